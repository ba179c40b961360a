//! Other seams for a component whose layout lies over itself.
//!
//! With a cone metric any seams between the cones open the surface to the same pieces, only joined otherwise: what lies over another piece with
//! some seams lies elsewhere with others. So the layout is taken apart where it overlaps, and the pieces are put together along a network of
//! all paths that seams might take: those there are, all cuts that were tried, shortest paths between neighbouring cones, and short ways
//! across (`uv/rearrange`). The best is what has few islands, then short seams and little room.

use geom::{EdgeData, FaceId, HalfedgeId, Id, Interrupted, Mesh, Watch};
use num_complex::Complex64;
use rayon::prelude::*;

use super::flat::Flat;
use crate::cut::SeamPlan;
use crate::flatten::Layout;
use crate::uv::{
    Figures, SEARCHES, Separation, UvMap, add_necks, attached, overlaps_on_islands, room, seam, taken_apart,
};

/// So many triangles are gone through one after the other.
const AT_ONCE: usize = 1024;
/// An island counts as such a share of the seams. On 13 layouts of 8 to 64 cones 20 islands are left, with 0.25 17, but 10 % less is filled.
const ISLAND: f64 = 0.1;
/// The side of the islands' squares, over the root of their area, counts as such a share of the seams,
const ROOM: f64 = 0.45;
/// and as so much where room is needed.
const NEEDED_ROOM: f64 = 1.0;
/// What seams are longer by than so many times those there were,
const LONGEST: f64 = 1.2;
/// or where nothing overlaps and a model of several parts needs room,
const LONGEST_FOR_ROOM: f64 = 1.1;
/// counts so many times again.
const TOO_LONG: f64 = 5.0;
/// So many islands are to be left at most, and no longer seams than by [`LONGEST`]. Else it is put together once more,
const MOST_ISLANDS: usize = 2;
/// where an island more counts as such a share of the seams again,
const ONE_MORE: f64 = 0.5;
/// and what seams are too long by, as lengths, so many times: with 5 or 10 face with 32 cones by `iterative` keeps one island less and 24 % more seam in
/// place of 20.
const BY_FAR_TOO_LONG: f64 = 20.0;
/// With more islands or cones that seldom helps: of 9 models by default it made two islands of one of them, and took up to twice their time.
const FEW_ISLANDS: usize = 2 * MOST_ISLANDS;
const FEW_CONES: usize = 64;
/// Of a model of several parts the square about an island is not to be larger than one that is filled so far: else its component is put
/// together otherwise as if it lay over itself (teapot with 32 cones: fill .492 → .614, seams 3.8 % longer).
const ENOUGH: f64 = 0.65;

/// A flattened component, and where its seams may go.
pub(super) struct Reseaming<'a> {
    mesh: &'a Mesh,
    flat: &'a Flat,
    plan: &'a SeamPlan,
    /// Whether it is to take less room even if it does not lie over itself.
    asks_for_room: bool,
    /// Its share of the model's area.
    share: f64,
    /// In the plane.
    area: f64,
}

impl<'a> Reseaming<'a> {
    pub(super) fn new(mesh: &'a Mesh, flat: &'a Flat, plan: &'a SeamPlan, asks_for_room: bool, share: f64) -> Self {
        Self { mesh, flat, plan, asks_for_room, share, area: flat.layout.area(mesh) }
    }

