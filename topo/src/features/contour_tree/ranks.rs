//! How many critical vertices enter before any other vertex.
//!
//! Their values are in order, so that this is a search. It begins in the right place: the range of values is cut into more intervals than there
//! are critical vertices, and for each interval it is known where it begins.

use crate::scalar::Scalar;

/// So many intervals for each critical vertex: with eight, a smooth picture takes 2 % less time and 6 % more memory.
const INTERVALS: usize = 2;

/// Critical vertices in the order in which they enter, to be searched.
pub(super) struct Ranks<'a, S> {
    vertices: &'a [u32],
    values: &'a [S],
    lowest: f64,
    /// How many intervals there are to a unit of value; 0 if all are one.
    per_unit: f64,
    /// How many critical vertices lie before each interval, and all of them.
    starts: Vec<u32>,
}

impl<'a, S: Scalar> Ranks<'a, S> {
    /// From vertices in their order and their values. Those that are searched for lie between the first and the last.
    pub(super) fn new(vertices: &'a [u32], values: &'a [S]) -> Self {
        let count = (INTERVALS * values.len()).max(1);
        let end = |value: Option<&S>| value.and_then(|value| value.to_f64()).unwrap_or(0.0);
        let (lowest, highest) = (end(values.first()), end(values.last()));
        let per_unit = (count as f64 - 1.0) / (highest - lowest);
        let per_unit = if per_unit.is_finite() { per_unit } else { 0.0 };
        let mut ranks = Self { vertices, values, lowest, per_unit, starts: vec![0; count + 1] };
        for value in values {
            let interval = ranks.interval(*value);
            ranks.starts[interval + 1] += 1;
        }
        for interval in 0..count {
            ranks.starts[interval + 1] += ranks.starts[interval];
        }
        ranks
    }

    /// The interval of a value, which is no lower if the value is no lower, as none of the roundings changes that.
    fn interval(&self, value: S) -> usize {
        let interval = (value.to_f64().unwrap_or(0.0) - self.lowest) * self.per_unit;
        (interval as usize).min(self.starts.len() - 2)
    }

    /// How many enter before a vertex that is none of them.
    #[inline]
    pub(super) fn before(&self, vertex: u32, value: S) -> u32 {
        let interval = self.interval(value);
        let [start, end] = [self.starts[interval], self.starts[interval + 1]];
        let within = start as usize..end as usize;
        let (values, vertices) = (&self.values[within.clone()], &self.vertices[within]);
        let mut before = values.partition_point(|other| *other < value);
        if values.get(before) == Some(&value) {
            let equal = &vertices[before..values.partition_point(|other| *other <= value)];
            before += equal.partition_point(|&other| other < vertex);
        }
        start + before as u32
    }
}
