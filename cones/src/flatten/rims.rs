//! Vertices at the rim of a hole narrowed to less than a full turn, so that nothing has to be cut off there.
//!
//! A flat metric says nothing of the angle at a boundary vertex. At the jagged rims and slits of a scan it often is more than 2π, in space
//! already: then the first and the last triangles there lie over each other in every layout, and a few triangles would be cut off. But
//! nothing depends on where vertices of the true boundary lie. So a patch round each such *wound* vertex is shaped anew ([`untangle`](super::untangle)):
//! its triangles are to keep the shape that they have in the layout, but for narrower angles at the wound vertex. Inner vertices move, those of the
//! boundary, and (rigidly) those of seams; the patch's rim stays. How much narrower the angles are to be is adapted until they sum to
//! [`GOAL`]. What would bend too much stays wound, and what overlaps there is cut off.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use geom::{FaceId, HalfedgeId, Id, Mesh, Metric, Sides, VertexId, Watch, WedgeId};
use num_complex::Complex64;

use super::fold_over::{Fans, Fixed, Moved, Untangler};
use super::layout::Layout;
use super::relax::stretch;
use super::scaling::Scaling;

/// The angle that wound vertices are to have. What is a little less than 2π leaves more triangles overlapping further out: of the dragon's 403 islands
/// 290 are left with .1 less, 303 with .03 (and half the stretch allowed).
const GOAL: f64 = 2.0 * PI - 0.1;
/// A patch reaches so many rings round what is wound, larger ones where smaller ones are not enough.
const RINGS: [usize; 2] = [1, 2];
/// Larger patches are not tried.
const MOST_FACES: usize = 1024;
/// So often the angles that are asked for are adapted,
const ROUNDS: usize = 12;
/// by this power of what they are off,
const POWER: f64 = 2.0;
/// to this share of themselves at least.
const LEAST_SHARE: f64 = 0.1;
/// No triangle is stretched more, σ₁/σ₂ against the shape that it had in the layout.
const MOST_STRETCH: f64 = 10.0;
/// A vertex that is wound no more may cost so much σ₁/σ₂, a vertex's mean area counting as one.
const PRICE: f64 = 0.3;

/// Narrows rim vertices of more than a full turn in a layout, in place, as far as that goes; returns the number of triangles in patches that were
/// shaped anew.
pub(crate) fn narrow_rims(
    input: &Mesh,
    metric: &Metric,
    scaling: &Scaling,
    fixed: &Fixed,
    layout: &mut Layout,
    watch: Watch,
) -> usize {
    let rim = input.vertices().filter(|&v| input.is_boundary_vertex(v));
    let mut left: Vec<VertexId> = rim.filter(|&v| is_wound(input, layout, v)).collect();
    if left.is_empty() {
        return 0;
    }
    let area: f64 = input.faces().map(|f| metric.sides(input, f).area()).sum();
    let price = PRICE * area / input.vertex_count() as f64;
    let Ok(mut untangler) = Untangler::new(input, metric, scaling, fixed, layout, watch) else { return 0 };
    let mut shaped = 0;
    for rings in RINGS {
        let faces: Vec<FaceId> = left.iter().flat_map(|&v| input.outgoing(v)).map(|h| input.face(h)).collect();
        for piece in untangler.pieces(&faces, rings) {
            // A part that is all patch weighs nothing in the whole.
            let price = if piece.len() == input.face_count() { f64::INFINITY } else { price };
            let narrowing = Narrowing::new(&untangler, (input, metric), &piece);
            if narrowing.is_some_and(|narrowing| narrowing.run(&mut untangler, price, watch)) {
                shaped += piece.len();
            }
        }
        left.retain(|&v| is_wound(input, untangler.layout(), v));
    }
    shaped
}

/// The signed angle of the corner at a halfedge's tail.
fn angle(input: &Mesh, layout: &Layout, h: HalfedgeId) -> f64 {
    let at = layout.corner(h);
    let [next, last] = [input.next(h), input.prev(h)].map(|h| layout.corner(h) - at);
    (last * next.conj()).arg()
}

/// The sums of angles in the wedges of some halfedges' tails.
fn sums(input: &Mesh, layout: &Layout, some: impl Iterator<Item = HalfedgeId>) -> BTreeMap<WedgeId, f64> {
    let mut sums = BTreeMap::new();
    some.for_each(|h| *sums.entry(layout.cut.wedge(h)).or_insert(0.0) += angle(input, layout, h));
    sums
}

fn is_more_than_a_turn(sum: f64) -> bool {
    sum > 2.0 * PI
}

/// Whether a copy of a boundary vertex has more than a full turn.
fn is_wound(input: &Mesh, layout: &Layout, v: VertexId) -> bool {
    sums(input, layout, input.outgoing(v)).into_values().any(is_more_than_a_turn)
}

/// A triangle as it lay in the layout at first.
struct Before {
    corners: [Complex64; 3],
    wedges: [WedgeId; 3],
}

impl Before {
    fn sides(&self) -> Sides {
        let [a, b, c] = self.corners;
        Sides([b - a, c - b, a - c].map(Complex64::norm))
    }

