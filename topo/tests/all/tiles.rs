//! Fields in blocks have the pairs that they have in one piece, whatever the cuts and the order of joining.

use crate::inputs::{field, graph};
use petgraph::graph::UnGraph;
use proptest::prelude::*;
use topo::{Adjacency, Connectivity, Domain, Error, Grid, Kind, NanPolicy, Pairs, PersistenceOptions, Summary, Tile};

const KINDS: [Kind; 2] = [Kind::Minimum, Kind::Maximum];

/// Joins summaries in an order and grouping that a list of numbers gives, each taken to bytes and back now and then.
fn joined(mut summaries: Vec<Summary<f64>>, order: &[usize]) -> Summary<f64> {
    let mut order = order.iter().cycle();
    let mut next = |below: usize| order.next().expect("it goes round") % below;
    while summaries.len() > 1 {
        let a = summaries.swap_remove(next(summaries.len()));
        let b = summaries.swap_remove(next(summaries.len()));
        let both = a.join(b).expect("alike");
        let read = Summary::from_bytes(&both.to_bytes()).expect("just written");
        assert_eq!(read, both);
        summaries.push(read);
    }
    summaries.pop().expect("there is one")
}

type Indices = Vec<(u64, Option<u64>, f64, f64)>;

fn indices(pairs: &Pairs<u64, f64>) -> Indices {
    pairs.iter().map(|pair| (pair.extremum, pair.saddle, pair.birth, pair.end())).collect()
}

fn in_one_piece<G: Domain<Vertex = usize>>(
    domain: G,
    field: &[f64],
    kind: Kind,
    options: PersistenceOptions,
) -> (Indices, usize) {
    let pairs = match kind {
        Kind::Minimum => options.sublevel(domain, field),
        Kind::Maximum => options.superlevel(domain, field),
    };
    let pairs = pairs.expect("it fits");
    let names = |v: usize| v as u64;
    let all = pairs.iter().map(|pair| (names(pair.extremum), pair.saddle.map(names), pair.birth, pair.end()));
    (all.collect(), pairs.zero_count())
}

fn options() -> impl Strategy<Value = PersistenceOptions> {
    any::<bool>().prop_map(|keeps| {
        let options = PersistenceOptions::new().nan(NanPolicy::Mask);
        if keeps { options.keep_zeros() } else { options }
    })
}

fn connectivity() -> impl Strategy<Value = Connectivity> {
    prop_oneof![Just(Connectivity::Axis), Just(Connectivity::Full), Just(Connectivity::Freudenthal)]
}

/// Values with many ties, and now and then none.
fn field_with_nan(count: usize) -> impl Strategy<Value = Vec<f64>> {
    let value = prop_oneof![8 => crate::inputs::value(), 8 => (0..4i32).prop_map(f64::from), 1 => Just(f64::NAN)];
    proptest::collection::vec(value, count)
}

/// The parts of an axis of a length.
fn parts(most: usize, longest: usize) -> impl Strategy<Value = Vec<usize>> {
    proptest::collection::vec(1..=longest, 1..=most)
}

fn grid_in_tiles<const D: usize>(
    most: usize,
    longest: usize,
) -> impl Strategy<Value = ([Vec<usize>; D], [bool; D], Connectivity, Vec<f64>)> {
    let axes: [_; D] = core::array::from_fn(|_| parts(most, longest));
    (axes, any::<[bool; D]>(), connectivity()).prop_flat_map(|(parts, periodic, connectivity)| {
        let count = parts.iter().map(|parts| parts.iter().sum::<usize>()).product();
        (Just(parts), Just(periodic), Just(connectivity), field_with_nan(count))
    })
}

