//! Feature points of a surface: the persistent extrema of its mean curvature and of its conformal factor, side by side.
//!
//! Mean curvature is high on ridges and tips and low in hollows, and full of small extrema that persistence sorts out. The conformal
//! factor smooths curvature by one Poisson solve: few extrema, at the ends of limbs and between them.
//!
//! `cargo run --release --example features [shape] [vertices]`, with a shape that `cones shape` knows

use cones::Analysis;
use geom::shapes::{self, Shape};
use geom::{Id, Mesh, Metric, VertexId};
use std::error::Error;
use topo::{Hierarchy, Kind};

const ROWS: usize = 10;

/// The mean curvature H of each vertex, from Lx = 2 H A n for the cotangent Laplacian L, the points x, the vertex areas A and the
/// outer normals n (Meyer, Desbrun, Schröder & Barr 2003, "Discrete differential-geometry operators for triangulated
/// 2-manifolds"). Positive where the surface is convex; a boundary has no meaning.
fn mean_curvature(shape: &Shape, mesh: &Mesh, metric: &Metric) -> Vec<f64> {
    let laplacian = geom::laplacian(mesh, metric).to_csr();
    let areas = metric.vertex_areas(mesh);
    let rows = laplacian.outer_iterator().zip(normals(shape)).zip(areas.iter());
    rows.map(|((row, normal), area)| {
        let along = |v: usize| (0..3).map(|axis| shape.points[v][axis] * normal[axis]).sum::<f64>();
        let length = normal.map(|n| n * n).iter().sum::<f64>().sqrt();
        row.iter().map(|(v, weight)| weight * along(v)).sum::<f64>() / (2.0 * area * length)
    })
    .collect()
}

/// The sum of the normals of the triangles at each vertex, by area.
fn normals(shape: &Shape) -> Vec<[f64; 3]> {
    let mut normals = vec![[0.0; 3]; shape.points.len()];
    for triangle in &shape.triangles {
        let [a, b, c] = triangle.map(|v| shape.points[v as usize]);
        let (p, q) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
        let cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
        for v in triangle {
            normals[*v as usize].iter_mut().zip(cross).for_each(|(sum, part)| *sum += part);
        }
    }
    normals
}

fn print(name: &str, hierarchy: &Hierarchy<VertexId, f64>, shape: &Shape) {
    println!("\n{name}: {} extrema; the most persistent:", hierarchy.extrema().len());
    println!("rank  kind       value  persistence  at");
    let strongest = hierarchy.by_persistence(1).first().map_or(0.0, |first| first.persistence);
    for (rank, extremum) in (1..).zip(hierarchy.by_persistence(ROWS)) {
        let kind = if extremum.kind == Kind::Minimum { "minimum" } else { "maximum" };
        let [x, y, z] = shape.points[extremum.vertex.index()];
        let bar = "#".repeat((24.0 * extremum.persistence / strongest).ceil() as usize);
        let (value, persistence) = (extremum.value, extremum.persistence);
        println!("{rank:4}  {kind}  {value:8.3}  {persistence:11.3}  ({x:6.3}, {y:6.3}, {z:6.3})  {bar}");
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "hare".into());
    let vertices = arguments.next().map_or(Ok(5000), |count| count.parse())?;
    let shape = shapes::by_name(&name, vertices).ok_or_else(|| format!("{name} is none of {:?}", shapes::NAMES))?;
    let mesh = shape.mesh();
    let metric = Metric::from_points(&mesh, &shape.points);
    println!("{name}: {} vertices", shape.points.len());

    let curvature = mean_curvature(&shape, &mesh, &metric);
    let surface = topo::Rings::new(&mesh, |v| !mesh.is_boundary_vertex(v));
    print("mean curvature", &topo::persistence(surface, &curvature)?.hierarchy(), &shape);

    let factor = Analysis::new(&shape.clone().into())?.conformal_factor();
    print("conformal factor", &topo::persistence(surface, &factor)?.hierarchy(), &shape);
    Ok(())
}
