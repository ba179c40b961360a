//! Cells glued together otherwise, so that there are few islands, short seams, and little room is taken.
//!
//! Which arcs are glued is a forest, and each forest in which no two cells of a tree overlap is a map ([`cells`](super::cells)). The search takes
//! what is there apart in one place (*ruin*): a few cells next to each other, or limbs where they are glued on. What has come apart is glued
//! again (*recreate*), longest arcs first, their lengths times a random factor (Schrimpf, Schneider, Stamm-Wilbrandt & Dueck 2000, *Record
//! breaking optimization results using the ruin and recreate principle*). It goes on with what is not much worse, less and less so (threshold
//! accepting; Dueck & Scheuer 1990), and the best that it came by is kept.
//!
//! Nothing of a step depends on how many triangles there are, but for pairs of cells that have not met in such a way before.

use std::ops::Range;

use geom::{EdgeData, HalfedgeId, Interrupted, Mesh, Watch, kruskal};
use rayon::prelude::*;

use super::boxes::{Bounds, meet, moved_bounds};
use super::cells::{Cells, Known, QUARTER, SeamRoom};
use super::divide::SLIVER;
use super::map::UvMap;
use super::motion::Motion;

/// So many steps are made for each cell,
const STEPS_A_CELL: usize = 60;
/// and so many at most. On 13 layouts of 8 to 64 cones 4,000 fill .48 to .51, as the dice fall, 16,000 .53, with as many islands and as long seams.
const STEPS: usize = 8000;
/// For all parts of a model so many, each its share of the area, but no fewer for a cell than this: on 48 models of more than 5 parts the stage
/// takes .64 of the time, all of it .89; seams .04 % shorter, fill .0002 more, 15,268 islands for 15,234.
const MODEL_STEPS: f64 = 200_000.0;
const FEWEST_A_CELL: usize = 15;
/// With more than 707 cells fewer, since each step compares cells: steps times the square of that are so many at most.
const MOST_WORK: usize = 4_000_000_000;
/// Rooms are whole multiples of this share of the side of all triangles' area, so that rounding decides nothing.
const ROOMS: f64 = 4096.0;
/// So often it is searched, each time with other dice, for the best. On 136 layouts the cost is .9 % less than with one search, with four 1.4 %; one
/// of twice as many steps gains .1 %.
pub(crate) const SEARCHES: u64 = 2;
/// Of more cells nothing is sought.
const MOST_CELLS: usize = 4000;
/// By so much may the next map be worse than the one before at first, as a cost. With 0.02 a tenth more islands are left, with 0.1 seams are 1 %
/// longer.
const PATIENCE: f64 = 0.05;
/// Costs that differ by less are those of one map, found in two ways.
const SAME_COST: f64 = 1e-6;
/// So many cells next to each other are taken apart at most,
const MOST_RUINED: u64 = 12;
/// or so many limbs.
const MOST_LIMBS: u64 = 3;
/// The bounding box of nothing: it meets no other.
const NOWHERE: Bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
/// By so much more than its length may an arc count.
const VARIATIONS: [f64; 4] = [0.0, 0.5, 2.0, 8.0];

/// What a map is like.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Figures {
    /// Its islands, those of a few triangles three times.
    pub(crate) islands: usize,
    /// What its seams cost, added up,
    pub(crate) seam: f64,
    /// and how long they are.
    pub(crate) length: f64,
    /// The side of a square of the area of those about its islands.
    pub(crate) room: f64,
}

