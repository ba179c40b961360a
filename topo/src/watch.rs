//! Stopping long work.
//!
//! Pairing a field of 10⁸ values takes seconds. What has a variant `…_watched` asks a [`Watch`] whether to go on, before each block of
//! some ten thousand vertices: stopped work returns [`Error::Interrupted`](crate::Error::Interrupted). Results do not depend on being
//! watched.

use core::fmt;
use core::ops::ControlFlow;
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// What long work asks now and then whether to go on.
///
/// The observer may be asked from several threads at once; the first [`Break`](ControlFlow::Break) ends the work.
///
/// ```
/// use std::ops::ControlFlow;
/// use topo::{Error, PersistenceOptions, Watch};
///
/// let grid = topo::Grid::new([300, 400], topo::Connectivity::Axis);
/// let impatient = || ControlFlow::Break(());
/// let peaks = PersistenceOptions::new().superlevel_watched(&grid, &[0.5; 120_000], Watch::new(&impatient));
/// assert_eq!(peaks, Err(Error::Interrupted));
/// ```
#[derive(Clone, Copy, Default)]
pub struct Watch<'a>(Option<&'a (dyn Fn() -> ControlFlow<()> + Sync)>);

impl<'a> Watch<'a> {
    /// Never stops.
    pub const NONE: Self = Self(None);

    /// Stops when an observer says so.
    pub fn new(observer: &'a (dyn Fn() -> ControlFlow<()> + Sync)) -> Self {
        Self(Some(observer))
    }

    /// Whether anybody is asked.
    pub(crate) fn is_watched(self) -> bool {
        self.0.is_some()
    }

    /// Whether the work must end.
    #[must_use]
    pub fn stops(self) -> bool {
        self.0.is_some_and(|observer| observer().is_break())
    }

    /// Does work with a watch that, once it has stopped, does so ever after, whatever the observer says then.
    pub(crate) fn held<T>(self, work: impl FnOnce(Watch<'_>) -> T) -> T {
        let stopped = AtomicBool::new(false);
        let observer = || {
            if stopped.load(Relaxed) || self.stops() {
                stopped.store(true, Relaxed);
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        };
        if self.is_watched() { work(Watch::new(&observer)) } else { work(Watch::NONE) }
    }
}

impl fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Watch").field("is_watched", &self.is_watched()).finish()
    }
}
