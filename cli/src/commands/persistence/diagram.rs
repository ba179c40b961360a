//! The persistence diagram and the barcode.
//!
//! Diagram: each pair a point, birth to the right and death up. Minima die above the diagonal and maxima below it, so both
//! fit into one picture; the farther from the diagonal, the more persistent. Classes that never die stand on the frame.
//! Barcode: each pair a bar from birth to death, the longest first.

use super::pairs::{Pair, PairList};
use crate::input::six_digits;
use crate::render::{Anchor, Colour, INK, MAXIMUM, MINIMUM, PAPER, Svg, mix};
use crate::report::table::{counted, thousands};
use std::collections::HashMap;
use topo::Kind;

/// The diagram's side and what is left free round it.
const SIDE: f64 = 640.0;
const LEFT: f64 = 90.0;
const RIGHT: f64 = 30.0;
const TOP: f64 = 50.0;
const BOTTOM: f64 = 60.0;
/// A single pair's radius, and that where there are many.
const POINT: f64 = 2.6;
const FINE: f64 = 1.7;
const MANY: usize = 8000;
const LETTERS: f64 = 14.0;
/// The least and greatest height of a bar with its gap; where there are many the picture grows.
const BAR: (f64, f64) = (4.0, 12.0);
/// Points nearer than this, in pixels, are drawn as one, larger one.
const NEAR: f64 = 2.0;

/// What stands where classes do that never die.
const INFINITY: &str = "∞";

/// The diagram of all directions.
pub(super) fn diagram(lists: &[PairList], title: &str) -> String {
    let mut svg = Svg::new(LEFT + SIDE + RIGHT, TOP + SIDE + BOTTOM);
    let scale = Axis::of(lists);
    let x = |value: f64| LEFT + SIDE * scale.share(value);
    let y = |value: f64| TOP + SIDE * (1.0 - scale.share(value));
    let (right, bottom) = (LEFT + SIDE, TOP + SIDE);
    for tick in scale.ticks() {
        grid_line(&mut svg, [x(tick), TOP], [x(tick), bottom]);
        grid_line(&mut svg, [LEFT, y(tick)], [right, y(tick)]);
        svg.text([x(tick), bottom + 22.0], LETTERS, Anchor::Middle, INK, &six_digits(tick));
        svg.text([LEFT - 10.0, y(tick) + 5.0], LETTERS, Anchor::End, INK, &six_digits(tick));
    }
    svg.line([LEFT, bottom], [right, TOP], 1.0, mix(PAPER, INK, 0.4));
    frame(&mut svg, [LEFT, TOP], [right, bottom]);
    svg.text([right, bottom + 46.0], LETTERS, Anchor::End, INK, "birth");
    svg.text([LEFT - 10.0, TOP - 18.0], LETTERS, Anchor::End, INK, "death");
    svg.text([LEFT + SIDE, TOP - 18.0], LETTERS, Anchor::End, INK, title);
    let shown: usize = lists.iter().map(|list| list.finite().count()).sum();
    let radius = if shown > MANY { FINE } else { POINT };
    let mut legend = LEFT + 20.0;
    for list in lists {
        let colour = colour(list.kind);
        let place = |pair: &Pair| Some([x(pair.birth.to_f64()), y(pair.death?.to_f64())]);
        for (centre, count) in clusters(list.finite().filter_map(place)) {
            // Ten pairs at a place double its disc's area.
            svg.disc(centre, radius * (1.0 + (count as f64).log10()).sqrt(), colour);
        }
        let end = if list.kind == Kind::Minimum { TOP } else { bottom };
        if list.essential().next().is_some() {
            let sign = if list.kind == Kind::Minimum { "" } else { "-" };
            svg.text([right + 6.0, end + 5.0], LETTERS, Anchor::Start, colour, &format!("{sign}{INFINITY}"));
        }
        for pair in list.essential() {
            let centre = [x(pair.birth.to_f64()), end];
            svg.disc(centre, 2.0 * POINT, colour);
            svg.disc(centre, 1.2 * POINT, PAPER);
        }
        svg.disc([legend, TOP - 23.0], 2.0 * POINT, colour);
        svg.text([legend + 12.0, TOP - 18.0], LETTERS, Anchor::Start, INK, &caption(list, list.finite().count()));
        legend += 0.33 * SIDE;
    }
    svg.finish()
}