/// Puts a map together otherwise of which no island overlaps itself. `network` are the edges along which it may be open, and must hold those
/// along which it is; `seam` is what a run of seam costs, and its length. Less of `cost` is better, which should be about 1 and not
/// fall where one of the figures grows. `share` is that of the model's area, for which less is tried, and
/// there is a search for each of the `dice`. None if nothing better is found.
///
/// # Errors
/// If it is stopped.
pub(super) fn rearranged(
    (mesh, kept): (&Mesh, Option<&EdgeData<bool>>),
    map: &UvMap,
    network: &EdgeData<bool>,
    (seam, cost, share, dice): (
        impl Fn(&[HalfedgeId]) -> [f64; 2] + Send,
        impl Fn(Figures) -> f64 + Sync,
        f64,
        Range<u64>,
    ),
    watch: Watch,
) -> Result<Option<UvMap>, Interrupted> {
    let cells = Cells::new((mesh, kept), seam, map, network);
    watch.ask(0.0)?;
    if cells.count() > MOST_CELLS {
        return Ok(None);
    }
    let start = Forest::of(&cells, mesh, &map.cut);
    let before = cost(start.figures(&cells, &mut Memory::new(&cells)));
    let found = dice.into_par_iter().map(|k| {
        let search = Search { cells: &cells, cost: &cost, random: Random(k), memory: Memory::new(&cells) };
        search.run((before, start.clone()), steps(cells.count(), share), watch)
    });
    let found = found.collect::<Result<Vec<_>, _>>()?;
    let best = found.into_iter().filter(|(cost, _)| *cost < before).min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, best)) = best else { return Ok(None) };
    let moved = cells.moved(mesh, cells.seams(best.is_open(), &mut SeamRoom::default()), best.motion);
    drop(cells);
    Ok(Some(moved.snapped(mesh, map.clone())))
}

/// How many steps are made for so many cells, which have a share of a model's area.
fn steps(cells: usize, share: f64) -> usize {
    let of_model = (MODEL_STEPS * share) as usize;
    (STEPS_A_CELL * cells).min(STEPS).min(MOST_WORK / cells.max(1).pow(2)).min(of_model.max(FEWEST_A_CELL * cells))
}

/// Cells that are glued to each other.
#[derive(Clone, Debug)]
struct Forest {
    /// Whether an arc is an edge of it.
    is_glued: Vec<bool>,
    /// Where cells are.
    motion: Vec<Motion>,
    placed: Vec<Bounds>,
    /// The island of each cell, named by one of its cells.
    island: Vec<u32>,
    /// The next cell of the same island, in a ring.
    next: Vec<u32>,
    /// The area of each island and how many triangles it has, at the cell that it is named by.
    area: Vec<f64>,
    size: Vec<usize>,
    /// The island that each cell was on before arcs were taken apart,
    was_on: Vec<u32>,
    /// and what has moved all of an island since; none if it is no longer as it was.
    since: Vec<Option<Motion>>,
}

impl Forest {
    /// The cells of a map as they lie, which is open along some of the arcs.
    fn of(cells: &Cells, mesh: &Mesh, cut: &EdgeData<bool>) -> Self {
        let count = cells.count();
        let closed = cells.arcs.iter().zip(0..).filter(|(arc, _)| arc.motion.is_some() && arc.is_closed(mesh, cut));
        let mut is_glued = vec![false; cells.arcs.len()];
        for k in kruskal(count, closed.map(|(arc, k)| (k, arc.cells))) {
            is_glued[k] = true;
        }
        let mut forest = Self {
            is_glued,
            motion: vec![Motion::NONE; count],
            placed: cells.bounds.iter().map(|bounds| bounds.unwrap_or(NOWHERE)).collect(),
            island: vec![0; count],
            next: vec![0; count],
            area: vec![0.0; count],
            size: vec![0; count],
            was_on: vec![0; count],
            since: vec![None; count],
        };
        forest.find_islands(cells, &mut Vec::new());
        forest
    }

    /// Becomes another one, but for what [`ruin`](Self::ruin) finds anew, and without asking for room, which takes longer than most of a step.
    fn copy(&mut self, from: &Self) {
        self.is_glued.clone_from(&from.is_glued);
        self.motion.clone_from(&from.motion);
        self.placed.clone_from(&from.placed);
        self.island.clone_from(&from.island);
    }

    /// Takes arcs apart.
    fn ruin(&mut self, cells: &Cells, arcs: &[u32], memory: &mut Memory) {
        arcs.iter().for_each(|&k| self.is_glued[k as usize] = false);
        self.find_islands(cells, &mut memory.found);
    }

