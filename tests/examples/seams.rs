//! What seams are like with weights: `cargo run --release -p tests --example seams -- FILE... [-n 8,16,32] [-w 0,0.5,1]`.
//!
//! For each mesh, number of cones and weight: the length of all seams, over that of the shortest (weight 0); how much they turn for their
//! length, over the same; the share of their length on edges that bend by more than 30°; the share of the sky that they see; the milliseconds that planning and cutting
//! took. Cones are placed by `iterative`.

use std::time::Instant;

use cones::internals::SeamPlan;
use cones::{Analysis, Placement, SeamFigures, SeamOptions};
use geom::{Id, VertexId, Watch};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let list = |flag: &str, or: &str| -> Vec<f64> {
        let given = arguments.iter().position(|a| a == flag).and_then(|at| arguments.get(at + 1));
        given.map_or(or, String::as_str).split(',').map(|x| x.parse().expect("a number")).collect()
    };
    let (counts, weights) = (list("-n", "8,16,32"), list("-w", "0,0.5,1"));
    let files = arguments.iter().take_while(|a| !a.starts_with('-'));
    println!(
        "{:28} {:>4} {:>5} {:>7} {:>25} {:>6} {:>6} {:>7}",
        "mesh", "n", "w", "length", "turning", "sharp", "seen", "ms"
    );
    for file in files {
        let model = match geom::shapes::by_name(file, 8000) {
            Some(shape) => shape.into(),
            None => geom::io::read(file)?,
        };
        let name = file.rsplit('/').next().unwrap_or(file);
        let analysis = Analysis::new(&model)?;
        let surfaces = geom::prepare(&model, geom::Weld::Auto)?.surfaces;
        for &count in &counts {
            let placed = analysis.place(Placement::Iterative, count as usize)?;
            let mut shortest: Option<SeamFigures> = None;
            for &weight in &weights {
                let options = SeamOptions { weight, ..SeamOptions::default() };
                let (mut figures, mut exposed, mut time) = (SeamFigures::default(), 0.0, 0.0);
                for surface in &surfaces {
                    let metric = surface.metric();
                    let here = |cone: &cones::Cone| surface.vertex.iter().position(|&v| v == cone.vertex);
                    let cones: Vec<VertexId> = placed.iter().filter_map(here).map(VertexId::new).collect();
                    let began = Instant::now();
                    let plan = SeamPlan::new(surface, &metric, model.corners(), &options, Watch::NONE)?;
                    let Ok(seams) = plan.cut(&surface.mesh, &cones, Watch::NONE) else { continue };
                    time += began.elapsed().as_secs_f64();
                    figures += SeamFigures::new(surface, &metric, &seams);
                    let triangles: Vec<[u32; 3]> =
                        surface.mesh.faces().map(|f| surface.mesh.corners(f).map(|v| v.0)).collect();
                    let seen = geom::exposure(&surface.points, &triangles);
                    for e in surface.mesh.edges().filter(|&e| seams.cut[e]) {
                        let [a, b] = surface.mesh.ends(e).map(|v| seen[v.0 as usize]);
                        exposed += 0.5 * (a + b) * metric.length(e) / surface.scale;
                    }
                }
                let edges: f64 = surfaces.iter().map(|s| s.metric().lengths().iter().sum::<f64>() / s.scale).sum();
                let mean = edges / surfaces.iter().map(|s| s.mesh.edge_count() as f64).sum::<f64>();
                let base = *shortest.get_or_insert(figures);
                println!(
                    "{name:28} {count:4} {weight:5.2} {:7.3} {:7.3} ({:.3} rad an edge) {:6.3} {:6.3} {:7.1}",
                    figures.length / base.length,
                    figures.turning_per_length() / base.turning_per_length(),
                    mean * figures.turning_per_length(),
                    figures.sharp_share(),
                    exposed / figures.length,
                    1e3 * time
                );
            }
        }
    }
    Ok(())
}
