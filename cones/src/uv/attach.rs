//! Islands put together again across seams.
//!
//! Whatever [`divide`](super::divide) has cut off is glued to an island next to it on the surface where the two sides of a seam are congruent
//! ([`chains`](super::chains)), longest chain first, as long as no two triangles come to lie over each other. Scale
//! stays untouched, the larger of two islands where it is, and two disks glued along one chain are a disk.
//!
//! An island is a list of pieces, each with the rigid motion that takes it from where it lay at first. Positions are
//! computed once, from the first ones, and one tree of all triangles as they lay at first serves all tests: triangles of the
//! smaller piece are taken to where the larger one lay.
//!
//! Whether islands come to lie over each other their boundaries tell. If that of the smaller one meets nothing of the larger, all of this
//! is covered equally often, and so not at all. So only triangles on that boundary are tested, which are few.
//!
//! A surface that was unfolded triangle by triangle falls to tens of thousands of pieces. So chains wait in a queue, only those along the smaller
//! of two islands are found anew when these are glued, and a chain that could not be glued is not tried again: whatever islands grow by,
//! what lay over each other still does.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use geom::{EdgeData, EdgeId, FaceData, FaceId, HalfedgeId, Interrupted, Islands, Mesh, Watch};
use rayon::prelude::*;

use super::AT_ONCE;
use super::boxes::{Bounds, Boxes, meet, moved_bounds};
use super::chains::{Chain, Loops};
use super::map::UvMap;
use super::motion::Motion;
use super::overlap::NEGLIGIBLE_DEPTH;
use super::table::{Set, Table};

/// Glued islands may overlap by this share of [`NEGLIGIBLE_DEPTH`], so that they do not overlap after some rounding.
pub(super) const ALLOWED: f64 = 0.5;

/// What a map is put together from.
#[derive(Clone)]
pub(super) struct Pieces<'a> {
    mesh: &'a Mesh,
    map: &'a UvMap,
    lengths: &'a EdgeData<f64>,
    /// What stays open.
    kept: Option<&'a EdgeData<bool>>,
    /// The longer side of the map's bounding box.
    extent: f64,
    /// The piece of each triangle, by breadth of islands.
    piece: FaceData<u32>,
    faces: Vec<Vec<FaceId>>,
    /// The halfedges on the boundary of each piece.
    rims: Vec<Vec<HalfedgeId>>,
    /// All triangles as they lay at first.
    boxes: &'a Boxes<'a>,
    /// The bounding box of each piece as it lay at first; none without area.
    bounds: Vec<Option<Bounds>>,
    /// And as it lies now.
    placed: Vec<Option<Bounds>>,
    motion: Vec<Motion>,
    /// The island of each piece.
    island: Vec<u32>,
    /// The pieces of each island.
    pieces: Vec<Vec<u32>>,
    /// How many triangles are on each island,
    size: Vec<usize>,
    /// and their area in the plane.
    area: Vec<f64>,
    cut: EdgeData<bool>,
    loops: Loops<'a>,
}

/// What has become of a map that was put together otherwise.
pub(super) struct Moved {
    /// The piece of each triangle.
    pub(super) piece: FaceData<u32>,
    pub(super) motion: Vec<Motion>,
    pub(super) cut: EdgeData<bool>,
}

impl Moved {
    /// The map in place of the one before, each vertex in one place.
    pub(super) fn snapped(self, mesh: &Mesh, mut map: UvMap) -> UvMap {
        self.put(&mut map);
        map.snapped(mesh, |_, h| self.motion[self.piece[mesh.face(h)] as usize] == Motion::NONE)
    }

    fn put(&self, map: &mut UvMap) {
        let triangles = map.position.as_chunks_mut::<3>().0.par_iter_mut().with_min_len(AT_ONCE);
        triangles.zip(self.piece.par_iter()).for_each(|(corners, &piece)| {
            let motion = &self.motion[piece as usize];
            if *motion != Motion::NONE {
                *corners = motion.of_triangle(*corners);
            }
        });
        map.cut.clone_from(&self.cut);
    }
}

