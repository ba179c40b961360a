//! Forward and backward substitution for several right-hand sides at once.
//!
//! Each value of the factor is used for all of them while it is in the cache, four columns of a supernode at a time. The
//! unknowns lie row by row, one value for each right-hand side, so that these fill the processor's vectors.

use pulp::{Arch, Simd, WithSimd};

use super::single::{Factor, Part};
use crate::parallel::try_each;
use crate::watch::{Interrupted, Watch};

/// The number of right-hand sides is a multiple of this, which the length of any vector divides.
pub(crate) const LANES: usize = 8;

/// The watch is asked again after so many values of the factor.
const ASKED_AFTER: usize = 1 << 16;

/// What is to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Passes {
    /// Forward and backward.
    Both,
    /// Backward alone.
    Backward,
}

/// Solves C Cᵀ x = b in place, or Cᵀ x = b alone; `x` holds `columns` values for each step. Subtrees of a large factor are gone through at
/// the same time, as for [one right-hand side](super::single).
pub(super) fn substitute(
    factor: Factor,
    passes: Passes,
    columns: usize,
    x: &mut [f64],
    watch: Watch,
) -> Result<(), Interrupted> {
    debug_assert_eq!(columns % LANES, 0);
    let (first, second) = match passes {
        Passes::Both => (watch.within(0.0, 0.5), watch.within(0.5, 1.0)),
        Passes::Backward => (watch, watch),
    };
    let Some(parted) = factor.parted else {
        let all = 0..factor.elimination.len();
        if passes == Passes::Both {
            Stretch::of_all(factor, columns, x, first).forward(all.clone(), &mut [])?;
        }
        return Stretch::of_all(factor, columns, x, second).backward(all, &[]);
    };
    let place = &parted.place[..];
    if passes == Passes::Both {
        let mut parts = parted.parts(factor.elimination, x, columns);
        let above = parted.steps.len() * columns;
        let changes = first.within(0.0, 0.9).shared(|watch| {
            let mut changes = vec![Vec::new(); parts.len()];
            let mut work: Vec<_> = parts.iter_mut().zip(&mut changes).collect();
            try_each(0, &mut work, &|_, (Part { tree, from, own }, change)| {
                **change = vec![0.0; above];
                Stretch { factor, columns, from: *from, own, place, watch }.forward(tree.clone(), change)
            })?;
            Ok(changes)
        })?;
        for (k, &step) in parted.steps.iter().enumerate() {
            let x = &mut x[step as usize * columns..][..columns];
            for change in &changes {
                x.iter_mut().zip(&change[k * columns..]).for_each(|(x, change)| *x += change);
            }
        }
        Stretch::of_all(factor, columns, x, first.within(0.9, 1.0)).forward(parted.above.iter().copied(), &mut [])?;
    }
    Stretch::of_all(factor, columns, x, second.within(0.0, 0.1)).backward(parted.above.iter().copied(), &[])?;
    let of_step = |&step: &u32| &x[step as usize * columns..][..columns];
    let above: Vec<f64> = parted.steps.iter().flat_map(of_step).copied().collect();
    let mut parts = parted.parts(factor.elimination, x, columns);
    second.within(0.1, 1.0).shared(|watch| {
        try_each(0, &mut parts, &|_, Part { tree, from, own }| {
            Stretch { factor, columns, from: *from, own, place, watch }.backward(tree.clone(), &above)
        })
    })
}

/// Steps that follow each other, with their values for all right-hand sides.
struct Stretch<'a> {
    factor: Factor<'a>,
    columns: usize,
    /// The first of them.
    from: usize,
    own: &'a mut [f64],
    /// Where a step beyond them is among those above.
    place: &'a [u32],
    watch: Watch<'a>,
}

impl<'a> Stretch<'a> {
    fn of_all(factor: Factor<'a>, columns: usize, x: &'a mut [f64], watch: Watch<'a>) -> Self {
        Self { factor, columns, from: 0, own: x, place: &[], watch }
    }

