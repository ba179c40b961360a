//! What the command writes: files, all and whole or none, and standard output.

mod file;
mod signal;

pub(crate) use file::Files;
pub(crate) use signal::end_cleanly_on_signals;

use crate::error::CommandError;
use anstyle::{AnsiColor, Style};
use geom::io::MeshFormat;
use std::error::Error;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// What stands for standard output, or standard input, in place of a file.
pub(crate) const STANDARD: &str = "-";

/// The style that clap gives its errors.
const ERROR: Style = AnsiColor::Red.on_default().bold();
const WARNING: Style = AnsiColor::Yellow.on_default().bold();

/// How much is said.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Volume {
    /// Results and errors.
    Quiet,
    /// Warnings, progress and a summary as well.
    #[default]
    Normal,
    /// Each stage as well.
    Verbose,
}

/// Set once, from the arguments.
static VOLUME: OnceLock<Volume> = OnceLock::new();

/// Sets how much is said; without it it is [`Volume::Normal`].
pub(crate) fn speak(volume: Volume) {
    // It is set once, at the beginning.
    let _ = VOLUME.set(volume);
}

pub(crate) fn volume() -> Volume {
    VOLUME.get().copied().unwrap_or_default()
}

/// Writes a result to standard output.
pub(crate) fn print(text: &str) -> Result<(), CommandError> {
    print_bytes(text.as_bytes())
}

/// Writes a result to standard output.
pub(crate) fn print_bytes(bytes: &[u8]) -> Result<(), CommandError> {
    let mut out = io::stdout().lock();
    out.write_all(bytes).and_then(|()| out.flush()).map_err(CommandError::Stdout)
}

/// Writes a value to standard output as JSON.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), CommandError> {
    print(&json(value))
}

/// Says what was done where the results are files: on standard output, or on standard error where one of the files is
/// standard output.
pub(crate) fn summary(text: &str) -> Result<(), CommandError> {
    match volume() {
        Volume::Quiet => Ok(()),
        _ if file::is_standard_output_taken() => {
            note(text);
            Ok(())
        }
        _ => print(text),
    }
}

/// Writes a result for people to standard output; where one of the files is standard output it becomes a [`summary`].
pub(crate) fn print_table(text: &str) -> Result<(), CommandError> {
    if file::is_standard_output_taken() { summary(text) } else { print(text) }
}

/// A value as JSON that people can read, too.
pub(crate) fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string_pretty(value).expect("reports have string keys and no failing parts") + "\n"
}

/// Writes a value to standard output as a line of JSON.
pub(crate) fn print_json_line(value: &impl serde::Serialize) -> Result<(), CommandError> {
    print(&(serde_json::to_string(value).expect("reports have string keys and no failing parts") + "\n"))
}

/// Rows, all of one length, as comma-separated values.
pub(crate) fn csv(rows: &[Vec<String>]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.write_record(row).expect("memory can be written to, and all rows are as long as the first");
    }
    String::from_utf8(writer.into_inner().expect("memory can be written to")).expect("it was text")
}

/// A message for the user that is no part of the result.
pub(crate) fn warn(message: &str) {
    if volume() != Volume::Quiet {
        say("warning", WARNING, message);
    }
}

/// Text for the user that is no part of the result.
pub(crate) fn note(text: &str) {
    let _ = write!(anstream::stderr(), "{text}");
}

/// An error and what lies behind it, a line each.
pub(crate) fn explain(error: &CommandError) {
    say("error", ERROR, &sentences(error).join("\n  because "));
}

/// An error and what lies behind it, in sentences.
pub(crate) fn sentences(error: &CommandError) -> Vec<String> {
    let mut sentences = vec![error.to_string()];
    let mut behind = error.source();
    while let Some(error) = behind {
        sentences.push(error.to_string());
        behind = error.source();
    }
    sentences
}

