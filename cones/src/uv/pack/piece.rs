//! What is moved as one: an island, or a block of small ones.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::{Arc, Mutex, PoisonError};

use num_complex::Complex64;

use super::hull::{Enclosing, convex_hull, enclosing, least};
use super::island_place::{quarter, turn};
use super::options::{PackOptions, Rotations};
use super::outline::Outline;
use super::raster::Shape;

/// So many turns are tried where islands are few, up to [`FEW`]; and so many where they are up to [`SOME`], or more. Time grows with
/// them and with the islands; these keep both near the work that [`search`](super::search) allows. Other numbers were not tried.
const TURNS: [u32; 3] = [32, 16, 8];
const FEW: usize = 8;
const SOME: usize = 64;

/// Extents that differ by less, over the larger one, are the same.
const ROUNDING: f64 = 1e-9;

/// Edges about a centre, in a common unit, and the turns that are worth trying, most promising first.
#[derive(Clone, Debug)]
pub(in crate::uv) struct Piece {
    pub(super) edges: Vec<[Complex64; 2]>,
    pub(super) turns: Vec<Complex64>,
    pub(super) area: f64,
    /// The side of the smallest square that has it in one of its turns.
    pub(super) side: f64,
    pub(super) rasters: Rasters,
}

/// The cells of a piece in all of its turns, where it is packed again and again beside others.
#[derive(Clone, Debug, Default)]
pub(super) struct Rasters(Option<Arc<Mutex<Vec<Raster>>>>);

/// The bits of a grid's scale and of the margin, and the cells there.
type Raster = ([u64; 2], Arc<[Shape]>);

/// The turns of an island, and its rectangle in the turn where that is smallest.
pub(super) struct Rectangle {
    pub(super) turn: Complex64,
    /// The lower left corner of the turned island.
    pub(super) low: Complex64,
    pub(super) extent: [f64; 2],
}

impl Piece {
    /// An island, with its [tilt](super::tilt), among so many.
    pub(super) fn new(outline: &Outline, tilt: Option<f64>, options: &PackOptions, count: usize) -> Self {
        let hull = hull(&outline.edges);
        let unturned = || unturned(&hull, tilt, options);
        let turns = match options.rotations {
            // All alike: 105 models are filled .500 on the mean, .491 if each is turned as little as it takes.
            Rotations::None if options.align => unturned().into_iter().map(|turn| lying(&hull, turn)).collect(),
            Rotations::None => unturned(),
            Rotations::Quarter => quarters(&unturned()),
            Rotations::Any => turns(&hull, tilt, count),
        };
        let side = |&turn: &Complex64| {
            let [_, extent] = bounds(&hull, turn);
            extent.re.max(extent.im)
        };
        let side = turns.iter().map(side).fold(f64::INFINITY, f64::min);
        Self { edges: outline.edges.clone(), turns, area: outline.area, side, rasters: Rasters::default() }
    }

    /// The first of the turns in which the smallest square has it, and its lower left corner then.
    pub(super) fn in_smallest_square(&self) -> (Complex64, Complex64) {
        let hull = hull(&self.edges);
        let side = |turn| {
            let [low, extent] = bounds(&hull, turn);
            (extent.re.max(extent.im), turn, low)
        };
        let (_, turn, low) =
            self.turns.iter().map(|&turn| side(turn)).min_by(|a, b| a.0.total_cmp(&b.0)).expect("there is a turn");
        (turn, low)
    }

    /// A rectangle about its centre; `area` is what it holds.
    pub(super) fn rectangle(extent: [f64; 2], area: f64, rotations: Rotations) -> Self {
        let [w, h] = extent.map(|x| 0.5 * x);
        let corners = [[-w, -h], [w, -h], [w, h], [-w, h]].map(|[x, y]| Complex64::new(x, y));
        let edges = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]).collect();
        let turns = if rotations == Rotations::None { vec![quarter(0)] } else { vec![quarter(0), quarter(1)] };
        Self { edges, turns, area, side: extent[0].max(extent[1]), rasters: Rasters::default() }
    }
}

impl Rasters {
    /// None yet, but they will be kept.
    pub(super) fn kept() -> Self {
        Self(Some(Arc::default()))
    }

    /// Those for a grid, as they were kept or made.
    pub(super) fn of<E>(
        &self,
        scale: f64,
        margin: f64,
        make: impl FnOnce() -> Result<Arc<[Shape]>, E>,
    ) -> Result<Arc<[Shape]>, E> {
        let Some(kept) = &self.0 else { return make() };
        let grid = [scale.to_bits(), margin.to_bits()];
        let all = || kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, shapes)) = all().iter().find(|(other, _)| *other == grid) {
            return Ok(shapes.clone());
        }
        let shapes = make()?;
        all().push((grid, shapes.clone()));
        Ok(shapes)
    }
}

/// The smallest rectangle about an island, lying where it may be turned.
pub(super) fn rectangle(outline: &Outline, options: &PackOptions) -> Rectangle {
    let hull = hull(&outline.edges);
    let turn = match options.rotations {
        Rotations::Any => turned_to(least(&enclosing(&hull), Enclosing::area)),
        _ => unturned(&hull, outline.tilt(), options)[0],
    };
    let is_kept = options.rotations == Rotations::None && !options.align;
    let turn = if is_kept { turn } else { lying(&hull, turn) };
    let [low, extent] = bounds(&hull, turn);
    Rectangle { turn, low, extent: [extent.re, extent.im] }
}

