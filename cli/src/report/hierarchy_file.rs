//! Files of the cone hierarchy, as `--hierarchy` writes them: CSV, or JSON, its keys stable, `schema` counts their changes.
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
//! (as they are after joining for STL), components in the order of their first faces. CSV has a row for each cone of the order, with what
//! is predicted for so many, and with kind, value and persistence where it is an extremum; what is null here is empty there.

use super::SCHEMA;
use cones::ConeOrder;
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Debug, Serialize)]
pub(crate) struct HierarchyFile {
    schema: u32,
    #[serde(flatten)]
    order: ConeOrder,
}

impl HierarchyFile {
    pub(crate) fn new(order: ConeOrder) -> Self {
        Self { schema: SCHEMA, order }
    }
}

/// The order as rows of a table under a head.
pub(crate) fn rows(order: &ConeOrder) -> Vec<Vec<String>> {
    const HEAD: [&str; 9] = [
        "n",
        "component",
        "vertex",
        "curvature_at_n",
        "predicted_l2",
        "predicted_area",
        "kind",
        "value",
        "persistence",
    ];
    let predicted: BTreeMap<usize, _> = order.curve.iter().map(|point| (point.count, point)).collect();
    let extrema: BTreeMap<u32, _> = order.extrema.iter().map(|extremum| (extremum.vertex, extremum)).collect();
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:?}"));
    let row = |cone: &cones::OrderedCone| {
        let (point, extremum) = (predicted.get(&cone.n), extrema.get(&cone.vertex));
        vec![
            cone.n.to_string(),
            cone.component.to_string(),
            cone.vertex.to_string(),
            number(cone.curvature),
            number(point.map(|point| point.log_scale_norm)),
            number(point.map(|point| point.area_distortion)),
            extremum.map_or_else(String::new, |extremum| extremum.kind.name().to_owned()),
            number(extremum.map(|extremum| extremum.value)),
            number(extremum.map(|extremum| extremum.persistence)),
        ]
    };
    std::iter::once(HEAD.map(str::to_owned).to_vec()).chain(order.cones.iter().map(row)).collect()
}
