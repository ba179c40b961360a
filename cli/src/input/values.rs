//! The numbers of a field, whatever their type.
//!
//! Pairs of integers are integers, exactly. Narrow types are held in the next of five wide ones, which changes neither
//! order nor difference: up to 32 bits signed, 64 bits of either kind, and both floats.

use serde::{Serialize, Serializer};
use std::fmt;
use topo::Scalar;

/// One number for each vertex.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Values {
    I32(Vec<i32>),
    I64(Vec<i64>),
    U64(Vec<u64>),
    F32(Vec<f32>),
    F64(Vec<f64>),
}

/// Does the same with values of each type.
macro_rules! each {
    ($values:expr, $field:ident => $body:expr) => {
        match $values {
            $crate::input::Values::I32($field) => $body,
            $crate::input::Values::I64($field) => $body,
            $crate::input::Values::U64($field) => $body,
            $crate::input::Values::F32($field) => $body,
            $crate::input::Values::F64($field) => $body,
        }
    };
}
pub(crate) use each;

impl Values {
    pub(crate) fn len(&self) -> usize {
        each!(self, field => field.len())
    }

    /// Puts values of the same type behind these; false, and nothing is changed, where they are of another.
    pub(super) fn append(&mut self, more: Self) -> bool {
        match (self, more) {
            (Self::I32(field), Self::I32(mut more)) => field.append(&mut more),
            (Self::I64(field), Self::I64(mut more)) => field.append(&mut more),
            (Self::U64(field), Self::U64(mut more)) => field.append(&mut more),
            (Self::F32(field), Self::F32(mut more)) => field.append(&mut more),
            (Self::F64(field), Self::F64(mut more)) => field.append(&mut more),
            _ => return false,
        }
        true
    }

    /// The values as f64: rounded, where they are integers beyond 2⁵³.
    pub(crate) fn to_f64(&self) -> Vec<f64> {
        each!(self, field => field.iter().map(|&x| x.number().to_f64()).collect())
    }
}

/// A number of a field as it is told: with as many digits as tell it from its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Number {
    Integer(i128),
    Single(f32),
    Double(f64),
}

impl Number {
    pub(crate) fn to_f64(self) -> f64 {
        match self {
            Self::Integer(x) => x as f64,
            Self::Single(x) => f64::from(x),
            Self::Double(x) => x,
        }
    }

    /// To six digits, for tables.
    pub(crate) fn short(self) -> String {
        match self {
            Self::Integer(x) => x.to_string(),
            Self::Single(x) => six_digits(f64::from(x)),
            Self::Double(x) => six_digits(x),
        }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(x) => write!(f, "{x}"),
            Self::Single(x) => write!(f, "{x:?}"),
            Self::Double(x) => write!(f, "{x:?}"),
        }
    }
}

impl Serialize for Number {
    /// JSON has no infinities: they become the strings `inf` and `-inf`, which parsers of numbers read.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::Integer(x) => serializer.serialize_i128(x),
            Self::Single(x) if x.is_finite() => serializer.serialize_f32(x),
            Self::Double(x) if x.is_finite() => serializer.serialize_f64(x),
            infinite => serializer.collect_str(&infinite),
        }
    }
}

/// A number to six significant digits and without idle zeros, as C's `%g` writes it.
pub(crate) fn six_digits(x: f64) -> String {
    let text = with_digits(x, 6, -5);
    let (digits, exponent) = text.find('e').map_or((&*text, ""), |at| text.split_at(at));
    match digits.contains('.') {
        true => format!("{}{exponent}", digits.trim_end_matches('0').trim_end_matches('.')),
        false => text,
    }
}

/// A number to so many significant digits, with at most four letters and a sign beside them.
pub(crate) fn significant(x: f64, digits: usize) -> String {
    with_digits(x, digits, -3)
}

/// A number to so many significant digits, with an exponent where it is less than `least` or the digits do not reach the point.
fn with_digits(x: f64, digits: usize, least: i32) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}").replace("-0", "0");
    }
    let last = digits as i32 - 1;
    let scientific = format!("{x:.*e}", digits - 1);
    let exponent: i32 = scientific.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    if (least..=last).contains(&exponent) { format!("{x:.*}", (last - exponent) as usize) } else { scientific }
}

/// A number that a field may consist of here.
pub(crate) trait FieldScalar: Scalar {
    /// As it is told.
    fn number(self) -> Number;
    /// A difference as it is told.
    fn width_number(width: Self::Width) -> Number;
    /// The greatest difference that is not above a threshold of at least 0.
    fn threshold(at_most: f64) -> Self::Width;
}

macro_rules! field_scalar {
    ($($type:ty: $number:ident, $width:ty: $width_number:ident);*) => {$(
        impl FieldScalar for $type {
            fn number(self) -> Number {
                Number::$number(self.into())
            }

            fn width_number(width: $width) -> Number {
                Number::$width_number(width.into())
            }

            fn threshold(at_most: f64) -> $width {
                // Conversions to integers round down and stop at the type's ends.
                at_most as $width
            }
        }
    )*};
}

field_scalar!(i32: Integer, u32: Integer; i64: Integer, u64: Integer; u64: Integer, u64: Integer;
    f32: Single, f64: Double; f64: Double, f64: Double);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_digits_are_kept_and_no_idle_zeros() {
        let told = [0.0, -0.0, 1.0, -2.5, 123_456.7, 1e-7, 1.5e20, 0.1 + 0.2, f64::INFINITY].map(six_digits);
        assert_eq!(told, ["0", "0", "1", "-2.5", "123457", "1e-7", "1.5e20", "0.3", "inf"]);
    }

    #[test]
    fn columns_of_numbers_have_as_many_digits() {
        let told = [0.0, 1.0, -0.0123, 98_765.4, 987_654.3, 2e-4].map(|x| significant(x, 5));
        assert_eq!(told, ["0", "1.0000", "-0.012300", "98765", "9.8765e5", "2.0000e-4"]);
    }

    #[test]
    fn numbers_are_told_exactly() {
        assert_eq!(Number::Integer(i128::from(u64::MAX)).to_string(), "18446744073709551615");
        assert_eq!(Number::Single(0.1).to_string(), "0.1");
        assert_eq!(serde_json::to_string(&Number::Double(f64::NEG_INFINITY)).expect("it is a string"), "\"-inf\"");
        assert_eq!(
            serde_json::to_string(&Number::Integer(i128::from(u64::MAX))).expect("it fits"),
            u64::MAX.to_string()
        );
    }

    #[test]
    fn thresholds_of_integers_round_down() {
        assert_eq!(i32::threshold(2.9), 2);
        assert_eq!(i64::threshold(1e30), u64::MAX);
        assert_eq!(f32::threshold(0.25), 0.25);
    }
}
