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

use std::collections::HashSet;

use geom::{CutMesh, EdgeData, FaceData, FaceId, HalfedgeId, Interrupted, Mesh, Watch};

use super::boxes::{Boxes, bounds};
use super::chains::{Chain, Loops};
use super::map::UvMap;
use super::motion::Motion;
use super::overlap::{NEGLIGIBLE_DEPTH, Overlap};
use super::triangle;

/// Glued islands may overlap by this share of [`NEGLIGIBLE_DEPTH`], so that they do not overlap after some rounding.
pub(super) const ALLOWED: f64 = 0.5;
/// Triangles of an island are tried in steps of so many, so that an overlap anywhere is soon found.
pub(super) const STRIDE: usize = 29;

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
    /// All triangles as they lay at first.
    boxes: &'a Boxes<'a>,
    /// The bounding box of each piece as it lay at first; none without area.
    bounds: Vec<Option<[[f64; 2]; 2]>>,
    /// The area of each piece in the plane.
    area: Vec<f64>,
    motion: Vec<Motion>,
    /// The island of each piece.
    island: Vec<u32>,
    /// The pieces of each island.
    pieces: Vec<Vec<u32>>,
    cut: EdgeData<bool>,
    loops: Loops<'a>,
}

/// What has become of a map that was put together otherwise.
pub(super) struct Moved {
    /// The piece of each triangle.
    piece: FaceData<u32>,
    motion: Vec<Motion>,
    cut: EdgeData<bool>,
}

impl Moved {
    /// The map; where pieces meet, positions agree but for rounding ([`UvMap::snapped`]).
    pub(super) fn map(&self, before: &UvMap) -> UvMap {
        let mut map = before.clone();
        self.put(&mut map);
        map
    }

    /// The map in place of the one before, each vertex in one place.
    pub(super) fn snapped(self, mesh: &Mesh, mut map: UvMap) -> UvMap {
        self.put(&mut map);
        map.snapped(mesh, |_, h| self.motion[self.piece[mesh.face(h)] as usize] == Motion::NONE)
    }

    fn put(&self, map: &mut UvMap) {
        for (corners, &piece) in map.position.as_chunks_mut::<3>().0.iter_mut().zip(self.piece.iter()) {
            let motion = &self.motion[piece as usize];
            if *motion != Motion::NONE {
                *corners = motion.of_triangle(*corners);
            }
        }
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
        let opened = CutMesh::open(mesh, &cut);
        let count = opened.island_count();
        let piece: FaceData<u32> = mesh.faces().map(|f| opened.island(f)).collect();
        let mut faces = vec![Vec::new(); count];
        mesh.faces().for_each(|f| faces[piece[f] as usize].push(f));
        Self {
            mesh,
            map,
            lengths,
            kept,
            extent: map.extent(),
            piece,
            boxes,
            bounds: faces.iter().map(|faces| boxes.bounds_of(faces.iter().map(|f| f.0))).collect(),
            area: faces.iter().map(|faces| faces.iter().map(|f| boxes.area(f.0)).sum()).collect(),
            faces,
            motion: vec![Motion::NONE; count],
            island: (0..count as u32).collect(),
            pieces: (0..count as u32).map(|p| vec![p]).collect(),
            cut,
            loops: Loops::new(mesh, &opened),
        }
    }

    /// Glues what can be glued.
    pub(super) fn attach(&mut self, watch: Watch) -> Result<(), Interrupted> {
        let mut glued = 0;
        // Chains that were tried, with the numbers of pieces that their islands had.
        let mut tried: HashSet<(HalfedgeId, HalfedgeId, [usize; 2])> = HashSet::new();
        let all = self.pieces.len().max(2) - 1;
        let mut chains = self.chains();
        loop {
            let mut found = None;
            for (k, chain) in chains.iter().enumerate() {
                watch.ask(glued as f64 / all as f64)?;
                let sizes = chain.islands.map(|island| self.pieces[island as usize].len());
                let key = (chain.sides[0], chain.sides[chain.sides.len() - 1], sizes);
                if tried.insert(key) && self.can_glue(chain) {
                    found = Some(k);
                    break;
                }
            }
            let Some(k) = found else { return Ok(()) };
            let chain = chains.swap_remove(k);
            self.glue(&chain);
            glued += 1;
            // Other chains than those of the two islands stay as they are.
            chains.retain(|other| !other.islands.iter().any(|island| chain.islands.contains(island)));
            let merged = self.island_of(chain.sides[0]);
            chains.extend(self.chains_between(|islands| islands[0] < islands[1] && islands.contains(&merged)));
            chains.sort_by(Chain::longer_first);
        }
    }

    /// The chains between different islands, longest first.
    pub(super) fn chains(&self) -> Vec<Chain> {
        self.chains_between(|[one, other]| one < other)
    }

    fn chains_between(&self, asked: impl Fn([u32; 2]) -> bool) -> Vec<Chain> {
        self.loops.chains(
            asked,
            (|h| self.island_of(h), |e| self.kept.is_some_and(|kept| kept[e])),
            |h| self.motion[self.piece[self.mesh.face(h)] as usize].of(self.map.position[h]),
            self.lengths,
            self.extent,
        )
    }

    fn island_of(&self, h: HalfedgeId) -> u32 {
        self.island[self.piece[self.mesh.face(h)] as usize]
    }

    fn size(&self, island: u32) -> usize {
        self.pieces[island as usize].iter().map(|&p| self.faces[p as usize].len()).sum()
    }

