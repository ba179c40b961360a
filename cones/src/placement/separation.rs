//! Where a further cone would be too near to others.

use geom::{VertexData, VertexId};

use crate::field::Operators;

/// Cones nearer to each other than this many edges are hard to flatten.
const LEAST_DISTANCE: usize = 3;

/// With fewer vertices than this for each cone they may be neighbours.
const ROOMY: usize = 40;

const NOBODY: u32 = u32::MAX;
const SEVERAL: u32 = u32::MAX - 1;

/// The surroundings of a set of cones, which are closed to others.
pub(crate) struct Separation {
    /// The one cone that a vertex is near to.
    near: VertexData<u32>,
}

impl Separation {
    pub(crate) fn new(operators: &Operators, cones: &[VertexId]) -> Self {
        // Edges of a coarse level are long.
        let roomy = operators.mesh.vertex_count() >= ROOMY * cones.len() && !operators.is_coarse();
        let separation = Self::within(operators, cones, if roomy { LEAST_DISTANCE } else { 1 });
        // A vertex may be so near to all others that there is no room beside it.
        if !roomy || separation.near.contains(&NOBODY) { separation } else { Self::within(operators, cones, 1) }
    }

    /// With all vertices closed that are less than so many edges from a cone.
    fn within(operators: &Operators, cones: &[VertexId], distance: usize) -> Self {
        let mesh = &operators.mesh;
        let mut separation = Self { near: VertexData::constant(mesh.vertex_count(), NOBODY) };
        if operators.is_bordered() {
            mesh.vertices().filter(|&v| mesh.is_boundary_vertex(v)).for_each(|v| separation.near[v] = SEVERAL);
        }
        for (i, &cone) in cones.iter().enumerate() {
            let mut ball = vec![cone];
            let mut rim = 0;
            for _ in 1..distance {
                let next: Vec<VertexId> = ball[rim..].iter().flat_map(|&v| mesh.neighbors(v)).copied().collect();
                rim = ball.len();
                ball.extend(next);
            }
            ball.iter().for_each(|&v| separation.mark(v, i as u32));
        }
        separation
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placement::energy_model::EnergyModel;
    use crate::placement::refined::refined;
    use geom::{Mesh, Metric};
    use std::f64::consts::TAU;

    #[test]
    fn there_is_room_beside_a_vertex_that_is_near_to_all_others() {
        // A bipyramid: every vertex of its rim is a neighbour of both tips.
        let rim = 400;
        let faces: Vec<[u32; 3]> =
            (0..rim).flat_map(|k| [[k, (k + 1) % rim, rim], [(k + 1) % rim, k, rim + 1]]).collect();
        let mut points: Vec<[f64; 3]> = (0..rim)
            .map(|k| {
                let (y, x) = (TAU * f64::from(k) / f64::from(rim)).sin_cos();
                [x, y, 0.0]
            })
            .collect();
        points.extend([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
        let mesh = Mesh::new(points.len(), &faces).unwrap();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &points)).unwrap();
        for count in [3, 8] {
            let set = refined(&mut EnergyModel::new(&operators, &mesh), count);
            assert_eq!((set.cones.len(), set.shortfall), (count, 0.0));
        }
    }
}
