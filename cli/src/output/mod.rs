//! What the command writes: files, whole or not at all, and standard output.
//!
//! Every file is written under another name and renamed. An interrupt that comes meanwhile waits for that file, then
//! ends the command with exit code 130; at any other moment it ends it at once.

use crate::failure::Failure;
use crate::render::Picture;
use geom::io::WriteError;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::Duration;

/// Held while a file is being written.
static WRITING: Mutex<()> = Mutex::new(());

/// The exit code after an interrupt, 128 + SIGINT as shells give it.
const INTERRUPTED: i32 = 130;

/// An interrupt waits so many times so long for a file: it may be a pipe that nobody reads.
const PATIENCE: u32 = 100;
const BREATH: Duration = Duration::from_millis(50);

/// From here on an interrupt leaves no half file behind.
pub(crate) fn end_cleanly_on_interrupt() {
    // Without a handler the command still ends, only less tidily: nothing to tell the user.
    let _ = ctrlc::set_handler(|| {
        for _ in 0..PATIENCE {
            match WRITING.try_lock() {
                Err(TryLockError::WouldBlock) => std::thread::sleep(BREATH),
                _idle => std::process::exit(INTERRUPTED),
            }
        }
        std::process::exit(INTERRUPTED);
    });
}

/// Lets an interrupt wait as long as this is held.
fn busy() -> MutexGuard<'static, ()> {
    WRITING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes a file, whole or not at all.
pub(crate) fn write(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), Failure> {
    let _busy = busy();
    Ok(geom::io::write_atomically(path, content)?)
}

/// Writes a text file.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    write(path, |out| Ok(out.write_all(text.as_bytes())?))
}

/// Writes a picture.
pub(crate) fn write_png(path: &Path, picture: &Picture) -> Result<(), Failure> {
    write(path, |out| Ok(picture.write_png(out)?))
}

/// Writes text to standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(Failure::Stdout)
}

/// Writes a value to standard output as JSON.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    print(&json(value))
}

/// A value as JSON that people can read, too.
pub(crate) fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string_pretty(value).expect("reports have string keys and no failing parts") + "\n"
}

/// A message for the user that is no part of the result.
pub(crate) fn warn(message: &str) {
    let _ = writeln!(io::stderr(), "warning: {message}");
}

/// Text for the user that is no part of the result.
pub(crate) fn note(text: &str) {
    let _ = write!(io::stderr(), "{text}");
}

/// Makes sure, before anything is computed, that the outputs can be written: into folders that are there and let files be
/// made in them, each to a file of its own that is none of the inputs, by whatever name.
pub(crate) fn check(inputs: &[&Path], outputs: &[&Path]) -> Result<(), Failure> {
    for (i, &path) in outputs.iter().enumerate() {
        if path.is_dir() {
            return Err(Failure::OutputIsFolder(path.to_owned()));
        }
        let folder = folder_of(path);
        if !folder.is_dir() {
            return Err(Failure::NoFolder { folder: folder.to_owned(), path: path.to_owned() });
        }
        if inputs.iter().any(|&input| same_file(input, path)) {
            return Err(Failure::OutputIsInput(path.to_owned()));
        }
        if outputs[..i].iter().any(|&other| same_file(other, path)) {
            return Err(Failure::OutputTwice(path.to_owned()));
        }
    }
    let _busy = busy();
    Ok(outputs.iter().try_for_each(geom::io::check_writable)?)
}

/// The ending of a file's name in lower case, if it is one of those wanted.
pub(crate) fn extension(path: &Path, wanted: &[&'static str]) -> Result<&'static str, Failure> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_lowercase();
    wanted
        .iter()
        .find(|&&w| w == ending)
        .copied()
        .ok_or_else(|| Failure::Extension { path: path.to_owned(), wanted: alternatives(wanted) })
}

/// `.a, .b or .c`
fn alternatives(endings: &[&str]) -> String {
    let endings: Vec<String> = endings.iter().map(|ending| format!(".{ending}")).collect();
    match endings.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        _ => endings.concat(),
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    }
}

/// Whether two names mean one file: through links of either kind, or because both will be made.
fn same_file(a: &Path, b: &Path) -> bool {
    fn resolved(path: &Path) -> Option<PathBuf> {
        path.canonicalize().ok().or_else(|| Some(folder_of(path).canonicalize().ok()?.join(path.file_name()?)))
    }
    resolved(a).is_some_and(|a| resolved(b).is_some_and(|b| a == b)) || hard_linked(a, b)
}

#[cfg(unix)]
fn hard_linked(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let inode = |path: &Path| path.metadata().ok().map(|m| (m.dev(), m.ino()));
    inode(a).is_some_and(|a| inode(b) == Some(a))
}

#[cfg(not(unix))]
fn hard_linked(_: &Path, _: &Path) -> bool {
    false
}