/// So many of the longest bars of each direction. Those that never end reach the frame.
pub(super) fn barcode(lists: &[PairList], title: &str, bars: usize) -> String {
    let shown: usize = lists.iter().map(|list| list.pairs.len().min(bars)).sum();
    let step = (SIDE / shown.max(1) as f64).clamp(BAR.0, BAR.1);
    let height = step * shown as f64 + 40.0 * lists.len() as f64;
    let mut svg = Svg::new(2.0 * RIGHT + SIDE, RIGHT + height + 0.7 * BOTTOM);
    let scale = Axis::of(lists);
    let x = |value: f64| RIGHT + SIDE * scale.share(value);
    let bottom = RIGHT + height;
    for tick in scale.ticks() {
        grid_line(&mut svg, [x(tick), RIGHT], [x(tick), bottom]);
        svg.text([x(tick), bottom + 22.0], LETTERS, Anchor::Middle, INK, &six_digits(tick));
    }
    frame(&mut svg, [RIGHT, RIGHT], [RIGHT + SIDE, bottom]);
    svg.text([RIGHT + SIDE, RIGHT - 8.0], LETTERS, Anchor::End, INK, title);
    let mut y = RIGHT;
    for list in lists {
        svg.text(
            [RIGHT + 10.0, y + 22.0],
            LETTERS,
            Anchor::Start,
            INK,
            &caption(list, list.finite().take(bars).count()),
        );
        y += 34.0;
        for pair in list.pairs.iter().take(bars) {
            let end = if list.kind == Kind::Minimum { RIGHT + SIDE } else { RIGHT };
            let centre = y + 0.5 * step;
            if pair.death.is_none() {
                let (beside, anchor, sign) = match list.kind {
                    Kind::Minimum => (end + 6.0, Anchor::Start, ""),
                    Kind::Maximum => (end - 6.0, Anchor::End, "-"),
                };
                svg.text([beside, centre + 5.0], LETTERS, anchor, colour(list.kind), &format!("{sign}{INFINITY}"));
            }
            let end = pair.death.map_or(end, |death| x(death.to_f64()));
            svg.line([x(pair.birth.to_f64()), centre], [end, centre], 0.6 * step, colour(list.kind));
            y += step;
        }
        y += 6.0;
    }
    svg.finish()
}

fn caption(list: &PairList, shown: usize) -> String {
    let extrema = if list.kind == Kind::Minimum { "minima" } else { "maxima" };
    match list.count == shown {
        true => format!("{extrema}: {}", counted(shown, "pair", "pairs")),
        false => format!("{extrema}: {} of {}", thousands(shown), counted(list.count, "pair", "pairs")),
    }
}

fn colour(kind: Kind) -> Colour {
    match kind {
        Kind::Minimum => MINIMUM,
        Kind::Maximum => MAXIMUM,
    }
}

fn grid_line(svg: &mut Svg, from: [f64; 2], to: [f64; 2]) {
    svg.line(from, to, 1.0, mix(PAPER, INK, 0.08));
}

fn frame(svg: &mut Svg, [left, top]: [f64; 2], [right, bottom]: [f64; 2]) {
    let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
    for (i, &corner) in corners.iter().enumerate() {
        svg.line(corner, corners[(i + 1) % 4], 1.4, mix(PAPER, INK, 0.6));
    }
}

/// Places that are near one another made one, with their number, the most numerous last.
fn clusters(places: impl Iterator<Item = [f64; 2]>) -> Vec<([f64; 2], usize)> {
    let mut cells: HashMap<[i64; 2], ([f64; 2], usize)> = HashMap::new();
    for place in places {
        cells.entry(place.map(|x| (x / NEAR).round() as i64)).or_insert((place, 0)).1 += 1;
    }
    let mut clusters: Vec<_> = cells.into_values().collect();
    clusters.sort_by(|a, b| a.1.cmp(&b.1).then_with(|| a.0.partial_cmp(&b.0).expect("places on a page are finite")));
    clusters
}

/// The finite values from the least to the greatest, with some air.
#[derive(Clone, Copy, Debug)]
struct Axis {
    low: f64,
    high: f64,
}

impl Axis {
    fn of(lists: &[PairList]) -> Self {
        let pairs = lists.iter().flat_map(|list| &list.pairs);
        let values = pairs.flat_map(|pair| [Some(pair.birth), pair.death]).flatten().map(|value| value.to_f64());
        // So far out that sizes still are finite; what is beyond stands on the frame.
        let values = values.filter(|value| value.abs() < 1e300);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        if low > high {
            return Self { low: 0.0, high: 1.0 };
        }
        let air = if high > low { 0.04 * (high - low) } else { 0.5 * low.abs().max(1.0) };
        Self { low: low - air, high: high + air }
    }

    /// From 0 to 1.
    fn share(self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    /// Round numbers, about six of them.
    fn ticks(self) -> Vec<f64> {
        let raw = (self.high - self.low) / 6.0;
        let power = 10f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|k| k * power).into_iter().find(|&step| step >= raw).unwrap_or(raw);
        let first = (self.low / step).ceil();
        (0..16).map(|i| (first + f64::from(i)) * step).take_while(|&tick| tick <= self.high).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        for (low, high) in [(0.0, 1.0), (-3.7e-9, 5.1e-9), (1e12, 1e12 + 700.0), (-0.5, 1e6)] {
            let ticks = Axis { low, high }.ticks();
            assert!((3..=10).contains(&ticks.len()), "{ticks:?}");
            assert!(ticks.iter().all(|tick| (low..=high).contains(tick)));
        }
        assert_eq!(Axis { low: -0.04, high: 1.04 }.ticks(), [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
    }

    #[test]
    fn places_that_cannot_be_told_apart_are_one() {
        let places = [[10.0, 10.0], [10.2, 10.1], [30.0, 30.0]];
        let counts: Vec<usize> = clusters(places.into_iter()).iter().map(|cluster| cluster.1).collect();
        assert_eq!(counts, [1, 2]);
    }

    #[test]
    fn nothing_at_all_can_be_drawn() {
        assert!(diagram(&[], "").ends_with("</svg>\n"));
        assert!(barcode(&[], "", 9).ends_with("</svg>\n"));
    }
}
