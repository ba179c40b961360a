//! What was repaired and decided, on stderr.

use crate::output::{self, Volume};
use crate::report::repair_text;
use cones::Note;
use geom::Repair;
use std::mem::discriminant;

/// So many lines are said of a surface, unless all of them are asked for; all are in the report.
const MOST: usize = 5;

/// Says what the library repaired and had to decide.
pub(crate) fn warn(repairs: &[Repair], notes: &[Note], components: usize) {
    said(repairs, notes, Vec::new(), components).iter().for_each(|line| output::warn(line));
}

/// What is said of that and of what is wrong with a map, a line each.
pub(crate) fn said(repairs: &[Repair], notes: &[Note], flaws: Vec<String>, components: usize) -> Vec<String> {
    let said = [repairs.iter().map(repair_text).collect(), lines(notes, components), flaws];
    if output::volume() == Volume::Verbose { said.concat() } else { shortened(said) }
}

/// At most so many lines of repairs, notes and flaws: those of the map first, as they are what the user has to deal with.
fn shortened([repairs, notes, flaws]: [Vec<String>; 3]) -> Vec<String> {
    let others = |lines: &[String]| usize::from(!lines.is_empty());
    let flaws = at_most(flaws, MOST - others(&repairs) - others(&notes));
    let notes = at_most(notes, MOST - others(&repairs) - flaws.len());
    let repairs = at_most(repairs, MOST - notes.len() - flaws.len());
    [repairs, notes, flaws].concat()
}

/// The first lines; the last of them says how many are left out.
fn at_most(mut lines: Vec<String>, most: usize) -> Vec<String> {
    let more = lines.len().saturating_sub(most);
    lines.truncate(most);
    if let Some(last) = lines.last_mut().filter(|_| more > 0) {
        last.push_str(&format!(" (and {more} more with --verbose)"));
    }
    lines
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

    #[test]
    fn five_lines_are_said_at_most_and_what_is_left_out_is_counted() {
        let named = |name: &str, count: usize| (1..=count).map(|k| format!("{name} {k}")).collect::<Vec<_>>();
        for counts in
            [[0, 0, 0], [3, 1, 1], [5, 0, 0], [9, 0, 0], [6, 1, 3], [0, 7, 2], [2, 2, 9], [1, 9, 9], [4, 4, 4]]
        {
            let all = [("repair", 0), ("note", 1), ("flaw", 2)].map(|(name, k)| named(name, counts[k]));
            let said = shortened(all);
            let whole: usize = counts.iter().sum();
            assert_eq!(said.len(), whole.min(MOST), "{counts:?}");
            for (name, count) in ["repair", "note", "flaw"].iter().zip(counts) {
                let lines: Vec<&String> = said.iter().filter(|line| line.starts_with(name)).collect();
                let left_out =
                    lines.last().and_then(|line| line.split("(and ").nth(1)?.split(' ').next()?.parse().ok());
                assert_eq!(lines.len() + left_out.unwrap_or(0), count, "{name} of {counts:?}: {said:?}");
            }
        }
    }
}
