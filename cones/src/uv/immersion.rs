//! The overlaps of a map that is nowhere folded over, found from its boundary.
//!
//! Let a map be one to one near each inner point: all triangles are counter-clockwise, and those about an inner vertex wind round it
//! once. The pairs of different points with one image fall into connected regions, and each region has a pair with a point on the
//! boundary: else every point of the island would have a partner in the region, that which lies farthest out in some direction too, and that is
//! on the boundary. So only triangles on the boundary are looked up among all; from each pair found one goes on to the neighbours of
//! either triangle, as long as they overlap. That looks at the pairs there are and what borders on them, not at all triangles
//! and their neighbours: on layouts of 28,576 triangles a third of the time of [`overlaps`](super::overlaps).

use geom::{CutMesh, FaceId, Interrupted, Mesh, VertexData, Watch};
use rayon::prelude::*;

use super::boxes::Boxes;
use super::map::UvMap;
use super::overlap::{FREE_PAIRS, NEGLIGIBLE_DEPTH, Overlap, Overlaps};
use super::table::Set;
use super::triangle::{self, Triangle};

/// Extents beyond which products of coordinates overflow or vanish.
const EXTENTS: std::ops::Range<f64> = 1e-60..1e60;
/// So many pairs are gone through between two looks at the watch.
const BLOCK: usize = 1 << 14;
/// So many triangles are looked up one after the other.
const AT_ONCE: usize = 1 << 10;

/// The pairs of triangles on one island that overlap deeper than [`NEGLIGIBLE_DEPTH`]; none if the map is folded over somewhere, or
/// has more pairs than are kept. `opened` is the map's.
///
/// # Errors
/// If it is stopped.
pub(super) fn overlaps_of_immersion(
    mesh: &Mesh,
    map: &UvMap,
    opened: &CutMesh,
    watch: Watch,
) -> Result<Option<Overlaps>, Interrupted> {
    if !is_immersion(mesh, map) {
        return Ok(None);
    }
    watch.ask(0.0)?;
    let uv = map.triangles();
    let mut outer: Vec<u32> = opened.boundary_loops().iter().flatten().map(|&h| mesh.face(h).0).collect();
    outer.sort_unstable();
    outer.dedup();
    // The boxes about the triangles at the boundary are about all, too.
    let boxes = Boxes::of(uv, outer);
    if !EXTENTS.contains(&boxes.extent) {
        return Ok(None);
    }
    let at_boundary = |g: usize| {
        let (mut found, one) = (Vec::new(), &uv[g]);
        boxes.meeting(one, |f| {
            let is_asked = f as usize != g && opened.island(FaceId(f)) == opened.island(FaceId(g as u32));
            if is_asked && triangle::depth(one, &uv[f as usize]).is_some() {
                found.push([FaceId(f), FaceId(g as u32)]);
            }
            true
        });
        found
    };
    let found: Vec<[FaceId; 2]> =
        (0..uv.len()).into_par_iter().with_min_len(AT_ONCE).flat_map_iter(at_boundary).collect();
    watch.ask(0.0)?;
    let mut spread = Spread::default();
    found.into_iter().for_each(|[f, g]| spread.look(f, g));
    let mut pairs = Vec::new();
    let mut count = 0_usize;
    while let Some([f, g]) = spread.waiting.pop() {
        if count.is_multiple_of(BLOCK) {
            watch.ask(1.0 - 1.0 / (1 + count / BLOCK) as f64)?;
        }
        count += 1;
        let [one, other] = [f, g].map(|f| &uv[f.0 as usize]);
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
#[derive(Default)]
struct Spread {
    seen: Set<[u32; 2]>,
    waiting: Vec<[FaceId; 2]>,
}

impl Spread {
    fn look(&mut self, f: FaceId, g: FaceId) {
        let [f, g] = [f.min(g), f.max(g)];
        if f != g && self.seen.insert([f.0, g.0]) {
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
        let corners: Triangle = map.triangle(f);
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
        overlaps_of_immersion(mesh, map, &map.opened(mesh), Watch::NONE).unwrap()
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
            let all = overlaps(map.triangles());
            assert_eq!(
                found.pairs.iter().map(|p| p.triangles).collect::<Vec<_>>(),
                all.pairs.iter().map(|p| p.triangles).collect::<Vec<_>>()
            );
            assert_eq!(found.pairs.is_empty(), speed < std::f64::consts::PI);
        }
    }
}
