//! Nested dissection: an order of elimination that keeps the Cholesky factor of a surface's Laplacian small.
//!
//! A set of vertices is split in two; those of one part that have neighbours in the other are the separator and come last;
//! the parts, which then have nothing to do with each other, are dissected in turn (George 1973). Where to split is told
//! by positions, as in geometric dissection (Miller, Teng, Thurston & Vavasis 1993): through the median of the longest
//! axis where a set is small. Where it is large, planes across each of the axes are tried, away from the median too, for
//! one where the surface is narrow. Positions only guide: whatever they are, the order is complete. Large parts are dissected in
//! parallel; each has its place in the order, so that it is the same for any number of threads.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use super::graph::Graph;
use crate::parallel::{self, join};
use crate::watch::{Interrupted, Progress, Watch};

/// Sets of so many vertices are not split any more.
const LEAF: usize = 16;
/// In sets of more vertices than this the narrowest plane is looked for. In smaller ones the estimate is too coarse: on a
/// scan of 134 thousand vertices the factor gets a tenth larger with 100.
const LARGE: usize = 1000;
/// Each part has at least this share of the vertices.
const LEAST_SHARE: f32 = 0.2;
/// How many places for a plane there are along an axis.
const BINS: usize = 64;
/// Sets of more vertices are gone through on several threads.
const SHARED: usize = 1 << 15;

/// A vertex with what decides on which side of a plane it is.
#[derive(Clone, Copy)]
struct Place {
    at: [f32; 3],
    /// No neighbour is farther away along each axis.
    reach: [f32; 3],
    vertex: u32,
}

/// Where a set is split: the axis, and how many of its vertices are on the low side.
#[derive(Clone, Copy)]
struct Plane {
    axis: usize,
    below: usize,
}

/// The vertices in an order of elimination.
pub(crate) fn dissect(graph: &Graph, points: &[[f64; 3]], watch: Watch) -> Result<Vec<u32>, Interrupted> {
    let points: Vec<[f32; 3]> = points.iter().map(|p| p.map(|x| x as f32)).collect();
    let mut order = vec![0; graph.len()];
    Dissection::new(graph, watch).split(&mut places(graph, &points), &mut order)?;
    Ok(order)
}

/// Each vertex with its position and its reach.
fn places(graph: &Graph, points: &[[f32; 3]]) -> Vec<Place> {
    let place = |vertex: u32| {
        let at = points[vertex as usize];
        let mut reach = [0.0_f32; 3];
        for &w in graph.neighbors(vertex) {
            reach = [0, 1, 2].map(|axis| reach[axis].max((points[w as usize][axis] - at[axis]).abs()));
        }
        // A hair more, for rounding.
        Place { at, reach: reach.map(|reach| 1.0001 * reach), vertex }
    };
    parallel::map(graph.len(), |vertex| place(vertex as u32))
}

struct Dissection<'a> {
    graph: &'a Graph,
    /// The number of the part that a vertex near to a plane was last in. Each is written where the set that it is in is split, and read there:
    /// parts that are dissected at the same time have no edges between them.
    part: Vec<AtomicU32>,
    /// How many parts there have been. Which numbers they get says nothing.
    parts: AtomicU32,
    progress: Progress<'a>,
}

impl<'a> Dissection<'a> {
    fn new(graph: &'a Graph, watch: Watch<'a>) -> Self {
        let part = (0..graph.len()).map(|_| AtomicU32::new(0)).collect();
        Self { graph, part, parts: AtomicU32::new(0), progress: Progress::new(watch, graph.len()) }
    }

    /// Fills in the order of a set of vertices.
    fn split(&self, places: &mut [Place], order: &mut [u32]) -> Result<(), Interrupted> {
        if places.len() <= LEAF {
            put(places, order);
            return Ok(());
        }
        let is_large = places.len() > LARGE;
        if is_large {
            self.progress.ask()?;
        }
        let (low, high, separator) = self.separate(places);
        let (of_parts, last) = order.split_at_mut(low.len() + high.len());
        let (of_low, of_high) = of_parts.split_at_mut(low.len());
        put(separator, last);
        if is_large {
            let small = [&*low, &*high].map(|part| if part.len() > LARGE { 0 } else { part.len() });
            self.progress.add(separator.len() + small[0] + small[1]);
            let (low, high) = join(|| self.split(low, of_low), || self.split(high, of_high));
            return low.and(high);
        }
        self.split(low, of_low)?;
        self.split(high, of_high)
    }

