//! Files that come to be together and whole, or not at all.
//!
//! Each is written under a short random name in its folder; when all are complete they are renamed, one right after another. When
//! anything fails, or a signal ends the command, what was written is removed, and what was there before is still there. What is
//! replaced hands on its mode and, where the system allows it, its owner; a link is followed and stays. A file that is protected
//! from writing is not replaced. This guards against failures of the program and a full disk, not against loss of power nor what ends
//! the program at once: a SIGKILL, or memory that cannot be had. So what takes long is computed before anything is written.
//!
//! Devices, pipes and standard output (also as `-`), which cannot be replaced, are written directly. What ends in `.gz` is compressed.

use crate::error::CommandError;
use crate::render::Picture;
use geom::io::{WriteError, gzip};
use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::{Builder, NamedTempFile, TempPath};

const BUFFER: usize = 1 << 16;

/// The most links from one name to the next; the system itself follows no more.
const LINKS: usize = 40;

/// Whether a file was written to standard output.
static IS_STANDARD_OUTPUT_TAKEN: AtomicBool = AtomicBool::new(false);

pub(super) fn is_standard_output_taken() -> bool {
    IS_STANDARD_OUTPUT_TAKEN.load(Ordering::Relaxed)
}

/// The temporary files of all [`Files`], each until it is renamed or removed.
static UNFINISHED: Mutex<Vec<Option<TempPath>>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<Option<TempPath>>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes what is unfinished. As long as the result is held no file is begun, and none renamed.
pub(super) fn abandon() -> impl Drop {
    let mut unfinished = unfinished();
    unfinished.clear();
    unfinished
}

/// The files that one piece of work results in. They are there once they are [finished](Files::finish); without that there is
/// nothing of them.
#[derive(Debug, Default)]
pub(crate) struct Files {
    written: Vec<Written>,
}

/// A file that waits for its name.
#[derive(Debug)]
struct Written {
    /// As the user named it.
    path: PathBuf,
    target: PathBuf,
    /// The place of its temporary file among the unfinished ones.
    place: usize,
}

impl Files {
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// Writes a file.
    pub(crate) fn write(
        &mut self,
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
                let file = self.begin(path, target).map_err(failed)?;
                fill(&file, content).map_err(told)?;
                hand_on(before.as_ref(), &file).map_err(failed)
            }
        }
    }

    /// Writes a text file.
    pub(crate) fn write_text(&mut self, path: &Path, text: &str) -> Result<(), CommandError> {
        self.write(path, |out| Ok(out.write_all(text.as_bytes())?))
    }

    /// Writes a value as JSON.
    pub(crate) fn write_json(&mut self, path: &Path, value: &impl serde::Serialize) -> Result<(), CommandError> {
        self.write_text(path, &super::json(value))
    }

    /// Writes rows of comma-separated values.
    pub(crate) fn write_csv(&mut self, path: &Path, rows: &[Vec<String>]) -> Result<(), CommandError> {
        self.write_text(path, &super::csv(rows))
    }

    /// Writes a picture.
    pub(crate) fn write_png(&mut self, path: &Path, picture: &Picture) -> Result<(), CommandError> {
        self.write(path, |out| Ok(picture.write_png(out)?))
    }

    /// Makes sure that [`write`](Self::write) can begin. A device or a pipe is not touched.
    pub(super) fn check(&mut self, path: &Path) -> Result<(), CommandError> {
        let begun = match Way::to(path) {
            Ok(Way::Replacing { target, .. }) => self.begin(path, target).map(drop),
            Ok(Way::Directly | Way::StandardOutput) => Ok(()),
            Err(error) => Err(error),
        };
        begun.map_err(|source| CommandError::WriteFile { path: path.to_owned(), source })
    }

    /// Gives all files their names. Nothing should be said of them before.
    pub(crate) fn finish(self) -> Result<(), CommandError> {
        let mut unfinished = unfinished();
        for Written { path, target, place } in &self.written {
            let temporary = unfinished[*place].take().expect("only this or an end of the program takes it");
            temporary
                .persist(target)
                .map_err(|error| CommandError::WriteFile { path: path.clone(), source: error.error })?;
        }
        Ok(())
    }

    /// Opens the temporary file of a target.
    fn begin(&mut self, path: &Path, target: PathBuf) -> io::Result<File> {
        let mut unfinished = unfinished();
        let (file, temporary) = beside(&target)?.into_parts();
        self.written.push(Written { path: path.to_owned(), target, place: unfinished.len() });
        unfinished.push(Some(temporary));
        Ok(file)
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let mut unfinished = unfinished();
        self.written.iter().for_each(|file| drop(unfinished[file.place].take()));
    }
}

/// Whether a path is that of a device, a pipe or standard output.
pub(super) fn is_written_directly(path: &Path) -> bool {
    matches!(Way::to(path), Ok(Way::Directly | Way::StandardOutput))
}

/// Whether it is standard output, by any of its names.
pub(super) fn is_standard_output(path: &Path) -> bool {
    matches!(Way::to(path), Ok(Way::StandardOutput))
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
