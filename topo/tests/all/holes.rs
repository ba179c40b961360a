//! Holes of pictures and cavities of volumes, against reduction of the boundary matrix of a whole complex.

use proptest::prelude::*;
use std::collections::BTreeMap;
use topo::{Connectivity, Error, Grid, Kind, Scalar};

/// A cell by its place, with the value at which it enters and its faces.
type Cells = BTreeMap<Vec<i32>, (i32, Vec<Vec<i32>>)>;

/// The pairs of dimension one less than the grid's, by reducing the boundary matrix over two elements: sorted, without those of
/// zero persistence.
fn by_reduction(cells: &Cells, dimension: impl Fn(&[i32]) -> usize, of: usize) -> Vec<(i32, i32)> {
    let mut order: Vec<&Vec<i32>> = cells.keys().collect();
    order.sort_by_key(|&cell| (cells[cell].0, dimension(cell)));
    let place: BTreeMap<&Vec<i32>, usize> = order.iter().enumerate().map(|(place, &cell)| (cell, place)).collect();
    let mut with_pivot: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let mut pairs = Vec::new();
    for &cell in order.iter().filter(|cell| dimension(cell) == of + 1) {
        let mut column: Vec<usize> = cells[cell].1.iter().map(|face| place[face]).collect();
        column.sort_unstable();
        while let Some(earlier) = column.last().and_then(|pivot| with_pivot.get(pivot)) {
            let mut sum: Vec<usize> = column.iter().filter(|row| !earlier.contains(row)).copied().collect();
            sum.extend(earlier.iter().filter(|row| !column.contains(row)));
            sum.sort_unstable();
            column = sum;
        }
        if let Some(&pivot) = column.last() {
            let (birth, death) = (cells[order[pivot]].0, cells[cell].0);
            if birth < death {
                pairs.push((birth, death));
            }
            with_pivot.insert(pivot, column);
        }
    }
    pairs.sort_unstable();
    pairs
}

fn positions(shape: &[i32]) -> Vec<Vec<i32>> {
    shape.iter().fold(vec![Vec::new()], |positions, &length| {
        positions.iter().flat_map(|position| (0..length).map(move |at| [&position[..], &[at]].concat())).collect()
    })
}

fn value(shape: &[i32], field: &[i32], position: &[i32]) -> Option<i32> {
    let is_inside = position.iter().zip(shape).all(|(at, length)| (0..*length).contains(at));
    let index = position.iter().zip(shape).fold(0, |index, (at, length)| index * length + at);
    is_inside.then(|| field[index as usize])
}

/// Cubes whose vertices, or whose cells of the highest dimension, are the pixels: places on a grid twice as fine.
fn cubes(shape: &[i32], field: &[i32], are_vertices: bool) -> Cells {
    let fine: Vec<i32> =
        shape.iter().map(|length| if are_vertices { 2 * length - 1 } else { 2 * length + 1 }).collect();
    let cell = |place: Vec<i32>| {
        let around = |along: i32, offset: i32| (along + offset).rem_euclid(2) == 1;
        // A vertex of the cell, or a cube it is a face of: half a step along the axes that are between two.
        let between = |at: i32| around(at, i32::from(!are_vertices));
        let pixels = place.iter().fold(vec![Vec::new()], |pixels, &at| {
            let at = if are_vertices { at } else { at - 1 };
            let halves = if between(if are_vertices { at } else { at + 1 }) { vec![at - 1, at + 1] } else { vec![at] };
            pixels
                .iter()
                .flat_map(|pixel| {
                    halves.iter().map(move |half| [&pixel[..], &[half / 2 - i32::from(*half < 0)]].concat())
                })
                .collect()
        });
        let values = pixels.iter().filter_map(|pixel| value(shape, field, pixel));
        let enters = if are_vertices { values.max() } else { values.min() };
        let is_long = |at: i32| at % 2 == 1;
        let faces = (0..place.len()).filter(|&axis| is_long(place[axis])).flat_map(|axis| {
            [-1, 1].map(|step| {
                let mut face = place.clone();
                face[axis] += step;
                face
            })
        });
        let faces = faces.collect();
        (place, (enters.expect("it belongs to a pixel"), faces))
    };
    positions(&fine).into_iter().map(cell).collect()
}

