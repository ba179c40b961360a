//! The islands of all components side by side.

use std::sync::Arc;

use geom::{EdgeData, EdgeId, FaceData, FaceId, HalfedgeId, Id, Interrupted, Watch};
use rayon::prelude::*;

use super::component::Component;
use super::flat::Flat;
use super::observer::{Stage, Task, Times};
use super::options::{Islands, Options};
use crate::error::Error;
use crate::flatten::seam_lengths;
use crate::uv::{PackOptions, Packing, Part, Tiles, Triangle, UvMap, cut_for_fill, pack};

/// Of a model of several parts that fills less than this its islands are cut further without being asked for,
const LEAST_FILL: f64 = 0.6;
/// within this share of the seams, if it then fills so much more: among many islands one more is little, but one long one leaves half of the
/// square to all others. (A map of the dragon, 151 parts: three cuts, seams 1.9 % longer, fill .448 -> .580.)
const LITTLE: f64 = 0.02;
const LEAST_GAIN: f64 = 0.04;

/// Seams shorter than so many roots of the area are hardly any, as those of flat rings, which fill the less of a square the thinner they are.
const HARDLY_ANY: f64 = 0.25;
/// Whoever asks for cuts may then have a share of so many roots of the area; what is curved has seams of two to five.
const USUAL: f64 = 4.0;

/// So many triangles or edges are gone through one after the other at least.
const AT_ONCE: usize = 4096;

/// The islands of a model in the plane, each in the size of its surface.
pub(crate) struct Packed {
    /// Where the triangles are, component by component.
    pub(crate) triangles: Vec<Triangle>,
    pub(crate) packing: Packing,
    /// The island of each component's triangles, numbered from 0 over all components.
    pub(crate) islands: Vec<FaceData<u32>>,
    /// Edges that were cut for packing alone, each with its component.
    pub(crate) added: Vec<(usize, EdgeId)>,
}

/// Packs the islands of flattened components; `has_say` where somebody has said where seams run, and wants no others.
///
/// # Errors
/// If they cannot be packed as is asked, or the observer has said stop.
pub(crate) fn packed(
    components: &[Arc<Component>],
    flats: &[Flat],
    (options, has_say): (&Options, bool),
    task: &Task,
    times: &mut Times,
) -> Result<Packed, Error> {
    let Options { islands, quantize, .. } = *options;
    let mut options = options.packing_for_texture();
    let mut unit = 1.0;
    if let Tiles::Udim { texel_density } = &mut options.tiles {
        unit = unit_of_islands(components, flats);
        *texel_density *= unit;
    }
    let in_unit = |error| match error {
        Error::Pack(error) => Error::Pack(error.in_unit(unit)),
        error => error,
    };
    let options = &options;
    let is_of_several = islands == Islands::OverlapFree && components.len() > 1 && options.tiles == Tiles::One;
    // Nor does who has a texture run on across them.
    let asks = is_of_several && !has_say && quantize.is_none();
    task.stage((Stage::Pack, 0), times, |watch| {
        let cuts: Vec<EdgeData<bool>> = components.iter().zip(flats).map(|(c, flat)| cut(c, flat)).collect();
        let (first, share, watch) = match islands {
            Islands::Pack => (None, (options.max_seam, USUAL), watch),
            _ => {
                let packed = arranged(components, (flats, &cuts), options, watch.within(0.0, 0.5))?;
                if !asks || packed.packing.fill >= LEAST_FILL {
                    return Ok(packed);
                }
                (Some(packed), (options.max_seam.min(LITTLE), 0.0), watch.within(0.5, 1.0))
            }
        };
        let further = further_cuts(components, (flats, &cuts), (options, share), watch.within(0.0, 0.5))?;
        let first = match first {
            Some(first) if further == cuts => return Ok(first),
            first => first,
        };
        let mut packed = arranged(components, (flats, &further), options, watch.within(0.5, 1.0))?;
        if let Some(first) = first.filter(|first| packed.packing.fill < first.packing.fill + LEAST_GAIN) {
            return Ok(first);
        }
        packed.added = added(&cuts, &further);
        Ok(packed)
    })?
    .map_err(in_unit)
}

