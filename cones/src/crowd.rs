//! Where a further cone would be too near to others.

use geom::{VertexData, VertexId};

use crate::operators::Operators;

/// Cones nearer to each other than this many edges are hard to flatten.
const LEAST_DISTANCE: usize = 3;

/// With fewer vertices than this for each cone they may be neighbours.
const ROOMY: usize = 40;

const NOBODY: u32 = u32::MAX;
const SEVERAL: u32 = u32::MAX - 1;

/// The surroundings of a set of cones, which are closed to others.
pub(crate) struct Crowd {
    /// The one cone that a vertex is near to.
    near: VertexData<u32>,
}

impl Crowd {
    pub(crate) fn new(operators: &Operators, cones: &[VertexId]) -> Self {
        let mesh = &operators.mesh;
        let outside = |v| if mesh.is_boundary_vertex(v) { SEVERAL } else { NOBODY };
        let mut crowd = Self { near: mesh.vertices().map(outside).collect() };
        let distance = if mesh.vertex_count() >= ROOMY * cones.len() { LEAST_DISTANCE } else { 1 };
        for (i, &cone) in cones.iter().enumerate() {
            let mut ball = vec![cone];
            let mut rim = 0;
            for _ in 1..distance {
                let next: Vec<VertexId> = ball[rim..].iter().flat_map(|&v| mesh.neighbors(v)).copied().collect();
                rim = ball.len();
                ball.extend(next);
            }
            ball.iter().for_each(|&v| crowd.mark(v, i as u32));
        }
        crowd
    }

    fn mark(&mut self, v: VertexId, cone: u32) {
        self.near[v] = match self.near[v] {
            NOBODY => cone,
            near if near == cone => cone,
            _ => SEVERAL,
        };
    }

    /// Whether any cone at all may move here.
    pub(crate) fn is_open(&self, v: VertexId) -> bool {
        self.near[v] != SEVERAL
    }

    /// Whether the cone at this place of the set may move here.
    pub(crate) fn admits(&self, v: VertexId, leaving: usize) -> bool {
        self.near[v] == NOBODY || self.near[v] == leaving as u32
    }

    /// Whether one more cone may be here.
    pub(crate) fn admits_another(&self, v: VertexId) -> bool {
        self.near[v] == NOBODY
    }
}
