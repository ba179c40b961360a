//! What was mended of a model.

use std::collections::BTreeMap;
use std::fmt;

/// Something that was mended. Printed, it is one line: `2 isolated vertices, left out (first vertex 7, counted from 0)`.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Repair {
    /// What it was.
    pub kind: RepairKind,
    /// How often it occurred.
    pub count: usize,
    /// The first place, in the file's numbering from 0: a face for what concerns faces, otherwise a vertex.
    pub first: usize,
}

impl fmt::Display for Repair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, count, first } = self;
        let element = if kind.is_of_faces() { "face" } else { "vertex" };
        write!(f, "{} (first {element} {first}, counted from 0)", kind.counted(*count))
    }
}

/// What can be mended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum RepairKind {
    /// A face that uses a vertex twice; left out.
    RepeatedVertex,
    /// A copy of a face at an edge with more than two; left out.
    DuplicateFace,
    /// A vertex that no face uses; left out.
    IsolatedVertex,
    /// A face that was oriented against its neighbours; turned.
    FlippedFace,
    /// An edge with more than two faces; opened.
    NonManifoldEdge,
    /// An edge with an even number of faces more than two, where bodies touch; their faces glued in pairs that bound the same body.
    TouchingEdge,
    /// A vertex whose faces form several fans; one copy a fan.
    NonManifoldVertex,
    /// An edge of a surface that cannot be oriented; opened.
    NonOrientableEdge,
    /// A triangle without area; computed with slightly lengthened edges.
    ZeroArea,
    /// A component without any area; left out.
    ComponentWithoutArea,
    /// A boundary vertex at the same place as another one: perhaps a seam that was never [welded](crate::Weld).
    Unwelded,
    /// A vertex on an edge of another face, where the surface stays open: see [`Model::with_edges_split`](crate::Model::with_edges_split).
    TJunction,
    /// Vertices welded because they were at the same place.
    Welded,
}

impl RepairKind {
    /// What was found and what was done, for a report.
    pub fn description(self) -> &'static str {
        match self {
            Self::RepeatedVertex => "faces that use a vertex twice, left out",
            Self::DuplicateFace => "copies of faces, left out",
            Self::IsolatedVertex => "isolated vertices, left out",
            Self::FlippedFace => "faces oriented against their neighbours, turned",
            Self::NonManifoldEdge => "edges with more than two faces, opened",
            Self::TouchingEdge => "edges where bodies touch, each body closed for itself",
            Self::NonManifoldVertex => "vertices with several fans of faces, opened",
            Self::NonOrientableEdge => "edges where the surface cannot be oriented, opened",
            Self::ZeroArea => "triangles without area, computed with slightly lengthened edges",
            Self::ComponentWithoutArea => "parts without any area, left out",
            Self::Unwelded => "boundary vertices at the place of another one, not welded",
            Self::TJunction => "vertices on the edges of other faces (T-junctions), where the surface is open",
            Self::Welded => "vertices at the place of another one, welded",
        }
    }

    /// The [description](Self::description) with how many there were, in the singular for one.
    pub fn counted(self, count: usize) -> String {
        if count != 1 {
            return format!("{count} {}", self.description());
        }
        let one = match self {
            Self::RepeatedVertex => "face that uses a vertex twice, left out",
            Self::DuplicateFace => "copy of a face, left out",
            Self::IsolatedVertex => "isolated vertex, left out",
            Self::FlippedFace => "face oriented against its neighbours, turned",
            Self::NonManifoldEdge => "edge with more than two faces, opened",
            Self::TouchingEdge => "edge where bodies touch, each body closed for itself",
            Self::NonManifoldVertex => "vertex with several fans of faces, opened",
            Self::NonOrientableEdge => "edge where the surface cannot be oriented, opened",
            Self::ZeroArea => "triangle without area, computed with slightly lengthened edges",
            Self::ComponentWithoutArea => "part without any area, left out",
            Self::Unwelded => "boundary vertex at the place of another one, not welded",
            Self::TJunction => "vertex on the edge of another face (T-junction), where the surface is open",
            Self::Welded => "vertex at the place of another one, welded",
        };
        format!("1 {one}")
    }

    /// Whether [`Repair::first`] counts faces (otherwise vertices).
    pub fn is_of_faces(self) -> bool {
        matches!(
            self,
            Self::RepeatedVertex
                | Self::DuplicateFace
                | Self::FlippedFace
                | Self::ZeroArea
                | Self::ComponentWithoutArea
        )
    }
}

/// What has been mended so far.
#[derive(Default)]
pub(super) struct RepairLog(BTreeMap<RepairKind, (usize, usize)>);

impl RepairLog {
    pub(super) fn note(&mut self, kind: RepairKind, place: usize) {
        let (count, first) = self.0.entry(kind).or_insert((0, place));
        *count += 1;
        *first = place.min(*first);
    }

    pub(super) fn into_repairs(self) -> Vec<Repair> {
        self.0.into_iter().map(|(kind, (count, first))| Repair { kind, count, first }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repair_is_printed_with_how_often_and_where_first() {
        let printed = |kind, count, first| Repair { kind, count, first }.to_string();
        let two = "2 isolated vertices, left out (first vertex 7, counted from 0)";
        assert_eq!(printed(RepairKind::IsolatedVertex, 2, 7), two);
        assert_eq!(
            printed(RepairKind::DuplicateFace, 1, 3),
            "1 copy of a face, left out (first face 3, counted from 0)"
        );
    }
}
