//! Progress on stderr while the work goes on: a bar on a terminal, a line a stage where that is asked for.

use crate::output::{self, Volume};
use cones::{Observer, Stage};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};

/// What the command does itself comes on top of the library's stages: reading first, measuring, writing and drawing last.
const STEPS: u64 = Stage::ALL.len() as u64 + 4;
/// The bar's length for each step.
const LENGTH: u64 = 1000;

/// The progress on one surface; clones share it.
#[derive(Clone, Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    /// The surface, in lines that say a stage.
    name: Option<Arc<str>>,
    /// The step that was said last.
    said: Arc<Mutex<&'static str>>,
}

impl Progress {
    /// The progress on one surface, which begins with its reading.
    pub(crate) fn begin(name: &str) -> Self {
        Self::shown(name, output::volume() == Volume::Normal)
    }

    /// The progress on one of several surfaces at a time: no bar, which others would overwrite.
    pub(crate) fn begin_one_of_many(name: &str) -> Self {
        Self::shown(name, false)
    }

    fn shown(name: &str, has_bar: bool) -> Self {
        let style = ProgressStyle::with_template("{prefix} {bar:24} {msg}")
            .expect("the template is right")
            .progress_chars("━╸─");
        let target = if has_bar { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(STEPS * LENGTH), target).with_style(style);
        bar.set_prefix(name.to_owned());
        let name = (output::volume() == Volume::Verbose).then(|| name.into());
        let progress = Self { bar, name, said: Arc::default() };
        progress.say("read");
        progress
    }

    /// What hears of the library's stages, on any component. The bar never goes back.
    pub(crate) fn observer(&self) -> impl Observer + use<> {
        let progress = self.clone();
        move |at: cones::Progress| {
            let steps = 1 + Stage::ALL.iter().position(|&s| s == at.stage).unwrap_or(0) as u64;
            let components = at.components.max(1) as f64;
            let share = (at.component as f64 + at.fraction.unwrap_or(0.0)) / components;
            progress.reach(steps * LENGTH + (share * LENGTH as f64) as u64, at.stage.name());
            ControlFlow::Continue(())
        }
    }

    /// A step begins that is none of the library's stages.
    pub(crate) fn step(&self, name: &'static str) {
        self.reach((self.bar.position() / LENGTH + 1) * LENGTH, name);
    }

    /// Nothing more is to be shown.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn reach(&self, position: u64, stage: &'static str) {
        if position >= self.bar.position() {
            self.bar.set_position(position);
            self.say(stage);
        }
    }

    fn say(&self, stage: &'static str) {
        let Ok(mut said) = self.said.lock() else { return };
        if std::mem::replace(&mut *said, stage) == stage {
            return;
        }
        self.bar.set_message(stage);
        if let Some(name) = &self.name {
            output::note(&format!("{name}: {stage} ({:.2} s)\n", self.bar.elapsed().as_secs_f64()));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        // The last of the clones clears the bar, also where an error ends the work.
        if Arc::strong_count(&self.said) == 1 {
            self.finish();
        }
    }
}
