//! Many surfaces, each to a file of its own: a line each in the order of the command line, then a table of all.
//!
//! An error in one stops no other. So many are worked on at a time, each with its share of the threads, as results depend
//! neither on threads nor on what else is being done.

mod names;

use super::{Job, UnwrapArgs, check_checker};
use crate::commands::shared::Unwrapped;
use crate::error::CommandError;
use crate::limits;
use crate::output::{self, Files};
use crate::progress::Progress;
use crate::report::table::{counted, labelled, thousands};
use crate::report::{SCHEMA, Times, UnwrapReport};
use geom::io::MeshFormat;
use names::{Target, targets};
use serde::Serialize;
use std::collections::{BTreeMap, HashSet};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// What came of one surface.
struct Outcome {
    /// Seconds.
    time: f64,
    result: Result<Done, CommandError>,
}

struct Done {
    report: UnwrapReport,
    warnings: Vec<String>,
}

/// The line of one surface in JSON.
#[derive(Serialize)]
struct Line<'a> {
    schema: u32,
    input: String,
    output: Option<String>,
    error: Option<String>,
    seconds: f64,
    report: Option<&'a UnwrapReport>,
}

/// The last line in JSON.
#[derive(Serialize)]
struct SummaryLine<'a> {
    schema: u32,
    summary: &'a Summary,
}

/// What came of all.
#[derive(Debug, Default, Serialize)]
struct Summary {
    surfaces: usize,
    unwrapped: usize,
    failed: usize,
    jobs: usize,
    seconds: f64,
    area_mean: Option<f64>,
    area_worst: Option<f64>,
    quasi_conformal_mean: Option<f64>,
    quasi_conformal_worst: Option<f64>,
    islands: usize,
    flipped: usize,
    overlapping: usize,
}

pub(super) fn run(args: &UnwrapArgs, folder: &Path) -> Result<(), CommandError> {
    if let Some(input) = named_twice(&args.inputs) {
        return Err(CommandError::InputTwice(input.to_owned()));
    }
    make_folder(folder)?;
    let targets = targets(&args.inputs, folder, args.format.map(MeshFormat::from));
    // Any of them, by whatever name, is never overwritten.
    let inputs: HashSet<PathBuf> = args.inputs.iter().filter_map(|path| path.canonicalize().ok()).collect();
    let began = Instant::now();
    let wanted = args.many.jobs.map_or_else(rayon::current_num_threads, usize::from);
    let jobs = wanted.clamp(1, targets.len().max(1));
    let teller =
        Mutex::new(Teller { args, targets: &targets, waiting: BTreeMap::new(), told: 0, summary: Summary::default() });
    let next = AtomicUsize::new(0);
    // Whoever reads standard output may leave, as `head` does: then nothing more is begun.
    let is_over = AtomicBool::new(false);
    let work = || {
        while !is_over.load(Ordering::Relaxed) {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(target) = targets.get(number) else { break };
            let outcome = attempt(args, &inputs, target);
            let mut teller = teller.lock().unwrap_or_else(PoisonError::into_inner);
            if let Err(error) = teller.hear(number, outcome) {
                is_over.store(true, Ordering::Relaxed);
                return Err(error);
            }
        }
        Ok(())
    };
    let pools = if jobs > 1 { limits::pools(jobs) } else { Vec::new() };
    let ended: Vec<Result<(), CommandError>> = if pools.len() > 1 {
        std::thread::scope(|scope| {
            let started: Vec<_> = pools.iter().map(|pool| scope.spawn(|| pool.install(work))).collect();
            started.into_iter().map(|thread| thread.join().unwrap_or_else(|fault| resume_unwind(fault))).collect()
        })
    } else {
        vec![work()]
    };
    ended.into_iter().collect::<Result<(), _>>()?;
    let teller = teller.into_inner().unwrap_or_else(PoisonError::into_inner);
    teller.finish(pools.len().max(1), began.elapsed().as_secs_f64())
}

