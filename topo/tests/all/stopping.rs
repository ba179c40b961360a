//! Work that is stopped says so, whenever that is; work that is watched finds the same.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use topo::{Connectivity, Domain, Error, Grid, PersistenceOptions, TriangleMesh, Watch};

/// Noise: numbers with ties now and then.
fn noise(count: usize) -> Vec<u32> {
    (0..count as u64).map(|v| (v.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as u32 * 7 % 500_009).collect()
}

/// How often the watch is asked over the pairing of a field; stopped at any of these it is told of, though the observer says no
/// more than once that it should be.
fn asked<G: Domain + std::fmt::Debug>(domain: G, field: &[u32]) -> usize
where
    G::Vertex: PartialEq + std::fmt::Debug,
{
    let options = PersistenceOptions::new();
    let pairs = options.sublevel(domain, field);
    let count = AtomicUsize::new(0);
    let counting = |stop_at: usize| {
        count.store(0, Relaxed);
        let observer = || {
            if count.fetch_add(1, Relaxed) == stop_at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        options.sublevel_watched(domain, field, Watch::new(&observer))
    };
    assert_eq!(counting(usize::MAX), pairs);
    let all = count.load(Relaxed);
    for stop_at in (0..all).step_by(all / 40 + 1) {
        assert_eq!(counting(stop_at), Err(Error::Interrupted), "at {stop_at} of {all}");
    }
    assert_eq!(counting(all), pairs);
    all
}

#[test]
fn pairing_a_volume_is_stopped_wherever_it_is() {
    for connectivity in [Connectivity::Axis, Connectivity::Full] {
        let grid = Grid::new([60, 70, 80], connectivity);
        assert!(asked(&grid, &noise(60 * 70 * 80)) > 20);
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
    assert!(asked(&mesh, &noise(rows * columns)) > 4);
}

#[test]
fn and_where_nothing_is_long_it_is_asked_at_the_end() {
    assert_eq!(asked(&topo::Path::new(100_000), &noise(100_000)), 1);
}