fn agree<const D: usize>(
    (parts, periodic, connectivity, field): ([Vec<usize>; D], [bool; D], Connectivity, Vec<f64>),
    order: &[usize],
    options: PersistenceOptions,
) {
    let shape = core::array::from_fn(|axis| parts[axis].iter().sum());
    let grid = Grid::new(shape, connectivity).periodic(periodic);
    let tiles = Tile::cut(&grid, core::array::from_fn(|axis| &parts[axis][..])).expect("the parts fit");
    for kind in KINDS {
        let summary = |tile: &Tile<D>| {
            let values = tile.values(&field).expect("of the grid");
            Summary::of_tile(tile, &values, kind, options).expect("of the tile")
        };
        let whole = joined(tiles.iter().map(summary).collect(), order).finish().expect("all are joined");
        assert_eq!((indices(&whole), whole.zero_count()), in_one_piece(&grid, &field, kind, options));
    }
}

proptest! {
    #[test]
    fn a_series_in_tiles_has_the_pairs_of_the_whole(
        grid in grid_in_tiles::<1>(8, 9), order: [usize; 7], options in options()
    ) {
        agree(grid, &order, options);
    }

    #[test]
    fn a_picture_in_tiles_has_the_pairs_of_the_whole(
        grid in grid_in_tiles::<2>(4, 6), order: [usize; 7], options in options()
    ) {
        agree(grid, &order, options);
    }

    #[test]
    fn a_volume_in_tiles_has_the_pairs_of_the_whole(
        grid in grid_in_tiles::<3>(3, 4), order: [usize; 7], options in options()
    ) {
        agree(grid, &order, options);
    }

    #[test]
    fn a_graph_in_blocks_has_the_pairs_of_the_whole(
        (graph, field, blocks, edges) in graph(60).prop_flat_map(|graph| {
            let (nodes, edges) = (graph.node_count(), graph.edge_count());
            let blocks = || proptest::collection::vec(1..16u8, nodes..=nodes);
            (Just(graph), field_with_nan(nodes), blocks(), proptest::collection::vec(1..16u8, edges))
        }),
        order: [usize; 7],
        options in options(),
        shuffles: bool,
    ) {
        let parts = blocks_of(&graph, blocks, &edges, shuffles);
        let ends: Vec<[usize; 2]> = graph.raw_edges().iter().map(|e| [e.source().index(), e.target().index()]).collect();
        let whole = Adjacency::from_edges(field.len(), &ends).expect("ends exist");
        for kind in KINDS {
            let summary = |(names, blocks, domain): &(Vec<u64>, Vec<u32>, Adjacency)| {
                let values: Vec<f64> = names.iter().map(|&name| field[name as usize]).collect();
                Summary::of_block(domain, &values, names, blocks, kind, options).expect("it fits")
            };
            let pairs = joined(parts.iter().map(summary).collect(), &order).finish().expect("all are joined");
            prop_assert_eq!((indices(&pairs), pairs.zero_count()), in_one_piece(&whole, &field, kind, options));
        }
    }

    #[test]
    fn pairs_taken_on_the_way_are_the_same_together(
        grid in grid_in_tiles::<2>(4, 6), options in options()
    ) {
        let (parts, periodic, connectivity, field) = grid;
        let shape = core::array::from_fn(|axis| parts[axis].iter().sum());
        let grid = Grid::new(shape, connectivity).periodic(periodic);
        let mut whole = Summary::empty(Kind::Maximum, options);
        let (mut all, mut zero_count) = (Vec::new(), 0);
        for tile in Tile::cut(&grid, [&parts[0], &parts[1]]).expect("the parts fit") {
            let values = tile.values(&field).expect("of the grid");
            whole = whole.join(Summary::of_tile(&tile, &values, Kind::Maximum, options).expect("it fits")).expect("alike");
            let taken = whole.take_pairs();
            zero_count += taken.zero_count();
            all.extend(indices(&taken));
        }
        prop_assert!(whole.is_complete() && whole.vertex_count() == 0 && whole.pair_count() == 0);
        all.sort_by_key(|pair| pair.0);
        prop_assert_eq!((all, zero_count), in_one_piece(&grid, &field, Kind::Maximum, options));
    }

    #[test]
    fn whatever_bytes_are_read_joining_them_does_not_panic(
        field in field(30), at in any::<prop::sample::Index>(), byte: u8, length in any::<prop::sample::Index>()
    ) {
        let grid = Grid::new([5, 6], Connectivity::Full);
        let tiles = Tile::cut(&grid, [&[5], &[3, 3]]).expect("the parts fit");
        let [a, b] = [0, 1].map(|tile: usize| {
            let values = tiles[tile].values(&field).expect("of the grid");
            Summary::of_tile(&tiles[tile], &values, Kind::Minimum, PersistenceOptions::new()).expect("it fits")
        });
        let whole = a.to_bytes();
        prop_assert!(Summary::<f64>::from_bytes(&whole[..length.index(whole.len())]).is_err());
        let mut bytes = whole;
        let at = at.index(bytes.len());
        bytes[at] = byte;
        if let Ok(changed) = Summary::from_bytes(&bytes) {
            prop_assert_eq!(changed.to_bytes(), bytes);
            let _ = changed.join(b).map(Summary::finish);
        }
    }
}

