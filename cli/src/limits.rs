//! Limits that the system sets: on the size of files, on memory, on threads. They end in an exit code, not in a signal.

use std::num::NonZeroUsize;

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

/// Starts the threads to work on; where none can be started the main thread does all the work.
pub(crate) fn start_threads(count: Option<NonZeroUsize>) {
    let threads = |count| rayon::ThreadPoolBuilder::new().num_threads(count);
    if threads(count.map_or(0, NonZeroUsize::get)).build_global().is_err() {
        // Results do not depend on it, so there is nothing to tell.
        let _ = threads(1).use_current_thread().build_global();
    }
}
