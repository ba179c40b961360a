//! Forward and backward substitution for several right-hand sides at once.
//!
//! Each value of the factor is used for all of them while it is in the cache, four columns of a supernode at a time. The
//! unknowns lie row by row, one value for each right-hand side, so that these fill the processor's vectors.

use pulp::{Arch, Simd, WithSimd};

use super::elimination::Elimination;
use crate::watch::{Interrupted, Watch};

/// The number of right-hand sides is a multiple of this, which the length of any vector divides.
pub(crate) const LANES: usize = 8;

/// Solves C Cᵀ x = b in place, or Cᵀ x = b alone; `x` holds `columns` values for each step.
pub(crate) fn substitute(
    elimination: &Elimination,
    factor: &[f64],
    passes: Passes,
    columns: usize,
    x: &mut [f64],
    watch: Watch,
) -> Result<(), Interrupted> {
    debug_assert_eq!(columns % LANES, 0);
    Arch::new().dispatch(Substitution { elimination, factor, passes, columns, x, watch })
}

/// The watch is asked again after so many values of the factor.
const ASKED_AFTER: usize = 1 << 16;

/// What is to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Passes {
    /// Forward and backward.
    Both,
    /// Backward alone.
    Backward,
}

struct Substitution<'a> {
    elimination: &'a Elimination,
    factor: &'a [f64],
    passes: Passes,
    columns: usize,
    x: &'a mut [f64],
    watch: Watch<'a>,
}

/// A supernode's part of the factor.
#[derive(Clone, Copy)]
struct Panel<'a> {
    first: usize,
    width: usize,
    rows: &'a [u32],
    values: &'a [f64],
}

impl<'a> Panel<'a> {
    fn column(&self, j: usize) -> &'a [f64] {
        let height = self.width + self.rows.len();
        &self.values[j * height..(j + 1) * height]
    }
}

impl WithSimd for Substitution<'_> {
    type Output = Result<(), Interrupted>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { elimination, factor, passes, columns, x, watch } = self;
        let parts = columns / S::F64_LANES;
        let x = S::as_mut_simd_f64s(x).0;
        // The values in the rows of a supernode, part after part.
        let mut below = Vec::new();
        let panel = |s: usize| Panel {
            first: elimination.first(s),
            width: elimination.width(s),
            rows: elimination.rows(s),
            values: &factor[elimination.values(s)],
        };
        // Whether a supernode has values beyond the next multiple of so many.
        let asks = |s: usize| elimination.values(s).start / ASKED_AFTER != elimination.values(s).end / ASKED_AFTER;
        let share = |s: usize| s as f64 / elimination.len() as f64;
        let (first, second) = (watch.within(0.0, 0.5), watch.within(0.5, 1.0));
        if passes == Passes::Both {
            for s in 0..elimination.len() {
                if asks(s) {
                    first.ask(share(s))?;
                }
                forward(simd, panel(s), parts, x, &mut below);
            }
        }
        for s in (0..elimination.len()).rev() {
            if asks(s) {
                second.ask(1.0 - share(s))?;
            }
            backward(simd, panel(s), parts, x, &mut below);
        }
        Ok(())
    }
}

#[inline(always)]
fn forward<S: Simd>(simd: S, panel: Panel, parts: usize, x: &mut [S::f64s], below: &mut Vec<S::f64s>) {
    let Panel { first, width, rows, .. } = panel;
    below.clear();
    below.resize(rows.len() * parts, simd.splat_f64s(0.0));
    let own = &mut x[first * parts..(first + width) * parts];
    for j in (0..width).step_by(4) {
        let four = width.min(j + 4) - j;
        let (own, later) = own[j * parts..].split_at_mut(four * parts);
        for c in 0..four {
            let column = panel.column(j + c);
            let (done, rest) = own.split_at_mut((c + 1) * parts);
            let y = &mut done[c * parts..];
            let inverse = simd.splat_f64s(column[j + c].recip());
            y.iter_mut().for_each(|y| *y = simd.mul_f64s(*y, inverse));
            for (x, entry) in rest.chunks_exact_mut(parts).zip(&column[j + c + 1..]) {
                let minus = simd.splat_f64s(-entry);
                x.iter_mut().zip(&*y).for_each(|(x, y)| *x = simd.mul_add_e_f64s(minus, *y, *x));
            }
        }
        for part in 0..parts {
            let below = &mut below[part * rows.len()..(part + 1) * rows.len()];
            if four == 4 {
                let y = [own[part], own[parts + part], own[2 * parts + part], own[3 * parts + part]];
                let [a, b, c, d] = [panel.column(j), panel.column(j + 1), panel.column(j + 2), panel.column(j + 3)];
                let top = [&a[j + 4..width], &b[j + 4..width], &c[j + 4..width], &d[j + 4..width]];
                let bottom = [&a[width..], &b[width..], &c[width..], &d[width..]];
                let minus = simd.splat_f64s(-1.0);
                let negated = [
                    simd.mul_f64s(minus, y[0]),
                    simd.mul_f64s(minus, y[1]),
                    simd.mul_f64s(minus, y[2]),
                    simd.mul_f64s(minus, y[3]),
                ];
                add_four::<S>(simd, later.chunks_exact_mut(parts).map(|row| &mut row[part]), top, negated);
                add_four::<S>(simd, below.iter_mut(), bottom, y);
            } else {
                for c in 0..four {
                    let y = own[c * parts + part];
                    for (x, entry) in below.iter_mut().zip(&panel.column(j + c)[width..]) {
                        *x = simd.mul_add_e_f64s(simd.splat_f64s(*entry), y, *x);
                    }
                }
            }
        }
    }
    for (i, &r) in rows.iter().enumerate() {
        for (part, x) in x[r as usize * parts..][..parts].iter_mut().enumerate() {
            *x = simd.sub_f64s(*x, below[part * rows.len() + i]);
        }
    }
}

