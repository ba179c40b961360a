//! Lobes moved elsewhere, so that an island takes less room and its seams get shorter.
//!
//! A path across an island parts it in two. If somewhere along its seams one part lies opposite to the other, and both sides of
//! that seam are congruent ([`chains`](super::chains)), the parts can be put together there instead: the path is a seam then, and
//! that run of seam none. The island is a disk again, at unchanged scale. All such *exchanges* of a few dozen short paths
//! ([`across`](super::across)) are compared by the length of the seams and the side of the smallest square about both parts' convex
//! hulls; the first of the best in which the parts lie beside each other is made, and the next is sought, as long as one gains enough.
//!
//! Two disks that do not lie over themselves lie beside each other iff the boundary of the smaller meets nothing of the larger: so
//! only triangles on its boundary are tested. Few tests are long, since most exchanges that take little room take it twice.
//!
//! On 12 surfaces (hemisphere, spot, threeholes, fertility, casting, punctured torus, octaflower, planck, moai, fandisk, camelhead, bunny)
//! with 32 cones, of other trees of seams alone the fill is .427 on average; with exchanges .460 to .530, as room is weighed
//! (`analysis/reseaming`).

use geom::{EdgeData, EdgeId, FaceId, HalfedgeId, Interrupted, Mesh, Watch};
use num_complex::Complex64;
use rayon::prelude::*;

use super::across::{Across, Paths, Sweep};
use super::attach::{ALLOWED, STRIDE};
use super::boxes::Boxes;
use super::chains::{Chain, Loops};
use super::map::UvMap;
use super::motion::Motion;
use super::overlap::NEGLIGIBLE_DEPTH;
use super::pack::{convex_hull, side};
use super::triangle;

/// So many exchanges are made at most: with 8 the fill on those is the same to .001,
const MOST_EXCHANGES: usize = 4;
/// and fewer where the surface is large: each goes through so many triangles (1 s on 870,000).
const TRIANGLES: usize = 240_000;
/// So many paths are looked at for each,
const PATHS: usize = 64;
/// none of which passes within this share of the island's extent of a shorter one.
const NEAR: f64 = 0.03;
/// Either part keeps at least this share of the area.
const LEAST_SHARE: f64 = 0.02;
/// So many exchanges are tested for overlap, the most promising first: some 10 µs each.
const TESTED: usize = 2000;
/// What an exchange must gain.
const LEAST_GAIN: f64 = 0.004;

/// What islands are to be like.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    /// The length that seams are counted in.
    pub(crate) seam: f64,
    /// What the side of the islands' squares, over the root of their area, is worth as a share of that.
    pub(crate) room: f64,
    /// How long seams may become.
    pub(crate) longest: f64,
    /// Whether an exchange is sought however large the surface is.
    pub(crate) always: bool,
}

/// Moves lobes of the largest island elsewhere as long as that gains something. Edges of infinite length are not cut, what is
/// `kept` open is not glued. No island may lie over itself. O(n log n) for each exchange.
///
/// # Errors
/// If it is stopped.
pub(crate) fn exchange(
    mesh: &Mesh,
    lengths: &EdgeData<f64>,
    kept: Option<&EdgeData<bool>>,
    mut map: UvMap,
    aim: &Aim,
    watch: Watch,
) -> Result<UvMap, Interrupted> {
    let rounds = (TRIANGLES / mesh.face_count().max(1)).clamp(usize::from(aim.always), MOST_EXCHANGES);
    for round in 0..rounds {
        watch.ask(round as f64 / rounds as f64)?;
        let Some(island) = Island::largest(mesh, lengths, kept, &map, watch)? else { break };
        let Some(better) = island.exchanged(aim, watch)? else { break };
        map = better;
    }
    Ok(map)
}

/// An island that may be put together otherwise.
struct Island<'a> {
    mesh: &'a Mesh,
    map: &'a UvMap,
    lengths: &'a EdgeData<f64>,
    paths: Paths<'a>,
    sweep: Sweep,
    /// The halfedges on its boundary.
    boundary: Vec<HalfedgeId>,
    /// The seams that have it on both sides.
    chains: Vec<Chain>,
    /// The sum of the squares about the others.
    others: f64,
    /// Of all islands, in the plane.
    area: f64,
    /// Of all seams.
    seam: f64,
}

/// A path that would be a seam, and a seam that would be none.
struct Exchange<'a> {
    across: &'a Across,
    glued: &'a [HalfedgeId],
    /// What takes the rest to where it meets the path's first side.
    motion: Motion,
    cost: f64,
}

