//! Vertices on the edges of other faces (T-junctions), where a surface is open though no gap can be seen.
//!
//! Meshes of merged quads, as greedy meshing of voxels gives them, and unions from CAD have a long edge of one face against several short ones of others.
//! They share no edge, and so the surface has a boundary there. It is closed if the face with the long edge gains a corner at each vertex that lies on it:
//! a corner on a straight side, which changes no shape.
//!
//! Only the boundary is looked at, and a corner is put in only where that closes something: the pieces that edges are cut into must lie on others, run
//! against these and bound the same wedge of the solid, as for [edges where bodies touch](super::radial). Boundaries that merely touch, a sheet on
//! another, faces that are oriented against each other and the sides of what has no area stay as they are.

use std::collections::{HashMap, HashSet};

use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree, RTreeObject, SelectionFunction};

use super::model::{Model, place_key};
use super::radial::{RadialFace, solid_pairs};
use crate::vector::{Vec3, cross, distance, dot, step, sub};

/// A vertex at most so far from an edge, as a share of the extent of all that is open, lies on it: what files round in single precision, but no gap that
/// anybody meant.
const ON_THE_EDGE: f64 = 1e-7;

/// Each edge may have so many vertices of others on it, on average. Where there are more, all of them lie on a few lines and there is no surface; only the
/// time would grow with the square of their number.
const MOST_ON_AN_EDGE: usize = 16;

/// A side of a face at the boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenSide {
    pub(super) face: u32,
    /// The model's corner where it starts.
    pub(super) corner: u32,
    /// The vertices that it is between.
    pub(super) ends: [u32; 2],
    /// The third vertex of its triangle.
    pub(super) apex: u32,
}

/// A corner that a face gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Insertion {
    /// The model's corner that it comes after.
    pub(super) corner: u32,
    /// How far it is along the side that starts there, between 0 and 1.
    pub(super) along: f64,
    /// Its vertex.
    pub(super) vertex: u32,
    /// The first vertex at its place.
    pub(super) place: u32,
}

/// The corners that faces have to gain so that a surface is closed at its T-junctions, side by side in the order of corners, along each side in order.
/// Vertices at one place are told apart if they are not `joined`. O(n log n) in the number of sides.
pub(super) fn t_junctions(model: &Model, sides: &[OpenSide], joined: bool) -> Vec<Insertion> {
    Junctions::new(model, sides, joined).map_or_else(Vec::new, |junctions| junctions.insertions())
}

/// What lies at the boundary of a surface.
struct Junctions<'a> {
    model: &'a Model,
    sides: &'a [OpenSide],
    /// The first vertex at the place of each that is at the boundary.
    place: HashMap<u32, u32>,
    /// Where positions are moved to the origin from, and what they are divided by.
    centre: Vec3,
    extent: f64,
}

/// A part of a side between vertices that lie on it.
#[derive(Clone, Copy)]
struct Piece {
    /// The places that it is between, ascending.
    ends: [u32; 2],
    side: u32,
    /// Whether it runs from the lower place to the higher one.
    is_forward: bool,
}

/// A place on a side where something is closed.
#[derive(Clone, Copy)]
struct Needed {
    side: u32,
    place: u32,
    /// A vertex there of a face that is joined, if it has one there, and how parallel that face is.
    vertex: Option<(u32, f64)>,
}

impl<'a> Junctions<'a> {
    /// None if there is nothing with any extent.
    fn new(model: &'a Model, sides: &'a [OpenSide], joined: bool) -> Option<Self> {
        let mut vertices: Vec<u32> = sides.iter().flat_map(|side| side.ends).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mut first = HashMap::new();
        let key = |v: u32| place_key(&model.points()[v as usize]);
        let place = |&v: &u32| (v, if joined { *first.entry(key(v)).or_insert(v) } else { v });
        let place: HashMap<u32, u32> = vertices.iter().map(place).collect();
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &v in &vertices {
            for (k, x) in model.points()[v as usize].into_iter().enumerate() {
                (low[k], high[k]) = (x.min(low[k]), x.max(high[k]));
            }
        }
        let extent = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let centre = std::array::from_fn(|k| 0.5 * low[k] + 0.5 * high[k]);
        (extent > 0.0).then_some(Self { model, sides, place, centre, extent })
    }

