//! Tables of numbers in text: a column is a series, several columns are a matrix, as spreadsheets and `numpy.savetxt` write them.
//!
//! Numbers are set apart by commas, semicolons, tabs or spaces, may be quoted, and are NaN where a cell is empty or NA. All lines have as
//! many numbers as the first; some may begin with `#` or be empty, but in a column, or of tabs alone in `.tsv`, none may be empty that has numbers
//! above and below, as it may stand for missing ones. In `.csv` and `.tsv` the first may have names of columns instead, which are passed over.

use super::array::Array;
use super::decimal::{Decimals, is_missing};
use super::ending;
use super::error::{FilePosition, Problem, ReadError};
use geom::counted;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// Reads a table.
pub(super) fn read(path: &Path) -> Result<Array, ReadError> {
    let bytes = std::fs::read(path).map_err(|error| Problem::from(error).in_file(path))?;
    let mut numbers = Decimals::default();
    let (mut rows, mut columns) = (0, 0);
    // The first lines that are empty: one may stand for the number of a column, or, of tabs, for a row.
    let (mut blank, mut blank_row) = (None, None);
    let is_tabbed = ending(path) == "tsv";
    let (mut is_begun, may_have_heading) = (false, may_have_heading(path));
    for (line, text) in (1..).zip(bytes.split(|&byte| byte == b'\n')) {
        let text = String::from_utf8_lossy(text);
        let is_first = cells(&text).next().is_some() && !std::mem::replace(&mut is_begun, true);
        if is_first && may_have_heading && is_heading(&text) {
            continue;
        }
        let fault = |problem: Problem| problem.at(FilePosition::Line(line), path);
        let mut count = 0;
        for cell in cells(&text) {
            numbers.push(cell).map_err(fault)?;
            count += 1;
        }
        if count == 0 {
            let is_blank = is_begun && trimmed(&text).is_empty();
            blank = blank.or(is_blank.then_some(line));
            blank_row = blank_row.or((is_blank && is_tabbed && text.contains('\t')).then_some(line));
            continue;
        }
        columns = if rows == 0 { count } else { columns };
        if count != columns {
            return Err(fault(Problem::unexpected(
                format!("a line of {}", counted(count, "number", "numbers")),
                format!("one of {columns}"),
            )));
        }
        if let Some(blank) = if columns == 1 { blank } else { blank_row } {
            return Err(Problem::BlankLine.at(FilePosition::Line(blank), path));
        }
        rows += 1;
    }
    let values = numbers.into_values();
    if rows == 0 {
        return Err(Problem::Empty.in_file(path));
    }
    Ok(Array { values, shape: if columns == 1 { vec![rows] } else { vec![rows, columns] } })
}

/// Whether the first line of a file that is neither empty nor a comment has the names of a network's columns.
pub(super) fn is_of_nodes(path: &Path) -> bool {
    first_line(path).is_some_and(|line| cells(&line).any(|cell| cell.eq_ignore_ascii_case("id")))
}

/// The line that is passed over as names of columns, if a table has one.
pub(crate) fn heading(path: &Path) -> Option<String> {
    if !may_have_heading(path) {
        return None;
    }
    let line = first_line(path).filter(|line| is_heading(line))?;
    Some(trimmed(&line).to_owned())
}

/// The first line of a file that is neither empty nor a comment.
fn first_line(path: &Path) -> Option<String> {
    let lines = BufReader::new(File::open(path).ok()?).split(b'\n').map_while(Result::ok);
    let mut lines = lines.map(|line| String::from_utf8_lossy(&line).into_owned());
    lines.find(|line| cells(line).next().is_some())
}

/// Whether the first line of such a file may name columns.
fn may_have_heading(path: &Path) -> bool {
    ["csv", "tsv"].contains(&&*ending(path))
}

/// Whether a line names columns: none of its words is a number, and not all say that one is missing.
fn is_heading(line: &str) -> bool {
    cells(line).all(|cell| cell.parse::<f64>().is_err()) && !cells(line).all(is_missing)
}

/// The words of a line, without quotes. Between commas, semicolons or tabs there is one each, which may be empty.
fn cells(line: &str) -> impl Iterator<Item = &str> {
    let line = trimmed(line);
    let line = if line.starts_with('#') { "" } else { line };
    let separator = separator(line);
    let apart = separator.into_iter().flat_map(move |separator| line.split(separator).map(str::trim));
    let spaced = separator.is_none().then(|| line.split_whitespace()).into_iter().flatten();
    apart.chain(spaced).map(unquoted)
}

/// What sets the words of a line apart, if it is no space.
pub(super) fn separator(line: &str) -> Option<char> {
    [';', ',', '\t'].into_iter().find(|&separator| line.contains(separator))
}

/// A line without a mark of byte order, and without space at its ends.
fn trimmed(line: &str) -> &str {
    line.trim_start_matches('\u{feff}').trim()
}

fn unquoted(cell: &str) -> &str {
    cell.strip_prefix('"').and_then(|cell| cell.strip_suffix('"')).map_or(cell, str::trim)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_set_apart_in_whatever_way() {
        for line in ["1, 2,3", "1;2; 3", "1\t2\t3", "  1 2   3 ", "\u{feff}1,2,3"] {
            assert_eq!(cells(line).collect::<Vec<_>>(), ["1", "2", "3"], "{line:?}");
        }
        assert_eq!(cells("1,,3").collect::<Vec<_>>(), ["1", "", "3"]);
        assert_eq!(cells("\"1\";\"\"; \"3 \"").collect::<Vec<_>>(), ["1", "", "3"]);
        assert_eq!(cells("# 1, 2").count() + cells("").count(), 0);
    }

    #[test]
    fn numbers_and_missing_ones_are_no_heading() {
        assert!(["level (m)", "\"x\",\"y\"", ",a,b", "x,NA"].iter().all(|line| is_heading(line)));
        assert!(!["NA", "\"1\",\"2\"", "n/a,null", "a,2"].iter().any(|line| is_heading(line)));
    }
}
