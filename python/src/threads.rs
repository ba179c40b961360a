//! The pool of threads that all work runs on.
//!
//! Rayon's global pool does not survive a fork: the child has its queues and none of its threads, and waits for ever. Python forks
//! (`multiprocessing` does by default on Linux until 3.13), so the pool is kept with the process it belongs to, and a child makes its own.
//! `RAYON_NUM_THREADS` says how many threads it has.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::Error;

/// Bytes of stack a thread: what the main thread of a program has.
const STACK: usize = 8 << 20;

static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// This process's pool.
pub(crate) fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut kept: MutexGuard<Option<(u32, Arc<ThreadPool>)>> = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    match &*kept {
        Some((owner, pool)) if *owner == process => Ok(Arc::clone(pool)),
        _ => {
            let pool = ThreadPoolBuilder::new().stack_size(STACK).build();
            let pool = Arc::new(pool.map_err(|error| Error::new_err(format!("no threads to work on: {error}")))?);
            // The parent's pool has no threads here; dropping it would wait for them.
            std::mem::forget(kept.replace((process, Arc::clone(&pool))));
            Ok(pool)
        }
    }
}

/// Does work on it, while other threads of the interpreter go on.
pub(crate) fn in_pool<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = pool()?;
    Ok(py.detach(|| pool.install(work)))
}

/// On how many threads work runs.
#[pyfunction]
pub(crate) fn thread_count() -> PyResult<usize> {
    Ok(pool()?.current_num_threads())
}
