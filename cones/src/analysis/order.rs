//! One order of cones for a whole model.
//!
//! Each connected component has a nested order of its own cones; a *sequence* of parts says whose next cone comes next. So the
//! first N cones of the whole are the first ones of each part, every N is a prefix, and what is predicted for all of them
//! follows from what is predicted for the parts.

use std::sync::Arc;

use rayon::prelude::*;
use topo::Kind;

use geom::{VertexId, Watch};

use super::Analysis;
use super::apportionment::{longest_sequence_of, sequence_of};
use super::component::Component;
use super::instances::each_shape;
use super::observer::Stage;
use crate::curvature::CurvatureRule;
use crate::error::Error;
use crate::field::Operators;
use crate::placement::{ComponentOrder, Nested, Placement, Prediction, Search, cones_of_sequence, curve_of_sequence};

/// An order of cones is found for so many in all, or for so many more than the components of a model need.
const ORDERED: usize = 64;
const ORDERED_MORE: usize = 32;

/// The curve of several parts ends where it has looked at so many triangles: each point looks at all.
const CURVE_WORK: usize = 200_000_000;

/// The hierarchy of a model's cones: the first N of `cones` are those for N, whatever N is.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ConeOrder {
    /// How the order was found; see [`Analysis::order`].
    #[cfg_attr(feature = "serde", serde(rename = "method"))]
    pub placement: Placement,
    /// How curvatures were found.
    #[cfg_attr(feature = "serde", serde(rename = "angles"))]
    pub rule: CurvatureRule,
    /// All extrema of the conformal factor, the most persistent first.
    pub extrema: Vec<ModelExtremum>,
    /// The cones.
    #[cfg_attr(feature = "serde", serde(rename = "order"))]
    pub cones: Vec<OrderedCone>,
    /// What is predicted for each number of cones that can take the curvature of all components.
    pub curve: Vec<Prediction>,
}

/// An extremum of the conformal factor, in terms of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ModelExtremum {
    /// The connected component that it is on.
    pub component: usize,
    /// Its vertex of the model.
    pub vertex: u32,
    /// Minimum or maximum.
    #[cfg_attr(feature = "serde", serde(serialize_with = "super::cones::kind_name"))]
    pub kind: Kind,
    /// The conformal factor there.
    pub value: f64,
    /// How much the conformal factor changes until its component joins an elder one.
    pub persistence: f64,
    /// The vertex where it does; none for the lowest and the highest point of a component.
    pub saddle: Option<u32>,
}

/// A cone of an order.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct OrderedCone {
    /// Its place in the order, counted from 1: how many cones there are up to it.
    pub n: usize,
    /// The connected component that it is on.
    pub component: usize,
    /// Its vertex of the model.
    pub vertex: u32,
    /// The curvature that it has where it is the last one, with all before it; with more cones it changes. None where those
    /// on its part are too few to take the part's curvature.
    #[cfg_attr(feature = "serde", serde(rename = "curvature_at_n"))]
    pub curvature: Option<f64>,
}

/// So many cones, or as many as a curve of several parts goes on to.
pub(super) fn affordable(components: &[Arc<Component>], total: usize) -> usize {
    let least: usize = components.iter().map(|component| component.least()).sum();
    let faces: usize = components.iter().map(|c| c.surface.mesh.face_count()).sum();
    total.min(least + (CURVE_WORK / faces.max(1)).max(64))
}

/// What is predicted for every number of cones up to `total`, with an order for each component, and the operators that it is for;
/// for models of thousands of them not so far.
pub(super) fn whole_curve(
    components: &[Arc<Component>],
    (nested, operators): (&[Nested], &[&Operators]),
    (placement, rule): (Placement, CurvatureRule),
    total: usize,
    watch: Watch,
) -> Vec<Prediction> {
    let total = affordable(components, total);
    let sequence = longest_sequence_of(components, nested, placement, total);
    curve_of_sequence(&component_orders(components, (nested, operators), rule, watch), &sequence, watch)
}

