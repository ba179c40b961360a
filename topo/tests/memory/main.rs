//! What a call takes beyond its input, as the allocator counts it: at most 16 bytes a vertex for a tree of white noise.
//!
//! Noise is the worst there is of fields that one measures: up to a fifth of its vertices are minima. There is one test in here, as others
//! would allocate meanwhile.

use cap::Cap;
use std::alloc::System;
use topo::{Connectivity, Domain, Grid, Kind};

#[global_allocator]
static ALLOCATED: Cap<System> = Cap::new(System, usize::MAX);

/// Tables of stencils and the like, which do not grow with the field.
const TABLES: usize = 1 << 18;

/// A number that looks random (the finaliser of `SplitMix64`).
fn hash(v: usize) -> f64 {
    let mut bits = (v as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ bits >> 31) >> 11) as f64 / (1u64 << 53) as f64
}

/// The most bytes a vertex that were ever allocated at once beside the field, up to the end of a call.
fn most<G: Domain>(domain: G, field: &[f64], name: &str) -> f64 {
    let before = ALLOCATED.allocated();
    let tree = topo::merge_tree(domain, field, Kind::Minimum).expect("it fits");
    let of_tree = (ALLOCATED.allocated() - before) as f64 / field.len() as f64;
    let most = (ALLOCATED.max_allocated() - before - TABLES) as f64 / field.len() as f64;
    println!("{name}: a tree of {} leaves has {of_tree:.1}, most so far {most:.1}", tree.leaf_count());
    most
}

#[test]
fn a_tree_takes_sixteen_bytes_a_vertex_at_most() {
    let field: Vec<f64> = (0..1 << 18).map(hash).collect();
    for connectivity in [Connectivity::Full, Connectivity::Freudenthal, Connectivity::Axis] {
        let picture = most(&Grid::new([512; 2], connectivity), &field, &format!("picture, {connectivity:?}"));
        let volume = most(&Grid::new([64; 3], connectivity), &field, &format!("volume, {connectivity:?}"));
        assert!(picture <= 16.0 && volume <= 16.0);
    }
}
