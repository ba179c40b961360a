//! The hierarchy of cones (paper §3.2): the persistent extrema of the conformal factor, in order.
//!
//! Extrema come from [`topo`] on the intrinsic Delaunay triangulation's edges, where the Laplacian has no negative weights
//! and so no false extrema. Boundary vertices are no candidates: the boundary takes curvature anyway. Two orders:
//! [`Method::Alternating`], the paper's, a maximum and a minimum in turn; and [`Method::Persistence`], whatever is more
//! persistent, which spends no cones on maxima that take little curvature. Either is nested: the first n cones are a prefix
//! of the first n + 1. The other methods do not ask for extrema; they have their own modules and are compared here only.
//!
//! What the paper leaves open: a candidate within two edges of an earlier cone waits until the others are used up, since
//! such pairs are hard to flatten; and where extrema run out, the hierarchy goes on *greedily* with the vertex at which the
//! log scale factor pinned to 0 at the cones so far is largest in absolute value (as boundary first flattening does;
//! Sawhney & Crane 2017).

use geom::{Id, Mesh, VertexData, VertexId};
use topo::{Extremum, Hierarchy, Kind};

use crate::factor::ConformalFactor;
use crate::iterative::{greedy, iterative};
use crate::operators::Operators;
use crate::pinned::Pinned;
use crate::pursuit::pursuit;
use crate::reduced::Reduced;
use crate::refined::refined;

/// Cones nearer to each other than this many edges are avoided while there are others.
const LEAST_DISTANCE: usize = 3;

/// How cones are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The most persistent maximum, minimum, second maximum, second minimum, … as in the paper.
    Alternating,
    /// By persistence, whatever their sign.
    Persistence,
    /// The highest and the lowest point of φ, level by level with φ pinned to 0 at the cones ([`iterative`]).
    Iterative,
    /// One by one where the pinned φ is largest in absolute value ([`greedy`]).
    Greedy,
    /// The best set found of this very number ([`refined`](crate::refined())); not nested.
    #[default]
    Refined,
    /// The best nested order found ([`pursuit`](crate::pursuit())).
    Pursuit,
}

/// A place for a cone, with the extremum that it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The vertex.
    pub vertex: VertexId,
    /// The extremum of φ there, if there is one.
    pub extremum: Option<Extremum<VertexId, f64>>,
}

/// The extrema of a conformal factor, ranked for use as cones.
#[derive(Clone, Debug)]
pub struct ConeHierarchy {
    extrema: Hierarchy<VertexId, f64>,
}

impl ConeHierarchy {
    /// Pairs and ranks the extrema of φ. O(V log V).
    ///
    /// # Panics
    /// If φ has not one value, not NaN, for each vertex.
    pub fn new(operators: &Operators, factor: &ConformalFactor) -> Self {
        let mesh = &operators.mesh;
        let surface = topo::Rings::new(mesh, |v| !mesh.is_boundary_vertex(v));
        let persistence = topo::persistence(surface, &factor.phi).expect("φ has one finite value a vertex");
        Self { extrema: persistence.hierarchy() }
    }

    /// All extrema of φ, most persistent first, boundary vertices included.
    pub fn extrema(&self) -> &[Extremum<VertexId, f64>] {
        self.extrema.extrema()
    }

    /// The number of inner extrema with a persistence above a threshold.
    pub fn count_above(&self, operators: &Operators, threshold: f64) -> usize {
        let inner = |e: &&Extremum<VertexId, f64>| !operators.mesh.is_boundary_vertex(e.vertex);
        self.extrema.above(threshold).iter().filter(inner).count()
    }

    /// `count` cones; fewer only where the mesh has no more inner vertices. `input` is the triangulation that will be laid
    /// out.
    pub fn cones(&self, operators: &Operators, input: &Mesh, method: Method, count: usize) -> Vec<Candidate> {
        let all = self.extrema.extrema().len();
        match method {
            Method::Alternating => self.first(operators, self.extrema.alternating(all).copied(), count),
            Method::Persistence => self.first(operators, self.extrema.by_persistence(all).iter().copied(), count),
            Method::Iterative => self.candidates(&iterative(operators, count)),
            Method::Greedy => self.candidates(&greedy(operators, count)),
            Method::Refined => self.candidates(&refined(&mut Reduced::new(operators, input), count).cones),
            Method::Pursuit => self.candidates(pursuit(&mut Reduced::new(operators, input), count).cones()),
        }
    }

    /// Vertices with the extrema that they are.
    pub(crate) fn candidates(&self, cones: &[VertexId]) -> Vec<Candidate> {
        let extremum = |v: VertexId| self.extrema().iter().find(|e| e.vertex == v).copied();
        cones.iter().map(|&vertex| Candidate { vertex, extremum: extremum(vertex) }).collect()
    }

    /// The first extrema that are far enough from each other, then greedily.
    fn first(
        &self,
        operators: &Operators,
        ranked: impl Iterator<Item = Extremum<VertexId, f64>>,
        count: usize,
    ) -> Vec<Candidate> {
        let mut chosen = Chosen::new(operators);
        for extremum in ranked {
            if chosen.candidates.len() < count && chosen.is_far(extremum.vertex) {
                chosen.add(Candidate { vertex: extremum.vertex, extremum: Some(extremum) });
            }
        }
        chosen.go_on_greedily(&self.extrema, count);
        chosen.candidates
    }
}

