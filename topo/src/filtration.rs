//! The order in which vertices enter, and its exact reverse.
//!
//! The *sublevel* filtration lets vertices enter by rising (value, index); the *superlevel* filtration is the same order
//! read backwards, so that a tie is broken alike in both: `superlevel(f)` equals `sublevel(-f)` with indices reversed.
//! Everything below is written once, against [`Filtration::precedes`], and never asks which of the two it is.

use crate::error::{Error, check_vertex_count};
use crate::parallel;
use crate::scalar::Scalar;
use crate::watch::Watch;
use core::cmp::Ordering;
use core::fmt::Debug;
use core::marker::PhantomData;

/// What to do with vertices whose value is NaN.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum NanPolicy {
    /// Fail with [`Error::NotANumber`].
    #[default]
    Refuse,
    /// Leave such vertices and their edges out of the domain. This is also how to restrict a field to a part of it.
    Mask,
}

/// Which extrema a filtration pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Kind {
    /// Of sublevel sets.
    Minimum,
    /// Of superlevel sets.
    Maximum,
}

impl Kind {
    /// What it is called in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Minimum => "minimum",
            Self::Maximum => "maximum",
        }
    }
}

/// One of the two ways through the order of the vertices: `Rising` or `Falling`.
pub trait Direction: Copy + Debug + Send + Sync + 'static {
    /// The extrema at which components of this direction are born.
    const KIND: Kind;

    /// Whether a vertex of value `a` enters before one of value `b` and *higher* index. False if one is NaN.
    fn precedes_higher_index<S: Scalar>(a: S, b: S) -> bool;

    /// Whether a vertex of value `a` enters before one of value `b` and *lower* index. False if one is NaN.
    fn precedes_lower_index<S: Scalar>(a: S, b: S) -> bool;

    /// The value that enters first; `b` if `a` is NaN. Of floating-point numbers an instruction.
    fn first<S: Scalar>(a: S, b: S) -> S;
}

/// Sublevel sets: low values first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rising;

/// Superlevel sets: high values first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Falling;

impl Direction for Rising {
    const KIND: Kind = Kind::Minimum;

    fn precedes_higher_index<S: Scalar>(a: S, b: S) -> bool {
        a <= b
    }

    fn precedes_lower_index<S: Scalar>(a: S, b: S) -> bool {
        a < b
    }

    fn first<S: Scalar>(a: S, b: S) -> S {
        if a < b { a } else { b }
    }
}

impl Direction for Falling {
    const KIND: Kind = Kind::Maximum;

    fn precedes_higher_index<S: Scalar>(a: S, b: S) -> bool {
        a > b
    }

    fn precedes_lower_index<S: Scalar>(a: S, b: S) -> bool {
        a >= b
    }

    fn first<S: Scalar>(a: S, b: S) -> S {
        if a > b { a } else { b }
    }
}

/// A field together with a direction: the total order in which its vertices enter.
///
/// Vertices whose value is NaN never enter; nothing precedes them and they precede nothing.
#[derive(Debug, Clone, Copy)]
pub struct Filtration<'a, S, D> {
    field: &'a [S],
    is_masked: bool,
    direction: PhantomData<D>,
    watch: Watch<'a>,
}

impl<'a, S: Scalar, D: Direction> Filtration<'a, S, D> {
    /// Checks a field for a domain of `vertices` vertices.
    pub(crate) fn new(field: &'a [S], vertices: usize, nan: NanPolicy) -> Result<Self, Error> {
        let filtration = Self::unchecked(field, vertices, nan)?;
        filtration.check()?;
        Ok(filtration)
    }

    /// Checks no more than the number of values.
    pub(crate) fn unchecked(field: &'a [S], vertices: usize, nan: NanPolicy) -> Result<Self, Error> {
        if field.len() != vertices {
            return Err(Error::Length { values: field.len(), vertices });
        }
        check_vertex_count(vertices)?;
        let is_masked = nan == NanPolicy::Mask;
        Ok(Self { field, is_masked, direction: PhantomData, watch: Watch::NONE })
    }

