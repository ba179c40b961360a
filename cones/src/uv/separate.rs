//! A map taken apart until nothing lies over itself, and put together again as far as that goes.
//!
//! Overlapping pairs within an island are found once ([`overlap`](super::overlap)); cuts part them ([`divide`](super::divide)), which moves
//! nothing and so makes no new ones; what was cut off is attached elsewhere ([`attach`](super::attach)), which is tested where
//! something moved. Which cuts are best depends on what can be attached afterwards, so several preferences are tried while the
//! result is not one island, and the best is kept: few islands, no slivers, short seams. Islands may still lie over *each other*:
//! that is for whoever places them.
//!
//! An island without overlap keeps its positions to the bit, and so does the largest piece of each other island.

use geom::{CutMesh, EdgeData, FaceId, Interrupted, Mesh, Watch};
use rayon::prelude::*;

use super::attach::{Moved, Pieces};
use super::boxes::Boxes;
use super::chains::Chain;
use super::divide::{Divider, Pair, Preference, SLIVER, divide};
use super::exchange::{Aim, exchange};
use super::immersion::overlaps_of_immersion;
use super::map::UvMap;
use super::overlap::{NEGLIGIBLE_DEPTH, Overlap, Overlaps, overlaps_watched};

/// What is tried. Of 48 such preferences these four give the fewest islands on 105 layouts that lie over themselves: each alone
/// leaves one island on 41 to 48 of them, all four together on 60.
const PREFERENCES: [Preference; 4] = [
    Preference { within_overlap: 3.0, power: 1.0, least_share: 0.0 },
    Preference { within_overlap: 3.0, power: 0.3, least_share: 0.03 },
    Preference { within_overlap: 1.0, power: 1.0, least_share: 0.03 },
    Preference { within_overlap: 10.0, power: 1.0, least_share: 0.01 },
];
/// What is tried besides where several islands are left, or long seams: on face and beetle with 8 to 32 cones, whose boundaries are long,
/// these four of 36 more leave fewest.
const INSISTENT: [Preference; 4] = [
    Preference { within_overlap: 1.0, power: 0.6, least_share: 0.03 },
    Preference { within_overlap: 1.0, power: 1.0, least_share: 0.01 },
    Preference { within_overlap: 1.0, power: 1.5, least_share: 0.01 },
    Preference { within_overlap: 10.0, power: 1.5, least_share: 0.0 },
];
/// What is tried where islands were glued all the same.
const GLUED: [Preference; 2] = [
    Preference { within_overlap: 3.0, power: 1.0, least_share: 0.0 },
    Preference { within_overlap: 10.0, power: 0.3, least_share: 0.0 },
];
/// So many triangles are gone through in search of fewer islands.
const TRIANGLES: usize = 400_000;
/// So often at most is another gluing tried.
const MOST_RUNS: usize = 48;
/// So many at the same time, of which the best is taken.
const AT_ONCE: usize = 8;
/// A gluing that was tried without gain counts as so much seam.
const PATIENCE: f64 = 0.01;
/// A gluing that brings about more pairs for each triangle is not tried.
const MOST_PAIRS: usize = 4;

/// A map whose islands do not lie over themselves.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Separation {
    /// The map.
    pub map: UvMap,
    /// The pairs of triangles on one island that lay over each other.
    pub overlaps: Overlaps,
    /// How much longer the seams are now, in the unit of the lengths given.
    pub added_seam: f64,
    /// The pairs that could not be parted, as triangles of one polygon cannot.
    pub left: Overlaps,
}

/// Takes a map apart and puts it together again until no island lies over itself. Edges of infinite length are not cut. `lengths`
/// are those of the edges in space; what is `kept` open is not glued. A map without overlap comes back as it is, to the bit.
///
/// O(n log n), and O(n + pairs) for each cut.
///
/// # Errors
/// If it is stopped.
pub fn separate(
    mesh: &Mesh,
    lengths: &EdgeData<f64>,
    kept: Option<&EdgeData<bool>>,
    map: UvMap,
    watch: Watch,
) -> Result<Separation, Interrupted> {
    let mut done = separate_by(mesh, lengths, kept, map, Effort::Thorough, watch.within(0.0, 0.9))?;
    done.look(mesh, watch.within(0.9, 1.0))?;
    Ok(done)
}

/// A map with its islands put together where their sides are congruent and nothing comes to lie over each other. Islands that
/// overlap themselves still do. O(n log n).
///
/// # Errors
/// If it is stopped.
pub(crate) fn attached(
    mesh: &Mesh,
    lengths: &EdgeData<f64>,
    kept: Option<&EdgeData<bool>>,
    map: UvMap,
    watch: Watch,
) -> Result<UvMap, Interrupted> {
    let boxes = Boxes::new(map.triangles());
    let mut pieces = Pieces::new((mesh, lengths, kept), &map, &boxes, map.cut.clone());
    pieces.attach(watch)?;
    let moved = pieces.moved();
    Ok(moved.snapped(mesh, map))
}

