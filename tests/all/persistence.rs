//! The laws of the pairing, and the paper's Fig. 3.

use geom::{EdgeId, Id, Mesh, shapes};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;
use tests::properties;
use topo::{Connectivity, Grid, NanPolicy, PersistenceOptions};

use crate::{bytes, cases};

proptest! {
    #![proptest_config(cases(512))]

    #[test]
    fn three_ways_to_the_pairs_agree_on_any_graph_and_field(bytes in bytes(400)) {
        properties::pairing(&bytes);
    }

    #[test]
    fn relabelling_and_monotone_maps_keep_the_pairs(bytes in bytes(400)) {
        properties::relabelled(&bytes);
    }

    #[test]
    fn hierarchies_are_nested_and_ordered(bytes in bytes(400)) {
        properties::hierarchy(&bytes);
    }

    #[test]
    fn domains_are_paired_segmented_and_simplified(bytes in bytes(600)) {
        properties::domains(&bytes);
    }
}

/// The terrain of Fig. 3 as heights on a square grid: eight hills round a higher ninth, and noise of a given size.
fn terrain(side: usize, noise: f64, seed: u64) -> (Vec<f64>, [usize; 9]) {
    let at = |x: f64| (x * (side - 1) as f64).round() as usize;
    let centre = |k: usize| match k {
        0 => [0.5, 0.5],
        k => {
            let a = std::f64::consts::TAU * k as f64 / 8.0;
            [0.5 + 0.32 * a.cos(), 0.5 + 0.32 * a.sin()]
        }
    };
    let centres: [[f64; 2]; 9] = std::array::from_fn(centre);
    let mut state = seed;
    let heights = (0..side * side).map(|v| {
        let p = [v % side, v / side].map(|i| i as f64 / (side - 1) as f64);
        let hill = |(k, c): (usize, &[f64; 2])| {
            let height = if k == 0 { 1.5 } else { 1.0 };
            height * (-((p[0] - c[0]).powi(2) + (p[1] - c[1]).powi(2)) / 0.005).exp()
        };
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        centres.iter().enumerate().map(hill).fold(0.0, f64::max) + noise * ((state >> 40) as f64 / (1u64 << 24) as f64)
    });
    (heights.collect(), centres.map(|c| at(c[0]) + side * at(c[1])))
}

proptest! {
    #![proptest_config(cases(48))]

    #[test]
    fn nine_hills_stand_out_of_noise_below_half_their_prominence(seed in any::<u64>()) {
        let side = 61;
        let (field, tops) = terrain(side, 0.3, seed);
        for connectivity in [Connectivity::Axis, Connectivity::Full, Connectivity::Freudenthal] {
            let grid = Grid::new([side, side], connectivity);
            let maxima = topo::superlevel(&grid, &field).expect("a value for each vertex").ranked();
            prop_assert!(maxima.len() > 50, "the noise has extrema of its own");
            let near = |v: usize, top: usize| (v % side).abs_diff(top % side) + (v / side).abs_diff(top / side) <= 8;
            prop_assert!(near(maxima[0].extremum, tops[0]), "the first is the central hill");
            for top in tops {
                let found = maxima[..9].iter().filter(|pair| near(pair.extremum, top)).count();
                prop_assert_eq!(found, 1);
            }
            prop_assert!(maxima[8].persistence() > 2.0 * maxima[9].persistence());
        }
    }

    /// Flips make loops and repeated edges; a boundary makes open rings; ties and gaps are in the field.
    #[test]
    fn a_surface_has_the_pairs_of_its_graph(
        shape in 0..3usize,
        flips in vec(any::<Index>(), 0..300),
        field in vec(prop_oneof![9 => (0..12u8).prop_map(f64::from), 1 => Just(f64::NAN)], 20..200),
    ) {
        let shape = [shapes::sphere(60), shapes::torus(2, 120), shapes::terrain(60, 3)][shape].clone();
        let mut triangulation = shape.mesh().triangulation().clone();
        for flip in flips {
            let e = EdgeId::new(flip.index(triangulation.edge_count()));
            if triangulation.is_flippable(e) {
                triangulation.flip(triangulation.halfedge(e));
            }
        }
        let mesh = Mesh::from_triangulation(triangulation).expect("flips keep a manifold one");
        let surface = topo::Rings::new(&mesh, |v| !mesh.is_boundary_vertex(v));
        let field: Vec<f64> = field.into_iter().cycle().take(mesh.vertex_count()).collect();
        let options = PersistenceOptions::new().keep_zeros().nan(NanPolicy::Mask);
        prop_assert_eq!(options.persistence(surface, &field), options.persistence(&mesh, &field));
    }
}

#[test]
fn a_terrain_mesh_has_the_pairs_of_its_graph_whichever_way_it_is_given() {
    let terrain = shapes::terrain(3000, 7);
    let mesh = terrain.mesh();
    let height: Vec<f64> = terrain.points.iter().map(|p| p[2]).collect();
    let triangulation = topo::TriangleMesh::new(mesh.vertex_count(), &terrain.triangles).expect("a surface");
    let by_mesh = topo::persistence(&mesh, &height).expect("a height for each vertex");
    let surface = topo::Rings::new(&mesh, |v| !mesh.is_boundary_vertex(v));
    assert_eq!(topo::persistence(surface, &height).as_ref(), Ok(&by_mesh));
    let by_rings = topo::persistence(&triangulation, &height).expect("a height for each vertex");
    let indices = |pairs: &topo::Pairs<geom::VertexId, f64>| -> Vec<(usize, Option<usize>)> {
        pairs.iter().map(|p| (p.extremum.0 as usize, p.saddle.map(|s| s.0 as usize))).collect()
    };
    for (mesh, rings) in [(by_mesh.minima, by_rings.minima), (by_mesh.maxima, by_rings.maxima)] {
        let rings: Vec<_> = rings.iter().map(|p| (p.extremum, p.saddle)).collect();
        assert_eq!(indices(&mesh), rings);
    }
}
