//! The numbers a field may consist of.
//!
//! Persistence needs three things of a number: to compare it, to sort many of it fast, and to say how far two of it are
//! apart. Sorting is done on integer *keys* (1 M keys take half the time of 1 M calls to `total_cmp`): for floats the
//! usual map of the sign-magnitude bits to two's complement, with -0.0 made equal to 0.0 first. Distances are *widths*
//! of a type in which no distance overflows: the unsigned integer of the same size, and `f64` for both floats.

use core::cmp::Ordering;
use core::fmt::Debug;
use num_traits::{ToPrimitive, Zero};

/// A number with a total order once NaN is set aside: `f32`, `f64` and every primitive integer.
///
/// Comparison with `<` must agree with the order of the keys, and every comparison with a number whose
/// [`key`](Self::key) is `None` must be false, as it is for NaN.
pub trait Scalar: Copy + PartialOrd + ToPrimitive + Debug + Send + Sync + 'static {
    /// An integer that sorts as the number does.
    type Key: Copy + Ord + Debug + Send + Sync;
    /// A number in which the distance of any two scalars fits.
    type Width: Copy + PartialOrd + Zero + ToPrimitive + Debug + Send + Sync;

    /// The sort key, or `None` for NaN. Equal numbers have equal keys, so -0.0 and 0.0 share one.
    fn key(self) -> Option<Self::Key>;

    /// The distance |self - other|: zero between equal numbers, infinities included; infinite between an infinity and
    /// anything else. The distance of two finite `f64` beyond `f64::MAX` is infinite too.
    fn width(self, other: Self) -> Self::Width;

    /// Whether this is no number.
    fn is_nan(self) -> bool {
        self.partial_cmp(&self).is_none()
    }
}

/// Orders widths from wide to narrow.
pub(crate) fn wider_first<W: PartialOrd>(a: &W, b: &W) -> Ordering {
    b.partial_cmp(a).expect("a width is never NaN")
}

macro_rules! integer_scalar {
    ($($int:ty => $unsigned:ty),*) => {$(
        impl Scalar for $int {
            type Key = Self;
            type Width = $unsigned;

            fn key(self) -> Option<Self> {
                Some(self)
            }

            fn width(self, other: Self) -> $unsigned {
                self.abs_diff(other)
            }
        }
    )*};
}

integer_scalar!(i8 => u8, i16 => u16, i32 => u32, i64 => u64, i128 => u128, isize => usize);
integer_scalar!(u8 => u8, u16 => u16, u32 => u32, u64 => u64, u128 => u128, usize => usize);

macro_rules! float_scalar {
    ($($float:ty, $key:ty);*) => {$(
        impl Scalar for $float {
            type Key = $key;
            type Width = f64;

            fn key(self) -> Option<$key> {
                // Adding zero turns -0.0 into 0.0 and changes nothing else.
                let bits = (self + 0.0).to_bits();
                let sign = 1 << (<$key>::BITS - 1);
                let key = if bits & sign == 0 { bits | sign } else { !bits };
                (!self.is_nan()).then_some(key)
            }

            fn width(self, other: Self) -> f64 {
                // Equal infinities have no difference in floating point, hence the exact comparison.
                if self == other { 0.0 } else { (f64::from(self) - f64::from(other)).abs() }
            }
        }
    )*};
}

float_scalar!(f32, u32; f64, u64);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_sort_as_floats_do() {
        let ascending =
            [f64::NEG_INFINITY, f64::MIN, -1.0, -f64::from_bits(1), 0.0, f64::from_bits(1), 1.0, f64::INFINITY];
        assert!(ascending.windows(2).all(|pair| pair[0].key() < pair[1].key()));
    }

    #[test]
    fn zeros_of_both_signs_are_one_number() {
        assert_eq!((-0.0f64).key(), 0.0f64.key());
        assert_eq!((-0.0f32).key(), 0.0f32.key());
    }

    #[test]
    fn nan_of_either_sign_has_no_key() {
        assert_eq!(f64::NAN.key(), None);
        assert_eq!((-f32::NAN).key(), None);
    }

    #[test]
    fn widths_never_overflow() {
        assert_eq!(i8::MIN.width(i8::MAX), 255);
        assert_eq!(u64::MAX.width(u64::MAX - 1), 1);
        assert_eq!(f32::MAX.width(f32::MIN), 2.0 * f64::from(f32::MAX));
    }

    #[test]
    fn equal_infinities_are_no_distance_apart() {
        assert_eq!(f64::INFINITY.width(f64::INFINITY), 0.0);
        assert_eq!(f64::INFINITY.width(f64::NEG_INFINITY), f64::INFINITY);
        assert_eq!(f32::INFINITY.width(3.0), f64::INFINITY);
    }
}
