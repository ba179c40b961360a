//! What a surface and its layout are coloured by: a checkerboard, islands, or values with a scale that a legend shows.

use super::colour::{CHECKER, Colour, INK, ISLANDS, MAXIMUM, MINIMUM, PAPER, mix, srgb};
use super::scene::Scene;

/// Ratios of areas up to this, and from its inverse on, have colours of their own, as in the paper's Fig. 1.
const MOST_AREA: f64 = 10.0;
/// The same of σ₁/σ₂.
const MOST_STRETCH: f64 = 2.0;
/// The share of the values at each end that share one colour, so that few do not bleach all others.
const TAIL: f64 = 0.02;
/// Bands of colour from the least value of a field to the greatest, so that level lines are seen.
const BANDS: f64 = 15.0;
/// Colours of a scale.
const STEPS: usize = 256;
/// A surface without anything on it.
const PLAIN: Colour = srgb(0xc4, 0xcb, 0xd4);

/// Blue where areas shrink, pale where they are kept, red where they grow: as the page has it.
const DIVERGING: [[u8; 3]; 5] =
    [[0x24, 0x3f, 0xb5], [0x5b, 0xa3, 0xe6], [0xf3, 0xf2, 0xec], [0xf2, 0xa0, 0x5a], [0xb8, 0x1d, 0x24]];
const GROWING: [[u8; 3]; 4] = [[0xf3, 0xf2, 0xec], [0xf4, 0xc8, 0x6a], [0xdb, 0x5c, 0x5c], [0x7a, 0x1f, 0x6d]];

/// What a surface is coloured by.
#[derive(Clone, Debug)]
pub(crate) enum Paint {
    Checker,
    /// Each island of the layout in its colour.
    Islands,
    Plain,
    Values {
        scale: Scale,
        /// For each triangle where the values of its corners are on the scale, from 0 to 1; NaN where there is none.
        places: Vec<[f64; 3]>,
    },
}

/// Colours of values, with the marks of a legend.
#[derive(Clone, Debug)]
pub(crate) struct Scale {
    colours: Vec<Colour>,
    /// Places on the scale with what is written there.
    pub(crate) marks: Vec<(f64, String)>,
    pub(crate) title: &'static str,
}

impl Paint {
    /// The ratio of areas of each triangle of a map, given by its logarithm: 0 where it is ideal.
    pub(crate) fn area(log_area: &[f64]) -> Self {
        let most = MOST_AREA.ln();
        let place = |&log: &f64| [(0.5 + 0.5 * log / most).clamp(0.0, 1.0); 3];
        let mark = |ratio: f64| (0.5 + 0.5 * ratio.ln() / most, ratio.to_string());
        let marks = [0.1, 0.3, 1.0, 3.0, 10.0].map(mark).to_vec();
        let scale = Scale { colours: ramp(&DIVERGING), marks, title: "area on the map over area; ideal 1" };
        Self::Values { scale, places: log_area.iter().map(place).collect() }
    }

    /// σ₁/σ₂ of each triangle of a map: 1 where it is ideal.
    pub(crate) fn stretch(stretch: &[f64]) -> Self {
        let most = MOST_STRETCH.ln();
        let place = |&stretch: &f64| [(stretch.ln() / most).clamp(0.0, 1.0); 3];
        let marks = [1.0, 1.2, 1.5, 2.0].map(|ratio: f64| (ratio.ln() / most, ratio.to_string())).to_vec();
        let scale = Scale { colours: ramp(&GROWING), marks, title: "longest over shortest stretch; ideal 1" };
        Self::Values { scale, places: stretch.iter().map(place).collect() }
    }

    /// Values at the vertices of triangles, in bands from the least to the greatest, the tails cut off, which the marks say; NaN where
    /// there is none.
    pub(crate) fn field(values: &[f64], triangles: &[[u32; 3]], title: &'static str) -> Self {
        let (low, high) = span(values);
        let at = |v: u32| {
            let value = values[v as usize];
            if value.is_nan() { value } else { share(value, low, high) }
        };
        let lower = if values.iter().any(|&value| value < low) { "<= " } else { "" };
        let higher = if values.iter().any(|&value| value > high) { ">= " } else { "" };
        let mark = |(place, sign)| (place, format!("{sign}{}", rounded(low + place * (high - low), high - low)));
        let scale =
            Scale { colours: banded(), marks: [(0.0, lower), (0.5, ""), (1.0, higher)].map(mark).to_vec(), title };
        Self::Values { scale, places: triangles.iter().map(|t| t.map(at)).collect() }
    }

    /// Its scale, if there is one.
    pub(crate) fn scale(&self) -> Option<&Scale> {
        if let Self::Values { scale, .. } = self { Some(scale) } else { None }
    }

