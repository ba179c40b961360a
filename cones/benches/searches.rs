//! The default search for cones, coarse to fine, beside the full one, greedy cones, and the floor: factoring the same Laplacian once.
//!
//! `cargo bench -p cones --bench searches` runs on a built-in shape; `… -- FILE…` on meshes of your own, with `--brief` without the
//! full search. For each number of cones, and the automatic one: floors from the factored Laplacian to the cones (best of three, one
//! thread), the predicted norm and area distortion, as shares of the full search's.

use std::path::Path;
use std::time::Instant;

use cones::{Analysis, ConeChoice, Options, Placement, Search, Stage};
use geom::{Model, Poisson, VertexId, delaunay, laplacian, prepare, shapes};

const RUNS: usize = 3;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_brief = arguments.iter().any(|a| a == "--brief");
    let files: Vec<&String> = arguments.iter().filter(|a| !a.starts_with('-')).collect();
    if files.is_empty() {
        bench("hare 29000", &shapes::hare(29_000).into(), is_brief);
    }
    for file in files {
        match geom::io::read(Path::new(file)) {
            Ok(model) => bench(file, &model, is_brief),
            Err(error) => eprintln!("{file}: {error}"),
        }
    }
}

fn bench(name: &str, model: &Model, is_brief: bool) {
    let floor = floor(model);
    let Ok(analysis) = Analysis::new(model) else { return eprintln!("{name}: it cannot be analysed") };
    println!("{name}: {} vertices, floor {floor:.3} s", analysis.topology().vertices);
    let counts = [4, 8, 16, 32].map(|count| (count.to_string(), ConeChoice::Count(count)));
    for (label, cones) in counts.into_iter().chain([("automatic".into(), ConeChoice::Automatic)]) {
        let run = |placement, search| {
            let analysis = Analysis::new(model).expect("it was analysed before");
            let options = Options { cones: cones.clone(), placement, search, ..Options::default() };
            let found = analysis.choose(&options).expect("cones are found");
            let seconds = found.times().of(Stage::Hierarchy).as_secs_f64() / floor;
            (seconds, found.len(), found.prediction().log_scale_norm, found.prediction().area_distortion)
        };
        let best = (0..RUNS).map(|_| run(Placement::Refined, Search::CoarseToFine));
        let fast = best.min_by(|a, b| a.0.total_cmp(&b.0)).expect("there are runs");
        print!("{label:>9}: coarse to fine {:.2} floors, N {}, norm {:.4}, D {:.3}", fast.0, fast.1, fast.2, fast.3);
        if !is_brief {
            let full = run(Placement::Refined, Search::Full);
            let [norm, excess] = [fast.2 / full.2, fast.3 / full.3];
            print!(" | full {:.2} floors, N {}: norm {norm:.3}, D {excess:.3} of it", full.0, full.1);
            let greedy = run(Placement::Greedy, Search::Full);
            print!(" | greedy {:.2} floors, norm {:.3} of full", greedy.0, greedy.2 / full.2);
        }
        println!();
    }
    let start = Instant::now();
    analysis.preview(32).expect("nobody says stop");
    print!("preview: {:.2} floors at first, ", start.elapsed().as_secs_f64() / floor);
    let start = Instant::now();
    let preview = analysis.preview(16).expect("nobody says stop");
    println!("then {:.1} µs; 16 cones: {:?}", 1e6 * start.elapsed().as_secs_f64(), preview.prediction);
}

/// The best time to order and factor, in seconds, of the first component.
fn floor(model: &Model) -> f64 {
    let Ok(prepared) = prepare(model, geom::Weld::Auto) else { return f64::NAN };
    let surface = &prepared.surfaces[0];
    let mesh = &surface.mesh;
    let intrinsic = delaunay(mesh, &surface.metric());
    let matrix = laplacian(&intrinsic.triangulation, &intrinsic.metric);
    let boundary: Vec<VertexId> = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).collect();
    let once = |_| {
        let start = Instant::now();
        drop(Poisson::with_points(&matrix, &boundary, &surface.points));
        start.elapsed().as_secs_f64()
    };
    (0..RUNS).map(once).fold(f64::INFINITY, f64::min)
}
