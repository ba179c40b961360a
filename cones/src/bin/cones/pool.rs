//! The threads that work is spread over: this one and as many others as can be had.
//!
//! A limit on processes (`ulimit -u`) may allow fewer threads than there are cores, or none. Rayon gives up where one cannot
//! be started, so they are started here, each to wait for the work that rayon hands to it.

use rayon::{ThreadBuilder, ThreadPoolBuilder};
use std::io;
use std::num::NonZeroUsize;
use std::sync::mpsc::{Sender, channel};
use std::thread;

/// Makes rayon's pool, of so many threads or one for each core.
pub(crate) fn make(threads: Option<NonZeroUsize>) {
    let wanted = threads.or_else(from_environment).or_else(|| thread::available_parallelism().ok());
    let others: Vec<Sender<ThreadBuilder>> = (1..wanted.map_or(1, NonZeroUsize::get)).map_while(|_| wait()).collect();
    let builder = ThreadPoolBuilder::new().num_threads(1 + others.len()).use_current_thread();
    let mut others = others.into_iter();
    let builder = builder.spawn_handler(move |work| match others.next() {
        Some(other) => other.send(work).map_err(|_| io::Error::other("a thread has ended before its work began")),
        None => Err(io::Error::other("there are as many threads as were asked for")),
    });
    // It fails only where the pool is there already.
    let _ = builder.build_global();
}

/// The number of threads that rayon takes where it is not told.
fn from_environment() -> Option<NonZeroUsize> {
    std::env::var("RAYON_NUM_THREADS").ok()?.parse().ok()
}

/// A thread that waits for work, if there is one to be had.
fn wait() -> Option<Sender<ThreadBuilder>> {
    let (sender, receiver) = channel::<ThreadBuilder>();
    let work = move || {
        if let Ok(work) = receiver.recv() {
            work.run();
        }
    };
    thread::Builder::new().spawn(work).ok().map(|_| sender)
}
