//! A comparison for terminals: a table for each mesh and number of cones with the columns that matter most.

use super::Comparison;
use super::row::{COLUMNS, Outcome, Row};
use crate::input::significant;
use crate::report::table::{columns, counted, wrapped};

/// Heads short enough for 80 columns, and the keys of the columns that say what they mean.
const HEADS: [(&str, &str); 7] = [
    ("method", "method"),
    ("cones", "cones"),
    ("qc", "quasi_conformal"),
    ("D", "area_mean"),
    ("flips", "flipped"),
    ("find s", "detection_seconds"),
    ("flat s", "flattening_seconds"),
];

pub(super) fn text(comparison: &Comparison) -> String {
    let mut text = String::new();
    for file in &comparison.files {
        let what = if file.vertices.is_some() { &*file.file } else { "–" };
        text += &wrapped(&format!("{}: {what}; {}", file.model, file.remark), 2);
    }
    if !comparison.files.is_empty() {
        text.push('\n');
    }
    for rows in comparison.rows.chunk_by(|a, b| (&a.mesh, a.asked) == (&b.mesh, b.asked)) {
        text += &group(rows);
    }
    for (head, key) in HEADS {
        let meaning = COLUMNS.iter().find(|column| column.key == key).map_or("", |column| column.meaning);
        text += &wrapped(&format!("{head}: {meaning}"), 2);
    }
    let rounds = if comparison.rounds == 1 { "one round".to_owned() } else { format!("{} rounds", comparison.rounds) };
    text += &wrapped(&format!("Times are the least of {rounds}; --format md has all columns."), 2);
    for claim in &comparison.claims {
        let verdict = if claim.holds { "holds" } else { "does not hold" };
        text += &format!("\n{}", wrapped(&format!("The paper: {}. It {verdict}: {}.", claim.claim, claim.measured), 2));
    }
    text
}

/// The methods on one mesh with one number of cones.
fn group(rows: &[Row]) -> String {
    let Row { mesh, vertices, asked, floor, .. } = &rows[0];
    let floor = significant(*floor, 3);
    let heading = format!(
        "{mesh}: {}, {} asked for, one factorization takes {floor} s",
        counted(*vertices, "vertex", "vertices"),
        counted(*asked, "cone", "cones")
    );
    let head = HEADS.map(|(head, _)| head.to_owned()).to_vec();
    let table: Vec<Vec<String>> = std::iter::once(head).chain(rows.iter().map(cells)).collect();
    let notes: String =
        rows.iter().filter_map(|row| Some(wrapped(&format!("{}: {}", row.variant.name(), note(row)?), 2))).collect();
    format!("{}\n{}{notes}\n", wrapped(&heading, 2), columns(&table))
}

fn cells(row: &Row) -> Vec<String> {
    let mut cells = vec![row.variant.name()];
    match &row.result {
        Ok(Outcome { cones, quasi_conformal, area, flipped, seconds, .. }) => cells.extend([
            cones.to_string(),
            short(*quasi_conformal),
            short(*area),
            flipped.to_string(),
            short(seconds.detection),
            short(seconds.flattening),
        ]),
        Err(_) => cells.extend(["–"; 6].map(str::to_owned)),
    }
    cells
}

/// A number in six letters.
fn short(x: f64) -> String {
    if x < 9.9999 { format!("{x:.4}") } else { significant(x, if x < 9999.0 { 5 } else { 2 }) }
}

fn note(row: &Row) -> Option<String> {
    match &row.result {
        Err(reason) => Some(format!("failed: {reason}")),
        Ok(outcome) => (!outcome.note.is_empty()).then(|| outcome.note.clone()),
    }
}
