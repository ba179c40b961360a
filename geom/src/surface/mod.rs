//! From points and polygons as a file had them to surfaces that can be computed with.

mod attributes;
mod curvature;
mod exposure;
mod holes;
mod instances;
mod model;
mod numbering;
mod prepare;
mod radial;
mod refine_attributes;
mod repair;
mod soup;
mod split_edges;
mod stitches;
mod t_junctions;
mod texture_seams;
mod triangulate;
mod weld;

pub use attributes::{
    Attribute, AttributeDomain, AttributeError, Attributes, BaseColourPicture, Listing, Meaning, NodePlace, ScalarType,
    SceneNode,
};
pub use curvature::{gaussian_curvature, mean_curvature};
pub use exposure::{exposure, exposure_watched};
pub use holes::{fill_holes, small_holes};
pub use instances::unify_instances;
pub use model::{MAX_COORDINATE, MissingTexture, Model, ModelError, Skipped, TextureCoordinates};
#[cfg(feature = "files")]
pub(crate) use model::{Polygons, is_coordinate};
pub use prepare::{PrepareError, Prepared, Surface, prepare, prepare_watched};
pub use refine_attributes::refine_attributes;
pub use repair::{Repair, RepairKind};
pub use split_edges::SplitEdges;
pub use texture_seams::texture_seams;
pub use triangulate::Triangles;
pub use weld::Weld;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_triangles_against_each_other_the_second_is_turned() {
        let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let model = Model::from_triangles(points, &[[0, 1, 2], [0, 3, 2]]).unwrap();
        let repairs = prepare(&model, Weld::Never).unwrap().repairs;
        assert_eq!(repairs, [Repair { kind: RepairKind::FlippedFace, count: 1, first: 1 }]);
    }

    #[test]
    fn what_is_too_small_to_be_scaled_to_unit_size_has_no_area() {
        let points = vec![[0.0; 3], [1e-320, 0.0, 0.0], [0.0, 1e-320, 0.0]];
        let model = Model::from_triangles(points, &[[0, 1, 2]]).unwrap();
        assert_eq!(prepare(&model, Weld::Never).unwrap_err(), PrepareError::NoArea { faces: 1 });
    }
}
