//! `cones compare`: methods side by side, on any meshes or on those of the paper's Table 1.
//!
//! Each method runs its stages as the library has them; what is timed is said in the table's legend. All methods run once
//! a round, and one plain factorization of the same mesh with them, the floor; of all rounds the least time is kept, so
//! that a busy moment of the machine hits all alike.

mod args;
mod claims;
mod plain;
mod plan;
mod prepared;
mod printed;
mod row;
mod text;
mod trial;
mod variant;

pub(crate) use args::CompareArgs;
pub(crate) use printed::{MODELS, PaperModel};
pub(crate) use variant::{Flattening, Variant};

use crate::commands::shape;
use crate::error::CommandError;
use crate::input;
use crate::output::{self, Files};
use crate::progress::Progress;
use args::Format;
use claims::{Claim, claims};
use plan::{Plan, Plans};
use prepared::PreparedModel;
use printed::Printed;
use row::{Outcome, Row};
use serde::Serialize;
use std::path::Path;
use trial::Trial;

/// What is compared where no mesh is given.
const SHAPES: [&str; 4] = ["hare", "part", "torus-3", "terrain"];

/// The methods that the paper's table is run with.
const PAPER_METHODS: [Variant; 5] =
    [Variant::PAPER, Variant::PUBLISHED, Variant::REUSING, Variant::PAPER_LINEAR, Variant::REFINED];

/// What comes out.
#[derive(Debug)]
struct Comparison {
    rounds: u16,
    rows: Vec<Row>,
    /// The paper's models and what stands in for them.
    files: Vec<StandIn>,
    claims: Vec<Claim>,
}

/// A file that stands in for one of the paper's models.
#[derive(Debug, Serialize)]
struct StandIn {
    model: &'static str,
    paper_vertices: &'static str,
    file: String,
    vertices: Option<usize>,
    remark: String,
}

/// A method with a number of cones, and what the paper prints for that.
type Entry = (usize, Variant, Option<Printed>);

pub(crate) fn run(args: &CompareArgs) -> Result<(), CommandError> {
    let inputs: Vec<&Path> = args.meshes.iter().map(|path| &**path).collect();
    output::check(&inputs, args.output.as_deref().as_slice())?;
    let mut comparison = Comparison { rounds: args.best_of, rows: Vec::new(), files: Vec::new(), claims: Vec::new() };
    let failed = match &args.paper {
        Some(folder) => comparison.run_paper(folder).map(|()| 0)?,
        None => comparison.run_meshes(args)?,
    };
    if comparison.rows.is_empty() && failed > 0 {
        return Err(CommandError::SomeNotCompared { failed, count: args.meshes.len() });
    }
    let written = match args.format() {
        Format::Text => plain::text(&comparison),
        Format::Md => text::markdown(&comparison),
        Format::Csv => text::csv(&comparison),
        Format::Json => output::json(&text::json(&comparison)),
    };
    if let Format::Csv = args.format() {
        output::note(&text::legend(&comparison));
    }
    match &args.output {
        Some(path) => {
            let mut files = Files::new();
            files.write_text(path, &written)?;
            files.finish()?;
        }
        None => output::print(&written)?,
    }
    if failed > 0 { Err(CommandError::SomeNotCompared { failed, count: args.meshes.len() }) } else { Ok(()) }
}

impl Comparison {
    /// Runs methods on the meshes that are asked for; how many of these cannot be read, of which it is said why.
    fn run_meshes(&mut self, args: &CompareArgs) -> Result<usize, CommandError> {
        let variants = args.variants();
        let entries: Vec<Entry> =
            args.counts.iter().flat_map(|&n| variants.iter().map(move |&variant| (n, variant, None))).collect();
        if args.meshes.is_empty() {
            for name in SHAPES {
                self.rows.extend(
                    self.compete(&PreparedModel::new(name.to_owned(), shape::model(name, args.vertices))?, &entries),
                );
            }
        }
        let mut failed = 0;
        for path in &args.meshes {
            let subject = input::read_model(path).map_err(CommandError::from);
            match subject.and_then(|(model, _)| PreparedModel::new(path.display().to_string(), model)) {
                Ok(subject) => self.rows.extend(self.compete(&subject, &entries)),
                Err(error) if args.meshes.len() == 1 => return Err(error),
                Err(error) => {
                    output::explain(&error);
                    failed += 1;
                }
            }
        }
        Ok(failed)
    }

