//! The dense work of a factorization: eliminating the first steps of a front.
//!
//! Most fronts are small. These are eliminated here, with vector instructions as the processor has them (pulp); for the few
//! large ones, where most of the arithmetic is, faer's blocked kernels are faster.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use pulp::{Arch, Simd, WithSimd};

use super::registers;
use crate::parallel::join;

/// From this width on panels are factored by faer.
const WIDE: usize = 48;
/// From this size on updates are computed by faer.
const LARGE: usize = 256;
/// Updates are computed in square tiles of this size, a multiple of any vector's length.
const TILE: usize = 8;

/// Eliminates fronts.
#[derive(Debug)]
pub(crate) struct Eliminator {
    arch: Arch,
    tiles: Vec<f64>,
}

impl Eliminator {
    pub(crate) fn new() -> Self {
        Self { arch: Arch::new(), tiles: Vec::new() }
    }

    /// Eliminates the steps of a front: the panel holds their columns, of the given height, and becomes theirs of the
    /// factor; their outer product is subtracted from the update, the square of the other rows. False at a pivot that is not
    /// positive.
    pub(crate) fn eliminate(&mut self, panel: &mut [f64], height: usize, update: &mut [f64]) -> bool {
        let width = panel.len() / height;
        let is_definite =
            if width < WIDE { self.arch.dispatch(Factor { panel, height }) } else { factor_wide(panel, height) };
        if is_definite && height > width {
            if height - width < LARGE {
                self.arch.dispatch(Downdate { panel, height, update, tiles: &mut self.tiles });
            } else {
                downdate_large(panel, height, update);
            }
        }
        is_definite
    }

    /// The same, with the work of large fronts shared.
    pub(crate) fn eliminate_large(&mut self, panel: &mut [f64], height: usize, update: &mut [f64]) -> bool {
        let width = panel.len() / height;
        if width < WIDE || height - width < LARGE {
            return self.eliminate(panel, height, update);
        }
        let is_definite = factor_wide(panel, height);
        if is_definite {
            let panel: &[f64] = panel;
            downdate_columns(panel, height, update, 0);
        }
        is_definite
    }
}

/// So many rows of a panel are divided at a time.
const ROWS: usize = 256;
/// So many columns of an update are computed at a time.
const COLUMNS: usize = 128;

/// Computes some columns of an update, from a given one on, by faer.
fn downdate_columns(panel: &[f64], height: usize, columns: &mut [f64], first: usize) {
    let width = panel.len() / height;
    let rest = height - width;
    let count = columns.len() / rest;
    if count > COLUMNS {
        // Parts are whole blocks, wherever the update is parted.
        let half = (count / 2).next_multiple_of(COLUMNS);
        let (left, right) = columns.split_at_mut(half * rest);
        join(|| downdate_columns(panel, height, left, first), || downdate_columns(panel, height, right, first + half));
        return;
    }
    let below = MatRef::from_column_major_slice(panel, height, width).split_at_row(width).1;
    let rows = below.split_at_row(first).1;
    faer::linalg::matmul::matmul(
        MatMut::from_column_major_slice_mut(columns, rest, count).split_at_row_mut(first).1,
        Accum::Add,
        rows,
        rows.split_at_row(count).0.transpose(),
        -1.0,
        Par::Seq,
    );
    registers::clear();
}

/// Factors a panel by faer.
fn factor_wide(panel: &mut [f64], height: usize) -> bool {
    let width = panel.len() / height;
    let (mut top, bottom) = MatMut::from_column_major_slice_mut(panel, height, width).split_at_row_mut(width);
    let mut scratch = MemBuffer::new(cholesky_in_place_scratch::<f64>(width, Par::Seq, Default::default()));
    let regularization = LltRegularization::default();
    let stack = MemStack::new(&mut scratch);
    let done = cholesky_in_place(top.as_mut(), regularization, Par::Seq, stack, Default::default()).is_ok();
    let is_definite = done && (0..width).all(|j| top[(j, j)] > 0.0 && top[(j, j)] < f64::INFINITY);
    registers::clear();
    if is_definite {
        divide(top.as_ref(), bottom);
    }
    is_definite
}

/// Solves X Tᵀ = B for a lower triangle T in place, rows by rows.
fn divide(triangle: MatRef<f64>, rows: MatMut<f64>) {
    if rows.nrows() > ROWS {
        // Parts are whole blocks, wherever the rows are parted.
        let half = (rows.nrows() / 2).next_multiple_of(ROWS);
        let (above, below) = rows.split_at_row_mut(half);
        join(|| divide(triangle, above), || divide(triangle, below));
        return;
    }
    solve_lower_triangular_in_place(triangle, rows.transpose_mut(), Par::Seq);
    registers::clear();
}

/// Computes an update by faer.
fn downdate_large(panel: &[f64], height: usize, update: &mut [f64]) {
    let width = panel.len() / height;
    let rest = height - width;
    let below = MatRef::from_column_major_slice(panel, height, width).split_at_row(width).1;
    matmul(
        MatMut::from_column_major_slice_mut(update, rest, rest),
        BlockStructure::TriangularLower,
        Accum::Add,
        below,
        BlockStructure::Rectangular,
        below.transpose(),
        BlockStructure::Rectangular,
        -1.0,
        Par::Seq,
    );
    registers::clear();
}

