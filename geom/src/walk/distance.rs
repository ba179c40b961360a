//! Distances along edges, without the ways.
//!
//! [`EdgeDistances`] is made for being asked often: neighbours are put side by side once, distances are f32. It agrees with
//! [`ShortestPaths`](crate::ShortestPaths). [`distance_along_edges`] asks for no mesh: any triangles will do.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use super::dijkstra::{Length, dijkstra};
use super::path::edges_at;
use crate::mesh::{EdgeId, Mesh, VertexData, VertexId};
use crate::rows::Rows;
use crate::vector::{Vec3, distance};
use crate::watch::{Interrupted, Watch, unwatched};

/// The edges of a mesh, vertex by vertex, with their lengths, to be asked for distances from changing sets of vertices.
///
/// ```
/// use geom::{EdgeDistances, Mesh, VertexId};
/// let strip = Mesh::new(5, &[[0, 1, 2], [2, 1, 3], [2, 3, 4]])?;
/// let distances = EdgeDistances::new(&strip, |_| 1.0);
/// assert_eq!(distances.from([VertexId(0)])[VertexId(4)], 2.0);
/// # Ok::<(), geom::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct EdgeDistances {
    /// At each vertex the other ends of its edges and their lengths.
    edges: Rows<(u32, f32)>,
}

impl EdgeDistances {
    /// The edges of a mesh with the given lengths; what is negative or missing (NaN) counts as zero. O(E).
    pub fn new(mesh: &Mesh, length: impl Fn(EdgeId) -> f32) -> Self {
        let edges = |v| edges_at(mesh, v).map(|(e, w)| (w.0, length(e).max(0.0)));
        Self { edges: mesh.vertices().map(edges).collect() }
    }

    /// The distance of each vertex from the nearest source; infinite where there is none. O(V log V).
    ///
    /// # Panics
    /// If a source is no vertex of the mesh.
    pub fn from(&self, sources: impl IntoIterator<Item = VertexId>) -> VertexData<f32> {
        unwatched(self.from_watched(sources, Watch::NONE))
    }

    /// [`EdgeDistances::from`], watched.
    ///
    /// # Errors
    /// If it is stopped.
    ///
    /// # Panics
    /// If a source is no vertex of the mesh.
    pub fn from_watched(
        &self,
        sources: impl IntoIterator<Item = VertexId>,
        watch: Watch,
    ) -> Result<VertexData<f32>, Interrupted> {
        let mut distance = VertexData::constant(self.edges.len(), f32::INFINITY);
        self.lower_watched(&mut distance, sources, watch)?;
        Ok(distance)
    }

    /// Lowers distances from some sources to those from these and further ones, as if all had been asked for at once. Costs as much as the
    /// vertices that are nearer to the further ones, watched.
    ///
    /// # Errors
    /// If it is stopped.
    ///
    /// # Panics
    /// If a source is no vertex of the mesh, or there is not a distance for each vertex.
    pub fn lower_watched(
        &self,
        distance: &mut VertexData<f32>,
        sources: impl IntoIterator<Item = VertexId>,
        watch: Watch,
    ) -> Result<(), Interrupted> {
        let sources = sources.into_iter().map(|v| v.0);
        let edges = |v: u32| self.edges.row(v as usize).iter().map(|&(w, length)| ((), w, length));
        dijkstra(distance, sources, edges, |_, (), _| {}, watch)
    }
}

/// The vertices within a distance of one along edges, with their distances, the nearest first; at most so many. Lengths are as for
/// [`EdgeDistances::new`]. O(B log B) for B of them.
///
/// # Panics
/// If the source is no vertex of the mesh.
pub fn vertices_around(
    mesh: &Mesh,
    length: impl Fn(EdgeId) -> f32,
    source: VertexId,
    radius: f32,
    most: usize,
) -> Vec<(VertexId, f32)> {
    let mut reached = HashMap::from([(source.0, 0.0)]);
    let mut queue = BinaryHeap::from([Reverse(0.0_f32.entry(source.0))]);
    let mut around = Vec::new();
    while around.len() < most
        && let Some(Reverse(first)) = queue.pop()
    {
        let v = f32::vertex(first);
        let to_here = reached[&v];
        if first != to_here.entry(v) {
            continue; // as in `dijkstra`
        }
        around.push((VertexId(v), to_here));
        for (e, w) in edges_at(mesh, VertexId(v)) {
            let along = to_here + length(e).max(0.0);
            if along <= radius && reached.get(&w.0).is_none_or(|&known| along < known) {
                reached.insert(w.0, along);
                queue.push(Reverse(along.entry(w.0)));
            }
        }
    }
    around
}