impl<'a> Pieces<'a> {
    /// Each island of the map opened further along `cut` is a piece; edges may be kept open.
    pub(super) fn new(
        (mesh, lengths, kept): (&'a Mesh, &'a EdgeData<f64>, Option<&'a EdgeData<bool>>),
        map: &'a UvMap,
        boxes: &'a Boxes<'a>,
        cut: EdgeData<bool>,
    ) -> Self {
        let islands = Islands::new(mesh, &cut);
        let (count, piece, faces) = (islands.count(), islands.of_faces().clone(), islands.faces());
        let mut rims = vec![Vec::new(); count];
        islands.boundary_loops().iter().flatten().for_each(|&h| rims[piece[mesh.face(h)] as usize].push(h));
        let bounds_of = |faces: &Vec<FaceId>| boxes.bounds_of(faces.par_iter().with_min_len(AT_ONCE).map(|f| f.0));
        let area_of = |faces: &Vec<FaceId>| faces.iter().map(|f| boxes.area(f.0)).sum();
        let (bounds, area): (Vec<Option<Bounds>>, Vec<f64>) =
            rayon::join(|| faces.iter().map(bounds_of).collect(), || faces.par_iter().map(area_of).collect());
        Self {
            mesh,
            map,
            lengths,
            kept,
            extent: map.extent(),
            piece,
            boxes,
            placed: bounds.clone(),
            bounds,
            size: faces.iter().map(Vec::len).collect(),
            area,
            faces,
            rims,
            motion: vec![Motion::NONE; count],
            island: (0..count as u32).collect(),
            pieces: (0..count as u32).map(|p| vec![p]).collect(),
            cut,
            loops: Loops::new(mesh, &islands),
        }
    }

    /// Glues what can be glued, longest chain first.
    pub(super) fn attach(&mut self, watch: Watch) -> Result<(), Interrupted> {
        let all = self.pieces.len().max(2) - 1;
        let mut glued = 0;
        let mut queue = Queue::new(self.mesh, self.chains());
        while let Some(chain) = queue.pop() {
            watch.ask(glued as f64 / all as f64)?;
            if chain.islands.iter().any(|&island| self.pieces[island as usize].is_empty()) {
                continue;
            }
            if self.can_glue(&chain) {
                queue.extend(self.glue(&chain));
                glued += 1;
            } else {
                queue.refuse(&chain);
            }
        }
        Ok(())
    }

    /// The chains between different islands, longest first.
    pub(super) fn chains(&self) -> Vec<Chain> {
        self.chains_through(self.rims.iter().flatten().copied())
    }

    /// Those that some of the halfedges are in.
    fn chains_through(&self, some: impl Iterator<Item = HalfedgeId>) -> Vec<Chain> {
        self.loops.chains_through(
            some,
            |[one, other]| one < other,
            (|h| self.island_of(h), |e| self.kept.is_some_and(|kept| kept[e])),
            |h| self.motion[self.piece[self.mesh.face(h)] as usize].of(self.map.position[h]),
            self.lengths,
            self.extent,
        )
    }

    fn island_of(&self, h: HalfedgeId) -> u32 {
        self.island[self.piece[self.mesh.face(h)] as usize]
    }

    /// The smaller of a chain's islands, the larger, and the motion that takes the smaller to it.
    fn gluing(&self, chain: &Chain) -> (u32, u32, Motion) {
        let [left, right] = chain.islands;
        match self.size[left as usize] < self.size[right as usize] {
            true => (left, right, chain.motion.inverse()),
            false => (right, left, chain.motion),
        }
    }

    /// Whether the two islands of a chain lie beside each other when it is glued; see the module's head.
    fn can_glue(&self, chain: &Chain) -> bool {
        let [left, right] = chain.islands;
        let (small, large, motion) = match self.area[left as usize] < self.area[right as usize] {
            true => (left, right, chain.motion.inverse()),
            false => (right, left, chain.motion),
        };
        self.pieces[small as usize].iter().all(|&p| {
            let Some(moved) = self.bounds[p as usize] else { return true };
            let moved = moved_bounds(moved, &motion.after(&self.motion[p as usize]));
            let meets = |q: &&u32| self.placed[**q as usize].is_some_and(|still| meet(&moved, &still));
            let mut near = self.pieces[large as usize].iter().filter(meets).peekable();
            if near.peek().is_none() {
                return true;
            }
            let tested = self.boundary(p);
            near.all(|&q| {
                let motion = self.between([p, q], &motion);
                match self.faces[q as usize].len() < tested.len() {
                    true => !self.overlap([q, p], &self.faces[q as usize], &motion.inverse()),
                    false => !self.overlap([p, q], &tested, &motion),
                }
            })
        })
    }

    /// The triangles of a piece that are on the boundary of its island; all of them where one of these has no area.
    fn boundary(&self, p: u32) -> Vec<FaceId> {
        let rim = self.rims[p as usize].iter().filter(|&&h| self.loops.contains(h));
        let mut found: Vec<FaceId> = rim.map(|&h| self.mesh.face(h)).collect();
        found.sort_unstable();
        found.dedup();
        let has_area = |f: &FaceId| self.boxes.upright(f.0).is_some();
        if found.iter().all(has_area) { found } else { self.faces[p as usize].clone() }
    }

    /// What takes a piece from where it lay at first to where another did, when its island is moved.
    fn between(&self, pieces: [u32; 2], motion: &Motion) -> Motion {
        let [to_place, place] = pieces.map(|piece| self.motion[piece as usize]);
        place.inverse().after(&motion.after(&to_place))
    }

    /// Whether some triangles of a piece, moved to where the second piece lay at first, lie over that.
    fn overlap(&self, [p, q]: [u32; 2], some: &[FaceId], motion: &Motion) -> bool {
        let [moved, still] = [p, q].map(|piece| self.bounds[piece as usize]);
        let least = ALLOWED * NEGLIGIBLE_DEPTH * self.extent;
        may_meet(moved, still, motion) && self.boxes.overlap(some, motion, |g| self.piece[g] == q, least)
    }

    /// Glues a chain. The chains that come of it are all those along the smaller island, and what joins them.
    pub(super) fn glue(&mut self, chain: &Chain) -> Vec<Chain> {
        let (small, large, motion) = self.gluing(chain);
        let moved = std::mem::take(&mut self.pieces[small as usize]);
        for &p in &moved {
            let (p, motion) = (p as usize, motion.after(&self.motion[p as usize]));
            self.placed[p] = self.bounds[p].map(|bounds| moved_bounds(bounds, &motion));
            self.motion[p] = motion;
            self.island[p] = large;
        }
        self.size[large as usize] += std::mem::take(&mut self.size[small as usize]);
        self.area[large as usize] += std::mem::take(&mut self.area[small as usize]);
        self.pieces[large as usize].extend(&moved);
        chain.sides.iter().for_each(|&h| self.cut[self.mesh.edge(h)] = false);
        let joined = self.loops.glue(chain);
        let rims = moved.iter().flat_map(|&p| &self.rims[p as usize]).copied().chain(joined);
        self.chains_through(rims.flat_map(|h| [Some(h), self.mesh.twin(h)]).flatten())
    }

    /// What has become of the map.
    pub(super) fn moved(self) -> Moved {
        Moved { piece: self.piece, motion: self.motion, cut: self.cut }
    }

    /// How many triangles each island has.
    pub(super) fn sizes(&self) -> Vec<usize> {
        self.size.iter().copied().filter(|&size| size > 0).collect()
    }

    /// Where the map is open.
    pub(super) fn cut(&self) -> &EdgeData<bool> {
        &self.cut
    }
}

/// Whether bounding boxes meet where the first is moved.
pub(super) fn may_meet(moved: Option<Bounds>, still: Option<Bounds>, motion: &Motion) -> bool {
    let (Some(moved), Some(still)) = (moved, still) else { return false };
    meet(&moved_bounds(moved, motion), &still)
}

/// The chains that are to be tried.
struct Queue<'a> {
    mesh: &'a Mesh,
    waiting: BinaryHeap<Waiting>,
    /// How many have been added.
    count: usize,
    /// The number of the last chain that each edge was in.
    last: Table<EdgeId, usize>,
    /// Edges of chains that cannot be glued.
    refused: Set<EdgeId>,
}