#[inline(always)]
fn backward<S: Simd>(simd: S, panel: Panel, parts: usize, x: &mut [S::f64s], below: &mut Vec<S::f64s>) {
    let Panel { first, width, rows, .. } = panel;
    below.clear();
    for part in 0..parts {
        below.extend(rows.iter().map(|&r| x[r as usize * parts + part]));
    }
    let own = &mut x[first * parts..(first + width) * parts];
    for j in (0..width).step_by(4).rev() {
        let four = width.min(j + 4) - j;
        let (own, later) = own[j * parts..].split_at_mut(four * parts);
        for part in 0..parts {
            let below = &below[part * rows.len()..(part + 1) * rows.len()];
            if four == 4 {
                let [a, b, c, d] = [panel.column(j), panel.column(j + 1), panel.column(j + 2), panel.column(j + 3)];
                let top = [&a[j + 4..width], &b[j + 4..width], &c[j + 4..width], &d[j + 4..width]];
                let bottom = [&a[width..], &b[width..], &c[width..], &d[width..]];
                let zero = [simd.splat_f64s(0.0); 4];
                let sum = sum_four::<S>(simd, later.chunks_exact(parts).map(|row| &row[part]), top, zero);
                let sum = sum_four::<S>(simd, below.iter(), bottom, sum);
                for (row, sum) in own.chunks_exact_mut(parts).zip(sum) {
                    row[part] = simd.sub_f64s(row[part], sum);
                }
            } else {
                for c in 0..four {
                    let mut sum = simd.splat_f64s(0.0);
                    for (x, entry) in below.iter().zip(&panel.column(j + c)[width..]) {
                        sum = simd.mul_add_e_f64s(simd.splat_f64s(*entry), *x, sum);
                    }
                    own[c * parts + part] = simd.sub_f64s(own[c * parts + part], sum);
                }
            }
        }
        for c in (0..four).rev() {
            let column = panel.column(j + c);
            let (done, rest) = own.split_at_mut((c + 1) * parts);
            let y = &mut done[c * parts..];
            for (x, entry) in rest.chunks_exact(parts).zip(&column[j + c + 1..]) {
                let minus = simd.splat_f64s(-entry);
                y.iter_mut().zip(x).for_each(|(y, x)| *y = simd.mul_add_e_f64s(minus, *x, *y));
            }
            let inverse = simd.splat_f64s(column[j + c].recip());
            y.iter_mut().for_each(|y| *y = simd.mul_f64s(*y, inverse));
        }
    }
}

/// x += a y₀ + b y₁ + c y₂ + d y₃
#[inline(always)]
fn add_four<'a, S: Simd>(
    simd: S,
    x: impl Iterator<Item = &'a mut S::f64s>,
    [a, b, c, d]: [&[f64]; 4],
    [ya, yb, yc, yd]: [S::f64s; 4],
) where
    S::f64s: 'a,
{
    for ((((x, a), b), c), d) in x.zip(a).zip(b).zip(c).zip(d) {
        let [a, b, c, d] = [simd.splat_f64s(*a), simd.splat_f64s(*b), simd.splat_f64s(*c), simd.splat_f64s(*d)];
        let ab = simd.mul_add_e_f64s(b, yb, simd.mul_add_e_f64s(a, ya, *x));
        *x = simd.mul_add_e_f64s(d, yd, simd.mul_add_e_f64s(c, yc, ab));
    }
}

/// The products of four columns with x, added to sums.
#[inline(always)]
fn sum_four<'a, S: Simd>(
    simd: S,
    x: impl Iterator<Item = &'a S::f64s>,
    [a, b, c, d]: [&[f64]; 4],
    [mut sa, mut sb, mut sc, mut sd]: [S::f64s; 4],
) -> [S::f64s; 4]
where
    S::f64s: 'a,
{
    for ((((x, a), b), c), d) in x.zip(a).zip(b).zip(c).zip(d) {
        sa = simd.mul_add_e_f64s(simd.splat_f64s(*a), *x, sa);
        sb = simd.mul_add_e_f64s(simd.splat_f64s(*b), *x, sb);
        sc = simd.mul_add_e_f64s(simd.splat_f64s(*c), *x, sc);
        sd = simd.mul_add_e_f64s(simd.splat_f64s(*d), *x, sd);
    }
    [sa, sb, sc, sd]
}
