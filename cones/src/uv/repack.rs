//! The islands of a model's map, whoever made it, packed.

use geom::distortion::{DistortionError, measure_watched, unit_on_surface};
use geom::{FaceId, Id, Model, Watch, Weld};

use super::companions::{Corners, leaders};
use super::pack::{PackError, PackOptions, Packing, Tiles, check_islands, fill, pack_numbered};
use super::triangle::Triangle;

/// A model's map whose islands are packed.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Repacked {
    /// The position of each corner of the model.
    pub uv: Vec<[f64; 2]>,
    /// What was done to each island.
    pub packing: Packing,
    /// The share of the square, or of the tiles that the map kept to, that was covered before.
    pub fill_before: f64,
}

/// The island of each of a model's triangles: those that hang together in the plane have the same number, from 0. Triangles that have a vertex twice or lie where
/// another one on the same vertices does have that of a triangle with which they have a corner in common, or none. `weld` takes vertices for
/// one. O(F).
///
/// # Errors
/// If there are more or fewer positions than corners, positions are not finite, there is no area, or the work was stopped.
pub fn islands_of(
    model: &Model,
    uv: &[[f64; 2]],
    weld: Weld,
    watch: Watch,
) -> Result<Vec<Option<u32>>, DistortionError> {
    let (found, corners) = (uv.len(), model.corner_count());
    if found != corners {
        return Err(DistortionError::TextureCount { found, corners });
    }
    let triangles = model.triangles();
    let (mut vertices, images) = (triangles.vertices(model), images(&triangles.corners, uv));
    weld.apply(model, &mut vertices);
    let companions = Corners { vertices: &vertices, uv: &images }.companions(0..vertices.len() as u32);
    let kept = leaders(&companions);
    let (kept_vertices, kept_images): (Vec<_>, Vec<_>) =
        kept.iter().map(|&t| (vertices[t as usize], images[t as usize])).unzip();
    let measured =
        measure_watched(model.points(), &kept_vertices, &kept_images, watch).map_err(|error| match error {
            DistortionError::UvNotFinite(f) => DistortionError::UvNotFinite(FaceId::new(kept[f.index()] as usize)),
            error => error,
        })?;
    let mut islands = vec![None; vertices.len()];
    kept.iter().zip(measured.triangle_island.iter()).for_each(|(&t, &island)| islands[t as usize] = Some(island));
    Ok(companions.iter().map(|companion| companion.and_then(|t| islands[t as usize])).collect())
}

/// Packs the islands of a model's map: they are moved rigidly and scaled alike, with all their triangles; what is on none stays. Copies of triangles take no
/// room and stay where the others are; `weld` takes vertices for one. Texels of [`Tiles::Udim`] are those of a unit of length on the surface. Cost as of [`pack`](super::pack()).
///
/// # Errors
/// As [`pack`](super::pack()), and if there are more or fewer positions than corners, or entries than triangles.
pub fn repack(
    model: &Model,
    uv: &[[f64; 2]],
    islands: &[Option<u32>],
    (weld, options): (Weld, &PackOptions),
    watch: Watch,
) -> Result<Repacked, PackError> {
    options.check()?;
    let (found, corners) = (uv.len(), model.corner_count());
    if found != corners {
        return Err(PackError::TextureCount { found, corners });
    }
    let triangles = model.triangles();
    if islands.len() != triangles.len() {
        return Err(PackError::Count { triangles: triangles.len(), islands: islands.len() });
    }
    check_islands(islands.iter().copied())?;
    let (mut vertices, images) = (triangles.vertices(model), images(&triangles.corners, uv));
    weld.apply(model, &mut vertices);
    let companions = Corners { vertices: &vertices, uv: &images }.companions(0..vertices.len() as u32);
    let kept: Vec<u32> = leaders(&companions).into_iter().filter(|&t| islands[t as usize].is_some()).collect();
    let of_kept: Vec<Triangle> = kept.iter().map(|&t| images[t as usize]).collect();
    let kept_vertices: Vec<[u32; 3]> = kept.iter().map(|&t| vertices[t as usize]).collect();
    let island: Vec<u32> = kept.iter().filter_map(|&t| islands[t as usize]).collect();
    let unit = unit_on_surface(model.points(), &kept_vertices, &of_kept);
    let tiles = match options.tiles {
        Tiles::Udim { texel_density } => Tiles::Udim { texel_density: texel_density * unit },
        Tiles::One => Tiles::One,
    };
    let options = PackOptions { tiles, ..*options };
    options.check().map_err(|error| error.in_unit(unit))?;
    let packing = pack_numbered(&of_kept, &island, &options, watch).map_err(|error| error.in_unit(unit))?;
    let mut placed = uv.to_vec();
    for ((corners, own), companion) in triangles.corners.iter().zip(islands).zip(&companions) {
        let island = companion.and_then(|companion| islands[companion as usize]).or(*own);
        if let Some(island) = island.map(|island| island as usize).filter(|&island| island < packing.places.len()) {
            corners.iter().for_each(|&c| placed[c as usize] = packing.place(island, uv[c as usize]));
        }
    }
    Ok(Repacked { uv: placed, packing, fill_before: fill(&of_kept) })
}

