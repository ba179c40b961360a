//! Islands in rows, so that they do not lie on each other.

use geom::{HalfedgeData, HalfedgeId, Mesh};

use crate::flatten::Layout;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flatten::Scaling;
    use geom::Watch;
    use geom::{EdgeData, Metric};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_two_places_lie_on_each_other(extents in prop::collection::vec([0.01..2.0f64, 0.01..2.0], 2..30), area in 0.1..9.0f64) {
            let mut shelf = Shelf::new(area);
            let places: Vec<([f64; 2], [f64; 2])> = extents.iter().map(|&extent| (shelf.corner(extent), extent)).collect();
            for (k, (low, extent)) in places.iter().enumerate() {
                for (other, theirs) in &places[..k] {
                    let apart = |i: usize| low[i] >= other[i] + theirs[i] || other[i] >= low[i] + extent[i];
                    prop_assert!(apart(0) || apart(1), "{places:?}");
                }
            }
        }
    }

    #[test]
    fn islands_get_the_room_that_they_take_at_their_size() {
        let mesh = Mesh::new(4, &[[0, 1, 2], [2, 1, 3]]).unwrap();
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        let metric = Metric::from_points(&mesh, &points);
        let cut = EdgeData::constant(mesh.edge_count(), true);
        let layout = Layout::new(&mesh, &Scaling::none(&mesh, &metric), &cut, Watch::NONE).unwrap();
        for size in [0.01, 1.0, 70.0] {
            let place = Shelf::new(0.9 * size * size).place(&layout, &mesh, size);
            let corners = [0, 1].map(|f| mesh.sides(geom::FaceId(f)).map(|h| place[h]));
            let range = |f: usize, k: usize| {
                let x = corners[f].map(|corner| corner[k]);
                [x.iter().copied().fold(f64::INFINITY, f64::min), x.iter().copied().fold(0.0, f64::max)]
            };
            let apart = |k: usize| range(0, k)[1] < range(1, k)[0] || range(1, k)[1] < range(0, k)[0];
            assert!(apart(0) || apart(1), "{corners:?}");
            for [a, b, c] in corners {
                let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
                assert!((area / (0.5 * size * size) - 1.0).abs() < 1e-12);
            }
        }
    }
}