    fn find_islands(&mut self, cells: &Cells, found: &mut Vec<u32>) {
        const NONE: u32 = u32::MAX;
        std::mem::swap(&mut self.island, &mut self.was_on);
        self.island.fill(NONE);
        self.since.fill(Some(Motion::NONE));
        for root in 0..cells.count() as u32 {
            if self.island[root as usize] != NONE {
                continue;
            }
            self.island[root as usize] = root;
            found.clear();
            found.push(root);
            let (mut area, mut size) = (0.0, 0);
            let mut at = 0;
            while at < found.len() {
                let c = found[at];
                at += 1;
                area += cells.area[c as usize];
                size += cells.size[c as usize];
                for &(k, other) in cells.around.row(c as usize) {
                    if self.is_glued[k as usize] && self.island[other as usize] == NONE {
                        self.island[other as usize] = root;
                        self.next[found[found.len() - 1] as usize] = other;
                        found.push(other);
                    }
                }
            }
            self.next[found[found.len() - 1] as usize] = root;
            self.area[root as usize] = area;
            self.size[root as usize] = size;
        }
    }

    /// The cells of the island that a cell is on, from that cell on.
    fn island_of(&self, c: u32) -> impl Iterator<Item = u32> {
        let mut next = Some(c);
        std::iter::from_fn(move || {
            let here = next?;
            next = Some(self.next[here as usize]).filter(|&next| next != c);
            Some(here)
        })
    }

    /// One cell of each island.
    fn islands(&self) -> impl Iterator<Item = u32> {
        self.island.iter().zip(0..).filter(|&(&name, c)| name == c).map(|(_, c)| c)
    }

    /// Glues an arc if its cells are on two islands that do not come to lie over each other.
    fn glue(&mut self, cells: &Cells, k: u32, Memory { known, moved, in_the_way, .. }: &mut Memory) {
        let arc = &cells.arcs[k as usize];
        let [left, right] = arc.cells.map(|c| self.island[c as usize] as usize);
        if left == right {
            return;
        }
        let still = arc.cells[usize::from(self.area[left] < self.area[right])];
        let Some((c, motion)) = arc.beyond(still) else { return };
        let motion = self.motion[still as usize].after(&motion).after(&self.motion[c as usize].inverse());
        let [small, large] = [c, still].map(|c| self.island[c as usize]);
        let since = self.since_both(cells, [c, still], &motion);
        moved.clear();
        if since.is_none() || !cells.is_same(&motion, &Motion::NONE) {
            let placed = |p: u32| {
                let motion = motion.after(&self.motion[p as usize]);
                (p, motion, cells.bounds[p as usize].map_or(NOWHERE, |bounds| moved_bounds(bounds, &motion)))
            };
            // What lies as it did does not overlap.
            let mut overlap = |(p, motion, bounds): &(u32, Motion, Bounds), q: u32| {
                since.is_none()
                    && meet(bounds, &self.placed[q as usize])
                    && cells.overlap([*p, q], [motion, &self.motion[q as usize]], known)
            };
            let in_the_way = &mut in_the_way[k as usize];
            for [p, q] in [*in_the_way, [in_the_way[1], in_the_way[0]]] {
                if self.island[p as usize] == small && self.island[q as usize] == large && overlap(&placed(p), q) {
                    return;
                }
            }
            for p in self.island_of(c) {
                let placed = placed(p);
                if let Some(q) = self.island_of(still).find(|&q| overlap(&placed, q)) {
                    *in_the_way = [p, q];
                    return;
                }
                moved.push(placed);
            }
        }
        for &(p, motion, bounds) in &*moved {
            self.motion[p as usize] = motion;
            self.placed[p as usize] = bounds;
        }
        let mut p = c;
        while self.island[p as usize] != large {
            self.island[p as usize] = large;
            p = self.next[p as usize];
        }
        self.since[large as usize] = since;
        // Two rings become one.
        self.next.swap(c as usize, still as usize);
        self.area[large as usize] += self.area[small as usize];
        self.size[large as usize] += self.size[small as usize];
        self.is_glued[k as usize] = true;
    }

    /// What has moved both islands of two cells since they were one, if they lie to each other as they did once that of the first is moved.
    fn since_both(&self, cells: &Cells, [c, still]: [u32; 2], motion: &Motion) -> Option<Motion> {
        let [one, other] = [c, still].map(|c| self.since[self.island[c as usize] as usize]);
        let were_one = self.was_on[c as usize] == self.was_on[still as usize];
        other.filter(|other| were_one && one.is_some_and(|one| cells.is_same(&motion.after(&one), other)))
    }