    fn insertions(&self) -> Vec<Insertion> {
        let Some(on_side) = self.on_sides() else { return Vec::new() };
        if on_side.iter().all(Vec::is_empty) {
            return Vec::new();
        }
        let mut needed = self.needed(&on_side);
        needed.sort_by_key(|needed| (needed.side, needed.place));
        let mut found: Vec<Insertion> = Vec::new();
        for at_one in needed.chunk_by(|a, b| (a.side, a.place) == (b.side, b.place)) {
            let Needed { side, place, .. } = at_one[0];
            let along = on_side[side as usize].iter().find(|on| on.1 == place).map_or(0.5, |on| on.0);
            let vertices = at_one.iter().filter_map(|needed| needed.vertex);
            let best = vertices.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
            let vertex = best.map_or(place, |(vertex, _)| vertex);
            found.push(Insertion { corner: self.sides[side as usize].corner, along, vertex, place });
        }
        found.sort_by(|a, b| a.corner.cmp(&b.corner).then(a.along.total_cmp(&b.along)).then(a.place.cmp(&b.place)));
        self.without_repeated(found)
    }

    /// For each side the places that lie on it, with how far along they are, ascending; none if there are too many.
    fn on_sides(&self) -> Option<Vec<Vec<(f64, u32)>>> {
        let mut places: Vec<u32> = self.place.values().copied().collect();
        places.sort_unstable();
        places.dedup();
        let entries = places.into_iter().map(|place| GeomWithData::new(self.at(place), place)).collect();
        let tree = RTree::bulk_load(entries);
        let mut left = MOST_ON_AN_EDGE * self.sides.len();
        let mut on_sides = Vec::with_capacity(self.sides.len());
        for side in self.sides {
            let near = NearSegment { ends: side.ends.map(|v| self.at(v)) };
            let mut on: Vec<(f64, u32)> = Vec::new();
            for entry in tree.locate_with_selection_function(near) {
                if let Some(along) = near.along(*entry.geom()) {
                    left = left.checked_sub(1)?;
                    on.push((along, entry.data));
                }
            }
            on.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            on_sides.push(on);
        }
        Some(on_sides)
    }

    /// Where pieces of sides can be glued to others.
    fn needed(&self, on_sides: &[Vec<(f64, u32)>]) -> Vec<Needed> {
        let mut pieces = Vec::new();
        for (side, on) in (0..).zip(on_sides) {
            let [start, end] = self.places(side);
            let stops: Vec<u32> = [start].into_iter().chain(on.iter().map(|on| on.1)).chain([end]).collect();
            pieces.extend(stops.windows(2).map(|stop| Piece {
                ends: [stop[0].min(stop[1]), stop[0].max(stop[1])],
                side,
                is_forward: stop[0] < stop[1],
            }));
        }
        pieces.sort_by_key(|piece| (piece.ends, piece.side));
        let is_cut = |piece: &Piece| !on_sides[piece.side as usize].is_empty();
        let mut needed = Vec::new();
        for at_one in pieces.chunk_by(|a, b| a.ends == b.ends) {
            if at_one.iter().any(is_cut) && self.can_be_glued(at_one) {
                at_one.iter().for_each(|piece| needed.extend(self.needed_by(piece, at_one)));
            }
        }
        needed
    }

    /// Whether pieces at one place are of different faces that bound the same wedges of a solid.
    fn can_be_glued(&self, pieces: &[Piece]) -> bool {
        let mut faces: Vec<u32> = pieces.iter().map(|piece| self.sides[piece.side as usize].face).collect();
        faces.sort_unstable();
        if pieces.len() < 2 || faces.windows(2).any(|pair| pair[0] == pair[1]) {
            return false;
        }
        let radial = |piece: &Piece| RadialFace {
            apex: self.at(self.sides[piece.side as usize].apex),
            is_forward: piece.is_forward,
        };
        solid_pairs(pieces[0].ends.map(|v| self.at(v)), &pieces.iter().map(radial).collect::<Vec<_>>()).is_some()
    }