/// Simplices of the Freudenthal triangulation: a vertex and the steps of a chain of sets of axes from it.
fn simplices(shape: &[i32], field: &[i32]) -> Cells {
    let axes = shape.len();
    let at = |from: &[i32], set: u32| -> Vec<i32> {
        from.iter().enumerate().map(|(axis, at)| at + (set >> axis & 1) as i32).collect()
    };
    let mut chains: Vec<Vec<u32>> = vec![vec![0]];
    let mut next = 0;
    while next < chains.len() {
        let chain = chains[next].clone();
        let last = chain[chain.len() - 1];
        chains.extend((last + 1..1 << axes).filter(|set| set & last == last).map(|set| [&chain[..], &[set]].concat()));
        next += 1;
    }
    let name = |from: &[i32], chain: &[u32]| -> Vec<i32> {
        let first = at(from, chain[0]);
        first.into_iter().chain(chain.iter().map(|set| (set ^ chain[0]) as i32)).collect()
    };
    let mut cells = Cells::new();
    for from in positions(shape) {
        for chain in &chains {
            let values: Option<Vec<i32>> = chain.iter().map(|&set| value(shape, field, &at(&from, set))).collect();
            let Some(enters) = values.and_then(|values| values.into_iter().max()) else { continue };
            let without = |place: usize| [&chain[..place], &chain[place + 1..]].concat();
            let faces = (0..chain.len()).filter(|_| chain.len() > 1).map(|place| name(&from, &without(place)));
            cells.insert(name(&from, chain), (enters, faces.collect()));
        }
    }
    cells
}

