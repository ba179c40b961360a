//! Where the texture coordinates that a file has are cut open.

use std::collections::HashMap;

use super::model::Model;
use super::weld::Weld;

/// A polygon's side: the two corners that it joins, in the polygon's order.
type Side = [u32; 2];

/// The edges of a model whose two polygons have different texture coordinates there, by their vertices in ascending order.
/// Coordinates are compared as points, so that one that is written twice is no seam. Where `weld` takes
/// vertices for one, an edge is named as its first polygon names it. Where just one of its polygons has coordinates the map ends, which is a seam, too.
/// Edges that have not just two polygons are left aside. O(F).
///
/// ```
/// # #[cfg(feature = "files")]
/// # {
/// let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 5 5\n";
/// let seams = |faces: &str| {
///     let model = geom::io::read_bytes([square, faces].concat().into(), "square.obj")?;
///     Ok::<_, geom::Error>(geom::texture_seams(&model, geom::Weld::Never))
/// };
/// assert_eq!(seams("f 1/1 2/2 3/3\nf 1/5 3/3 4/4\n")?, [[0, 2]]);
/// assert_eq!(seams("f 1/1 2/2 3/3\nf 1 3 4\n")?, [[0, 2]]);
/// assert!(seams("f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n")?.is_empty());
/// # }
/// # Ok::<(), geom::Error>(())
/// ```
pub fn texture_seams(model: &Model, weld: Weld) -> Vec<[u32; 2]> {
    let Some(uv) = model.uv() else { return Vec::new() };
    let place = weld.of(model).unwrap_or_default();
    let place_of = |v: u32| place.get(v as usize).copied().unwrap_or(v);
    let mut first: HashMap<[u32; 2], (Side, usize)> = HashMap::new();
    let mut pairs: Vec<([u32; 2], [Side; 2])> = Vec::new();
    let ends = |side: Side| side.map(|corner| place_of(model.corners()[corner as usize]));
    for face in 0..model.face_count() {
        let corners = model.face_corners(face);
        let size = corners.len();
        for k in 0..size {
            let side = [corners.start + k, corners.start + (k + 1) % size].map(|corner| corner as u32);
            let mut key = ends(side);
            key.sort_unstable();
            let (other, count) = first.entry(key).or_insert((side, 0));
            *count += 1;
            if *count == 2 {
                pairs.push((key, [*other, side]));
            }
        }
    }
    pairs.retain(|(key, _)| first[key].1 == 2 && key[0] != key[1]);
    let is_seam = |[one, mut other]: [Side; 2]| {
        if ends(one)[0] != ends(other)[0] {
            other.reverse();
        }
        one.into_iter().zip(other).any(|(a, b)| uv.corner(a as usize) != uv.corner(b as usize))
    };
    let named = |[one, _]: [Side; 2]| {
        let mut ends = one.map(|corner| model.corners()[corner as usize]);
        ends.sort_unstable();
        ends
    };
    let mut seams: Vec<[u32; 2]> = pairs.into_iter().filter(|pair| is_seam(pair.1)).map(|pair| named(pair.1)).collect();
    seams.sort_unstable();
    seams.dedup();
    seams
}

#[cfg(all(test, feature = "files"))]
mod tests {
    use super::*;

    const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 2 0 0\nv 2 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 1 0\n";

    fn seams(faces: &str, weld: Weld) -> Vec<[u32; 2]> {
        texture_seams(&crate::io::read_bytes(format!("{CORNERS}{faces}").into(), "squares.obj").unwrap(), weld)
    }

    #[test]
    fn an_edge_is_a_seam_where_its_sides_have_different_coordinates() {
        assert_eq!(seams("f 1/1 2/2 3/3 4/4\nf 2/2 7/1 8/1 3/3\n", Weld::Never), [[0u32; 2]; 0]);
        assert_eq!(
            seams("f 1/1 2/2 3/3 4/4\nf 2/5 7/1 8/1 3/3\n", Weld::Never),
            [[0u32; 2]; 0],
            "the same point twice"
        );
        assert_eq!(seams("f 1/1 2/2 3/3 4/4\nf 2/4 7/1 8/1 3/3\n", Weld::Never), [[1, 2]]);
        assert_eq!(seams("f 1 2 3 4\nf 2/4 7/1 8/1 3/3\n", Weld::Never), [[1, 2]], "the map ends");
        assert_eq!(seams("f 1 2 3 4\nf 2 7 8 3\n", Weld::Never), [[0u32; 2]; 0]);
    }

    #[test]
    fn welded_vertices_are_named_as_the_first_polygon_does() {
        let faces = "f 1/1 2/2 3/3 4/4\nf 5/1 7/2 8/3 6/4\n";
        assert_eq!(seams(faces, Weld::Never), [[0u32; 2]; 0], "they are two surfaces");
        for weld in [Weld::Auto, Weld::Always] {
            assert_eq!(seams(faces, weld), [[1, 2]]);
        }
        assert_eq!(seams("f 5/1 7/2 8/3 6/4\nf 1/1 2/2 3/3 4/4\n", Weld::Always), [[4, 5]]);
    }
}
