//! Why a field or a domain is refused.

use core::fmt;

/// What is wrong with a field, with the lists that a domain is made from, or with diagrams to be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error {
    /// The field has not one value for every vertex.
    Length {
        /// Number of values in the field.
        values: usize,
        /// Number of vertices of the domain.
        vertices: usize,
    },
    /// A value is NaN and the policy is [`NanPolicy::Refuse`](crate::NanPolicy::Refuse).
    NotANumber {
        /// Index of the first such vertex.
        vertex: usize,
    },
    /// The domain has more vertices than can be numbered, which are 2³¹ - 1.
    TooLarge {
        /// Number of vertices of the domain.
        vertices: usize,
    },
    /// A neighbour does not exist.
    Neighbor {
        /// The vertex in whose list it stands.
        of: usize,
        /// What stands there.
        vertex: i128,
        /// Number of vertices.
        vertices: usize,
    },
    /// An end of an edge does not exist.
    Edge {
        /// Number of the edge, from 0.
        edge: usize,
        /// What it names.
        vertex: i128,
        /// Number of vertices.
        vertices: usize,
    },
    /// The starts of compressed rows do not rise from 0 to the number of indices.
    Rows {
        /// The first row where they do not.
        row: usize,
    },
    /// An edge of an undirected graph is there from one of its ends only.
    OneWay {
        /// The vertex in whose row it stands, or stands more often.
        from: usize,
        /// The vertex in whose row it does not.
        to: usize,
    },
    /// The weight of an edge is NaN.
    Weight {
        /// Number of the edge, from 0.
        edge: usize,
    },
    /// The threshold of persistence is NaN.
    Threshold,
    /// A grid goes round an axis, which has to have ends.
    Periodic,
    /// One diagram is of minima and the other of maxima.
    Directions,
    /// The order of a distance, or the norm of its steps, is not 1 at least.
    Order,
    /// The relative error that is allowed is negative or NaN.
    RelativeError,
    /// A coordinate of a diagram is NaN.
    Point {
        /// Number of the point, or of the essential class, from 0.
        point: usize,
    },
    /// A tile is empty or goes beyond its grid.
    Tile {
        /// The axis, from 0.
        axis: usize,
    },
    /// A block has two vertices of one name.
    Twice {
        /// The name of the vertex.
        vertex: u64,
    },
    /// Summaries are of opposite directions, or were made with different options.
    Summaries,
    /// Blocks give a vertex different values, or do not agree how many of them share it.
    Shared {
        /// The name of the vertex.
        vertex: u64,
    },
    /// Summaries that are to be joined have the same pair: a block is part of both.
    JoinedTwice {
        /// The name of the pair's extremum.
        vertex: u64,
    },
    /// A summary is to be finished, but not all blocks have been joined.
    Unfinished {
        /// A vertex that is shared with a block that is missing.
        vertex: u64,
    },
    /// Bytes that are not those of a summary of this type of numbers.
    Bytes {
        /// Where reading failed.
        at: usize,
    },
    /// The work was stopped by its [`Watch`](crate::Watch).
    Interrupted,
    /// The field has no contour tree: no tree has both its join and its split tree, for the domain has loops.
    Loops,
    /// A corner of a triangle does not exist.
    Triangle {
        /// Number of the triangle, from 0.
        triangle: usize,
        /// What it names.
        vertex: i128,
        /// Number of vertices.
        vertices: usize,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, number, vertex, vertices) = match *self {
            Self::Length { values, vertices } => {
                let values_of = if values == 1 { "value" } else { "values" };
                let vertices_of = if vertices == 1 { "vertex" } else { "vertices" };
                return write!(
                    f,
                    "the field has {values} {values_of} for {vertices} {vertices_of}; it needs one for each"
                );
            }
            Self::NotANumber { vertex } => {
                return write!(
                    f,
                    "the value of vertex {vertex} is NaN; replace it, or mask such vertices out of the domain"
                );
            }
            Self::TooLarge { vertices } => {
                return write!(f, "the domain has {vertices} vertices, more than {MAX_VERTICES}; coarsen or split it");
            }
            Self::Rows { row } => {
                return write!(
                    f,
                    "start {row} of the compressed rows is not where they go on; starts rise from 0 to the number of indices"
                );
            }
            Self::OneWay { from, to } => {
                return write!(
                    f,
                    "the edge from vertex {from} to {to} is not there from {to} to {from}, or not as often; add it to both rows"
                );
            }
            Self::Weight { edge } => {
                return write!(f, "the weight of edge {edge} is NaN; replace it, or leave the edge out");
            }
            Self::Threshold => return f.write_str("the threshold of persistence is NaN; it must be a number"),
            Self::Periodic => return f.write_str("the grid goes round an axis; holes are found on grids with ends"),
            Self::Directions => {
                return f.write_str("one diagram is of minima and the other of maxima; compare like with like");
            }
            Self::Order => return f.write_str("the order of a distance and the norm of its steps must be 1 at least"),
            Self::RelativeError => return f.write_str("the relative error of a distance must be 0 at least"),
            Self::Point { point } => return write!(f, "point {point} of a diagram has a coordinate that is NaN"),
            Self::Tile { axis } => {
                return write!(f, "the tile has no vertices along axis {axis}, or goes beyond the grid there");
            }
            Self::Twice { vertex } => return write!(f, "two vertices of the block are called {vertex}"),
            Self::Summaries => {
                return f.write_str("summaries of different directions or options are not to be joined");
            }
            Self::Shared { vertex } => {
                return write!(
                    f,
                    "the blocks do not agree about the value of vertex {vertex}, or how many of them share it"
                );
            }
            Self::JoinedTwice { vertex } => {
                return write!(f, "the extremum {vertex} is part of both summaries: a block is to be joined once");
            }
            Self::Unfinished { vertex } => {
                return write!(f, "vertex {vertex} is shared with a block that has not been joined");
            }
            Self::Bytes { at } => {
                return write!(f, "byte {at} is not of a summary of this version and type of numbers");
            }
            Self::Interrupted => return f.write_str("the work was interrupted"),
            Self::Loops => {
                return f.write_str("contours of the field form loops, as its domain does; fill them with triangles");
            }
            Self::Neighbor { of, vertex, vertices } => ("the neighbour list of vertex", of, vertex, vertices),
            Self::Edge { edge, vertex, vertices } => ("edge", edge, vertex, vertices),
            Self::Triangle { triangle, vertex, vertices } => ("triangle", triangle, vertex, vertices),
        };
        let are = if vertices == 1 { "is" } else { "are" };
        write!(f, "{what} {number} names vertex {vertex}, but there {are} only {vertices}, counted from 0")
    }
}

