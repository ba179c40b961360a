//! Islands in rows, so that they do not lie on each other.

use geom::{HalfedgeData, HalfedgeId, Mesh};

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

    /// Finds places for a layout's islands, scaled by `size`; returns the corner positions by halfedge.
    pub(crate) fn place(&mut self, layout: &Layout, input: &Mesh, size: f64) -> HalfedgeData<[f64; 2]> {
        let cut = &layout.cut;
        let island = |h: HalfedgeId| cut.island(input.face(h)) as usize;
        let mut low = vec![[f64::INFINITY; 2]; cut.island_count()];
        let mut high = vec![[f64::NEG_INFINITY; 2]; cut.island_count()];
        for h in input.halfedges() {
            let z = layout.corner(h);
            for (k, x) in [z.re, z.im].into_iter().enumerate() {
                low[island(h)][k] = low[island(h)][k].min(x);
                high[island(h)][k] = high[island(h)][k].max(x);
            }
        }
        let extents = low.iter().zip(&high).map(|(low, high)| [0, 1].map(|k| size * (high[k] - low[k])));
        let corners: Vec<[f64; 2]> = extents.map(|extent| self.corner(extent)).collect();
        let position = |h: HalfedgeId| {
            let (z, low, corner) = (layout.corner(h), low[island(h)], corners[island(h)]);
            [corner[0] + size * (z.re - low[0]), corner[1] + size * (z.im - low[1])]
        };
        input.halfedges().map(position).collect()
    }

    /// The lower left corner of the next free place of this extent.
    fn corner(&mut self, extent: [f64; 2]) -> [f64; 2] {
        if self.at[0] > 0.0 && self.at[0] + extent[0] > self.width {
            self.at = [0.0, self.at[1] + self.height + self.gap];
            self.height = 0.0;
        }
        let corner = self.at;
        self.at[0] += extent[0] + self.gap;
        self.height = self.height.max(extent[1]);
        corner
    }
}