    /// Sorts a set into two parts without edges between them, and the separator.
    fn separate<'b>(&self, places: &'b mut [Place]) -> (&'b mut [Place], &'b mut [Place], &'b mut [Place]) {
        let Plane { axis, below } = choose_plane(places);
        places.select_nth_unstable_by(below, |a, b| a.at[axis].total_cmp(&b.at[axis]).then(a.vertex.cmp(&b.vertex)));
        let plane = places[below].at[axis];
        let near = move |place: &&Place| (place.at[axis] - plane).abs() <= place.reach[axis];
        let is_shared = places.len() > SHARED;
        let (low, high) = places.split_at_mut(below);
        let before = self.parts.fetch_add(2, Relaxed);
        let parts = [before + 1, before + 2];
        let enter = |half: &[Place], part| {
            half.iter().filter(near).for_each(|place| self.part[place.vertex as usize].store(part, Relaxed));
        };
        join_if(is_shared, || enter(low, parts[0]), || enter(high, parts[1]));
        let rim = |half: &[Place], other| half.iter().filter(near).filter(|place| self.touches(place, other)).count();
        let (of_low, of_high) = join_if(is_shared, || rim(low, parts[1]), || rim(high, parts[0]));
        if of_low <= of_high {
            let (low, separator) = self.without_rim(low, parts[1], near);
            (low, high, separator)
        } else {
            let (high, separator) = self.without_rim(high, parts[0], near);
            (low, high, separator)
        }
    }

    /// Whether a vertex has a neighbour in a part.
    fn touches(&self, place: &Place, part: u32) -> bool {
        self.graph.neighbors(place.vertex).iter().any(|&w| self.part[w as usize].load(Relaxed) == part)
    }

    /// Moves the vertices that touch the other part behind the others.
    fn without_rim<'b>(
        &self,
        places: &'b mut [Place],
        other: u32,
        near: impl Fn(&&Place) -> bool,
    ) -> (&'b mut [Place], &'b mut [Place]) {
        let mut inner = places.len();
        for k in (0..places.len()).rev() {
            if near(&&places[k]) && self.touches(&places[k], other) {
                inner -= 1;
                places.swap(k, inner);
            }
        }
        places.split_at_mut(inner)
    }
}

/// Writes down vertices in the order in which they are.
fn put(places: &[Place], order: &mut [u32]) {
    order.iter_mut().zip(places).for_each(|(vertex, place)| *vertex = place.vertex);
}

/// The results of two pieces of work, at the same time if there is enough of it.
fn join_if<A: Send, B: Send>(is_shared: bool, a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    if is_shared { join(a, b) } else { (a(), b()) }
}

/// The lower left and the upper right corner of a box about a set.
fn bounds(places: &[Place]) -> [[f32; 3]; 2] {
    places.iter().fold([[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]], |[low, high], place| {
        [[0, 1, 2].map(|axis| low[axis].min(place.at[axis])), [0, 1, 2].map(|axis| high[axis].max(place.at[axis]))]
    })
}

/// The plane to split a set at.
fn choose_plane(places: &[Place]) -> Plane {
    let [low, high] = bounds(places);
    let extent = |axis: usize| high[axis] - low[axis];
    let longest = (0..3).max_by(|&a, &b| extent(a).total_cmp(&extent(b))).unwrap_or(0);
    let median = Plane { axis: longest, below: places.len() / 2 };
    if places.len() <= LARGE {
        return median;
    }
    let across = |axis: usize| narrowest(places, axis, [low[axis], high[axis]]);
    let is_shared = places.len() > SHARED;
    let (x, (y, z)) = join_if(is_shared, || across(0), || join_if(is_shared, || across(1), || across(2)));
    let narrow = [x, y, z].into_iter().flatten();
    narrow.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(median, |(_, plane)| plane)
}