/// Factors a narrow panel column by column.
struct Factor<'a> {
    panel: &'a mut [f64],
    height: usize,
}

impl WithSimd for Factor<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self { panel, height } = self;
        for j in 0..panel.len() / height {
            let (done, column) = panel.split_at_mut(j * height);
            let column = &mut column[j..height];
            let mut fours = done.chunks_exact(4 * height);
            for four in &mut fours {
                let (ab, cd) = four.split_at(2 * height);
                let (a, b) = ab.split_at(height);
                let (c, d) = cd.split_at(height);
                subtract_four(simd, column, &a[j..], &b[j..], &c[j..], &d[j..]);
            }
            for one in fours.remainder().chunks_exact(height) {
                subtract(simd, column, &one[j..]);
            }
            let pivot = column[0];
            let is_positive = pivot > 0.0 && pivot < f64::INFINITY; // not so with NaN
            if !is_positive {
                return false;
            }
            let inverse = pivot.sqrt().recip();
            column[0] = pivot.sqrt();
            column[1..].iter_mut().for_each(|x| *x *= inverse);
        }
        true
    }
}

/// x -= a[0] a
#[inline(always)]
fn subtract<S: Simd>(simd: S, x: &mut [f64], a: &[f64]) {
    let minus_a0 = -a[0];
    let factor = simd.splat_f64s(minus_a0);
    let (x, x_tail) = S::as_mut_simd_f64s(x);
    let (a, a_tail) = S::as_simd_f64s(a);
    for (x, a) in x.iter_mut().zip(a) {
        *x = simd.mul_add_e_f64s(factor, *a, *x);
    }
    x_tail.iter_mut().zip(a_tail).for_each(|(x, a)| *x += minus_a0 * a);
}

/// x -= a[0] a + b[0] b + c[0] c + d[0] d
#[inline(always)]
fn subtract_four<S: Simd>(simd: S, x: &mut [f64], a: &[f64], b: &[f64], c: &[f64], d: &[f64]) {
    let (a0, b0, c0, d0) = (-a[0], -b[0], -c[0], -d[0]);
    let (fa, fb, fc, fd) = (simd.splat_f64s(a0), simd.splat_f64s(b0), simd.splat_f64s(c0), simd.splat_f64s(d0));
    let (x, x_tail) = S::as_mut_simd_f64s(x);
    let (a, a_tail) = S::as_simd_f64s(a);
    let (b, b_tail) = S::as_simd_f64s(b);
    let (c, c_tail) = S::as_simd_f64s(c);
    let (d, d_tail) = S::as_simd_f64s(d);
    for ((((x, a), b), c), d) in x.iter_mut().zip(a).zip(b).zip(c).zip(d) {
        let ab = simd.mul_add_e_f64s(fb, *b, simd.mul_add_e_f64s(fa, *a, *x));
        *x = simd.mul_add_e_f64s(fd, *d, simd.mul_add_e_f64s(fc, *c, ab));
    }
    for ((((x, a), b), c), d) in x_tail.iter_mut().zip(a_tail).zip(b_tail).zip(c_tail).zip(d_tail) {
        *x += a0 * a + b0 * b + c0 * c + d0 * d;
    }
}

/// Subtracts the outer product of a panel's rows below its diagonal block from an update.
struct Downdate<'a> {
    panel: &'a [f64],
    height: usize,
    update: &'a mut [f64],
    tiles: &'a mut Vec<f64>,
}

impl WithSimd for Downdate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { panel, height, update, tiles } = self;
        let width = panel.len() / height;
        let size = height - width;
        tile(panel, height, tiles);
        let lanes = S::F64_LANES;
        for (g, group) in tiles.chunks_exact(TILE * width).enumerate() {
            for (t, tile) in tiles.chunks_exact(TILE * width).enumerate().skip(g) {
                let rows = (t * TILE..size.min((t + 1) * TILE)).step_by(lanes);
                for (part, row) in rows.enumerate() {
                    let mut sum = [simd.splat_f64s(0.0); TILE];
                    for (a, b) in tile.chunks_exact(TILE).zip(group.chunks_exact(TILE)) {
                        let a = S::as_simd_f64s(a).0[part];
                        for c in 0..TILE {
                            sum[c] = simd.mul_add_e_f64s(a, simd.splat_f64s(b[c]), sum[c]);
                        }
                    }
                    let end = size.min(row + lanes);
                    for (c, sum) in (g * TILE..size).zip(sum) {
                        let target = &mut update[c * size + row..c * size + end];
                        let difference = simd.sub_f64s(simd.partial_load_f64s(target), sum);
                        simd.partial_store_f64s(target, difference);
                    }
                }
            }
        }
    }
}

/// Copies the rows of a panel below its diagonal block to tiles of eight rows each, padded with zeros, in which columns
/// follow each other.
#[inline(always)]
fn tile(panel: &[f64], height: usize, tiles: &mut Vec<f64>) {
    let width = panel.len() / height;
    tiles.clear();
    tiles.resize((height - width).div_ceil(TILE) * TILE * width, 0.0);
    for (j, column) in panel.chunks_exact(height).enumerate() {
        for (t, rows) in column[width..].chunks(TILE).enumerate() {
            let from = (t * width + j) * TILE;
            tiles[from..from + rows.len()].copy_from_slice(rows);
        }
    }
}