    /// The ends of a piece that are no ends of its side.
    fn needed_by(&self, piece: &Piece, at_one: &[Piece]) -> impl Iterator<Item = Needed> {
        let own = self.places(piece.side);
        let normal = self.normal(piece.side);
        piece.ends.into_iter().filter(move |place| !own.contains(place)).flat_map(move |place| {
            let corner_of = move |other: &Piece| {
                let k = self.places(other.side).iter().position(|&end| end == place)?;
                Some((self.sides[other.side as usize].ends[k], dot(normal, self.normal(other.side))))
            };
            let of_others: Vec<(u32, f64)> = at_one.iter().filter_map(corner_of).collect();
            let known = !of_others.is_empty();
            let none = (!known).then_some(Needed { side: piece.side, place, vertex: None });
            let of_others = of_others.into_iter().map(Some);
            none.into_iter().chain(of_others.map(move |vertex| Needed { side: piece.side, place, vertex }))
        })
    }

    /// The same without those of faces that would have a place twice.
    fn without_repeated(&self, found: Vec<Insertion>) -> Vec<Insertion> {
        let model = self.model;
        let face_of =
            |insertion: &Insertion| model.face_start().partition_point(|&start| start <= insertion.corner) - 1;
        let of_one_face = found.chunk_by(|a, b| face_of(a) == face_of(b));
        let is_simple = |of_one: &&[Insertion]| {
            let own = model.face(face_of(&of_one[0])).iter().map(|v| self.place.get(v).unwrap_or(v));
            let own: HashSet<u32> = own.copied().collect();
            let mut new = HashSet::new();
            of_one.iter().all(|insertion| !own.contains(&insertion.place) && new.insert(insertion.place))
        };
        of_one_face.filter(is_simple).flatten().copied().collect()
    }

    /// A vertex, moved to the origin and scaled to unit size.
    fn at(&self, v: u32) -> Vec3 {
        let point = self.model.points()[v as usize];
        std::array::from_fn(|k| (point[k] - self.centre[k]) / self.extent)
    }

    fn places(&self, side: u32) -> [u32; 2] {
        self.sides[side as usize].ends.map(|v| self.place[&v])
    }

    /// The normal of the triangle of a side, of length 1; 0 if it has none.
    fn normal(&self, side: u32) -> Vec3 {
        let OpenSide { ends: [a, b], apex, .. } = self.sides[side as usize];
        let [a, b, c] = [a, b, apex].map(|v| self.at(v));
        let normal = cross(sub(b, a), sub(c, a));
        let length = dot(normal, normal).sqrt();
        if length > 0.0 { normal.map(|x| x / length) } else { [0.0; 3] }
    }
}

/// What is near a segment in unit size.
#[derive(Clone, Copy)]
struct NearSegment {
    ends: [Vec3; 2],
}

impl NearSegment {
    /// How far along the segment a point is that lies on it, its ends excepted.
    fn along(&self, point: Vec3) -> Option<f64> {
        let [start, end] = self.ends;
        let way = sub(end, start);
        let along = dot(sub(point, start), way) / dot(way, way);
        let is_on = along > 0.0
            && along < 1.0
            && distance(point, step(start, along, way)) <= ON_THE_EDGE
            && self.ends.iter().all(|&end| distance(point, end) > ON_THE_EDGE);
        is_on.then_some(along)
    }
}

impl SelectionFunction<GeomWithData<Vec3, u32>> for NearSegment {
    /// Whether the segment runs through a box, by the intervals that it is between the planes of opposite faces.
    fn should_unpack_parent(&self, envelope: &AABB<Vec3>) -> bool {
        let [start, end] = self.ends;
        let (low, high) = (envelope.lower(), envelope.upper());
        // Most boxes are beside the segment's own.
        let is_beside =
            |k: usize| start[k].min(end[k]) > high[k] + ON_THE_EDGE || start[k].max(end[k]) < low[k] - ON_THE_EDGE;
        if (0..3).any(is_beside) {
            return false;
        }
        let mut inside = [0.0_f64, 1.0];
        for k in (0..3).filter(|&k| start[k] != end[k]) {
            let way = end[k] - start[k];
            let [a, b] = [low[k] - ON_THE_EDGE, high[k] + ON_THE_EDGE].map(|plane| (plane - start[k]) / way);
            inside = [inside[0].max(a.min(b)), inside[1].min(a.max(b))];
        }
        inside[0] <= inside[1]
    }

    fn should_unpack_leaf(&self, leaf: &GeomWithData<Vec3, u32>) -> bool {
        self.should_unpack_parent(&leaf.envelope())
    }
}
