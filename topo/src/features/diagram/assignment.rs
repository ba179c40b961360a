//! The cheapest assignment of the points of one diagram to those of another or to the diagonal, exactly.
//!
//! That the diagonal takes any number of points makes the problem a rectangular one of the points alone: with d(b) for what
//! point b costs at the diagonal, matching a with b costs c(a, b) - d(b) more than leaving b there. So rows are points of
//! one diagram, each goes to one column or to the diagonal at d(a), and columns may stay free. Of n + m points on both
//! sides, as the problem is mostly stated, n rows and m columns are left.
//!
//! Shortest augmenting paths with column potentials (Jonker & Volgenant 1987, "A shortest augmenting path algorithm for dense
//! and sparse linear assignment problems"), their augmenting row reduction first; a free column and the diagonal have the
//! potential 0. O(n² m) at worst; costs are computed as they are needed.

use crate::pairing::NONE;
use crate::watch::Watch;

/// How often rows are assigned by their two best columns before paths are searched for, as by Jonker & Volgenant.
const REDUCTIONS: usize = 2;

/// The costs of an assignment: of each row to go to each column, less what the column costs at the diagonal.
pub(super) trait Costs {
    /// What each row costs at the diagonal.
    fn alone(&self) -> &[f64];

    /// Number of columns.
    fn columns(&self) -> usize;

    /// Writes the costs of a row into one number a column.
    fn write_row(&self, row: usize, costs: &mut [f64]);
}

/// For each row its column, or [`NONE`] for the diagonal; of no meaning if the watch has stopped the work.
pub(super) fn assign(costs: &impl Costs, watch: Watch<'_>) -> Vec<u32> {
    let mut assignment = Assignment::new(costs);
    let mut free: Vec<u32> = (0..costs.alone().len() as u32).collect();
    for _ in 0..REDUCTIONS {
        free = assignment.reduce(&free, watch);
    }
    free.into_iter().take_while(|_| !watch.stops()).for_each(|row| assignment.augment(row));
    assignment.column_of
}

struct Assignment<'a, C> {
    costs: &'a C,
    column_of: Vec<u32>,
    row_of: Vec<u32>,
    /// Of each column; never above zero.
    potential: Vec<f64>,
    /// The costs of one row.
    row: Vec<f64>,
    /// For each column how far it is from the row that comes in, by which row, and whether that is final.
    distance: Vec<f64>,
    before: Vec<u32>,
}

impl<'a, C: Costs> Assignment<'a, C> {
    fn new(costs: &'a C) -> Self {
        let (rows, columns) = (costs.alone().len(), costs.columns());
        Self {
            costs,
            column_of: vec![NONE; rows],
            row_of: vec![NONE; columns],
            potential: vec![0.0; columns],
            row: vec![0.0; columns],
            distance: vec![0.0; columns],
            before: vec![NONE; columns],
        }
    }

    /// Gives each free row its best column, whose potential falls until the second best is as good; what that turns out is
    /// tried on until nothing is gained. Returns the rows left free.
    fn reduce(&mut self, free: &[u32], watch: Watch<'_>) -> Vec<u32> {
        let mut left = Vec::new();
        let mut waiting: Vec<u32> = free.iter().rev().copied().collect();
        let mut steps = free.len() * 4;
        while let Some(row) = waiting.pop().filter(|_| !watch.stops()) {
            let alone = self.costs.alone()[row as usize];
            let (best, [first, second]) = self.two_best(row, alone);
            let Some(column) = best else {
                // The diagonal is best, and has room.
                self.column_of[row as usize] = NONE;
                continue;
            };
            let gained = second - first;
            let ousted = self.row_of[column];
            if ousted != NONE && gained <= 0.0 {
                left.push(row);
                continue;
            }
            self.potential[column] -= if ousted == NONE { 0.0 } else { gained };
            (self.column_of[row as usize], self.row_of[column]) = (column as u32, row);
            if ousted != NONE {
                self.column_of[ousted as usize] = NONE;
                steps = steps.saturating_sub(1);
                if steps > 0 { waiting.push(ousted) } else { left.push(ousted) }
            }
        }
        left
    }

    /// The best column of a row, if it is better than the diagonal, with its reduced cost and the second best.
    fn two_best(&mut self, row: u32, alone: f64) -> (Option<usize>, [f64; 2]) {
        self.costs.write_row(row as usize, &mut self.row);
        let (mut best, mut first, mut second) = (None, alone, f64::INFINITY);
        for (column, (&cost, &potential)) in self.row.iter().zip(&self.potential).enumerate() {
            let reduced = cost - potential;
            if reduced < second {
                if reduced < first {
                    (best, first, second) = (Some(column), reduced, first);
                } else {
                    second = reduced;
                }
            }
        }
        (best, [first, second])
    }

    /// Takes in a row by the shortest path to a free column or to the diagonal.
    fn augment(&mut self, row: u32) {
        let columns = self.potential.len();
        self.distance.fill(f64::INFINITY);
        // Columns that are not final yet, then final ones in reverse.
        let mut order: Vec<u32> = (0..columns as u32).collect();
        let mut open = columns;
        let (mut at, mut length) = (row, 0.0);
        let (mut nearest_diagonal, mut last_row) = (f64::INFINITY, row);
        let end = loop {
            // The reduced cost of the row's own column is zero, so `base` makes lengths of its costs.
            self.costs.write_row(at as usize, &mut self.row);
            let own = self.column_of[at as usize];
            let base = if at == row { 0.0 } else { self.row[own as usize] - self.potential[own as usize] - length };
            let diagonal = self.costs.alone()[at as usize] - base;
            if diagonal < nearest_diagonal {
                (nearest_diagonal, last_row) = (diagonal, at);
            }
            let (mut nearest, mut shortest) = (None, nearest_diagonal);
            for (place, &column) in order[..open].iter().enumerate() {
                let column = column as usize;
                let through = self.row[column] - self.potential[column] - base;
                if through < self.distance[column] {
                    (self.distance[column], self.before[column]) = (through, at);
                }
                if self.distance[column] < shortest {
                    (nearest, shortest) = (Some(place), self.distance[column]);
                }
            }
            length = shortest;
            let Some(place) = nearest else { break None };
            let column = order[place];
            if self.row_of[column as usize] == NONE {
                break Some(column);
            }
            open -= 1;
            order.swap(place, open);
            at = self.row_of[column as usize];
        };
        for &column in &order[open..] {
            self.potential[column as usize] += self.distance[column as usize] - length;
        }
        self.swap_along(row, end, last_row);
    }

    /// Assigns anew along the path that ends in a free column, or with a row that goes to the diagonal.
    fn swap_along(&mut self, row: u32, end: Option<u32>, last_row: u32) {
        let mut column = match end {
            Some(column) => column,
            None => core::mem::replace(&mut self.column_of[last_row as usize], NONE),
        };
        if end.is_none() && last_row == row {
            return;
        }
        loop {
            let from = self.before[column as usize];
            self.row_of[column as usize] = from;
            let left = core::mem::replace(&mut self.column_of[from as usize], column);
            if from == row {
                return;
            }
            column = left;
        }
    }
}
