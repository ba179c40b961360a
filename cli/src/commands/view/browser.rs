//! The user's browser.

use std::process::{Command, Stdio};

/// What opens an address, with its arguments before that.
const OPENERS: [&[&str]; 5] = if cfg!(target_os = "windows") {
    [&["rundll32", "url.dll,FileProtocolHandler"], &[], &[], &[], &[]]
} else if cfg!(target_os = "macos") {
    [&["open"], &[], &[], &[], &[]]
} else {
    [&["xdg-open"], &["gio", "open"], &["wslview"], &["x-www-browser"], &[]]
};

/// Opens an address; whether anything could be started for that.
pub(super) fn open(address: &str) -> bool {
    let start = |opener: &&[&str]| {
        let Some((program, arguments)) = opener.split_first() else { return false };
        let mut command = Command::new(program);
        command.args(arguments).arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let Ok(mut child) = command.spawn() else { return false };
        // It is waited for, so that it does not stay behind as a zombie.
        std::thread::spawn(move || child.wait());
        true
    };
    OPENERS.iter().any(start)
}
