//! Limits that the system sets: on the size of files, on memory, on threads. They end in an exit code, not in a signal.

use std::io;
use std::num::NonZeroUsize;
use std::sync::RwLock;
use std::thread;

/// From here on a file that grows beyond its limit is an error like a full disk, and where memory cannot be had the command
/// ends with exit code 1.
#[cfg(unix)]
pub(crate) fn end_cleanly_at_limits() {
    use signal_hook::consts::{SIGABRT, SIGXFSZ};
    use signal_hook::flag;
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    // Once the signal has a handler, whatever it does, the call that grew the file returns an error.
    let _ = flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
    // Rust says how much memory was asked for, and aborts.
    let _ = flag::register_conditional_shutdown(SIGABRT, 1, Arc::new(AtomicBool::new(true)));
}

#[cfg(not(unix))]
pub(crate) fn end_cleanly_at_limits() {}

/// Starts the threads to work on; where they cannot be started the main thread does all the work, with the same results.
pub(crate) fn start_threads(count: Option<NonZeroUsize>) {
    let threads = |count| rayon::ThreadPoolBuilder::new().num_threads(count);
    let wanted = count.or_else(|| thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
    // A pool that fails once is not built again, so this is tried without it.
    let pool = if can_start(wanted) { threads(wanted) } else { threads(1).use_current_thread() };
    // It fails only where the pool is there already.
    let _ = pool.build_global();
}

/// Whether so many threads can run at the same time.
fn can_start(count: usize) -> bool {
    let gate = RwLock::new(());
    let closed = gate.write();
    thread::scope(|scope| {
        let wait = || drop(gate.read());
        let started: io::Result<Vec<_>> =
            (0..count).map(|_| thread::Builder::new().spawn_scoped(scope, wait)).collect();
        drop(closed);
        started.map(|threads| threads.into_iter().for_each(|thread| drop(thread.join()))).is_ok()
    })
}
