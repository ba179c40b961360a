//! Signals that end the command: an interrupt, and what `kill`, `timeout`, batch systems and closed terminals send.
//!
//! They end it at once, with the exit code that a shell would give, 128 and the signal's number, and without the temporary files
//! that there are.

use super::file;

/// From here on such signals leave no unfinished file behind.
#[cfg(unix)]
pub(crate) fn end_cleanly_on_signals() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    let listen = || {
        // What `nohup` starts outlives its terminal.
        let awaited = [SIGINT, SIGTERM].into_iter().chain(hears_of_closed_terminals().then_some(SIGHUP));
        let Ok(mut signals) = Signals::new(awaited) else { return };
        if let Some(signal) = signals.forever().next() {
            end(128 + signal);
        }
    };
    // Without that thread they end the command as well, only less tidily: nothing to tell the user.
    let _ = std::thread::Builder::new().spawn(listen);
}

/// Whether SIGHUP is known not to be ignored, as Linux tells it by the lowest bit. Where nothing tells it is left as it is.
#[cfg(unix)]
fn hears_of_closed_terminals() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 1 == 0)
}

/// From here on an interrupt, and closing the console, leaves no unfinished file behind.
#[cfg(not(unix))]
pub(crate) fn end_cleanly_on_signals() {
    // Without a handler they end the command as well, only less tidily: nothing to tell the user.
    let _ = ctrlc::set_handler(|| end(130));
}

fn end(code: i32) -> ! {
    let _nothing_is_begun = file::abandon();
    std::process::exit(code)
}
