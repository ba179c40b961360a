//! Numbers written in decimal: one a line in a text, or a column of a table.

use super::error::{FilePosition, Problem, ReadError};
use super::values::Values;
use std::path::Path;

/// Numbers that stay integers as long as all are.
#[derive(Debug, Default)]
pub(super) struct Decimals {
    integers: Vec<i64>,
    /// In use from the first number on that is no integer.
    floats: Option<Vec<f64>>,
}

impl Decimals {
    /// Adds a number, NaN for what [is missing](is_missing).
    pub(super) fn push(&mut self, text: &str) -> Result<(), Problem> {
        if let (None, Ok(integer)) = (&self.floats, text.parse()) {
            self.integers.push(integer);
            return Ok(());
        }
        let float = match text.parse() {
            Ok(float) => float,
            Err(_) if is_missing(text) => f64::NAN,
            Err(_) => return Err(Problem::unexpected(format!("{text:?}"), "a number")),
        };
        let integers = &mut self.integers;
        self.floats.get_or_insert_with(|| integers.drain(..).map(|x| x as f64).collect()).push(float);
        Ok(())
    }

    pub(super) fn into_values(self) -> Values {
        match self.floats {
            Some(floats) => Values::F64(floats),
            None => Values::I64(self.integers),
        }
    }
}

/// Whether a cell says that there is no number, as spreadsheets, R and pandas write it.
pub(super) fn is_missing(text: &str) -> bool {
    ["", "NA", "N/A", "n/a", "null"].contains(&text)
}

/// Reads a text of one number a line; lines may be empty or begin with `#`.
pub(super) fn read(path: &Path) -> Result<Values, ReadError> {
    let bytes = std::fs::read(path).map_err(|error| Problem::from(error).in_file(path))?;
    let mut numbers = Decimals::default();
    for (line, text) in (1..).zip(bytes.split(|&byte| byte == b'\n')) {
        let text = String::from_utf8_lossy(text);
        let text = text.trim_start_matches('\u{feff}').trim();
        if !text.is_empty() && !text.starts_with('#') {
            numbers.push(text).map_err(|problem| problem.at(FilePosition::Line(line), path))?;
        }
    }
    let values = numbers.into_values();
    if values.len() == 0 { Err(Problem::Empty.in_file(path)) } else { Ok(values) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(texts: &[&str]) -> Values {
        let mut numbers = Decimals::default();
        texts.iter().for_each(|text| numbers.push(text).expect("a number"));
        numbers.into_values()
    }

    #[test]
    fn integers_stay_integers_while_all_are() {
        assert_eq!(values(&["3", "-9007199254740993"]), Values::I64(vec![3, -9_007_199_254_740_993]));
        assert_eq!(values(&["3", "0.5", "4"]), Values::F64(vec![3.0, 0.5, 4.0]));
    }
}
