//! `cones simplify`: a field without its small extrema.

use crate::commands::persistence::{DomainField, FieldArgs, PairList, Places, Wanted, explain, on};
use crate::commands::shared::non_negative;
use crate::error::CommandError;
use crate::input::{FieldScalar, Values, six_digits, write_values};
use crate::output::{self, Files};
use crate::report::table::thousands;
use clap::Args;
use std::path::PathBuf;
use topo::{Kind, PersistenceOptions};

#[derive(Args, Debug)]
pub(crate) struct SimplifyArgs {
    #[command(flatten)]
    of: FieldArgs,
    /// Remove minima and maxima that are no more persistent than this; nowhere is the field changed by more. With --connectivity axis or full, and on networks,
    /// one may take others with it that are up to twice as persistent
    #[arg(long, visible_alias = "min-persistence", value_name = "P", value_parser = non_negative, allow_negative_numbers = true)]
    threshold: f64,
    /// The simplified field, an array of the same shape: .npy; whole numbers become int32, int64 or uint64, halves float32
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
}

pub(crate) fn run(args: &SimplifyArgs) -> Result<(), CommandError> {
    output::extension(&args.output, &["npy"])?;
    output::check(&args.of.files(), &[&args.output])?;
    let mut subject = DomainField::read(&args.of)?;
    let options = args.of.options();
    let failure = |error| explain(&args.of.input, error);
    let before = counts(&subject, options).map_err(failure)?;
    let simplified = simplified(&subject, options, args.threshold).map_err(failure)?;
    let change = change(&subject.values, &simplified);
    subject.values = simplified;
    let after = counts(&subject, options).map_err(failure)?;
    let shape = if let Places::Array(shape) = &subject.places { shape.clone() } else { vec![subject.vertex_count()] };
    let mut files = Files::new();
    files.write(&args.output, |out| Ok(write_values(&shape, &subject.values, out)?))?;
    files.finish()?;
    let [minima, maxima] = [0, 1].map(|kind| format!("{} of {}", thousands(after[kind]), thousands(before[kind])));
    output::summary(&format!(
        "{minima} minima and {maxima} maxima are left; no value is changed by more than {}\n",
        six_digits(change)
    ))
}

/// The numbers of minima and maxima, those of no persistence aside.
fn counts(subject: &DomainField, options: PersistenceOptions) -> Result<[usize; 2], topo::Error> {
    let wanted = Wanted { options, min_persistence: 0.0, top: None };
    let count = |kind| PairList::new(subject, kind, &wanted).map(|list| list.pairs.len());
    Ok([count(Kind::Minimum)?, count(Kind::Maximum)?])
}

fn simplified(subject: &DomainField, options: PersistenceOptions, threshold: f64) -> Result<Values, topo::Error> {
    fn of<S: FieldScalar>(_: &[S], threshold: f64) -> S::Width {
        S::threshold(threshold)
    }
    Ok(match &subject.values {
        Values::I32(field) => Values::I32(on!(&subject.domain, d => options.simplify(d, field, of(field, threshold)))?),
        Values::I64(field) => Values::I64(on!(&subject.domain, d => options.simplify(d, field, of(field, threshold)))?),
        Values::U64(field) => Values::U64(on!(&subject.domain, d => options.simplify(d, field, of(field, threshold)))?),
        Values::F32(field) => Values::F32(on!(&subject.domain, d => options.simplify(d, field, of(field, threshold)))?),
        Values::F64(field) => Values::F64(on!(&subject.domain, d => options.simplify(d, field, of(field, threshold)))?),
    })
}

/// The largest change; values that are equal, infinities too, have not changed.
fn change(before: &Values, after: &Values) -> f64 {
    let after = after.to_f64();
    let changes = before.to_f64().into_iter().zip(after).filter(|(a, b)| a != b).map(|(a, b)| (a - b).abs());
    changes.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn infinities_that_stay_are_no_change() {
        let field = |x| Values::F64(vec![f64::INFINITY, x, f64::NAN]);
        assert_eq!(change(&field(1.0), &field(3.5)), 2.5);
    }
}
