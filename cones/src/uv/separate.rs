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

use super::attach::Pieces;
use super::divide::{Pair, Preference, SLIVER, divide};
use super::map::UvMap;
use super::overlap::{Boxes, NEGLIGIBLE_DEPTH, Overlap, Overlaps, overlaps_watched};
use super::triangle;

/// What is tried, in this order.
const PREFERENCES: [Preference; 4] = [
    Preference { within_overlap: 1.0, power: 1.0, least_share: 0.003 },
    Preference { within_overlap: 4.0, power: 1.0, least_share: 0.01 },
    Preference { within_overlap: 1.0, power: 0.5, least_share: 0.0 },
    Preference { within_overlap: 4.0, power: 2.0, least_share: 0.003 },
];

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
    /// How many of the pairs could not be parted: triangles of one polygon.
    pub left: usize,
}

/// Takes a map apart and puts it together again until no island lies over itself. Edges of infinite length are not cut. `lengths`
/// are those of the edges in space. A map without overlap comes back as it is, to the bit.
///
/// O(n log n), and O(n + pairs) for each cut.
///
/// # Errors
/// If it is stopped.
pub fn separate(mesh: &Mesh, lengths: &EdgeData<f64>, map: UvMap, watch: Watch) -> Result<Separation, Interrupted> {
    let overlaps = on_one_island(mesh, &map, &map.cut, watch.within(0.0, 0.3))?;
    if overlaps.pairs.is_empty() {
        return Ok(Separation { map, overlaps, added_seam: 0.0, left: 0 });
    }
    let task = Task { mesh, lengths, map: &map, overlaps: &overlaps };
    let (separated, left) = task.best(watch.within(0.3, 1.0))?;
    let added_seam = seam(mesh, lengths, &separated.cut) - seam(mesh, lengths, &map.cut);
    Ok(Separation { map: separated, overlaps, added_seam, left })
}

/// The pairs of triangles that overlap on an island of the map opened along `cut`.
fn on_one_island(mesh: &Mesh, map: &UvMap, cut: &EdgeData<bool>, watch: Watch) -> Result<Overlaps, Interrupted> {
    let opened = CutMesh::open(mesh, cut);
    let asked = |pair: [u32; 2]| opened.island(FaceId(pair[0])) == opened.island(FaceId(pair[1]));
    overlaps_watched(&map.triangles(mesh), NEGLIGIBLE_DEPTH, asked, watch)
}

fn seam(mesh: &Mesh, lengths: &EdgeData<f64>, cut: &EdgeData<bool>) -> f64 {
    mesh.edges().filter(|&e| cut[e]).map(|e| lengths[e]).filter(|l| l.is_finite()).sum()
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
    map: &'a UvMap,
    overlaps: &'a Overlaps,
}

/// What came of a preference; less is better.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct Cost {
    /// Islands, those of a few triangles three times.
    islands: usize,
    seam: f64,
}

impl Task<'_> {
    /// The best map, and how many pairs could not be parted.
    fn best(&self, watch: Watch) -> Result<(UvMap, usize), Interrupted> {
        let boxes = Boxes::new(self.map.triangles(self.mesh).into_iter().map(triangle::upright));
        let pairs = weighed(&self.overlaps.pairs);
        let mut best: Option<(Cost, Pieces)> = None;
        let before = self.cost(&Pieces::new(self.mesh, self.map, self.lengths, &boxes, self.map.cut.clone())).islands;
        let share = |k: usize| k as f64 / PREFERENCES.len() as f64;
        for (k, preference) in PREFERENCES.iter().enumerate() {
            let watch = watch.within(share(k), share(k + 1));
            let cut = self.cut(&pairs, preference, watch.within(0.0, 0.5))?;
            let mut pieces = Pieces::new(self.mesh, self.map, self.lengths, &boxes, cut);
            pieces.attach(watch.within(0.5, 1.0))?;
            let cost = self.cost(&pieces);
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, pieces));
            }
            if cost.islands <= before {
                break;
            }
        }
        let (_, pieces) = best.expect("there are preferences");
        let separated = pieces.map();
        let left = on_one_island(self.mesh, &separated, &separated.cut, watch)?.pairs.len();
        Ok((separated, left))
    }

    /// Cuts by a preference until all pairs are parted, those too that were not kept at first.
    fn cut(&self, pairs: &[Pair], preference: &Preference, watch: Watch) -> Result<EdgeData<bool>, Interrupted> {
        let mut cut = divide(self.mesh, self.lengths, &self.map.cut, pairs, preference, watch)?;
        let mut is_complete = self.overlaps.is_complete;
        while !is_complete {
            let more = on_one_island(self.mesh, self.map, &cut, watch)?;
            let further = divide(self.mesh, self.lengths, &cut, &weighed(&more.pairs), preference, watch)?;
            is_complete = more.is_complete || further == cut;
            cut = further;
        }
        Ok(cut)
    }

    fn cost(&self, pieces: &Pieces) -> Cost {
        let sizes = pieces.sizes();
        let slivers = sizes.iter().filter(|&&size| size < SLIVER as usize).count();
        Cost { islands: sizes.len() + 2 * slivers, seam: seam(self.mesh, self.lengths, pieces.cut()) }
    }
}
