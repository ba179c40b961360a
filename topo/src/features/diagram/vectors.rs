//! Diagrams as vectors of a fixed length, for statistics and learning. Points with an infinite coordinate and essential
//! classes are left out of all of them.

use super::Diagram;
use super::ground::{Point, is_bounded};
use core::ops::RangeInclusive;

impl Diagram {
    /// The entropy of the lifetimes, as parts of their sum: 0 for one point, log n for n that live equally long (Chintakunta,
    /// Gentimis, Gonzalez-Diaz, Jimenez & Krim 2015). O(points).
    pub fn entropy(&self) -> f64 {
        let sum: f64 = self.bounded().map(lifetime).sum();
        let parts = self.bounded().map(|point| lifetime(point) / sum).filter(|&part| part > 0.0);
        // The sum of no floats is -0.
        parts.fold(0.0, |sum, part| sum - part * part.ln())
    }

    /// The persistence landscape (Bubenik 2015) at some levels: for each of the first `count` functions its values, one after the
    /// other. The k-th function is the k-th largest of the tents over the points, each as high as half the lifetime.
    /// O(levels · points).
    ///
    /// ```
    /// let diagram = topo::sublevel(&topo::Path::new(5), &[0.0, 6.0, 2.0, 9.0, 5.0])?.diagram();
    /// assert_eq!(diagram.landscape(2, &[3.0, 5.5, 7.0]), [1.0, 0.5, 2.0, 0.0, 0.5, 0.0]); // of (2, 6) and (5, 9)
    /// # Ok::<(), topo::Error>(())
    /// ```
    pub fn landscape(&self, count: usize, levels: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; count * levels.len()];
        for (place, &level) in levels.iter().enumerate() {
            let mut tents: Vec<f64> =
                self.bounded().map(|point| tent(point, level)).filter(|&height| height > 0.0).collect();
            tents.sort_unstable_by(|a, b| b.total_cmp(a));
            for (function, tent) in tents.into_iter().take(count).enumerate() {
                values[function * levels.len() + place] = tent;
            }
        }
        values
    }

    /// The silhouette (Chazal, Fasy, Lecci, Rinaldo & Wasserman 2014) at some levels: the mean of the tents over the points,
    /// each weighted by a power of its lifetime. O(levels · points).
    pub fn silhouette(&self, power: f64, levels: &[f64]) -> Vec<f64> {
        let weight = |point| lifetime(point).powf(power);
        let sum: f64 = self.bounded().map(weight).sum();
        let mean = |&level: &f64| self.bounded().map(|point| weight(point) * tent(point, level)).sum::<f64>() / sum;
        if sum > 0.0 { levels.iter().map(mean).collect() } else { vec![0.0; levels.len()] }
    }

    /// The persistence image (Adams et al. 2017): a row for each of some lifetimes, shortest first, a column for each of some
    /// births, evenly from one end of a range to the other. Each point adds a Gaussian round (birth, lifetime) of unit mass times
    /// its lifetime; `bandwidth`, the standard deviation, is above 0 (with 0 pixels are NaN). O(pixels · points).
    pub fn image(
        &self,
        births: RangeInclusive<f64>,
        lifetimes: RangeInclusive<f64>,
        [rows, columns]: [usize; 2],
        bandwidth: f64,
    ) -> Vec<f64> {
        let variance = bandwidth * bandwidth;
        let along = |range: &RangeInclusive<f64>, count: usize, place: usize| {
            let step = (range.end() - range.start()) / count.saturating_sub(1).max(1) as f64;
            range.start() + step * place as f64
        };
        let bell = |x: f64| (-x * x / (2.0 * variance)).exp();
        let mut pixels = vec![0.0; rows * columns];
        for point in self.bounded() {
            let mass = lifetime(point) / (core::f64::consts::TAU * variance);
            let row: Vec<f64> = (0..columns).map(|x| bell(along(&births, columns, x) - point.0)).collect();
            for (y, pixels) in pixels.chunks_mut(columns.max(1)).enumerate() {
                let across = mass * bell(along(&lifetimes, rows, y) - lifetime(point));
                pixels.iter_mut().zip(&row).for_each(|(pixel, bell)| *pixel += across * bell);
            }
        }
        pixels
    }

    fn bounded(&self) -> impl Iterator<Item = Point> {
        self.finite.iter().copied().filter(is_bounded)
    }
}

fn lifetime((birth, death): Point) -> f64 {
    (death - birth).abs()
}

/// How far a level is inside the life of a point, 0 outside.
fn tent((birth, death): Point, level: f64) -> f64 {
    (level - birth.min(death)).min(birth.max(death) - level).max(0.0)
}
