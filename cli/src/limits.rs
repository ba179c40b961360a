//! Limits that the system sets: on the size of files, on memory, on threads. They end in an exit code, not in a signal.

use crate::error::CommandError;
use rayon::{ThreadBuilder, ThreadPool, ThreadPoolBuilder};
use std::io;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::mpsc::{Sender, channel};
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

/// What the program needs by itself.
const BASE: u64 = 24_000_000;
/// What unwrapping takes for a vertex at least: 2600 to 3600 bytes were measured from 20 to 134 thousand vertices.
pub(crate) const UNWRAPPED: u64 = 2000;
/// What making a shape takes for a vertex at least: 133 to 205 bytes were measured from 300 thousand to a million vertices.
pub(crate) const MADE: u64 = 130;

/// Refuses a surface of so many vertices, which take so many bytes each, where the limit of the address space (`ulimit -v`) is sure to
/// be too low: an allocation that fails ends the program with less of a sentence, wherever it is.
pub(crate) fn check_memory(path: &Path, vertices: usize, per_vertex: u64) -> Result<(), CommandError> {
    let needed = BASE + per_vertex * vertices as u64;
    match std::fs::read_to_string("/proc/self/limits").ok().as_deref().and_then(address_space) {
        Some(allowed) if allowed < needed => {
            Err(CommandError::Memory { path: path.to_owned(), vertices, needed, allowed })
        }
        _ => Ok(()),
    }
}

/// The limit of the address space in bytes, as Linux tells it.
fn address_space(limits: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// More threads than any machine has cores for; to start thousands takes minutes.
pub(crate) const MOST_THREADS: usize = 1024;

/// Makes the pool of threads to work on: this one and as many others as can be had, in all so many or one for each core.
/// A limit on processes (`ulimit -u`) may allow fewer, or none. Rayon gives up where one cannot be started, so they are
/// started here, each to wait for the work that rayon hands to it.
pub(crate) fn start_threads(count: Option<NonZeroUsize>) {
    let wanted = count.or_else(from_environment).or_else(|| thread::available_parallelism().ok());
    let wanted = wanted.map_or(1, NonZeroUsize::get).min(MOST_THREADS);
    let others: Vec<Sender<ThreadBuilder>> = (1..wanted).map_while(|_| wait()).collect();
    let builder = ThreadPoolBuilder::new().num_threads(1 + others.len()).use_current_thread();
    let mut others = others.into_iter();
    let builder = builder.spawn_handler(move |work| match others.next() {
        Some(other) => other.send(work).map_err(|_| io::Error::other("a thread has ended before its work began")),
        None => Err(io::Error::other("there are as many threads as were asked for")),
    });
    // It fails only where the pool is there already.
    let _ = builder.build_global();
}

/// So many pools of threads, or as many as can be had, which share the threads of the one that there is: no more than it has.
pub(crate) fn pools(count: usize) -> Vec<ThreadPool> {
    let threads = rayon::current_num_threads();
    let count = count.min(threads);
    let share = |k: usize| threads / count + usize::from(k < threads % count);
    (0..count).map_while(|k| ThreadPoolBuilder::new().num_threads(share(k)).build().ok()).collect()
}

/// How far a thread that [gives way](give_way) does: of a core that both want it gets a quarter.
#[cfg(target_os = "linux")]
const NICE: i32 = 5;

/// From here on this thread works with what others leave of the processor. Elsewhere than on Linux threads cannot be told apart so.
#[cfg(target_os = "linux")]
pub(crate) fn give_way() {
    // Where it is not allowed the work goes on as before.
    let _ = rustix::process::setpriority_process(Some(rustix::thread::gettid()), NICE);
}

#[cfg(not(target_os = "linux"))]
pub(crate) fn give_way() {}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_pools_are_had_than_threads_whose_number_they_share() {
        let of_three = ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        let threads =
            |count| of_three.install(|| pools(count)).iter().map(ThreadPool::current_num_threads).collect::<Vec<_>>();
        assert_eq!([threads(1), threads(2), threads(8)], [vec![3], vec![2, 1], vec![1, 1, 1]]);
    }

    #[test]
    fn the_limit_is_read_where_there_is_one() {
        let text = |limit: &str| format!("Max locked memory 1 1 bytes\nMax address space {limit}  unlimited  bytes\n");
        assert_eq!(address_space(&text("40960000")), Some(40_960_000));
        assert_eq!(address_space(&text("unlimited")), None);
        assert_eq!(address_space(""), None);
    }
}
