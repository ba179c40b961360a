//! Work without the interpreter's lock, that can be stopped.
//!
//! Only the main thread hears of signals, and only there Python code may run for them; the work is on other threads. So the thread that
//! called waits, and wakes every [`INTERVAL`]: it looks for signals, tells the caller's callable how far the work is, and if either
//! raises, the work is told to stop and the exception is passed on.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use cones::{Observer, Progress};
use geom::Watch;
use pyo3::prelude::*;

use crate::threads::pool;

/// How often the caller's thread looks up. Ctrl-C is answered within this and what the work takes to stop.
const INTERVAL: Duration = Duration::from_millis(40);

/// What the work tells, and whether it is to go on.
#[derive(Debug, Default)]
pub(crate) struct Told {
    stops: AtomicBool,
    last: Mutex<Option<(&'static str, Option<f64>)>>,
}

impl Told {
    fn tell(&self, stage: &'static str, fraction: Option<f64>) -> ControlFlow<()> {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some((stage, fraction));
        self.goes_on()
    }

    /// Hands a watch over a stage of some name to the work.
    pub(crate) fn watch<T>(&self, stage: &'static str, work: impl FnOnce(Watch<'_>) -> T) -> T {
        let observe = |fraction: f64| self.tell(stage, (!fraction.is_nan()).then_some(fraction));
        work(Watch::new(&observe))
    }

    /// Whether work that tells nothing is to go on.
    pub(crate) fn goes_on(&self) -> ControlFlow<()> {
        if self.stops.load(Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// What the library's analysis tells.
    pub(crate) fn observer(self: &Arc<Self>) -> impl Observer + use<> {
        let told = Arc::clone(self);
        move |progress: Progress| told.tell(progress.stage.name(), progress.fraction)
    }
}

/// Runs work on the pool, while the calling thread listens for signals and tells `progress(stage, fraction)`.
pub(crate) fn watched<T: Send, E: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Arc<Told>) -> Result<T, E> + Send,
) -> PyResult<T>
where
    PyErr: From<crate::error::Failed<E>>,
{
    let pool = pool()?;
    let told = Arc::new(Told::default());
    let done: PyResult<Result<T, E>> = py.detach(|| {
        std::thread::scope(|scope| {
            let (sender, receiver) = channel();
            let (told, pool) = (&told, &pool);
            let working = scope.spawn(move || sender.send(pool.install(|| work(told))));
            let mut raised = None;
            loop {
                match receiver.recv_timeout(INTERVAL) {
                    Ok(done) => break raised.map_or(Ok(done), Err),
                    Err(RecvTimeoutError::Timeout) if raised.is_some() => {}
                    Err(RecvTimeoutError::Timeout) => {
                        raised = Python::attach(|py| look_up(py, told, progress.as_ref())).err();
                        told.stops.store(raised.is_some(), Relaxed);
                    }
                    Err(RecvTimeoutError::Disconnected) => match working.join() {
                        Err(panic) => std::panic::resume_unwind(panic),
                        Ok(_) => unreachable!("work that ends has sent its result"),
                    },
                }
            }
        })
    });
    done?.map_err(|error| crate::error::Failed(error).into())
}

fn look_up(py: Python<'_>, told: &Told, progress: Option<&Py<PyAny>>) -> PyResult<()> {
    py.check_signals()?;
    let last = *told.last.lock().unwrap_or_else(PoisonError::into_inner);
    if let (Some(progress), Some(last)) = (progress, last) {
        progress.call1(py, last)?;
    }
    Ok(())
}
