//! Progress of long work, and how to stop it.

use std::fmt;
use std::ops::ControlFlow;

/// What long work asks now and then whether to go on, and tells how far it is.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    observer: Option<&'a (dyn Fn(f64) -> ControlFlow<()> + Sync)>,
    from: f64,
    to: f64,
}

impl<'a> Watch<'a> {
    /// Never stops, and tells nobody.
    pub const NONE: Watch<'static> = Watch { observer: None, from: 0.0, to: 1.0 };

    /// Tells an observer fractions from 0 to 1. One that has said Break must keep saying so.
    pub fn new(observer: &'a (dyn Fn(f64) -> ControlFlow<()> + Sync)) -> Self {
        Self { observer: Some(observer), from: 0.0, to: 1.0 }
    }

    /// A piece of the work: its fractions from 0 to 1 are those between `from` and `to` here.
    #[must_use]
    pub fn within(self, from: f64, to: f64) -> Self {
        let at = |fraction: f64| self.from + fraction * (self.to - self.from);
        Self { from: at(from), to: at(to), ..self }
    }

    /// Tells how far the work is; true if it must end.
    #[must_use]
    pub fn stops_at(self, fraction: f64) -> bool {
        let at = self.from + fraction * (self.to - self.from);
        self.observer.is_some_and(|observer| observer(at).is_break())
    }
}

impl Default for Watch<'_> {
    fn default() -> Self {
        Self::NONE
    }
}

impl fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("Watch").field("from", &self.from).field("to", &self.to).finish_non_exhaustive()
    }
}
