//! The hierarchy of cones (paper §3.2): the persistent extrema of the conformal factor, in order.
//!
//! Extrema come from [`topo`] on the intrinsic Delaunay triangulation's edges, where the Laplacian has no negative weights
//! and so no false extrema. Boundary vertices are no candidates: the boundary takes curvature anyway. Two orders:
//! the paper's, a maximum and a minimum in turn ([`ConeHierarchy::alternating`]); and by persistence alone
//! ([`ConeHierarchy::by_persistence`]), which spends no cones on maxima that take little curvature. Either is nested: the
//! first n cones are a prefix of the first n + 1.
//!
//! What the paper leaves open: a candidate within two edges of an earlier cone waits until the others are used up, since
//! such pairs are hard to flatten; and where extrema run out, the hierarchy goes on *greedily* with the vertex at which the
//! log scale factor pinned to 0 at the cones so far is largest in absolute value (as boundary first flattening does;
//! Sawhney & Crane 2017).

use geom::{Id, VertexData, VertexId, Watch};
use topo::{Extremum, Hierarchy};

use crate::field::{ConformalFactor, Operators, PinnedFactor};

/// Cones nearer to each other than this many edges are avoided while there are others.
const LEAST_DISTANCE: usize = 3;

/// With more cones than these the log scale factor comes from a factorization with them pinned. What it takes to add cones to one that is known grows
/// with their square: 2,000 of a hare of 7,982 vertices took 2.8 s in that way, and all of it 180 s.
const MANY: usize = 512;

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

    /// The extremum that a vertex is, if it is one.
    pub(crate) fn extremum(&self, v: VertexId) -> Option<Extremum<VertexId, f64>> {
        self.extrema().iter().find(|e| e.vertex == v).copied()
    }

    /// `count` cones in the paper's order: the most persistent maximum, minimum, second maximum, second minimum, …; fewer only
    /// where the mesh has no more inner vertices.
    pub fn alternating(&self, operators: &Operators, count: usize, watch: Watch) -> Vec<VertexId> {
        let all = self.extrema.extrema().len();
        first(operators, self.extrema.alternating(all).map(|e| e.vertex), count, watch)
    }

    /// `count` cones by persistence, whatever their sign; fewer only where the mesh has no more inner vertices.
    pub fn by_persistence(&self, operators: &Operators, count: usize, watch: Watch) -> Vec<VertexId> {
        first(operators, self.extrema().iter().map(|e| e.vertex), count, watch)
    }
}

/// [`PinnedFactor::factor`] by a factorization with the cones pinned; none if there is none.
fn pinned_anew(operators: &Operators, cones: &[VertexId]) -> Option<VertexData<f64>> {
    let source: VertexData<f64> = operators.curvature.iter().map(|k| -k).collect();
    Some(operators.refactored(cones, Watch::NONE).ok()?.solve(&source))
}

/// The first extrema that are far enough from each other, then greedily.
fn first(operators: &Operators, ranked: impl Iterator<Item = VertexId>, count: usize, watch: Watch) -> Vec<VertexId> {
    let mut chosen = Chosen::new(operators);
    for extremum in ranked {
        if chosen.cones.len() < count && chosen.is_far(extremum) {
            chosen.add(extremum);
        }
    }
    chosen.go_on_greedily(count, watch);
    chosen.cones
}

/// Cones chosen so far, and where no further ones should go.
struct Chosen<'a> {
    operators: &'a Operators,
    cones: Vec<VertexId>,
    /// Boundary vertices and cones.
    taken: VertexData<bool>,
    /// Vertices too near to a cone.
    near: VertexData<bool>,
}

impl<'a> Chosen<'a> {
    fn new(operators: &'a Operators) -> Self {
        let mesh = &operators.mesh;
        let taken: VertexData<bool> = mesh.vertices().map(|v| mesh.is_boundary_vertex(v)).collect();
        Self { operators, cones: Vec::new(), near: taken.clone(), taken }
    }

    fn is_far(&self, v: VertexId) -> bool {
        !self.near[v]
    }

