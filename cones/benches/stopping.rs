//! How soon the work ends once an observer has said stop: for each stage the longest time between two questions to the
//! observer, and the longest from its Break to the return.
//!
//! `cargo bench -p cones --bench stopping` runs on a hare of 134 thousand vertices, `… -- FILE` on a mesh of your own.
//! Milliseconds; what is not asked between two of the library's questions is in the first column.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use cones::{Analysis, ConeChoice, Error, Options, Placement, Preparation, Progress, Stage};
use geom::{Model, shapes};

/// Work is stopped at so many different moments.
const STOPS: u32 = 10;

/// What an observer has seen.
#[derive(Default)]
struct Seen {
    last: Option<(Instant, Stage)>,
    longest: [Duration; Stage::ALL.len()],
    stop_after: Option<Duration>,
    began: Option<Instant>,
    broke: Option<(Instant, Stage)>,
}

impl Seen {
    fn hear(&mut self, at: Progress) -> ControlFlow<()> {
        let now = Instant::now();
        if let Some((before, stage)) = self.last.replace((now, at.stage)) {
            let longest = &mut self.longest[stage as usize];
            *longest = now.duration_since(before).max(*longest);
        }
        let began = *self.began.get_or_insert(now);
        match self.stop_after {
            Some(after) if now.duration_since(began) >= after => {
                self.broke = Some((now, at.stage));
                ControlFlow::Break(())
            }
            _ => ControlFlow::Continue(()),
        }
    }
}

fn main() {
    let file = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    let model: Model = match file {
        Some(file) => geom::io::read(Path::new(&file)).expect("a mesh"),
        None => shapes::hare(134_000).into(),
    };
    let work: [(&str, Options); 3] = [
        ("automatic", Options::default()),
        (
            "16 by persistence",
            Options { cones: ConeChoice::Count(16), placement: Placement::Persistence, ..Options::default() },
        ),
        (
            "32 by pursuit",
            Options { cones: ConeChoice::Count(32), placement: Placement::Pursuit, ..Options::default() },
        ),
    ];
    for (name, options) in work {
        bench(name, &model, &options);
    }
}

fn bench(name: &str, model: &Model, options: &Options) {
    let (_, whole, seen) = run(model, options, None);
    println!("\n{name}: {:.2} s", whole.as_secs_f64());
    let mut ending = [Duration::ZERO; Stage::ALL.len()];
    for k in 1..STOPS {
        let (result, _, seen) = run(model, options, Some(whole * k / STOPS));
        if let (Some((broke, stage)), Err(error)) = (seen.broke, result) {
            assert!(matches!(error, Error::Interrupted));
            ending[stage as usize] = broke.elapsed().max(ending[stage as usize]);
        }
    }
    for stage in Stage::ALL {
        let [asked, ended] = [seen.longest, ending].map(|times| times[stage as usize].as_secs_f64() * 1e3);
        println!("{:10} longest unasked {asked:7.1}   Break to return {ended:7.1}", stage.name());
    }
}

/// Unwraps, perhaps until an observer says stop; returns when that was over, the time it took, and what was seen.
fn run(model: &Model, options: &Options, stop_after: Option<Duration>) -> (Result<(), Error>, Duration, Seen) {
    let seen = Arc::new(Mutex::new(Seen { stop_after, ..Seen::default() }));
    let observer = {
        let seen = Arc::clone(&seen);
        move |at: Progress| seen.lock().map_or(ControlFlow::Continue(()), |mut seen| seen.hear(at))
    };
    let began = Instant::now();
    let result =
        Analysis::observed(model, Preparation::default(), observer).and_then(|analysis| analysis.atlas(options));
    let ended = Instant::now();
    let mut seen = std::mem::take(&mut *seen.lock().expect("nobody has panicked"));
    // From the Break to here.
    seen.broke = seen.broke.map(|(broke, stage)| (Instant::now() - ended.duration_since(broke), stage));
    (result.map(drop), ended - began, seen)
}
