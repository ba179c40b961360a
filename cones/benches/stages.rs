//! Each stage of the method beside its floor: factoring the same Laplacian once.
//!
//! `cargo bench -p cones --bench stages` runs on built-in shapes; `… -- FILE…` on meshes of your own. Best of five, one thread;
//! the ratio to the floor, taken in the same run, is what can be compared between machines.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use cones::{Analysis, ConeChoice, Options, Placement, Stage, Times, unwrap_model};
use geom::{Model, Poisson, VertexId, delaunay, laplacian, prepare, shapes};

const RUNS: usize = 5;
const CONES: usize = 16;

fn main() {
    let files: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    if files.is_empty() {
        for vertices in [3_000, 29_000, 134_000] {
            bench(&format!("hare {vertices}"), &shapes::hare(vertices).into());
        }
    }
    for file in files {
        match geom::io::read(Path::new(&file)) {
            Ok(model) => bench(&file, &model),
            Err(error) => eprintln!("{file}: {error}"),
        }
    }
}

fn bench(name: &str, model: &Model) {
    let (prepared, analysis) = match (prepare(model, geom::Weld::Auto), Analysis::new(model)) {
        (Ok(prepared), Ok(analysis)) => (prepared, analysis),
        (Err(error), _) => return eprintln!("{name}: {error}"),
        (_, Err(error)) => return eprintln!("{name}: {error}"),
    };
    let surface = &prepared.surfaces[0];
    let mesh = &surface.mesh;
    let intrinsic = delaunay(mesh, &surface.metric());
    let matrix = laplacian(&intrinsic.triangulation, &intrinsic.metric);
    let boundary: Vec<VertexId> = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).collect();
    let cones = analysis.place(Placement::Persistence, CONES).expect("sixteen cones are enough");

    println!("\n{name}: {} vertices, {CONES} cones", mesh.vertex_count());
    let floor = time(|| drop(Poisson::with_points(&matrix, &boundary, &surface.points)));
    let row = |stage: &str, seconds: f64| println!("{stage:32} {seconds:9.4} s  {:6.2} x floor", seconds / floor);
    row("floor: order and factor", floor);
    let made = best(|| Analysis::new(model).expect("it was made before").times());
    row("prepare", made[Stage::Prepare as usize]);
    row("Delaunay, Laplacian, factor", made[Stage::Factor as usize]);
    row("conformal factor, extrema", made[Stage::Hierarchy as usize]);
    let placed = best(|| analysis.place(Placement::Persistence, CONES).expect("as before").times());
    row("cones by persistence", placed[Stage::Hierarchy as usize]);
    row("optimal curvatures", placed[Stage::Curvature as usize]);
    let flattened = best(|| analysis.flatten(&cones).expect("they flatten it").times);
    row("cut", flattened[Stage::Cut as usize]);
    row("scale", flattened[Stage::Scale as usize]);
    row("layout", flattened[Stage::Layout as usize]);
    row("islands", flattened[Stage::Islands as usize]);
    let options = |placement| Options { cones: ConeChoice::Count(CONES), placement, ..Options::default() };
    for (name, placement) in [("all, by persistence", Placement::Persistence), ("all, refined", Placement::Refined)] {
        row(name, time(|| drop(unwrap_model(model, &options(placement)))));
    }
}

/// The best time of each stage of several runs, in seconds.
fn best(work: impl Fn() -> Times) -> [f64; Stage::ALL.len()] {
    let runs: Vec<Times> = (0..RUNS).map(|_| black_box(&work)()).collect();
    Stage::ALL.map(|stage| runs.iter().map(|times| times.of(stage).as_secs_f64()).fold(f64::INFINITY, f64::min))
}

/// The best time of several runs, in seconds.
fn time(work: impl Fn()) -> f64 {
    let once = |_| {
        let start = Instant::now();
        black_box(&work)();
        start.elapsed().as_secs_f64()
    };
    (0..RUNS).map(once).fold(f64::INFINITY, f64::min)
}