impl<'a> Queue<'a> {
    fn new(mesh: &'a Mesh, chains: Vec<Chain>) -> Self {
        let (waiting, last, refused) = (BinaryHeap::new(), Table::default(), Set::default());
        let mut queue = Self { mesh, waiting, count: 0, last, refused };
        queue.extend(chains);
        queue
    }

    /// Adds chains, in place of those that their edges were in.
    fn extend(&mut self, chains: Vec<Chain>) {
        for chain in chains {
            let edges = || chain.sides.iter().map(|&h| self.mesh.edge(h));
            let is_refused = edges().any(|e| self.refused.contains(&e));
            self.last.extend(edges().map(|e| (e, self.count)));
            if !is_refused {
                self.waiting.push(Waiting { chain, number: self.count });
            }
            self.count += 1;
        }
    }

    /// The longest one.
    fn pop(&mut self) -> Option<Chain> {
        while let Some(Waiting { chain, number }) = self.waiting.pop() {
            if self.last.get(&self.mesh.edge(chain.sides[0])) == Some(&number) {
                return Some(chain);
            }
        }
        None
    }

    /// Says that a chain cannot be glued, nor any that it becomes part of.
    fn refuse(&mut self, chain: &Chain) {
        self.refused.extend(chain.sides.iter().map(|&h| self.mesh.edge(h)));
    }
}