    /// Whether each arc is not glued.
    fn is_open(&self) -> impl Iterator<Item = bool> {
        self.is_glued.iter().map(|glued| !glued)
    }

    /// What is found at once: the room is only not less than this, as much as the islands cover.
    fn figures_without_room(&self, cells: &Cells, memory: &mut Memory) -> Figures {
        let open = cells.seams(self.is_open(), &mut memory.seams);
        let (mut seam, mut length) = (0.0, 0.0);
        for (arc, _) in cells.arcs.iter().zip(open).filter(|(_, open)| **open) {
            seam += arc.cost;
            length += arc.length;
        }
        let is_sliver = |c: u32| self.size[c as usize] < SLIVER as usize;
        let islands = self.islands().map(|c| if is_sliver(c) { 3 } else { 1 }).sum();
        Figures { islands, seam, length, room: cells.whole.sqrt() }
    }

    fn figures(&self, cells: &Cells, memory: &mut Memory) -> Figures {
        let figures = self.figures_without_room(cells, memory);
        Figures { room: self.room(cells, memory), ..figures }
    }

    fn room(&self, cells: &Cells, memory: &mut Memory) -> f64 {
        let room = self.islands().map(|c| self.side(cells, c, memory).powi(2)).sum::<f64>().sqrt();
        let step = cells.whole.sqrt() / ROOMS;
        if step > 0.0 { (room / step).round() * step } else { room }
    }

    /// The side of the smallest square about a cell's island in one of some directions.
    fn side(&self, cells: &Cells, c: u32, memory: &mut Memory) -> f64 {
        let mut island = Reach::NONE;
        self.island_of(c).for_each(|c| island.include(memory.reach(cells, c, &self.motion[c as usize])));
        let extent = |k: usize| island.farthest[k] - island.nearest[k];
        let side = (0..QUARTER).map(|k| extent(k).max(extent(k + QUARTER))).fold(f64::MAX, f64::min);
        side.max(0.0)
    }
}

/// How far something reaches in each of some directions, and in the opposite ones.
#[derive(Clone, Copy)]
struct Reach {
    farthest: [f64; 2 * QUARTER],
    nearest: [f64; 2 * QUARTER],
}

impl Reach {
    const NONE: Self = Self { farthest: [f64::MIN; 2 * QUARTER], nearest: [f64::MAX; 2 * QUARTER] };

    fn of(cells: &Cells, c: u32, Motion { turn, shift }: &Motion) -> Self {
        let mut reach = Self::NONE;
        for z in &cells.extremes[c as usize] {
            let z = turn * z + shift;
            let at = cells.directions.map(|[cos, sin]| cos * z.re + sin * z.im);
            reach.include(&Self { farthest: at, nearest: at });
        }
        reach
    }

    fn include(&mut self, other: &Self) {
        // Of `f64::max` more is asked where something is no number, which takes longer.
        for (one, &other) in self.farthest.iter_mut().zip(&other.farthest) {
            *one = if *one < other { other } else { *one };
        }
        for (one, &other) in self.nearest.iter_mut().zip(&other.nearest) {
            *one = if *one > other { other } else { *one };
        }
    }
}

/// What is kept from step to step.
struct Memory {
    known: Known,
    /// Room for cells that are moved,
    moved: Vec<(u32, Motion, Bounds)>,
    /// for those of an island,
    found: Vec<u32>,
    /// for arcs that may be glued,
    arcs: Vec<(f64, u32)>,
    /// and for seams.
    seams: SeamRoom,
    /// How far each cell reaches where it was of late, the last first: most of a step's cells have not moved, or move back.
    reach: Vec<[(Motion, Reach); 2]>,
    /// Two cells that lay over each other when an arc was to be glued: they often do so again.
    in_the_way: Vec<[u32; 2]>,
}