    /// The colour at a place of a triangle of a scene.
    pub(super) fn brush<'a>(&'a self, scene: &'a Scene) -> impl Fn(usize, [f64; 3]) -> Colour + 'a {
        let checker = scene.checker();
        let islands = if matches!(self, Self::Islands) { scene.islands().0 } else { Vec::new() };
        move |t, w| match self {
            Self::Checker => checker.colour([0, 1].map(|i| (0..3).map(|k| w[k] * scene.uv[t][k][i]).sum())),
            Self::Islands => mix(CHECKER[0], ISLANDS[islands[t] % ISLANDS.len()], 0.85),
            Self::Plain => PLAIN,
            Self::Values { scale, places } => scale.colour((0..3).map(|k| w[k] * places[t][k]).sum()),
        }
    }
}

impl Scale {
    /// The colour at a place from 0 to 1; grey where there is none.
    pub(crate) fn colour(&self, place: f64) -> Colour {
        if place.is_nan() {
            return mix(PAPER, INK, 0.3);
        }
        self.colours[(place.clamp(0.0, 1.0) * (self.colours.len() - 1) as f64).round() as usize]
    }
}

/// Between colours as they stand in files, as browsers do it.
fn ramp(ends: &[[u8; 3]]) -> Vec<Colour> {
    let at = |k: usize| {
        let along = k as f64 / (STEPS - 1) as f64 * (ends.len() - 1) as f64;
        let first = (along as usize).min(ends.len() - 2);
        let channel = |i: usize| {
            let [a, b] = [ends[first][i], ends[first + 1][i]].map(f64::from);
            (a + (along - first as f64) * (b - a)).round() as u8
        };
        srgb(channel(0), channel(1), channel(2))
    };
    (0..STEPS).map(at).collect()
}

/// From pale blue over white to pale red, so that marks stand out.
fn banded() -> Vec<Colour> {
    let colour = |k: usize| {
        let band = (BANDS * k as f64 / STEPS as f64).floor() / (BANDS - 1.0);
        let end = if band < 0.5 { MINIMUM } else { MAXIMUM };
        mix(PAPER, end, 0.62 * (2.0 * band - 1.0).abs())
    };
    (0..STEPS).map(colour).collect()
}

/// Between which values a scale runs.
fn span(values: &[f64]) -> (f64, f64) {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted.get((share * sorted.len().saturating_sub(1) as f64) as usize).copied().unwrap_or(0.0);
    (at(TAIL), at(1.0 - TAIL))
}

fn share(value: f64, low: f64, high: f64) -> f64 {
    if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 }
}

/// A number with as many decimals as a range asks for.
fn rounded(value: f64, range: f64) -> String {
    let decimals = if range > 0.0 { (2.0 - range.log10().floor()).clamp(0.0, 9.0) as usize } else { 2 };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::super::colour::encode;
    use super::*;

    #[test]
    fn a_field_s_colours_are_shared_out_between_the_tails() {
        let mut values: Vec<f64> = (0..101).map(f64::from).collect();
        values[100] = 1e9;
        let (low, high) = span(&values);
        let shares: Vec<f64> = values.iter().map(|&value| share(value, low, high)).collect();
        assert_eq!((shares[0], shares[50], shares[100]), (0.0, 0.5, 1.0));
        assert_eq!(span(&[7.0, f64::NAN, 7.0]), (7.0, 7.0));
        assert_eq!(share(7.0, 7.0, 7.0), 0.5);
    }

    #[test]
    fn the_marks_of_a_field_say_where_tails_are_cut_off() {
        let marks = |values: &[f64]| {
            let Paint::Values { scale, .. } = Paint::field(values, &[], "") else { panic!("it has values") };
            scale.marks.into_iter().map(|(_, text)| text).collect::<Vec<_>>()
        };
        let mut values: Vec<f64> = (0..101).map(f64::from).collect();
        assert_eq!(marks(&values), ["<= 2.0", "50.0", ">= 98.0"]);
        values.iter_mut().take(3).for_each(|value| *value = 2.0);
        assert_eq!(marks(&values), ["2.0", "50.0", ">= 98.0"]);
        assert_eq!(marks(&[1.0, f64::NAN, 1.0]), ["1.00", "1.00", "1.00"]);
    }

    #[test]
    fn kept_areas_are_pale_and_others_blue_or_red() {
        let Paint::Values { scale, places } = Paint::area(&[0.0, -9.0, 9.0]) else { panic!("it has values") };
        let [kept, smaller, larger] = [0, 1, 2].map(|t| encode(scale.colour(places[t][0])));
        assert!(kept.iter().all(|&c| c > 225), "{kept:?}");
        assert!(smaller[2] > 2 * smaller[0] && larger[0] > 2 * larger[2], "{smaller:?} {larger:?}");
        assert_eq!(scale.marks[2], (0.5, "1".to_owned()));
    }
}
