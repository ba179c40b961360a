//! The numbers that fields of arrays have here. Other kinds are widened to one of these by Python, which keeps their order: `bool` and
//! `float16` for example, and `int8`.

use num_traits::ToPrimitive;
use numpy::Element;
use pyo3::prelude::*;
use topo::Scalar;

use crate::error::Error;

/// A number of a field, to and from Python.
pub(crate) trait Number: Scalar + Element + for<'a, 'py> FromPyObject<'a, 'py> {
    /// What a persistence is strictly above exactly if it is strictly above a given number.
    fn width(threshold: f64) -> Self::Width;
}

macro_rules! integers {
    ($($int:ty => $width:ty),*) => {
        $(impl Number for $int {
            // Integers above x are those above the integer below x; casts saturate.
            fn width(threshold: f64) -> $width {
                threshold.floor() as $width
            }
        })*
    };
}

integers!(u8 => u8, u16 => u16, i16 => u16, i32 => u32, i64 => u64, u64 => u64);

macro_rules! floats {
    ($($float:ty),*) => {
        $(impl Number for $float {
            fn width(threshold: f64) -> f64 {
                threshold
            }
        })*
    };
}

floats!(f32, f64);

/// A threshold of persistence, refused if it is negative or no number.
pub(crate) fn threshold<S: Number>(threshold: f64) -> PyResult<S::Width> {
    if threshold >= 0.0 {
        return Ok(<S as Number>::width(threshold));
    }
    Err(Error::new_err(format!("a threshold of persistence must be 0 at least, but {threshold} is given")))
}

/// A persistence as a float.
pub(crate) fn as_float<W: ToPrimitive>(width: &W) -> f64 {
    width.to_f64().unwrap_or(f64::NAN)
}