/// The images of triangles, given as corners of which the positions are known.
pub(super) fn images(corners: &[[u32; 3]], uv: &[[f64; 2]]) -> Vec<Triangle> {
    corners.iter().map(|t| t.map(|c| uv[c as usize])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uv::part;

    const FIRST: Triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    const BESIDE: Triangle = [[0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];

    /// Two triangles side by side, one that is elsewhere in space, and the second of them once more, with the images of the last two.
    fn copied(elsewhere: Triangle, copy: Triangle) -> (Model, Vec<[f64; 2]>) {
        let points = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 0.0, 5.0],
            [1.0, 0.0, 5.0],
            [0.0, 1.0, 5.0],
        ];
        let model = Model::from_triangles(points, &[[0, 1, 2], [2, 1, 3], [4, 5, 6], [2, 1, 3]]).unwrap();
        (model, [FIRST, BESIDE, elsewhere, copy].concat())
    }

    #[test]
    fn copies_go_where_the_triangle_goes_on_which_they_lie() {
        let second = [[0.1, 0.0], [1.1, 0.0], [0.1, 1.0]];
        let (model, uv) = copied(second, BESIDE);
        let parted = part(&model, &uv, Weld::Auto, Watch::NONE).unwrap();
        assert_eq!((parted.overlaps.pairs.len(), parted.island_count), (2, 2));
        let packed =
            repack(&model, &parted.uv, &parted.islands, (Weld::Auto, &PackOptions::default()), Watch::NONE).unwrap();
        assert_ne!(packed.uv[3..6], uv[3..6]);
        assert_eq!(packed.uv[9..12], packed.uv[3..6]);
        let found = islands_of(&model, &uv, Weld::Auto, Watch::NONE).unwrap();
        assert_eq!(found, [Some(0), Some(0), Some(1), Some(0)]);
        // Three triangles of half a unit each, and no fourth one.
        assert!((packed.packing.scale.powi(2) * 1.5 - packed.packing.fill).abs() < 1e-9);
    }

    #[test]
    fn a_copy_that_lies_elsewhere_has_room_of_its_own() {
        let second = [[0.1, 0.0], [1.1, 0.0], [0.1, 1.0]];
        let (model, uv) = copied(second, [[5.0, 5.0], [6.0, 4.0], [6.0, 5.0]]);
        let parted = part(&model, &uv, Weld::Auto, Watch::NONE).unwrap();
        assert_eq!((parted.island_count, parted.islands[3]), (3, Some(2)));
        let packed =
            repack(&model, &parted.uv, &parted.islands, (Weld::Auto, &PackOptions::default()), Watch::NONE).unwrap();
        assert!(packed.uv.as_flattened().iter().all(|x| (0.0..=1.0).contains(x)), "{:?}", packed.uv);
    }

    #[test]
    fn islands_may_have_any_numbers_less_than_that_of_triangles() {
        let second = [[0.1, 0.0], [1.1, 0.0], [0.1, 1.0]];
        let (model, uv) = copied(second, BESIDE);
        let repacked = |islands: [u32; 4]| {
            repack(&model, &uv, &islands.map(Some), (Weld::Auto, &PackOptions::default()), Watch::NONE)
        };
        // The fourth triangle is a copy, so that three are packed.
        assert_eq!(repacked([3, 3, 1, 3]).unwrap().packing.places.len(), 4);
        for island in [4, u32::MAX] {
            let error = repacked([0, 0, island, 0]).unwrap_err();
            assert_eq!(error, PackError::Island { triangle: 2, island, triangles: 4 });
        }
    }

    #[test]
    fn what_does_not_fit_the_model_is_refused_by_both_numbers() {
        let (model, uv) = copied(FIRST, BESIDE);
        let packed = |uv: &[[f64; 2]], islands: &[Option<u32>]| {
            repack(&model, uv, islands, (Weld::Auto, &PackOptions::default()), Watch::NONE).unwrap_err()
        };
        let long = [uv.as_slice(), &uv[..1]].concat();
        for wrong in [&uv[1..], &long, &[]] {
            let told = format!("there are {} texture coordinates for 12 corners of faces", wrong.len());
            assert_eq!(islands_of(&model, wrong, Weld::Auto, Watch::NONE).unwrap_err().to_string(), told);
            assert_eq!(part(&model, wrong, Weld::Auto, Watch::NONE).unwrap_err().to_string(), told);
            assert_eq!(packed(wrong, &[Some(0); 4]).to_string(), told);
        }
        for islands in [3, 5] {
            assert_eq!(packed(&uv, &vec![Some(0); islands]), PackError::Count { triangles: 4, islands });
        }
    }

    #[test]
    fn rounded_positions_and_signs_of_zero_part_nothing() {
        let (model, mut uv) = copied([[0.1, 0.0], [1.1, 0.0], [0.1, 1.0]], [[5.0, 5.0], [6.0, 4.0], [6.0, 5.0]]);
        uv[3] = [-0.0, 1.0 - 3e-7];
        let parted = part(&model, &uv, Weld::Auto, Watch::NONE).unwrap();
        assert_eq!((parted.islands[0], parted.islands[1]), (Some(0), Some(0)));
        let found = islands_of(&model, &uv, Weld::Auto, Watch::NONE).unwrap();
        assert_eq!((found[0], found[1]), (Some(0), Some(0)));
    }
}
