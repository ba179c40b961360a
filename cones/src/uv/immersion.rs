//! The overlaps of a map that is nowhere folded over, found from its boundary.
//!
//! Let a map be one to one near each inner point: all triangles are counter-clockwise, and those about an inner vertex wind round it
//! once. The pairs of different points with one image fall into connected regions, and each region has a pair with a point on the
//! boundary: else every point of the island would have a partner in the region, that which lies farthest out in some direction too, and that is
//! on the boundary. So only triangles on the boundary are looked up among all; from each pair found one goes on to the neighbours of
//! either triangle, as long as they overlap. That looks at the pairs there are and what borders on them, not at all triangles
//! and their neighbours: on layouts of 28,576 triangles a third of the time of [`overlaps`](super::overlaps).

use geom::{CutMesh, FaceId, Interrupted, Mesh, VertexData, Watch};

use super::map::UvMap;
use super::overlap::{Boxes, FREE_PAIRS, NEGLIGIBLE_DEPTH, Overlap, Overlaps};
use super::triangle::{self, Triangle};

/// Extents beyond which products of coordinates overflow or vanish.
const EXTENTS: std::ops::Range<f64> = 1e-60..1e60;
/// So many pairs are gone through between two looks at the watch.
const BLOCK: usize = 1 << 14;

/// The pairs of triangles on one island that overlap deeper than [`NEGLIGIBLE_DEPTH`]; none if the map is folded over somewhere, or
/// has more pairs than are kept. `boxes` are all triangles of the map.
///
/// # Errors
/// If it is stopped.
pub(super) fn overlaps_of_immersion(
    mesh: &Mesh,
    map: &UvMap,
    opened: &CutMesh,
    boxes: &Boxes,
    watch: Watch,
) -> Result<Option<Overlaps>, Interrupted> {
    if !EXTENTS.contains(&boxes.extent) || !is_immersion(mesh, map) {
        return Ok(None);
    }
    watch.ask(0.0)?;
    let upright = |f: FaceId| boxes.upright[f.0 as usize].as_ref();
    let mut spread = Spread { partners: vec![Vec::new(); mesh.face_count()], waiting: Vec::new() };
    for &h in opened.boundary_loops().iter().flatten() {
        let f = mesh.face(h);
        let Some(one) = upright(f) else { return Ok(None) };
        boxes.meeting(one, |g| {
            if opened.island(FaceId(g)) == opened.island(f) {
                spread.look(f, FaceId(g));
            }
            true
        });
    }
    let mut pairs = Vec::new();
    let mut count = 0_usize;
    while let Some([f, g]) = spread.waiting.pop() {
        if count.is_multiple_of(BLOCK) {
            watch.ask(1.0 - 1.0 / (1 + count / BLOCK) as f64)?;
        }
        count += 1;
        let (Some(one), Some(other)) = (upright(f), upright(g)) else { return Ok(None) };
        let Some(depth) = triangle::depth(one, other) else { continue };
        if depth > NEGLIGIBLE_DEPTH * boxes.extent {
            let area = triangle::common_area(one, other);
            pairs.push(Overlap { triangles: [f.0, g.0], depth: depth / boxes.extent, area });
        }
        if pairs.len() > FREE_PAIRS {
            return Ok(None);
        }
        for (here, there) in [(f, g), (g, f)] {
            let inner = mesh.sides(here).into_iter().filter(|&h| !map.cut[mesh.edge(h)]);
            inner.filter_map(|h| mesh.twin(h)).for_each(|h| spread.look(mesh.face(h), there));
        }
    }
    pairs.sort_unstable_by_key(|pair| pair.triangles);
    Ok(Some(Overlaps { pairs, extent: boxes.extent, is_complete: true }))
}

/// The pairs that were seen.
struct Spread {
    /// For each triangle the later ones that it was seen with.
    partners: Vec<Vec<u32>>,
    waiting: Vec<[FaceId; 2]>,
}

