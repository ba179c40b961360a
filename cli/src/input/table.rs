//! Tables of numbers in text: a column is a series, several columns are a matrix, as spreadsheets and `numpy.savetxt` write them.
//!
//! Numbers are set apart by commas, semicolons, tabs or spaces; lines may be empty or begin with `#`. All lines have as many
//! numbers as the first. In `.csv` and `.tsv` the first may have names of columns instead, which are passed over.

use super::array::Array;
use super::decimal::Decimals;
use super::error::{FilePosition, Problem, ReadError};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// Reads a table.
pub(super) fn read(path: &Path) -> Result<Array, ReadError> {
    let bytes = std::fs::read(path).map_err(|error| Problem::from(error).in_file(path))?;
    let mut numbers = Decimals::default();
    let (mut rows, mut columns) = (0, 0);
    let mut may_be_heading = path.extension().is_some_and(|ending| !ending.eq_ignore_ascii_case("txt"));
    for (line, text) in (1..).zip(bytes.split(|&byte| byte == b'\n')) {
        let text = String::from_utf8_lossy(text);
        if cells(&text).next().is_some() && std::mem::take(&mut may_be_heading) && is_heading(&text) {
            continue;
        }
        let fault = |problem: Problem| problem.at(FilePosition::Line(line), path);
        let mut count = 0;
        for cell in cells(&text) {
            numbers.push(cell).map_err(fault)?;
            count += 1;
        }
        if count == 0 {
            continue;
        }
        columns = if rows == 0 { count } else { columns };
        if count != columns {
            return Err(fault(Problem::unexpected(format!("a line of {count} numbers"), format!("one of {columns}"))));
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
    let Ok(file) = File::open(path) else { return false };
    let mut lines = BufReader::new(file).lines().map_while(Result::ok);
    let first = lines.find(|line| cells(line).next().is_some());
    first.is_some_and(|line| cells(&line).any(|cell| cell.trim_matches('"') == "id"))
}

/// Whether a line names columns: none of its words is a number.
fn is_heading(line: &str) -> bool {
    cells(line).all(|cell| cell.parse::<f64>().is_err())
}

/// The words of a line. Between commas, semicolons or tabs there is one each, which may be empty.
fn cells(line: &str) -> impl Iterator<Item = &str> {
    let line = line.trim_start_matches('\u{feff}').trim();
    let line = if line.starts_with('#') { "" } else { line };
    let separator = [';', ',', '\t'].into_iter().find(|&separator| line.contains(separator));
    let apart = separator.into_iter().flat_map(move |separator| line.split(separator).map(str::trim));
    let spaced = separator.is_none().then(|| line.split_whitespace()).into_iter().flatten();
    apart.chain(spaced)
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
        assert_eq!(cells("# 1, 2").count() + cells("").count(), 0);
    }
}
