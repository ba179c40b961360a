//! Islands in rows, so that they do not lie on each other.

use num_complex::Complex64;

use crate::layout::Layout;

/// Rows of islands, filled from left to right.
pub(crate) struct Shelf {
    at: [f64; 2],
    height: f64,
    width: f64,
    gap: f64,
}

impl Shelf {
    pub(crate) fn new(area: f64) -> Self {
        Self { at: [0.0; 2], height: 0.0, width: 1.5 * area.sqrt(), gap: 0.01 * area.sqrt() }
    }

    /// Finds a place for an island; returns the map of its positions to there.
    pub(crate) fn place(&mut self, layout: &Layout, size: f64) -> impl Fn(Complex64) -> [f64; 2] + use<> {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for z in &layout.position {
            for (k, x) in [z.re, z.im].into_iter().enumerate() {
                low[k] = low[k].min(x);
                high[k] = high[k].max(x);
            }
        }
        let extent = [0, 1].map(|k| size * (high[k] - low[k]));
        if self.at[0] > 0.0 && self.at[0] + extent[0] > self.width {
            self.at = [0.0, self.at[1] + self.height + self.gap];
            self.height = 0.0;
        }
        let corner = self.at;
        self.at[0] += extent[0] + self.gap;
        self.height = self.height.max(extent[1]);
        move |z| [corner[0] + size * (z.re - low[0]), corner[1] + size * (z.im - low[1])]
    }
}
