//! Files of edges: a line of two vertices each, counted from 0, `#` begins a comment.

use super::error::unreadable;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a file of edges cannot be used.
#[derive(Debug, Error)]
pub(crate) enum EdgeFileError {
    #[error("{}: {}", path.display(), unreadable(error))]
    Io { path: PathBuf, error: io::Error },
    #[error("{}, line {line}: {text:?} is not an edge: write the indices of its two vertices, from 0", path.display())]
    NotAnEdge { path: PathBuf, line: usize, text: String },
    #[error("{}, line {line}: {error}", path.display())]
    Refused { path: PathBuf, line: usize, error: cones::Error },
}

/// An edge and its line.
type Placed = ([u32; 2], usize);

/// The edges of a file, each by its vertices and with its line, counted from 1.
#[derive(Debug)]
pub(crate) struct EdgeFile {
    path: PathBuf,
    edges: Vec<Placed>,
}

impl EdgeFile {
    pub(crate) fn read(path: &Path) -> Result<Self, EdgeFileError> {
        let bytes = std::fs::read(path).map_err(|error| EdgeFileError::Io { path: path.to_owned(), error })?;
        match parse(&String::from_utf8_lossy(&bytes)) {
            Ok(edges) => Ok(Self { path: path.to_owned(), edges }),
            Err((line, text)) => Err(EdgeFileError::NotAnEdge { path: path.to_owned(), line, text }),
        }
    }

    pub(crate) fn edges(&self) -> Vec<[u32; 2]> {
        self.edges.iter().map(|&(ends, _)| ends).collect()
    }

    /// The complaint about an edge, with the line that has it; the error itself if it is about none of them.
    pub(crate) fn place(&self, error: cones::Error) -> Result<EdgeFileError, cones::Error> {
        let cones::Error::NoSuchEdge { ends, .. } = &error else { return Err(error) };
        match self.edges.iter().find(|(edge, _)| edge == ends) {
            Some(&(_, line)) => Ok(EdgeFileError::Refused { path: self.path.clone(), line, error }),
            None => Err(error),
        }
    }
}

/// The edges, or the number and text of the first line that is none.
fn parse(text: &str) -> Result<Vec<Placed>, (usize, String)> {
    let mut edges = Vec::new();
    for (i, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let words: Vec<&str> = line.split('#').next().unwrap_or("").split_whitespace().collect();
        let wrong = || (i + 1, line.trim().chars().take(80).collect());
        match words[..] {
            [] => {}
            [a, b] => match [a.parse(), b.parse()] {
                [Ok(a), Ok(b)] if a != b => edges.push(([a, b], i + 1)),
                _ => return Err(wrong()),
            },
            _ => return Err(wrong()),
        }
    }
    Ok(edges)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_blank_lines_are_fine_and_lines_are_counted() {
        let edges = parse("\u{feff}# edges\r\n\r\n 3\t1 # first\r\n7 2\n").unwrap();
        assert_eq!(edges, [([3, 1], 3), ([7, 2], 4)]);
        assert!(parse("").unwrap().is_empty());
    }

    #[test]
    fn a_wrong_line_is_named() {
        for wrong in ["1", "1 2 3", "-4 1", "1 x", "5000000000 1", "4 4"] {
            assert_eq!(parse(&format!("1 2\n{wrong}\n")), Err((2, wrong.to_owned())));
        }
    }
}
