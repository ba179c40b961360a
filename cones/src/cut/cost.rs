//! What an edge costs a seam: its length, less a discount where a seam is welcome.
//!
//! Seams are least seen along *sharp* edges, where shading breaks off anyway, and in *hidden* places, which see little of the
//! sky ([`exposure`](geom::exposure): hollows, undersides, gaps; cf. Sheffer & Hart 2002, "Seamster: inconspicuous low-distortion texture seam
//! layout"). With the discount d of an edge a seam on the way of least cost is at most 1/(1 - d) times as long as the shortest.

use std::f64::consts::PI;

use geom::vector::{Vec3, angle, normal};
use geom::{EdgeData, EdgeId, Id, Interrupted, Mesh, Surface, VertexId, Watch, edges_at, exposure_watched};
use rayon::prelude::*;

/// What a sharp edge is cheaper by at full weight, as a share of its length. At half the weight, the default, a way along sharp
/// edges is taken that is up to two thirds longer; seams as a whole become little longer, since most have none beside them. With .5 part of 1,500 to
/// 12,000 vertices with 8 cones has .66 to .79 of its seams along sharp edges, with this .81 to .85, fandisk .52 and .82; on 33 meshes
/// seams are .6 % longer.
const SHARP: f64 = 0.8;
/// What a wholly hidden edge is cheaper by. It moves seams little: at half the weight those of part, hare, bunny, rocker arm, fertility
/// and octaflower, with 8 and 32 cones, see as much of the sky as the shortest to 0.01 but for octaflower, where sharp edges win.
const HIDDEN: f64 = 0.15;
/// Up to this bend an edge is an edge of a smooth surface's triangles, and up to eight times what those about it are bent by one of a rough
/// surface's: seams that keep to the bends of a rough terrain turn as much as the shortest.
const SMOOTH: f64 = 10.0 * PI / 180.0;
/// From so much more on it is as sharp as can be.
const CREASE: f64 = 30.0 * PI / 180.0;

/// The watch is asked once for so many bends.
const EDGES_AT_ONCE: usize = 1 << 16;

/// The angle between the normals of the two triangles at an edge: 0 where it is flat, on the boundary, and beside a triangle
/// without area.
pub(crate) fn bend(mesh: &Mesh, points: &[Vec3], e: EdgeId) -> f64 {
    let h = mesh.halfedge(e);
    let Some(g) = mesh.twin(h) else { return 0.0 };
    let normals = [h, g].map(|h| normal(mesh.corners(mesh.face(h)).map(|v| points[v.0 as usize])));
    Some(angle(normals[0], normals[1])).filter(|bend| bend.is_finite()).unwrap_or(0.0)
}

/// For each edge the share of its length that it costs, with a weight from 0 (all of it) to 1.
///
/// # Errors
/// If it is stopped.
pub(crate) fn shares(surface: &Surface, weight: f64, watch: Watch) -> Result<EdgeData<f64>, Interrupted> {
    let Surface { mesh, points, .. } = surface;
    if weight <= 0.0 {
        return Ok(EdgeData::constant(mesh.edge_count(), 1.0));
    }
    let triangles: Vec<[u32; 3]> = mesh.faces().map(|f| mesh.corners(f).map(|v| v.0)).collect();
    let seen = exposure_watched(points, &triangles, watch)?;
    let bends = bends(surface, watch)?;
    watch.ask(1.0)?;
    let rough = |v: VertexId| median(edges_at(mesh, v).map(|(e, _)| bends[e]));
    let share = |e: EdgeId| {
        let [a, b] = mesh.ends(e);
        let sharp = match bends[e] > SMOOTH {
            true => ((bends[e] - SMOOTH.max(8.0 * rough(a).min(rough(b)))) / CREASE).clamp(0.0, 1.0),
            false => 0.0,
        };
        let hidden = 1.0 - 0.5 * (seen[a.0 as usize] + seen[b.0 as usize]);
        1.0 - weight * (SHARP * sharp).max(HIDDEN * hidden)
    };
    let shares: Vec<f64> = (0..mesh.edge_count()).into_par_iter().map(|e| share(EdgeId::new(e))).collect();
    Ok(shares.into())
}

/// The bend of each edge.
fn bends(Surface { mesh, points, .. }: &Surface, watch: Watch) -> Result<EdgeData<f64>, Interrupted> {
    let mut bends: Vec<f64> = vec![0.0; mesh.edge_count()];
    bends.par_chunks_mut(EDGES_AT_ONCE).enumerate().try_for_each(|(k, bends)| {
        watch.ask(1.0)?;
        let first = k * EDGES_AT_ONCE;
        bends.iter_mut().zip(first..).for_each(|(value, e)| *value = bend(mesh, points, EdgeId(e as u32)));
        Ok(())
    })?;
    Ok(bends.into())
}

/// The lower one where two are in the middle; 0 of none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::{Model, prepare, shapes};

    #[test]
    fn without_weight_an_edge_costs_its_length_and_with_it_less_but_never_nothing() {
        let surface = &prepare(&Model::from(shapes::part(900)), geom::Weld::Auto).unwrap().surfaces[0];
        assert!(shares(surface, 0.0, Watch::NONE).unwrap().iter().all(|share| *share == 1.0));
        let [half, full] = [0.5, 1.0].map(|weight| shares(surface, weight, Watch::NONE).unwrap());
        for (half, full) in half.iter().zip(full.iter()) {
            assert!(*full <= *half && *half <= 1.0 && *full >= 1.0 - SHARP.max(HIDDEN));
            assert!((1.0 - full - 2.0 * (1.0 - half)).abs() < 1e-12);
        }
        let is_crease = |e: &EdgeId| bend(&surface.mesh, &surface.points, *e) > SMOOTH + CREASE;
        assert!(surface.mesh.edges().filter(is_crease).all(|e| full[e] <= 1.0 - SHARP));
        assert!(surface.mesh.edges().filter(is_crease).count() > 20);
    }
}