impl Analysis {
    /// The hierarchy of cones: one order of at least so many for the whole model, as far as there are so many, of which every
    /// prefix is a set of cones, and what is predicted for each. A method without an order of its own
    /// ([`Placement::Refined`]) gives that of [`Placement::Pursuit`]; many more cones than the components need are in the
    /// order of [`Placement::Persistence`] instead of these.
    ///
    /// # Errors
    /// If the observer has said stop.
    pub fn order(&self, placement: Placement, rule: CurvatureRule, count: usize) -> Result<ConeOrder, Error> {
        let task = self.task();
        let mut times = super::observer::Times::default();
        let components = self.components();
        let needed: usize = components.iter().map(|component| component.least()).sum();
        let placement = placement.for_count(count.saturating_sub(needed)).nested();
        let total = count.max(ORDERED).max(if components.len() > 1 { needed + ORDERED_MORE } else { 0 });
        let most = |component: &Component| component.least() + total.saturating_sub(needed);
        let nested: Vec<Nested> = each_shape(
            components,
            &mut times,
            |_, _| true,
            |component, times| {
                let order = task.stage((Stage::Hierarchy, component.index), times, |watch| {
                    placement.order(component.ground(Search::CoarseToFine, watch), most(component))
                })?;
                Ok(order?)
            },
        )?;
        task.stage((Stage::Hierarchy, 0), &mut times, |watch| {
            cone_order(components, &nested, (placement, rule), total, watch)
        })
    }

    /// All extrema of the conformal factor, the most persistent first.
    pub fn extrema(&self) -> Vec<ModelExtremum> {
        extrema(self.components())
    }
}

fn cone_order(
    components: &[Arc<Component>],
    nested: &[Nested],
    (placement, rule): (Placement, CurvatureRule),
    total: usize,
    watch: Watch,
) -> ConeOrder {
    let sequence = sequence_of(components, nested, placement, total);
    let operators: Vec<&Operators> = components.iter().map(|c| &*c.operators).collect();
    let orders = component_orders(components, (nested, &operators), rule, watch);
    let cone = |(n, (component, v, curvature)): (usize, (usize, VertexId, _))| {
        let vertex = components[component].surface.vertex[v];
        OrderedCone { n, component, vertex, curvature }
    };
    ConeOrder {
        placement,
        rule,
        extrema: extrema(components),
        cones: (1..).zip(cones_of_sequence(&orders, &sequence)).map(cone).collect(),
        curve: curve_of_sequence(&orders, &sequence, watch),
    }
}

fn extrema(components: &[Arc<Component>]) -> Vec<ModelExtremum> {
    let of_component = |component: &Arc<Component>| -> Vec<ModelExtremum> {
        let vertex = |v: VertexId| component.surface.vertex[v];
        let extremum = |e: &topo::Extremum<VertexId, f64>| ModelExtremum {
            component: component.index,
            vertex: vertex(e.vertex),
            kind: e.kind,
            value: e.value,
            persistence: e.persistence,
            saddle: e.saddle.map(vertex),
        };
        component.hierarchy.extrema().iter().map(extremum).collect()
    };
    let mut extrema: Vec<ModelExtremum> = components.par_iter().flat_map_iter(of_component).collect();
    extrema.sort_by(|a, b| b.persistence.total_cmp(&a.persistence));
    extrema
}

/// The orders of components on the surfaces that they are for.
pub(super) fn component_orders<'a>(
    components: &[Arc<Component>],
    (nested, operators): (&[Nested], &[&'a Operators]),
    rule: CurvatureRule,
    watch: Watch,
) -> Vec<ComponentOrder<'a>> {
    let of_component = |((c, nested), operators): ((&Arc<Component>, &Nested), &&'a Operators)| {
        ComponentOrder::new(operators, c.area, nested, rule, watch)
    };
    components.iter().zip(nested).zip(operators).map(of_component).collect()
}
