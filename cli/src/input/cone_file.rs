//! Files of cones: a line `vertex curvature` each, vertices counted from 0, `#` begins a comment.
//!
//! The curvature, in radians, may be missing: then it is chosen by `--angles`. What the command writes says besides, in comments that begin with `#:`, what was
//! done to the surface before it was flattened with these cones ([`Recipe`]); other programs may pass over it.

use super::error::unreadable;
use cones::{ConeChoice, GivenCone, Recipe};
use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use thiserror::Error;

/// Why a file of cones cannot be used.
#[derive(Debug, Error)]
pub(crate) enum ConeFileError {
    #[error("{}: {}", path.display(), unreadable(error))]
    Io { path: PathBuf, error: io::Error },
    #[error("{}, line {line}: {text:?} is not a cone: write a vertex's index from 0, then its curvature or nothing", path.display())]
    NotACone { path: PathBuf, line: usize, text: String },
    #[error("{}, line {line}: {text:?} is nothing that can be said of a surface: take it out, or write a comment with # alone", path.display())]
    NotSaid { path: PathBuf, line: usize, text: String },
    #[error("{} lists no cone: write lines of a vertex's index from 0 and its curvature", .0.display())]
    Empty(PathBuf),
    #[error("{}{}: {error}", path.display(), line.map_or_else(String::new, |line| format!(", line {line}")))]
    Refused { path: PathBuf, line: Option<usize>, error: cones::Error },
}

/// The cones of a file, each with its line, counted from 1.
#[derive(Debug)]
pub(crate) struct ConeFile {
    path: PathBuf,
    recipe: Recipe,
    lines: Vec<usize>,
}

impl ConeFile {
    pub(crate) fn read(path: &Path) -> Result<Self, ConeFileError> {
        let path = path.to_owned();
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) => return Err(ConeFileError::Io { path, error }),
        };
        match parse(&String::from_utf8_lossy(&bytes)) {
            Err(Wrong { line, text, is_said: false }) => Err(ConeFileError::NotACone { path, line, text }),
            Err(Wrong { line, text, .. }) => Err(ConeFileError::NotSaid { path, line, text }),
            // A map may have none; but a file without a word is a mistake.
            Ok((recipe, _)) if recipe == Recipe::default() => Err(ConeFileError::Empty(path)),
            Ok((recipe, lines)) => Ok(Self { path, recipe, lines }),
        }
    }

    pub(crate) fn recipe(&self) -> Recipe {
        self.recipe.clone()
    }

    /// The complaint about a cone, with the line that has it, or about all; the error itself if it is about none of them.
    pub(crate) fn place(&self, error: cones::Error) -> Result<ConeFileError, cones::Error> {
        let cones = &self.recipe.cones;
        let of = |vertex: u32| cones.iter().position(|cone| cone.vertex == vertex);
        let cone = match &error {
            cones::Error::NoSuchCone { vertex, .. }
            | cones::Error::ConeOnBoundary(vertex)
            | cones::Error::ConeAtHole(vertex) => of(*vertex),
            cones::Error::NotAtFace { vertex, face } => {
                cones.iter().position(|cone| (cone.vertex, cone.face) == (*vertex, Some(*face)))
            }
            // The last of those that are one.
            cones::Error::RepeatedCone(vertex) => cones.iter().rposition(|cone| cone.vertex == *vertex),
            cones::Error::CurvatureTooLarge(curvature) => {
                cones.iter().position(|cone| cone.curvature == Some(*curvature))
            }
            cones::Error::SomeCurvatures { .. } => cones.iter().position(|cone| cone.curvature.is_none()),
            cones::Error::CurvatureSum { .. }
            | cones::Error::OtherModel { .. }
            | cones::Error::OtherSeams
            | cones::Error::ConesForHoles
            | cones::Error::NotFilled(_)
            | cones::Error::NoNecks => None,
            _ => return Err(error),
        };
        let line = cone.map(|cone| self.lines[cone]);
        Ok(ConeFileError::Refused { path: self.path.clone(), line, error })
    }
}

