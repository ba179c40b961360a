//! Distance along the edges of a mesh.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;
use topo::Adjacency;

type Point = [f64; 3];

/// The length of the shortest way along edges from a vertex, or from the one farthest from the middle of all; NaN where no
/// way leads. Dijkstra (1959), "A note on two problems in connexion with graphs".
pub(super) fn along_edges(points: &[Point], triangles: &[[u32; 3]], from: Option<usize>) -> Vec<f64> {
    let mut distance = vec![f64::NAN; points.len()];
    let sides: Vec<[usize; 2]> =
        triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(|s| s.map(|v| v as usize)).collect();
    let (Ok(edges), Some(from)) =
        (Adjacency::from_edges(points.len(), &sides), from.or_else(|| farthest_out(points, triangles)))
    else {
        return distance;
    };
    let mut queue = BinaryHeap::from([Reverse(Reached { distance: 0.0, vertex: from })]);
    while let Some(Reverse(reached)) = queue.pop() {
        let v = reached.vertex;
        if !distance[v].is_nan() {
            continue;
        }
        distance[v] = reached.distance;
        for u in edges.neighbors(v).iter().map(|&u| u as usize).filter(|&u| distance[u].is_nan()) {
            queue.push(Reverse(Reached { distance: reached.distance + length(points[v], points[u]), vertex: u }));
        }
    }
    distance
}

/// The vertex of the surface that is farthest from the mean of all.
fn farthest_out(points: &[Point], triangles: &[[u32; 3]]) -> Option<usize> {
    let used = || triangles.iter().flatten().map(|&v| v as usize);
    let share = 1.0 / used().count() as f64;
    let middle = used().fold([0.0; 3], |sum, v| std::array::from_fn(|i| sum[i] + share * points[v][i]));
    used().max_by(|&u, &v| length(points[u], middle).total_cmp(&length(points[v], middle)).then(v.cmp(&u)))
}

fn length(a: Point, b: Point) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// A vertex and the length of a way to it; the shortest way, then the lowest vertex, is the least.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Reached {
    distance: f64,
    vertex: usize,
}

impl Eq for Reached {}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        self.distance.total_cmp(&other.distance).then(self.vertex.cmp(&other.vertex))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_lead_along_edges_and_nowhere_else() {
        // A unit square of two triangles, and a vertex apart.
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [5.0, 5.0, 5.0]];
        let distance = along_edges(&points, &[[0, 1, 2], [0, 2, 3]], Some(1));
        assert_eq!(distance[..4], [1.0, 0.0, 1.0, 2.0]);
        assert!(distance[4].is_nan());
    }
}
