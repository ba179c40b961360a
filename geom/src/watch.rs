//! Watching long work, and stopping it.
//!
//! What takes more than some ten milliseconds on a surface of 10⁵ vertices has a variant `…_watched`, which asks a [`Watch`] every
//! few milliseconds whether to go on, and tells it how far the work is. Stopped work returns [`Interrupted`], or an error
//! that has it as a variant; nothing is left half done that could be asked. Results do not depend on being watched.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use thiserror::Error;

/// What long work asks now and then whether to go on, and tells how far it is.
///
/// The observer is given a fraction between 0 and 1, which rises as the work goes on, and answers whether the work should.
/// Once it has said [`Break`](ControlFlow::Break) it must keep saying so.
///
/// ```
/// use geom::{Interrupted, Metric, ShortestPaths, VertexId, Watch, shapes};
/// use std::ops::ControlFlow;
///
/// let shape = shapes::torus(1, 20_000);
/// let mesh = shape.mesh();
/// let metric = Metric::from_points(&mesh, &shape.points);
/// let impatient = |fraction: f64| if fraction > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
/// let source = [(VertexId(0), 0)];
/// let paths = ShortestPaths::new_watched(&mesh, metric.lengths(), source, Watch::new(&impatient));
/// assert_eq!(paths.unwrap_err(), Interrupted);
/// ```
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    observer: Option<&'a (dyn Fn(f64) -> ControlFlow<()> + Sync)>,
    from: f64,
    to: f64,
}

impl Watch<'static> {
    /// Never stops and tells nobody.
    pub const NONE: Self = Self { observer: None, from: 0.0, to: 1.0 };
}

impl<'a> Watch<'a> {
    /// A watch over the whole of some work.
    pub fn new(observer: &'a (dyn Fn(f64) -> ControlFlow<()> + Sync)) -> Self {
        Self { observer: Some(observer), from: 0.0, to: 1.0 }
    }

    /// The same for a piece of the work: what is told of the piece, from 0 to 1, is between `from` and `to` of the whole.
    #[must_use]
    pub fn within(self, from: f64, to: f64) -> Self {
        let place = |fraction: f64| self.from + fraction * (self.to - self.from);
        Self { from: place(from), to: place(to), ..self }
    }

    /// Tells how far the work is, as a fraction; true if the work must end.
    #[must_use]
    pub fn stops_at(self, fraction: f64) -> bool {
        let place = || self.from + fraction.clamp(0.0, 1.0) * (self.to - self.from);
        self.observer.is_some_and(|observer| observer(place()).is_break())
    }

    /// Does work on several threads with a watch that tells the greatest fraction of them, so that what is told never falls.
    pub fn shared<T>(self, work: impl FnOnce(Watch) -> T) -> T {
        let told = Mutex::new(0.0f64);
        let rising = |fraction: f64| {
            // An observer that panicked has stopped the work by that.
            let Ok(mut told) = told.lock() else { return ControlFlow::Break(()) };
            *told = told.max(fraction);
            if self.stops_at(*told) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        if self.observer.is_none() { work(Watch::NONE) } else { work(Watch::new(&rising)) }
    }

    /// The same for work that returns a result.
    ///
    /// # Errors
    /// If the work must end.
    pub fn ask(self, fraction: f64) -> Result<(), Interrupted> {
        if self.stops_at(fraction) { Err(Interrupted) } else { Ok(()) }
    }

    /// Asks for each 2048th of so many steps.
    pub(crate) fn ask_at_step(self, step: usize, steps: usize) -> Result<(), Interrupted> {
        if step.is_multiple_of(2048) { self.ask(step as f64 / steps as f64) } else { Ok(()) }
    }
}

/// How far work is that several threads share, told as a share of its steps.
pub(crate) struct Progress<'a> {
    watch: Watch<'a>,
    done: AtomicUsize,
    /// The fraction that was told last: what is told never falls.
    told: Mutex<f64>,
    steps: usize,
}

impl<'a> Progress<'a> {
    pub(crate) fn new(watch: Watch<'a>, steps: usize) -> Self {
        Self { watch, done: AtomicUsize::new(0), told: Mutex::new(0.0), steps }
    }

    /// Counts steps that are done.
    pub(crate) fn add(&self, steps: usize) {
        self.done.fetch_add(steps, Relaxed);
    }

    /// Tells how far the work is.
    ///
    /// # Errors
    /// If it must end.
    pub(crate) fn ask(&self) -> Result<(), Interrupted> {
        // An observer that panicked has stopped the work by that.
        let mut told = self.told.lock().map_err(|_| Interrupted)?;
        *told = told.max(self.done.load(Relaxed) as f64 / self.steps.max(1) as f64);
        self.watch.ask(*told)
    }
}

impl Default for Watch<'_> {
    fn default() -> Self {
        Watch::NONE
    }
}

impl fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { observer, from, to } = self;
        f.debug_struct("Watch").field("is_watched", &observer.is_some()).field("from", from).field("to", to).finish()
    }
}

/// The work was stopped by its [`Watch`].
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the work was interrupted")]
pub struct Interrupted;

/// What work gives that nobody watches.
pub(crate) fn unwatched<T>(result: Result<T, Interrupted>) -> T {
    result.expect("only a watch interrupts")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_pieces_are_told_as_fractions_of_the_whole() {
        let told = Mutex::new(Vec::new());
        let observer = |fraction: f64| {
            told.lock().unwrap().push(fraction);
            if fraction < 0.8 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        let watch = Watch::new(&observer);
        let piece = watch.within(0.5, 1.0).within(0.5, 1.0);
        assert!(!watch.stops_at(0.25) && !piece.stops_at(0.0));
        assert!(piece.stops_at(0.5) && piece.stops_at(7.0));
        assert_eq!(*told.lock().unwrap(), [0.25, 0.75, 0.875, 1.0]);
        assert!(!Watch::NONE.stops_at(1.0) && !Watch::default().within(0.0, 0.5).stops_at(f64::NAN));
    }
}