    fn add(&mut self, cone: VertexId) {
        let mesh = &self.operators.mesh;
        self.cones.push(cone);
        self.taken[cone] = true;
        self.near[cone] = true;
        let mut rim = vec![cone];
        for _ in 1..LEAST_DISTANCE {
            rim = rim.iter().flat_map(|&v| mesh.neighbors(v)).copied().collect();
            rim.iter().for_each(|&v| self.near[v] = true);
        }
    }

    /// Adds the vertices where the pinned log scale factor is largest, far ones as long as there are any: one for each
    /// solve at first, an eighth of the cones later. (The batches depend on nothing but what is there, so that fewer cones
    /// are still a prefix of more.)
    fn go_on_greedily(&mut self, count: usize, watch: Watch) {
        if self.cones.len() >= count {
            return;
        }
        let mut pinned = PinnedFactor::new(self.operators);
        while self.cones.len() < count && !watch.stops_at(self.cones.len() as f64 / count as f64) {
            let factored = if self.cones.len() > MANY { pinned_anew(self.operators, &self.cones) } else { None };
            let u = factored.unwrap_or_else(|| {
                let known = pinned.cones().len();
                pinned.add(&self.cones[known..]);
                pinned.factor()
            });
            let largest = |blocked: &VertexData<bool>| {
                let open = u.iter_ids().filter(|(v, _)| !blocked[*v]);
                open.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()).then(b.0.index().cmp(&a.0.index()))).map(|(v, _)| v)
            };
            for _ in 0..(1 + self.cones.len() / 8).min(count - self.cones.len()) {
                let Some(vertex) = largest(&self.near).or_else(|| largest(&self.taken)) else { return };
                self.add(vertex);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geom::{Metric, shapes};
    use topo::Kind;

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
            for order in [ConeHierarchy::alternating, ConeHierarchy::by_persistence] {
                let mut all = order(&hierarchy, &operators, 30, Watch::NONE);
                let inner = operators.mesh.vertices().filter(|&v| !operators.mesh.is_boundary_vertex(v)).count();
                assert_eq!(all.len(), inner.min(30));
                for count in [0, 1, 5, 12] {
                    assert_eq!(order(&hierarchy, &operators, count, Watch::NONE), all[..count]);
                }
                let count = all.len();
                all.sort_unstable();
                all.dedup();
                assert_eq!(count, all.len());
                assert!(all.iter().all(|&v| !operators.mesh.is_boundary_vertex(v)));
            }
        }
    }

    #[test]
    fn many_cones_begin_with_fewer_and_go_on_as_they_did() {
        let (operators, hierarchy) = hierarchy(&shapes::hare(1500));
        let [few, many] = [MANY - 20, MANY + 200].map(|count| hierarchy.by_persistence(&operators, count, Watch::NONE));
        assert_eq!(few, many[..few.len()]);
        let mut pinned = PinnedFactor::new(&operators);
        pinned.add(&many);
        let (added, anew) = (pinned.factor(), pinned_anew(&operators, &many).unwrap());
        assert!(added.iter().zip(anew.iter()).all(|(a, b)| (a - b).abs() < 1e-8));
        assert!(anew.iter().any(|u| u.abs() > 1e-4), "something is left to compare");
    }

    #[test]
    fn a_mesh_without_enough_inner_vertices_gives_what_it_has() {
        let (operators, hierarchy) = hierarchy(&shapes::square(9));
        let inner = operators.mesh.vertices().filter(|&v| !operators.mesh.is_boundary_vertex(v)).count();
        assert_eq!(hierarchy.by_persistence(&operators, 100, Watch::NONE).len(), inner);
    }

    #[test]
    fn the_paper_takes_maxima_and_minima_in_turn() {
        let (operators, hierarchy) = hierarchy(&shapes::hare(2000));
        let cones = hierarchy.alternating(&operators, 4, Watch::NONE);
        let kind = |&v: &VertexId| hierarchy.extremum(v).expect("there are enough extrema").kind;
        let kinds: Vec<Kind> = cones.iter().map(kind).collect();
        assert_eq!(kinds, [Kind::Maximum, Kind::Minimum, Kind::Maximum, Kind::Minimum]);
    }
}