/// Blocks of a graph, each vertex and each edge in those whose bits are set, with the names of the vertices and in how many
/// blocks each is. Ends of an edge are in its blocks.
fn blocks_of(
    graph: &UnGraph<(), ()>,
    mut of_vertex: Vec<u8>,
    of_edge: &[u8],
    shuffles: bool,
) -> Vec<(Vec<u64>, Vec<u32>, Adjacency)> {
    let ends: Vec<[usize; 2]> = graph.raw_edges().iter().map(|e| [e.source().index(), e.target().index()]).collect();
    for (ends, blocks) in ends.iter().zip(of_edge) {
        ends.iter().for_each(|&end| of_vertex[end] |= blocks);
    }
    let block = |bit: u8| {
        let mut names: Vec<usize> = (0..of_vertex.len()).filter(|&v| of_vertex[v] >> bit & 1 != 0).collect();
        if shuffles {
            names.sort_by_key(|v| v * 37 % 61);
        }
        let local = |end: usize| names.iter().position(|&v| v == end).expect("ends are in the block");
        let inside = ends.iter().zip(of_edge).filter(|(_, blocks)| *blocks >> bit & 1 != 0);
        let inside: Vec<[usize; 2]> = inside.map(|(ends, _)| ends.map(local)).collect();
        let domain = Adjacency::from_edges(names.len(), &inside).expect("ends exist");
        let counts = names.iter().map(|&v| of_vertex[v].count_ones()).collect();
        (names.iter().map(|&v| v as u64).collect(), counts, domain)
    };
    (0..4).map(block).collect()
}

/// A number in 0..1 (the finaliser of `SplitMix64`).
fn random(v: u64) -> f64 {
    let mut bits = v.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ bits >> 31) >> 11) as f64
}

/// The most vertices that a summary keeps, of all tiles and joins of rows of tiles, over the vertices on its border.
fn vertices_over_border(field: &[f64], side: usize, parts: usize, kind: Kind) -> f64 {
    let grid = Grid::new([side, side], Connectivity::Freudenthal);
    let lengths = vec![side / parts; parts];
    let tiles = Tile::cut(&grid, [&lengths, &lengths]).expect("the parts fit");
    let options = PersistenceOptions::new();
    let mut most = 0f64;
    for row in tiles.chunks(parts) {
        let mut whole = Summary::empty(kind, options);
        for (tile, count) in row.iter().zip(1..) {
            let values = tile.values(field).expect("of the grid");
            let summary = Summary::of_tile(tile, &values, kind, options).expect("it fits");
            let length = tile.shape()[0] as f64;
            most = most.max(summary.vertex_count() as f64 / (4.0 * length));
            whole = whole.join(summary).expect("alike");
            most = most.max(whole.vertex_count() as f64 / (2.0 * length * f64::from(count + 1)));
        }
    }
    most
}