/// The length on the surface of a unit of the islands' plane, on average: they have a little more area than the surface.
fn unit_of_islands(components: &[Arc<Component>], flats: &[Flat]) -> f64 {
    let area: f64 = components.iter().map(|component| component.area).sum();
    let laid_out =
        |(component, flat): (&Arc<Component>, &Flat)| flat.size * flat.size * flat.layout.area(&component.surface.mesh);
    let islands: f64 = components.iter().zip(flats).map(laid_out).sum();
    if islands > 0.0 && area > 0.0 { (area / islands).sqrt() } else { 1.0 }
}

/// The islands packed that there are with cuts.
fn arranged(
    components: &[Arc<Component>],
    (flats, cuts): (&[Flat], &[EdgeData<bool>]),
    options: &PackOptions,
    watch: Watch,
) -> Result<Packed, Error> {
    let (mut triangles, mut island) = (Vec::new(), Vec::new());
    let mut islands: Vec<FaceData<u32>> = Vec::new();
    let mut first = 0;
    for ((component, flat), cut) in components.iter().zip(flats).zip(cuts) {
        let mesh = &component.surface.mesh;
        watch.ask(0.0)?;
        let own = geom::Islands::new(mesh, cut);
        watch.ask(0.0)?;
        let faces = (0..mesh.face_count()).into_par_iter().with_min_len(AT_ONCE).map(FaceId::new);
        triangles.par_extend(faces.map(|f| mesh.sides(f).map(|h| place(flat, h))));
        islands.push(mesh.faces().map(|f| first + own.of(f)).collect());
        island.extend(islands.last().into_iter().flat_map(|islands| islands.iter().copied()));
        first += own.count() as u32;
    }
    let packing = pack(&triangles, &island, options, watch)?;
    triangles.par_iter_mut().zip(&island).for_each(|(corners, &island)| {
        *corners = corners.map(|p| packing.unscaled(island as usize, p));
    });
    Ok(Packed { triangles, packing, islands, added: Vec::new() })
}

/// The edges that were cut further, each with its component.
fn added(cuts: &[EdgeData<bool>], further: &[EdgeData<bool>]) -> Vec<(usize, EdgeId)> {
    let of_one = |(part, (cut, further)): (usize, (&EdgeData<bool>, &EdgeData<bool>))| -> Vec<(usize, EdgeId)> {
        let new = cut.iter_ids().filter(|&(e, is_cut)| further[e] && !*is_cut);
        new.map(|(e, _)| (part, e)).collect()
    };
    cuts.iter().zip(further).enumerate().flat_map(of_one).collect()
}

/// Where a component's layout has a corner, in the size of the surface.
fn place(flat: &Flat, h: HalfedgeId) -> [f64; 2] {
    let z = flat.layout.corner(h);
    [flat.size * z.re, flat.size * z.im]
}

/// Where a component's layout is open.
fn cut(component: &Component, flat: &Flat) -> EdgeData<bool> {
    let (mesh, layout) = (&component.surface.mesh, &flat.layout);
    let is_cut = |e: usize| {
        let h = mesh.halfedge(EdgeId::new(e));
        mesh.twin(h).is_some_and(|g| {
            [(h, mesh.next(g)), (mesh.next(h), g)].iter().any(|&(a, b)| layout.cut.wedge(a) != layout.cut.wedge(b))
        })
    };
    (0..mesh.edge_count()).into_par_iter().with_min_len(AT_ONCE).map(is_cut).collect::<Vec<_>>().into()
}

