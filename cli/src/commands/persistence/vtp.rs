//! Extrema and saddles as points and pairs as lines, in VTK's XML format for polygonal data (`ParaView` opens it).
//!
//! Format: "VTK File Formats" of the VTK User's Guide. Points carry `vertex`, `value` and `kind`, where 0 is a minimum, 1 a saddle that
//! joins minima, 2 a saddle that joins maxima, 3 a maximum; points and cells both carry the `persistence` of their pair.

use super::field::Places;
use super::pairs::{Pair, PairList};
use std::fmt::Write;
use topo::Kind;

/// The document; vertices must be somewhere in space.
pub(super) fn text(lists: &[PairList], places: &Places) -> String {
    let points: Vec<MarkedVertex> =
        lists.iter().flat_map(|list| list.pairs.iter().flat_map(|pair| ends(list.kind, pair))).collect();
    let positions = points.iter().filter_map(|point| places.point(point.vertex));
    let lines: Vec<usize> = (1..points.len()).filter(|&i| points[i].is_saddle()).collect();
    let of_points = |number: fn(&MarkedVertex) -> f64| points.iter().map(number).collect::<Vec<_>>();
    let persistence = of_points(|point| point.persistence);
    let of_cells = persistence.iter().copied().chain(lines.iter().map(|&i| persistence[i]));
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n\
         <Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\" NumberOfLines=\"{1}\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n",
        points.len(),
        lines.len()
    );
    text += "<PointData Scalars=\"persistence\">\n";
    text += &integers("vertex", points.iter().map(|point| point.vertex));
    text += &integers("kind", points.iter().map(|point| point.kind));
    text += &floats("value", 1, of_points(|point| point.value));
    text += &floats("persistence", 1, persistence.iter().copied());
    text += "</PointData>\n<CellData Scalars=\"persistence\">\n";
    text += &floats("persistence", 1, of_cells);
    text += "</CellData>\n<Points>\n";
    text += &floats("Points", 3, positions.flatten());
    text += "</Points>\n<Verts>\n";
    text += &integers("connectivity", 0..points.len());
    text += &integers("offsets", 1..=points.len());
    text += "</Verts>\n<Lines>\n";
    text += &integers("connectivity", lines.iter().flat_map(|&i| [i - 1, i]));
    text += &integers("offsets", (1..=lines.len()).map(|line| 2 * line));
    text + "</Lines>\n</Piece>\n</PolyData>\n</VTKFile>\n"
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

fn integers(name: &str, numbers: impl IntoIterator<Item = usize>) -> String {
    array("Int64", name, 1, numbers.into_iter().map(|x| x.to_string()))
}

/// Numbers; VTK's readers know no infinities, so these become the largest numbers.
fn floats(name: &str, components: usize, numbers: impl IntoIterator<Item = f64>) -> String {
    array("Float64", name, components, numbers.into_iter().map(|x| format!("{:?}", x.clamp(f64::MIN, f64::MAX))))
}

fn array(number: &str, name: &str, components: usize, words: impl Iterator<Item = String>) -> String {
    let mut text =
        format!("<DataArray type=\"{number}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">\n");
    for word in words {
        let _ = writeln!(text, "{word}");
    }
    text + "</DataArray>\n"
}