    /// Refuses NaN unless it is masked.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let first = if self.is_masked { None } else { first_nan(self.field) };
        first.map_or(Ok(()), |vertex| Err(Error::NotANumber { vertex }))
    }

    /// Whether there may be NaN, which never enters.
    pub(crate) fn is_masked(&self) -> bool {
        self.is_masked
    }

    /// The same, for work that can be stopped.
    pub(crate) fn watched(self, watch: Watch<'a>) -> Self {
        Self { watch, ..self }
    }

    /// What is asked whether to go on.
    pub(crate) fn watch(&self) -> Watch<'a> {
        self.watch
    }

    /// Whether the work must end. Then whatever has been found may be left as it is.
    pub(crate) fn stops(&self) -> bool {
        self.watch.stops()
    }

    /// The same field and the reverse order.
    pub(crate) fn backwards(&self) -> Filtration<'a, S, Falling> {
        Filtration { field: self.field, is_masked: self.is_masked, direction: PhantomData, watch: self.watch }
    }

    /// The field itself, by vertex index.
    pub fn field(&self) -> &'a [S] {
        self.field
    }

    /// The value of a vertex.
    pub fn value(&self, vertex: u32) -> S {
        self.field[vertex as usize]
    }

    /// Whether `u` enters before `v`. False for `u == v` and if either never enters.
    pub fn precedes(&self, u: u32, v: u32) -> bool {
        let (a, b) = (self.value(u), self.value(v));
        if u < v { D::precedes_higher_index(a, b) } else { u > v && D::precedes_lower_index(a, b) }
    }

    /// Which of two vertices that enter does so earlier.
    pub(crate) fn compare(&self, u: u32, v: u32) -> Ordering {
        self.precedes(v, u).cmp(&self.precedes(u, v))
    }

    /// The one of two vertices that enters later.
    pub(crate) fn later(&self, u: u32, v: u32) -> u32 {
        if self.precedes(u, v) { v } else { u }
    }

    /// The one of two vertices that enters earlier.
    pub(crate) fn earlier(&self, u: u32, v: u32) -> u32 {
        if self.precedes(u, v) { u } else { v }
    }

    /// Whether the vertex enters at all: its value is a number.
    pub fn contains(&self, vertex: u32) -> bool {
        !self.value(vertex).is_nan()
    }

    /// All vertices that enter, in the order in which they do. O(n log n).
    pub(crate) fn order(&self) -> Vec<u32> {
        let keyed = self.field.iter().zip(0..).filter_map(|(value, vertex)| Some((value.key()?, vertex)));
        let mut keyed: Vec<(S::Key, u32)> = keyed.collect();
        keyed.sort_unstable();
        let order = keyed.into_iter().map(|(_, vertex)| vertex);
        if D::KIND == Kind::Minimum { order.collect() } else { order.rev().collect() }
    }
}

/// Index of the first NaN. Values are tested by the dozen, which compiles to vector instructions.
fn first_nan<S: Scalar>(field: &[S]) -> Option<usize> {
    const TESTED: usize = 64;
    let first_of_block = |start: usize, field: &[S]| {
        let mut tested = field.chunks(TESTED);
        let place = tested.position(|values| values.iter().fold(false, |found, value| found | value.is_nan()))?;
        let values = field[place * TESTED..].iter();
        values.clone().position(|value| value.is_nan()).map(|offset| start + place * TESTED + offset)
    };
    parallel::fold_blocks(field, &first_of_block).into_iter().flatten().next()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order<D: Direction>(field: &[f64]) -> Vec<u32> {
        Filtration::<f64, D>::new(field, field.len(), NanPolicy::Mask).expect("fits").order()
    }

    #[test]
    fn superlevel_is_sublevel_backwards() {
        let field = [1.0, 0.0, 1.0, -0.0, f64::NAN, f64::INFINITY];
        let rising = order::<Rising>(&field);
        let falling: Vec<u32> = order::<Falling>(&field).into_iter().rev().collect();
        assert_eq!(rising, [1, 3, 0, 2, 5]);
        assert_eq!(rising, falling);
    }

    #[test]
    fn precedes_agrees_with_the_order() {
        let field = [1.0, 0.0, 1.0, -0.0, f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        let filtration = Filtration::<f64, Falling>::new(&field, field.len(), NanPolicy::Refuse).expect("fits");
        let order = filtration.order();
        for (i, &u) in order.iter().enumerate() {
            for (j, &v) in order.iter().enumerate() {
                assert_eq!(filtration.precedes(u, v), i < j);
            }
        }
    }

    #[test]
    fn a_wrong_field_is_named() {
        let short = Filtration::<f64, Rising>::new(&[0.0], 2, NanPolicy::Refuse).expect_err("too short");
        assert_eq!(short, Error::Length { values: 1, vertices: 2 });
        let mut field = [0.0; 200];
        field[131] = f64::NAN;
        let nan = Filtration::<f64, Rising>::new(&field, 200, NanPolicy::Refuse).expect_err("NaN");
        assert_eq!(nan, Error::NotANumber { vertex: 131 });
    }
}