impl<'a> Island<'a> {
    /// The island with the most triangles; none if it is no disk.
    fn largest(
        mesh: &'a Mesh,
        lengths: &'a EdgeData<f64>,
        kept: Option<&EdgeData<bool>>,
        map: &'a UvMap,
        watch: Watch,
    ) -> Result<Option<Self>, Interrupted> {
        let paths = Paths::new(mesh, lengths, map, watch.within(f64::NAN, f64::NAN))?;
        let islands = paths.islands();
        watch.ask(f64::NAN)?;
        let largest = (0..islands.len()).max_by_key(|&k| (islands[k].len(), std::cmp::Reverse(k)));
        let Some(largest) = largest else { return Ok(None) };
        let Some(sweep) = paths.sweep(&islands[largest]) else { return Ok(None) };
        watch.ask(f64::NAN)?;
        let opened = paths.opened();
        let island = |h: HalfedgeId| opened.island(mesh.face(h));
        let is_on = |h: HalfedgeId| island(h) as usize == largest;
        let mut boundaries = vec![Vec::new(); islands.len()];
        opened.boundary_loops().iter().flatten().for_each(|&h| boundaries[island(h) as usize].push(h));
        let square = |k: usize| side(&convex_hull(boundaries[k].iter().map(|&h| at(map, h)).collect())).powi(2);
        let is_kept = |e: EdgeId| kept.is_some_and(|kept| kept[e]);
        let loops = Loops::new(mesh, opened);
        let within = |[one, other]: [u32; 2]| one == other;
        let mut chains = loops.chains(within, (island, is_kept), |h| map.position[h], lengths, map.extent());
        chains.retain(|chain| is_on(chain.sides[0]));
        watch.ask(f64::NAN)?;
        let cut = mesh.edges().filter(|&e| map.cut[e]).map(|e| lengths[e]);
        Ok(Some(Self {
            others: (0..islands.len()).filter(|&k| k != largest).map(square).sum(),
            boundary: std::mem::take(&mut boundaries[largest]),
            area: mesh.faces().map(|f| 0.5 * triangle::twice_area(map.triangle(f)).abs()).sum(),
            seam: cut.filter(|l| l.is_finite()).sum(),
            mesh,
            map,
            lengths,
            paths,
            sweep,
            chains,
        }))
    }

    /// The map after the best exchange; none if no exchange gains enough.
    fn exchanged(&self, aim: &Aim, watch: Watch) -> Result<Option<UvMap>, Interrupted> {
        let before = self.cost(aim, self.seam, &convex_hull(self.boundary.iter().map(|&h| at(self.map, h)).collect()));
        let across = self.spread(aim);
        watch.ask(f64::NAN)?;
        let found: Vec<Vec<Exchange>> = across.par_iter().map(|path| self.exchanges(path, aim, before)).collect();
        let mut exchanges: Vec<Exchange> = found.into_iter().flatten().collect();
        exchanges.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        exchanges.truncate(TESTED);
        watch.ask(f64::NAN)?;
        let boxes = Boxes::new(self.map.triangles());
        for exchange in &exchanges {
            watch.ask(f64::NAN)?;
            if let Some(made) = self.made(exchange, &boxes) {
                return Ok(Some(made.snapped(self.mesh, |made, h| made.agrees(self.map, h))));
            }
        }
        Ok(None)
    }

    fn cost(&self, aim: &Aim, seam: f64, hull: &[Complex64]) -> f64 {
        seam / aim.seam + aim.room * ((self.others + side(hull).powi(2)) / self.area).sqrt()
    }

    /// Short paths across the island, apart from each other.
    fn spread(&self, aim: &Aim) -> Vec<Across> {
        let longest = self.chains.iter().fold(0.0, |most: f64, chain| chain.length.max(most));
        let mut across = self.paths.across(&self.sweep, (aim.longest - self.seam).max(0.0) + longest, LEAST_SHARE);
        across.sort_by(|a, b| a.length.total_cmp(&b.length));
        let near = NEAR * self.map.extent();
        let mut chosen: Vec<Across> = Vec::new();
        for path in across {
            if chosen.iter().all(|other| other.distance(&path) > near) {
                chosen.push(path);
            }
            if chosen.len() == PATHS {
                break;
            }
        }
        chosen
    }

