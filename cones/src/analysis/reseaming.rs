//! Other seams for a component whose layout lies over itself.
//!
//! With a cone metric every tree of paths between the cones opens the surface to the same pieces, only joined otherwise
//! (`flatten::reopen`): a lobe that lies over another with one tree lies elsewhere with the next, whose paths are a hundredth longer.
//! So several are tried, each taken apart where it still overlaps, and the best result is kept: few
//! islands, then short seams and little room. Only with the best one more is tried where islands are left over.
//!
//! On 48 overlapping layouts (spot, fandisk, fertility, threeholes, hemisphere and punctured torus with 16, 32 and 64 cones by three methods)
//! 30 end in one island with the first tree alone, 36 with 12 others, one preference each and half the variation, 38 with two
//! preferences and more than twice of it, 40 with four preferences, 41 with 24 trees besides.

use geom::{EdgeData, HalfedgeData, Interrupted, Mesh, Watch};
use num_complex::Complex64;
use rayon::prelude::*;

use super::flat::Flat;
use crate::cut::SeamPlan;
use crate::flatten::{Layout, SeamError, Seams, Variation};
use crate::uv::{Effort, Separation, UvMap, room, separate_by};

/// So many other trees at most,
const MOST_TREES: u64 = 12;
/// and so many triangles in all of them: 4 trees on 30,000.
const TRIANGLES: usize = 120_000;
/// With more cones than this there are none: of so many pieces few fit together on any tree, and taking them apart takes long. (`cheese`,
/// 512 cones: six trees took half of the time.)
const MOST_CONES: usize = 128;
/// The paths of another tree may be longer by this share each; all of it is .2 to 3 % longer.
const STRENGTH: f64 = 0.3;
/// So many preferences are tried with each.
const PREFERENCES: usize = 2;
/// Seams that are longer by more than this count as an island.
const LONGEST: f64 = 1.2;
/// The side of the islands' squares, over the root of their area, counts as such a share of the seams. On 30 layouts (16 and 32 cones on the
/// surfaces above) the fill is .427 and the added seam 1.8 % with .1, .447 and 2.4 % with .3; .409 and 2.5 % with the first tree alone.
const ROOM: f64 = 0.3;

/// A component opened so that it does not lie over itself.
pub(super) struct Opening {
    /// The seams and the layout that it came of, if not those there were.
    pub(super) other: Option<(Seams, Layout)>,
    pub(super) separation: Separation,
}

/// What openings are compared by; less is better.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct Cost {
    islands: usize,
    /// Seams over those there were, and room.
    extent: f64,
}

/// A flattened component, and where its seams may go.
pub(super) struct Reseaming<'a> {
    mesh: &'a Mesh,
    flat: &'a Flat,
    plan: &'a SeamPlan,
    /// Of the seams there are.
    seam: f64,
    /// In the plane.
    area: f64,
}

impl<'a> Reseaming<'a> {
    pub(super) fn new(mesh: &'a Mesh, flat: &'a Flat, plan: &'a SeamPlan) -> Self {
        let area = |[a, b, c]: [Complex64; 3]| 0.5 * ((b - a).conj() * (c - a)).im.abs();
        let area = mesh.faces().map(|f| area(mesh.sides(f).map(|h| flat.layout.corner(h)))).sum();
        Self { mesh, flat, plan, seam: seam(mesh, plan.costs(), &flat.seams.cut), area }
    }

    /// The best opening. A layout that does not lie over itself stays as it is.
    pub(super) fn best(&self, watch: Watch) -> Result<Opening, Interrupted> {
        let first = map(self.mesh, &self.flat.layout, &self.flat.seams.cut);
        let before = self.flat.layout.cut.island_count();
        let mut separation = self.separated(first.clone(), Effort::Quick(usize::MAX), watch.within(0.0, 0.2))?;
        if separation.overlaps.pairs.is_empty() {
            return Ok(Opening { other: None, separation });
        }
        let mut others = self.others(watch.within(0.2, 0.6))?;
        let costs: Vec<Cost> = others.iter().map(|other| self.cost(&other.separation)).collect();
        let (mut cost, mut other) = (self.cost(&separation), None);
        if let Some(k) = (0..others.len()).min_by(|&j, &k| costs[j].partial_cmp(&costs[k]).expect("no NaN"))
            && costs[k] < cost
        {
            let better = others.swap_remove(k);
            (cost, separation, other) = (costs[k], better.separation, better.other);
        }
        if cost.islands > before {
            let unparted = other.as_ref().map_or(first, |(seams, layout)| map(self.mesh, layout, &seams.cut));
            let further = self.separated(unparted, Effort::Thorough, watch.within(0.6, 0.9))?;
            if self.cost(&further) < cost {
                separation = further;
            }
        }
        separation.look(self.mesh, watch.within(0.9, 1.0))?;
        Ok(Opening { other, separation })
    }

