//! Progress, stopping, and the time that stages take.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use geom::Watch;

use crate::error::Error;

/// An observer is told at most so often.
const INTERVAL: Duration = Duration::from_millis(2);

/// The stages, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Stage {
    /// The model is made into surfaces.
    Prepare,
    /// Intrinsic Delaunay triangulation, Laplacian, its factorization.
    Factor,
    /// The conformal factor, its persistent extrema, the places of the cones.
    Hierarchy,
    /// The cones' curvatures.
    Curvature,
    /// Seams through the cones.
    Cut,
    /// Newton's method for the metric.
    Scale,
    /// Positions in the plane, fold-overs removed.
    Layout,
    /// What lies over itself, and how it is taken apart.
    Islands,
    /// Islands packed into the square; it is told of as on the first component.
    Pack,
}

impl Stage {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Prepare,
        Self::Factor,
        Self::Hierarchy,
        Self::Curvature,
        Self::Cut,
        Self::Scale,
        Self::Layout,
        Self::Islands,
        Self::Pack,
    ];

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Prepare => "prepare",
            Self::Factor => "factor",
            Self::Hierarchy => "hierarchy",
            Self::Curvature => "curvature",
            Self::Cut => "cut",
            Self::Scale => "scale",
            Self::Layout => "layout",
            Self::Islands => "islands",
            Self::Pack => "pack",
        }
    }
}

/// How far the work is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// What is being done.
    pub stage: Stage,
    /// On which connected component. Of those of one shape, for which everything is done once, one is named.
    pub component: usize,
    /// How many there are; 0 while that is not known.
    pub components: usize,
    /// How much of the stage is done on it, from 0 to 1, where that is known. It does not fall, but a stage may begin again: where other
    /// cones are tried.
    pub fraction: Option<f64>,
}

/// Hears of the work, every few milliseconds, from whichever thread does it (components are worked on at the same time, so
/// two threads may be telling at once), and can stop it: once it has said
/// [`ControlFlow::Break`] what was asked for ends with [`Error::Interrupted`], within some 50 ms on a surface of 134 thousand
/// vertices (`cargo bench -p cones --bench stopping`). The analysis stays as it was and can be asked again.
pub trait Observer: Send + Sync {
    /// Hears how far the work is, and says whether it should go on.
    fn hear(&self, progress: Progress) -> ControlFlow<()>;
}

impl<F: Fn(Progress) -> ControlFlow<()> + Send + Sync> Observer for F {
    fn hear(&self, progress: Progress) -> ControlFlow<()> {
        self(progress)
    }
}

/// Hears nothing and never stops anything.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Silent;

impl Observer for Silent {
    fn hear(&self, _: Progress) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// The time that each stage took, on the clock: where components were worked on at the same time the clock's time is
/// divided among the stages as they were busy, so that all of them add up to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Times([Duration; Stage::ALL.len()]);

impl Times {
    /// The time of a stage.
    pub fn of(&self, stage: Stage) -> Duration {
        self.0[stage as usize]
    }

    /// All of them together.
    pub fn total(&self) -> Duration {
        self.0.iter().sum()
    }

    pub(crate) fn add(&mut self, stage: Stage, time: Duration) {
        self.0[stage as usize] += time;
    }

    /// What several threads were busy with in a time on the clock.
    pub(crate) fn on_clock(busy: impl IntoIterator<Item = Self>, clock: Duration) -> Self {
        let sum: Self = busy.into_iter().sum();
        let share = clock.as_secs_f64() / sum.total().as_secs_f64().max(f64::MIN_POSITIVE);
        Self(sum.0.map(|time| time.mul_f64(if share.is_finite() { share } else { 0.0 })))
    }
}

impl std::ops::AddAssign for Times {
    fn add_assign(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(time, more)| *time += more);
    }
}

impl std::iter::Sum for Times {
    fn sum<I: Iterator<Item = Self>>(times: I) -> Self {
        times.fold(Self::default(), |mut sum, times| {
            sum += times;
            sum
        })
    }
}

/// Something that was asked for, while it is worked on: tells the observer, and knows whether it has said stop.
pub(crate) struct Task {
    observer: Arc<dyn Observer>,
    components: usize,
    stopped: AtomicBool,
    began: Instant,
    /// When the observer was last told how far a stage is, after the beginning; locked while it hears that.
    told: Mutex<Duration>,
}

impl Task {
    pub(crate) fn new(observer: &Arc<dyn Observer>, components: usize) -> Self {
        Self {
            observer: Arc::clone(observer),
            components,
            stopped: AtomicBool::new(false),
            began: Instant::now(),
            told: Mutex::new(Duration::ZERO),
        }
    }

    /// Runs a stage on a component and adds up its time. What the work returns once the watch has said stop is dropped.
    ///
    /// # Errors
    /// If the observer has said stop.
    pub(crate) fn stage<T>(
        &self,
        (stage, component): (Stage, usize),
        times: &mut Times,
        work: impl FnOnce(Watch) -> T,
    ) -> Result<T, Error> {
        let began = Instant::now();
        self.tell(stage, component, Some(0.0));
        // What is tried at the same time, or one after the other, tells fractions of its own: the greatest is told.
        let greatest = AtomicU64::new(0);
        let observe = |fraction: f64| {
            // Numbers that are not negative are in the order of their bits; NaN is none of them.
            let known = if fraction >= 0.0 { fraction.to_bits() } else { 0 };
            greatest.fetch_max(known, Relaxed);
            // One thread tells at a time, or a smaller fraction could be told after a greater one.
            if let Ok(mut told) = self.told.try_lock() {
                let now = self.began.elapsed();
                if now.saturating_sub(*told) >= INTERVAL {
                    *told = now;
                    let greatest = f64::from_bits(greatest.load(Relaxed));
                    self.tell(stage, component, (!fraction.is_nan()).then_some(greatest));
                }
            }
            if self.stopped.load(Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let done = work(Watch::new(&observe));
        times.add(stage, began.elapsed());
        if self.stopped.load(Relaxed) { Err(Error::Interrupted) } else { Ok(done) }
    }

    fn tell(&self, stage: Stage, component: usize, fraction: Option<f64>) {
        let progress = Progress { stage, component, components: self.components, fraction };
        if !self.stopped.load(Relaxed) && self.observer.hear(progress).is_break() {
            self.stopped.store(true, Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    #[test]
    fn what_a_slow_observer_hears_of_two_threads_never_falls() {
        let heard = Arc::new(Mutex::new(Vec::new()));
        let (hears, is_heard) = mpsc::channel();
        let listener = Arc::clone(&heard);
        let observer: Arc<dyn Observer> = Arc::new(move |progress: Progress| {
            if progress.fraction == Some(0.25) {
                hears.send(()).expect("somebody waits");
                std::thread::sleep(10 * INTERVAL);
            }
            listener.lock().expect("no panic").extend(progress.fraction);
            ControlFlow::Continue(())
        });
        let work = |watch: Watch| {
            std::thread::sleep(2 * INTERVAL);
            std::thread::scope(|scope| {
                scope.spawn(|| assert!(!watch.stops_at(0.25)));
                is_heard.recv().expect("it is told");
                std::thread::sleep(2 * INTERVAL);
                assert!(!watch.stops_at(0.5));
            });
            std::thread::sleep(2 * INTERVAL);
            assert!(!watch.stops_at(0.5));
        };
        Task::new(&observer, 1).stage((Stage::Islands, 0), &mut Times::default(), work).expect("nobody says stop");
        let mut heard = heard.lock().expect("no panic").clone();
        heard.dedup();
        assert_eq!(heard, [0.0, 0.25, 0.5]);
    }
}
