//! Refines the surfaces of models and says how far that goes: `refine FILE…`.

use geom::{Metric, TriangleSize, prepare, refine};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for path in std::env::args().skip(1) {
        let model = geom::io::read(&path)?;
        for surface in prepare(&model, geom::Weld::Auto)?.surfaces {
            let metric: Metric = surface.metric();
            let began = std::time::Instant::now();
            let refinement = refine(&surface.mesh, &metric, TriangleSize::ANY);
            let took = began.elapsed().as_secs_f64();
            let t = &refinement.triangulation;
            let angles = t.halfedges().map(|h| refinement.metric.angle(t, h).to_degrees());
            println!(
                "{path}: {} vertices became {}, {} triangles in common, least angle {:.1}°, complete: {}, {took:.2} s",
                surface.mesh.vertex_count(),
                t.vertex_count(),
                refinement.common.triangles.len(),
                angles.fold(180.0, f64::min),
                refinement.is_complete,
            );
        }
    }
    Ok(())
}