/// The first input that an earlier one names, too, be it by another way to its folder. A link to a file is a name of its own.
fn named_twice(inputs: &[PathBuf]) -> Option<&Path> {
    let place = |input: &Path| {
        let folder = input.parent().map(|folder| if folder == Path::new("") { Path::new(".") } else { folder });
        match (folder.and_then(|folder| folder.canonicalize().ok()), input.file_name()) {
            (Some(folder), Some(name)) => folder.join(name),
            _ => input.to_owned(),
        }
    };
    let mut places = HashSet::new();
    inputs.iter().map(|input| &**input).find(|input| !places.insert(place(input)))
}

fn make_folder(folder: &Path) -> Result<(), CommandError> {
    std::fs::create_dir_all(folder).map_err(|source| CommandError::MakeFolder { path: folder.to_owned(), source })
}

/// Unwraps one surface; a fault of the program is an error like any other.
fn attempt(args: &UnwrapArgs, inputs: &HashSet<PathBuf>, target: &Target) -> Outcome {
    let start = Instant::now();
    let result = catch_unwind(AssertUnwindSafe(|| unwrap(args, inputs, target)));
    let result = result.unwrap_or_else(|_| Err(CommandError::Fault(target.input.clone())));
    Outcome { time: start.elapsed().as_secs_f64(), result }
}

fn unwrap(args: &UnwrapArgs, inputs: &HashSet<PathBuf>, target: &Target) -> Result<Done, CommandError> {
    let start = Instant::now();
    let Target { input, output, format, is_taken } = target;
    if *is_taken {
        return Err(CommandError::OutputTwice(output.clone()));
    }
    check_checker(args, output, *format)?;
    output.parent().map_or(Ok(()), make_folder)?;
    if output.canonicalize().is_ok_and(|path| inputs.contains(&path)) {
        return Err(CommandError::OutputIsInput(output.clone()));
    }
    output::check(&[input], &[output])?;
    let progress = Progress::begin_one_of_many(&input.display().to_string());
    let job = Job { args, input, output, format: *format };
    let (mut unwrapped, times): (Unwrapped, Times) = job.unwrap(&progress)?;
    let mut files = Files::new();
    progress.step("write");
    let times = Times { write: Some(job.write(&mut unwrapped, &mut files)?), ..times };
    files.finish()?;
    let total = Some(start.elapsed().as_secs_f64());
    let report = unwrapped.report(input, Times { total, ..times });
    Ok(Done { warnings: unwrapped.warnings(), report })
}

/// Tells of surfaces in their order, whenever they are ready.
struct Teller<'a> {
    args: &'a UnwrapArgs,
    targets: &'a [Target],
    waiting: BTreeMap<usize, Outcome>,
    told: usize,
    summary: Summary,
}

impl Teller<'_> {
    fn hear(&mut self, number: usize, outcome: Outcome) -> Result<(), CommandError> {
        self.waiting.insert(number, outcome);
        while let Some(outcome) = self.waiting.remove(&self.told) {
            let target = &self.targets[self.told];
            self.told += 1;
            self.tell(target, &outcome)?;
        }
        Ok(())
    }

    fn tell(&mut self, target: &Target, Outcome { time, result }: &Outcome) -> Result<(), CommandError> {
        let input = target.input.display();
        match result {
            Ok(done) => {
                self.summary.add(&done.report);
                done.warnings.iter().for_each(|line| output::warn(&format!("{input}: {line}")));
            }
            Err(error) => {
                self.summary.failed += 1;
                output::explain(error);
            }
        }
        if self.args.json {
            return output::print_json_line(&Line {
                schema: SCHEMA,
                input: input.to_string(),
                output: result.is_ok().then(|| target.output.display().to_string()),
                error: result.as_ref().err().map(|error| output::sentences(error).join(": ")),
                seconds: *time,
                report: result.as_ref().ok().map(|done| &done.report),
            });
        }
        match result {
            Ok(done) => output::summary(&line(target, &done.report, *time)),
            Err(_) => Ok(()),
        }
    }

    fn finish(mut self, jobs: usize, seconds: f64) -> Result<(), CommandError> {
        self.summary.end(jobs, seconds);
        if self.args.json {
            output::print_json_line(&SummaryLine { schema: SCHEMA, summary: &self.summary })?;
        } else {
            output::summary(&self.summary.text())?;
        }
        match self.summary {
            Summary { failed: 0, .. } => Ok(()),
            Summary { failed, surfaces, .. } => Err(CommandError::SomeFailed { failed, count: surfaces }),
        }
    }
}