    /// Through supernodes of these steps, ascending; what changes above is subtracted there.
    fn forward(self, supernodes: impl Iterator<Item = usize>, above: &mut [f64]) -> Result<(), Interrupted> {
        Arch::new().dispatch(Forward { stretch: self, supernodes, above })
    }

    /// Through supernodes of these steps, given ascending, from the last to the first.
    fn backward(self, supernodes: impl DoubleEndedIterator<Item = usize>, above: &[f64]) -> Result<(), Interrupted> {
        Arch::new().dispatch(Backward { stretch: self, supernodes, above })
    }
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
    /// With its first step counted from another.
    fn new(factor: Factor<'a>, s: usize, from: usize) -> Self {
        let elimination = factor.elimination;
        let (first, width) = (elimination.first(s) - from, elimination.width(s));
        Self { first, width, rows: elimination.rows(s), values: factor.panel(s) }
    }

    fn column(&self, j: usize) -> &'a [f64] {
        let height = self.width + self.rows.len();
        &self.values[j * height..(j + 1) * height]
    }
}

struct Forward<'a, I> {
    stretch: Stretch<'a>,
    supernodes: I,
    above: &'a mut [f64],
}

impl<I: Iterator<Item = usize>> WithSimd for Forward<'_, I> {
    type Output = Result<(), Interrupted>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Stretch { factor, columns, from, own, place, watch } = self.stretch;
        let parts = columns / S::F64_LANES;
        let (own, above) = (S::as_mut_simd_f64s(own).0, S::as_mut_simd_f64s(self.above).0);
        let steps = own.len() / parts;
        // The values in the rows of a supernode, part after part.
        let mut below = Vec::new();
        for s in self.supernodes {
            if let Some(done) = factor.asks_at(s, ASKED_AFTER) {
                watch.ask(done)?;
            }
            let panel = Panel::new(factor, s, from);
            forward(simd, panel, parts, own, &mut below);
            for (i, &r) in panel.rows.iter().enumerate() {
                let k = r as usize - from;
                let x =
                    if k < steps { &mut own[k * parts..] } else { &mut above[place[r as usize] as usize * parts..] };
                for (part, x) in x[..parts].iter_mut().enumerate() {
                    *x = simd.sub_f64s(*x, below[part * panel.rows.len() + i]);
                }
            }
        }
        Ok(())
    }
}

struct Backward<'a, I> {
    stretch: Stretch<'a>,
    supernodes: I,
    above: &'a [f64],
}

impl<I: DoubleEndedIterator<Item = usize>> WithSimd for Backward<'_, I> {
    type Output = Result<(), Interrupted>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Stretch { factor, columns, from, own, place, watch } = self.stretch;
        let parts = columns / S::F64_LANES;
        let (own, above) = (S::as_mut_simd_f64s(own).0, S::as_simd_f64s(self.above).0);
        let steps = own.len() / parts;
        let mut below = Vec::new();
        for s in self.supernodes.rev() {
            if let Some(left) = factor.asks_at(s, ASKED_AFTER) {
                watch.ask(1.0 - left)?;
            }
            let panel = Panel::new(factor, s, from);
            below.clear();
            for part in 0..parts {
                below.extend(panel.rows.iter().map(|&r| {
                    let k = r as usize - from;
                    if k < steps { own[k * parts + part] } else { above[place[r as usize] as usize * parts + part] }
                }));
            }
            backward(simd, panel, parts, own, &below);
        }
        Ok(())
    }
}

/// Eliminates a supernode's steps; what is to be subtracted from its rows in `below`.
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
}

/// Finds a supernode's steps from what is in its rows.
#[inline(always)]
fn backward<S: Simd>(simd: S, panel: Panel, parts: usize, x: &mut [S::f64s], below: &[S::f64s]) {
    let Panel { first, width, rows, .. } = panel;
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
