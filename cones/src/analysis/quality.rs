//! What a layout of a component is worth, as it came out.

use geom::{Mesh, Metric};

use crate::flatten::{Layout, stretch};
use crate::placement::distortion_of;

/// σ₁/σ₂ counts up to here, so that one needle does not outweigh a surface.
const WORST: f64 = 1e3;

/// The measures of [`geom::distortion`] that attempts are compared by.
#[derive(Clone, Debug)]
pub(crate) struct Quality {
    /// The mean of σ₁/σ₂, weighted by area.
    pub(crate) quasi_conformal: f64,
    /// Each triangle's area in space, and its area in the layout over that.
    pub(crate) ratios: Vec<(f64, f64)>,
}

impl Quality {
    /// Measures a layout; `metric` has the lengths in space. Triangles without area in space are left out.
    pub(crate) fn of(mesh: &Mesh, metric: &Metric, layout: &Layout) -> Self {
        let mut ratios = Vec::with_capacity(mesh.face_count());
        let (mut sum, mut whole) = (0.0, 0.0);
        for f in mesh.faces() {
            let sides = metric.sides(mesh, f);
            let Some([stretch, ratio]) = stretch(sides, mesh.sides(f).map(|h| layout.corner(h))) else { continue };
            let area = sides.area();
            sum += area * stretch.min(WORST);
            whole += area;
            ratios.push((area, ratio));
        }
        Self { quasi_conformal: sum / whole, ratios }
    }

    /// The area distortion D.
    pub(crate) fn area_distortion(&self) -> f64 {
        distortion_of(&self.ratios)
    }
}
