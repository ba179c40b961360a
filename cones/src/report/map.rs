//! A map of a model that anybody made, measured.

use geom::distortion::DistortionError;
use geom::{FaceId, Id, Model, Watch, Weld};

use super::quality::Quality;
use super::worth::worth_measuring;
use crate::uv::{Triangle, rounding_depth};

/// What a map of a model is worth, and the triangles that were measured for it: all but those that [`worth_measuring`] leaves out.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct MeasuredMap {
    /// All measures of it; triangles have their numbers in the lists below.
    pub quality: Quality,
    /// The triangles that were measured, by their numbers of the model's [triangles](Model::triangles).
    pub triangle: Vec<u32>,
    /// The face that each is part of.
    pub face_of: Vec<u32>,
    /// The vertices of each; of those that are taken for one, the first.
    pub vertices: Vec<[u32; 3]>,
    /// Where each lies in the plane.
    pub uv: Vec<Triangle>,
    /// The model's triangles that were not measured.
    pub left_out: Vec<u32>,
}

impl MeasuredMap {
    /// Measures a map that has a position for each corner of a model. What rounding to single precision [explains](rounding_depth) is no overlap. `weld` takes vertices for one, as many files have several along seams.
    ///
    /// ```
    /// use cones::report::MeasuredMap;
    ///
    /// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    /// let square = geom::Model::from_polygons(points, [[0, 1, 2, 3]])?;
    /// let twice_as_wide = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
    /// let map = MeasuredMap::new(&square, &twice_as_wide, geom::Weld::Auto)?;
    /// assert_eq!(map.quality.distortion.quasi_conformal.max, 2.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If there are more or fewer positions than corners, one is not finite, or no triangle has an area on both sides.
    pub fn new(model: &Model, uv: &[[f64; 2]], weld: Weld) -> Result<Self, DistortionError> {
        Self::new_watched(model, uv, weld, None, Watch::NONE)
    }

    /// [`new`](Self::new) of a model whose faces show several textures, each of which has the plane to itself: triangles whose faces have not the same one do not
    /// overlap. Faces beyond those that are given have none.
    ///
    /// ```
    /// use cones::report::MeasuredMap;
    ///
    /// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    /// let square = geom::Model::from_triangles(points, &[[0, 1, 2], [2, 3, 0]])?;
    /// let [a, b, c] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
    /// let uv = [a, b, c, a, b, c];
    /// let pairs = |of_face: &[Option<u32>]| -> Result<usize, geom::distortion::DistortionError> {
    ///     let map = MeasuredMap::of_textures(&square, &uv, geom::Weld::Auto, of_face)?;
    ///     Ok(map.quality.distortion.overlap.pairs)
    /// };
    /// assert_eq!((pairs(&[Some(0), Some(0)])?, pairs(&[Some(0), Some(1)])?), (1, 0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_textures(
        model: &Model,
        uv: &[[f64; 2]],
        weld: Weld,
        of_face: &[Option<u32>],
    ) -> Result<Self, DistortionError> {
        Self::measured(model, uv, weld, (None, Some(of_face)), Watch::NONE)
    }

    /// [`new`](Self::new) with the vertices that are the map's cones, if they are known; watched.
    ///
    /// # Errors
    /// As [`new`](Self::new), and if it is stopped.
    pub fn new_watched(
        model: &Model,
        uv: &[[f64; 2]],
        weld: Weld,
        cones: Option<&[u32]>,
        watch: Watch,
    ) -> Result<Self, DistortionError> {
        Self::measured(model, uv, weld, (cones, None), watch)
    }

    fn measured(
        model: &Model,
        uv: &[[f64; 2]],
        weld: Weld,
        (cones, texture): (Option<&[u32]>, Option<&[Option<u32>]>),
        watch: Watch,
    ) -> Result<Self, DistortionError> {
        let (found, corners) = (uv.len(), model.corner_count());
        if found != corners {
            return Err(DistortionError::TextureCount { found, corners });
        }
        let triangles = model.triangles();
        let mut vertices = triangles.vertices(model);
        let mut cones = cones.map(<[u32]>::to_vec);
        if let Some(first) = weld.of(model) {
            let all = vertices.iter_mut().flatten().chain(cones.iter_mut().flatten());
            // Cones that are no vertices are none of the map's either.
            all.for_each(|v| *v = first.get(*v as usize).copied().unwrap_or(*v));
        }
        let uv: Vec<Triangle> = triangles.corners.iter().map(|t| t.map(|c| uv[c as usize])).collect();
        let triangle = worth_measuring(&vertices, &uv);
        let mut is_left_out = vec![true; vertices.len()];
        triangle.iter().for_each(|&t| is_left_out[t as usize] = false);
        let (vertices, uv) = (picked(&triangle, &vertices), picked(&triangle, &uv));
        let face_of = picked(&triangle, &triangles.face_of);
        let texture = texture.map(|of_face| -> Vec<_> {
            face_of.iter().map(|&face| of_face.get(face as usize).copied().flatten()).collect()
        });
        let (points, given) = (model.points(), (cones.as_deref(), rounding_depth(&uv)));
        let quality = Quality::measure_deeper(points, &vertices, &uv, given, texture.as_deref(), watch);
        let quality = quality.map_err(|error| match error {
            DistortionError::UvNotFinite(f) => DistortionError::UvNotFinite(FaceId::new(triangle[f.index()] as usize)),
            error => error,
        })?;
        let left_out = (0..).zip(is_left_out).filter_map(|(t, is_left_out)| is_left_out.then_some(t)).collect();
        Ok(Self { quality, face_of, triangle, vertices, uv, left_out })
    }
}

fn picked<T: Copy>(triangle: &[u32], items: &[T]) -> Vec<T> {
    triangle.iter().map(|&t| items[t as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quad, a face that has a vertex twice, and a triangle, all apart but for places.
    fn strip() -> (Model, Vec<[f64; 2]>) {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.0], [2.0, 0.0], [1.0, 1.0]];
        let faces: [&[u32]; 3] = [&[0, 1, 2, 3], &[0, 1, 1], &[4, 5, 6]];
        let uv = faces.concat().iter().map(|&v| points[v as usize]).collect();
        (Model::from_polygons(points.map(|[x, y]| [x, y, 0.0]).to_vec(), faces).unwrap(), uv)
    }

    #[test]
    fn triangles_keep_their_numbers_and_vertices_are_taken_for_one_as_asked() {
        let (model, uv) = strip();
        let measured = |weld| MeasuredMap::new_watched(&model, &uv, weld, Some(&[6]), Watch::NONE).unwrap();
        let map = measured(Weld::Always);
        assert_eq!((map.triangle.len(), map.face_of.as_slice()), (3, [0, 0, 2].as_slice()));
        assert_eq!((map.left_out.as_slice(), map.quality.islands.len()), ([2].as_slice(), 1));
        assert_eq!(map.vertices[2], [1, 5, 2]);
        assert_eq!(measured(Weld::Never).quality.islands.len(), 2);
    }

    #[test]
    fn what_cannot_be_measured_is_named_by_the_models_numbers() {
        let (model, mut uv) = strip();
        let error = |uv: &[[f64; 2]]| MeasuredMap::new(&model, uv, Weld::Auto).unwrap_err();
        assert_eq!(error(&uv[1..]), DistortionError::TextureCount { found: 9, corners: 10 });
        uv[8][0] = f64::NAN;
        assert_eq!(error(&uv), DistortionError::UvNotFinite(FaceId::new(3)));
    }
}
