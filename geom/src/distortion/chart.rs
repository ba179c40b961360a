//! Which triangles of a map hang together.
//!
//! A *side* is that of a triangle from its corner k to the next, numbered 3f + k as its corner is. Two sides on one edge
//! of the surface face each other; they are glued where their ends' images agree. Where more than two meet all those are glued
//! whose images agree, in whatever order they come, and those that are left over face another one.

use std::collections::HashSet;

use petgraph::unionfind::UnionFind;

use crate::mesh::{FaceData, FaceId, Id, of_edges};
use crate::parallel::join;
use crate::watch::{Interrupted, Progress, Watch};

/// Images closer than this share of the map's extent are the same: files round, to six digits or to single precision, and each corner by itself.
const SAME_IMAGE: f64 = 1e-6;

/// The watch is asked once for so many pairs.
const STRIDE: usize = 2048;

/// How sides face each other and are glued.
pub(super) struct Charts {
    /// The sides that face each other.
    facing: Vec<Facing>,
    /// The image vertex of each corner, as a corner of it.
    vertex: Vec<u32>,
    /// Which sides face no other.
    is_boundary: Vec<bool>,
    /// Whether a triangle is turned against the first one of its island.
    is_turned: Vec<bool>,
    /// Which island a triangle is in.
    pub(super) island: FaceData<u32>,
    /// How many islands there are.
    pub(super) count: usize,
}

/// Two sides on one edge.
#[derive(Clone, Copy)]
pub(super) struct Facing {
    pub(super) sides: [u32; 2],
    /// Whether they run in the same direction: their triangles are turned against each other.
    is_parallel: bool,
    is_glued: bool,
}

/// The corner at a side's other end.
pub(super) fn end(side: u32) -> u32 {
    if side % 3 == 2 { side - 2 } else { side + 1 }
}

impl Charts {
    pub(super) fn new(
        vertex_count: usize,
        triangles: &[[u32; 3]],
        uv: &[[[f64; 2]; 3]],
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        let is_same = same_image(uv.as_flattened());
        let facing = face_sides(vertex_count, triangles.as_flattened(), is_same, watch.within(0.0, 0.4))?;
        let glued = || (0..).zip(&facing).filter(|(_, pair)| pair.is_glued);
        let sides = 3 * triangles.len();
        let vertices = |watch: Watch| {
            let mut vertices = UnionFind::new(sides);
            for (k, pair) in glued() {
                watch.ask_at_step(k, 2 * facing.len())?;
                pair.corners_at_ends().into_iter().for_each(|[c, d]| _ = vertices.union(c, d));
            }
            watch.ask(0.5)?;
            Ok(vertices.into_labeling())
        };
        let islands = |watch: Watch| {
            let mut islands = UnionFind::new(triangles.len());
            for (k, pair) in glued() {
                watch.ask_at_step(k, 2 * facing.len())?;
                islands.union(pair.sides[0] / 3, pair.sides[1] / 3);
            }
            watch.ask(0.5)?;
            let numbered = numbered(&mut islands);
            watch.ask(0.7)?;
            let mut is_boundary = vec![true; sides];
            facing.iter().flat_map(|pair| pair.sides).for_each(|side| is_boundary[side as usize] = false);
            watch.ask(0.8)?;
            Ok((numbered, is_boundary, turned(triangles.len(), &facing)))
        };
        let (vertex, islands) = watch.within(0.4, 1.0).shared(|watch| join(|| vertices(watch), || islands(watch)));
        let (vertex, ((island, count), is_boundary, is_turned)) = (vertex?, islands?);
        Ok(Self { facing, vertex, is_boundary, is_turned, island: island.into(), count })
    }

    /// The sides that face each other and are not glued.
    pub(super) fn seam(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.facing.iter().filter(|pair| !pair.is_glued).map(|pair| pair.sides)
    }

