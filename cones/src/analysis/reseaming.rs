//! Other seams for a component whose layout lies over itself.
//!
//! With a cone metric every tree of paths between the cones opens the surface to the same pieces, only joined otherwise
//! (`flatten::reopen`): a lobe that lies over another with one tree lies elsewhere with the next, whose paths are a hundredth longer.
//! So several are tried, each taken apart where it still overlaps, lobes of the best are moved to where they take less room
//! (`uv::exchange`), and the best result is kept: few islands, then short seams and little room. Only where islands or long seams are left
//! over more is tried with the best one, then trees that pass through cones of more than 2π rather than to end there
//! (`flatten/seam_tree`), which are kept if they leave fewer. (Tried everywhere they add .4 % less seam to 144 layouts of 15 surfaces, but with 32
//! cones bunny's fill is .483 for .589, face's .421 for .510.)
//!
//! On 48 overlapping layouts (spot, fandisk, fertility, threeholes, hemisphere and punctured torus with 16, 32 and 64 cones by three methods)
//! 30 end in one island with the first tree alone, 36 with 12 others, one preference each and half the variation, 38 with two
//! preferences and more than twice of it, 40 with four preferences, 41 with 24 trees besides.

use std::ops::RangeInclusive;

use geom::{CutMesh, EdgeData, FaceId, Id, Interrupted, Mesh, Watch};
use num_complex::Complex64;
use rayon::prelude::*;

use super::flat::Flat;
use crate::cut::SeamPlan;
use crate::flatten::{Layout, SeamError, Seams, Variation};
use crate::uv::{Aim, Effort, Separation, UvMap, attached, is_searched, room, separate_by};

/// So many triangles are gone through one after the other.
const AT_ONCE: usize = 1024;
/// So many other trees at most, and one more that pass through cones where islands are left over or long seams,
const MOST_TREES: u64 = 12;
/// and so many triangles in all of either: 4 trees on 30,000.
const TRIANGLES: usize = 120_000;
/// With more cones than this there are none: of so many pieces few fit together on any tree, and taking them apart takes long. (`cheese`,
/// 512 cones: six trees took half of the time.)
const MOST_CONES: usize = 128;
/// The paths of another tree may be longer by this share each; all of it is .2 to 3 % longer.
const STRENGTH: f64 = 0.3;
/// So many preferences are tried with each.
const PREFERENCES: usize = 2;
/// Other preferences are tried with all trees where the best leaves so many islands, or one less and long seams. (With more islands, as of many
/// handles, one less is not worth the time.) Not on surfaces of more than 400,000 triangles.
const INSISTED: RangeInclusive<usize> = 3..=12;
/// Seams that are longer by more than this
const LONGEST: f64 = 1.2;
/// count as so many islands, and further ones by so much as another;
const LONG: usize = 3;
const FURTHER: f64 = 0.03;
/// then so many triangles are gone through in search of shorter ones.
const TRIANGLES_IF_LONG: usize = 480_000;
/// The side of the islands' squares, over the root of their area, counts as such a share of the seams. On 12 surfaces with 32 cones
/// (`uv/exchange`) the fill is .486 with .3, .519 with seams 1.8 % longer with .5, .530 and 2.5 % with .8.
const ROOM: f64 = 0.5;
/// Of so many openings of fewest islands lobes are moved: of one alone the fill on those is .46 to .47, of four .518, of all thirteen .519.
const BEST: usize = 4;
/// Of a model of several parts the square about an island is not to be larger than one that is filled so far: else its component is opened
/// along other trees and lobes are moved as if it lay over itself (teapot with 32 cones: fill .492 → .614, seams 3.8 % longer).
const ENOUGH: f64 = 0.65;
/// Seams are not made longer than so many times those there were for the sake of room.
const LONGEST_EXCHANGED: f64 = 1.1;

/// A component opened so that it does not lie over itself.
pub(super) struct Opening {
    /// The seams and the layout that it came of, if not those there were.
    pub(super) other: Option<(Seams, Layout)>,
    pub(super) separation: Separation,
}

/// Another tree of seams.
#[derive(Clone, Copy)]
struct Other {
    /// Which of those with random distances; 0 is the one with the true ones.
    number: u64,
    /// Whether it passes through cones of more than 2π rather than to end there.
    through: bool,
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
    /// Whether it is to take less room even if it does not lie over itself.
    asks_for_room: bool,
    /// Its share of the model's area.
    share: f64,
    /// Of the seams there are.
    seam: f64,
    /// In the plane.
    area: f64,
}

