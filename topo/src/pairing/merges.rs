//! The common outcome of all algorithms: who dies where, in vertex indices.

/// No basin, no vertex: of an eldest component, which joins nothing.
pub(crate) const NONE: u32 = u32::MAX;

/// The end of a component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Merge {
    /// The extremum at which it was born.
    pub(crate) extremum: u32,
    /// The vertex at which it joins an elder one; if it joins none, the last vertex to enter it.
    pub(crate) end: u32,
    /// Some extremum of an elder component that meets it there, not necessarily the eldest; [`NONE`] if it joins none.
    pub(crate) towards: u32,
}

impl Merge {
    /// A component of which only its birth is known.
    pub(crate) fn born(extremum: u32) -> Self {
        Self { extremum, end: NONE, towards: NONE }
    }

    /// Whether it joins an elder one.
    pub(crate) fn is_finite(&self) -> bool {
        self.towards != NONE
    }
}

/// A branch ends at a saddle. Extrema go by their basins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct BranchEnd {
    /// The extremum whose branch it is.
    pub(crate) extremum: u32,
    pub(crate) saddle: u32,
    /// The eldest extremum of all that meet at the saddle, whose branch goes on.
    pub(crate) elder: u32,
    /// The extremum to which one comes from the saddle by steepest descent into the elder component.
    pub(crate) beyond: u32,
}