    /// What the seams offer in place of a path, as far as it gains enough.
    fn exchanges<'b>(&'b self, across: &'b Across, aim: &Aim, before: f64) -> Vec<Exchange<'b>> {
        let is_first = |h: HalfedgeId| across.is_first(&self.sweep, self.mesh.face(h));
        let ends = self.paths.edges(across).into_iter().flat_map(|e| {
            let h = self.mesh.halfedge(e);
            [at(self.map, h), at(self.map, self.mesh.next(h))]
        });
        let ends: Vec<Complex64> = ends.collect();
        let hull = |first: bool| {
            let on_side = self.boundary.iter().filter(|&&h| is_first(h) == Some(first));
            let points = on_side.flat_map(|&h| [at(self.map, h), at(self.map, self.mesh.next(h))]);
            convex_hull(points.chain(ends.iter().copied()).collect())
        };
        let [first, rest] = [true, false].map(hull);
        let mut found = Vec::new();
        for chain in &self.chains {
            // Which side of the path the halfedge is on, where its twin is on the other.
            let side = |h: &HalfedgeId| Some((is_first(*h)?, is_first(self.mesh.twin(*h)?)?)).filter(|(a, b)| a != b);
            for glued in chain.sides.chunk_by(|a, b| side(a) == side(b)) {
                let Some((is_first, _)) = side(&glued[0]) else { continue };
                let length: f64 = glued.iter().map(|&h| self.lengths[self.mesh.edge(h)]).sum();
                let seam = self.seam + across.length - length;
                if seam > aim.longest.max(self.seam) || seam / aim.seam + aim.room > before {
                    continue;
                }
                let motion = if is_first { chain.motion } else { chain.motion.inverse() };
                let moved = rest.iter().map(|z| {
                    let [x, y] = motion.of([z.re, z.im]);
                    Complex64::new(x, y)
                });
                let cost = self.cost(aim, seam, &convex_hull(first.iter().copied().chain(moved).collect()));
                if cost < before - LEAST_GAIN {
                    found.push(Exchange { across, glued, motion, cost });
                }
            }
        }
        found
    }

    /// The map after an exchange; none if the parts would lie over each other.
    fn made(&self, exchange: &Exchange, boxes: &Boxes) -> Option<UvMap> {
        let Exchange { across, glued, motion, .. } = exchange;
        let is_smaller = across.share < 0.5;
        let motion = if is_smaller { motion.inverse() } else { *motion };
        let is_moved = |f: FaceId| across.is_first(&self.sweep, f) == Some(is_smaller);
        let along = self.paths.edges(across);
        let beside = along.iter().flat_map(|&e| [Some(self.mesh.halfedge(e)), self.mesh.twin(self.mesh.halfedge(e))]);
        let outer = self.boundary.iter().copied().chain(beside.flatten()).map(|h| self.mesh.face(h));
        let outer: Vec<FaceId> = outer.filter(|&f| is_moved(f)).collect();
        let least = ALLOWED * NEGLIGIBLE_DEPTH * self.map.extent();
        let is_free = |f: &FaceId| {
            let Some(one) = boxes.upright(f.0).map(|corners| motion.of_triangle(corners)) else { return true };
            let mut is_free = true;
            boxes.meeting(&one, |g| {
                let is_still = across.is_first(&self.sweep, FaceId(g)) == Some(!is_smaller);
                if is_still && let Some(other) = boxes.upright(g) {
                    is_free = triangle::depth(&one, &other).is_none_or(|depth| depth <= least);
                }
                is_free
            });
            is_free
        };
        if !(0..STRIDE).flat_map(|first| outer.iter().skip(first).step_by(STRIDE)).all(is_free) {
            return None;
        }
        let mut map = self.map.clone();
        for f in self.mesh.faces().filter(|&f| is_moved(f)) {
            for h in self.mesh.sides(f) {
                map.position[h] = motion.of(map.position[h]);
            }
        }
        along.into_iter().for_each(|e| map.cut[e] = true);
        glued.iter().for_each(|&h| map.cut[self.mesh.edge(h)] = false);
        Some(map)
    }
}