impl<'a> Reseaming<'a> {
    pub(super) fn new(mesh: &'a Mesh, flat: &'a Flat, plan: &'a SeamPlan, asks_for_room: bool, share: f64) -> Self {
        let area = |[a, b, c]: [Complex64; 3]| 0.5 * ((b - a).conj() * (c - a)).im.abs();
        let area = mesh.faces().map(|f| area(mesh.sides(f).map(|h| flat.layout.corner(h)))).sum();
        Self { mesh, flat, plan, asks_for_room, share, seam: seam(mesh, plan.costs(), &flat.seams.cut), area }
    }

    /// The best opening. A layout that does not lie over itself stays as it is, unless room is asked for or the model's square is as large as it
    /// is for this component alone.
    pub(super) fn best(&self, watch: Watch) -> Result<Opening, Interrupted> {
        let first = self.first(watch.within(0.0, 0.1))?;
        let separation = self.separated(first, Effort::Quick(usize::MAX), watch.within(0.1, 0.2))?;
        let opening = Opening { other: None, separation };
        let bounds_the_square = self.bounds_the_square(&opening.separation.map);
        let always = bounds_the_square || self.asks_for_room;
        if opening.separation.overlaps.pairs.is_empty() && !bounds_the_square {
            return match self.asks_for_room {
                true => self.exchanged(opening, (1.0, always), watch.within(0.2, 1.0)),
                false => Ok(opening),
            };
        }
        let mut openings = self.found(vec![opening], self.trees(), watch.within(0.2, 0.5))?;
        if self.tree_count(TRIANGLES) > 0 && self.adds_islands(&openings[0].0, watch.within(0.5, 0.5))? {
            let trees = self.further_trees(self.is_long(&openings[0].1.separation));
            let others = self.found(Vec::new(), trees, watch.within(0.5, 0.7))?;
            if others.first().is_some_and(|(cost, _)| cost.islands < openings[0].0.islands) {
                openings = others;
            }
        }
        let fewest = openings[0].0.islands;
        openings.retain(|(cost, _)| cost.islands <= fewest);
        openings.truncate(BEST);
        let exchanged = openings
            .into_par_iter()
            .map(|(_, opening)| self.exchanged(opening, (LONGEST_EXCHANGED, always), watch.within(0.7, 0.9)));
        let exchanged: Vec<Result<Opening, Interrupted>> = exchanged.collect();
        watch.ask(0.9)?;
        let ranked = self.ranked(exchanged.into_iter().collect::<Result<Vec<_>, _>>()?, watch)?;
        let (_, mut best) = ranked.into_iter().next().expect("the first is one of them");
        best.separation.look(self.mesh, watch.within(0.9, 1.0))?;
        Ok(best)
    }

    /// These openings and what comes of other trees, with their costs, the best first and resolved further.
    fn found(
        &self,
        openings: Vec<Opening>,
        trees: Vec<Other>,
        watch: Watch,
    ) -> Result<Vec<(Cost, Opening)>, Interrupted> {
        let others = self.others(trees, watch.within(0.0, 0.6))?;
        watch.ask(0.6)?;
        let mut openings = self.ranked(openings.into_iter().chain(others), watch)?;
        watch.ask(0.6)?;
        if openings.first().is_some_and(|(cost, _)| INSISTED.contains(&cost.islands)) && is_searched(self.mesh) {
            openings = self.insisted(openings, watch.within(0.6, 0.6))?;
        }
        if let Some(best) = openings.first_mut() {
            self.resolve_further(best, watch.within(0.6, 1.0))?;
        }
        Ok(openings)
    }

    /// The layout as it came out, what was detached attached where there is room for it.
    fn first(&self, watch: Watch) -> Result<UvMap, Interrupted> {
        let first = map(self.mesh, &self.flat.layout, &self.flat.seams.cut);
        match self.flat.detached.is_empty() {
            true => Ok(first),
            false => attached(self.mesh, self.plan.costs(), Some(self.plan.given()), first, watch),
        }
    }

    /// Whether the model's square is as large as it is for one island of this component, which is not all of the model.
    fn bounds_the_square(&self, map: &UvMap) -> bool {
        if self.share == 1.0 {
            return false;
        }
        let boundaries = boundaries(self.mesh, map, &map.opened(self.mesh));
        let largest = boundaries.into_iter().map(|island| room(vec![island])).fold(0.0, f64::max);
        largest * largest * ENOUGH > self.area / self.share
    }

