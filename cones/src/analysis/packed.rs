//! The islands of all components side by side.

use geom::{CutMesh, EdgeData, FaceData, HalfedgeId, Interrupted, Watch};
use rayon::prelude::*;

use super::component::Component;
use super::flat::Flat;
use super::observer::{Stage, Task, Times};
use super::options::{Islands, Options};
use crate::error::Error;
use crate::flatten::{Chain, seam_lengths};
use crate::uv::{PackOptions, Packing, Part, Triangle, UvMap, cut_for_fill, pack};

/// The islands of a model in the plane, each in the size of its surface.
pub(crate) struct Packed {
    /// Where the triangles are, component by component.
    pub(crate) triangles: Vec<Triangle>,
    pub(crate) packing: Packing,
    /// The island of each component's triangles, numbered from 0 over all components.
    pub(crate) islands: Vec<FaceData<u32>>,
    /// Edges that were cut for packing alone, as vertices of the model along them.
    pub(crate) added: Vec<Vec<u32>>,
}

/// Packs the islands of flattened components.
///
/// # Errors
/// If they cannot be packed as is asked, or the observer has said stop.
pub(crate) fn packed(
    components: &[Component],
    flats: &[Flat],
    options: &Options,
    task: &Task,
    times: &mut Times,
) -> Result<Packed, Error> {
    let cuts_further = options.islands == Islands::Pack;
    let options = &options.packing_for_texture();
    task.stage((Stage::Pack, 0), times, |watch| {
        let cuts: Vec<EdgeData<bool>> = components.iter().zip(flats).map(|(c, flat)| cut(c, flat)).collect();
        let further = match cuts_further {
            true => Some(further_cuts(components, (flats, &cuts), options, watch.within(0.0, 0.5))?),
            false => None,
        };
        let cut = further.as_ref().unwrap_or(&cuts);
        let (mut triangles, mut island, mut added) = (Vec::new(), Vec::new(), Vec::new());
        let mut islands: Vec<FaceData<u32>> = Vec::new();
        let mut first = 0;
        for (k, (component, flat)) in components.iter().zip(flats).enumerate() {
            let mesh = &component.surface.mesh;
            watch.ask(0.5)?;
            let opened = CutMesh::open(mesh, &cut[k]);
            watch.ask(0.5)?;
            triangles.extend(mesh.faces().map(|f| mesh.sides(f).map(|h| place(flat, h))));
            islands.push(mesh.faces().map(|f| first + opened.island(f)).collect());
            island.extend(islands.last().into_iter().flat_map(|islands| islands.iter().copied()));
            first += opened.island_count() as u32;
            let new = mesh.edges().filter(|&e| cut[k][e] && !cuts[k][e]);
            added.extend(
                new.map(|e| component.vertices_along(&Chain { vertices: mesh.ends(e).to_vec(), edges: vec![e] })),
            );
        }
        watch.ask(0.5)?;
        let packing = pack(&triangles, &island, options, watch.within(0.5, 1.0))?;
        triangles.par_iter_mut().zip(&island).for_each(|(corners, &island)| {
            *corners = corners.map(|p| packing.unscaled(island as usize, p));
        });
        Ok(Packed { triangles, packing, islands, added })
    })?
}

/// Where a component's layout has a corner, in the size of the surface.
fn place(flat: &Flat, h: HalfedgeId) -> [f64; 2] {
    let z = flat.layout.corner(h);
    [flat.size * z.re, flat.size * z.im]
}

/// Where a component's layout is open.
fn cut(component: &Component, flat: &Flat) -> EdgeData<bool> {
    let (mesh, layout) = (&component.surface.mesh, &flat.layout);
    let is_cut = |e| {
        let h = mesh.halfedge(e);
        mesh.twin(h).is_some_and(|g| {
            [(h, mesh.next(g)), (mesh.next(h), g)].iter().any(|&(a, b)| layout.cut.wedge(a) != layout.cut.wedge(b))
        })
    };
    mesh.edges().map(is_cut).collect()
}

/// Cuts within the share of the seams that may be added.
fn further_cuts(
    components: &[Component],
    (flats, cuts): (&[Flat], &[EdgeData<bool>]),
    options: &PackOptions,
    watch: Watch,
) -> Result<Vec<EdgeData<bool>>, Interrupted> {
    let lengths: Vec<EdgeData<f64>> = components
        .iter()
        .map(|component| {
            let lengths = seam_lengths(&component.surface, &component.metric);
            lengths.iter().map(|l| l / component.surface.scale).collect()
        })
        .collect();
    let map = |((component, flat), cut): ((&Component, &Flat), &EdgeData<bool>)| UvMap {
        position: component.surface.mesh.halfedges().map(|h| place(flat, h)).collect(),
        cut: cut.clone(),
    };
    let maps: Vec<UvMap> = components.iter().zip(flats).zip(cuts).map(map).collect();
    let parts: Vec<Part> = components
        .iter()
        .zip(&maps)
        .zip(&lengths)
        .map(|((component, map), lengths)| Part { mesh: &component.surface.mesh, lengths, map })
        .collect();
    let seam = |part: &Part| -> f64 {
        let cut = part.mesh.edges().filter(|&e| part.map.cut[e]).map(|e| part.lengths[e]);
        cut.filter(|l| l.is_finite()).sum()
    };
    let whole: f64 = parts.iter().map(seam).sum();
    cut_for_fill(&parts, options.max_seam * whole, options, watch)
}
