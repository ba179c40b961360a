//! One order of cones for a whole model.
//!
//! Each connected part has a nested order of its own cones; a *sequence* of parts says whose next cone comes next. So the
//! first N cones of the whole are the first ones of each part, every N is a prefix, and what is predicted for all of them
//! follows from what is predicted for the parts.

use geom::VertexId;
use rayon::prelude::*;
use topo::Kind;

use crate::angles::{Angles, least_cones};
use crate::component::Component;
use crate::distortion::{Predicted, Whole};
use crate::hierarchy::Method;
use crate::operators::Operators;
use crate::pursuit::{Nested, pursuit};
use crate::reduced::Reduced;
use crate::settled::Settled;
use crate::share::{Part, sequence, sequence_by_persistence, share_out};

/// The curve of several parts ends where it has looked at so many triangles: each point looks at all.
const CURVE_WORK: usize = 200_000_000;

/// The hierarchy of a model's cones: the first N of `cones` are those for N, whatever N is.
#[derive(Clone, Debug, PartialEq)]
pub struct ConeOrder {
    /// How the order was found. [`Method::Refined`] has none and gives that of [`Method::Pursuit`]; more than 64 cones
    /// are in the order of [`Method::Persistence`] instead of either.
    pub method: Method,
    /// How curvatures were found.
    pub angles: Angles,
    /// All extrema of the conformal factor, the most persistent first.
    pub extrema: Vec<ModelExtremum>,
    /// The cones.
    pub cones: Vec<OrderedCone>,
    /// What is predicted for each number of cones that can take the curvature of all parts.
    pub curve: Vec<Predicted>,
}

/// An extremum of the conformal factor, in terms of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelExtremum {
    /// The connected part that it is on.
    pub component: usize,
    /// Its vertex of the model.
    pub vertex: u32,
    /// Minimum or maximum.
    pub kind: Kind,
    /// The conformal factor there.
    pub value: f64,
    /// How much the conformal factor changes until its component joins an elder one.
    pub persistence: f64,
    /// The vertex where it does; none for the lowest and the highest point of a part.
    pub saddle: Option<u32>,
}

/// A cone of an order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderedCone {
    /// The connected part that it is on.
    pub component: usize,
    /// Its vertex of the model.
    pub vertex: u32,
    /// The curvature that it has where it is the last one, with all before it; with more cones it changes. None where those
    /// on its part are too few to take the part's curvature.
    pub curvature: Option<f64>,
}

impl Component<'_> {
    fn least(&self) -> usize {
        least_cones(&self.operators)
    }

    /// The order of at least `most` cones, as far as there are so many; at most 64 by pursuit.
    pub(crate) fn nested(&self, method: Method, most: usize) -> Nested {
        let mut reduced = Reduced::new(&self.operators, &self.surface.mesh);
        if matches!(method, Method::Refined | Method::Pursuit) {
            return pursuit(&mut reduced, Part::known(&self.operators, most));
        }
        let order: Vec<VertexId> = self
            .hierarchy
            .cones(&self.operators, &self.surface.mesh, method, most)
            .iter()
            .map(|cone| cone.vertex)
            .collect();
        Nested::new(&mut reduced, &order)
    }

    fn inner_vertices(&self) -> usize {
        self.surface.mesh.vertices().filter(|&v| !self.surface.mesh.is_boundary_vertex(v)).count()
    }
}

/// How many cones each part gets, `total` in all, or as many as all of them need.
pub(crate) fn counts(components: &[Component], method: Method, total: usize) -> Vec<usize> {
    let least: Vec<usize> = components.iter().map(Component::least).collect();
    let spare = total.saturating_sub(least.iter().sum());
    if let [alone] = least[..] {
        return vec![total.max(alone)];
    }
    if spare == 0 {
        return least;
    }
    let parts = |of: fn(&mut Reduced, f64, usize) -> Part| -> Vec<Part> {
        let part = |c: &Component| of(&mut Reduced::new(&c.operators, &c.surface.mesh), c.area, c.least() + spare);
        components.par_iter().with_max_len(1).map(part).collect()
    };
    let sequence = match method {
        Method::Refined => return at_least(share_out(&parts(Part::brief), total), &least),
        Method::Pursuit => sequence(&parts(Part::new), total),
        _ => by_persistence(components, total),
    };
    let mut counts = vec![0; components.len()];
    sequence.into_iter().for_each(|p| counts[p] += 1);
    at_least(counts, &least)
}

fn at_least(counts: Vec<usize>, least: &[usize]) -> Vec<usize> {
    counts.into_iter().zip(least).map(|(count, &least)| count.max(least)).collect()
}

/// The parts that get the first cone, the second, …, where each has such an order; up to where one of them is known no
/// further.
fn sequence_of(components: &[Component], nested: &[Nested], method: Method, total: usize) -> Vec<usize> {
    let mut left: Vec<usize> = nested.iter().map(|order| order.cones().len()).collect();
    if let [alone] = left[..] {
        return vec![0; total.min(alone)];
    }
    let part = |(c, nested): (&Component, &Nested)| Part::of_order(&c.operators, nested, c.area, nested.cones().len());
    let sequence = match method {
        Method::Refined | Method::Pursuit => {
            sequence(&components.iter().zip(nested).map(part).collect::<Vec<Part>>(), total)
        }
        _ => by_persistence(components, total),
    };
    let is_all = |p: usize| nested[p].cones().len() == components[p].inner_vertices();
    let mut known = Vec::new();
    for p in sequence {
        if left[p] == 0 {
            break;
        }
        left[p] -= 1;
        known.push(p);
        if left[p] == 0 && !is_all(p) {
            break;
        }
    }
    known
}