/// Whether more is tried with all effort than preferences alone; not so on large surfaces.
pub(crate) fn is_searched(mesh: &Mesh) -> bool {
    mesh.face_count() <= TRIANGLES
}

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effort {
    /// So many preferences at most.
    Quick(usize),
    /// Other preferences.
    Insistent,
    /// All preferences, and gluing what overlaps then while there are more islands than before.
    Thorough,
}

/// [`separate`] with less effort. What is left is not looked for: see [`look`](Separation::look).
pub(crate) fn separate_by(
    mesh: &Mesh,
    lengths: &EdgeData<f64>,
    kept: Option<&EdgeData<bool>>,
    map: UvMap,
    effort: Effort,
    watch: Watch,
) -> Result<Separation, Interrupted> {
    let overlaps = overlaps_on_islands(mesh, &map, watch.within(0.0, 0.25))?;
    let left = Overlaps::default();
    if overlaps.pairs.is_empty() {
        return Ok(Separation { map, overlaps, added_seam: 0.0, left });
    }
    let boxes = Boxes::new(map.triangles());
    watch.ask(0.3)?;
    let task = Task { mesh, lengths, kept, map: &map, boxes: &boxes, overlaps: &overlaps };
    let place = task.best(effort, watch.within(0.3, 1.0))?;
    drop(boxes);
    watch.ask(f64::NAN)?;
    let before = seam(mesh, lengths, &map.cut);
    let map = place.snapped(mesh, map);
    let added_seam = seam(mesh, lengths, &map.cut) - before;
    Ok(Separation { map, overlaps, added_seam, left })
}

impl Separation {
    /// Looks for the pairs that could not be parted.
    pub(crate) fn look(&mut self, mesh: &Mesh, watch: Watch) -> Result<(), Interrupted> {
        if !self.overlaps.pairs.is_empty() {
            self.left = overlaps_on_islands(mesh, &self.map, watch)?;
        }
        Ok(())
    }

    /// Moves lobes elsewhere ([`exchange`]).
    pub(crate) fn exchanged(
        mut self,
        (mesh, lengths, kept): (&Mesh, &EdgeData<f64>, Option<&EdgeData<bool>>),
        aim: &Aim,
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        let before = seam(mesh, lengths, &self.map.cut);
        self.map = exchange(mesh, lengths, kept, self.map, aim, watch)?;
        self.added_seam += seam(mesh, lengths, &self.map.cut) - before;
        Ok(self)
    }

    /// What it costs; `opened` is its map's.
    pub(crate) fn cost(&self, mesh: &Mesh, lengths: &EdgeData<f64>, opened: &CutMesh) -> Cost {
        Cost::new(mesh, lengths, &sizes(mesh, opened), &self.map.cut)
    }
}

/// The pairs of triangles that overlap on an island of the map opened along `cut`.
fn on_one_island(mesh: &Mesh, map: &UvMap, cut: &EdgeData<bool>, watch: Watch) -> Result<Overlaps, Interrupted> {
    let opened = CutMesh::open(mesh, cut);
    let asked = |pair: [u32; 2]| opened.island(FaceId(pair[0])) == opened.island(FaceId(pair[1]));
    overlaps_watched(map.triangles(), NEGLIGIBLE_DEPTH, asked, watch)
}

/// The pairs of triangles that overlap on an island, found from the boundary where that can be.
pub(crate) fn overlaps_on_islands(mesh: &Mesh, map: &UvMap, watch: Watch) -> Result<Overlaps, Interrupted> {
    let opened = map.opened(mesh);
    watch.ask(0.0)?;
    match overlaps_of_immersion(mesh, map, &opened, watch.within(0.0, 0.5))? {
        Some(overlaps) => Ok(overlaps),
        None => on_one_island(mesh, map, &map.cut, watch.within(0.5, 1.0)),
    }
}

fn seam(mesh: &Mesh, lengths: &EdgeData<f64>, cut: &EdgeData<bool>) -> f64 {
    mesh.edges().filter(|&e| cut[e]).map(|e| lengths[e]).filter(|l| l.is_finite()).sum()
}

/// How many triangles each island has.
fn sizes(mesh: &Mesh, opened: &CutMesh) -> Vec<usize> {
    let mut sizes = vec![0; opened.island_count()];
    mesh.faces().for_each(|f| sizes[opened.island(f) as usize] += 1);
    sizes
}

