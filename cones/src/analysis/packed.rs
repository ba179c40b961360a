//! The islands of all components side by side.

use geom::{CutMesh, EdgeData, FaceData, HalfedgeData, Interrupted, Watch};

use super::component::Component;
use super::flat::Flat;
use super::observer::{Stage, Task, Times};
use super::options::{Islands, Options};
use crate::error::Error;
use crate::flatten::{Chain, seam_lengths};
use crate::uv::{PackOptions, Packing, Part, UvMap, cut_for_fill, pack};

/// The islands of a model in the plane, each in the size of its surface.
pub(crate) struct Packed {
    /// The positions of each component's corners, by halfedge.
    pub(crate) positions: Vec<HalfedgeData<[f64; 2]>>,
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
        let mut maps: Vec<UvMap> = Vec::with_capacity(components.len());
        for (component, flat) in components.iter().zip(flats) {
            maps.push(map(component, flat));
            watch.ask(0.0)?;
        }
        let cuts = match cuts_further {
            true => further_cuts(components, &maps, options, watch.within(0.0, 0.5))?,
            false => maps.iter().map(|map| map.cut.clone()).collect(),
        };
        let (mut triangles, mut island, mut added) = (Vec::new(), Vec::new(), Vec::new());
        let mut islands: Vec<FaceData<u32>> = Vec::new();
        let mut first = 0;
        for ((component, map), cut) in components.iter().zip(&maps).zip(&cuts) {
            let mesh = &component.surface.mesh;
            watch.ask(0.5)?;
            let opened = CutMesh::open(mesh, cut);
            watch.ask(0.5)?;
            triangles.extend(map.triangles(mesh));
            islands.push(mesh.faces().map(|f| first + opened.island(f)).collect());
            island.extend(islands.last().into_iter().flat_map(|islands| islands.iter().copied()));
            first += opened.island_count() as u32;
            let new = mesh.edges().filter(|&e| cut[e] && !map.cut[e]);
            added.extend(
                new.map(|e| component.vertices_along(&Chain { vertices: mesh.ends(e).to_vec(), edges: vec![e] })),
            );
        }
        watch.ask(0.5)?;
        let packing = pack(&triangles, &island, options, watch.within(0.5, 1.0))?;
        let placed = |(component, (map, islands)): (&Component, (&UvMap, &FaceData<u32>))| {
            let mesh = &component.surface.mesh;
            let place = |h| packing.unscaled(islands[mesh.face(h)] as usize, map.position[h]);
            mesh.halfedges().map(place).collect()
        };
        let positions = components.iter().zip(maps.iter().zip(&islands)).map(placed).collect();
        Ok(Packed { positions, packing, islands, added })
    })?
}

/// A component's layout in the size of its surface, open where it is cut.
fn map(component: &Component, flat: &Flat) -> UvMap {
    let (mesh, layout) = (&component.surface.mesh, &flat.layout);
    let position = mesh.halfedges().map(|h| {
        let z = layout.corner(h);
        [flat.size * z.re, flat.size * z.im]
    });
    let is_cut = |e| {
        let h = mesh.halfedge(e);
        mesh.twin(h).is_some_and(|g| {
            [(h, mesh.next(g)), (mesh.next(h), g)].iter().any(|&(a, b)| layout.cut.wedge(a) != layout.cut.wedge(b))
        })
    };
    UvMap { position: position.collect(), cut: mesh.edges().map(is_cut).collect() }
}

/// Cuts within the share of the seams that may be added.
fn further_cuts(
    components: &[Component],
    maps: &[UvMap],
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
    let parts: Vec<Part> = components
        .iter()
        .zip(maps)
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
