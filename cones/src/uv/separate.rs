//! A map taken apart until nothing lies over itself, and put together again as far as that goes.
//!
//! Overlapping pairs within an island are found once ([`overlap`](super::overlap)); cuts part them ([`divide`](super::divide)), which moves
//! nothing and so makes no new ones; what was cut off is attached elsewhere ([`attach`](super::attach)), which is tested where
//! something moved. Which cuts are best depends on what can be attached afterwards, so several preferences are tried, and the best is kept: few
//! islands, no slivers, short seams. All cuts that were tried, and short paths across, are a network along which it is put together otherwise
//! ([`rearrange`](super::rearrange)). Islands may still lie over *each other*: that is for whoever places them.
//!
//! An island without overlap keeps its positions to the bit.

use std::ops::Range;

use geom::{EdgeData, EdgeId, FaceData, FaceId, HalfedgeId, Interrupted, Islands, Mesh, Watch};
use rayon::prelude::*;

use super::across::Paths;
use super::attach::{Moved, Pieces};
use super::boxes::Boxes;
use super::divide::{Divider, Pair, Preference, SLIVER, divide};
use super::immersion::overlaps_from_boundary;
use super::map::UvMap;
use super::overlap::{NEGLIGIBLE_DEPTH, Overlap, Overlaps, overlaps_watched};
use super::rearrange::{Figures, SEARCHES, rearranged};

/// What is tried. Of 48 such preferences these four give the fewest islands on 105 layouts that lie over themselves: each alone
/// leaves one island on 41 to 48 of them, all four together on 60.
const PREFERENCES: [Preference; 4] = [
    Preference { within_overlap: 3.0, power: 1.0, least_share: 0.0 },
    Preference { within_overlap: 3.0, power: 0.3, least_share: 0.03 },
    Preference { within_overlap: 1.0, power: 1.0, least_share: 0.03 },
    Preference { within_overlap: 10.0, power: 1.0, least_share: 0.01 },
];
/// With so many triangles each all preferences are tried.
const TRIANGLES: usize = 400_000;
/// So many islands at most are large enough that paths across them are sought.
const MOST_CROSSED: usize = 100;

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
    /// What is no overlap, over the map's extent.
    deeper_than: f64,
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
    separate_deeper(mesh, lengths, kept, (map, NEGLIGIBLE_DEPTH), watch)
}

/// [`separate`], where overlaps that are no deeper than a share of the map's extent are none.
pub(super) fn separate_deeper(
    mesh: &Mesh,
    lengths: &EdgeData<f64>,
    kept: Option<&EdgeData<bool>>,
    (map, deeper_than): (UvMap, f64),
    watch: Watch,
) -> Result<Separation, Interrupted> {
    let mut overlaps = overlaps_on_islands(mesh, &map, watch.within(0.0, 0.2))?;
    overlaps.pairs.retain(|pair| pair.depth > deeper_than);
    if overlaps.pairs.is_empty() {
        return Ok(Separation::none(map, overlaps));
    }
    let (mut done, mut network) = taken_apart((mesh, lengths, kept), (map, overlaps), watch.within(0.2, 0.5))?;
    // Other islands are the user's own.
    let mut overlaps = FaceData::constant(mesh.face_count(), false);
    done.overlaps.pairs.iter().flat_map(|pair| pair.triangles).for_each(|f| overlaps[FaceId(f)] = true);
    let is_crossed = |island: &[FaceId]| island.iter().any(|&f| overlaps[f]);
    add_necks((mesh, lengths), &done.map, &mut network, is_crossed, watch)?;
    done.deeper_than = deeper_than;
    let before = seam(mesh, lengths, &done.map.cut);
    let cost = |figures: Figures| figures.islands as f64 + if before > 0.0 { figures.seam / before } else { 0.0 };
    let along = |run: &[HalfedgeId]| [run.iter().map(|&h| lengths[mesh.edge(h)]).filter(|l| l.is_finite()).sum(); 2];
    done.rearranged((mesh, lengths, kept), &network, (along, cost, 1.0, 0..SEARCHES), watch.within(0.6, 1.0))
}

