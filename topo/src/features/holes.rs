//! The holes of pictures and the cavities of volumes, by duality.
//!
//! What a sublevel set leaves out of a picture falls into components. Those that do not reach the border are its holes: one
//! more component outside is one more class of 1-dimensional homology, and in volumes of 2-dimensional (Alexander duality). As
//! levels rise the set grows and what it leaves out shrinks, so that the holes are the pairs of the *superlevel* sets, read
//! backwards: a hole is born where its component parts from an elder one, and is filled at its maximum (Edelsbrunner &
//! Kerber 2012, "Alexander duality for functions: the persistent behavior of land and water and shore"). The outside of
//! everything is one vertex: a frame round the grid with the last value of all.
//!
//! The connectivity says which complex the sets are. With [`Connectivity::Axis`] pixels are vertices of squares, with
//! [`Connectivity::Full`] they are squares themselves, and what is left out is connected by the other one. With
//! [`Connectivity::Freudenthal`] pixels are vertices of triangles, and what is left out is connected alike.
//!
//! A saddle of a picture ends a component or closes a hole. So [`pairs_and_holes`] looks at the picture once, and puts its saddles in order
//! once, for both.

use super::diagram::Diagram;
use crate::domain::{Connectivity, Domain, Grid, Picture};
use crate::error::Error;
use crate::filtration::{Direction, Falling, Filtration, Kind, NanPolicy, Rising};
use crate::pairing::{Merge, last_of_all, pair_both};
use crate::persistence::Pairs;
use crate::scalar::Scalar;
use crate::watch::Watch;
use num_traits::Zero;

/// A hole of a picture or a cavity of a volume, from its birth until it is filled.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Hole<S> {
    /// The vertex that closes the ring, or the shell.
    pub closed: usize,
    /// The vertex inside that is reached last.
    pub filled: usize,
    /// The value where it is closed.
    pub birth: S,
    /// The value where it is filled.
    pub death: S,
}

/// The holes of one direction, by rising index of the vertex where each is filled.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Holes<S> {
    kind: Kind,
    holes: Vec<Hole<S>>,
}

impl<S> core::ops::Deref for Holes<S> {
    type Target = [Hole<S>];

    fn deref(&self) -> &[Hole<S>] {
        &self.holes
    }
}

impl<S: Scalar> Holes<S> {
    /// The holes as points of a diagram. Integers beyond 2⁵³ are rounded.
    pub fn diagram(&self) -> Diagram {
        let number = |value: S| value.to_f64().unwrap_or(f64::NAN);
        let finite = self.holes.iter().map(|hole| (number(hole.birth), number(hole.death))).collect();
        Diagram { kind: self.kind, finite, essential: Vec::new() }
    }
}

/// The holes of the sublevel sets (minima) or superlevel sets (maxima) of a picture, or the cavities of those of a volume:
/// persistent homology of dimension 1, or 2. Those of zero persistence are left out. As fast as the pairs, and a copy of the
/// field in memory. With the pairs it is all there is of a picture; [`pairs_and_holes`] finds both in less time.
///
/// ```
/// use topo::{Connectivity, Grid, Kind};
///
/// let ring = [
///     9, 1, 1, 9, //
///     1, 5, 7, 1, //
///     9, 2, 1, 9,
/// ];
/// let grid = Grid::new([3, 4], Connectivity::Full);
/// let holes = topo::holes(&grid, &ring, Kind::Minimum)?;
/// assert_eq!(holes.len(), 1);
/// assert_eq!((holes[0].birth, holes[0].death), (2, 7)); // closed by the 2, filled at the 7
/// # Ok::<(), topo::Error>(())
/// ```
///
/// # Errors
/// If the field has not one value for every vertex, if one is NaN, or if the grid goes round an axis.
pub fn holes<const D: usize, S: Scalar>(grid: &Grid<D>, field: &[S], kind: Kind) -> Result<Holes<S>, Error> {
    holes_watched(grid, field, kind, Watch::NONE)
}

/// [`holes`](fn@holes) that can be stopped.
///
/// # Errors
/// As those of [`holes`](fn@holes); [`Error::Interrupted`] if the watch has stopped the work.
pub fn holes_watched<const D: usize, S: Scalar>(
    grid: &Grid<D>,
    field: &[S],
    kind: Kind,
    watch: Watch<'_>,
) -> Result<Holes<S>, Error> {
    const { assert!(D >= 2, "a line has no holes") };
    if grid.is_periodic() {
        return Err(Error::Periodic);
    }
    // What a set leaves out comes by the other direction.
    watch.held(|watch| match kind {
        Kind::Minimum => left_out::<D, S, Rising, Falling>(grid, field, watch),
        Kind::Maximum => left_out::<D, S, Falling, Rising>(grid, field, watch),
    })
}

