//! A comparison as Markdown, CSV or JSON.

use super::Comparison;
use super::claims::Claim;
use super::row::{COLUMNS, Cell, Column, PRINTED, object};
use crate::output;
use crate::report::SCHEMA;
use serde_json::json;

/// The columns of a comparison: the paper's figures only where there are some.
fn columns(comparison: &Comparison) -> Vec<&'static Column> {
    let with_printed = comparison.rows.iter().any(|row| row.printed.is_some());
    COLUMNS.iter().chain(PRINTED.iter().filter(|_| with_printed)).collect()
}

pub(super) fn markdown(comparison: &Comparison) -> String {
    let columns = columns(comparison);
    let mut text = String::new();
    if !comparison.files.is_empty() {
        let head = ["model", "the paper's vertices", "file", "vertices", "remark"];
        let row = |file: &super::StandIn| {
            [
                file.model,
                file.paper_vertices,
                &file.file,
                &file.vertices.map_or_else(String::new, |n| n.to_string()),
                &file.remark,
            ]
            .map(str::to_owned)
            .to_vec()
        };
        text += &table(&head, comparison.files.iter().map(row));
        text += "\n";
    }
    let heads: Vec<&str> = columns.iter().map(|column| column.head).collect();
    text += &table(&heads, comparison.rows.iter().map(|row| columns.iter().map(|c| (c.value)(row).text()).collect()));
    text += &format!("\n{}", legend(comparison));
    if !comparison.claims.is_empty() {
        text += "\nThe paper's claims, on these files and on this machine:\n\n";
        comparison.claims.iter().for_each(|claim| text += &verdict(claim));
    }
    text
}

fn verdict(claim: &Claim) -> String {
    let verdict = if claim.holds { "holds" } else { "does not hold" };
    format!("- {}: **{verdict}**; {}.\n", claim.claim, claim.measured)
}

fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head: Vec<String> = head.iter().map(|&cell| cell.to_owned()).collect();
    let escaped = |row: Vec<String>| row.iter().map(|cell| cell.replace('|', "\\|")).collect::<Vec<_>>();
    let body: String = rows.map(|row| line(&escaped(row))).collect();
    format!("{}|{}\n{body}", line(&escaped(head.clone())), "---|".repeat(head.len()))
}

/// What the columns mean, a line each.
pub(super) fn legend(comparison: &Comparison) -> String {
    let line = |column: &&Column| format!("- {}: {}\n", column.head, column.meaning);
    let lines: String = columns(comparison).iter().map(line).collect();
    format!(
        "{lines}- maps: seams rigid, as cones unwrap has them with --free-seams never\n\
         - times: one thread, the least of {} rounds, each of which runs every method once\n",
        comparison.rounds
    )
}

/// The rows alone, numbers with all their digits.
pub(super) fn csv(comparison: &Comparison) -> String {
    let columns = columns(comparison);
    let exact = |cell: Cell| match cell.json() {
        serde_json::Value::Null => String::new(),
        serde_json::Value::String(text) => text,
        number => number.to_string(),
    };
    let row = |row| columns.iter().map(|column| exact((column.value)(row))).collect();
    let head = columns.iter().map(|column| column.key.to_owned()).collect();
    output::csv(&std::iter::once(head).chain(comparison.rows.iter().map(row)).collect::<Vec<_>>())
}

pub(super) fn json(comparison: &Comparison) -> serde_json::Value {
    let columns = columns(comparison);
    let legend = columns.iter().map(|c| (c.key.to_owned(), json!(c.meaning))).collect::<serde_json::Map<_, _>>();
    json!({
        "schema": SCHEMA,
        "rounds": comparison.rounds,
        "legend": legend,
        "rows": comparison.rows.iter().map(|row| object(&columns, row)).collect::<Vec<_>>(),
        "files": comparison.files,
        "claims": comparison.claims,
    })
}