    /// The smaller of a chain's islands, the larger, and the motion that takes the smaller to it.
    fn gluing(&self, chain: &Chain) -> (u32, u32, Motion) {
        let [left, right] = chain.islands;
        match self.size(left) < self.size(right) {
            true => (left, right, chain.motion.inverse()),
            false => (right, left, chain.motion),
        }
    }

    /// Whether the two islands of a chain lie beside each other when it is glued; see the module's head.
    fn can_glue(&self, chain: &Chain) -> bool {
        let area = |island: u32| self.pieces[island as usize].iter().map(|&p| self.area[p as usize]).sum::<f64>();
        let [left, right] = chain.islands;
        let (small, large, motion) = match area(left) < area(right) {
            true => (left, right, chain.motion.inverse()),
            false => (right, left, chain.motion),
        };
        self.pieces[small as usize].iter().all(|&p| {
            let tested = self.boundary(p);
            self.pieces[large as usize].iter().all(|&q| {
                let motion = self.between([p, q], &motion);
                match self.faces[q as usize].len() < tested.len() {
                    true => self.meetings_of([q, p], &self.faces[q as usize], &motion.inverse(), &mut |_| false),
                    false => self.meetings_of([p, q], &tested, &motion, &mut |_| false),
                }
            })
        })
    }

    /// The triangles of a piece that are on the boundary of its island; all of them where one of these has no area.
    fn boundary(&self, p: u32) -> Vec<FaceId> {
        let of_piece = |f: &FaceId| self.piece[*f] == p;
        let mut found: Vec<FaceId> = self.loops.all().iter().map(|&h| self.mesh.face(h)).filter(of_piece).collect();
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

    /// The pairs of triangles that lie over each other when a chain is glued; none if there are too many.
    pub(super) fn overlaps_when_glued(&self, chain: &Chain, most: usize) -> Option<Vec<Overlap>> {
        let mut pairs = Vec::new();
        let is_all = self.meetings(chain, |pair| {
            pairs.push(pair);
            pairs.len() <= most
        });
        is_all.then_some(pairs)
    }

    /// Visits the pairs of triangles that lie over each other when a chain is glued, as long as the visitor says to go on;
    /// whether it always has.
    fn meetings(&self, chain: &Chain, mut visit: impl FnMut(Overlap) -> bool) -> bool {
        let (small, large, motion) = self.gluing(chain);
        for &p in &self.pieces[small as usize] {
            for &q in &self.pieces[large as usize] {
                let motion = self.between([p, q], &motion);
                let [faces, others] = [p, q].map(|piece| &self.faces[piece as usize]);
                let goes_on = match faces.len() > others.len() {
                    true => self.meetings_of([q, p], others, &motion.inverse(), &mut visit),
                    false => self.meetings_of([p, q], faces, &motion, &mut visit),
                };
                if !goes_on {
                    return false;
                }
            }
        }
        true
    }

    /// The same for some triangles of a piece and all of another, `motion` taking the first to where the second lay at first.
    fn meetings_of(
        &self,
        [p, q]: [u32; 2],
        few: &[FaceId],
        motion: &Motion,
        visit: &mut impl FnMut(Overlap) -> bool,
    ) -> bool {
        let [moved, still] = [p, q].map(|piece| self.bounds[piece as usize]);
        if !may_meet(moved, still, motion) {
            return true;
        }
        let least = ALLOWED * NEGLIGIBLE_DEPTH * self.extent;
        let mut goes_on = true;
        for k in (0..STRIDE).flat_map(|first| (first..few.len()).step_by(STRIDE)) {
            let Some(one) = self.boxes.upright(few[k].0).map(|corners| motion.of_triangle(corners)) else {
                continue;
            };
            self.boxes.meeting(&one, |g| {
                if self.piece[FaceId(g)] == q
                    && let Some(other) = self.boxes.upright(g)
                    && let Some(depth) = triangle::depth(&one, &other).filter(|&depth| depth > least)
                {
                    let f = few[k].0;
                    let area = triangle::common_area(&one, &other);
                    goes_on = visit(Overlap { triangles: [f.min(g), f.max(g)], depth: depth / self.extent, area });
                }
                goes_on
            });
            if !goes_on {
                return false;
            }
        }
        true
    }

    /// Glues a chain.
    pub(super) fn glue(&mut self, chain: &Chain) {
        let (small, large, motion) = self.gluing(chain);
        let moved = std::mem::take(&mut self.pieces[small as usize]);
        for &p in &moved {
            self.motion[p as usize] = motion.after(&self.motion[p as usize]);
            self.island[p as usize] = large;
        }
        self.pieces[large as usize].extend(moved);
        chain.sides.iter().for_each(|&h| self.cut[self.mesh.edge(h)] = false);
        self.loops.glue(chain);
    }

    /// What has become of the map.
    pub(super) fn moved(self) -> Moved {
        Moved { piece: self.piece, motion: self.motion, cut: self.cut }
    }

    /// How many triangles each island has.
    pub(super) fn sizes(&self) -> Vec<usize> {
        (0..self.pieces.len() as u32).map(|island| self.size(island)).filter(|&size| size > 0).collect()
    }

    /// Where the map is open.
    pub(super) fn cut(&self) -> &EdgeData<bool> {
        &self.cut
    }
}

/// Whether bounding boxes meet where the first is moved.
fn may_meet(moved: Option<[[f64; 2]; 2]>, still: Option<[[f64; 2]; 2]>, motion: &Motion) -> bool {
    let (Some([low, high]), Some(still)) = (moved, still) else { return false };
    let corners = [low, [high[0], low[1]], high, [low[0], high[1]]].map(|corner| motion.of(corner));
    let [low, high] = bounds(&corners);
    (0..2).all(|i| low[i] <= still[1][i] && still[0][i] <= high[i])
}