/// The pairs of a picture, as [`sublevel`](fn@crate::sublevel) or [`superlevel`](fn@crate::superlevel) finds them, and its
/// [holes](fn@holes), in some two thirds of the time.
///
/// ```
/// use topo::{Connectivity, Grid, Kind};
///
/// let ring = [
///     9, 1, 1, 9, //
///     1, 5, 7, 0, //
///     9, 2, 1, 9,
/// ];
/// let (pairs, holes) = topo::pairs_and_holes(&Grid::new([3, 4], Connectivity::Full), &ring, Kind::Minimum)?;
/// assert_eq!((pairs.len(), pairs[0].birth), (1, 0));
/// assert_eq!((holes.len(), holes[0].birth, holes[0].death), (1, 2, 7));
/// # Ok::<(), topo::Error>(())
/// ```
///
/// # Errors
/// As those of [`holes`](fn@holes).
pub fn pairs_and_holes<S: Scalar>(
    grid: &Grid<2>,
    field: &[S],
    kind: Kind,
) -> Result<(Pairs<usize, S>, Holes<S>), Error> {
    pairs_and_holes_watched(grid, field, kind, Watch::NONE)
}

/// [`pairs_and_holes`](fn@pairs_and_holes) that can be stopped.
///
/// # Errors
/// As those of [`holes`](fn@holes); [`Error::Interrupted`] if the watch has stopped the work.
pub fn pairs_and_holes_watched<S: Scalar>(
    grid: &Grid<2>,
    field: &[S],
    kind: Kind,
    watch: Watch<'_>,
) -> Result<(Pairs<usize, S>, Holes<S>), Error> {
    if grid.is_periodic() {
        return Err(Error::Periodic);
    }
    watch.held(|watch| match kind {
        Kind::Minimum => both::<S, Rising>(grid, field, watch),
        Kind::Maximum => both::<S, Falling>(grid, field, watch),
    })
}

fn both<S: Scalar, D: Direction>(
    grid: &Grid<2>,
    field: &[S],
    watch: Watch<'_>,
) -> Result<(Pairs<usize, S>, Holes<S>), Error> {
    let filtration = Filtration::<S, D>::new(field, grid.vertex_count(), NanPolicy::Refuse)?.watched(watch);
    let Picture { descents, crossings } = Picture::new(grid, &filtration);
    let [mut merges, left_out] = pair_both(&filtration, descents.each_ref(), crossings);
    drop(descents);
    if filtration.stops() {
        return Err(Error::Interrupted);
    }
    if let [last] = last_of_all(&filtration)[..] {
        merges.iter_mut().filter(|merge| !merge.is_finite()).for_each(|merge| merge.end = last);
    }
    let pairs = Pairs::of_merges(&filtration, &merges, |vertex| vertex as usize);
    drop(merges);
    let hole = |merge: &Merge| hole(&filtration, merge, |vertex| Some(vertex as usize));
    Ok((pairs, Holes { kind: D::KIND, holes: left_out.iter().filter_map(hole).collect() }))
}

fn left_out<const D: usize, S: Scalar, F: Direction, O: Direction>(
    grid: &Grid<D>,
    field: &[S],
    watch: Watch<'_>,
) -> Result<Holes<S>, Error> {
    let inside = Filtration::<S, F>::new(field, grid.vertex_count(), NanPolicy::Refuse)?;
    let Some(last) = (0..field.len() as u32).reduce(|u, v| inside.later(u, v)) else {
        return Ok(Holes { kind: F::KIND, holes: Vec::new() });
    };
    let connectivity = match grid.connectivity() {
        Connectivity::Axis => Connectivity::Full,
        Connectivity::Full => Connectivity::Axis,
        Connectivity::Freudenthal => Connectivity::Freudenthal,
    };
    let framed = Grid::new(grid.shape().map(|length| length + 2), connectivity);
    let values = with_frame(grid, &framed, field, inside.value(last));
    let outside = Filtration::<S, O>::new(&values, (&framed).vertex_count(), NanPolicy::Refuse)?.watched(watch);
    let merges = (&framed).merges(&outside);
    if outside.stops() {
        return Err(Error::Interrupted);
    }
    let unframed = |vertex: u32| grid.vertex_at(framed.position(vertex as usize).map(|at| at.wrapping_sub(1)));
    // Only ends at the value of the frame are in the frame.
    let hole = |merge: &Merge| hole(&outside, merge, unframed);
    Ok(Holes { kind: F::KIND, holes: merges.iter().filter_map(hole).collect() })
}

/// The hole that a component of what is left out is, unless it is of zero persistence or the outside, given what its vertices are called.
fn hole<S: Scalar, D: Direction>(
    of: &Filtration<'_, S, D>,
    merge: &Merge,
    vertex: impl Fn(u32) -> Option<usize>,
) -> Option<Hole<S>> {
    if !merge.is_finite() {
        return None;
    }
    let (birth, death) = (of.value(merge.end), of.value(merge.extremum));
    let is_zero = birth.width(death).is_zero();
    let (closed, filled) = (vertex(merge.end).filter(|_| !is_zero)?, vertex(merge.extremum)?);
    Some(Hole { closed, filled, birth, death })
}

/// The field with a frame of one value round it.
fn with_frame<const D: usize, S: Scalar>(grid: &Grid<D>, framed: &Grid<D>, field: &[S], value: S) -> Vec<S> {
    let mut values = vec![value; framed.vertex_count()];
    let length = grid.shape()[D - 1];
    for (row, from) in field.chunks_exact(length.max(1)).enumerate() {
        let first = grid.position(row * length).map(|at| at + 1);
        if let Some(to) = framed.vertex_at(first) {
            values[to..to + length].copy_from_slice(from);
        }
    }
    values
}
