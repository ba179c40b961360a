//! The domains of this crate: their fast ways against the plain sweep, their neighbours against each other.

use crate::inputs::field;
use proptest::prelude::*;
use topo::{Adjacency, Connectivity, Domain, Grid, Kind, NanPolicy, Path, PersistenceOptions, Scalar, TriangleMesh};

fn connectivity() -> impl Strategy<Value = Connectivity> {
    prop_oneof![Just(Connectivity::Axis), Just(Connectivity::Full), Just(Connectivity::Freudenthal)]
}

fn assert_fast_equals_plain<G: Domain<Vertex = usize>, S: Scalar>(domain: G, field: &[S]) {
    let options = PersistenceOptions::new().keep_zeros().nan(NanPolicy::Mask);
    let fast = options.persistence(domain, field).expect("the field fits");
    let plain = options.plain_sweep().persistence(domain, field).expect("the field fits");
    assert_eq!(fast.minima[..], plain.minima[..]);
    assert_eq!(fast.maxima[..], plain.maxima[..]);
}

fn grid<const D: usize>(max: usize) -> impl Strategy<Value = (Grid<D>, Vec<f64>)> {
    let shape = proptest::array::uniform::<_, D>(1..=max);
    let periodic = proptest::array::uniform::<_, D>(any::<bool>());
    (shape, periodic, connectivity()).prop_flat_map(|(shape, periodic, connectivity)| {
        let grid = Grid::new(shape, connectivity).periodic(periodic);
        (Just(grid), field((&grid).vertex_count()))
    })
}

/// Triangles at random: sheets that meet, repeated and degenerate triangles; or a torus in random orientation.
fn triangles() -> impl Strategy<Value = (usize, Vec<[u32; 3]>)> {
    let soup = (3..30u32).prop_flat_map(|n| {
        let triangle = [0..n, 0..n, 0..n];
        (Just(n as usize), proptest::collection::vec(triangle, 0..60))
    });
    let torus = (3..9u32, 3..9u32, any::<u64>()).prop_map(|(rows, columns, flips)| {
        let at = move |y: u32, x: u32| y % rows * columns + x % columns;
        let squares = (0..rows).flat_map(|y| (0..columns).map(move |x| (y, x)));
        let halves = squares.flat_map(|(y, x)| {
            let [a, b, c, d] = [at(y, x), at(y, x + 1), at(y + 1, x + 1), at(y + 1, x)];
            [[a, b, c], [a, c, d]]
        });
        let flip = |(i, [a, b, c]): (usize, [u32; 3])| if flips >> (i % 64) & 1 == 0 { [a, b, c] } else { [b, a, c] };
        ((rows * columns) as usize, halves.enumerate().map(flip).collect())
    });
    prop_oneof![soup, torus]
}

/// The squared distance of two vertices by the shorter way along each axis.
fn square_distance<const D: usize>(grid: &Grid<D>, periodic: [bool; D], u: usize, v: usize) -> usize {
    let (u, v) = (grid.position(u), grid.position(v));
    let along = |axis: usize| {
        let step = u[axis].abs_diff(v[axis]);
        if periodic[axis] { step.min(grid.shape()[axis] - step) } else { step }
    };
    (0..D).map(|axis| along(axis).pow(2)).sum()
}