/// Cones chosen so far, and where no further ones should go.
struct Chosen<'a> {
    operators: &'a Operators,
    candidates: Vec<Candidate>,
    /// Boundary vertices and cones.
    taken: VertexData<bool>,
    /// Vertices too near to a cone.
    near: VertexData<bool>,
}

impl<'a> Chosen<'a> {
    fn new(operators: &'a Operators) -> Self {
        let mesh = &operators.mesh;
        let taken: VertexData<bool> = mesh.vertices().map(|v| mesh.is_boundary_vertex(v)).collect();
        Self { operators, candidates: Vec::new(), near: taken.clone(), taken }
    }

    fn is_far(&self, v: VertexId) -> bool {
        !self.near[v]
    }

    fn add(&mut self, candidate: Candidate) {
        let mesh = &self.operators.mesh;
        self.candidates.push(candidate);
        self.taken[candidate.vertex] = true;
        self.near[candidate.vertex] = true;
        let mut rim = vec![candidate.vertex];
        for _ in 1..LEAST_DISTANCE {
            rim = rim.iter().flat_map(|&v| mesh.neighbors(v)).copied().collect();
            rim.iter().for_each(|&v| self.near[v] = true);
        }
    }

    /// Adds the vertices where the pinned log scale factor is largest, far ones as long as there are any: one for each
    /// solve at first, an eighth of the cones later. (The batches depend on nothing but what is there, so that fewer cones
    /// are still a prefix of more.)
    fn go_on_greedily(&mut self, extrema: &Hierarchy<VertexId, f64>, count: usize) {
        if self.candidates.len() >= count {
            return;
        }
        let mut pinned = Pinned::new(self.operators);
        while self.candidates.len() < count {
            let known = pinned.cones().len();
            let new: Vec<VertexId> = self.candidates[known..].iter().map(|c| c.vertex).collect();
            pinned.add(&new);
            let u = pinned.factor();
            let largest = |blocked: &VertexData<bool>| {
                let open = u.iter_ids().filter(|(v, _)| !blocked[*v]);
                open.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()).then(b.0.index().cmp(&a.0.index()))).map(|(v, _)| v)
            };
            for _ in 0..(1 + self.candidates.len() / 8).min(count - self.candidates.len()) {
                let Some(vertex) = largest(&self.near).or_else(|| largest(&self.taken)) else { return };
                let extremum = extrema.extrema().iter().find(|e| e.vertex == vertex).copied();
                self.add(Candidate { vertex, extremum });
            }
        }
    }
}

/// What a cone is called: by its extremum where it is one, otherwise by the sign of its curvature, since φ is low where the
/// surface sticks out.
pub(crate) fn kind_of(candidate: &Candidate, curvature: f64) -> Kind {
    match candidate.extremum {
        Some(extremum) => extremum.kind,
        None if curvature >= 0.0 => Kind::Minimum,
        None => Kind::Maximum,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::{Metric, shapes};

    fn hierarchy(shape: &shapes::Shape) -> (Operators, ConeHierarchy) {
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let hierarchy = ConeHierarchy::new(&operators, &ConformalFactor::new(&operators));
        (operators, hierarchy)
    }

    #[test]
    fn cones_are_nested_distinct_inner_vertices_as_many_as_asked_for() {
        for shape in [shapes::hare(1000), shapes::part(1000), shapes::terrain(900, 3), shapes::sphere(40)] {
            let (operators, hierarchy) = hierarchy(&shape);
            for method in [Method::Alternating, Method::Persistence, Method::Iterative, Method::Greedy] {
                let all = hierarchy.cones(&operators, &operators.mesh, method, 30);
                let inner = operators.mesh.vertices().filter(|&v| !operators.mesh.is_boundary_vertex(v)).count();
                assert_eq!(all.len(), inner.min(30));
                for count in [0, 1, 5, 12] {
                    assert_eq!(hierarchy.cones(&operators, &operators.mesh, method, count), all[..count]);
                }
                let mut vertices: Vec<VertexId> = all.iter().map(|c| c.vertex).collect();
                vertices.sort_unstable();
                vertices.dedup();
                assert_eq!(vertices.len(), all.len());
                assert!(vertices.iter().all(|&v| !operators.mesh.is_boundary_vertex(v)));
            }
        }
    }

    #[test]
    fn a_mesh_without_enough_inner_vertices_gives_what_it_has() {
        let (operators, hierarchy) = hierarchy(&shapes::square(9));
        let inner = operators.mesh.vertices().filter(|&v| !operators.mesh.is_boundary_vertex(v)).count();
        assert_eq!(hierarchy.cones(&operators, &operators.mesh, Method::Persistence, 100).len(), inner);
    }

    #[test]
    fn the_paper_takes_maxima_and_minima_in_turn() {
        let (operators, hierarchy) = hierarchy(&shapes::hare(2000));
        let kinds: Vec<Kind> = hierarchy
            .cones(&operators, &operators.mesh, Method::Alternating, 4)
            .iter()
            .map(|cone| cone.extremum.expect("there are enough extrema").kind)
            .collect();
        assert_eq!(kinds, [Kind::Maximum, Kind::Minimum, Kind::Maximum, Kind::Minimum]);
    }
}
