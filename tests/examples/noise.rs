//! How stable the cones of every method are under noise, as a table in Markdown; see [`tests::noise`].
//!
//! `cargo run --release -p tests --example noise -- N SEEDS FILE…`, meshes in one part; without files on built-in shapes

use geom::Mesh;
use geom::shapes;
use std::error::Error;
use std::path::Path;
use tests::noise::{Clean, RULES, Stability};

/// Root mean square displacements in mean edge lengths.
const STRENGTHS: [f64; 3] = [0.1, 0.2, 0.3];

/// A name, a mesh and its points.
type Surface = (String, Mesh, Vec<[f64; 3]>);

/// By strength, then by rule.
type Results = [Vec<Vec<Stability>>; 3];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let count = arguments.next().map_or(Ok(8), |n| n.parse())?;
    let seeds = arguments.next().map_or(Ok(3), |n| n.parse())?;
    let files: Vec<String> = arguments.collect();
    let mut all: Results = Default::default();
    println!("| mesh | method | {} |\n|---|---|---|---|---|", STRENGTHS.map(|s| format!("noise {s} h")).join(" | "));
    for (name, mesh, points) in surfaces(&files)? {
        let clean = Clean::new(mesh, points, count)?;
        let mut found: Results = Default::default();
        for (strength, found) in STRENGTHS.iter().zip(&mut found) {
            for seed in 0..seeds {
                found.push(clean.under_noise(*strength, seed)?);
            }
        }
        print(&name, &found);
        all.iter_mut().zip(found).for_each(|(all, found)| all.extend(found));
    }
    print("all", &all);
    println!(
        "\n{count} cones, {seeds} seeds: share of clean cones recovered within 5 h, norm on the clean mesh over clean"
    );
    Ok(())
}

/// The surfaces of the files, or built-in ones, with their names.
fn surfaces(files: &[String]) -> Result<Vec<Surface>, Box<dyn Error>> {
    let mut surfaces = Vec::new();
    for file in files {
        let model = geom::io::read(Path::new(file))?;
        let prepared = geom::prepare(&model, geom::Weld::Auto)?.surfaces.swap_remove(0);
        let points = prepared.vertex.iter().map(|&v| model.points()[v as usize]).collect();
        let name = Path::new(file).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        surfaces.push((name, prepared.mesh, points));
    }
    if files.is_empty() {
        let shape = |name: &str| {
            let shape = shapes::by_name(name, 4000).ok_or("no such shape")?;
            Ok::<_, Box<dyn Error>>((name.to_owned(), shape.mesh(), shape.points))
        };
        surfaces = ["hare", "part", "terrain"].map(shape).into_iter().collect::<Result<_, _>>()?;
    }
    Ok(surfaces)
}

/// A row for each rule.
fn print(name: &str, found: &Results) {
    for (r, (method, is_smooth)) in RULES.iter().enumerate() {
        let cell = |runs: &Vec<Vec<Stability>>| {
            let mean = Stability::mean(&runs.iter().map(|run| run[r]).collect::<Vec<_>>());
            format!("{:.2}, {:.3}", mean.recovered, mean.norm)
        };
        let method = format!("{method:?}{}", if *is_smooth { " --smooth" } else { "" }).to_lowercase();
        println!("| {name} | `{method}` | {} |", found.each_ref().map(cell).join(" | "));
    }
}
