//! `cones distance`: how far apart two fields are, by their persistence diagrams.

use crate::commands::persistence::{DirectionName, DomainField, FieldArgs, direction, explain, on};
use crate::commands::shared::non_negative;
use crate::error::CommandError;
use crate::input::{Number, each};
use crate::output;
use crate::report::SCHEMA;
use crate::report::table::columns;
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use topo::{Diagram, Kind, Wasserstein};

#[derive(Args, Debug)]
pub(crate) struct DistanceArgs {
    #[command(flatten)]
    of: FieldArgs,
    /// The other field; all that is said of the first holds for it too, and its shape may be another
    #[arg(value_name = "OTHER")]
    other: PathBuf,
    /// Whether to compare minima, maxima or both
    #[arg(long, value_enum, default_value_t = DirectionName::Both)]
    direction: DirectionName,
    /// Leave out pairs of either that are no more persistent than this
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = non_negative, allow_negative_numbers = true)]
    min_persistence: f64,
    /// The order of the Wasserstein distance, at least 1, or inf; steps are measured by the larger of the changes of birth and death
    #[arg(long, value_name = "ORDER", default_value_t = 2.0, value_parser = order, allow_negative_numbers = true)]
    order: f64,
    /// By how much the Wasserstein distance of diagrams of more than 200 points may exceed the least one, as a part of it; 0 is exact, and slow
    #[arg(long, value_name = "SHARE", default_value_t = 0.01, value_parser = non_negative, allow_negative_numbers = true)]
    relative_error: f64,
    /// Print JSON in place of the table
    #[arg(long)]
    json: bool,
}

/// The report of `cones distance`. Its keys are stable.
#[derive(Debug, Serialize)]
struct DistanceReport {
    schema: u32,
    inputs: [String; 2],
    order: Number,
    #[serde(skip_serializing_if = "Option::is_none")]
    sublevel: Option<Distances>,
    #[serde(skip_serializing_if = "Option::is_none")]
    superlevel: Option<Distances>,
}

/// The distances of two diagrams.
#[derive(Clone, Copy, Debug, Serialize)]
struct Distances {
    /// How many finite pairs each has.
    pairs: [usize; 2],
    /// How many essential classes each has; where these differ distances are infinite.
    essential: [usize; 2],
    bottleneck: Number,
    wasserstein: Number,
}

fn order(text: &str) -> Result<f64, String> {
    let order: Option<f64> = text.parse().ok();
    order.filter(|order| *order >= 1.0).ok_or_else(|| "expected a number, at least 1".to_owned())
}

pub(crate) fn run(args: &DistanceArgs) -> Result<(), CommandError> {
    let first = DomainField::read(&args.of)?;
    let second = DomainField::read(&FieldArgs { input: args.other.clone(), ..args.of.clone() })?;
    let inputs = [&args.of.input, &args.other].map(|path| path.display().to_string());
    let order = Number::Double(args.order);
    let mut report = DistanceReport { schema: SCHEMA, inputs, order, sublevel: None, superlevel: None };
    let measure = Wasserstein::new(args.order).relative_error(args.relative_error);
    for &kind in args.direction.kinds() {
        let diagrams = [diagram(args, &first, kind)?, diagram(args, &second, kind)?];
        let distances = Distances::new(&diagrams, measure).map_err(|error| explain(Path::new(&args.other), error))?;
        match kind {
            Kind::Minimum => report.sublevel = Some(distances),
            Kind::Maximum => report.superlevel = Some(distances),
        }
    }
    if args.json { output::print_json(&report) } else { output::print(&report.text(args.direction.kinds())) }
}

/// The diagram of a field, of what is persistent enough.
fn diagram(args: &DistanceArgs, subject: &DomainField, kind: Kind) -> Result<Diagram, CommandError> {
    let options = args.of.options();
    let diagram: Result<Diagram, topo::Error> = each!(&subject.values, field => on!(&subject.domain, domain => match kind {
        Kind::Minimum => options.sublevel(domain, field).map(|pairs| pairs.diagram()),
        Kind::Maximum => options.superlevel(domain, field).map(|pairs| pairs.diagram()),
    }));
    let mut diagram = diagram.map_err(|error| explain(&subject.path, error))?;
    if args.min_persistence > 0.0 {
        diagram.finite.retain(|(birth, death)| (death - birth).abs() > args.min_persistence);
    }
    Ok(diagram)
}

impl Distances {
    fn new([a, b]: &[Diagram; 2], measure: Wasserstein) -> Result<Self, topo::Error> {
        Ok(Self {
            pairs: [a, b].map(|diagram| diagram.finite.len()),
            essential: [a, b].map(|diagram| diagram.essential.len()),
            bottleneck: Number::Double(a.bottleneck(b)?),
            wasserstein: Number::Double(measure.distance(a, b)?),
        })
    }
}

impl DistanceReport {
    fn text(&self, kinds: &[Kind]) -> String {
        let head = ["", "pairs", "bottleneck", "Wasserstein"].map(str::to_owned);
        let row = |&kind: &Kind| {
            let distances = if kind == Kind::Minimum { self.sublevel } else { self.superlevel }?;
            let pairs = distances.pairs.map(|pairs| pairs.to_string()).join(" and ");
            Some(vec![direction(kind).to_owned(), pairs, distances.bottleneck.short(), distances.wasserstein.short()])
        };
        let rows: Vec<Vec<String>> = std::iter::once(head.to_vec()).chain(kinds.iter().filter_map(row)).collect();
        columns(&rows)
    }
}
