//! Each stage of the method beside its floor: factoring the same Laplacian once.
//!
//! `cargo bench -p cones --bench stages` runs on built-in shapes; `… -- FILE…` on meshes of your own. Best of five, one thread;
//! the ratio to the floor, taken in the same run, is what can be compared between machines.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use cones::{Angles, ConeChoice, ConeHierarchy, ConformalFactor, Layout, Method, Operators, Options, Seams};
use geom::{Model, Poisson, Surface, VertexData, VertexId, laplacian, prepare, shapes};

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
    let prepared = match prepare(model, false) {
        Ok(prepared) => prepared,
        Err(error) => return eprintln!("{name}: {error}"),
    };
    let surface: &Surface = &prepared.surfaces[0];
    let (mesh, metric) = (&surface.mesh, surface.metric());
    let operators =
        Operators::with_points(mesh, &metric, &surface.points).expect("the shape has no degenerate triangles");
    let factor = ConformalFactor::new(&operators);
    let hierarchy = ConeHierarchy::new(&operators, &factor);
    let cones: Vec<VertexId> =
        hierarchy.cones(&operators, mesh, Method::Persistence, CONES).iter().map(|cone| cone.vertex).collect();
    let curvatures =
        cones::cone_curvatures(&operators, mesh, &cones, Angles::Optimal).expect("sixteen cones are enough");
    let mut target = VertexData::constant(mesh.vertex_count(), 0.0);
    for (&v, &k) in cones.iter().zip(&curvatures.curvature) {
        target[v] = k;
    }
    let seams = Seams::new(mesh, metric.lengths(), &cones).expect("sixteen cones cut any surface");
    let scaling = cones::scale(mesh, &metric, &operators, &target, &curvatures.predicted).expect("it converges");
    let boundary: Vec<VertexId> = mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).collect();
    let options = |method| Options { cones: ConeChoice::Count(CONES), method, ..Options::default() };

    println!("\n{name}: {} vertices, {CONES} cones, {} Newton steps", mesh.vertex_count(), scaling.steps);
    let floor = time(|| drop(Poisson::with_points(&operators.laplacian, &boundary, &surface.points)));
    let row = |stage: &str, seconds: f64| println!("{stage:32} {seconds:9.4} s  {:6.2} x floor", seconds / floor);
    row("floor: order and factor", floor);
    row("prepare", time(|| drop(prepare(model, false))));
    row("Delaunay, Laplacian, factor", time(|| drop(Operators::with_points(mesh, &metric, &surface.points))));
    row("Laplacian alone", time(|| drop(laplacian(&operators.mesh, &operators.metric))));
    row("conformal factor", time(|| drop(ConformalFactor::new(&operators))));
    row("persistence, hierarchy", time(|| drop(ConeHierarchy::new(&operators, &factor))));
    row("optimal curvatures", time(|| drop(cones::cone_curvatures(&operators, mesh, &cones, Angles::Optimal))));
    row("cut", time(|| drop(Seams::new(mesh, metric.lengths(), &cones))));
    row("scale", time(|| drop(cones::scale(mesh, &metric, &operators, &target, &curvatures.predicted))));
    row("layout", time(|| drop(Layout::new(mesh, &scaling, &seams.cut))));
    for (name, method) in [("all, by persistence", Method::Persistence), ("all, refined", Method::Refined)] {
        row(name, time(|| drop(cones::unwrap(model, &options(method), &mut |_| ()))));
    }
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
