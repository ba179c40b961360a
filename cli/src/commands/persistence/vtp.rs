//! Extrema and saddles as points and pairs as lines, in VTK's XML format for polygonal data (`ParaView` opens it).
//!
//! Points carry `vertex`, `value` and `kind`, where 0 is a minimum, 1 a saddle that
//! joins minima, 2 a saddle that joins maxima, 3 a maximum; points and cells both carry the `persistence` of their pair.

use super::field::Places;
use super::pairs::{Pair, PairList};
use crate::vtk::{Numbers, PolyData};
use topo::Kind;

/// The document; vertices must be somewhere in space.
pub(super) fn text(lists: &[PairList], places: &Places) -> String {
    let points: Vec<MarkedVertex> =
        lists.iter().flat_map(|list| list.pairs.iter().flat_map(|pair| ends(list.kind, pair))).collect();
    let lines: Vec<usize> = (1..points.len()).filter(|&i| points[i].is_saddle()).collect();
    let integers = |number: fn(&MarkedVertex) -> usize| {
        Numbers::Integers(points.iter().map(|point| number(point) as i64).collect())
    };
    // VTK knows no infinities that can be coloured by: they become the largest numbers.
    let finite = |x: f64| x.clamp(f64::MIN, f64::MAX);
    let persistence: Vec<f64> = points.iter().map(|point| finite(point.persistence)).collect();
    let of_cells = persistence.iter().copied().chain(lines.iter().map(|&i| persistence[i])).collect();
    PolyData {
        points: points.iter().filter_map(|point| places.point(point.vertex)).collect(),
        verts: (0..points.len()).collect(),
        lines: lines.iter().map(|&i| vec![i - 1, i]).collect(),
        scalars: ["persistence"; 2],
        of_points: vec![
            ("vertex", integers(|point| point.vertex)),
            ("kind", integers(|point| point.kind)),
            ("value", Numbers::Floats(1, points.iter().map(|point| finite(point.value)).collect())),
            ("persistence", Numbers::Floats(1, persistence.clone())),
        ],
        of_cells: vec![("persistence", Numbers::Floats(1, of_cells))],
        ..PolyData::default()
    }
    .text()
}

/// An extremum or a saddle.
#[derive(Clone, Copy, Debug)]
struct MarkedVertex {
    vertex: usize,
    kind: usize,
    value: f64,
    persistence: f64,
}

impl MarkedVertex {
    fn is_saddle(&self) -> bool {
        matches!(self.kind, 1 | 2)
    }
}

/// The extremum of a pair and, behind it, the saddle if it has one.
fn ends(kind: Kind, pair: &Pair) -> impl Iterator<Item = MarkedVertex> + use<> {
    let (extremum, saddle) = match kind {
        Kind::Minimum => (0, 1),
        Kind::Maximum => (3, 2),
    };
    let point = |vertex, kind, value| MarkedVertex { vertex, kind, value, persistence: pair.persistence.to_f64() };
    let first = point(pair.extremum, extremum, pair.birth.to_f64());
    let second = pair.saddle.zip(pair.death).map(|(vertex, death)| point(vertex, saddle, death.to_f64()));
    std::iter::once(first).chain(second)
}
