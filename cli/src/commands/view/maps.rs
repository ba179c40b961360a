//! Maps that are known, and the one that is made before anybody has asked.
//!
//! A browser takes a while to open the page, and the page to read and draw its surface. What it will ask for first is known all along: so that
//! map is begun with the server, and whoever asks for it waits for what is left to do. A question for another map stops it.

use crate::commands::shared::Shown;
use cones::Options;
use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// So many maps are kept: that of a tab, to be measured and saved, beside that of another. (Igea, 134,345 vertices: 30 MB each.)
const KEPT: usize = 2;
/// Who waits looks so often whether there is a newer question.
const LOOK: Duration = Duration::from_millis(20);

/// See the [module](self).
#[derive(Debug, Default)]
pub(super) struct Maps {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    /// The newest last.
    known: VecDeque<(Options, Arc<Shown>)>,
    begun: Option<Begun>,
}

/// A map that is made unasked.
#[derive(Clone, Debug)]
pub(super) struct Begun {
    options: Options,
    is_stopped: Arc<AtomicBool>,
}

impl Begun {
    /// What it is made with.
    pub(super) fn options(&self) -> &Options {
        &self.options
    }

    /// Whether the work goes on.
    pub(super) fn goes_on(&self) -> ControlFlow<()> {
        if self.is_stopped.load(SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

impl Maps {
    /// Says that a map is going to be made, which is then [ended](Self::end).
    pub(super) fn begin(&self, options: Options) -> Begun {
        let begun = Begun { options, is_stopped: Arc::default() };
        self.lock().begun = Some(begun.clone());
        begun
    }

    /// Ends what was begun, with a map or without.
    pub(super) fn end(&self, begun: Begun, shown: Option<Arc<Shown>>) {
        let mut state = self.lock();
        if !begun.is_stopped.load(SeqCst) {
            state.begun = None;
        }
        if let Some(shown) = shown {
            state.keep(begun.options, shown);
        }
        self.changed.notify_all();
    }

    /// The map, if it is known or being made; otherwise nothing is being made from now on. Waits for as long as `goes_on` says.
    pub(super) fn find(&self, options: &Options, goes_on: impl Fn() -> ControlFlow<()>) -> Option<Arc<Shown>> {
        let mut state = self.lock();
        loop {
            if let Some((_, shown)) = state.known.iter().find(|(of, _)| of == options) {
                return Some(Arc::clone(shown));
            }
            let is_begun = state.begun.as_ref().is_some_and(|begun| begun.options == *options);
            if !is_begun || goes_on().is_break() {
                break;
            }
            state = self
                .changed
                .wait_timeout(state, LOOK)
                .map_or_else(|poisoned| poisoned.into_inner().0, |(state, _)| state);
        }
        if let Some(other) = state.begun.take_if(|begun| begun.options != *options) {
            other.is_stopped.store(true, SeqCst);
        }
        None
    }

    /// Keeps a map, in the place of the oldest.
    pub(super) fn keep(&self, options: Options, shown: Arc<Shown>) {
        self.lock().keep(options, shown);
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn keep(&mut self, options: Options, shown: Arc<Shown>) {
        self.known.retain(|(of, _)| *of != options);
        if self.known.len() == KEPT {
            self.known.pop_front();
        }
        self.known.push_back((options, shown));
    }
}