fn by_persistence(components: &[Component], total: usize) -> Vec<usize> {
    let persistences = |c: &Component| c.hierarchy.extrema().iter().map(|e| e.persistence).collect();
    let parts: Vec<(f64, Vec<f64>)> = components.iter().map(|c| (c.area, persistences(c))).collect();
    let limits: Vec<[usize; 2]> = components.iter().map(|c| [c.least(), c.inner_vertices()]).collect();
    sequence_by_persistence(&parts, &limits, total)
}

/// What is predicted for every number of cones up to `total`, with an order for each part; for models of thousands of parts
/// not so far.
pub(crate) fn whole_curve(
    components: &[Component],
    nested: &[Nested],
    (method, angles): (Method, Angles),
    total: usize,
) -> Vec<Predicted> {
    let least: usize = components.iter().map(Component::least).sum();
    let faces: usize = components.iter().map(|c| c.surface.mesh.face_count()).sum();
    let total = total.min(least + (CURVE_WORK / faces).max(64));
    let sequence = sequence_of(components, nested, method, total);
    curve(&part_orders(components, nested, angles), &sequence)
}

/// An order of at least `total` cones for the whole model, as far as there are so many, with its curve.
pub(crate) fn cone_order(components: &[Component], (method, angles): (Method, Angles), total: usize) -> ConeOrder {
    let method = if method == Method::Refined { Method::Pursuit } else { method };
    let vertex = |component: usize, v: VertexId| components[component].surface.vertex[v];
    let least: usize = components.iter().map(Component::least).sum();
    let most = |c: &Component| c.least() + total.saturating_sub(least);
    let nested: Vec<Nested> = components.par_iter().with_max_len(1).map(|c| c.nested(method, most(c))).collect();
    let sequence = sequence_of(components, &nested, method, total);
    let parts = part_orders(components, &nested, angles);
    let of_part = |(component, c): (usize, &Component)| -> Vec<ModelExtremum> {
        let extremum = |e: &topo::Extremum<VertexId, f64>| ModelExtremum {
            component,
            vertex: vertex(component, e.vertex),
            kind: e.kind,
            value: e.value,
            persistence: e.persistence,
            saddle: e.saddle.map(|v| vertex(component, v)),
        };
        c.hierarchy.extrema().iter().map(extremum).collect()
    };
    let mut extrema: Vec<ModelExtremum> = components.iter().enumerate().flat_map(of_part).collect();
    extrema.sort_by(|a, b| b.persistence.total_cmp(&a.persistence));
    let cone = |(component, v, curvature)| OrderedCone { component, vertex: vertex(component, v), curvature };
    ConeOrder {
        method,
        angles,
        extrema,
        cones: cones(&parts, &sequence).into_iter().map(cone).collect(),
        curve: curve(&parts, &sequence),
    }
}

fn part_orders<'a>(components: &'a [Component], nested: &[Nested], angles: Angles) -> Vec<PartOrder<'a>> {
    components.iter().zip(nested).map(|(c, nested)| PartOrder::new(&c.operators, c.area, nested, angles)).collect()
}

/// A connected part with the curvatures of every prefix of its order.
pub(crate) struct PartOrder<'a> {
    operators: &'a Operators,
    /// The area in the model.
    area: f64,
    cones: Vec<VertexId>,
    /// For each number of cones, from 0 on; none where so many cannot take the part's curvature.
    prefixes: Vec<Option<Settled>>,
}

impl<'a> PartOrder<'a> {
    /// Costs no solves, or one for each cone if curvatures are harmonic.
    pub(crate) fn new(operators: &'a Operators, area: f64, nested: &Nested, angles: Angles) -> Self {
        let prefixes = Settled::nested(operators, &nested.sets, angles);
        Self { operators, area, cones: nested.cones().to_vec(), prefixes }
    }

    /// The curve of this part alone.
    pub(crate) fn curve(self) -> Vec<Predicted> {
        let sequence = vec![0; self.cones.len()];
        curve(&[self], &sequence)
    }
}

/// What is predicted for each number of cones that can take the curvature of all parts. Half a solve for each.
pub(crate) fn curve(parts: &[PartOrder], sequence: &[usize]) -> Vec<Predicted> {
    let mut whole = Whole::new(parts.len());
    let mut counts = vec![0; parts.len()];
    let put = |whole: &mut Whole, p: usize, count: usize| {
        if let Some(settled) = &parts[p].prefixes[count] {
            let u = settled.log_scale(parts[p].operators);
            whole.put(p, parts[p].operators, parts[p].area, count, u);
        }
    };
    let is_able = |counts: &[usize]| parts.iter().zip(counts).all(|(part, &count)| part.prefixes[count].is_some());
    (0..parts.len()).for_each(|p| put(&mut whole, p, 0));
    let mut curve: Vec<Predicted> = is_able(&counts).then(|| whole.predicted()).into_iter().collect();
    for &p in sequence {
        counts[p] += 1;
        put(&mut whole, p, counts[p]);
        if is_able(&counts) {
            curve.push(whole.predicted());
        }
    }
    curve
}

/// The cones of a sequence: part, vertex of the part, and curvature as in [`OrderedCone`].
pub(crate) fn cones(parts: &[PartOrder], sequence: &[usize]) -> Vec<(usize, VertexId, Option<f64>)> {
    let mut counts = vec![0; parts.len()];
    let cone = |&p: &usize| {
        let at = counts[p];
        counts[p] += 1;
        let curvature = parts[p].prefixes[at + 1].as_ref().map(|settled| settled.curvature[at]);
        (p, parts[p].cones[at], curvature)
    };
    sequence.iter().map(cone).collect()
}