/// A chain and its number; the longest is the greatest.
struct Waiting {
    chain: Chain,
    number: usize,
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        other.chain.longer_first(&self.chain)
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Waiting {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flatten::flattened::Flattened;
    use geom::{VertexId, shapes};

    #[test]
    fn of_single_triangles_nothing_is_left_that_could_be_glued() {
        let mut chains = 0;
        for (shape, count) in [(shapes::hare(400), 12), (shapes::hare(900), 60), (shapes::torus(2, 800), 60)] {
            let cones: Vec<VertexId> = (0..count).map(|k| VertexId(5 + k * 12)).collect();
            let Flattened { mesh, metric, layout, .. } = Flattened::new(&shape, &cones);
            let position = mesh.halfedges().map(|h| [layout.corner(h).re, layout.corner(h).im]).collect();
            let map = UvMap { position, cut: EdgeData::constant(mesh.edge_count(), true) };
            let boxes = Boxes::new(map.triangles());
            let mut pieces = Pieces::new((&mesh, metric.lengths(), None), &map, &boxes, map.cut.clone());
            pieces.attach(Watch::NONE).unwrap();
            let left = pieces.chains();
            assert!(left.iter().all(|chain| !pieces.can_glue(chain)));
            chains += left.len();
            let islands = pieces.pieces.iter().filter(|pieces| !pieces.is_empty()).count();
            assert_eq!(islands, map_of(pieces, &map, &mesh).opened(&mesh).island_count());
        }
        assert!(chains > 10, "{chains} chains could not be glued");
    }

    /// What comes of pieces; each island is a disk.
    fn map_of(pieces: Pieces, before: &UvMap, mesh: &Mesh) -> UvMap {
        let map = pieces.moved().snapped(mesh, before.clone());
        let opened = map.opened(mesh);
        assert_eq!(opened.euler_characteristic(), opened.island_count() as i64);
        assert_eq!(opened.boundary_loops().len(), opened.island_count());
        for h in mesh.halfedges() {
            let length = |map: &UvMap| {
                let [[x, y], [z, w]] = [h, mesh.next(h)].map(|h| map.position[h]);
                (x - z).hypot(y - w)
            };
            assert!((length(&map) - length(before)).abs() < 1e-9 * before.extent());
        }
        map
    }
}
