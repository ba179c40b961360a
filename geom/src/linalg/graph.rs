//! The graph of a symmetric matrix: its rows, joined where an entry off the diagonal is stored.

use crate::rows::Rows;

/// Where a vertex is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Low,
    High,
    /// On neither side: in the separator, or where one is sought.
    Between,
}

impl Side {
    pub(crate) fn other(self) -> Self {
        match self {
            Self::Low => Self::High,
            Self::High => Self::Low,
            Self::Between => Self::Between,
        }
    }
}

/// A graph by its neighbours, without loops.
#[derive(Clone, Debug)]
pub(crate) struct Graph {
    start: Vec<u32>,
    neighbor: Vec<u32>,
}

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
        let rows = Rows::sorted(count, (0..count).flat_map(both_ways));
        let mut graph = Self { start: Vec::with_capacity(count + 1), neighbor: Vec::with_capacity(rows.item_count()) };
        graph.start.push(0);
        for v in 0..count {
            graph.neighbor.extend_from_slice(rows.row(v));
            graph.start.push(graph.neighbor.len() as u32);
        }
        graph
    }

    /// A graph by the neighbours of each vertex.
    pub(crate) fn from_rows<R: IntoIterator<Item = u32>>(rows: impl Iterator<Item = R>) -> Self {
        let mut graph = Self { start: vec![0], neighbor: Vec::new() };
        for row in rows {
            graph.neighbor.extend(row);
            graph.start.push(graph.neighbor.len() as u32);
        }
        graph
    }

    /// The graphs of the vertices on the low and on the high side, numbered anew in the same order.
    pub(crate) fn sides(&self, side: &[Side]) -> [Self; 2] {
        let of = |side: Side| usize::from(side == Side::High);
        let (mut count, mut most) = ([0; 2], [0; 2]);
        let mut number = vec![0u32; self.len()];
        for (v, &own) in side.iter().enumerate().filter(|(_, side)| **side != Side::Between) {
            number[v] = count[of(own)];
            count[of(own)] += 1;
            most[of(own)] += (self.start[v + 1] - self.start[v]) as usize;
        }
        let mut graphs =
            [0, 1].map(|k| Self { start: Vec::with_capacity(count[k] as usize + 1), neighbor: vec![0; most[k]] });
        let mut end = [0; 2];
        graphs.iter_mut().for_each(|graph| graph.start.push(0));
        for (v, &own) in side.iter().enumerate().filter(|(_, side)| **side != Side::Between) {
            let Self { start, neighbor } = &mut graphs[of(own)];
            let end = &mut end[of(own)];
            // Each is written; the next takes the place of one on the other side. No branch is to be foretold so.
            for &w in self.neighbors(v as u32) {
                neighbor[*end] = number[w as usize];
                *end += usize::from(side[w as usize] == own);
            }
            start.push(*end as u32);
        }
        for (graph, end) in graphs.iter_mut().zip(end) {
            graph.neighbor.truncate(end);
        }
        graphs
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
