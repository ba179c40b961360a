//! Files that are there whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::error::WriteError;

/// Writes a file under a temporary name in the same folder and renames it when it is complete.
///
/// When anything fails the temporary file is removed and what was at `path` before is still there. A file that is
/// protected from writing is not replaced; a device or a pipe is written directly. This guards against failures of the program and a full disk, not against loss of power.
///
/// ```
/// # let folder = std::env::temp_dir();
/// let path = folder.join("geom-io-atomic.txt");
/// geom::io::write_atomically(&path, |out| Ok(write!(out, "whole")?))?;
/// assert_eq!(std::fs::read_to_string(&path)?, "whole");
/// # std::fs::remove_file(path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// What `write` returns, with the path where it was not known, and what the system says to the file.
pub fn write_atomically(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    put(path, write).map_err(|error| named(path, error))
}

/// Makes sure that [`write_atomically`] can begin: the same file is opened, and removed again. A device or a pipe is not
/// touched.
///
/// ```
/// let error = geom::io::check_writable("no/such/folder/scan.obj").unwrap_err();
/// assert!(error.to_string().contains("no/such/folder/scan.obj"));
/// ```
///
/// # Errors
/// What [`write_atomically`] would return before anything is written.
pub fn check_writable(path: impl AsRef<Path>) -> Result<(), WriteError> {
    let path = path.as_ref();
    let begin = || -> io::Result<()> {
        if let Way::Replacing(path) = Way::to(path)? {
            Temporary::beside(&path)?.create()?;
        }
        Ok(())
    };
    begin().map_err(|error| named(path, error.into()))
}

/// An error with the path where it was not known.
fn named(path: &Path, error: WriteError) -> WriteError {
    match error {
        WriteError::Io(source) => WriteError::File { path: path.to_owned(), source },
        other => other,
    }
}

/// How a path is written.
enum Way {
    /// It is a device or a pipe.
    Directly,
    /// This file is made, or replaced: the target of a link, not the link.
    Replacing(PathBuf),
}

impl Way {
    fn to(path: &Path) -> io::Result<Self> {
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
            Ok(found) if !found.is_file() => Ok(Self::Directly),
            Ok(found) if found.permissions().readonly() => Err(io::ErrorKind::PermissionDenied.into()),
            Ok(_) => Ok(Self::Replacing(fs::canonicalize(path)?)),
            Err(_) => Ok(Self::Replacing(path.to_owned())),
        }
    }
}

fn put(path: &Path, write: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>) -> Result<(), WriteError> {
    match Way::to(path)? {
        Way::Directly => fill(File::options().write(true).open(path)?, write),
        Way::Replacing(path) => {
            let temporary = Temporary::beside(&path)?;
            fill(temporary.create()?, write)?;
            Ok(fs::rename(&temporary.path, path)?)
        }
    }
}

fn fill(file: File, write: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>) -> Result<(), WriteError> {
    let mut out = BufWriter::with_capacity(1 << 16, file);
    write(&mut out)?;
    out.flush()?;
    Ok(())
}

/// Tells apart the temporary files of one process.
static SERIAL: AtomicU64 = AtomicU64::new(0);

/// The name of a file that is removed, if it is still there, when this goes.
struct Temporary {
    path: PathBuf,
}

impl Temporary {
    /// A name that nobody else takes, and that is hidden where dots hide.
    fn beside(path: &Path) -> io::Result<Self> {
        let name = path.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        let serial = SERIAL.fetch_add(1, Ordering::Relaxed);
        hidden.push(format!(".{}-{serial}.part", std::process::id()));
        Ok(Self { path: path.with_file_name(hidden) })
    }

    fn create(&self) -> io::Result<File> {
        File::options().write(true).create_new(true).open(&self.path)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // After the rename there is nothing left to remove, and before it a failure has its own message.
        let _ = fs::remove_file(&self.path);
    }
}