/// Adds short paths across those islands of a map that are to be crossed, but for the smallest, and where it is open.
pub(crate) fn add_necks(
    (mesh, lengths): (&Mesh, &EdgeData<f64>),
    map: &UvMap,
    network: &mut EdgeData<bool>,
    is_crossed: impl Fn(&[FaceId]) -> bool + Sync,
    watch: Watch,
) -> Result<(), Interrupted> {
    let paths = Paths::new(mesh, lengths, map, watch.within(f64::NAN, f64::NAN))?;
    let least = mesh.face_count() / MOST_CROSSED;
    let across = |island: Vec<FaceId>| -> Result<Vec<EdgeId>, Interrupted> {
        watch.ask(f64::NAN)?;
        let Some(sweep) = paths.sweep(&island) else { return Ok(Vec::new()) };
        Ok(paths.spread(&sweep).iter().flat_map(|path| paths.edges(path)).collect())
    };
    let large = paths.islands().into_par_iter().filter(|island| island.len() >= least && is_crossed(island));
    let across: Vec<Result<Vec<EdgeId>, Interrupted>> = large.map(across).collect();
    for edges in across {
        edges?.into_iter().for_each(|e| network[e] = true);
    }
    mesh.edges().filter(|&e| map.cut[e]).for_each(|e| network[e] = true);
    Ok(())
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

/// [`separate`] as far as cuts alone go, given the overlaps on islands, and all edges that were cut, whether or not that was best. What is
/// left is not looked for.
pub(crate) fn taken_apart(
    (mesh, lengths, kept): (&Mesh, &EdgeData<f64>, Option<&EdgeData<bool>>),
    (map, overlaps): (UvMap, Overlaps),
    watch: Watch,
) -> Result<(Separation, EdgeData<bool>), Interrupted> {
    let mut network = map.cut.clone();
    if overlaps.pairs.is_empty() {
        return Ok((Separation::none(map, overlaps), network));
    }
    let pairs = weighed(&overlaps.pairs);
    let (boxes, dividers) = rayon::join(
        || Boxes::new(map.triangles()),
        || dividers((mesh, lengths), &map.cut, &pairs, watch.within(0.0, 0.3)),
    );
    let dividers = dividers?;
    let task =
        Task { mesh, lengths, kept, map: &map, boxes: &boxes, dividers: &dividers, is_complete: overlaps.is_complete };
    let moved = task.best(&mut network, watch.within(0.3, 1.0))?;
    drop((boxes, dividers));
    drop(pairs);
    watch.ask(f64::NAN)?;
    let before = seam(mesh, lengths, &map.cut);
    let map = moved.snapped(mesh, map);
    let added_seam = seam(mesh, lengths, &map.cut) - before;
    Ok((Separation { added_seam, ..Separation::none(map, overlaps) }, network))
}

impl Separation {
    /// A map as it is.
    pub(crate) fn none(map: UvMap, overlaps: Overlaps) -> Self {
        Self { map, overlaps, added_seam: 0.0, left: Overlaps::default(), deeper_than: NEGLIGIBLE_DEPTH }
    }

    /// Looks for the pairs that could not be parted.
    fn look(&mut self, mesh: &Mesh, watch: Watch) -> Result<(), Interrupted> {
        if !self.overlaps.pairs.is_empty() {
            self.left = self.overlaps(mesh, &self.map, watch)?;
        }
        Ok(())
    }

    /// The pairs of triangles that overlap on an island of a map.
    fn overlaps(&self, mesh: &Mesh, map: &UvMap, watch: Watch) -> Result<Overlaps, Interrupted> {
        let mut found = overlaps_on_islands(mesh, map, watch)?;
        found.pairs.retain(|pair| pair.depth > self.deeper_than);
        Ok(found)
    }

    /// Its cells along a network put together otherwise ([`rearranged`]), and what could not be parted looked for.
    pub(crate) fn rearranged(
        mut self,
        (mesh, lengths, kept): (&Mesh, &EdgeData<f64>, Option<&EdgeData<bool>>),
        network: &EdgeData<bool>,
        costs: (impl Fn(&[HalfedgeId]) -> [f64; 2] + Send, impl Fn(Figures) -> f64 + Sync, f64, Range<u64>),
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        let Some(map) = rearranged((mesh, kept), &self.map, network, costs, watch.within(0.0, 0.8))? else {
            self.look(mesh, watch.within(0.8, 1.0))?;
            return Ok(self);
        };
        let left = self.overlaps(mesh, &map, watch.within(0.8, 0.9))?;
        if !left.pairs.is_empty() {
            self.look(mesh, watch.within(0.9, 1.0))?;
        }
        // What could not be parted is there still; nothing else may be.
        if left.pairs.len() <= self.left.pairs.len() {
            self.added_seam += seam(mesh, lengths, &map.cut) - seam(mesh, lengths, &self.map.cut);
            (self.map, self.left) = (map, left);
        }
        Ok(self)
    }
}

/// The pairs of triangles that overlap on an island of the map opened along `cut`.
fn on_one_island(mesh: &Mesh, map: &UvMap, cut: &EdgeData<bool>, watch: Watch) -> Result<Overlaps, Interrupted> {
    let islands = Islands::new(mesh, cut);
    let asked = |pair: [u32; 2]| islands.of(FaceId(pair[0])) == islands.of(FaceId(pair[1]));
    overlaps_watched(map.triangles(), NEGLIGIBLE_DEPTH, asked, watch)
}

/// The pairs of triangles that overlap on an island, found from the boundary where that can be.
pub(crate) fn overlaps_on_islands(mesh: &Mesh, map: &UvMap, watch: Watch) -> Result<Overlaps, Interrupted> {
    match overlaps_from_boundary(mesh, map, watch.within(0.0, 0.5))? {
        Some(overlaps) => Ok(overlaps),
        None => on_one_island(mesh, map, &map.cut, watch.within(0.5, 1.0)),
    }
}

/// The length of what is cut.
pub(crate) fn seam(mesh: &Mesh, lengths: &EdgeData<f64>, cut: &EdgeData<bool>) -> f64 {
    mesh.edges().filter(|&e| cut[e]).map(|e| lengths[e]).filter(|l| l.is_finite()).sum()
}

/// Pairs with whole numbers for areas, so that sums are exact; a pair without area counts, too.
fn weighed(pairs: &[Overlap]) -> Vec<Pair> {
    let total: f64 = pairs.iter().map(|pair| pair.area).sum();
    let unit = if total > 0.0 { f64::from(1 << 30) / total } else { 0.0 };
    let weight = |pair: &Overlap| Pair { triangles: pair.triangles.map(FaceId), weight: 1 + (pair.area * unit) as i64 };
    pairs.iter().map(weight).collect()
}

/// What is tried on a mesh: fewer on large ones.
fn preferences(mesh: &Mesh) -> &'static [Preference] {
    &PREFERENCES[..(TRIANGLES / mesh.face_count().max(1)).clamp(1, PREFERENCES.len())]
}