    fn angles(&self) -> [f64; 3] {
        std::array::from_fn(|k| {
            let [at, next, last] = [k, k + 1, k + 2].map(|k| self.corners[k % 3]);
            ((last - at) * (next - at).conj()).arg()
        })
    }

    /// The shape with some angles multiplied by a share; what that leaves goes to the others. The area stays.
    fn narrowed(&self, shares: &BTreeMap<WedgeId, f64>) -> Sides {
        let shares = self.wedges.map(|w| shares.get(&w));
        let others = shares.iter().filter(|share| share.is_none()).count();
        if others == 0 || others == 3 {
            return self.sides();
        }
        let mut angles = self.angles();
        angles.iter_mut().zip(shares).for_each(|(angle, share)| *angle *= share.unwrap_or(&1.0));
        let rest = (PI - angles.iter().sum::<f64>()) / others as f64;
        angles.iter_mut().zip(shares).filter(|(_, share)| share.is_none()).for_each(|(angle, _)| *angle += rest);
        // Each side has the sine of the angle opposite.
        let sines = Sides([2, 0, 1].map(|k| angles[k].sin()));
        let scale = (self.sides().area() / sines.area()).sqrt();
        Sides(sines.0.map(|side| side * scale))
    }
}

/// A patch round wound vertices.
struct Narrowing<'a> {
    input: &'a Mesh,
    metric: &'a Metric,
    /// Ascending.
    faces: &'a [FaceId],
    before: Vec<Before>,
}

impl<'a> Narrowing<'a> {
    /// None if the patch is too large or something is folded over there.
    fn new(untangler: &Untangler, (input, metric): (&'a Mesh, &'a Metric), faces: &'a [FaceId]) -> Option<Self> {
        let wedges = |f| input.sides(f).map(|h| untangler.layout().cut.wedge(h));
        let before = |&f: &FaceId| Before { corners: untangler.positions(f), wedges: wedges(f) };
        let before: Vec<Before> = faces.iter().take(MOST_FACES + 1).map(before).collect();
        let is_upright = before.iter().flat_map(Before::angles).all(|angle| angle > 0.0);
        (is_upright && faces.len() <= MOST_FACES).then_some(Self { input, metric, faces, before })
    }

    /// The sums of angles in the patch's wedges at the boundary.
    fn sums(&self, layout: &Layout) -> BTreeMap<WedgeId, f64> {
        let sides = self.faces.iter().flat_map(|&f| self.input.sides(f));
        sums(self.input, layout, sides.filter(|&h| self.input.is_boundary_vertex(self.input.tail(h))))
    }

    /// σ₁/σ₂ against the shapes in space, by area.
    fn cost(&self, untangler: &Untangler) -> f64 {
        let cost = |&f: &FaceId| {
            let sides = self.metric.sides(self.input, f);
            stretch(sides, untangler.positions(f)).map(|[stretch, _]| sides.area() * stretch)
        };
        self.faces.iter().filter_map(cost).sum()
    }

    /// Shapes the patch anew so that fewer wedges are wound, for a price each; returns whether that was possible.
    fn run(&self, untangler: &mut Untangler, price: f64, watch: Watch) -> bool {
        let wound = |sums: &BTreeMap<WedgeId, f64>| sums.values().filter(|&&sum| is_more_than_a_turn(sum)).count();
        let wedges = || self.before.iter().flat_map(|before| before.wedges);
        let positions = |layout: &Layout| -> Moved { wedges().map(|w| (w, layout.position[w.index()])).collect() };
        let mut sums = self.sums(untangler.layout());
        let (first, cost) = (wound(&sums), self.cost(untangler));
        let (mut least, mut best) = (first, positions(untangler.layout()));
        // The share of its angles that each wedge is asked to have.
        let mut shares: BTreeMap<WedgeId, f64> = BTreeMap::new();
        for _ in 0..ROUNDS {
            let power = if shares.is_empty() { 1.0 } else { POWER };
            for (w, sum) in sums {
                if is_more_than_a_turn(sum) || shares.contains_key(&w) {
                    let share = shares.entry(w).or_insert(1.0);
                    *share = (*share * (GOAL / sum).powf(power)).clamp(LEAST_SHARE, 1.0);
                }
            }
            let reference = |_: &Untangler, f: FaceId| {
                let k = self.faces.binary_search(&f).expect("it is of the patch");
                self.before[k].narrowed(&shares)
            };
            let is_shaped = untangler.try_shaping(self.faces, Fans::Free, reference, watch).is_some();
            if !is_shaped || self.most_stretch(untangler) > MOST_STRETCH {
                break;
            }
            sums = self.sums(untangler.layout());
            let now = wound(&sums);
            let is_worth_it = self.cost(untangler) - cost <= price * first.saturating_sub(now) as f64;
            if now < least && is_worth_it {
                (least, best) = (now, positions(untangler.layout()));
            }
            if now == 0 {
                break;
            }
        }
        untangler.put_back(best);
        least < first
    }