    /// What comes of other trees. Where triangles were detached or very many vertices are cones there are none.
    fn others(&self, watch: Watch) -> Result<Vec<Opening>, Interrupted> {
        let Self { mesh, flat, plan, .. } = *self;
        if !flat.detached.is_empty() || flat.is_unfolded || flat.cones.len() > MOST_CONES {
            return Ok(Vec::new());
        }
        let count = MOST_TREES.min((TRIANGLES / mesh.face_count().max(1)) as u64);
        let opened = |number: u64| -> Result<Option<(Seams, Layout)>, Interrupted> {
            let variation = Variation { strength: STRENGTH, number };
            let seams = match plan.cut_otherwise(mesh, &flat.cones, variation, watch) {
                Err(SeamError::Interrupted(why)) => return Err(why),
                seams => seams.ok(),
            };
            let layout = |seams: Seams| {
                let layout = flat.layout.reopened(mesh, &flat.seams.cut, &seams.cut)?;
                Some((seams, layout))
            };
            Ok(seams.and_then(layout))
        };
        let trees: Vec<Result<_, Interrupted>> = (1..=count).into_par_iter().map(opened).collect();
        let mut different: Vec<(Seams, Layout)> = Vec::new();
        for tree in trees {
            let is_new = |(seams, _): &(Seams, Layout)| {
                seams.cut != flat.seams.cut && different.iter().all(|(other, _)| seams.cut != other.cut)
            };
            if let Some(tree) = tree?.filter(is_new) {
                different.push(tree);
            }
        }
        let separated = |(seams, layout): (Seams, Layout)| {
            let separation =
                self.separated(map(mesh, &layout, &seams.cut), Effort::Quick(PREFERENCES), watch.within(0.4, 1.0))?;
            Ok(Opening { other: Some((seams, layout)), separation })
        };
        let openings: Vec<Result<Opening, Interrupted>> = different.into_par_iter().map(separated).collect();
        openings.into_iter().collect()
    }

    fn separated(&self, map: UvMap, effort: Effort, watch: Watch) -> Result<Separation, Interrupted> {
        separate_by(self.mesh, self.plan.costs(), Some(self.plan.given()), map, effort, watch)
    }

    fn cost(&self, separation: &Separation) -> Cost {
        let cost = separation.cost(self.mesh, self.plan.costs());
        let longer = if self.seam > 0.0 { cost.seam / self.seam } else { 1.0 };
        let room = if self.area > 0.0 { room(boundaries(self.mesh, &separation.map)) / self.area.sqrt() } else { 0.0 };
        Cost { islands: cost.islands + usize::from(longer > LONGEST), extent: longer + ROOM * room }
    }
}

/// A layout opened along its seams.
pub(super) fn map(mesh: &Mesh, layout: &Layout, cut: &EdgeData<bool>) -> UvMap {
    let at = |z: Complex64| [z.re, z.im];
    let position: HalfedgeData<[f64; 2]> = mesh.halfedges().map(|h| at(layout.corner(h))).collect();
    UvMap { position, cut: cut.clone() }
}

/// The points on the boundary of each island.
fn boundaries(mesh: &Mesh, map: &UvMap) -> Vec<Vec<Complex64>> {
    let opened = map.opened(mesh);
    let mut points = vec![Vec::new(); opened.island_count()];
    for &h in opened.boundary_loops().iter().flatten() {
        let [x, y] = map.position[h];
        points[opened.island(mesh.face(h)) as usize].push(Complex64::new(x, y));
    }
    points
}

fn seam(mesh: &Mesh, lengths: &EdgeData<f64>, cut: &EdgeData<bool>) -> f64 {
    mesh.edges().filter(|&e| cut[e]).map(|e| lengths[e]).filter(|l| l.is_finite()).sum()
}

#[cfg(test)]
mod tests {
    use crate::uv::{Triangle, overlaps};
    use crate::{Analysis, Atlas, Islands, Options, Placement};
    use geom::shapes;

    fn triangles(atlas: &Atlas) -> Vec<Triangle> {
        atlas.triangles.corners.iter().map(|corners| corners.map(|c| atlas.uv[c as usize])).collect()
    }

    /// A map with its layout as it is, and one without overlap.
    fn maps(cones: usize) -> [Atlas; 2] {
        let model = shapes::hare(1200).into();
        let analysis = Analysis::new(&model).unwrap();
        let cones = analysis.place(Placement::Persistence, cones).unwrap();
        let map = |islands| analysis.flatten_with(&cones, &Options { islands, ..Options::default() }).unwrap();
        [Islands::Single, Islands::OverlapFree].map(map)
    }

    #[test]
    fn wherever_the_seams_are_then_all_triangles_keep_their_shape_and_nothing_overlaps() {
        let mut mended = 0;
        for count in [8, 12, 16, 20, 24, 28, 32] {
            let [single, free] = maps(count);
            let [before, after] = [&single, &free].map(triangles);
            mended += usize::from(!overlaps(&before).pairs.is_empty());
            assert!(overlaps(&after).pairs.is_empty(), "with {count} cones");
            let length = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
            for (one, other) in before.iter().zip(&after) {
                for k in 0..3 {
                    let [before, after] = [one, other].map(|t| length(t[k], t[(k + 1) % 3]));
                    assert!((after / before - 1.0).abs() < 1e-7, "{before} {after}");
                }
            }
            assert!(free.seam_figures.length <= super::LONGEST * single.seam_figures.length);
        }
        assert!(mended >= 3, "{mended} layouts lay over themselves");
    }

    #[test]
    fn the_seams_are_the_same_for_any_number_of_threads() {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| maps(32)[1].uv.clone())
        };
        assert_eq!(with(1), with(3));
    }

    #[test]
    fn a_layout_that_does_not_lie_over_itself_keeps_its_seams() {
        let [single, free] = maps(4);
        assert!(overlaps(&triangles(&single)).pairs.is_empty());
        assert_eq!(single.seams, free.seams);
    }
}
