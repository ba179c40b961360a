//! Which request of each tab is the newest: older ones are stopped.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering::SeqCst};
use std::sync::{Arc, Mutex, PoisonError};

/// So many tabs are remembered; of those beyond the oldest are forgotten, which stops nothing.
const MOST: usize = 64;

/// The tabs that have asked.
#[derive(Debug, Default)]
pub(super) struct Tabs(Mutex<Known>);

#[derive(Debug, Default)]
struct Known {
    /// The newest request of each tab, and when it was made.
    newest: HashMap<String, (Arc<AtomicU64>, u64)>,
    count: u64,
}

/// A request that a newer one of the same tab stops.
#[derive(Clone, Debug)]
pub(super) struct Turn {
    newest: Arc<AtomicU64>,
    serial: u64,
}

impl Tabs {
    /// A request of a tab; numbers of requests go up.
    pub(super) fn turn(&self, tab: &str, serial: u64) -> Turn {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.count += 1;
        let count = known.count;
        if known.newest.len() >= MOST && !known.newest.contains_key(tab) {
            let oldest = known.newest.iter().min_by_key(|(_, (_, at))| *at).map(|(tab, _)| tab.clone());
            oldest.and_then(|oldest| known.newest.remove(&oldest));
        }
        let (newest, at) = known.newest.entry(tab.to_owned()).or_default();
        *at = count;
        newest.fetch_max(serial, SeqCst);
        Turn { newest: Arc::clone(newest), serial }
    }
}

impl Turn {
    /// Whether the work goes on.
    pub(super) fn goes_on(&self) -> ControlFlow<()> {
        if self.newest.load(SeqCst) > self.serial { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_request_of_a_tab_stops_the_others() {
        let tabs = Tabs::default();
        let [first, second] = [1, 2].map(|serial| tabs.turn("a", serial));
        let other = tabs.turn("b", 1);
        let late = tabs.turn("a", 1);
        assert!(first.goes_on().is_break() && late.goes_on().is_break());
        assert!(second.goes_on().is_continue() && other.goes_on().is_continue());
    }

    #[test]
    fn tabs_without_end_take_no_memory() {
        let tabs = Tabs::default();
        (0..1000).for_each(|tab| _ = tabs.turn(&tab.to_string(), 1));
        assert_eq!(tabs.0.lock().unwrap().newest.len(), MOST);
    }
}