/// What a file says that is no file here; otherwise the line that is wrong.
pub(crate) fn recipe(text: &str) -> Result<Recipe, String> {
    let wrong = |Wrong { line, text, .. }: Wrong| format!("line {line}: {text:?} says nothing of cones");
    parse(text).map(|(recipe, _)| recipe).map_err(wrong)
}

/// The first line that is wrong, and whether it says something of the surface.
#[derive(Debug, PartialEq)]
struct Wrong {
    line: usize,
    text: String,
    is_said: bool,
}

/// What a file says, and the line of each cone.
fn parse(text: &str) -> Result<(Recipe, Vec<usize>), Wrong> {
    let (mut recipe, mut lines) = (Recipe::default(), Vec::new());
    for (i, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let wrong = |is_said| Wrong { line: i + 1, text: line.trim().chars().take(80).collect(), is_said };
        let (told, comment) = line.split_once('#').unwrap_or((line, ""));
        let told: Vec<&str> = told.split_whitespace().collect();
        let said: Option<Vec<&str>> = comment.strip_prefix(':').map(|said| said.split_whitespace().collect());
        if told.is_empty() {
            said.map_or(Some(()), |said| say(&said, &mut recipe)).ok_or_else(|| wrong(true))?;
            continue;
        }
        let mut cone = cone(&told).ok_or_else(|| wrong(false))?;
        if let Some(said) = said {
            let ["face", face] = said[..] else { return Err(wrong(true)) };
            cone.face = Some(face.parse().map_err(|_| wrong(true))?);
        }
        recipe.cones.push(cone);
        lines.push(i + 1);
    }
    Ok((recipe, lines))
}

fn cone(words: &[&str]) -> Option<GivenCone> {
    let vertex = words[0].parse().ok()?;
    let curvature = match words[1..] {
        [] => None,
        [curvature] => Some(curvature.parse().ok().filter(|k: &f64| k.is_finite())?),
        _ => return None,
    };
    Some(GivenCone { vertex, curvature, face: None })
}

/// Takes over what is said of the surface; none if that is nothing.
fn say(words: &[&str], recipe: &mut Recipe) -> Option<()> {
    match words {
        ["vertices", count] => recipe.vertices = Some(count.parse().ok()?),
        ["opened", faces @ ..] => recipe.opened.extend(numbers::<u32>(faces)?),
        ["neck", vertices @ ..] if vertices.len() > 1 => recipe.necks.push(numbers(vertices)?),
        ["welded"] => recipe.welded = true,
        ["filled", size] => {
            recipe.filled = Some(size.parse().ok().filter(|size: &f64| *size >= 0.0 && size.is_finite())?);
        }
        ["charts"] => recipe.charts = true,
        ["straight"] => recipe.straight = true,
        ["freed", faces @ ..] => recipe.freed.extend(numbers::<u32>(faces)?),
        ["target", target] => recipe.target = Some(target.parse().ok().filter(|target: &f64| *target >= 1.0)?),
        ["refined-from", vertices] => recipe.refined_from = Some(vertices.parse().ok()?),
        ["refined-for", choice @ ..] => recipe.refined_for = Some(Box::new(chosen(choice)?)),
        _ => return None,
    }
    Some(())
}

/// What cones were asked for, in words.
fn chosen(words: &[&str]) -> Option<ConeChoice> {
    Some(match words {
        ["automatic"] => ConeChoice::Automatic,
        ["number", count] => ConeChoice::Count(count.parse().ok()?),
        ["distortion", target] => ConeChoice::WithinDistortion(target.parse().ok()?),
        ["persistence", threshold] => ConeChoice::MinPersistence(threshold.parse().ok()?),
        _ => return None,
    })
}

/// The words for it; none for what no option asks for.
fn words(choice: &ConeChoice) -> Option<String> {
    match choice {
        ConeChoice::Automatic => Some("automatic".to_owned()),
        ConeChoice::Count(count) => Some(format!("number {count}")),
        ConeChoice::WithinDistortion(target) => Some(format!("distortion {target}")),
        ConeChoice::MinPersistence(threshold) => Some(format!("persistence {threshold}")),
        _ => None,
    }
}

