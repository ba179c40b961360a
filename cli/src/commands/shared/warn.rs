//! What was repaired and decided, on stderr.

use crate::output;
use crate::report::repair_text;
use cones::Note;
use geom::Repair;
use std::mem::discriminant;

/// So many notes are said; all of them are in the report.
const MOST: usize = 5;

/// Says what the library repaired and had to decide.
pub(crate) fn warn(repairs: &[Repair], notes: &[Note], components: usize) {
    said(repairs, notes, components).iter().for_each(|line| output::warn(line));
}

/// What is said of that, a line each.
pub(crate) fn said(repairs: &[Repair], notes: &[Note], components: usize) -> Vec<String> {
    let mut said: Vec<String> = repairs.iter().map(repair_text).collect();
    let lines = lines(notes, components);
    said.extend(lines.iter().take(MOST).cloned());
    if lines.len() > MOST {
        said.push(format!("and {} things more, which a --report has", lines.len() - MOST));
    }
    said
}

/// A line for each kind of note: the first of them, and on how many other components there is one.
fn lines(notes: &[Note], components: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for (k, note) in notes.iter().enumerate() {
        let is_alike = |other: &&Note| discriminant(*other) == discriminant(note);
        if notes[..k].iter().any(|other| is_alike(&other)) {
            continue;
        }
        let more = notes[k + 1..].iter().filter(is_alike).filter(|other| other.component() != note.component()).count();
        let part = match (note.component(), components) {
            (Some(component), 2..) => format!("part {}: ", component + 1),
            _ => String::new(),
        };
        let others = match more {
            0 => String::new(),
            1 => " (and 1 part more)".to_owned(),
            more => format!(" (and {more} parts more)"),
        };
        lines.push(format!("{part}{note}{others}"));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_holds_for_many_parts_is_said_once() {
        let few = |component| Note::FewVertices { component, asked: 8, there: component };
        let notes: Vec<Note> = (3..16).map(few).collect();
        assert_eq!(
            lines(&notes, 20),
            ["part 4: 8 cones asked for, but there are only 3 inner vertices (and 12 parts more)"]
        );
        assert_eq!(lines(&notes[..1], 1), ["8 cones asked for, but there are only 3 inner vertices"]);
    }
}