/// Cuts within a share of the seams, or of what is usual where there are [hardly any](HARDLY_ANY).
fn further_cuts(
    components: &[Arc<Component>],
    (flats, cuts): (&[Flat], &[EdgeData<bool>]),
    (options, (share, usual)): (&PackOptions, (f64, f64)),
    watch: Watch,
) -> Result<Vec<EdgeData<bool>>, Interrupted> {
    let lengths: Vec<EdgeData<f64>> = components
        .iter()
        .map(|component| {
            let lengths = seam_lengths(&component.surface, &component.metric);
            lengths.iter().map(|l| l / component.surface.scale).collect()
        })
        .collect();
    let map = |((component, flat), cut): ((&Arc<Component>, &Flat), &EdgeData<bool>)| UvMap {
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
    let root = components.iter().map(|component| component.area).sum::<f64>().sqrt();
    let whole = if whole < HARDLY_ANY * root { whole.max(usual * root) } else { whole };
    cut_for_fill(&parts, share * whole, options, watch)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Analysis, ConeChoice, SeamOptions};
    use geom::{Metric, Model, shapes};
    use std::f64::consts::PI;

    /// A hare of area 1, and a flat arc round it, less wide than a fiftieth of the hare's seams is long.
    fn hare_and_arc() -> Model {
        let hare = shapes::hare(900);
        let scale = Metric::from_points(&hare.mesh(), &hare.points).area(&hare.mesh()).sqrt().recip();
        let mut points: Vec<[f64; 3]> = hare.points.iter().map(|p| p.map(|x| scale * x)).collect();
        let mut triangles = hare.triangles;
        let first = points.len() as u32;
        for k in 0..=60 {
            let (sin, cos) = (0.08 * f64::from(k)).sin_cos();
            points.extend([1.0, 1.035].map(|r| [r * cos, r * sin, 9.0]));
        }
        for k in (0..60).map(|k| first + 2 * k) {
            triangles.extend([[k, k + 1, k + 3], [k, k + 3, k + 2]]);
        }
        Model::from_triangles(points, &triangles).unwrap()
    }

    #[test]
    fn of_several_parts_one_that_bounds_the_square_is_cut() {
        let model = hare_and_arc();
        let analysis = Analysis::new(&model).unwrap();
        let cones = analysis.choose(&Options { cones: ConeChoice::Each(vec![32, 0]), ..Options::default() }).unwrap();
        let [a, b, ..] = model.face(0) else { unreachable!("it is a triangle") };
        let map = |islands, max_seam, avoid: Vec<[u32; 2]>| {
            let packing = PackOptions { max_seam, ..PackOptions::default() };
            let seams = SeamOptions { avoid, ..SeamOptions::default() };
            analysis.flatten_with(&cones, &Options { islands, packing, seams, ..Options::default() }).unwrap()
        };
        let [kept, free] = [0.0, 0.1].map(|max_seam| map(Islands::OverlapFree, max_seam, vec![]));
        assert!(free.fill >= kept.fill + LEAST_GAIN, "{} {}", free.fill, kept.fill);
        let islands = |atlas: &crate::Atlas| atlas.islands.iter().flatten().max().copied();
        assert!(islands(&free) > islands(&kept));
        let avoiding = map(Islands::OverlapFree, 0.1, vec![[*a, *b]]);
        assert_eq!(islands(&avoiding), islands(&kept), "whoever says where seams run wants no others");
        assert_eq!(islands(&map(Islands::Single, 0.1, vec![])), Some(1));
    }

    #[test]
    fn a_flat_ring_is_cut_into_arcs_where_cuts_are_asked_for() {
        let at = |k: u32, r: f64| [r * (0.1 * PI * f64::from(k)).cos(), r * (0.1 * PI * f64::from(k)).sin(), 0.0];
        let points: Vec<[f64; 3]> = (0..20).flat_map(|k| [0.9, 1.0].map(|r| at(k, r))).collect();
        let side = |k: u32| [2 * k, 2 * k + 1, (2 * k + 3) % 40, (2 * k + 2) % 40];
        let triangles: Vec<[u32; 3]> = (0..20).map(side).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let model = Model::from_triangles(points, &triangles).unwrap();
        let analysis = Analysis::new(&model).unwrap();
        let map = |islands, max_seam| {
            let packing = PackOptions { max_seam, ..PackOptions::default() };
            analysis.atlas(&Options { islands, packing, ..Options::default() }).unwrap()
        };
        let islands = |atlas: &crate::Atlas| atlas.islands.iter().flatten().max().map(|last| last + 1);
        let [whole, none, arcs] =
            [(Islands::OverlapFree, 0.1), (Islands::Pack, 0.0), (Islands::Pack, 0.1)].map(|(i, s)| map(i, s));
        assert_eq!([&whole, &none].map(islands), [Some(1); 2]);
        assert!(
            islands(&arcs) > Some(2) && arcs.fill > 1.5 * whole.fill,
            "{:?} {} {}",
            islands(&arcs),
            arcs.fill,
            whole.fill
        );
        // Each cut is a tenth long.
        let cuts = islands(&arcs).map_or(0, |count| count - 1);
        assert!(0.1 * f64::from(cuts) <= 0.1 * USUAL * (0.19 * PI).sqrt(), "{cuts}");
    }
}
