//! Files of the cone hierarchy, as `--hierarchy` writes them: JSON, its keys stable, `schema` counts their changes.
//!
//! ```text
//! { "schema": 1, "method", "angles",
//!   "extrema": [{ "component", "vertex", "kind", "value", "persistence", "saddle" }],
//!   "order": [{ "n", "component", "vertex", "curvature_at_n" }],
//!   "curve": [{ "n", "predicted_l2", "predicted_area" }] }
//! ```
//!
//! `extrema` are those of the conformal factor, most persistent first; the saddle of a part's lowest and highest point is
//! null. `order` is nested: for any N the first N cones are the ones to take, those of `-n N` with this method. A model of
//! several components has one order over all of them: first what each needs, then by what cones bring. `curvature_at_n`
//! is the curvature, in radians, that the n-th cone has among the first n; all curvatures change with n, and it is null
//! where the cones so far cannot take the curvature of their component. `curve` begins with the least number that all
//! components can do with. `method` is `pursuit` where `refined` was asked for, which has an order for no number but its own,
//! and `persistence` where more cones were asked for than are optimised. Vertices are counted from 0 as in the input file
//! (as they are after joining for STL), components in the order of their first faces.

use super::{CurvePoint, SCHEMA, angles_name, kind_name, method_name};
use cones::ConeOrder;
use serde::Serialize;

#[derive(Debug, Serialize)]
pub(crate) struct HierarchyFile {
    schema: u32,
    method: &'static str,
    angles: &'static str,
    extrema: Vec<Extremum>,
    order: Vec<NthCone>,
    curve: Vec<CurvePoint>,
}

#[derive(Debug, Serialize)]
struct Extremum {
    component: usize,
    vertex: u32,
    kind: &'static str,
    value: f64,
    persistence: f64,
    saddle: Option<u32>,
}

#[derive(Debug, Serialize)]
struct NthCone {
    n: usize,
    component: usize,
    vertex: u32,
    curvature_at_n: Option<f64>,
}

impl From<&ConeOrder> for HierarchyFile {
    fn from(order: &ConeOrder) -> Self {
        let extremum = |e: &cones::ModelExtremum| Extremum {
            component: e.component,
            vertex: e.vertex,
            kind: kind_name(e.kind),
            value: e.value,
            persistence: e.persistence,
            saddle: e.saddle,
        };
        let place = |(n, cone): (usize, &cones::OrderedCone)| NthCone {
            n,
            component: cone.component,
            vertex: cone.vertex,
            curvature_at_n: cone.curvature,
        };
        Self {
            schema: SCHEMA,
            method: method_name(order.method),
            angles: angles_name(order.angles),
            extrema: order.extrema.iter().map(extremum).collect(),
            order: (1..).zip(&order.cones).map(place).collect(),
            curve: order.curve.iter().map(CurvePoint::from).collect(),
        }
    }
}