fn hull(edges: &[[Complex64; 2]]) -> Vec<Complex64> {
    convex_hull(edges.iter().flatten().copied().collect())
}

/// The turns of an island that is turned no further than it has to be: as it lies, or without its tilt. One without straight sides lies as well in
/// the smallest rectangle or square as anyhow.
fn unturned(hull: &[Complex64], tilt: Option<f64>, options: &PackOptions) -> Vec<Complex64> {
    match tilt {
        _ if !options.align => vec![quarter(0)],
        Some(tilt) => vec![turned_to(tilt)],
        None => {
            let found = enclosing(hull);
            [Enclosing::area, Enclosing::side].map(|measure| turned_to(least(&found, measure))).to_vec()
        }
    }
}

/// The turn, or a quarter on, after which it is not higher than wide by more than rounding: in its smallest square it mostly is as high as wide.
fn lying(hull: &[Complex64], turn: Complex64) -> Complex64 {
    let [_, extent] = bounds(hull, turn);
    if extent.im > extent.re * (1.0 + ROUNDING) { quarter(1) * turn } else { turn }
}

/// The turn after which a rectangle at an angle is upright.
fn turned_to(angle: f64) -> Complex64 {
    turn(-angle)
}

/// The one without its tilt, those of the smallest square and the rectangles of least area and width, and evenly many between.
fn turns(hull: &[Complex64], tilt: Option<f64>, count: usize) -> Vec<Complex64> {
    let found = enclosing(hull);
    let number = TURNS[usize::from(count > FEW) + usize::from(count > SOME)];
    let square = least(&found, Enclosing::side);
    let area = least(&found, Enclosing::area);
    let even = (0..number / 4).map(|k| area - f64::from(k) * TAU / f64::from(number));
    let mut angles: Vec<f64> = Vec::new();
    for angle in tilt.into_iter().chain([square, area, least(&found, Enclosing::width)]).chain(even) {
        let angle = angle.rem_euclid(FRAC_PI_2);
        if angles.iter().all(|other| (other - angle).abs() > 1e-6) {
            angles.push(angle);
        }
    }
    quarters(&angles.into_iter().map(turned_to).collect::<Vec<_>>())
}

/// The same and on by one, two and three quarters: all of one quarter first, so that the first few are the different ones.
fn quarters(turns: &[Complex64]) -> Vec<Complex64> {
    (0..4).flat_map(|k| turns.iter().map(move |turn| quarter(k) * turn)).collect()
}

/// The lower left corner and the extent after a turn.
fn bounds(points: &[Complex64], turn: Complex64) -> [Complex64; 2] {
    if points.is_empty() {
        return [Complex64::default(); 2];
    }
    let turned = || points.iter().map(|z| z * turn);
    let low = turned().fold([f64::INFINITY; 2], |low, z| [low[0].min(z.re), low[1].min(z.im)]);
    let high = turned().fold([f64::NEG_INFINITY; 2], |high, z| [high[0].max(z.re), high[1].max(z.im)]);
    [Complex64::new(low[0], low[1]), Complex64::new(high[0] - low[0], high[1] - low[1])]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Its lower edge falls by an ulp, so that the best rectangle is at a right angle.
    #[test]
    fn a_rectangle_lies_about_its_island() {
        let corners = [
            Complex64::new(-0.009740896852561517, -0.0019715741005198644),
            Complex64::new(0.00939518118789823, -0.0019715741005198652),
            Complex64::new(0.009740896852561519, 0.0017004090011962824),
            Complex64::new(-0.007298445106530472, 0.0019715741005198652),
        ];
        let edges = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]).collect();
        let outline = Outline { edges, centre: [0.0; 2], area: 0.0 };
        for rotations in [Rotations::None, Rotations::Quarter, Rotations::Any] {
            let options = PackOptions { rotations, ..PackOptions::default() };
            let Rectangle { turn, low, extent } = rectangle(&outline, &options);
            assert!(extent[0] >= extent[1]);
            for z in corners.map(|z| z * turn - low) {
                assert!((0.0..=extent[0]).contains(&z.re) && (0.0..=extent[1]).contains(&z.im), "{z}");
            }
        }
    }

    #[test]
    fn cells_are_kept_for_their_own_grid_and_margin() {
        let piece = Piece::rectangle([2.0, 1.0], 2.0, Rotations::None);
        let kept = Rasters::kept();
        let grids = [(8.0, 1.0), (8.0, 2.0), (16.0, 2.0)];
        let mut made = 0;
        for (scale, margin) in grids.into_iter().chain(grids) {
            let mut shape = || {
                made += 1;
                Ok::<_, ()>(Arc::from([Shape::new(&piece.edges, quarter(0), scale, margin)]))
            };
            let anew = shape().unwrap();
            let shapes = kept.of(scale, margin, shape).unwrap();
            assert_eq!((shapes[0].size, shapes[0].pad), (anew[0].size, anew[0].pad));
        }
        assert_eq!(made, 6 + 3);
    }
}