    /// Openings with their costs, the best first.
    fn ranked(
        &self,
        openings: impl IntoIterator<Item = Opening>,
        watch: Watch,
    ) -> Result<Vec<(Cost, Opening)>, Interrupted> {
        let with_cost = |opening: Opening| Ok((self.cost(&opening.separation, watch)?, opening));
        let mut ranked = openings.into_iter().map(with_cost).collect::<Result<Vec<(Cost, Opening)>, _>>()?;
        sort(&mut ranked);
        Ok(ranked)
    }

    /// Whether there are more islands than in the layout as it came out.
    fn adds_islands(&self, cost: &Cost, watch: Watch) -> Result<bool, Interrupted> {
        Ok(cost.islands > 1 && cost.islands > self.first(watch)?.opened(self.mesh).island_count())
    }

    /// Tries more where there are more islands than there were.
    fn resolve_further(&self, (cost, opening): &mut (Cost, Opening), watch: Watch) -> Result<(), Interrupted> {
        let is_done = opening.other.is_none() && !is_searched(self.mesh);
        if is_done || !self.adds_islands(cost, watch)? {
            return Ok(());
        }
        let further = self.separated(self.unparted(opening, watch)?, Effort::Thorough, watch)?;
        let cost_there = self.cost(&further, watch)?;
        if cost_there < *cost {
            *cost = cost_there;
            opening.separation = further;
        }
        Ok(())
    }

    /// The openings and what other preferences make of their trees, with their costs, the best first.
    fn insisted(&self, mut openings: Vec<(Cost, Opening)>, watch: Watch) -> Result<Vec<(Cost, Opening)>, Interrupted> {
        let otherwise = |(_, opening): &(Cost, Opening)| {
            let separation = self.separated(self.unparted(opening, watch)?, Effort::Insistent, watch)?;
            Ok(Opening { other: opening.other.clone(), separation })
        };
        let others: Vec<Result<Opening, Interrupted>> = openings.par_iter().map(otherwise).collect();
        openings.extend(self.ranked(others.into_iter().collect::<Result<Vec<_>, _>>()?, watch)?);
        sort(&mut openings);
        Ok(openings)
    }

    /// The map that an opening came of. Found again, since it takes as much room as the opening itself.
    fn unparted(&self, opening: &Opening, watch: Watch) -> Result<UvMap, Interrupted> {
        match &opening.other {
            Some((seams, layout)) => Ok(map(self.mesh, layout, &seams.cut)),
            None => self.first(watch),
        }
    }

    /// An opening with its lobes where they take less room, and seams at most so many times those there were; `always` as in [`Aim`].
    fn exchanged(
        &self,
        opening: Opening,
        (longest, always): (f64, bool),
        watch: Watch,
    ) -> Result<Opening, Interrupted> {
        let Opening { other, separation } = opening;
        let costs = self.plan.path_costs();
        let seam = seam(self.mesh, costs, &self.flat.seams.cut);
        let aim = Aim { seam, room: ROOM, longest: longest * seam, always };
        let surface = (self.mesh, costs, Some(self.plan.given()));
        Ok(Opening { other, separation: separation.exchanged(surface, &aim, watch)? })
    }

    /// How many other trees go through so many triangles. Where triangles were detached or very many vertices are cones there are none.
    fn tree_count(&self, triangles: usize) -> u64 {
        if !self.flat.detached.is_empty() || self.flat.is_unfolded || self.flat.cones.len() > MOST_CONES {
            return 0;
        }
        MOST_TREES.min((triangles / self.mesh.face_count().max(1)) as u64)
    }

    /// The trees that are tried first.
    fn trees(&self) -> Vec<Other> {
        (1..=self.tree_count(TRIANGLES)).map(|number| Other { number, through: false }).collect()
    }

    /// Those that are tried where islands are left over, or long seams.
    fn further_trees(&self, is_long: bool) -> Vec<Other> {
        let few = self.tree_count(TRIANGLES);
        let many = if is_long { self.tree_count(TRIANGLES_IF_LONG) } else { few };
        let tree = |through| move |number| Other { number, through };
        (0..=many).map(tree(true)).chain((few + 1..=many).map(tree(false))).collect()
    }