proptest! {
    #[test]
    fn isolation_is_the_distance_to_the_nearest_of_all_that_come_before(
        shape in proptest::array::uniform3(1..7usize), periodic in any::<[bool; 3]>(), values in field(7 * 7 * 7), masked in 0..300usize
    ) {
        let grid = Grid::new(shape, Connectivity::Axis).periodic(periodic);
        let mut field = values[..(&grid).vertex_count()].to_vec();
        field.iter_mut().skip(masked).step_by(3).for_each(|value| *value = f64::NAN);
        let pairs = PersistenceOptions::new().nan(NanPolicy::Mask).persistence(&grid, &field).expect("fits");
        for pairs in [pairs.minima, pairs.maxima] {
            let isolation = topo::isolation(&grid, &field, &pairs).expect("fits");
            for (pair, isolation) in pairs.iter().zip(isolation) {
                let from = pair.extremum;
                let is_before = |&u: &usize| match pairs.kind() {
                    Kind::Minimum => field[u] < field[from] || field[u] == field[from] && u < from,
                    Kind::Maximum => field[u] > field[from] || field[u] == field[from] && u > from,
                };
                let nearest = (0..field.len()).filter(is_before).map(|u| square_distance(&grid, periodic, u, from)).min();
                prop_assert_eq!(isolation, nearest.map(|square| (square as f64).sqrt()));
            }
        }
    }

    #[test]
    fn triangles_are_paired_as_by_the_sweep_and_as_their_edges(
        ((count, triangles), field) in triangles().prop_flat_map(|mesh| { let count = mesh.0; (Just(mesh), field(count)) })
    ) {
        let mesh = TriangleMesh::new(count, &triangles).expect("corners exist");
        assert_fast_equals_plain(&mesh, &field);
        let edges: Vec<_> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(|edge| edge.map(|v| v as usize)).collect();
        let graph = Adjacency::from_edges(count, &edges).expect("ends exist");
        prop_assert_eq!(topo::persistence(&mesh, &field), topo::persistence(&graph, &field));
    }

    #[test]
    fn a_path_is_paired_as_by_the_sweep(mut field in (0..200usize).prop_flat_map(field), masked in proptest::collection::vec(any::<prop::sample::Index>(), 0..5)) {
        let path = Path::new(field.len());
        assert_fast_equals_plain(&path, &field);
        if !field.is_empty() {
            masked.iter().for_each(|index| field[index.index((&path).vertex_count())] = f64::NAN);
            assert_fast_equals_plain(&path, &field);
        }
    }

    #[test]
    fn a_line_is_paired_as_by_the_sweep((grid, field) in grid::<1>(200)) {
        assert_fast_equals_plain(&grid, &field);
    }

    #[test]
    fn a_picture_is_paired_as_by_the_sweep((grid, field) in grid::<2>(20)) {
        assert_fast_equals_plain(&grid, &field);
    }

    #[test]
    fn a_volume_is_paired_as_by_the_sweep((grid, field) in grid::<3>(7)) {
        assert_fast_equals_plain(&grid, &field);
    }

    #[test]
    fn masked_vertices_are_not_there((grid, mut field) in grid::<2>(12), masked in proptest::collection::vec(any::<prop::sample::Index>(), 0..20)) {
        masked.iter().for_each(|index| field[index.index((&grid).vertex_count())] = f64::NAN);
        assert_fast_equals_plain(&grid, &field);
    }

    #[test]
    fn grid_edges_go_both_ways((grid, _) in grid::<3>(4)) {
        let domain = &grid;
        let neighbors = |v| { let mut of = Vec::new(); domain.for_each_neighbor(v, |u| of.push(u)); of };
        for v in 0..domain.vertex_count() {
            for u in neighbors(v) {
                prop_assert!(neighbors(u).contains(&v));
            }
        }
    }
}

#[test]
fn rows_longer_than_a_span_are_scanned_whole() {
    let field: Vec<i32> = (0..3 * 1500i64).map(|i| (i * 7919 % 1013) as i32).collect();
    for connectivity in [Connectivity::Axis, Connectivity::Full, Connectivity::Freudenthal] {
        for periodic in [false, true] {
            assert_fast_equals_plain(&Grid::new([3, 1500], connectivity).periodic([periodic; 2]), &field);
        }
    }
}

#[test]
fn a_grid_without_vertices_has_no_pairs() {
    for shape in [[0, 3], [3, 0], [usize::MAX, 0]] {
        let persistence = topo::persistence::<_, f64>(&Grid::new(shape, Connectivity::Full).periodic([true; 2]), &[]);
        assert!(persistence.is_ok_and(|persistence| persistence.minima.is_empty()));
    }
    assert!(topo::sublevel(&Grid::new([usize::MAX; 3], Connectivity::Axis), &[0.0]).is_err());
}