fn at(map: &UvMap, h: HalfedgeId) -> Complex64 {
    let [x, y] = map.position[h];
    Complex64::new(x, y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flatten::flattened::Flattened;
    use crate::uv::{overlaps, separate};
    use geom::{VertexId, shapes};

    /// A surface flattened with cones that share its curvature evenly, taken apart.
    fn separated(shape: &shapes::Shape, cones: &[VertexId]) -> (Mesh, EdgeData<f64>, UvMap) {
        let Flattened { mesh, metric, seams, layout, .. } = Flattened::new(shape, cones);
        let position = mesh.halfedges().map(|h| [layout.corner(h).re, layout.corner(h).im]).collect();
        let map = UvMap { position, cut: seams.cut };
        let lengths = metric.lengths().clone();
        let done = separate(&mesh, &lengths, None, map, Watch::NONE).unwrap();
        (mesh, lengths, done.map)
    }

    fn seam(mesh: &Mesh, lengths: &EdgeData<f64>, map: &UvMap) -> f64 {
        mesh.edges().filter(|&e| map.cut[e]).map(|e| lengths[e]).sum()
    }

    /// The squares of the sides about all islands, added up.
    fn squares(mesh: &Mesh, map: &UvMap) -> f64 {
        let opened = map.opened(mesh);
        let mut points = vec![Vec::new(); opened.island_count()];
        mesh.halfedges().for_each(|h| points[opened.island(mesh.face(h)) as usize].push(at(map, h)));
        points.into_iter().map(|points| side(&convex_hull(points)).powi(2)).sum()
    }

    #[test]
    fn islands_stay_disks_of_the_same_triangles_and_take_less_room_or_shorter_seams() {
        let cones = |count: u32, step: u32| (0..count).map(|k| VertexId(7 + k * step)).collect::<Vec<_>>();
        let cases = [
            (shapes::hare(900), cones(8, 100)),
            (shapes::hare(900), cones(16, 53)),
            (shapes::torus(2, 800), cones(12, 60)),
            (shapes::terrain(900, 2), cones(9, 90)),
        ];
        let mut moved = 0;
        for (shape, cones) in cases {
            let (mesh, lengths, before) = separated(&shape, &cones);
            let length = seam(&mesh, &lengths, &before);
            let aim = Aim { seam: length, room: 0.5, longest: 1.1 * length, always: false };
            let after = exchange(&mesh, &lengths, None, before.clone(), &aim, Watch::NONE).unwrap();
            moved += usize::from(after != before);
            let [one, other] = [&before, &after].map(|map| map.opened(&mesh));
            assert_eq!(one.island_count(), other.island_count());
            assert_eq!(other.euler_characteristic(), other.island_count() as i64);
            assert_eq!(other.boundary_loops().len(), other.island_count());
            for island in 0..other.island_count() as u32 {
                let on_it: Vec<_> = mesh.faces().filter(|&f| other.island(f) == island).collect();
                let triangles: Vec<_> = on_it.into_iter().map(|f| after.triangle(f)).collect();
                assert!(overlaps(&triangles).pairs.is_empty());
            }
            for h in mesh.halfedges() {
                let span = |map: &UvMap| (at(map, mesh.next(h)) - at(map, h)).norm();
                assert!((span(&after) - span(&before)).abs() <= 1e-9 * before.extent());
                if let Some(g) = mesh.twin(h).filter(|_| !after.cut[mesh.edge(h)]) {
                    assert_eq!(after.position[h], after.position[mesh.next(g)]);
                }
            }
            let area: f64 = before.triangles().iter().map(|&t| 0.5 * triangle::twice_area(t)).sum();
            let cost = |map: &UvMap| seam(&mesh, &lengths, map) / length + 0.5 * (squares(&mesh, map) / area).sqrt();
            assert!(after == before || cost(&after) < cost(&before));
            assert!(seam(&mesh, &lengths, &after) <= aim.longest.max(length));
            let kept = EdgeData::constant(mesh.edge_count(), true);
            let still = exchange(&mesh, &lengths, Some(&kept), before.clone(), &aim, Watch::NONE).unwrap();
            assert_eq!(still, before, "what is kept open is not glued");
        }
        assert!(moved >= 2, "{moved}");
    }

    #[test]
    fn without_length_to_spare_and_without_worth_of_room_seams_only_get_shorter() {
        let cones: Vec<VertexId> = (0..16).map(|k| VertexId(7 + k * 53)).collect();
        let (mesh, lengths, before) = separated(&shapes::hare(900), &cones);
        let length = seam(&mesh, &lengths, &before);
        let aim = Aim { seam: length, room: 0.0, longest: 0.0, always: false };
        let after = exchange(&mesh, &lengths, None, before, &aim, Watch::NONE).unwrap();
        assert!(seam(&mesh, &lengths, &after) <= length);
    }
}