fn assert_holes<const D: usize>(shape: [usize; D], field: &[i32]) {
    let lengths = shape.map(|length| length as i32);
    for connectivity in [Connectivity::Axis, Connectivity::Full, Connectivity::Freudenthal] {
        for kind in [Kind::Minimum, Kind::Maximum] {
            let sign = if kind == Kind::Minimum { 1 } else { -1 };
            let signed: Vec<i32> = field.iter().map(|value| sign * value).collect();
            let dimension_of_cube = |cell: &[i32]| cell.iter().filter(|&at| at % 2 == 1).count();
            let expected = match connectivity {
                Connectivity::Axis => by_reduction(&cubes(&lengths, &signed, true), dimension_of_cube, D - 1),
                Connectivity::Full => by_reduction(&cubes(&lengths, &signed, false), dimension_of_cube, D - 1),
                _ => by_reduction(&simplices(&lengths, &signed), |cell: &[i32]| cell.len() - D - 1, D - 1),
            };
            let holes = topo::holes(&Grid::new(shape, connectivity), field, kind).expect("fits");
            assert!(holes.iter().all(|hole| field[hole.closed] == hole.birth && field[hole.filled] == hole.death));
            let mut found: Vec<_> = holes.iter().map(|hole| (sign * hole.birth, sign * hole.death)).collect();
            found.sort_unstable();
            assert_eq!(found, expected, "{connectivity:?} {kind:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn holes_of_a_picture_are_its_loops((shape, field) in ([1..7usize, 1..7usize]).prop_flat_map(|shape| (Just(shape), proptest::collection::vec(-4..5i32, shape[0] * shape[1])))) {
        assert_holes(shape, &field);
    }

    #[test]
    fn cavities_of_a_volume_are_its_shells((shape, field) in ([1..5usize, 1..5usize, 1..4usize]).prop_flat_map(|shape| (Just(shape), proptest::collection::vec(-3..4i32, shape.iter().product::<usize>())))) {
        assert_holes(shape, &field);
    }
}

/// Both at once and one after the other.
fn assert_both<S: Scalar>(shape: [usize; 2], field: &[S]) {
    for connectivity in [Connectivity::Axis, Connectivity::Full, Connectivity::Freudenthal] {
        let grid = Grid::new(shape, connectivity);
        let (pairs, holes) = topo::pairs_and_holes(&grid, field, Kind::Minimum).expect("fits");
        assert_eq!(pairs, topo::sublevel(&grid, field).expect("fits"), "{connectivity:?}");
        assert_eq!(holes, topo::holes(&grid, field, Kind::Minimum).expect("fits"), "{connectivity:?}");
        let (pairs, holes) = topo::pairs_and_holes(&grid, field, Kind::Maximum).expect("fits");
        assert_eq!(pairs, topo::superlevel(&grid, field).expect("fits"), "{connectivity:?}");
        assert_eq!(holes, topo::holes(&grid, field, Kind::Maximum).expect("fits"), "{connectivity:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn pairs_and_holes_are_those_of_either((shape, levels, seed) in ([0..40usize, 0..40usize], 1..2000u64, any::<u64>())) {
        let word = |v: u64| (v ^ seed).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let field: Vec<u64> = (0..(shape[0] * shape[1]) as u64).map(|v| (word(v) >> 20) % levels).collect();
        assert_both(shape, &field);
        // Levels at both infinities, and zeros of both signs.
        let middle = levels as f64 / 2.0;
        let float = |&level: &u64| {
            let value = level as f64 - middle;
            if value.abs() + 1.0 > middle { value * f64::INFINITY } else { value.floor() * 0.0f64.max(value.abs() - 2.0) }
        };
        let floats: Vec<f64> = field.iter().map(float).map(|value: f64| if value.is_nan() { -0.0 } else { value }).collect();
        assert_both(shape, &floats);
    }
}

#[test]
fn so_they_are_across_blocks_and_spans() {
    for shape in [[70, 1100], [1100, 70], [1, 70_000], [70_000, 1]] {
        let noise = |v: usize| (v as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 44;
        let field: Vec<u64> = (0..shape[0] * shape[1]).map(noise).collect();
        assert_both(shape, &field);
        assert_both(shape, &field.iter().map(|value| value >> 14).collect::<Vec<_>>());
        let smooth = |v: usize| ((v / shape[1]) as f32 / 9.0).sin() + ((v % shape[1]) as f32 / 7.0).cos();
        assert_both(shape, &(0..field.len()).map(smooth).collect::<Vec<_>>());
    }
}

#[test]
fn what_has_no_holes_is_told() {
    let grid = Grid::new([3, 3], Connectivity::Full);
    assert_eq!(topo::holes(&grid.periodic([true, false]), &[0; 9], Kind::Minimum), Err(Error::Periodic));
    let both = topo::pairs_and_holes(&grid.periodic([true, false]), &[0; 9], Kind::Minimum);
    assert_eq!(both.expect_err("round an axis"), Error::Periodic);
    let both = topo::pairs_and_holes(&grid, &[f32::NAN; 9], Kind::Maximum);
    assert_eq!(both.expect_err("no numbers"), Error::NotANumber { vertex: 0 });
    assert_eq!(topo::holes(&grid, &[0; 8], Kind::Minimum), Err(Error::Length { values: 8, vertices: 9 }));
    assert_eq!(topo::holes(&grid, &[f64::NAN; 9], Kind::Minimum), Err(Error::NotANumber { vertex: 0 }));
    assert!(topo::holes(&grid, &[u8::MAX; 9], Kind::Minimum).expect("fits").is_empty());
    for shape in [[0, 3], [3, 0]] {
        assert!(
            topo::holes::<2, f64>(&Grid::new(shape, Connectivity::Axis), &[], Kind::Maximum).expect("fits").is_empty()
        );
    }
}
