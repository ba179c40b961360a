//! Taking a layout apart beside finding alone what overlaps in it, and flattening with and without all that is done about overlap, as the
//! surface grows.
//!
//! `cargo bench -p cones --bench islands`. The surface is the built-in hare with 32 cones by persistence, whose layout lies over itself.

use cones::uv::{Triangle, UvMap, overlaps, separate};
use cones::{Analysis, Islands, Options, Placement};
use divan::Bencher;
use geom::{EdgeData, Mesh, Watch, prepare, shapes};

const VERTICES: [usize; 3] = [4_000, 15_000, 60_000];

fn main() {
    divan::main();
}

/// A layout as it is before it is taken apart.
fn layout(vertices: usize) -> (Mesh, EdgeData<f64>, UvMap) {
    let model = shapes::hare(vertices).into();
    let analysis = Analysis::new(&model).expect("it is a sphere");
    let cones = analysis.place(Placement::Persistence, 32).expect("there is room for them");
    let atlas = analysis
        .flatten_with(&cones, &Options { islands: Islands::Single, ..Options::default() })
        .expect("they flatten it");
    let surface = prepare(&model, geom::Weld::Auto).expect("it was prepared before").surfaces.remove(0);
    let position = surface.mesh.halfedges().map(|h| atlas.uv[surface.corner[h] as usize]).collect();
    let map = UvMap::new(&surface.mesh, position);
    (surface.mesh.clone(), surface.metric().lengths().clone(), map)
}

#[divan::bench(args = VERTICES, sample_count = 5, sample_size = 1)]
fn find_overlaps(bencher: Bencher, vertices: usize) {
    let (_, _, map) = layout(vertices);
    let uv: &[Triangle] = map.triangles();
    bencher.bench_local(|| overlaps(uv));
}

#[divan::bench(args = VERTICES, sample_count = 5, sample_size = 1)]
fn take_apart(bencher: Bencher, vertices: usize) {
    let (mesh, lengths, map) = layout(vertices);
    bencher.bench_local(|| separate(&mesh, &lengths, None, map.clone(), Watch::NONE));
}

/// Metric, layout, and what is done about overlap.
fn flatten(bencher: Bencher, vertices: usize, islands: Islands) {
    let analysis = Analysis::new(&shapes::hare(vertices).into()).expect("it is a sphere");
    let cones = analysis.place(Placement::Persistence, 32).expect("there is room for them");
    let options = Options { islands, ..Options::default() };
    bencher.bench_local(|| analysis.flatten_with(&cones, &options).map(|atlas| atlas.uv.len()));
}

#[divan::bench(args = VERTICES, sample_count = 5, sample_size = 1)]
fn flatten_as_laid_out(bencher: Bencher, vertices: usize) {
    flatten(bencher, vertices, Islands::Single);
}

#[divan::bench(args = VERTICES, sample_count = 5, sample_size = 1)]
fn flatten_without_overlap(bencher: Bencher, vertices: usize) {
    flatten(bencher, vertices, Islands::OverlapFree);
}

#[divan::bench(args = VERTICES, sample_count = 5, sample_size = 1)]
fn flatten_to_pack(bencher: Bencher, vertices: usize) {
    flatten(bencher, vertices, Islands::Pack);
}
