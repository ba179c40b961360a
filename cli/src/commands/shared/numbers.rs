//! Numbers on the command line. What is said of a wrong one tells what is expected; clap says before it what was found.
//!
//! An option with such a number also needs `allow_negative_numbers`: else clap takes -1 for an option, and says so.

use std::ops::{Bound, RangeBounds};

/// A whole number within bounds; `what` it is, such as `number of cones`, is said where it is none.
pub(crate) fn whole<T: TryFrom<usize>>(
    what: &'static str,
    bounds: impl RangeBounds<usize> + Clone,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let number = text.parse().ok().filter(|number| bounds.contains(number));
        number.and_then(|number| T::try_from(number).ok()).ok_or_else(|| {
            let least = match bounds.start_bound() {
                Bound::Included(least) => *least,
                Bound::Excluded(below) => below + 1,
                Bound::Unbounded => 0,
            };
            match bounds.end_bound() {
                Bound::Included(most) => format!("expected a whole {what} from {least} to {most}"),
                _ => format!("expected a whole {what}, at least {least}"),
            }
        })
    }
}

pub(crate) fn vertex_count(text: &str) -> Result<usize, String> {
    whole("number of vertices", 1..=geom::shapes::MAX_VERTICES)(text)
}

pub(crate) fn non_negative(text: &str) -> Result<f64, String> {
    real(text, |x| x >= 0.0, "a number, at least 0")
}

pub(super) fn positive(text: &str) -> Result<f64, String> {
    real(text, |x| x > 0.0, "a number above 0")
}

/// A number from 0 to 1.
pub(super) fn share(text: &str) -> Result<f64, String> {
    real(text, |x| (0.0..=1.0).contains(&x), "a number from 0 to 1")
}

/// An area distortion.
pub(super) fn distortion(text: &str) -> Result<f64, String> {
    real(text, |x| x > 1.0, "a number above 1 (1 is no distortion)")
}

fn real(text: &str, holds: impl Fn(f64) -> bool, expected: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|&x: &f64| x.is_finite() && holds(x));
    number.ok_or_else(|| format!("expected {expected}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::num::NonZeroUsize;

    #[test]
    fn what_is_no_such_number_is_answered_with_what_is_expected() {
        let cones = whole::<usize>("number of cones", 0..);
        assert_eq!((cones("0"), cones("12")), (Ok(0), Ok(12)));
        for wrong in ["1.5", "-3", "", "x", "99999999999999999999999"] {
            assert_eq!(cones(wrong), Err("expected a whole number of cones, at least 0".into()), "{wrong}");
        }
        let threads = whole::<NonZeroUsize>("number of threads", 1..);
        assert_eq!(threads("0"), Err("expected a whole number of threads, at least 1".into()));
        let best = whole::<u16>("number", 1..=9);
        assert_eq!((best("9"), best("10")), (Ok(9), Err("expected a whole number from 1 to 9".into())));
        assert_eq!(share("2"), Err("expected a number from 0 to 1".into()));
        assert!(["0", "-1", "nan"].iter().all(|wrong| positive(wrong) == Err("expected a number above 0".into())));
        assert!(["nan", "inf", "-1"].map(non_negative).iter().all(Result::is_err));
    }
}
