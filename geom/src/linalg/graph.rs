//! The graph of a symmetric matrix: its rows, joined where an entry off the diagonal is stored.

use crate::rows::Rows;

/// A graph by its neighbours, without loops.
#[derive(Debug)]
pub(crate) struct Graph(Rows<u32>);

impl Graph {
    /// The graph of a symmetric matrix, from its lower triangle by columns.
    pub(crate) fn of_lower_triangle(column_start: &[u32], row: &[u32]) -> Self {
        let count = column_start.len() - 1;
        let entries = |column: usize| {
            let rows = &row[column_start[column] as usize..column_start[column + 1] as usize];
            rows.iter().copied().filter(move |&row| row as usize != column)
        };
        let both_ways =
            |column: usize| entries(column).flat_map(move |row| [(column, row), (row as usize, column as u32)]);
        Self(Rows::sorted(count, (0..count).flat_map(both_ways)))
    }

    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn edge_count(&self) -> usize {
        self.0.item_count() / 2
    }

    pub(crate) fn neighbors(&self, v: u32) -> &[u32] {
        self.0.row(v as usize)
    }
}
