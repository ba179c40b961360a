//! The graph of a symmetric matrix: its rows, joined where an entry off the diagonal is stored.

/// A graph by its neighbours, without loops.
#[derive(Debug)]
pub(crate) struct Graph {
    start: Vec<u32>,
    neighbor: Vec<u32>,
}

impl Graph {
    /// The graph of a symmetric matrix, from its lower triangle by columns.
    pub(crate) fn of_lower_triangle(column_start: &[u32], row: &[u32]) -> Self {
        let n = column_start.len() - 1;
        let entries = |column: usize| {
            let rows = &row[column_start[column] as usize..column_start[column + 1] as usize];
            rows.iter().copied().filter(move |&row| row as usize != column)
        };
        // The start of v is counted up at v + 1 while neighbours are filled in.
        let mut start = vec![0u32; n + 2];
        for column in 0..n {
            for row in entries(column) {
                start[column + 2] += 1;
                start[row as usize + 2] += 1;
            }
        }
        for v in 0..n {
            start[v + 2] += start[v + 1];
        }
        let mut neighbor = vec![0; start[n + 1] as usize];
        for column in 0..n {
            for row in entries(column) {
                for (from, to) in [(column, row), (row as usize, column as u32)] {
                    neighbor[start[from + 1] as usize] = to;
                    start[from + 1] += 1;
                }
            }
        }
        start.truncate(n + 1);
        Self { start, neighbor }
    }

    pub(crate) fn len(&self) -> usize {
        self.start.len() - 1
    }

    pub(crate) fn edge_count(&self) -> usize {
        self.neighbor.len() / 2
    }

    pub(crate) fn neighbors(&self, v: u32) -> &[u32] {
        &self.neighbor[self.start[v as usize] as usize..self.start[v as usize + 1] as usize]
    }
}
