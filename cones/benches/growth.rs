//! How everything grows with the number of vertices: seconds, times one plain factorization, peak memory, exponent.
//!
//! `cargo bench -p cones --bench growth` runs on hares of 3 to 134 thousand vertices; `… -- 437000 1000000` on others, `… --
//! FILE…` on meshes of your own. One thread, best of up to five. Seconds are processor time where the system tells (Linux), so
//! that other programs matter little. What took longer than [`PATIENCE`] is not tried on larger meshes.

use std::fmt::Write;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use cones::{Analysis, ConeChoice, Options, Placement, unwrap_model};
use geom::{Model, Poisson, VertexId, delaunay, laplacian, prepare, shapes};

const RUNS: usize = 5;
/// In seconds: work that takes longer than a fifth of it is done once.
const PATIENCE: f64 = 30.0;

/// What one piece of work took on one mesh.
#[derive(Clone, Copy)]
struct Cost {
    seconds: f64,
    ratio: f64,
    /// In bytes; nothing where the system does not tell.
    peak: Option<u64>,
}

/// A piece of work, with its costs by mesh.
struct Row {
    name: String,
    costs: Vec<Option<Cost>>,
}

struct Table {
    meshes: Vec<(String, usize)>,
    rows: Vec<Row>,
    floor: f64,
}

fn main() {
    let mut names: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    if names.is_empty() {
        names = ["3000", "29000", "134000"].map(String::from).to_vec();
    }
    let mut table = Table { meshes: Vec::new(), rows: Vec::new(), floor: 0.0 };
    for name in names {
        let model = match name.parse() {
            Ok(vertices) => shapes::hare(vertices).into(),
            Err(_) => match geom::io::read(Path::new(&name)) {
                Ok(model) => model,
                Err(error) => {
                    eprintln!("{name}: {error}");
                    continue;
                }
            },
        };
        table.add(name, &model);
        println!("{}", table.last_mesh());
    }
    println!("{}", table.growth());
}

impl Table {
    /// Measures everything on a mesh.
    fn add(&mut self, name: String, model: &Model) {
        let (prepared, analysis) = match (prepare(model, geom::Weld::Auto), Analysis::new(model)) {
            (Ok(prepared), Ok(analysis)) => (prepared, analysis),
            (Err(error), _) => return eprintln!("{name}: {error}"),
            (_, Err(error)) => return eprintln!("{name}: {error}"),
        };
        let surface = &prepared.surfaces[0];
        let intrinsic = delaunay(&surface.mesh, &surface.metric());
        let matrix = laplacian(&intrinsic.triangulation, &intrinsic.metric);
        self.meshes.push((name, surface.mesh.vertex_count()));
        let mesh = &surface.mesh;
        let boundary: Vec<VertexId> = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).collect();
        self.row("order and factor (floor)", || {
            drop(black_box(Poisson::with_points(&matrix, &boundary, &surface.points)));
        });
        self.row("analyse", || drop(black_box(Analysis::new(model))));
        for count in [16, 64] {
            for placement in Placement::ALL {
                self.row(&format!("place {count} by {}", placement.name()), || {
                    let _ = black_box(analysis.place(placement, count));
                });
            }
        }
        for placement in [Placement::Persistence, Placement::Refined] {
            let options = Options { cones: ConeChoice::Count(16), placement, ..Options::default() };
            self.row(&format!("unwrap 16 by {}", placement.name()), || {
                let _ = black_box(unwrap_model(model, &options));
            });
        }
    }

    /// Measures one piece of work on the mesh added last. The first row is the floor of the others.
    fn row(&mut self, name: &str, work: impl Fn()) {
        let mesh = self.meshes.len() - 1;
        let place = self.rows.iter().position(|row| row.name == name).unwrap_or_else(|| {
            self.rows.push(Row { name: name.to_owned(), costs: vec![None; mesh] });
            self.rows.len() - 1
        });
        let costs = &mut self.rows[place].costs;
        let tried = costs.last().is_none_or(|last| last.is_some_and(|cost| cost.seconds < PATIENCE));
        let cost = tried.then(|| {
            let (seconds, peak) = best(work);
            if place == 0 {
                self.floor = seconds;
            }
            Cost { seconds, ratio: seconds / self.floor, peak }
        });
        costs.push(cost);
    }

    /// The costs on the mesh added last, in Markdown.
    fn last_mesh(&self) -> String {
        let Some((name, vertices)) = self.meshes.last() else { return String::new() };
        let mut text =
            format!("\n{name}: {vertices} vertices\n\n| | seconds | × floor | peak MB |\n|---|---|---|---|\n");
        for row in &self.rows {
            let Some(Some(cost)) = row.costs.last() else { continue };
            let peak = cost.peak.map_or("–".to_owned(), |bytes| (bytes >> 20).to_string());
            let _ = writeln!(text, "| {} | {:.4} | {:.2} | {peak} |", row.name, cost.seconds, cost.ratio);
        }
        text
    }

    /// The exponent of each row between the first mesh and the last that it was measured on.
    fn growth(&self) -> String {
        let mut text = "\n| | exponent |\n|---|---|\n".to_owned();
        for row in &self.rows {
            let costs = self.meshes.iter().zip(&row.costs);
            let mut measured =
                costs.filter_map(|((_, n), cost)| cost.map(|cost| ((*n as f64).ln(), cost.seconds.ln())));
            if let (Some((n, seconds)), Some((most, longest))) = (measured.next(), measured.next_back()) {
                let _ = writeln!(text, "| {} | {:.2} |", row.name, (longest - seconds) / (most - n));
            }
        }
        text
    }
}

/// The best time of several runs, in seconds, and the most memory in use meanwhile.
fn best(work: impl Fn()) -> (f64, Option<u64>) {
    reset_peak();
    let mut seconds = f64::INFINITY;
    let mut spent = 0.0;
    for run in 0..RUNS {
        if run > 0 && spent > PATIENCE / 5.0 {
            break;
        }
        let time = time(&work);
        spent += time;
        seconds = seconds.min(time);
    }
    (seconds, peak())
}

/// The mean time of as many runs as the clock needs to be exact.
fn time(work: &impl Fn()) -> f64 {
    const LEAST: f64 = 0.1;
    let (before, start) = (processor_time(), Instant::now());
    let passed = || match (before, processor_time()) {
        (Some(before), Some(now)) => now - before,
        _ => start.elapsed().as_secs_f64(),
    };
    let mut runs = 0.0;
    loop {
        work();
        runs += 1.0;
        let passed = passed();
        if passed >= LEAST {
            return passed / runs;
        }
    }
}

/// The seconds that this thread has had a processor; on Linux.
fn processor_time() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?)
}

/// Lets the system forget the most memory that was in use; on Linux.
fn reset_peak() {
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// The most memory in use since, in bytes; on Linux.
fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    Some(1024 * line.split_whitespace().nth(1)?.parse::<u64>().ok()?)
}