fn numbers<T: FromStr>(words: &[&str]) -> Option<Vec<T>> {
    words.iter().map(|word| word.parse().ok()).collect()
}

/// The text of a file of these cones; every curvature reads back to the same number.
pub(crate) fn text(recipe: &Recipe) -> String {
    let mut text =
        String::from("# vertex (from 0), curvature (radians); lines with #: say what was done to the surface\n");
    let mut say = |words: &str, numbers: &[u32]| {
        if !numbers.is_empty() {
            let numbers: Vec<String> = numbers.iter().map(u32::to_string).collect();
            let _ = writeln!(text, "#: {words} {}", numbers.join(" "));
        }
    };
    say("opened", &recipe.opened);
    recipe.necks.iter().for_each(|neck| say("neck", neck));
    say("freed", &recipe.freed);
    let words_alone = [("welded", recipe.welded), ("charts", recipe.charts), ("straight", recipe.straight)];
    for (word, _) in words_alone.iter().filter(|(_, is_so)| *is_so) {
        let _ = writeln!(text, "#: {word}");
    }
    if let Some(size) = recipe.filled {
        let _ = writeln!(text, "#: filled {size}");
    }
    if let Some(target) = recipe.target {
        let _ = writeln!(text, "#: target {target}");
    }
    if let Some(choice) = recipe.refined_for.as_deref().and_then(words) {
        let _ = writeln!(text, "#: refined-for {choice}");
    }
    if let Some(vertices) = recipe.refined_from {
        let _ = writeln!(text, "#: refined-from {vertices}");
    }
    if let Some(vertices) = recipe.vertices {
        let _ = writeln!(text, "#: vertices {vertices}");
    }
    for GivenCone { vertex, curvature, face } in &recipe.cones {
        let _ = write!(text, "{vertex}");
        let _ = curvature.map_or(Ok(()), |curvature| write!(text, " {curvature}"));
        let _ = face.map_or(Ok(()), |face| write!(text, " #: face {face}"));
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_blank_lines_and_missing_curvatures_are_fine() {
        let (recipe, lines) = parse("\u{feff}# cones\r\n\r\n 3\t1.5 # first\r\n7\n").unwrap();
        let cone = |vertex, curvature| GivenCone { vertex, curvature, face: None };
        assert_eq!((recipe.cones, lines), (vec![cone(3, Some(1.5)), cone(7, None)], vec![3, 4]));
    }

    #[test]
    fn a_wrong_line_is_named() {
        let said = ["#: opend 3", "#: neck 4", "#: opened x", "1 2 #: side 3", "1 2 #: face -1", "#: target nan"];
        let cones = ["x 1", "1 2 3", "-4 1", "1 nan", "5000000000"];
        for (wrong, is_said) in cones.map(|wrong| (wrong, false)).into_iter().chain(said.map(|wrong| (wrong, true))) {
            let expected = Wrong { line: 2, text: wrong.to_owned(), is_said };
            assert_eq!(parse(&format!("1 2\n{wrong}\n")), Err(expected));
        }
    }

    #[test]
    fn what_is_written_is_read_as_it_was() {
        let recipe = Recipe {
            cones: vec![
                GivenCone { vertex: 3, curvature: Some(0.1 + 0.2), face: Some(8) },
                GivenCone { vertex: 3, curvature: Some(-1e-300), face: None },
            ],
            vertices: Some(12),
            opened: vec![4, 5],
            necks: vec![vec![1, 2, 3, 1], vec![7, 8]],
            welded: true,
            filled: Some(0.3),
            charts: true,
            straight: true,
            freed: vec![6],
            target: Some(1.1),
            refined_for: Some(Box::new(ConeChoice::Count(7))),
            refined_from: Some(11),
        };
        assert_eq!(parse(&text(&recipe)).unwrap(), (recipe, vec![14, 15]));
        let none = Recipe { vertices: Some(4), ..Recipe::default() };
        assert_eq!(parse(&text(&none)).unwrap(), (none, vec![]));
    }
}
