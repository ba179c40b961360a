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
    let named = |source| WriteError::File { path: path.to_owned(), source };
    let result = match fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(io::Error::from(io::ErrorKind::IsADirectory).into()),
        Ok(found) if !found.is_file() => {
            File::options().write(true).open(path).map_err(WriteError::from).and_then(|file| fill(file, write))
        }
        Ok(found) if found.permissions().readonly() => Err(io::Error::from(io::ErrorKind::PermissionDenied).into()),
        // The target of a link is replaced, not the link.
        Ok(_) => fs::canonicalize(path).map_err(WriteError::from).and_then(|path| replace(&path, write)),
        Err(_) => replace(path, write),
    };
    result.map_err(|error| match error {
        WriteError::Io(source) => named(source),
        other => other,
    })
}

fn replace(path: &Path, write: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>) -> Result<(), WriteError> {
    let temporary = Temporary::beside(path)?;
    let file = File::options().write(true).create_new(true).open(&temporary.path)?;
    fill(file, write)?;
    fs::rename(&temporary.path, path)?;
    Ok(())
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
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // After the rename there is nothing left to remove, and before it a failure has its own message.
        let _ = fs::remove_file(&self.path);
    }
}