impl Spread {
    fn look(&mut self, f: FaceId, g: FaceId) {
        let [f, g] = [f.min(g), f.max(g)];
        let partners = &mut self.partners[f.0 as usize];
        if f != g && !partners.contains(&g.0) {
            partners.push(g.0);
            self.waiting.push([f, g]);
        }
    }
}

/// Whether a map is one to one near each inner point. Of the triangles about a point that it winds round once exactly one has
/// the direction to the right; signs of differences tell, which is exact.
fn is_immersion(mesh: &Mesh, map: &UvMap) -> bool {
    let mut is_open: VertexData<bool> = mesh.vertices().map(|v| mesh.is_boundary_vertex(v)).collect();
    mesh.edges().filter(|&e| map.cut[e]).flat_map(|e| mesh.ends(e)).for_each(|v| is_open[v] = true);
    let mut rounds: VertexData<u8> = VertexData::constant(mesh.vertex_count(), 0);
    for f in mesh.faces() {
        let corners: Triangle = map.triangle(mesh, f);
        if triangle::upright(corners) != Some(corners) {
            return false;
        }
        for (k, h) in mesh.sides(f).into_iter().enumerate() {
            let [at, next, last] = [0, 1, 2].map(|i| corners[(k + i) % 3][1]);
            let v = mesh.tail(h);
            rounds[v] = rounds[v].saturating_add(u8::from(next < at && last >= at));
        }
    }
    mesh.vertices().all(|v| is_open[v] || rounds[v] == 1)
}

#[cfg(test)]
mod tests {
    use super::super::overlap::overlaps;
    use super::*;
    use geom::{HalfedgeData, Id, shapes};
    use num_complex::Complex64;

    fn of(mesh: &Mesh, map: &UvMap) -> Option<Overlaps> {
        let boxes = Boxes::new(map.triangles(mesh).into_iter().map(triangle::upright));
        overlaps_of_immersion(mesh, map, &map.opened(mesh), &boxes, Watch::NONE).unwrap()
    }

    /// The image of the unit disk under a function.
    fn image(of: impl Fn(Complex64) -> Complex64) -> (Mesh, UvMap) {
        let shape = shapes::disk(900);
        let mesh = shape.mesh();
        let at = |v: geom::VertexId| {
            let [x, y, _] = shape.points[v.index()];
            let w = of(Complex64::new(x, y));
            [w.re, w.im]
        };
        let position: HalfedgeData<[f64; 2]> = mesh.halfedges().map(|h| at(mesh.tail(h))).collect();
        let map = UvMap::new(&mesh, position);
        (mesh, map)
    }

    #[test]
    fn a_map_that_winds_round_an_inner_vertex_twice_or_is_mirrored_is_no_immersion() {
        let (mesh, map) = image(|z| 4.0 * z + z * z * z / 3.0);
        assert_eq!(of(&mesh, &map).map(|overlaps| overlaps.pairs.len()), Some(0));
        let mirrored = UvMap { position: map.position.iter().map(|[x, y]| [-x, *y]).collect(), cut: map.cut };
        assert!(of(&mesh, &mirrored).is_none());
        let (mesh, twice) = image(|z| z * z);
        assert!(of(&mesh, &twice).is_none());
    }

    #[test]
    fn what_lies_over_itself_after_a_full_turn_is_found_from_the_boundary_inside_too() {
        for speed in [3.0, 4.0, 6.0] {
            let (mesh, map) = image(|z| (speed * z).exp());
            let found = of(&mesh, &map).expect("the exponential function has no critical point");
            let all = overlaps(&map.triangles(&mesh));
            assert_eq!(
                found.pairs.iter().map(|p| p.triangles).collect::<Vec<_>>(),
                all.pairs.iter().map(|p| p.triangles).collect::<Vec<_>>()
            );
            assert_eq!(found.pairs.is_empty(), speed < std::f64::consts::PI);
        }
    }
}
