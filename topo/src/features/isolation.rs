//! How far it is from an extremum to the next vertex that is more extreme.
//!
//! Among peaks this is their *topographic isolation*: a summit that stands alone, be it ever so low. It asks where the
//! vertices are, so it is for grids; distances are Euclidean and a step along an axis is 1. Round each extremum ever larger cubes
//! are searched. Of the extrema that have to search beyond r no two are nearer to each other than that, so there are few
//! of them: O(n log n) in all for n vertices.

use crate::domain::{Domain, Grid};
use crate::error::Error;
use crate::filtration::{Direction, Falling, Filtration, Kind, NanPolicy, Rising};
use crate::scalar::Scalar;
use core::ops::RangeInclusive;

/// For some extrema of a field on a grid the distance from each to the nearest vertex that comes before it in the order of
/// their direction, connected to it or not; `None` for the first of all. NaN is passed over.
///
/// ```
/// use topo::{Connectivity, Grid, Kind};
///
/// let heights = [
///     4, 0, 0, 0, 0, //
///     0, 0, 0, 7, 0, //
///     0, 0, 0, 0, 9,
/// ];
/// let grid = Grid::new([3, 5], Connectivity::Axis);
/// let peaks: Vec<usize> = topo::superlevel(&grid, &heights)?.ranked().iter().map(|peak| peak.extremum).collect();
/// let isolation = topo::isolation(&grid, &heights, Kind::Maximum, &peaks)?;
/// assert_eq!(isolation, [None, Some(2f64.sqrt()), Some(10f64.sqrt())]); // of 9, 7 and 4
/// # Ok::<(), topo::Error>(())
/// ```
///
/// # Errors
/// If the field has not one value for every vertex.
///
/// # Panics
/// If an extremum is not on the grid.
pub fn isolation<const D: usize, S: Scalar>(
    grid: &Grid<D>,
    field: &[S],
    kind: Kind,
    extrema: &[usize],
) -> Result<Vec<Option<f64>>, Error> {
    match kind {
        Kind::Minimum => of_each::<D, S, Rising>(grid, field, extrema),
        Kind::Maximum => of_each::<D, S, Falling>(grid, field, extrema),
    }
}

fn of_each<const N: usize, S: Scalar, D: Direction>(
    grid: &Grid<N>,
    field: &[S],
    extrema: &[usize],
) -> Result<Vec<Option<f64>>, Error> {
    let filtration = Filtration::<S, D>::new(field, grid.vertex_count(), NanPolicy::Mask)?;
    let isolation = |&extremum: &usize| {
        let precedes = |vertex| filtration.precedes(vertex as u32, extremum as u32);
        nearest(grid, extremum, precedes).map(|square| (square as f64).sqrt())
    };
    Ok(extrema.iter().map(isolation).collect())
}

/// The square of the distance to the nearest vertex for which something holds.
fn nearest<const D: usize>(grid: &Grid<D>, from: usize, holds: impl Fn(usize) -> bool) -> Option<u64> {
    let reach = grid.reach(from);
    let farthest = reach.iter().map(|axis| axis.end().max(&-axis.start()).unsigned_abs() as u64).max().unwrap_or(0);
    let mut best = None;
    for radius in 1..=farthest {
        // Nothing on the cube of this radius is nearer than its faces.
        if best.is_some_and(|best| best <= radius * radius) {
            break;
        }
        on_cube(&reach, radius as isize, |offset| {
            let square = offset.iter().map(|&step| (step * step) as u64).sum();
            if best.is_none_or(|best| square < best) && holds(grid.at_offset(from, offset)) {
                best = Some(square);
            }
        });
    }
    best
}

/// Visits the offsets within reach whose largest step is the radius.
fn on_cube([z, y, x]: &[RangeInclusive<isize>; 3], radius: isize, mut visit: impl FnMut([isize; 3])) {
    for dz in within(z, radius) {
        for dy in within(y, radius) {
            if dz.abs() == radius || dy.abs() == radius {
                within(x, radius).for_each(|dx| visit([dz, dy, dx]));
            } else {
                [-radius, radius].into_iter().filter(|dx| x.contains(dx)).for_each(|dx| visit([dz, dy, dx]));
            }
        }
    }
}

fn within(reach: &RangeInclusive<isize>, radius: isize) -> RangeInclusive<isize> {
    *reach.start().max(&-radius)..=*reach.end().min(&radius)
}
