//! The islands of all components side by side.

use geom::HalfedgeId;

use super::component::Component;
use super::flat::Flat;
use super::observer::{Stage, Task, Times};
use crate::error::Error;
use crate::uv::{PackOptions, Packing, pack};

/// The islands of a model in the plane, each in the size of its surface.
pub(crate) struct Packed {
    /// The corner of the model and the position of each corner of a component's triangle.
    pub(crate) corners: Vec<(u32, [f64; 2])>,
    pub(crate) packing: Packing,
}

/// Packs the islands of flattened components.
///
/// # Errors
/// If they cannot be packed as is asked, or the observer has said stop.
pub(crate) fn packed(
    components: &[Component],
    flats: &[Flat],
    options: &PackOptions,
    task: &Task,
    times: &mut Times,
) -> Result<Packed, Error> {
    task.stage((Stage::Pack, 0), times, |watch| {
        let (mut triangles, mut islands, mut corner) = (Vec::new(), Vec::new(), Vec::new());
        let mut first = 0;
        for (component, flat) in components.iter().zip(flats) {
            let (mesh, layout, size) = (&component.surface.mesh, &flat.layout, flat.size);
            let position = |h: HalfedgeId| {
                let z = layout.corner(h);
                [size * z.re, size * z.im]
            };
            for f in mesh.faces() {
                triangles.push(mesh.sides(f).map(position));
                islands.push(first + layout.cut.island(f));
                corner.push(mesh.sides(f).map(|h| component.surface.corner[h]));
            }
            first += layout.cut.island_count() as u32;
        }
        let packing = pack(&triangles, &islands, options, watch)?;
        let place = |(t, &island): (&[[f64; 2]; 3], &u32)| t.map(|p| packing.unscaled(island as usize, p));
        let placed = triangles.iter().zip(&islands).map(place);
        let corners = corner.into_iter().zip(placed).flat_map(|(c, t)| [0, 1, 2].map(|k| (c[k], t[k]))).collect();
        Ok(Packed { corners, packing })
    })?
}