/// The best plane across an axis, with what it costs: an estimate of the separator's size, which counts the more the less
/// even the parts are.
fn narrowest(places: &[Place], axis: usize, [low, high]: [f32; 2]) -> Option<(f32, Plane)> {
    let per_length = BINS as f32 / (high - low);
    if !per_length.is_finite() {
        return None;
    }
    let mut count = [0; BINS];
    // A vertex is in the separator of a plane next to its bin with a chance that goes with its reach;
    let mut reach = [0.0; BINS];
    // if it reaches farther than a bin, in those of all planes within its reach: how many more do from each plane on.
    let mut long = [0; BINS + 1];
    for place in places {
        let at = (place.at[axis] - low) * per_length;
        let bin = (at as usize).min(BINS - 1);
        count[bin] += 1;
        let farthest = place.reach[axis] * per_length;
        if farthest < 1.0 {
            reach[bin] += farthest;
        } else {
            long[(at - farthest).max(0.0).ceil() as usize] += 1;
            long[((at + farthest) as usize).min(BINS - 1) + 1] -= 1;
        }
    }
    let all = places.len() as f32;
    let (mut below, mut across) = (0, long[0]);
    let planes = (1..BINS).filter_map(|k| {
        below += count[k - 1];
        across += long[k];
        let share = (below as f32).min(all - below as f32) / all;
        let size = reach[k - 1] + reach[k] + across as f32;
        (share >= LEAST_SHARE).then_some((size / share.sqrt(), Plane { axis, below }))
    });
    planes.min_by(|a, b| a.0.total_cmp(&b.0))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::{Mesh, shapes};

    fn graph(mesh: &Mesh) -> Graph {
        let (mut start, mut row) = (vec![0], Vec::new());
        for v in mesh.vertices() {
            row.extend(mesh.neighbors(v).iter().filter(|&&w| w > v).map(|w| w.0));
            start.push(row.len() as u32);
        }
        Graph::of_lower_triangle(&start, &row)
    }

    #[test]
    fn edges_that_are_longer_than_a_bin_are_not_cut_as_if_there_were_none() {
        let around = 2000;
        let rim = |z: f64| {
            (0..around).map(move |k| (TAU * f64::from(k) / f64::from(around)).sin_cos()).map(move |(y, x)| [x, y, z])
        };
        let points: Vec<[f64; 3]> = rim(0.0).chain(rim(0.1)).collect();
        let needles = |k: u32| {
            let next = (k + 1) % around;
            [[k, next, around + k], [next, around + next, around + k]]
        };
        let mesh = Mesh::new(points.len(), &(0..around).flat_map(needles).collect::<Vec<_>>()).unwrap();
        let graph = graph(&mesh);
        let points: Vec<[f32; 3]> = points.iter().map(|p| p.map(|x| x as f32)).collect();
        let dissection = Dissection::new(&graph, Watch::NONE);
        let mut places = places(&graph, &points);
        let (low, high, separator) = dissection.separate(&mut places);
        assert!(
            separator.len() < 10 && low.len().min(high.len()) > 700,
            "{} {} {}",
            low.len(),
            high.len(),
            separator.len()
        );
    }

    #[test]
    fn no_edge_leads_from_one_part_past_the_separator_to_the_other() {
        // The last one is gone through on several threads.
        let large = shapes::hare(SHARED + 4000);
        for shape in [shapes::hare(3000), shapes::terrain(900, 3), shapes::torus(2, 1500), large] {
            let mesh = shape.mesh();
            let graph = graph(&mesh);
            let points = shape.points.iter().map(|p| p.map(|x| x as f32)).collect::<Vec<_>>();
            let mut places = places(&graph, &points);
            let (low, high, separator) = Dissection::new(&graph, Watch::NONE).separate(&mut places);
            assert_eq!(low.len() + high.len() + separator.len(), graph.len());
            assert!(separator.len() < graph.len() / 10);
            let is_high: Vec<bool> = mesh.vertices().map(|v| high.iter().any(|place| place.vertex == v.0)).collect();
            for place in low {
                assert!(graph.neighbors(place.vertex).iter().all(|&w| !is_high[w as usize]));
            }
        }
    }
}
