//! The default search for cones, coarse to fine, beside the full one, greedy cones, and the floor: factoring the same Laplacian once.
//!
//! `cargo bench -p cones --bench searches` runs on a built-in shape; `… -- FILE…` on meshes of your own, with `--brief` without the
//! full search. For each number of cones, and the automatic one: floors from the factored Laplacian to the cones (one thread; floor and
//! search in turns, the best of each), the predicted norm and area distortion, as shares of the full search's.

use std::path::Path;
use std::time::Instant;

use cones::{Analysis, ConeChoice, Options, Placement, Prediction, Search, Stage};
use geom::{Model, Poisson, SymmetricMatrix, VertexId, delaunay, laplacian, prepare, shapes};

/// Floor and search are timed so often at least, and for so many seconds.
const LEAST_RUNS: usize = 3;
const LEAST_SECONDS: f64 = 4.0;

/// What a search takes, and what is predicted for its cones.
struct Run {
    seconds: f64,
    count: usize,
    norm: f64,
    area_distortion: f64,
}

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
    let Ok(analysis) = Analysis::new(model) else { return eprintln!("{name}: it cannot be analysed") };
    let Some(floor) = Floor::new(model) else { return eprintln!("{name}: it cannot be prepared") };
    println!("{name}: {} vertices", analysis.topology().vertices);
    let mut least = f64::INFINITY;
    let counts = [4, 8, 16, 32].map(|count| (count.to_string(), ConeChoice::Count(count)));
    for (label, cones) in counts.into_iter().chain([("automatic".into(), ConeChoice::Automatic)]) {
        let run = |placement, search| {
            let analysis = Analysis::new(model).expect("it was analysed before");
            let options = Options { cones: cones.clone(), placement, search, ..Options::default() };
            let cones = analysis.choose(&options).expect("cones are found");
            let Prediction { log_scale_norm: norm, area_distortion, .. } = cones.prediction();
            Run { seconds: cones.times().of(Stage::Hierarchy).as_secs_f64(), count: cones.len(), norm, area_distortion }
        };
        let start = Instant::now();
        let (mut unit, mut fast) = (floor.seconds(), run(Placement::Refined, Search::CoarseToFine));
        for done in 1.. {
            if done >= LEAST_RUNS && start.elapsed().as_secs_f64() >= LEAST_SECONDS {
                break;
            }
            unit = unit.min(floor.seconds());
            fast.seconds = fast.seconds.min(run(Placement::Refined, Search::CoarseToFine).seconds);
        }
        least = least.min(unit);
        let Run { seconds, count, norm, area_distortion } = fast;
        print!(
            "{label:>9}: coarse to fine {:.2} floors, N {count}, norm {norm:.4}, D {area_distortion:.3}",
            seconds / unit
        );
        if !is_brief {
            let full = run(Placement::Refined, Search::Full);
            let [norm_share, share] = [norm / full.norm, area_distortion / full.area_distortion];
            let greedy = run(Placement::Greedy, Search::Full);
            let [of_full, of_greedy] = [&full, &greedy].map(|run| run.seconds / unit);
            print!(" | full {of_full:.2} floors, N {}: norm {norm_share:.3}, D {share:.3} of it", full.count);
            print!(" | greedy {of_greedy:.2} floors, norm {:.3} of full", greedy.norm / full.norm);
        }
        println!();
    }
    let start = Instant::now();
    analysis.preview(32).expect("nobody says stop");
    print!("a floor is {least:.3} s; preview: {:.2} floors at first, ", start.elapsed().as_secs_f64() / least);
    let start = Instant::now();
    let preview = analysis.preview(16).expect("nobody says stop");
    println!("then {:.1} µs; 16 cones: {:?}", 1e6 * start.elapsed().as_secs_f64(), preview.prediction);
}

/// Ordering and factoring the Laplacian of the first component.
struct Floor {
    matrix: SymmetricMatrix,
    boundary: Vec<VertexId>,
    points: Vec<[f64; 3]>,
}

impl Floor {
    fn new(model: &Model) -> Option<Self> {
        let mut prepared = prepare(model, geom::Weld::Auto).ok()?;
        let surface = prepared.surfaces.swap_remove(0);
        let mesh = &surface.mesh;
        let intrinsic = delaunay(mesh, &surface.metric());
        let boundary = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).collect();
        Some(Self { matrix: laplacian(&intrinsic.triangulation, &intrinsic.metric), boundary, points: surface.points })
    }

    /// How long it takes, once.
    fn seconds(&self) -> f64 {
        let start = Instant::now();
        drop(Poisson::with_points(&self.matrix, &self.boundary, &self.points));
        start.elapsed().as_secs_f64()
    }
}
