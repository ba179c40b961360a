//! A field as the page shows it: where its values are, its extrema, and what belongs to which of them at every level.

use super::{Container, with_data};
use serde_json::{Value, json};
use std::io;

/// A vertex that belongs to no extremum.
pub(crate) const NO_SEGMENT: u32 = u32::MAX;

/// Where the vertices that are shown are.
#[derive(Clone, Debug)]
pub(crate) enum FieldPlaces {
    /// On a mesh about the origin, within a unit cube.
    Mesh { points: Vec<[f32; 3]>, triangles: Vec<[u32; 3]> },
    /// In an array of depth, rows and columns, of which the vertices from `first` on are shown, layer by layer.
    Array { shape: [usize; 3], first: usize },
    /// Nowhere: nodes of a network have names only.
    Network { names: Vec<String> },
}

/// The minima or the maxima.
#[derive(Clone, Debug)]
pub(crate) struct FieldDirection {
    /// The pairs with their parents, and the levels, as the page reads them.
    pub(crate) meta: Value,
    /// For each vertex that is shown its basin at the finest level.
    pub(crate) basins: Vec<u32>,
    /// Level by level for each of these basins the pair that it belongs to.
    pub(crate) survivors: Vec<u32>,
}

/// All that the page shows of a field.
#[derive(Clone, Debug)]
pub(crate) struct FieldPage {
    pub(crate) name: String,
    pub(crate) places: FieldPlaces,
    /// Of the vertices that are shown; NaN where there is none.
    pub(crate) values: Vec<f64>,
    pub(crate) directions: Vec<FieldDirection>,
}

impl FieldPage {
    /// The page with the field inside.
    ///
    /// # Errors
    /// None that memory does not have.
    pub(crate) fn html(&self) -> io::Result<String> {
        let finite = || self.values.iter().copied().filter(|value| value.is_finite());
        let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
        let directions: Vec<&Value> = self.directions.iter().map(|direction| &direction.meta).collect();
        let (kind, shape, first, names) = match &self.places {
            FieldPlaces::Mesh { .. } => ("mesh", None, 0, None),
            FieldPlaces::Array { shape, first } => ("array", Some(shape), *first, None),
            FieldPlaces::Network { names } => ("network", None, 0, Some(names)),
        };
        let range = if low <= high { [low, high] } else { [0.0, 0.0] };
        let meta = json!({ "field": {
            "name": self.name, "kind": kind, "shape": shape, "first": first, "names": names, "range": range,
            "directions": directions,
        } });
        let mut container = Container::new(meta).bytes("values", &steps(&self.values, range));
        if let FieldPlaces::Mesh { points, triangles } = &self.places {
            container = container.floats("points", points.as_flattened()).words("triangles", triangles.as_flattened());
        }
        for (k, direction) in self.directions.iter().enumerate() {
            container = container
                .words(&format!("basins.{k}"), &direction.basins)
                .words(&format!("survivors.{k}"), &direction.survivors);
        }
        with_data(container)
    }
}

/// Values as the page's colours need them: from 1 to 255, 0 where there is none.
fn steps(values: &[f64], [low, high]: [f64; 2]) -> Vec<u8> {
    let step = |&value: &f64| match value {
        _ if value.is_nan() => 0,
        _ if high > low => 1 + (254.0 * ((value - low) / (high - low)).clamp(0.0, 1.0)).round() as u8,
        _ => 128,
    };
    values.iter().map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_value_is_1_the_greatest_255_and_none_0() {
        assert_eq!(steps(&[2.0, f64::NAN, 4.0, 3.0, f64::INFINITY], [2.0, 4.0]), [1, 0, 255, 128, 255]);
        assert_eq!(steps(&[7.0], [7.0, 7.0]), [128]);
    }
}