    /// The sides on the surface's own boundary.
    pub(super) fn boundary_sides(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.is_boundary.len() as u32).filter(|&side| self.is_boundary[side as usize])
    }

    /// -1 for a triangle that is turned against the first one of its island, else 1.
    pub(super) fn orientation(&self, face: usize) -> f64 {
        if self.is_turned[face] { -1.0 } else { 1.0 }
    }

    /// V - E + F of each island.
    pub(super) fn euler_characteristics(&self) -> Vec<i64> {
        let mut chi = vec![0; self.count];
        for (f, corners) in self.vertex.chunks_exact(3).enumerate() {
            let vertices = (0..).zip(corners).filter(|&(k, &vertex)| vertex == 3 * f as u32 + k).count();
            chi[self.island[FaceId::new(f)] as usize] += vertices as i64 - 3 + 1;
        }
        for pair in self.facing.iter().filter(|pair| pair.is_glued) {
            chi[self.island_of(pair.sides[0])] += 1;
        }
        chi
    }

    /// The vertices inside the surface that several fans of triangles share, with no edge between them, once for each fan but the first.
    pub(super) fn further_fans(&self, corner_vertex: &[u32], is_inside: &[bool]) -> Vec<u32> {
        // A fan that no seam runs into has one image of its vertex.
        let mut image = vec![None; is_inside.len()];
        let mut has_images = vec![false; is_inside.len()];
        for (&v, &vertex) in corner_vertex.iter().zip(&self.vertex) {
            has_images[v as usize] |= *image[v as usize].get_or_insert(vertex) != vertex;
        }
        let is_asked = |corner: u32| {
            let v = corner_vertex[corner as usize] as usize;
            is_inside[v] && has_images[v]
        };
        let asked: Vec<u32> = (0..corner_vertex.len() as u32).filter(|&corner| is_asked(corner)).collect();
        if asked.is_empty() {
            return Vec::new();
        }
        let mut fans = UnionFind::new(corner_vertex.len());
        for [c, d] in self.facing.iter().flat_map(|pair| pair.corners_at_ends()).filter(|&[c, _]| is_asked(c)) {
            fans.union(c, d);
        }
        let firsts = asked.into_iter().filter(|&corner| fans.find(corner) == corner);
        let mut has_one = HashSet::new();
        firsts.map(|corner| corner_vertex[corner as usize]).filter(|&v| !has_one.insert(v)).collect()
    }

    /// How many loops bound each island.
    pub(super) fn boundary_loops(&self) -> Vec<usize> {
        let mut open = vec![true; self.vertex.len()];
        for pair in self.facing.iter().filter(|pair| pair.is_glued) {
            pair.sides.into_iter().for_each(|side| open[side as usize] = false);
        }
        let open_sides: Vec<u32> = (0..self.vertex.len() as u32).filter(|&side| open[side as usize]).collect();
        let ends = |side: u32| [side, end(side)].map(|corner| self.vertex[corner as usize]);
        let mut vertices: Vec<u32> = open_sides.iter().flat_map(|&side| ends(side)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let number = |vertex: u32| vertices.partition_point(|&v| v < vertex);
        let mut loops = UnionFind::<usize>::new(vertices.len());
        for &side in &open_sides {
            let [from, to] = ends(side).map(number);
            loops.union(from, to);
        }
        let mut counts = vec![0; self.count];
        let mut is_counted = vec![false; vertices.len()];
        for &side in &open_sides {
            let root = loops.find_mut(number(ends(side)[0]));
            if !std::mem::replace(&mut is_counted[root], true) {
                counts[self.island_of(side)] += 1;
            }
        }
        counts
    }

    fn island_of(&self, side: u32) -> usize {
        self.island[FaceId(side / 3)] as usize
    }
}

impl Facing {
    /// The corners of both sides at either end.
    fn corners_at_ends(self) -> [[u32; 2]; 2] {
        let [a, b] = self.sides;
        if self.is_parallel { [[a, b], [end(a), end(b)]] } else { [[a, end(b)], [end(a), b]] }
    }
}

/// Pairs the sides on each edge.
fn face_sides(
    vertex_count: usize,
    corner_vertex: &[u32],
    is_same_image: impl Fn(u32, u32) -> bool + Sync,
    watch: Watch,
) -> Result<Vec<Facing>, Interrupted> {
    let progress = Progress::new(watch, corner_vertex.len() / 2);
    let vertex = |side: usize| corner_vertex[side];
    let facing = |sides: [u32; 2]| {
        let is_parallel = vertex(sides[0] as usize) == vertex(sides[1] as usize);
        let pair = Facing { sides, is_parallel, is_glued: false };
        let is_glued = pair.corners_at_ends().into_iter().all(|[c, d]| is_same_image(c, d));
        Facing { is_glued, ..pair }
    };
    let visit = |found: &mut Vec<Facing>, _, sides: &[u32]| {
        if found.len().is_multiple_of(STRIDE) {
            progress.add(STRIDE);
            progress.ask()?;
        }
        match *sides {
            [] | [_] => {}
            [a, b] => found.push(facing([a, b])),
            ref many => found.extend(facing_of_many(many, facing)),
        }
        Ok(())
    };
    let parts = of_edges(vertex_count, corner_vertex.len(), vertex, visit);
    Ok(parts.into_iter().collect::<Result<Vec<_>, Interrupted>>()?.concat())
}