/// Pairs with whole numbers for areas, so that sums are exact; a pair without area counts, too.
fn weighed(pairs: &[Overlap]) -> Vec<Pair> {
    let total: f64 = pairs.iter().map(|pair| pair.area).sum();
    let unit = if total > 0.0 { f64::from(1 << 30) / total } else { 0.0 };
    let weight = |pair: &Overlap| Pair { triangles: pair.triangles.map(FaceId), weight: 1 + (pair.area * unit) as i64 };
    pairs.iter().map(weight).collect()
}

/// What is tried on.
struct Task<'a> {
    mesh: &'a Mesh,
    lengths: &'a EdgeData<f64>,
    /// What stays open.
    kept: Option<&'a EdgeData<bool>>,
    map: &'a UvMap,
    boxes: &'a Boxes<'a>,
    overlaps: &'a Overlaps,
}

/// A map without overlap: what was given moved, or a map that was made of it. Since it takes much room it is made when it is asked for.
struct Place {
    made: Option<UvMap>,
    moved: Moved,
}

impl Place {
    fn map(&self, first: &UvMap) -> UvMap {
        self.moved.map(self.made.as_ref().unwrap_or(first))
    }

    /// The map in place of the first, each vertex in one place, where it was at first if there is a choice.
    fn snapped(self, mesh: &Mesh, first: UvMap) -> UvMap {
        match self.made {
            None => self.moved.snapped(mesh, first),
            Some(made) => self.moved.map(&made).snapped(mesh, |map, h| map.agrees(&first, h)),
        }
    }
}

/// A map without overlap and what it costs.
struct State {
    cost: Cost,
    place: Place,
    /// The share of triangles that are not on the largest island.
    beside: f64,
    /// How many other gluings were tried.
    tried: usize,
    /// Whether these are all.
    is_done: bool,
}

impl State {
    /// States of few islands first, and of these such with short seams on which little was tried.
    fn rank(&self) -> f64 {
        self.cost.islands as f64 + self.beside + PATIENCE * self.tried as f64
    }
}

/// What maps are compared by; less is better.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(crate) struct Cost {
    /// Islands, those of a few triangles three times.
    pub(crate) islands: usize,
    pub(crate) seam: f64,
}

impl Cost {
    /// Of a map with islands of so many triangles each.
    fn new(mesh: &Mesh, lengths: &EdgeData<f64>, sizes: &[usize], cut: &EdgeData<bool>) -> Self {
        let slivers = sizes.iter().filter(|&&size| size < SLIVER as usize).count();
        Self { islands: sizes.len() + 2 * slivers, seam: seam(mesh, lengths, cut) }
    }
}