    /// Table 1 of the paper.
    fn run_paper(&mut self, folder: &Path) -> Result<(), CommandError> {
        let exists = |model: &PaperModel| model.file.is_some_and(|file| folder.join(file).is_file());
        if !MODELS.iter().any(exists) {
            return Err(CommandError::NoPaperMeshes(folder.to_owned()));
        }
        for model in &MODELS {
            let mut file = StandIn {
                model: model.name,
                paper_vertices: model.vertices,
                file: model.file.unwrap_or_default().to_owned(),
                vertices: None,
                remark: model.remark.to_owned(),
            };
            if let Some(path) = model.file.map(|file| folder.join(file)) {
                if path.is_file() {
                    let (surface, _) = input::read_model(&path)?;
                    let subject = PreparedModel::new(model.name.to_owned(), surface)?;
                    file.vertices = Some(subject.vertex_count());
                    self.rows.extend(self.compete(&subject, &entries(model)));
                } else {
                    file.remark = "not in the folder".to_owned();
                }
            }
            self.files.push(file);
        }
        self.claims = claims(&self.rows);
        Ok(())
    }

    /// Runs methods on a mesh, in rounds.
    fn compete(&self, subject: &PreparedModel, entries: &[Entry]) -> Vec<Row> {
        let progress = Progress::begin(&subject.name);
        let row = |&(asked, variant, printed): &Entry| Row {
            mesh: subject.name.clone(),
            vertices: subject.vertex_count(),
            asked,
            variant,
            result: Err(String::new()),
            floor: f64::INFINITY,
            printed,
        };
        let mut rows: Vec<Row> = entries.iter().map(row).collect();
        let mut plans = Plans::new(subject);
        let plans: Vec<Result<Plan, String>> =
            entries.iter().map(|&(asked, variant, _)| plans.of(variant, asked)).collect();
        let mut floor = f64::INFINITY;
        for round in 0..self.rounds {
            progress.step("compare");
            floor = floor.min(subject.floor());
            for (row, plan) in rows.iter_mut().zip(&plans) {
                match (round, plan) {
                    (0, Ok(plan)) => row.result = first(subject, row.variant, plan),
                    (0, Err(reason)) => row.result = Err(reason.clone()),
                    (_, plan) => again(subject, row, plan),
                }
            }
        }
        rows.iter_mut().for_each(|row| row.floor = floor);
        rows
    }
}

/// A method's first run, which is measured.
fn first(subject: &PreparedModel, variant: Variant, plan: &Plan) -> Result<Outcome, String> {
    let run = || {
        let trial = Trial::run(subject, variant, plan)?;
        let map = trial.distortion(subject)?;
        Ok(Outcome::new(&trial, &map, trial.overlap(subject), plan.notes(variant)))
    };
    run().map_err(|error: trial::TrialError| error.to_string())
}

/// A further run, which gives the same and is only timed.
fn again(subject: &PreparedModel, row: &mut Row, plan: &Result<Plan, String>) {
    if let (Ok(outcome), Ok(plan)) = (&mut row.result, plan)
        && let Ok(trial) = Trial::run(subject, row.variant, plan)
    {
        outcome.keep_best(trial.seconds);
    }
}

/// What is run on one of the paper's models.
fn entries(model: &PaperModel) -> Vec<Entry> {
    let mut entries = Vec::new();
    for row in model.rows {
        for variant in PAPER_METHODS {
            let printed = match variant {
                Variant::PAPER => Some(row.ours),
                Variant::PUBLISHED => Some(row.published),
                _ => None,
            };
            entries.push((row.cones, variant, printed));
        }
    }
    entries
}