impl core::error::Error for Error {}

/// Vertices are `u32`s whose top bit marks finished labels.
const MAX_VERTICES: usize = (1 << 31) - 1;

/// Refuses more vertices than fit into 31 bits.
pub(crate) fn check_vertex_count(vertices: usize) -> Result<(), Error> {
    if vertices > MAX_VERTICES { Err(Error::TooLarge { vertices }) } else { Ok(()) }
}

/// Refuses a threshold that nothing is above or below of.
pub(crate) fn check_threshold<W: PartialOrd>(threshold: W) -> Result<(), Error> {
    if threshold.partial_cmp(&threshold).is_none() { Err(Error::Threshold) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_have_31_bits() {
        let most = (1 << 31) - 1;
        assert_eq!(check_vertex_count(most), Ok(()));
        let error = check_vertex_count(most + 1).expect_err("one too many");
        assert_eq!(error.to_string(), "the domain has 2147483648 vertices, more than 2147483647; coarsen or split it");
    }

    #[test]
    fn one_of_a_thing_is_told_in_the_singular() {
        let said = |values, vertices| Error::Length { values, vertices }.to_string();
        assert_eq!(said(1, 3), "the field has 1 value for 3 vertices; it needs one for each");
        assert_eq!(said(2, 1), "the field has 2 values for 1 vertex; it needs one for each");
    }
}