impl Task<'_> {
    /// A map's islands, opened further along `cut`.
    fn pieces<'b>(&'b self, map: &'b UvMap, boxes: &'b Boxes<'b>, cut: EdgeData<bool>) -> Pieces<'b> {
        Pieces::new((self.mesh, self.lengths, self.kept), map, boxes, cut)
    }

    /// The best map.
    fn best(&self, effort: Effort, watch: Watch) -> Result<Place, Interrupted> {
        let preferences = match effort {
            Effort::Quick(count) => &PREFERENCES[..count.clamp(1, PREFERENCES.len())],
            Effort::Insistent => &INSISTENT,
            Effort::Thorough => &PREFERENCES,
        };
        let mut states = self.starts(preferences, watch.within(0.0, 0.5))?;
        let (runs, before) = match effort {
            Effort::Quick(_) | Effort::Insistent => (0, 0),
            Effort::Thorough => {
                let before = self.cost(&sizes(self.mesh, &self.map.opened(self.mesh)), &self.map.cut).islands;
                ((TRIANGLES / self.mesh.face_count().max(1)).min(MOST_RUNS), before)
            }
        };
        let mut tried = 0;
        while tried < runs && states.iter().all(|state| state.cost.islands > before) {
            watch.ask(0.5 + 0.5 * tried as f64 / runs as f64)?;
            let open = (0..states.len()).filter(|&k| !states[k].is_done);
            let Some(k) = open.min_by(|&j, &k| states[j].rank().partial_cmp(&states[k].rank()).expect("no NaN")) else {
                break;
            };
            let others = self.glued_otherwise(&states[k], AT_ONCE.min(runs - tried), watch)?;
            tried += AT_ONCE;
            states[k].tried += AT_ONCE;
            states[k].is_done = others.is_none();
            for other in others.into_iter().flatten() {
                let is_new = states.iter().all(|state| state.cost != other.cost);
                if is_new && other.cost.islands <= states[k].cost.islands + 1 {
                    states.push(other);
                }
            }
        }
        watch.ask(f64::NAN)?;
        let best = states.into_iter().min_by(|a, b| a.cost.partial_cmp(&b.cost).expect("no NaN"));
        Ok(best.expect("there are preferences").place)
    }

    /// What comes of preferences, of fewer where the surface is large.
    fn starts(&self, preferences: &[Preference], watch: Watch) -> Result<Vec<State>, Interrupted> {
        let pairs = weighed(&self.overlaps.pairs);
        let most = (TRIANGLES / self.mesh.face_count().max(1)).clamp(1, preferences.len());
        let preferences = &preferences[..most];
        let mut within: Vec<f64> = preferences.iter().map(|preference| preference.within_overlap).collect();
        within.sort_by(f64::total_cmp);
        within.dedup();
        let divider = |&within: &f64| {
            let divider =
                Divider::new((self.mesh, self.lengths), &self.map.cut, &pairs, within, watch.within(0.0, 0.3))?;
            Ok((within, divider))
        };
        let dividers: Vec<Result<(f64, Divider), Interrupted>> = within.par_iter().map(divider).collect();
        let dividers = dividers.into_iter().collect::<Result<Vec<_>, _>>()?;
        let run = |preference: &Preference| {
            let divider = dividers.iter().find(|(within, _)| *within == preference.within_overlap);
            let (_, divider) = divider.expect("each has one");
            let cut = self.all_parted(divider.divide(preference, watch.within(0.3, 0.6))?, preference, watch)?;
            let (cost, moved, beside) = self.attached(self.pieces(self.map, self.boxes, cut), watch)?;
            Ok(State { cost, place: Place { made: None, moved }, beside, tried: 0, is_done: false })
        };
        let states: Vec<Result<State, Interrupted>> = preferences.par_iter().map(run).collect();
        states.into_iter().collect()
    }

    /// What comes of gluing one of the longest chains all the same, and parting what lies over each other then; none if all have
    /// been tried.
    fn glued_otherwise(&self, state: &State, count: usize, watch: Watch) -> Result<Option<Vec<State>>, Interrupted> {
        let ask = || watch.ask(f64::NAN);
        let there = state.place.map(self.map);
        let boxes_there = Boxes::new(there.triangles());
        ask()?;
        let pieces = self.pieces(&there, &boxes_there, there.cut.clone());
        ask()?;
        let chains = pieces.chains();
        let gluings: Vec<(&Chain, &Preference)> = chains
            .iter()
            .flat_map(|chain| GLUED.iter().map(move |p| (chain, p)))
            .skip(state.tried)
            .take(count)
            .collect();
        if gluings.is_empty() {
            return Ok(None);
        }
        let run = |&(chain, preference): &(&Chain, &Preference)| -> Result<Option<State>, Interrupted> {
            let most = MOST_PAIRS * self.mesh.face_count();
            ask()?;
            let Some(pairs) = pieces.overlaps_when_glued(chain, most) else { return Ok(None) };
            ask()?;
            let mut glued = pieces.clone();
            glued.glue(chain);
            let map = glued.moved().map(&there);
            let cut = divide(self.mesh, self.lengths, &map.cut, &weighed(&pairs), preference, watch)?;
            let boxes = Boxes::new(map.triangles());
            ask()?;
            let (cost, moved, beside) = self.attached(self.pieces(&map, &boxes, cut), watch)?;
            drop(boxes);
            Ok(Some(State { cost, place: Place { made: Some(map), moved }, beside, tried: 0, is_done: false }))
        };
        let states: Vec<Result<Option<State>, Interrupted>> = gluings.par_iter().map(run).collect();
        Ok(Some(states.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect()))
    }

    /// Pieces glued as far as that goes: the cost, where they are, and the share of triangles that are not on the largest island.
    fn attached(&self, mut pieces: Pieces, watch: Watch) -> Result<(Cost, Moved, f64), Interrupted> {
        watch.ask(f64::NAN)?;
        pieces.attach(watch)?;
        watch.ask(f64::NAN)?;
        let sizes = pieces.sizes();
        let largest = sizes.iter().copied().max().unwrap_or(0);
        let beside = 1.0 - largest as f64 / self.mesh.face_count().max(1) as f64;
        let cost = self.cost(&sizes, pieces.cut());
        watch.ask(f64::NAN)?;
        Ok((cost, pieces.moved(), beside))
    }

    /// Cuts further until those pairs too are parted that were not kept at first.
    fn all_parted(
        &self,
        mut cut: EdgeData<bool>,
        preference: &Preference,
        watch: Watch,
    ) -> Result<EdgeData<bool>, Interrupted> {
        let mut is_complete = self.overlaps.is_complete;
        while !is_complete {
            let more = on_one_island(self.mesh, self.map, &cut, watch)?;
            let further = divide(self.mesh, self.lengths, &cut, &weighed(&more.pairs), preference, watch)?;
            is_complete = more.is_complete || further == cut;
            cut = further;
        }
        Ok(cut)
    }

    /// What a map costs with islands of so many triangles each.
    fn cost(&self, sizes: &[usize], cut: &EdgeData<bool>) -> Cost {
        Cost::new(self.mesh, self.lengths, sizes, cut)
    }
}
