//! The common outcome of all algorithms: who dies where, in vertex indices.

/// A component joins an elder one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Merge {
    /// The extremum that dies.
    pub(crate) extremum: u32,
    /// The vertex at which it does.
    pub(crate) saddle: u32,
    /// Some extremum of an elder component that meets it there, not necessarily the eldest.
    pub(crate) towards: u32,
}

/// All merges of a filtration.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Merges {
    /// One for every extremum but the eldest of each connected component, in no particular order.
    pub(crate) finite: Vec<Merge>,
    /// For each connected component its eldest extremum and the last vertex to enter it.
    pub(crate) essential: Vec<(u32, u32)>,
}