    /// The component opened so that it does not lie over itself. A layout that does not stays as it is, unless room is asked for or the model's
    /// square is as large as it is for this component alone.
    pub(super) fn best(&self, watch: Watch) -> Result<Separation, Interrupted> {
        let Self { mesh, flat, plan, .. } = *self;
        let first = self.first(watch.within(0.0, 0.1))?;
        let found = overlaps_on_islands(mesh, &first, watch.within(0.1, 0.2))?;
        let overlaps = !found.pairs.is_empty();
        if !overlaps && !self.asks_for_room && !self.bounds_the_square(&first) {
            return Ok(Separation::none(first, found));
        }
        let apart = || {
            let task = (mesh, plan.costs(), Some(plan.given()));
            let (separation, mut network) = taken_apart(task, (first, found), watch.within(0.2, 0.5))?;
            add_necks((mesh, plan.costs()), &separation.map, &mut network, |_| true, watch)?;
            Ok((separation, network))
        };
        let between_cones =
            || plan.network(mesh, &flat.cones, flat.seams.cut.clone(), watch.within(f64::NAN, f64::NAN));
        // Neither needs the other.
        let (apart, between_cones) = rayon::join(apart, between_cones);
        let ((separation, mut network), between_cones) = (apart?, between_cones?);
        mesh.edges().filter(|&e| between_cones[e]).for_each(|e| network[e] = true);
        let needs_room = self.asks_for_room || self.bounds_the_square(&separation.map);
        let long =
            |run: &[HalfedgeId]| run.iter().map(|&h| plan.lengths()[mesh.edge(h)]).filter(|l| l.is_finite()).sum();
        let along = |run: &[HalfedgeId]| [plan.along(mesh, run), long(run)];
        let before: f64 = flat.seams.chains.iter().map(|chain| plan.along(mesh, &chain.halfedges(mesh))).sum();
        let longest = match (overlaps, self.asks_for_room) {
            (true, _) => LONGEST,
            (false, false) => LONGEST_FOR_ROOM,
            (false, true) => 1.0, // what may be longer is left to cuts that fill more
        };
        let worth = if needs_room { NEEDED_ROOM } else { ROOM };
        let longer = |figures: &Figures| if before > 0.0 { figures.seam / before } else { 1.0 };
        let with = |figures: &Figures, too_long: f64| {
            let room = if self.area > 0.0 { figures.room / self.area.sqrt() } else { 0.0 };
            longer(figures) + too_long + worth * room + ISLAND * figures.islands as f64
        };
        let cost = |figures: Figures| with(&figures, TOO_LONG * (longer(&figures) - longest).max(0.0));
        let task = (mesh, plan.costs(), Some(plan.given()));
        let costs = (along, cost, self.share, 0..SEARCHES);
        let done = separation.rearranged(task, &network, costs, watch.within(0.5, 0.8))?;
        let are_few = || flat.cones.len() <= FEW_CONES && done.map.islands(mesh).count() <= FEW_ISLANDS;
        // Polygons that lie over themselves are to be taken out first.
        let is_parted = done.left.pairs.is_empty();
        if !overlaps || !is_parted || !are_few() || self.broken(&done.map) == 0 {
            return Ok(done);
        }
        let network = plan.with_shortest(mesh, &flat.cones, network, watch.within(f64::NAN, f64::NAN))?;
        let length = seam(mesh, plan.lengths(), &flat.seams.cut);
        let cost = |figures: Figures| {
            let too_long = if length > 0.0 { (figures.length / length - LONGEST).max(0.0) } else { 0.0 };
            let more = figures.islands.saturating_sub(MOST_ISLANDS);
            with(&figures, BY_FAR_TOO_LONG * too_long) + ONE_MORE * more as f64
        };
        let costs = (along, cost, self.share, SEARCHES..2 * SEARCHES);
        let other = done.clone().rearranged(task, &network, costs, watch.within(0.8, 1.0))?;
        Ok(if self.broken(&other.map) < self.broken(&done.map) { other } else { done })
    }

    /// How many of two promises a map breaks: few islands and short seams.
    fn broken(&self, map: &UvMap) -> usize {
        let [before, after] = [&self.flat.seams.cut, &map.cut].map(|cut| seam(self.mesh, self.plan.lengths(), cut));
        usize::from(map.islands(self.mesh).count() > MOST_ISLANDS) + usize::from(after > LONGEST * before)
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
        let islands = map.islands(self.mesh);
        let mut boundaries = vec![Vec::new(); islands.count()];
        for &h in islands.boundary_loops().iter().flatten() {
            let [x, y] = map.position[h];
            boundaries[islands.of(self.mesh.face(h)) as usize].push(Complex64::new(x, y));
        }
        let largest = boundaries.into_iter().map(|island| room(vec![island])).fold(0.0, f64::max);
        largest * largest * ENOUGH > self.area / self.share
    }
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
    fn where_many_islands_or_long_seams_are_left_all_is_put_together_once_more() {
        let model = shapes::by_name("terrain", 2500).unwrap().into();
        let analysis = Analysis::new(&model).unwrap();
        // With one search 3 islands and 23 % more seam, 2 and 22 %.
        for (placement, count) in [(Placement::Alternating, 12), (Placement::Persistence, 24)] {
            let cones = analysis.place(placement, count).unwrap();
            let map = |islands| {
                let options = Options { islands, free_seams: FreeSeams::Never, ..Options::default() };
                analysis.flatten_with(&cones, &options).unwrap()
            };
            let [single, free] = [Islands::Single, Islands::OverlapFree].map(map);
            assert!(overlaps(&triangles(&free)).pairs.is_empty(), "{placement:?}");
            assert!(free.seam_figures.length <= super::LONGEST * single.seam_figures.length, "{placement:?}");
            assert!(free.islands.iter().all(|&island| island < Some(super::MOST_ISLANDS as u32)), "{placement:?}");
        }
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
