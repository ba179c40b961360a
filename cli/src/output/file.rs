//! Files that are there whole or not at all.
//!
//! A file is written under a short random name in the same folder, which is renamed when it is complete. When anything fails
//! that file is removed, and what was there before is still there. What is replaced hands on its mode and, where the system
//! allows it, its owner; a link is followed and stays. A file that is protected from writing is not replaced. This guards
//! against failures of the program and a full disk, not against loss of power.
//!
//! Devices, pipes and standard output (also as `-`), which cannot be replaced, are written directly. What ends in `.gz` is compressed.

use crate::error::CommandError;
use geom::io::{WriteError, gzip};
use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use tempfile::{Builder, NamedTempFile};

const BUFFER: usize = 1 << 16;

/// The most links from one name to the next; the system itself follows no more.
const LINKS: usize = 40;

/// Whether a file was written to standard output.
static IS_STANDARD_OUTPUT_TAKEN: AtomicBool = AtomicBool::new(false);

pub(super) fn is_standard_output_taken() -> bool {
    IS_STANDARD_OUTPUT_TAKEN.load(Ordering::Relaxed)
}

/// Writes a file.
pub(super) fn write(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), CommandError> {
    let content = |out: &mut dyn Write| match path.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("gz") => gzip(out, content),
        _ => content(out),
    };
    let failed = |source| CommandError::WriteFile { path: path.to_owned(), source };
    let told = |error| match error {
        WriteError::Io(source) => failed(source),
        error => error.into(),
    };
    match Way::to(path).map_err(failed)? {
        Way::StandardOutput => {
            IS_STANDARD_OUTPUT_TAKEN.store(true, Ordering::Relaxed);
            fill(io::stdout().lock(), content).map_err(|error| match error {
                WriteError::Io(source) => CommandError::Stdout(source),
                error => error.into(),
            })
        }
        Way::Directly => {
            let file = File::options().write(true).open(path).map_err(failed)?;
            fill(file, content).map_err(told)
        }
        Way::Replacing { target, before } => {
            let temporary = beside(&target).map_err(failed)?;
            fill(temporary.as_file(), content).map_err(told)?;
            hand_on(before.as_ref(), temporary.as_file()).map_err(failed)?;
            temporary.persist(target).map_err(|error| failed(error.error))?;
            Ok(())
        }
    }
}

/// Makes sure that [`write`] can begin: the same file is opened, and removed again. A device or a pipe is not touched.
pub(super) fn check(path: &Path) -> Result<(), CommandError> {
    let begin = || match Way::to(path)? {
        Way::Replacing { target, .. } => beside(&target).map(drop),
        Way::Directly | Way::StandardOutput => Ok(()),
    };
    begin().map_err(|source| CommandError::WriteFile { path: path.to_owned(), source })
}

/// Whether a path is that of a device, a pipe or standard output.
pub(super) fn is_written_directly(path: &Path) -> bool {
    matches!(Way::to(path), Ok(Way::Directly | Way::StandardOutput))
}

/// How a path is written.
enum Way {
    StandardOutput,
    /// It is a device or a pipe.
    Directly,
    /// This file is made, or replaced: the target of a link, not the link.
    Replacing {
        target: PathBuf,
        before: Option<Metadata>,
    },
}

impl Way {
    fn to(path: &Path) -> io::Result<Self> {
        // Opened by this name, a file that standard output was sent to would be written from its beginning.
        if path == Path::new(super::STANDARD) {
            return Ok(Self::StandardOutput);
        }
        if cfg!(unix) && ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].iter().any(|name| path == Path::new(name)) {
            return Ok(Self::StandardOutput);
        }
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
            Ok(found) if !found.is_file() => Ok(Self::Directly),
            Ok(found) if found.permissions().readonly() => Err(io::ErrorKind::PermissionDenied.into()),
            Ok(found) => Ok(Self::Replacing { target: fs::canonicalize(path)?, before: Some(found) }),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                Ok(Self::Replacing { target: end_of_links(path), before: None })
            }
            Err(error) => Err(error),
        }
    }
}

/// Where a link leads that leads to no file yet; the path itself where it is no link.
fn end_of_links(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    for _ in 0..LINKS {
        let Ok(next) = fs::read_link(&path) else { break };
        path = path.parent().unwrap_or(Path::new("")).join(next);
    }
    path
}

/// A file with a name of its own in the folder of another, hidden where dots hide, with the mode of any new file.
fn beside(path: &Path) -> io::Result<NamedTempFile> {
    let folder = super::folder_of(path);
    let mut builder = Builder::new();
    builder.prefix(".cones-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder).map_err(|error| error.kind().into())
}

/// Gives a file the mode and the owner of the one that it replaces.
fn hand_on(before: Option<&Metadata>, file: &File) -> io::Result<()> {
    let Some(before) = before else { return Ok(()) };
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        // Only an administrator may give files away; what anyone else replaces becomes theirs.
        let _ = fchown(file, Some(before.uid()), Some(before.gid()));
    }
    file.set_permissions(before.permissions())
}

fn fill(file: impl Write, content: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>) -> Result<(), WriteError> {
    let mut out = BufWriter::with_capacity(BUFFER, file);
    content(&mut out)?;
    out.flush()?;
    Ok(())
}
