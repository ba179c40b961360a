//! Work that is stopped says so, whenever that is; work that is watched finds the same.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use topo::{Connectivity, Diagram, Domain, Error, Grid, Kind, PersistenceOptions, TriangleMesh, Wasserstein, Watch};

/// Noise: numbers with ties now and then.
fn noise(count: usize) -> Vec<u32> {
    (0..count as u64).map(|v| (v.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as u32 * 7 % 500_009).collect()
}

/// How often the watch is asked over some work; stopped at any of these it is told of, though the observer says no more than once that it
/// should be. Work that is watched finds what it finds otherwise.
fn asked<T: PartialEq + std::fmt::Debug>(work: impl Fn(Watch<'_>) -> Result<T, Error>) -> usize {
    let found = work(Watch::NONE).expect("it fits");
    let count = AtomicUsize::new(0);
    let counting = |stop_at: usize| {
        count.store(0, Relaxed);
        let observer = || {
            if count.fetch_add(1, Relaxed) == stop_at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        work(Watch::new(&observer))
    };
    assert!(counting(usize::MAX).is_ok_and(|watched| watched == found));
    let all = count.load(Relaxed);
    for stop_at in (0..all).step_by(all / 40 + 1) {
        let watched = counting(stop_at);
        // Threads that race for where a vertex of a mesh points to change how often it is asked, by little.
        let is_told = count.load(Relaxed) > stop_at;
        assert!(is_told || stop_at > all - all / 8, "asked {} times after {all}", count.load(Relaxed));
        let is_right = if is_told { watched == Err(Error::Interrupted) } else { watched.is_ok_and(|it| it == found) };
        assert!(is_right, "at {stop_at} of {all}");
    }
    assert!(counting(2 * all).is_ok_and(|watched| watched == found));
    all
}

/// How often it is asked over the pairs of a field.
fn asked_for_pairs<G: Domain>(domain: G, field: &[u32]) -> usize
where
    G::Vertex: PartialEq + std::fmt::Debug,
{
    asked(|watch| PersistenceOptions::new().sublevel_watched(domain, field, watch))
}

#[test]
fn pairing_a_volume_is_stopped_wherever_it_is() {
    for connectivity in [Connectivity::Axis, Connectivity::Full] {
        let grid = Grid::new([60, 70, 80], connectivity);
        assert!(asked_for_pairs(&grid, &noise(60 * 70 * 80)) > 20);
    }
}

#[test]
fn so_is_that_of_a_mesh() {
    let (rows, columns) = (300, 400);
    let corner = |v: usize| v as u32;
    let cells = (0..rows - 1).flat_map(|y| (0..columns - 1).map(move |x| y * columns + x));
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|v| [[v, v + 1, v + columns], [v + 1, v + columns + 1, v + columns]])
        .map(|triangle| triangle.map(corner))
        .collect();
    let mesh = TriangleMesh::new(rows * columns, &triangles).expect("corners exist");
    assert!(asked_for_pairs(&mesh, &noise(rows * columns)) > 4);
}

#[test]
fn so_are_those_of_a_series_and_of_a_graph() {
    assert!(asked_for_pairs(&topo::Path::new(300_000), &noise(300_000)) > 4);
    let edges: Vec<[u32; 2]> = (1..200_000).map(|v: u32| [v, v - 1 - v % 3 % v.min(3)]).collect();
    let graph = topo::Adjacency::from_edges(200_000, &edges).expect("ends exist");
    assert!(asked_for_pairs(&graph, &noise(200_000)) > 6);
}

#[test]
fn trees_segmentations_holes_and_simpler_fields_are_stopped_wherever_they_are() {
    let (grid, field, options) = (Grid::new([500, 400], Connectivity::Full), noise(200_000), PersistenceOptions::new());
    for kind in [Kind::Minimum, Kind::Maximum] {
        assert!(asked(|watch| options.merge_tree_watched(&grid, &field, kind, watch)) > 20);
        assert!(asked(|watch| options.segmentation_watched(&grid, &field, kind, 1000, watch)) > 20);
        assert!(asked(|watch| topo::holes_watched(&grid, &field, kind, watch)) > 20);
        assert!(asked(|watch| topo::pairs_and_holes_watched(&grid, &field, kind, watch)) > 20);
    }
    assert!(asked(|watch| options.simplify_watched(&grid, &field, 1000, watch)) > 40);
    let filled = Grid::new([500, 400], Connectivity::Freudenthal);
    let smooth: Vec<u32> =
        (0..200_000u32).map(|v| (v / 400).abs_diff(250).pow(2) + (v % 400).abs_diff(100 + v / 3000).pow(2)).collect();
    for field in [field, smooth] {
        assert!(asked(|watch| options.contour_tree_watched(&filled, &field, watch)) > 10);
    }
}

#[test]
fn distances_are_stopped_wherever_they_are() {
    let [a, b] = [0, 1000].map(|first| {
        let coordinates: Vec<f64> = noise(first + 600).into_iter().skip(first).map(f64::from).collect();
        let finite = coordinates.chunks(2).map(|pair| (pair[0], pair[0] + pair[1])).collect();
        Diagram { kind: Kind::Minimum, finite, essential: vec![0.0] }
    });
    for (order, error, least) in [(f64::INFINITY, 0.0, 1000), (2.0, 0.01, 1000), (2.0, 0.0, 300)] {
        let measure = Wasserstein::new(order).relative_error(error);
        assert!(asked(|watch| measure.distance_watched(&a, &b, watch)) > least);
        assert!(asked(|watch| measure.matching_watched(&a, &b, watch)) > least);
    }
}
