//! Triangle meshes and what conformal geometry computes on them.
//!
//! | for | there is |
//! |---|---|
//! | files | [`io`] reads OBJ, OFF, PLY, STL and glTF into a [`Model`]: points and polygons as the file had them; and writes OBJ, PLY and GLB |
//! | making surfaces of it | [`prepare()`]: oriented manifold [`Surface`]s, what is broken mended and counted |
//! | connectivity | [`Mesh`], and [`Triangulation`], which can be flipped; typed ids ([`VertexId`], …); a `&Mesh` is a graph for petgraph |
//! | lengths | [`Metric`]: an edge length each; angles, areas, cotangents; [`angle_defects`] |
//! | flips | [`delaunay()`], [`ptolemaic_delaunay`] |
//! | equations | [`laplacian()`], a [`SymmetricMatrix`]; [`Poisson`]: factored once, asked often |
//! | paths | [`ShortestPaths`], [`kruskal`], [`CutMesh`]: a mesh opened along edges, [`Islands`]: what it falls into then |
//! | judging maps | [`distortion`] |
//! | something to begin with | [`shapes`] |
//!
//! Words: a *halfedge* is a side of a triangle, directed counter-clockwise, and names the *corner* at its tail. A *metric*
//! is a length for every edge. *Curvature* is an angle defect in radians, at vertices. The Laplacian is positive
//! semidefinite. Everything is f64, but for [`EdgeDistances`].
//!
//! Halfedges 3f, 3f + 1 and 3f + 2 are the sides of triangle f, in its order; corner c of a [`Model`] is the c-th of all its faces, one face after the other.
//!
//! ```
//! use geom::{Metric, angle_defects, shapes};
//!
//! let shape = shapes::torus(2, 1000);
//! let mesh = shape.mesh();
//! let metric = Metric::from_points(&mesh, &shape.points);
//! let total: f64 = angle_defects(&mesh, &metric).iter().sum();
//! assert!((total - 2.0 * std::f64::consts::PI * mesh.euler_characteristic() as f64).abs() < 1e-9);
//! ```

mod counted;
pub mod distortion;
mod error;
mod intrinsic;
#[cfg(feature = "files")]
pub mod io;
mod linalg;
mod mesh;
mod parallel;
mod refinement;
mod rows;
pub mod shapes;
mod surface;
pub mod vector;
mod walk;
mod watch;

#[doc(hidden)]
pub use counted::{are, counted};
pub use error::Error;
pub use intrinsic::*;
pub use linalg::{Cholesky, CholeskyError, SymmetricMatrix, gram, gram_watched};
pub use mesh::*;
pub use refinement::*;
pub use rows::Rows;
pub use surface::*;
pub use walk::*;
pub use watch::{Interrupted, Watch};

/// What the tests of this workspace ask beyond the library. No part of it: it changes without notice.
#[doc(hidden)]
pub mod internals {
    pub use crate::linalg::factorizations;
}

/// The example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_shared_and_sent_between_threads() {
        fn is_shared<T: Send + Sync>() {}
        is_shared::<(Mesh, Triangulation, CutMesh, Double, Metric, Intrinsic, SymmetricMatrix)>();
        is_shared::<(Model, Prepared, Surface, Poisson, Cholesky, ForwardSolution, ShortestPaths, EdgeDistances)>();
        is_shared::<(distortion::Distortion, shapes::Shape, Rows<VertexId>, Watch<'static>, Error)>();
    }

    #[cfg(feature = "serde")]
    #[test]
    fn reports_come_back_as_they_were_serialized() {
        let repair = Repair { kind: RepairKind::ZeroArea, count: 2, first: 7 };
        let text = serde_json::to_string(&repair).unwrap();
        assert_eq!(text, r#"{"kind":"zero_area","count":2,"first":7}"#);
        assert_eq!(serde_json::from_str::<Repair>(&text).unwrap(), repair);
        let values: FaceData<f64> = vec![1.0, 0.5].into();
        assert_eq!(serde_json::to_string(&values).unwrap(), "[1.0,0.5]");
    }
}
