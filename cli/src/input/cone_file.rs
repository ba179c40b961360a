//! Files of cones: a line `vertex curvature` each, vertices counted from 0, `#` begins a comment.
//!
//! The curvature, in radians, may be missing: then it is chosen by `--angles`.

use super::error::unreadable;
use cones::Cone;
use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a file of cones cannot be used.
#[derive(Debug, Error)]
pub(crate) enum ConeFileError {
    #[error("{}: {}", path.display(), unreadable(error))]
    Io { path: PathBuf, error: io::Error },
    #[error("{}, line {line}: {text:?} is not a cone: write a vertex's index from 0, then its curvature or nothing", path.display())]
    NotACone { path: PathBuf, line: usize, text: String },
    #[error("{} lists no cone: write lines of a vertex's index from 0 and its curvature", .0.display())]
    Empty(PathBuf),
}

/// A vertex and, where it is given, its curvature.
type Given = (u32, Option<f64>);

/// Reads the cones of a file.
pub(crate) fn read(path: &Path) -> Result<Vec<Given>, ConeFileError> {
    let bytes = std::fs::read(path).map_err(|error| ConeFileError::Io { path: path.to_owned(), error })?;
    let cones = parse(&String::from_utf8_lossy(&bytes)).map_err(|(line, text)| ConeFileError::NotACone {
        path: path.to_owned(),
        line,
        text,
    })?;
    if cones.is_empty() { Err(ConeFileError::Empty(path.to_owned())) } else { Ok(cones) }
}

/// The cones, or the number and text of the first line that is none.
fn parse(text: &str) -> Result<Vec<Given>, (usize, String)> {
    let mut cones = Vec::new();
    for (i, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let words: Vec<&str> = line.split('#').next().unwrap_or("").split_whitespace().collect();
        if !words.is_empty() {
            cones.push(cone(&words).ok_or_else(|| (i + 1, line.trim().chars().take(80).collect()))?);
        }
    }
    Ok(cones)
}

fn cone(words: &[&str]) -> Option<Given> {
    let vertex = words[0].parse().ok()?;
    match words[1..] {
        [] => Some((vertex, None)),
        [curvature] => curvature.parse().ok().filter(|k: &f64| k.is_finite()).map(|k| (vertex, Some(k))),
        _ => None,
    }
}

/// The text of a file of these cones; every curvature reads back to the same number.
pub(crate) fn text(cones: &[Cone]) -> String {
    let mut text = String::from("# vertex (from 0), curvature (radians)\n");
    for cone in cones {
        let _ = writeln!(text, "{} {}", cone.vertex, cone.curvature);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_blank_lines_and_missing_curvatures_are_fine() {
        let cones = parse("\u{feff}# cones\r\n\r\n 3\t1.5 # first\r\n7\n").unwrap();
        assert_eq!(cones, [(3, Some(1.5)), (7, None)]);
    }

    #[test]
    fn a_wrong_line_is_named() {
        for wrong in ["x 1", "1 2 3", "-4 1", "1 nan", "5000000000"] {
            assert_eq!(parse(&format!("1 2\n{wrong}\n")), Err((2, wrong.to_owned())));
        }
    }
}