impl Memory {
    fn new(cells: &Cells) -> Self {
        let reach =
            (0..cells.count() as u32).map(|c| [(Motion::NONE, Reach::of(cells, c, &Motion::NONE)); 2]).collect();
        let in_the_way = vec![[0; 2]; cells.arcs.len()];
        Self {
            known: Known::default(),
            moved: Vec::new(),
            found: Vec::new(),
            arcs: Vec::new(),
            seams: SeamRoom::default(),
            reach,
            in_the_way,
        }
    }

    fn reach(&mut self, cells: &Cells, c: u32, motion: &Motion) -> &Reach {
        let [last, before] = &mut self.reach[c as usize];
        if last.0 != *motion {
            std::mem::swap(last, before);
        }
        if last.0 != *motion {
            *last = (*motion, Reach::of(cells, c, motion));
        }
        &last.1
    }
}

struct Search<'a, C> {
    cells: &'a Cells<'a>,
    cost: C,
    random: Random,
    memory: Memory,
}

impl<C: Fn(Figures) -> f64> Search<'_, C> {
    /// The best forest of so many steps and its cost, from one with its cost.
    fn run(mut self, start: (f64, Forest), steps: usize, watch: Watch) -> Result<(f64, Forest), Interrupted> {
        let mut at = start;
        let mut best = at.clone();
        let mut next = at.1.clone();
        for step in 0..steps {
            let done = step as f64 / steps as f64;
            watch.ask(done)?;
            let arcs = self.chosen(&at.1);
            next.copy(&at.1);
            next.ruin(self.cells, &arcs, &mut self.memory);
            self.recreate(&mut next);
            // Every second time it comes back as it was.
            if next.is_glued == at.1.is_glued && next.motion == at.1.motion {
                continue;
            }
            let most = at.0 + PATIENCE * (1.0 - done).powi(2);
            let mut figures = next.figures_without_room(self.cells, &mut self.memory);
            if (self.cost)(figures) > most {
                continue;
            }
            figures.room = next.room(self.cells, &mut self.memory);
            let cost = (self.cost)(figures);
            if cost <= most {
                at.0 = cost;
                std::mem::swap(&mut at.1, &mut next);
                if at.0 < best.0 - SAME_COST {
                    best.0 = at.0;
                    best.1.copy(&at.1);
                }
            }
        }
        Ok(best)
    }

    /// What is to be taken apart: the arcs of some limbs, or about some cells next to each other.
    fn chosen(&mut self, forest: &Forest) -> Vec<u32> {
        let cells = self.cells;
        let is_glued = |k: &u32| forest.is_glued[*k as usize];
        if self.random.below(2) == 0 {
            let glued = || (0..cells.arcs.len() as u32).filter(is_glued);
            let count = glued().count() as u64;
            let limbs = if count == 0 { 0 } else { 1 + self.random.below(MOST_LIMBS) };
            return (0..limbs).filter_map(|_| glued().nth(self.random.below(count) as usize)).collect();
        }
        let count = cells.count() as u64;
        let size = 1 + self.random.below(count.min(MOST_RUINED)) as usize;
        let mut near = vec![self.random.below(count) as u32];
        let mut at = 0;
        while at < near.len() {
            for &(_, other) in cells.around.row(near[at] as usize) {
                if near.len() < size && !near.contains(&other) {
                    near.push(other);
                }
            }
            at += 1;
        }
        near.iter().flat_map(|&c| cells.around.row(c as usize).iter().map(|&(k, _)| k).filter(is_glued)).collect()
    }

    /// Glues what can be glued.
    fn recreate(&mut self, forest: &mut Forest) {
        let variation = VARIATIONS[self.random.below(VARIATIONS.len() as u64) as usize];
        let mut arcs = std::mem::take(&mut self.memory.arcs);
        arcs.clear();
        for (arc, k) in self.cells.arcs.iter().zip(0..) {
            let [left, right] = arc.cells.map(|c| forest.island[c as usize]);
            if left != right && arc.motion.is_some() {
                arcs.push((arc.cost * (1.0 + variation * self.random.unit()), k));
            }
        }
        arcs.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        arcs.iter().for_each(|&(_, k)| forest.glue(self.cells, k, &mut self.memory));
        self.memory.arcs = arcs;
    }
}