/// Says something under a coloured word. Where stderr is no terminal, or `NO_COLOR` is set, it is not coloured.
fn say(word: &str, style: Style, message: &str) {
    // There is nobody to tell when stderr is closed, too.
    let _ = writeln!(anstream::stderr(), "{style}{word}:{style:#} {message}");
}

/// Makes sure, before anything is computed, that the outputs can be written: into folders that are there and let files be
/// made in them, each to a file of its own that is none of the inputs, by whatever name.
pub(crate) fn check(inputs: &[&Path], outputs: &[&Path]) -> Result<(), CommandError> {
    for (i, &path) in outputs.iter().enumerate() {
        if path.is_dir() {
            return Err(CommandError::OutputIsFolder(path.to_owned()));
        }
        if file::is_standard_output(path) && outputs[..i].iter().any(|path| file::is_standard_output(path)) {
            return Err(CommandError::OutputTwice(path.to_owned()));
        }
        if file::is_written_directly(path) {
            continue;
        }
        let folder = folder_of(path);
        if !folder.is_dir() {
            return Err(CommandError::NoFolder { folder: folder.to_owned(), path: path.to_owned() });
        }
        if inputs.iter().any(|&input| same_file(input, path)) {
            return Err(CommandError::OutputIsInput(path.to_owned()));
        }
        if outputs[..i].iter().any(|&other| same_file(other, path)) {
            return Err(CommandError::OutputTwice(path.to_owned()));
        }
    }
    let mut files = Files::new();
    outputs.iter().try_for_each(|path| files.check(path))
}

/// Makes sure that no file is to go where JSON goes, which is standard output.
pub(crate) fn check_json(is_json: bool, outputs: &[&Path]) -> Result<(), CommandError> {
    match outputs.iter().find(|path| is_json && file::is_standard_output(path)) {
        Some(&path) => Err(CommandError::OutputTwice(path.to_owned())),
        None => Ok(()),
    }
}

/// The ending of a file's name in lower case, if it is one of those wanted; a device or a pipe needs none and gets the first.
pub(crate) fn extension(path: &Path, wanted: &[&'static str]) -> Result<&'static str, CommandError> {
    if path.extension().is_none() && file::is_written_directly(path) {
        return Ok(wanted[0]);
    }
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_lowercase();
    wanted.iter().find(|&&w| w == ending).copied().ok_or_else(|| no_such_ending(path, alternatives(wanted)))
}

/// The format in which a surface is to be written: by the file's ending, with or without `.gz`, or as it is asked where no ending
/// tells.
pub(crate) fn surface_format(path: &Path, asked: Option<MeshFormat>) -> Result<MeshFormat, CommandError> {
    let is_compressed = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gz"));
    let inner = if is_compressed { path.with_extension("") } else { path.to_owned() };
    let is_open = inner.extension().is_none() && (asked.is_some() || file::is_written_directly(path));
    let wanted: Vec<&str> = match asked {
        _ if is_open => return Ok(asked.unwrap_or(MeshFormat::Obj)),
        Some(format) => vec![format.extension()],
        None => MeshFormat::ALL.map(MeshFormat::extension).to_vec(),
    };
    let ending = inner.extension().and_then(|e| e.to_str()).unwrap_or("").to_lowercase();
    let format = MeshFormat::ALL.into_iter().find(|format| format.extension() == ending);
    format
        .filter(|_| wanted.contains(&&*ending))
        .ok_or_else(|| no_such_ending(path, alternatives(&wanted) + if is_compressed { " before .gz" } else { "" }))
}

/// Why a path whose ending is none of those wanted cannot be written.
fn no_such_ending(path: &Path, wanted: String) -> CommandError {
    let path = path.to_owned();
    if path.is_dir() { CommandError::OutputIsFolder(path) } else { CommandError::Extension { path, wanted } }
}

/// `.a, .b or .c`
fn alternatives(endings: &[&str]) -> String {
    let endings: Vec<String> = endings.iter().map(|ending| format!(".{ending}")).collect();
    match endings.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        _ => endings.concat(),
    }
}

pub(crate) fn folder_of(path: &Path) -> &Path {
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