/// The length of the shortest way along the sides of triangles from one of the points, or from the one in use that is farthest
/// from the middle of all; NaN where no way leads. Triangles may be any: meeting in threes, turned, in pieces. O(F log F).
///
/// # Panics
/// If a triangle, or `from`, names a point that is not there.
pub fn distance_along_edges(points: &[Vec3], triangles: &[[u32; 3]], from: Option<usize>) -> Vec<f64> {
    let mut along = vec![f64::INFINITY; points.len()];
    if let Some(from) = from.or_else(|| farthest_out(points, triangles)) {
        // An edge comes once for each of its triangles, which does no harm.
        let both_ways = |&[a, b, c]: &[u32; 3]| [(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)];
        let sides = triangles.iter().flat_map(both_ways).map(|(a, b)| (a as usize, b));
        let neighbors = Rows::sorted(points.len(), sides);
        let edges = |v: u32| {
            let length = move |w: u32| distance(points[v as usize], points[w as usize]);
            neighbors.row(v as usize).iter().map(move |&w| ((), w, length(w)))
        };
        unwatched(dijkstra(&mut along, [from as u32].into_iter(), edges, |_, (), _| {}, Watch::NONE));
    }
    along.iter().map(|d| if d.is_finite() { *d } else { f64::NAN }).collect()
}

/// The point in use that is farthest from the mean of all corners; the lowest of several.
fn farthest_out(points: &[Vec3], triangles: &[[u32; 3]]) -> Option<usize> {
    let used = || triangles.iter().flatten().map(|&v| v as usize);
    let share = 1.0 / used().count() as f64;
    let middle = used().fold([0.0; 3], |sum, v| std::array::from_fn(|i| sum[i] + share * points[v][i]));
    used().max_by(|&u, &v| distance(points[u], middle).total_cmp(&distance(points[v], middle)).then(v.cmp(&u)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Metric, ShortestPaths, shapes};

    #[test]
    fn distances_are_to_the_bit_those_that_a_heap_gives() {
        let shape = shapes::hare(9000);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let length = |e| metric.length(e) as f32;
        let distances = EdgeDistances::new(&mesh, length);
        let sources = [VertexId(0), VertexId(4321)];
        let mut along = distances.from([sources[0]]);
        for v in sources {
            let around = vertices_around(&mesh, length, v, f32::INFINITY, usize::MAX);
            let from = distances.from([v]);
            assert_eq!(around.len(), mesh.vertex_count());
            assert!(around.iter().all(|&(w, distance)| distance == from[w]));
            around.iter().for_each(|&(w, distance)| along[w] = along[w].min(distance));
        }
        assert_eq!(distances.from(sources), along);
    }

    #[test]
    fn all_distances_are_those_of_the_shortest_paths() {
        for shape in [shapes::hare(900), shapes::terrain(700, 2)] {
            let mesh = shape.mesh();
            let metric = Metric::from_points(&mesh, &shape.points);
            let sources: Vec<VertexId> = mesh.vertices().step_by(250).collect();
            let from =
                |sources: &[VertexId]| ShortestPaths::new(&mesh, metric.lengths(), sources.iter().map(|&v| (v, 0)));
            let paths = from(&sources);
            let distances = EdgeDistances::new(&mesh, |e| metric.length(e) as f32);
            let distance = distances.from(sources.iter().copied());
            assert!(mesh.vertices().all(|v| (f64::from(distance[v]) - paths.distance[v]).abs() < 1e-5));
            let single = distance_along_edges(&shape.points, &shape.triangles, Some(17));
            assert!(single.iter().eq(from(&[VertexId(17)]).distance.iter()));
            assert!(distances.from([]).iter().all(|d| *d == f32::INFINITY));
            let mut lowered = distances.from(sources[..2].iter().copied());
            distances.lower_watched(&mut lowered, sources[2..].iter().copied(), Watch::NONE).unwrap();
            assert!(sources.len() > 2 && lowered == distance);
        }
    }

    #[test]
    fn what_is_around_a_vertex_is_what_is_near_it() {
        let shape = shapes::hare(900);
        let mesh = shape.mesh();
        let metric = Metric::from_points(&mesh, &shape.points);
        let distances = EdgeDistances::new(&mesh, |e| metric.length(e) as f32);
        for source in mesh.vertices().step_by(111) {
            let all = distances.from([source]);
            let around = |most| vertices_around(&mesh, |e| metric.length(e) as f32, source, 0.3, most);
            let (around, few) = (around(usize::MAX), around(5));
            assert!(around.windows(2).all(|two| two[0].1 <= two[1].1));
            assert!(around.iter().all(|&(v, distance)| distance == all[v] && distance <= 0.3));
            assert_eq!(around.len(), all.iter().filter(|&&distance| distance <= 0.3).count());
            assert_eq!(few, around[..5]);
        }
    }

    #[test]
    fn ways_lead_along_edges_and_nowhere_else() {
        // A unit square of two triangles, and a vertex apart.
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [5.0, 5.0, 5.0]];
        let distance = distance_along_edges(&points, &[[0, 1, 2], [0, 2, 3]], Some(1));
        assert_eq!(distance[..4], [1.0, 0.0, 1.0, 2.0]);
        assert!(distance[4].is_nan());
    }

    #[test]
    fn without_a_start_the_one_farthest_out_is_taken() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 3.0, 0.0], [99.0, 0.0, 0.0]];
        let distance = distance_along_edges(&points, &[[0, 1, 2]], None);
        assert_eq!(distance[..3], [3.0, 10.0_f64.sqrt(), 0.0]);
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(distance_along_edges(&square, &[[0, 1, 2], [2, 3, 0]], None)[0], 0.0);
        assert!(distance_along_edges(&points, &[], None).iter().all(|d| d.is_nan()));
    }
}
