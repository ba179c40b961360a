//! Networks: a table of nodes and a table of edges, with commas, semicolons or tabs between cells.

use super::decimal::Decimals;
use super::error::{FilePosition, Problem, ReadError, unreadable};
use super::table::separator;
use super::values::Values;
use csv::{ReaderBuilder, StringRecord, Trim};
use geom::{are, counted};
use std::collections::HashMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Nodes with values and the edges between them.
#[derive(Debug)]
pub(crate) struct Network {
    pub(crate) values: Values,
    /// As the file calls them, or their ids.
    pub(crate) names: Vec<String>,
    pub(crate) edges: Vec<[usize; 2]>,
}

impl Network {
    /// Reads nodes (columns id, value, and name if there is one) and edges (columns a, b); other columns are passed over.
    pub(crate) fn read(nodes: &Path, edges: &Path) -> Result<Self, ReadError> {
        let nodes = Nodes::read(nodes)?;
        let edges = nodes.edges(edges)?;
        Ok(Self { values: nodes.values.into_values(), names: nodes.names, edges })
    }

    /// How many edges join a node to itself, and how many of the others stand in the file before, either way round.
    pub(crate) fn idle_edges(&self) -> [usize; 2] {
        let mut others: Vec<[usize; 2]> = self.edges.iter().copied().filter(|[a, b]| a != b).collect();
        let (loops, count) = (self.edges.len() - others.len(), others.len());
        others.iter_mut().for_each(|ends| ends.sort_unstable());
        others.sort_unstable();
        others.dedup();
        [loops, count - others.len()]
    }
}

/// Where the edges of a file of nodes lie, if they are called alike: `x.edges.csv` beside `x.nodes.csv`.
pub(crate) fn edges_beside(nodes: &Path) -> Option<PathBuf> {
    let stem = nodes.file_name()?.to_str()?.strip_suffix(".nodes.csv")?;
    Some(nodes.with_file_name(format!("{stem}.edges.csv"))).filter(|edges| edges.is_file())
}

#[derive(Debug, Default)]
struct Nodes {
    by_id: HashMap<String, usize>,
    names: Vec<String>,
    values: Decimals,
}

impl Nodes {
    fn read(path: &Path) -> Result<Self, ReadError> {
        const WANTED: &str = "id, name, value";
        let mut table = Table::open(path)?;
        let (id, value) = (table.column("id", WANTED)?, table.column("value", WANTED)?);
        let name = table.column("name", WANTED).unwrap_or(id);
        let mut nodes = Self::default();
        while let Some(row) = table.next_row()? {
            let known = nodes.by_id.insert(row[id].to_owned(), nodes.names.len());
            let added = nodes.values.push(&row[value]);
            nodes.names.push(row[name].to_owned());
            let twice = known.map_or(Ok(()), |_| Err(Problem::Twice(row[id].to_owned())));
            added.and(twice).map_err(|problem| table.fault(problem))?;
        }
        if nodes.names.is_empty() { Err(Problem::Empty.in_file(path)) } else { Ok(nodes) }
    }

    fn edges(&self, path: &Path) -> Result<Vec<[usize; 2]>, ReadError> {
        const WANTED: &str = "a, b";
        let mut table = Table::open(path)?;
        let ends = [table.column("a", WANTED)?, table.column("b", WANTED)?];
        let mut edges = Vec::new();
        while let Some(row) = table.next_row()? {
            let node = |column: usize| {
                let id = &row[column];
                self.by_id.get(id).copied().ok_or_else(|| table.fault(Problem::NoNode(id.to_owned())))
            };
            edges.push([node(ends[0])?, node(ends[1])?]);
        }
        Ok(edges)
    }
}

/// A table whose first line names its columns.
struct Table<'a> {
    path: &'a Path,
    reader: csv::Reader<Cursor<Vec<u8>>>,
    columns: StringRecord,
    line: u64,
}

impl<'a> Table<'a> {
    fn open(path: &'a Path) -> Result<Self, ReadError> {
        let bytes = std::fs::read(path).map_err(|error| Problem::from(error).in_file(path))?;
        let first = bytes.split(|&byte| byte == b'\n').find(|line| !line.trim_ascii().is_empty()).unwrap_or_default();
        let separator = separator(&String::from_utf8_lossy(first)).unwrap_or(',') as u8;
        let mut reader = ReaderBuilder::new().delimiter(separator).trim(Trim::All).from_reader(Cursor::new(bytes));
        let columns = reader.headers().map_err(|error| fault(&error, path))?.clone();
        Ok(Self { path, reader, columns, line: 1 })
    }

    fn column(&self, name: &'static str, wanted: &'static str) -> Result<usize, ReadError> {
        let is_it = |column: &str| column.trim_start_matches('\u{feff}').eq_ignore_ascii_case(name);
        let found = self.columns.iter().position(is_it);
        found.ok_or_else(|| self.fault(Problem::Column { name, wanted }))
    }

    /// The next row, which has as many cells as there are columns.
    fn next_row(&mut self) -> Result<Option<StringRecord>, ReadError> {
        let mut row = StringRecord::new();
        let is_row = self.reader.read_record(&mut row).map_err(|error| fault(&error, self.path))?;
        self.line = row.position().map_or(self.line, csv::Position::line);
        Ok(is_row.then_some(row))
    }

    /// A problem in the row read last.
    fn fault(&self, problem: Problem) -> ReadError {
        problem.at(FilePosition::Line(self.line), self.path)
    }
}

fn fault(error: &csv::Error, path: &Path) -> ReadError {
    let place = error.position().map_or(FilePosition::File, |position| FilePosition::Line(position.line()));
    let message = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!(
                "there {} where the first line names {}",
                are(*len as usize, "cell", "cells"),
                counted(*expected_len as usize, "column", "columns")
            )
        }
        csv::ErrorKind::Utf8 { .. } => "there is text that is not UTF-8: save the table as UTF-8".to_owned(),
        csv::ErrorKind::Io(error) => unreadable(error),
        _ => error.to_string(),
    };
    Problem::Csv(message).at(place, path)
}