    /// What comes of other trees.
    fn others(&self, trees: Vec<Other>, watch: Watch) -> Result<Vec<Opening>, Interrupted> {
        let Self { mesh, flat, plan, .. } = *self;
        let angle = trees.iter().any(|tree| tree.through).then(|| flat.layout.angles(mesh));
        let opened = |Other { number, through }: Other| -> Result<Option<(Seams, Layout)>, Interrupted> {
            let strength = if number == 0 { 0.0 } else { STRENGTH };
            let variation = Variation { strength, number, angle: angle.as_ref().filter(|_| through) };
            let seams = match plan.cut_otherwise(mesh, &flat.cones, variation, watch) {
                Err(SeamError::Interrupted(why)) => return Err(why),
                seams => seams.ok(),
            };
            watch.ask(f64::NAN)?;
            let layout = |seams: Seams| {
                let layout = flat.layout.reopened(mesh, &flat.seams.cut, &seams.cut)?;
                Some((seams, layout))
            };
            Ok(seams.and_then(layout))
        };
        let trees: Vec<Result<_, Interrupted>> = trees.into_par_iter().map(opened).collect();
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

    /// A length of seams over that of those there were.
    fn longer(&self, seam: f64) -> f64 {
        if self.seam > 0.0 { seam / self.seam } else { 1.0 }
    }

    fn is_long(&self, separation: &Separation) -> bool {
        self.longer(seam(self.mesh, self.plan.costs(), &separation.map.cut)) > LONGEST
    }

    fn cost(&self, separation: &Separation, watch: Watch) -> Result<Cost, Interrupted> {
        let opened = separation.map.opened(self.mesh);
        watch.ask(f64::NAN)?;
        let cost = separation.cost(self.mesh, self.plan.costs(), &opened);
        let longer = self.longer(cost.seam);
        let boundaries = boundaries(self.mesh, &separation.map, &opened);
        let room = if self.area > 0.0 { room(boundaries) / self.area.sqrt() } else { 0.0 };
        let further = ((longer - LONGEST) / FURTHER).min(100.0);
        let islands = cost.islands + if further > 0.0 { LONG + further as usize } else { 0 };
        Ok(Cost { islands, extent: longer + ROOM * room })
    }
}

fn sort(openings: &mut [(Cost, Opening)]) {
    openings.sort_by(|a, b| a.0.partial_cmp(&b.0).expect("no NaN"));
}

/// A layout opened along its seams.
pub(super) fn map(mesh: &Mesh, layout: &Layout, cut: &EdgeData<bool>) -> UvMap {
    let corners = |f: usize| {
        mesh.sides(FaceId::new(f)).map(|h| {
            let z = layout.corner(h);
            [z.re, z.im]
        })
    };
    let position: Vec<[[f64; 2]; 3]> =
        (0..mesh.face_count()).into_par_iter().with_min_len(AT_ONCE).map(corners).collect();
    UvMap { position: position.into_flattened().into(), cut: cut.clone() }
}

/// The points on the boundary of each island.
fn boundaries(mesh: &Mesh, map: &UvMap, opened: &CutMesh) -> Vec<Vec<Complex64>> {
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
    use crate::{Analysis, Atlas, FreeSeams, Islands, Options, Placement};
    use geom::shapes;

    fn triangles(atlas: &Atlas) -> Vec<Triangle> {
        atlas.triangles.corners.iter().map(|corners| corners.map(|c| atlas.uv[c as usize])).collect()
    }

    /// A map with its layout as it is, one without overlap, and one that fills more.
    fn maps(cones: usize) -> [Atlas; 3] {
        let model = shapes::hare(1200).into();
        let analysis = Analysis::new(&model).unwrap();
        let cones = analysis.place(Placement::Persistence, cones).unwrap();
        let rigid = Options { free_seams: FreeSeams::Never, ..Options::default() };
        let map = |islands| analysis.flatten_with(&cones, &Options { islands, ..rigid.clone() }).unwrap();
        [Islands::Single, Islands::OverlapFree, Islands::Pack].map(map)
    }

    #[test]
    fn wherever_the_seams_are_then_all_triangles_keep_their_shape_and_nothing_overlaps() {
        let mut mended = 0;
        for count in [8, 12, 16, 20, 24, 28, 32] {
            let [single, free, packed] = maps(count);
            let [before, after] = [&single, &free].map(triangles);
            assert!(overlaps(&triangles(&packed)).pairs.is_empty(), "packed with {count} cones");
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
        let [single, free, _] = maps(4);
        assert!(overlaps(&triangles(&single)).pairs.is_empty());
        assert_eq!(single.seams, free.seams);
    }
}
