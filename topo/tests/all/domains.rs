//! The domains of this crate: their fast ways against the plain sweep, their neighbours against each other.

use crate::inputs::field;
use proptest::prelude::*;
use topo::{
    Adjacency, Connectivity, Domain, Error, Grid, Kind, NanPolicy, Path, PersistenceOptions, Rings, Scalar,
    TriangleMesh,
};

/// The neighbours of a vertex.
fn neighbors<G: Domain<Vertex = usize>>(domain: G, vertex: usize) -> Vec<usize> {
    let mut neighbors = Vec::new();
    domain.for_each_neighbor(vertex, |u| neighbors.push(u));
    neighbors
}

/// A number that looks random.
fn hash(number: usize) -> u64 {
    let bits = (number as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (bits ^ bits >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 20
}

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

/// A grid of squares, each cut in two, that keeps its neighbours in cyclic order; round a torus if it is one.
struct Sheet {
    rings: Vec<Vec<usize>>,
    is_closed: Vec<bool>,
}

impl Sheet {
    fn new(rows: usize, columns: usize, is_torus: bool) -> Self {
        // Steps to the neighbours in the order in which they lie round a vertex.
        const AROUND: [[isize; 2]; 6] = [[0, 1], [1, 1], [1, 0], [0, -1], [-1, -1], [-1, 0]];
        let along = |at: usize, step: isize, length: usize| {
            let to = at as isize + step;
            if is_torus {
                Some(to.rem_euclid(length as isize) as usize)
            } else {
                usize::try_from(to).ok().filter(|&to| to < length)
            }
        };
        let link = |v: usize| {
            AROUND.map(|[dy, dx]| Some(along(v / columns, dy, rows)? * columns + along(v % columns, dx, columns)?))
        };
        let ring = |v: usize| {
            // An open ring begins behind the gap.
            let link = link(v);
            let begin = (0..6).find(|&place| link[place].is_some() && link[(place + 5) % 6].is_none()).unwrap_or(0);
            (begin..begin + 6).filter_map(|place| link[place % 6]).collect()
        };
        let vertices = 0..rows * columns;
        let is_closed = vertices.clone().map(|v| link(v).iter().all(Option::is_some)).collect();
        Self { rings: vertices.map(ring).collect(), is_closed }
    }
}

impl Domain for &Sheet {
    type Vertex = usize;

    fn vertex_count(&self) -> usize {
        self.rings.len()
    }

    fn vertex(&self, index: usize) -> usize {
        index
    }

    fn for_each_neighbor(&self, index: usize, visit: impl FnMut(usize)) {
        self.rings[index].iter().copied().for_each(visit);
    }
}

/// Few values on a plain, so that the way to the next higher one is long; or many; with gaps.
fn scattered<const D: usize>(max: usize) -> impl Strategy<Value = (Grid<D>, Vec<f64>)> {
    grid::<D>(max).prop_flat_map(|(grid, field)| {
        (Just((grid, field)), 1..40usize, any::<usize>()).prop_map(|((grid, mut field), one_in, seed)| {
            for (v, value) in field.iter_mut().enumerate() {
                match hash(seed.wrapping_add(v)) as usize % (2 * one_in) {
                    0 => {}
                    1 if one_in < 9 => *value = f64::NAN,
                    _ => *value = 0.0,
                }
            }
            (grid, field)
        })
    })
}

fn assert_isolation<const D: usize>(grid: &Grid<D>, field: &[f64]) {
    let periodic: [bool; D] = core::array::from_fn(|axis| {
        let mut end = [0; D];
        end[axis] = grid.shape()[axis] - 1;
        // On a longer axis the two ends are neighbours only round it.
        end[axis] > 1 && neighbors(grid, 0).contains(&grid.vertex_at(end).expect("inside"))
    });
    let pairs = PersistenceOptions::new().nan(NanPolicy::Mask).persistence(grid, field).expect("fits");
    for pairs in [pairs.minima, pairs.maxima] {
        let extrema: Vec<usize> = pairs.iter().map(|pair| pair.extremum).collect();
        let isolation = topo::isolation(grid, field, pairs.kind(), &extrema).expect("fits");
        for (pair, isolation) in pairs.iter().zip(isolation) {
            let from = pair.extremum;
            let is_before = |&u: &usize| match pairs.kind() {
                Kind::Minimum => field[u] < field[from] || field[u] == field[from] && u < from,
                Kind::Maximum => field[u] > field[from] || field[u] == field[from] && u > from,
            };
            let nearest = (0..field.len()).filter(is_before).map(|u| square_distance(grid, periodic, u, from)).min();
            assert_eq!(isolation, nearest.map(|square| (square as f64).sqrt()));
        }
    }
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
    fn isolation_in_a_volume_is_the_distance_to_the_nearest_that_comes_before((grid, field) in scattered::<3>(6)) {
        assert_isolation(&grid, &field);
    }

    #[test]
    fn isolation_in_a_picture_is_the_distance_to_the_nearest_that_comes_before((grid, field) in scattered::<2>(14)) {
        assert_isolation(&grid, &field);
    }

    #[test]
    fn isolation_on_a_line_is_the_distance_to_the_nearest_that_comes_before((grid, field) in scattered::<1>(40)) {
        assert_isolation(&grid, &field);
    }

    #[test]
    fn rings_are_paired_as_their_graph(
        ((rows, columns), is_torus, field) in (3..9usize, 3..9usize, any::<bool>())
            .prop_flat_map(|(rows, columns, is_torus)| (Just((rows, columns)), Just(is_torus), field(rows * columns)))
    ) {
        let sheet = Sheet::new(rows, columns, is_torus);
        let rings = Rings::new(&sheet, |v| sheet.is_closed[v]);
        assert_fast_equals_plain(rings, &field);
        let graph = Adjacency::new(&sheet.rings).expect("neighbours exist");
        prop_assert_eq!(topo::persistence(rings, &field), topo::persistence(&graph, &field));
        for kind in [Kind::Minimum, Kind::Maximum] {
            prop_assert_eq!(topo::merge_tree(rings, &field, kind), topo::merge_tree(&graph, &field, kind));
        }
    }

    #[test]
    fn chains_of_triangles_round_a_vertex_are_kept_apart(
        (chains, field) in proptest::collection::vec((3..7usize, any::<bool>()), 1..5).prop_flat_map(|chains| {
            let count = 1 + chains.iter().map(|chain| chain.0).sum::<usize>();
            (Just(chains), field(count))
        })
    ) {
        // Fans that share their tip, vertex 0; those that are closed go all round it.
        let mut triangles = Vec::new();
        let mut first = 1;
        for (length, is_closed) in chains {
            let around = |place: usize| (first + place % length) as u32;
            triangles.extend((0..length - usize::from(!is_closed)).map(|place| [0, around(place), around(place + 1)]));
            first += length;
        }
        let mesh = TriangleMesh::new(field.len(), &triangles).expect("corners exist");
        assert_fast_equals_plain(&mesh, &field);
        let edges: Vec<_> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(|edge| edge.map(|v| v as usize)).collect();
        let graph = Adjacency::from_edges(field.len(), &edges).expect("ends exist");
        prop_assert_eq!(topo::persistence(&mesh, &field), topo::persistence(&graph, &field));
    }

    #[test]
    fn a_position_names_one_vertex((grid, _) in grid::<2>(6)) {
        let [rows, columns] = grid.shape();
        for row in 0..rows + 2 {
            for column in 0..columns + 2 {
                let inside = row < rows && column < columns;
                prop_assert_eq!(grid.vertex_at([row, column]), inside.then_some(row * columns + column));
                prop_assert!(!inside || grid.position(row * columns + column) == [row, column]);
            }
        }
    }

    #[test]
    fn triangles_are_paired_as_by_the_sweep_and_as_their_edges(
        ((count, triangles), field) in triangles().prop_flat_map(|mesh| { let count = mesh.0; (Just(mesh), field(count)) }),
        masked in proptest::collection::vec(any::<prop::sample::Index>(), 0..5)
    ) {
        let mesh = TriangleMesh::new(count, &triangles).expect("corners exist");
        assert_fast_equals_plain(&mesh, &field);
        let edges: Vec<_> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(|edge| edge.map(|v| v as usize)).collect();
        let graph = Adjacency::from_edges(count, &edges).expect("ends exist");
        let of_graph = topo::persistence(&graph, &field);
        // By its rings, which the sweep has made, and by the triangles alone.
        prop_assert_eq!(topo::persistence(&mesh, &field), of_graph.clone());
        let fresh = TriangleMesh::new(count, &triangles).expect("corners exist");
        prop_assert_eq!(topo::persistence(&fresh, &field), of_graph);
        let mut field = field;
        masked.iter().for_each(|index| field[index.index(count)] = f64::NAN);
        assert_fast_equals_plain(&fresh, &field);
        assert_fast_equals_plain(&TriangleMesh::new(count, &triangles).expect("corners exist"), &field);
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
        for v in 0..(&grid).vertex_count() {
            prop_assert!(neighbors(&grid, v).into_iter().all(|u| neighbors(&grid, u).contains(&v)));
        }
    }
}

#[test]
fn noise_with_thousands_of_basins_is_paired_as_by_the_sweep() {
    const SIDE: usize = 70;
    for seed in 0..4 {
        let noise: Vec<u64> = (0..SIDE * SIDE).map(|v| hash(v + seed * SIDE * SIDE)).collect();
        for connectivity in [Connectivity::Axis, Connectivity::Full, Connectivity::Freudenthal] {
            assert_fast_equals_plain(&Grid::new([SIDE; 2], connectivity), &noise);
        }
        let edges: Vec<_> = (1..noise.len()).map(|v| [v, hash(v) as usize % v]).collect();
        assert_fast_equals_plain(&Adjacency::from_edges(noise.len(), &edges).expect("ends exist"), &noise);
    }
}

/// With the feature `rayon` fields are worked on in blocks of 32,768 vertices.
#[test]
fn fields_of_several_blocks_are_paired_as_by_the_sweep() {
    const COUNT: usize = 120_000;
    let mut field: Vec<f64> = (0..COUNT).map(|v| hash(v / 3) as f64).collect();
    assert_fast_equals_plain(&Path::new(COUNT), &field);
    for shape in [[300, 400], [1, COUNT], [COUNT, 1], [3, 40_000]] {
        assert_fast_equals_plain(&Grid::new(shape, Connectivity::Full), &field);
    }
    let strip: Vec<[u32; 3]> = (2..COUNT as u32).map(|v| [v - 2, v - 1, v]).collect();
    assert_fast_equals_plain(&TriangleMesh::new(COUNT, &strip).expect("corners exist"), &field);
    field[100_001] = f64::NAN;
    let error = topo::sublevel(&Grid::new([300, 400], Connectivity::Axis), &field);
    assert_eq!(error, Err(Error::NotANumber { vertex: 100_001 }));
    assert_fast_equals_plain(&Grid::new([300, 400], Connectivity::Axis), &field);
}

#[test]
fn a_vertex_beyond_the_last_is_refused() {
    let error = Adjacency::from_edges(2, &[[0, 1], [1, 2]]).expect_err("vertex 2 does not exist");
    assert_eq!(error, Error::Edge { edge: 1, vertex: 2, vertices: 2 });
    let error = TriangleMesh::new(3, &[[0, 1, 3]]).expect_err("vertex 3 does not exist");
    assert_eq!(error.to_string(), "triangle 0 names vertex 3, but there are only 3, counted from 0");
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