/// What is said of one surface.
fn line(target: &Target, report: &UnwrapReport, time: f64) -> String {
    let distortion = &report.map.distortion;
    format!(
        "{} → {}: {}, area {:.3}, angles {:.4}, {}, {} flipped, {time:.2} s\n",
        target.input.display(),
        target.output.display(),
        counted(report.map.cones.len(), "cone", "cones"),
        distortion.area_mean,
        distortion.quasi_conformal.mean,
        counted(report.map.islands.len(), "island", "islands"),
        thousands(distortion.flipped),
    )
}

impl Summary {
    fn add(&mut self, report: &UnwrapReport) {
        let distortion = &report.map.distortion;
        let sum = |sum: &mut Option<f64>, x: f64| *sum = Some(sum.unwrap_or(0.0) + x);
        let most = |most: &mut Option<f64>, x: f64| *most = Some(most.map_or(x, |most| most.max(x)));
        self.unwrapped += 1;
        sum(&mut self.area_mean, distortion.area_mean);
        most(&mut self.area_worst, distortion.area_mean);
        sum(&mut self.quasi_conformal_mean, distortion.quasi_conformal.mean);
        most(&mut self.quasi_conformal_worst, distortion.quasi_conformal.mean);
        self.islands += report.map.islands.len();
        self.flipped += distortion.flipped;
        self.overlapping += usize::from(distortion.overlap.pairs > 0);
    }

    /// Means in place of sums.
    fn end(&mut self, jobs: usize, seconds: f64) {
        self.surfaces = self.unwrapped + self.failed;
        let count = self.unwrapped as f64;
        self.area_mean = self.area_mean.map(|sum| sum / count);
        self.quasi_conformal_mean = self.quasi_conformal_mean.map(|sum| sum / count);
        (self.jobs, self.seconds) = (jobs, seconds);
    }

    fn text(&self) -> String {
        let pair = |mean: Option<f64>, worst: Option<f64>| match (mean, worst) {
            (Some(mean), Some(worst)) => format!("{mean:.3} in the mean, {worst:.3} at worst"),
            _ => "–".to_owned(),
        };
        let Self { surfaces, unwrapped, failed, jobs, seconds, .. } = self;
        let failed = if *failed == 0 { String::new() } else { format!(", {} not", thousands(*failed)) };
        let layout = format!(
            "{}, {} flipped, {} of the maps overlap",
            counted(self.islands, "island", "islands"),
            thousands(self.flipped),
            if self.overlapping == 0 { "none".to_owned() } else { thousands(self.overlapping) }
        );
        let surfaces =
            labelled("surfaces", &format!("{} of {} unwrapped{failed}", thousands(*unwrapped), thousands(*surfaces)));
        let time = labelled("time", &format!("{seconds:.2} s, {jobs} at a time"));
        if *unwrapped == 0 {
            return format!("\n{surfaces}{time}");
        }
        [
            "\n".to_owned(),
            surfaces,
            labelled("area", &format!("distortion {}", pair(self.area_mean, self.area_worst))),
            labelled(
                "angles",
                &format!("quasi-conformal {}", pair(self.quasi_conformal_mean, self.quasi_conformal_worst)),
            ),
            labelled("layout", &layout),
            time,
        ]
        .concat()
    }
}