    /// The largest σ₁/σ₂ against the shapes at first.
    fn most_stretch(&self, untangler: &Untangler) -> f64 {
        let stretch = |(&f, before): (&FaceId, &Before)| {
            stretch(before.sides(), untangler.positions(f)).map_or(f64::INFINITY, |[stretch, _]| stretch)
        };
        self.faces.iter().zip(&self.before).map(stretch).fold(1.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flatten::flattened::Flattened;
    use crate::uv::overlaps;
    use geom::{VertexData, shapes::Shape};

    /// Rings of triangles round vertex 0, which is on the boundary and has the angle given, about.
    fn fan(turn: f64, rings: usize) -> Shape {
        let steps = 14;
        let mut points = vec![[0.0, 0.0, 0.05 * turn]];
        for ring in 1..=rings {
            let at = |k: usize| turn * k as f64 / steps as f64;
            points.extend((0..=steps).map(|k| [ring as f64 * at(k).cos(), ring as f64 * at(k).sin(), 0.1 * at(k)]));
        }
        let index = |ring: usize, k: usize| if ring == 0 { 0 } else { (1 + (ring - 1) * (steps + 1) + k) as u32 };
        let mut triangles = Vec::new();
        for k in 0..steps {
            triangles.push([0, index(1, k), index(1, k + 1)]);
            for ring in 1..rings {
                triangles.push([index(ring, k), index(ring + 1, k), index(ring + 1, k + 1)]);
                triangles.push([index(ring, k), index(ring + 1, k + 1), index(ring, k + 1)]);
            }
        }
        Shape { points, triangles }
    }

    /// The number of triangles shaped anew, the layouts before and after, and what was laid out.
    fn narrowed(shape: &Shape) -> (usize, Layout, Flattened) {
        let mut flat = Flattened::new(shape, &[]);
        let before = flat.layout.clone();
        let is_cone = VertexData::constant(flat.mesh.vertex_count(), false);
        let fixed = Fixed { is_cone, is_side: None, may_loosen: true };
        let shaped = narrow_rims(&flat.mesh, &flat.metric, &flat.scaling, &fixed, &mut flat.layout, Watch::NONE);
        (shaped, before, flat)
    }

    fn triangles(flat: &Flattened, layout: &Layout) -> Vec<[[f64; 2]; 3]> {
        let corner = |h| [layout.corner(h).re, layout.corner(h).im];
        flat.mesh.faces().map(|f| flat.mesh.sides(f).map(corner)).collect()
    }

    #[test]
    fn a_rim_vertex_of_more_than_a_turn_is_narrowed_until_nothing_overlaps() {
        let (shaped, before, flat) = narrowed(&fan(2.15 * PI, 1));
        assert!(is_wound(&flat.mesh, &before, VertexId(0)));
        assert!(!overlaps(&triangles(&flat, &before)).pairs.is_empty());
        assert_eq!(shaped, flat.mesh.face_count());
        assert!(!is_wound(&flat.mesh, &flat.layout, VertexId(0)));
        assert!(overlaps(&triangles(&flat, &flat.layout)).pairs.is_empty());
        for f in flat.mesh.faces() {
            let [before, after] = [&before, &flat.layout].map(|layout| Before {
                corners: flat.mesh.sides(f).map(|h| layout.corner(h)),
                wedges: flat.mesh.sides(f).map(|h| layout.cut.wedge(h)),
            });
            assert!(after.angles().iter().all(|&angle| angle > 0.0), "no triangle is flipped");
            assert!(stretch(before.sides(), after.corners).is_some_and(|[stretch, _]| stretch < 2.0));
        }
    }

    #[test]
    fn what_is_not_wound_or_would_bend_too_much_stays_to_the_bit() {
        for (turn, rings) in [(1.95 * PI, 2), (2.6 * PI, 12)] {
            let (shaped, before, flat) = narrowed(&fan(turn, rings));
            assert_eq!(is_wound(&flat.mesh, &before, VertexId(0)), turn > 2.0 * PI);
            assert_eq!(shaped, 0);
            assert_eq!(flat.layout.position, before.position);
        }
    }

    #[test]
    fn a_narrowed_shape_has_the_angle_asked_for_and_its_area() {
        let corners = [[0.0, 0.0], [2.0, 0.3], [0.4, 1.1]].map(|[x, y]| Complex64::new(x, y));
        let before = Before { corners, wedges: [0, 1, 2].map(WedgeId) };
        for narrow in [vec![0], vec![1, 2]] {
            let shares = narrow.iter().map(|&w| (WedgeId(w), 0.6)).collect();
            let sides = before.narrowed(&shares);
            assert!((sides.area() / before.sides().area() - 1.0).abs() < 1e-12);
            let corners = [0, 1, 2].map(|k| {
                let steps = sides.unfold().into_iter().take(k).map(|[x, y]| Complex64::new(x, y));
                steps.sum::<Complex64>()
            });
            let after = Before { corners, wedges: before.wedges }.angles();
            for w in narrow {
                assert!((after[w as usize] / before.angles()[w as usize] - 0.6).abs() < 1e-12);
            }
        }
    }
}
