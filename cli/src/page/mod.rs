//! The page that shows a surface and its maps in a browser, and the data that it reads.
//!
//! `web/` has its source; what is built of that is one file, script and style inside, with the licences of what it uses. It is
//! used twice: by the server of `cones view`, which sends it surface and maps as [`Container`]s of plain arrays, and as a report
//! that opens from the disk, with everything [packed](report) into it.

mod container;
mod field;
mod packed;
mod report;

pub(crate) use container::Container;
pub(crate) use field::{FieldDirection, FieldPage, FieldPlaces, NO_SEGMENT};
pub(crate) use report::{Level, Report};

use report::with_data;

/// The page without data.
pub(crate) const PAGE: &str = include_str!("../../page/index.html");

/// A surface as the page shows it.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    /// About the origin, within a unit cube.
    pub(crate) points: Vec<[f32; 3]>,
    /// Vertices of each triangle.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The conformal factor of each vertex; 0 where it is on no surface.
    pub(crate) factor: Vec<f32>,
}

/// A map as the page shows it: what it is on each triangle of its surface.
#[derive(Clone, Debug)]
pub(crate) struct Map {
    /// In the unit square, or on tiles of that size.
    pub(crate) uv: Vec<[[f32; 2]; 3]>,
    /// The island.
    pub(crate) island: Vec<u32>,
    /// Chains of vertices.
    pub(crate) seams: Vec<Vec<u32>>,
}

/// What a map does to each triangle.
#[derive(Clone, Debug)]
pub(crate) struct Stretches {
    /// The log of the ratio of areas, 0 where they are kept.
    pub(crate) log_area: Vec<f32>,
    /// σ₁/σ₂.
    pub(crate) stretch: Vec<f32>,
}

impl Surface {
    /// As plain arrays.
    pub(crate) fn container(&self, meta: serde_json::Value) -> Container {
        Container::new(meta)
            .floats("points", self.points.as_flattened())
            .words("triangles", self.triangles.as_flattened())
            .floats("factor", &self.factor)
    }
}

impl Map {
    /// As plain arrays.
    pub(crate) fn container(&self, meta: serde_json::Value) -> Container {
        let lengths: Vec<u32> = self.seams.iter().map(|seam| seam.len() as u32).collect();
        Container::new(meta)
            .floats("uv", self.uv.as_flattened().as_flattened())
            .words("island", &self.island)
            .words("seams", &self.seams.concat())
            .words("seam_lengths", &lengths)
    }
}

impl Stretches {
    /// As plain arrays.
    pub(crate) fn container(&self, meta: serde_json::Value) -> Container {
        Container::new(meta).floats("log_area", &self.log_area).floats("stretch", &self.stretch)
    }
}
