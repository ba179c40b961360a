//! Progress on stderr while the stages run: a bar on a terminal, a line a stage where that is asked for.

use crate::output::{self, Volume};
use cones::Stage;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Reading and writing come on top of the library's stages.
const STEPS: u64 = 8;

#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    /// The surface, in lines that say a stage.
    name: Option<String>,
}

impl Progress {
    /// The progress on one surface, which begins with its reading.
    pub(crate) fn begin(name: &str) -> Self {
        let style = ProgressStyle::with_template("{prefix} {bar:24} {msg}")
            .expect("the template is right")
            .progress_chars("━╸─");
        let target = match output::volume() {
            Volume::Normal => ProgressDrawTarget::stderr(),
            Volume::Quiet | Volume::Verbose => ProgressDrawTarget::hidden(),
        };
        let bar = ProgressBar::with_draw_target(Some(STEPS), target).with_style(style);
        bar.set_prefix(name.to_owned());
        let progress = Self { bar, name: (output::volume() == Volume::Verbose).then(|| name.to_owned()) };
        progress.say("read");
        progress
    }

    /// A stage begins, in some part of the surface.
    pub(crate) fn stage(&mut self, stage: Stage) {
        let done = Stage::ALL.iter().position(|&s| s == stage).unwrap_or(0) as u64 + 1;
        if done >= self.bar.position() {
            self.bar.set_position(done);
            self.say(stage.name());
        }
    }

    /// A step begins that is none of the library's stages.
    pub(crate) fn step(&mut self, name: &'static str) {
        self.bar.inc(1);
        self.say(name);
    }

    fn say(&self, stage: &'static str) {
        self.bar.set_message(stage);
        if let Some(name) = &self.name {
            output::note(&format!("{name}: {stage} ({:.2} s)\n", self.bar.elapsed().as_secs_f64()));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
