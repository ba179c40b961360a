//! The laws of what is computed before anything is flattened.

use geom::{CutMesh, EdgeData, Metric, VertexId, angle_defects, laplacian, shapes};
use proptest::prelude::*;
use tests::{properties, solids};

use crate::{bytes, cases};

proptest! {
    #![proptest_config(cases(192))]

    #[test]
    fn flips_keep_the_surface_and_are_undone_exactly(bytes in bytes(160)) {
        properties::flips(&bytes);
    }

    #[test]
    fn constants_are_in_the_kernel_of_a_symmetric_semidefinite_matrix(bytes in bytes(400)) {
        properties::laplacian(&bytes);
    }

    #[test]
    fn poisson_solves_as_gaussian_elimination_does(bytes in bytes(400)) {
        properties::poisson(&bytes);
    }

    #[test]
    fn seams_open_to_a_disk_and_are_no_longer_than_the_spanning_tree(bytes in bytes(160)) {
        properties::seams(&bytes);
    }
}

#[test]
fn total_curvature_is_two_pi_times_the_euler_characteristic_of_every_built_in_shape() {
    for name in shapes::NAMES {
        let shape = shapes::by_name(name, 2000).expect("a name from the list");
        let mesh = shape.mesh();
        mesh.check();
        let metric = Metric::from_points(&mesh, &shape.points);
        let total: f64 = angle_defects(&mesh, &metric).iter().sum();
        let expected = std::f64::consts::TAU * mesh.euler_characteristic() as f64;
        assert!((total - expected).abs() < 1e-9, "{name}: {total} against {expected}");
        let rows = laplacian(&mesh, &metric);
        let most = rows.multiply(&vec![1.0; rows.dimension()]).iter().fold(0.0, |most: f64, sum| most.max(sum.abs()));
        assert!(most < 1e-10, "{name}: a row of L sums to {most:e}");
    }
}

#[test]
fn cuts_open_to_a_disk_for_every_genus_and_number_of_boundaries() {
    for genus in 0..=4 {
        for boundaries in 0..=3 {
            let shape = solids::refined(&solids::slab(genus, boundaries));
            let mesh = shape.mesh();
            let lengths: EdgeData<f64> = Metric::from_points(&mesh, &shape.points).lengths().clone();
            for count in [2, 3, 8, 20] {
                let vertex = |k: u32| VertexId((k * 37 + 11) % mesh.vertex_count() as u32);
                let cones: Vec<_> = (0..count).map(vertex).collect();
                let seams = cones::internals::Seams::new(&mesh, &lengths, &cones, geom::Watch::NONE)
                    .expect("two terminals at least");
                let open = CutMesh::open(&mesh, &seams.cut);
                assert!(open.is_disk(), "genus {genus}, {boundaries} boundaries, {count} cones");
                assert!(
                    cones.iter().all(|&v| {
                        mesh.is_boundary_vertex(v) || geom::edges_at(&mesh, v).any(|(e, _)| seams.cut[e])
                    })
                );
            }
        }
    }
}
