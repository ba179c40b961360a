//! Which of the paper's claims hold on the rows of its Table 1, as measured here.

use super::row::{Outcome, Row};
use super::variant::Variant;
use serde::Serialize;

/// The largest difference between the two quasi-conformal columns that the paper prints and calls nearly identical.
const NEARLY_IDENTICAL: f64 = 0.005;
/// What the paper prints as its speed-up.
const SPEED_UP: f64 = 23.0;
/// The examples in which the paper's areal distortion is the worse one, in its own words.
const EXCEPTIONS: usize = 2;
/// Areal distortions that differ by less than this share agree.
const AGREEMENT: f64 = 0.1;

/// A claim of the paper with a verdict.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Claim {
    pub(super) claim: String,
    pub(super) holds: bool,
    pub(super) measured: String,
}

/// A row of the table with what its methods reached.
struct ClaimCase<'a> {
    name: String,
    row: &'a Row,
    paper: &'a Outcome,
    published: &'a Outcome,
}

/// The claims, judged on those rows where both methods have a result; none where there is no such row.
pub(super) fn claims(rows: &[Row]) -> Vec<Claim> {
    let cases = cases(rows);
    if cases.is_empty() {
        return Vec::new();
    }
    vec![
        quasi_conformal(&cases),
        areal(&cases),
        areal_as_printed(&cases),
        speed_up(&cases, rows),
        faster_than(&cases, rows, Variant::PAPER, "flattening by Newton's method"),
        faster_than(&cases, rows, Variant::PAPER_LINEAR, "flattening by linear metric scaling"),
    ]
}

fn cases(rows: &[Row]) -> Vec<ClaimCase<'_>> {
    let case = |row| {
        let paper = outcome(rows, row, Variant::PAPER)?;
        let published = outcome(rows, row, Variant::PUBLISHED)?;
        Some(ClaimCase { name: format!("{} {}", row.mesh, row.asked), row, paper, published })
    };
    rows.iter().filter(|row| row.variant == Variant::PAPER).filter_map(case).collect()
}

/// What another method reached on a row's mesh with as many cones.
fn outcome<'a>(rows: &'a [Row], of: &Row, variant: Variant) -> Option<&'a Outcome> {
    let same = |row: &&Row| row.mesh == of.mesh && row.asked == of.asked && row.variant == variant;
    rows.iter().find(same)?.result.as_ref().ok()
}

fn quasi_conformal(cases: &[ClaimCase<'_>]) -> Claim {
    let difference = |case: &ClaimCase<'_>| (case.paper.quasi_conformal - case.published.quasi_conformal).abs();
    let (worst, most) = extreme(cases, difference);
    Claim {
        claim: format!(
            "quasi-conformal distortion is nearly identical to [BCGB08] (the paper's figures differ by up to {NEARLY_IDENTICAL})"
        ),
        holds: most <= NEARLY_IDENTICAL,
        measured: format!("the difference is {most:.4} at most ({worst})"),
    }
}

fn areal(cases: &[ClaimCase<'_>]) -> Claim {
    let worse: Vec<String> = cases
        .iter()
        .filter(|case| case.paper.area_inverse > case.published.area_inverse)
        .map(|case| {
            format!("{} ({:.3} against {:.3})", case.name, case.paper.area_inverse, case.published.area_inverse)
        })
        .collect();
    Claim {
        claim: format!("areal distortion is lower than with [BCGB08] in all but {EXCEPTIONS} examples"),
        holds: worse.len() <= EXCEPTIONS,
        measured: format!("it is higher in {} of {}: {}", worse.len(), cases.len(), list(&worse)),
    }
}

fn areal_as_printed(cases: &[ClaimCase<'_>]) -> Claim {
    let printed = |case: &ClaimCase<'_>| case.row.printed.map_or(f64::NAN, |printed| printed.areal);
    let far = |case: &&ClaimCase<'_>| (case.paper.area_inverse / printed(case) - 1.0).abs() > AGREEMENT;
    let off: Vec<String> = cases
        .iter()
        .filter(far)
        .map(|case| format!("{} ({:.3}, printed {:.3})", case.name, case.paper.area_inverse, printed(case)))
        .collect();
    Claim {
        claim: format!("areal distortion of the paper's method is as printed, within {:.0} %", 100.0 * AGREEMENT),
        holds: off.is_empty(),
        measured: format!("it is off in {} of {}: {}", off.len(), cases.len(), list(&off)),
    }
}

fn speed_up(cases: &[ClaimCase<'_>], rows: &[Row]) -> Claim {
    let mean = |ratio: &dyn Fn(&ClaimCase<'_>) -> Option<f64>| {
        let ratios: Vec<f64> = cases.iter().filter_map(ratio).collect();
        ratios.iter().sum::<f64>() / ratios.len() as f64
    };
    let ratio = |case: &ClaimCase<'_>| case.published.seconds.detection / case.paper.seconds.detection;
    let refactoring = mean(&|case| Some(ratio(case)));
    let reusing =
        mean(&|case| Some(outcome(rows, case.row, Variant::REUSING)?.seconds.detection / case.paper.seconds.detection));
    let (best, most) = extreme(cases, ratio);
    Claim {
        claim: format!(
            "the whole hierarchy is found {SPEED_UP} times faster than [BCGB08] finds its cones, on average"
        ),
        holds: refactoring >= SPEED_UP,
        measured: format!(
            "{refactoring:.1} times on average, {most:.1} at most ({best}); {reusing:.1} times against the iterative method on \
             one factorization"
        ),
    }
}

/// Whether the hierarchy always takes less time than flattening.
fn faster_than(cases: &[ClaimCase<'_>], rows: &[Row], variant: Variant, what: &str) -> Claim {
    let ratio = |case: &ClaimCase<'_>| {
        outcome(rows, case.row, variant).map_or(f64::NAN, |o| case.paper.seconds.detection / o.seconds.flattening)
    };
    let slower: Vec<String> = cases.iter().filter(|case| ratio(case) >= 1.0).map(|case| case.name.clone()).collect();
    let (worst, most) = extreme(cases, ratio);
    Claim {
        claim: format!("the hierarchy takes less time than {what}"),
        holds: slower.is_empty(),
        measured: format!("it takes {most:.2} times as long at most ({worst}); longer in: {}", list(&slower)),
    }
}

/// The case in which something is largest.
fn extreme(cases: &[ClaimCase<'_>], measure: impl Fn(&ClaimCase<'_>) -> f64) -> (String, f64) {
    let measured = cases.iter().map(|case| (case.name.clone(), measure(case))).filter(|(_, x)| !x.is_nan());
    measured.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(("no row".to_owned(), f64::NAN))
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