/// Numbers that look random (`SplitMix64`; Steele, Lea & Flood 2014), the same in each run.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: u64) -> u64 {
        self.bits() % count
    }

    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;
    use crate::flatten::flattened::Flattened;
    use crate::uv::pack::convex_hull;
    use crate::uv::separate::{add_necks, overlaps_on_islands, taken_apart};
    use crate::uv::{Triangle, overlaps, triangle};
    use geom::{EdgeId, Id, VertexId, shapes};
    use num_complex::Complex64;

    /// A surface flattened with cones that share its curvature evenly, taken apart, and a network of cuts.
    fn apart(shape: &shapes::Shape, cones: &[VertexId]) -> (Mesh, EdgeData<f64>, UvMap, EdgeData<bool>) {
        let Flattened { mesh, metric, seams, layout, .. } = Flattened::new(shape, cones);
        let position = mesh.halfedges().map(|h| [layout.corner(h).re, layout.corner(h).im]).collect();
        let lengths = metric.lengths().clone();
        let map = UvMap { position, cut: seams.cut.clone() };
        let overlaps = overlaps_on_islands(&mesh, &map, Watch::NONE).unwrap();
        let (done, mut network) = taken_apart((&mesh, &lengths, None), (map, overlaps), Watch::NONE).unwrap();
        add_necks((&mesh, &lengths), &done.map, &mut network, |_| true, Watch::NONE).unwrap();
        (mesh, lengths, done.map, network)
    }

    fn seam(mesh: &Mesh, lengths: &EdgeData<f64>, map: &UvMap) -> f64 {
        mesh.edges().filter(|&e| map.cut[e]).map(|e| lengths[e]).sum()
    }

    fn sum<'a>(mesh: &'a Mesh, lengths: &'a EdgeData<f64>) -> impl Fn(&[HalfedgeId]) -> [f64; 2] + 'a {
        |run| [run.iter().map(|&h| lengths[mesh.edge(h)]).sum(); 2]
    }

    fn cases() -> impl Iterator<Item = (shapes::Shape, Vec<VertexId>)> {
        let cones = |count: u32, step: u32| (0..count).map(|k| VertexId(7 + k * step)).collect::<Vec<_>>();
        [
            (shapes::hare(900), cones(8, 100)),
            (shapes::hare(900), cones(16, 53)),
            (shapes::torus(2, 800), cones(12, 60)),
            (shapes::terrain(900, 2), cones(9, 90)),
        ]
        .into_iter()
    }

    #[test]
    fn islands_stay_disks_of_the_same_triangles_that_lie_beside_each_other_and_cost_less() {
        for (shape, cones) in cases() {
            let (mesh, lengths, done, network) = apart(&shape, &cones);
            let length = seam(&mesh, &lengths, &done);
            // Each cell an island of its own.
            let before = UvMap { position: done.position.clone(), cut: network.clone() };
            let least = Mutex::new(f64::INFINITY);
            let cost = |figures: Figures| figures.islands as f64 + figures.seam / length;
            let counted = |figures: Figures| {
                let cost = cost(figures);
                let mut least = least.lock().unwrap();
                *least = least.min(cost);
                cost
            };
            let after = rearranged(
                (&mesh, None),
                &before,
                &network,
                (sum(&mesh, &lengths), counted, 1.0, 0..SEARCHES),
                Watch::NONE,
            )
            .unwrap();
            let after = after.expect("it is better than single cells");
            let [done, other] = [&done, &after].map(|map| map.opened(&mesh));
            assert!(other.island_count() <= done.island_count(), "it is as good as what cuts leave");
            assert_eq!(other.euler_characteristic(), other.island_count() as i64);
            assert_eq!(other.boundary_loops().len(), other.island_count());
            let sizes: Vec<usize> = (0..other.island_count() as u32)
                .map(|island| {
                    let on_it = mesh.faces().filter(|&f| other.island(f) == island);
                    let triangles: Vec<Triangle> = on_it.map(|f| after.triangle(f)).collect();
                    assert!(overlaps(&triangles).pairs.is_empty());
                    triangles.len()
                })
                .collect();
            let slivers = sizes.iter().filter(|&&size| size < SLIVER as usize).count();
            let seam = seam(&mesh, &lengths, &after);
            let figures = Figures { islands: sizes.len() + 2 * slivers, seam, length: seam, room: 0.0 };
            assert!((cost(figures) - *least.lock().unwrap()).abs() < 1e-3, "it costs what was counted");
            for h in mesh.halfedges() {
                let span = |map: &UvMap| {
                    let [[x, y], [z, w]] = [h, mesh.next(h)].map(|h| map.position[h]);
                    (x - z).hypot(y - w)
                };
                assert!((span(&after) - span(&before)).abs() <= 1e-9 * before.extent());
                if let Some(g) = mesh.twin(h).filter(|_| !after.cut[mesh.edge(h)]) {
                    assert_eq!(after.position[h], after.position[mesh.next(g)]);
                }
            }
            assert!(mesh.edges().all(|e| network[e] || !after.cut[e]), "it is open along the network only");
        }
    }

    #[test]
    fn paths_across_begin_and_end_where_the_map_is_open_and_only_islands_asked_for_are_crossed() {
        let (shape, cones) = cases().nth(1).unwrap();
        let (mesh, lengths, map, _) = apart(&shape, &cones);
        let [mut none, mut all] = [map.cut.clone(), map.cut.clone()];
        add_necks((&mesh, &lengths), &map, &mut none, |_| false, Watch::NONE).unwrap();
        assert_eq!(none, map.cut);
        add_necks((&mesh, &lengths), &map, &mut all, |_| true, Watch::NONE).unwrap();
        let [before, after] = [&map.cut, &all].map(|network| geom::CutMesh::open(&mesh, network));
        assert!(after.island_count() > before.island_count() + 10, "{}", after.island_count());
        assert_eq!(after.euler_characteristic(), after.island_count() as i64, "cells are disks");
    }

    #[test]
    fn parts_share_the_steps_of_their_model() {
        assert_eq!([steps(50, 1.0), steps(200, 1.0), steps(200, 0.1)], [50 * STEPS_A_CELL, STEPS, STEPS]);
        assert_eq!(50 * steps(200, 0.02), MODEL_STEPS as usize);
        assert_eq!([steps(200, 1e-6), steps(4, 0.0)], [200 * FEWEST_A_CELL, 4 * FEWEST_A_CELL]);
    }

    #[test]
    fn what_is_kept_stays_open() {
        let (shape, cones) = cases().nth(1).unwrap();
        let (mesh, lengths, before, network) = apart(&shape, &cones);
        let kept: EdgeData<bool> = mesh.edges().map(|e: EdgeId| before.cut[e] && e.index().is_multiple_of(3)).collect();
        let cost = |figures: Figures| figures.islands as f64 + figures.seam;
        let after = rearranged(
            (&mesh, Some(&kept)),
            &before,
            &network,
            (sum(&mesh, &lengths), cost, 1.0, 0..SEARCHES),
            Watch::NONE,
        )
        .unwrap();
        let after = after.unwrap_or(before);
        assert!(mesh.edges().all(|e| after.cut[e] || !kept[e]));
    }

    #[test]
    fn cells_overlap_where_their_triangles_do_wherever_they_are_moved() {
        let (shape, cones) = cases().nth(1).unwrap();
        let (mesh, lengths, map, network) = apart(&shape, &cones);
        let cells = Cells::new((&mesh, None), sum(&mesh, &lengths), &map, &network);
        let triangles = |c: u32| -> Vec<Triangle> {
            mesh.faces().filter(|&f| cells.cell[f] == c).map(|f| map.triangle(f)).collect()
        };
        let mut random = Random(5);
        let mut known = Known::default();
        let mut found = [0, 0];
        for _ in 0..400 {
            let [p, q] = [0; 2].map(|_| random.below(cells.count() as u64) as u32);
            if p == q {
                continue;
            }
            let turn = Complex64::from_polar(1.0, 6.3 * random.unit());
            // Somewhere near the other one.
            let [from, to] = [p, q].map(|c| cells.extremes[c as usize][0]);
            let off = Complex64::new(random.unit() - 0.5, random.unit() - 0.5) * 0.15 * map.extent();
            let motion = Motion { turn, shift: to + off - turn * from };
            let (moved, still) = (triangles(p), triangles(q));
            let expected = moved.iter().any(|&one| {
                let one = triangle::upright(motion.of_triangle(one)).unwrap();
                still.iter().any(|&other| {
                    let other = triangle::upright(other).unwrap();
                    triangle::depth(&one, &other).is_some_and(|depth| depth > 1e-9 * map.extent())
                })
            });
            assert_eq!(cells.overlap([p, q], [&motion, &Motion::NONE], &mut known), expected);
            assert_eq!(cells.overlap([q, p], [&Motion::NONE, &motion], &mut known), expected);
            found[usize::from(expected)] += 1;
        }
        assert!(found[0] > 50 && found[1] > 50, "{found:?}");
    }

    #[test]
    fn a_cell_within_another_one_overlaps_it_though_their_boundaries_are_apart() {
        let (shape, cones) = cases().nth(1).unwrap();
        let (mesh, lengths, map, network) = apart(&shape, &cones);
        let cells = Cells::new((&mesh, None), sum(&mesh, &lengths), &map, &network);
        let smallest = cells.count() as u32 - 1;
        let turn = Complex64::from_polar(1.0, 0.3);
        let deep = mesh.faces().filter(|&f| cells.cell[f] == 0).filter(|&f| {
            let middle = map.triangle(f).iter().fold(Complex64::ZERO, |z, p| z + Complex64::new(p[0], p[1]) / 3.0);
            let motion = Motion { turn, shift: middle - turn * cells.extremes[smallest as usize][0] };
            let moves = [&motion, &Motion::NONE];
            let (touches, overlaps) =
                (cells.touch([smallest, 0], &motion), cells.overlap([smallest, 0], moves, &mut Known::default()));
            assert!(overlaps, "a corner of it is in the middle of a triangle");
            !touches
        });
        assert!(deep.count() > 3);
    }

    #[test]
    fn room_and_size_are_those_of_the_cells_whatever_was_kept_from_earlier_steps() {
        let (shape, cones) = cases().nth(1).unwrap();
        let (mesh, lengths, map, network) = apart(&shape, &cones);
        let cells = Cells::new((&mesh, None), sum(&mesh, &lengths), &map, &network);
        let mut forest = Forest::of(&cells, &mesh, &map.cut);
        let mut search = Search { cells: &cells, cost: |_| 0.0, random: Random(3), memory: Memory::new(&cells) };
        let mut rooms = Vec::new();
        for _ in 0..50 {
            let arcs = search.chosen(&forest);
            forest.ruin(&cells, &arcs, &mut search.memory);
            search.recreate(&mut forest);
            rooms.push(forest.room(&cells, &mut search.memory));
            assert_eq!(rooms.last(), Some(&forest.room(&cells, &mut Memory::new(&cells))));
            for c in forest.islands() {
                let size: usize = forest.island_of(c).map(|c| cells.size[c as usize]).sum();
                assert_eq!(forest.size[c as usize], size);
            }
        }
        assert!(rooms.iter().any(|&room| room != rooms[0]));
    }

    #[test]
    fn room_is_that_of_a_square_about_all_corners_and_length_that_of_the_seams() {
        let (shape, cones) = cases().next().unwrap();
        let (mesh, lengths, map, network) = apart(&shape, &cones);
        let cells = Cells::new((&mesh, None), sum(&mesh, &lengths), &map, &network);
        let figures = Forest::of(&cells, &mesh, &map.cut).figures(&cells, &mut Memory::new(&cells));
        let opened = map.opened(&mesh);
        let mut points = vec![Vec::new(); opened.island_count()];
        mesh.halfedges().for_each(|h| {
            points[opened.island(mesh.face(h)) as usize].push(Complex64::new(map.position[h][0], map.position[h][1]));
        });
        let room = crate::uv::room(points.into_iter().map(convex_hull).collect());
        assert!((figures.room / room - 1.0).abs() < 0.04, "{room} {}", figures.room);
        let seam = seam(&mesh, &lengths, &map);
        assert!((figures.seam / seam - 1.0).abs() < 1e-3 && (figures.length / seam - 1.0).abs() < 1e-12);
    }
}
