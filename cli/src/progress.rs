//! A progress bar on stderr while the stages run; nothing where stderr is no terminal.

use cones::Stage;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Reading and writing come on top of the library's stages.
const STEPS: u64 = 8;

#[derive(Debug)]
pub(crate) struct Progress(ProgressBar);

impl Progress {
    /// A bar for one surface, which begins with its reading.
    pub(crate) fn begin(name: &str) -> Self {
        let style = ProgressStyle::with_template("{prefix} {bar:24} {msg}")
            .expect("the template is right")
            .progress_chars("━╸─");
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr()).with_style(style);
        bar.set_prefix(name.to_owned());
        bar.set_message("read");
        Self(bar)
    }

    /// A stage begins, in some part of the surface.
    pub(crate) fn stage(&mut self, stage: Stage) {
        let done = Stage::ALL.iter().position(|&s| s == stage).unwrap_or(0) as u64 + 1;
        if done >= self.0.position() {
            self.0.set_position(done);
            self.0.set_message(stage.name());
        }
    }

    /// A step begins that is none of the library's stages.
    pub(crate) fn step(&mut self, name: &'static str) {
        self.0.inc(1);
        self.0.set_message(name);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