/// Of more than two sides on one edge those that are glued, in chains, and for each that is left over another one that it faces.
fn facing_of_many(sides: &[u32], facing: impl Fn([u32; 2]) -> Facing) -> Vec<Facing> {
    let mut chains: Vec<Vec<u32>> = Vec::new();
    let mut found = Vec::new();
    for &side in sides {
        let glued = chains.iter_mut().find_map(|chain| {
            let pair = facing([chain[chain.len() - 1], side]);
            pair.is_glued.then_some((chain, pair))
        });
        match glued {
            Some((chain, pair)) => {
                chain.push(side);
                found.push(pair);
            }
            None => chains.push(vec![side]),
        }
    }
    for k in 0..chains.len() {
        let other = if k > 0 { k - 1 } else { 1 };
        if let ([alone], Some(others)) = (&chains[k][..], chains.get(other)) {
            // The second one by itself is counted at its own turn.
            if other < k || others.len() > 1 {
                found.push(facing([others[0], *alone]));
            }
        }
    }
    found
}

/// Whether two corners have the same image.
fn same_image(uv: &[[f64; 2]]) -> impl Fn(u32, u32) -> bool + '_ {
    let extent = |axis: usize| {
        let range = uv.iter().fold([f64::MAX, f64::MIN], |[low, high], q| [q[axis].min(low), q[axis].max(high)]);
        range[1] - range[0]
    };
    let tolerance = SAME_IMAGE * extent(0).max(extent(1));
    move |c, d| {
        let [p, q] = [uv[c as usize], uv[d as usize]];
        (p[0] - q[0]).abs() <= tolerance && (p[1] - q[1]).abs() <= tolerance
    }
}

/// Which triangles are turned against the first one of their island; none in an island that cannot be oriented.
fn turned(face_count: usize, facing: &[Facing]) -> Vec<bool> {
    let mut is_turned = vec![false; face_count];
    let glued = || facing.iter().filter(|pair| pair.is_glued);
    if glued().all(|pair| !pair.is_parallel) {
        return is_turned;
    }
    let mut neighbors = vec![Vec::new(); face_count];
    for pair in glued() {
        let [f, g] = pair.sides.map(|side| side / 3);
        neighbors[f as usize].push((g, pair.is_parallel));
        neighbors[g as usize].push((f, pair.is_parallel));
    }
    let mut is_seen = vec![false; face_count];
    for seed in 0..face_count {
        if std::mem::replace(&mut is_seen[seed], true) {
            continue;
        }
        let mut island = vec![seed];
        let mut can_be_oriented = true;
        let mut at = 0;
        while at < island.len() {
            let f = island[at];
            at += 1;
            for &(g, is_parallel) in &neighbors[f] {
                let turned = is_turned[f] != is_parallel;
                if !std::mem::replace(&mut is_seen[g as usize], true) {
                    is_turned[g as usize] = turned;
                    island.push(g as usize);
                }
                can_be_oriented &= is_turned[g as usize] == turned;
            }
        }
        if !can_be_oriented {
            island.into_iter().for_each(|f| is_turned[f] = false);
        }
    }
    is_turned
}

/// The number of each element's set, in the order of their least elements, and how many there are.
fn numbered(sets: &mut UnionFind<u32>) -> (Vec<u32>, usize) {
    let elements = 0..sets.len() as u32;
    let mut of_root = vec![u32::MAX; elements.len()];
    let mut count = 0;
    let number = |x| {
        let number = &mut of_root[sets.find_mut(x) as usize];
        if *number == u32::MAX {
            *number = count;
            count += 1;
        }
        *number
    };
    let numbers = elements.map(number).collect();
    (numbers, count as usize)
}
