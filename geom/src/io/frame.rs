//! The spaces that a glTF's coordinates are in: those of its nodes, and one about the middle of a model without nodes, so that f32 keeps its digits
//! far from the origin.

use super::transformation::Transformation;
use crate::surface::Model;

/// How a model's space becomes the one that coordinates are written in.
pub(super) enum Frame {
    /// About the middle of the faces.
    Middle {
        /// The middle.
        centre: [f64; 3],
        /// 1 where f32 bears the size and its square, the size where not.
        scale: f64,
    },
    /// Of a node: the way back from where it has put its mesh.
    Node(Transformation),
}

impl Frame {
    pub(super) fn middle(model: &Model) -> Self {
        let mut used = model.corners().iter().map(|&v| model.points()[v as usize]);
        let first = used.next().unwrap_or_default();
        let (mut low, mut high) = (first, first);
        for point in used {
            for axis in 0..3 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let size = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        let is_moderate = (1e-15..=1e15).contains(&size) || size == 0.0;
        let centre = [0, 1, 2].map(|axis| 0.5 * low[axis] + 0.5 * high[axis]);
        Self::Middle { centre, scale: if is_moderate { 1.0 } else { size } }
    }

    /// The frame of each of a model's nodes; none where there is no way back, as where a scale is 0, or f32 does not bear it.
    pub(super) fn of_nodes(model: &Model) -> Vec<Option<Self>> {
        let attributes = model.attributes();
        let mut places: Vec<Transformation> = Vec::with_capacity(attributes.nodes.len());
        for node in &attributes.nodes {
            let outer = node.parent.and_then(|parent| places.get(parent as usize));
            places.push(outer.unwrap_or(&Transformation::IDENTITY).after(&Transformation::of(&node.place)));
        }
        let mut frames: Vec<_> = places.iter().map(|place| place.inverse().map(Self::Node)).collect();
        for face in 0..model.face_count() {
            let Some(node) = attributes.node(face) else { continue };
            let is_finite = |frame: &mut Self| {
                let mut points = model.face(face).iter().flat_map(|&v| frame.point(model.points()[v as usize]));
                points.all(f32::is_finite)
            };
            frames[node as usize].take_if(|frame| !is_finite(frame));
        }
        frames
    }

    pub(super) fn point(&self, point: [f64; 3]) -> [f32; 3] {
        match self {
            Self::Middle { centre, scale } => [0, 1, 2].map(|axis| ((point[axis] - centre[axis]) / scale) as f32),
            Self::Node(back) => back.point(point).map(|x| x as f32),
        }
    }

    pub(super) fn normal(&self, normal: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Middle { .. } => normal,
            Self::Node(back) => back.normal(normal),
        }
    }

    /// Whether triangles are to be turned, so that they are as they were where the node has put them.
    pub(super) fn mirrors(&self) -> bool {
        matches!(self, Self::Node(back) if back.mirrors())
    }
}
