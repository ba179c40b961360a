//! Arrays of one to three axes: series, pictures, volumes.

use super::error::{Problem, ReadError};
use super::values::Values;
use std::path::Path;

/// Values in C order, the slowest axis first.
#[derive(Debug)]
pub(crate) struct Array {
    pub(crate) values: Values,
    pub(crate) shape: Vec<usize>,
}

/// What to take of an array whose last axis may be colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layer {
    /// All: the axis is one of space.
    Volume,
    /// One value of the axis.
    One(usize),
}

impl Layer {
    /// From a number or `volume`.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        match text {
            "volume" => Ok(Self::Volume),
            _ => text.parse().map(Self::One).map_err(|_| "give a number from 0, or volume".to_owned()),
        }
    }
}

/// Axes of so many values may be colours, where the axes before it are longer.
const COLOURS: std::ops::RangeInclusive<usize> = 3..=4;

impl Array {
    /// The array, or one layer of it; asks which where that is not clear.
    pub(crate) fn layer(self, layer: Option<Layer>, path: &Path) -> Result<Self, ReadError> {
        fn every<T: Copy>(values: &[T], layers: usize, layer: usize) -> Vec<T> {
            values.iter().skip(layer).step_by(layers).copied().collect()
        }
        let Self { values, shape } = &self;
        let (last, others) = shape.split_last().map_or((1, &[][..]), |(last, others)| (*last, others));
        let may_be_colours = others.len() == 2 && COLOURS.contains(&last);
        match layer {
            None if may_be_colours && others.iter().all(|length| *length > last) => {
                Err(Problem::Colours(shape.clone()).in_file(path))
            }
            None => Ok(self),
            // What is said of a volume is true, whatever its last axis.
            Some(Layer::Volume) if others.len() == 2 => Ok(self),
            Some(Layer::One(layer)) if may_be_colours => {
                if layer >= last {
                    return Err(Problem::NoLayer { layer, layers: last }.in_file(path));
                }
                let values = match values {
                    Values::I32(field) => Values::I32(every(field, last, layer)),
                    Values::I64(field) => Values::I64(every(field, last, layer)),
                    Values::U64(field) => Values::U64(every(field, last, layer)),
                    Values::F32(field) => Values::F32(every(field, last, layer)),
                    Values::F64(field) => Values::F64(every(field, last, layer)),
                };
                Ok(Self { values, shape: others.to_vec() })
            }
            Some(_) => Err(Problem::NoColours(shape.clone()).in_file(path)),
        }
    }
}

/// Which axes are meant: x is the fastest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Axes {
    /// By (z, y, x).
    pub(crate) zyx: [bool; 3],
}

impl Axes {
    /// From names as in `x,y`.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let mut axes = Self::default();
        for name in text.split(',') {
            let axis = ["z", "y", "x"].iter().position(|known| *known == name.trim());
            axes.zyx[axis.ok_or_else(|| format!("{name:?} is none of x, y, z"))?] = true;
        }
        Ok(axes)
    }
}

/// Values in Fortran order, the first axis the fastest, put into C order.
pub(super) fn to_c_order(values: Values, shape: &[usize]) -> Values {
    fn reordered<T: Copy>(values: Vec<T>, shape: &[usize]) -> Vec<T> {
        let (Some((&fast, slow)), true) = (shape.split_first(), shape.len() > 1 && !values.is_empty()) else {
            return values;
        };
        // The first axis becomes the slowest, and the others are reordered among themselves.
        let block = |i: usize| values.iter().skip(i).step_by(fast.max(1)).copied().collect::<Vec<T>>();
        (0..fast).flat_map(|i| reordered(block(i), slow)).collect()
    }
    match values {
        Values::I32(field) => Values::I32(reordered(field, shape)),
        Values::I64(field) => Values::I64(reordered(field, shape)),
        Values::U64(field) => Values::U64(reordered(field, shape)),
        Values::F32(field) => Values::F32(reordered(field, shape)),
        Values::F64(field) => Values::F64(reordered(field, shape)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fortran_order_becomes_c_order() {
        // Element (z, y, x) of a 2 × 3 × 2 array is 100 z + 10 y + x.
        let fortran = (0..2).flat_map(|x| (0..3).flat_map(move |y| (0..2).map(move |z| 100 * z + 10 * y + x)));
        let c: Vec<i32> =
            (0..2).flat_map(|z| (0..3).flat_map(move |y| (0..2).map(move |x| 100 * z + 10 * y + x))).collect();
        let reordered = to_c_order(Values::I32(fortran.collect()), &[2, 3, 2]);
        assert_eq!(reordered, Values::I32(c));
    }

    #[test]
    fn axes_are_named_by_letters() {
        assert_eq!(Axes::parse("x, z"), Ok(Axes { zyx: [true, false, true] }));
        assert!(Axes::parse("x,w").is_err_and(|message| message.contains("\"w\"")));
    }
}