/// Of noise a third of the vertices on a border are its minima; each comes with a saddle and an extremum, and a few steps.
#[test]
fn a_summary_of_noise_is_hardly_larger_than_its_border_and_one_of_waves_much_smaller() {
    for (side, most) in [(64, 1.0), (256, 1.2)] {
        let noise: Vec<f64> = (0..side * side).map(|v| random(v as u64)).collect();
        let wave = |v: usize| (0.3 * (v % side) as f64).sin() + (0.2 * (v / side) as f64).cos();
        let waves: Vec<f64> = (0..side * side).map(wave).collect();
        for kind in KINDS {
            let [of_noise, of_waves] = [&noise, &waves].map(|field| vertices_over_border(field, side, 4, kind));
            assert!(of_noise <= most && of_waves <= 0.2, "{side}: {of_noise}, {of_waves}");
        }
    }
}

/// What the documentation admits: steps towards the border, each deeper and beyond a higher saddle, are all undecided.
#[test]
fn of_a_staircase_towards_the_border_all_steps_are_kept() {
    let steps = 50;
    let values: Vec<i32> = (0..2 * steps).map(|v| if v % 2 == 0 { -v } else { v }).collect();
    let [tile, _] = Tile::cut(&Grid::new([200], Connectivity::Axis), [&[99, 101]]).expect("they fit")[..] else {
        panic!()
    };
    let backwards: Vec<i32> = values.iter().rev().copied().collect();
    let summary = Summary::of_tile(&tile, &backwards, Kind::Minimum, PersistenceOptions::new()).expect("it fits");
    assert_eq!((summary.shared_count(), summary.vertex_count(), summary.pair_count()), (1, 100, 0));
}

#[test]
fn blocks_that_do_not_belong_together_are_refused() {
    let options = PersistenceOptions::new();
    let path = topo::Path::new(2);
    let block =
        |values: [f64; 2], names: [u64; 2], kind| Summary::of_block(&path, &values, &names, &[1, 2], kind, options);
    let a = block([0.0, 1.0], [0, 1], Kind::Minimum).expect("it fits");
    let other = block([0.0, 2.0], [2, 1], Kind::Minimum).expect("it fits");
    let maxima = block([0.0, 1.0], [2, 1], Kind::Maximum).expect("it fits");
    assert_eq!(a.clone().join(other), Err(Error::Shared { vertex: 1 }));
    assert_eq!(a.clone().join(maxima), Err(Error::Summaries));
    let of_three = Summary::of_block(&path, &[1.0, 3.0], &[1, 2], &[3, 1], Kind::Minimum, options).expect("it fits");
    assert_eq!(a.clone().join(of_three), Err(Error::Shared { vertex: 1 }));
    assert_eq!(a.clone().finish(), Err(Error::Unfinished { vertex: 1 }));
    let rest = block([2.0, 1.0], [2, 1], Kind::Minimum).expect("it fits");
    let whole = a.join(rest).expect("they belong together");
    assert!(whole.is_complete());
    assert_eq!(whole.clone().join(whole), Err(Error::JoinedTwice { vertex: 0 }));
    assert_eq!(block([0.0, 1.0], [3, 3], Kind::Minimum), Err(Error::Twice { vertex: 3 }));
    assert_eq!(block([0.0, f64::NAN], [3, 9], Kind::Minimum), Err(Error::NotANumber { vertex: 9 }));
    let grid = Grid::new([3, 4], Connectivity::Axis);
    assert_eq!(Tile::new(&grid, [0..3, 2..2]), Err(Error::Tile { axis: 1 }));
    assert_eq!(Tile::cut(&grid, [&[2], &[4]]), Err(Error::Tile { axis: 0 }));
    let integers = Summary::of_block(&path, &[1u32, 2], &[0, 1], &[1, 1], Kind::Minimum, options).expect("it fits");
    assert!(Summary::<i32>::from_bytes(&integers.to_bytes()).is_err());
    assert!(Summary::<f32>::from_bytes(&integers.to_bytes()).is_err());
    assert_eq!(Summary::<u32>::from_bytes(&integers.to_bytes()), Ok(integers));
}