/// What cuts by them have in common, each with how many times longer it takes an edge within overlaps to be.
fn dividers<'a>(
    (mesh, lengths): (&'a Mesh, &EdgeData<f64>),
    cut: &EdgeData<bool>,
    pairs: &'a [Pair],
    watch: Watch,
) -> Result<Vec<(f64, Divider<'a>)>, Interrupted> {
    let mut within: Vec<f64> = preferences(mesh).iter().map(|preference| preference.within_overlap).collect();
    within.sort_by(f64::total_cmp);
    within.dedup();
    let divider = |&within: &f64| Ok((within, Divider::new((mesh, lengths), cut, pairs, within, watch)?));
    let dividers: Vec<Result<_, Interrupted>> = within.par_iter().map(divider).collect();
    dividers.into_iter().collect()
}

/// What is tried on.
struct Task<'a> {
    mesh: &'a Mesh,
    lengths: &'a EdgeData<f64>,
    /// What stays open.
    kept: Option<&'a EdgeData<bool>>,
    map: &'a UvMap,
    boxes: &'a Boxes<'a>,
    /// Each with how many times longer it takes an edge within overlaps to be.
    dividers: &'a [(f64, Divider<'a>)],
    /// Whether the dividers know all pairs.
    is_complete: bool,
}

impl Task<'_> {
    /// What comes of the best preference; the cuts of all are added to the network.
    fn best(&self, network: &mut EdgeData<bool>, watch: Watch) -> Result<Moved, Interrupted> {
        let run = |preference: &Preference| {
            let divider = self.dividers.iter().find(|(within, _)| *within == preference.within_overlap);
            let (_, divider) = divider.expect("each has one");
            let cut = self.all_parted(divider.divide(preference, watch.within(0.0, 0.5))?, preference, watch)?;
            let mut pieces = Pieces::new((self.mesh, self.lengths, self.kept), self.map, self.boxes, cut.clone());
            watch.ask(f64::NAN)?;
            pieces.attach(watch)?;
            Ok((self.cost(&pieces), pieces.moved(), cut))
        };
        let tried: Vec<Result<_, Interrupted>> = preferences(self.mesh).par_iter().map(run).collect();
        let tried = tried.into_iter().collect::<Result<Vec<_>, _>>()?;
        for (_, _, cut) in &tried {
            self.mesh.edges().filter(|&e| cut[e]).for_each(|e| network[e] = true);
        }
        let best = tried.into_iter().min_by(|a, b| a.0.partial_cmp(&b.0).expect("no NaN"));
        Ok(best.expect("there are preferences").1)
    }

    /// Cuts further until those pairs too are parted that were not kept at first.
    fn all_parted(
        &self,
        mut cut: EdgeData<bool>,
        preference: &Preference,
        watch: Watch,
    ) -> Result<EdgeData<bool>, Interrupted> {
        let mut is_complete = self.is_complete;
        while !is_complete {
            let more = on_one_island(self.mesh, self.map, &cut, watch)?;
            let further = divide(self.mesh, self.lengths, &cut, &weighed(&more.pairs), preference, watch)?;
            is_complete = more.is_complete || further == cut;
            cut = further;
        }
        Ok(cut)
    }

    /// Islands, those of a few triangles three times, and the length of seams; less is better.
    fn cost(&self, pieces: &Pieces) -> (usize, f64) {
        let sizes = pieces.sizes();
        let slivers = sizes.iter().filter(|&&size| size < SLIVER as usize).count();
        (sizes.len() + 2 * slivers, seam(self.mesh, self.lengths, pieces.cut()))
    }
}
