//! A map as VTK's polygonal data: cones are points, seams lines, triangles polygons, each with all that is known of it.
//!
//! Points are split along seams, so that texture coordinates belong to them; `vertex` is the vertex of the model (counted from 0) that each
//! is a copy of. Cells carry `kind` (0 a cone, 1 a seam, 2 a triangle), and of what they are: a cone its `curvature`, a
//! triangle its `face`, its `island`, the ratio of areas `area` (1 is ideal, means as in the report), σ₁/σ₂ as `stretch`, and `u`, the log of its
//! scale about the mean. Integers are -1 and other numbers NaN where a cell has none.

use super::unwrapped::Unwrapped;
use crate::vtk::{Numbers, PolyData};
use std::collections::HashMap;

/// The document.
pub(crate) fn text(unwrapped: &Unwrapped) -> String {
    let copies = Copies::new(unwrapped);
    let (kept, atlas) = (unwrapped.kept(), &unwrapped.map.atlas);
    let verts: Vec<usize> = atlas.cones.iter().map(|cone| copies.first(cone.vertex)).collect();
    let lines: Vec<Vec<usize>> =
        atlas.seams.iter().map(|seam| seam.iter().map(|&v| copies.first(v)).collect()).collect();
    let cells = CellCounts { cones: verts.len(), seams: lines.len(), triangles: copies.triangles.len() };
    let scene = unwrapped.scene();
    let area = unwrapped.map.quality.log_areas(&scene.areas()).into_iter().map(f64::exp).collect();
    let factor = unwrapped.analysis.conformal_factor();
    let of_triangles = |number: &dyn Fn(usize) -> i64| kept.iter().map(|&t| number(t as usize)).collect();
    PolyData {
        points: copies.source.iter().map(|&(v, _)| unwrapped.model.points()[v as usize]).collect(),
        verts,
        lines,
        polygons: copies.triangles.iter().map(|t| t.to_vec()).collect(),
        scalars: ["phi", "area"],
        texture: Some("uv"),
        of_points: vec![
            ("vertex", Numbers::Integers(copies.source.iter().map(|&(v, _)| i64::from(v)).collect())),
            ("phi", Numbers::Floats(1, copies.source.iter().map(|&(v, _)| factor[v as usize]).collect())),
            ("uv", Numbers::Floats(2, copies.source.iter().flat_map(|&(_, uv)| uv).collect())),
        ],
        of_cells: vec![
            ("kind", cells.kinds()),
            ("curvature", cells.of_cones(atlas.cones.iter().map(|cone| cone.curvature).collect())),
            ("face", cells.integers(of_triangles(&|t| i64::from(atlas.triangles.face_of[t])))),
            ("island", cells.integers(of_triangles(&|t| atlas.islands[t].map_or(-1, i64::from)))),
            ("area", cells.floats(area)),
            ("stretch", cells.floats(unwrapped.map.quality.quasi_conformal.clone())),
            ("u", cells.floats(unwrapped.map.quality.log_scale.clone())),
        ],
    }
    .text()
}

/// The vertices as they are split along seams.
struct Copies {
    /// The vertex that each is of, and its texture coordinates.
    source: Vec<(u32, [f64; 2])>,
    triangles: Vec<[usize; 3]>,
    first: HashMap<u32, usize>,
}

impl Copies {
    fn new(unwrapped: &Unwrapped) -> Self {
        let mut found = Self { source: Vec::new(), triangles: Vec::new(), first: HashMap::new() };
        let mut number: HashMap<(u32, [u64; 2]), usize> = HashMap::new();
        for &t in &unwrapped.kept() {
            let corners = unwrapped.map.atlas.triangles.corners[t as usize];
            found.triangles.push(corners.map(|corner| {
                let (vertex, uv) = (unwrapped.model.corners()[corner as usize], unwrapped.map.uv[corner as usize]);
                *number.entry((vertex, uv.map(f64::to_bits))).or_insert_with(|| {
                    found.source.push((vertex, uv));
                    found.first.entry(vertex).or_insert(found.source.len() - 1);
                    found.source.len() - 1
                })
            }));
        }
        // Where vertices at one place are joined, seams and cones may name one that no triangle has: it stands by itself.
        let named = unwrapped.map.atlas.seams.iter().flatten().copied();
        for vertex in named.chain(unwrapped.map.atlas.cones.iter().map(|cone| cone.vertex)) {
            if !found.first.contains_key(&vertex) {
                found.source.push((vertex, [0.0; 2]));
                found.first.insert(vertex, found.source.len() - 1);
            }
        }
        found
    }

    fn first(&self, vertex: u32) -> usize {
        self.first[&vertex]
    }
}

/// How many cells of each kind there are, in VTK's order.
#[derive(Clone, Copy, Debug)]
struct CellCounts {
    cones: usize,
    seams: usize,
    triangles: usize,
}

impl CellCounts {
    fn kinds(self) -> Numbers {
        let of = |kind, count| std::iter::repeat_n(kind, count);
        Numbers::Integers(of(0, self.cones).chain(of(1, self.seams)).chain(of(2, self.triangles)).collect())
    }

    fn of_cones(self, values: Vec<f64>) -> Numbers {
        let rest = std::iter::repeat_n(f64::NAN, self.seams + self.triangles);
        Numbers::Floats(1, values.into_iter().chain(rest).collect())
    }

    /// Numbers of triangles.
    fn floats(self, values: Vec<f64>) -> Numbers {
        let before = std::iter::repeat_n(f64::NAN, self.cones + self.seams);
        Numbers::Floats(1, before.chain(values).collect())
    }

    fn integers(self, values: Vec<i64>) -> Numbers {
        Numbers::Integers(std::iter::repeat_n(-1, self.cones + self.seams).chain(values).collect())
    }
}
