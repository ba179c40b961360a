//! A field with its extrema as a page to open in a browser.
//!
//! Segments are told level by level: one for each of some numbers of extrema, where all less persistent ones have joined
//! others. Levels are nested, so that a vertex is given with its basin at the finest of them, and each level says which extremum each of these
//! basins belongs to there. Essential classes survive at every level, whatever the range of their component: they stand first, so that those
//! that survive are always the first pairs.

use super::explain;
use super::field::{DomainField, Places, on};
use super::pairs::{Pair, PairList};
use crate::error::CommandError;
use crate::input::{FieldScalar, each};
use crate::page::{FieldDirection, FieldPage, FieldPlaces, NO_SEGMENT};
use crate::render::extent;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::Path;
use topo::{MergeTree, PersistenceOptions};

/// Every number of extrema up to this has a level of its own.
const EACH: usize = 32;
/// Levels of more extrema.
const MORE: [usize; 8] = [48, 64, 96, 128, 192, 256, 384, 512];
/// The most pairs of a direction that the page has; its diagram is full long before.
const MOST_PAIRS: usize = 4000;
/// Of larger volumes one layer is shown, so that the file stays one that browsers open at once.
const MOST_VERTICES: usize = 4_000_000;

/// The page, which is written to `path`.
pub(crate) fn html(
    path: &Path,
    subject: &DomainField,
    lists: &[&PairList],
    options: PersistenceOptions,
) -> Result<String, CommandError> {
    let (places, window) = places(subject, lists);
    let mut directions = Vec::new();
    for list in lists {
        let of_all = direction(subject, list, options).map_err(|error| explain(&subject.path, error))?;
        let basins = of_all.basins[window.clone()].to_vec();
        directions.push(FieldDirection { basins, ..of_all });
    }
    let values = subject.values.to_f64()[window].to_vec();
    let name = subject.path.file_name().unwrap_or(subject.path.as_os_str()).to_string_lossy().into_owned();
    let page = FieldPage { name, places, values, directions };
    page.html().map_err(|source| CommandError::WriteFile { path: path.to_owned(), source })
}

/// Where vertices are, and which of them are shown.
fn places(subject: &DomainField, lists: &[&PairList]) -> (FieldPlaces, std::ops::Range<usize>) {
    let all = 0..subject.vertex_count();
    match &subject.places {
        Places::Network(names) => (FieldPlaces::Network { names: names.clone() }, all),
        Places::Mesh { points, triangles } => {
            let used = || triangles.iter().flatten().map(|&v| points[v as usize]);
            let (low, size) = extent(used());
            let high = used().fold(low, |high, p| std::array::from_fn(|i| f64::max(high[i], p[i])));
            let place = |p: &[f64; 3]| std::array::from_fn(|i| ((p[i] - 0.5 * (low[i] + high[i])) / size) as f32);
            (FieldPlaces::Mesh { points: points.iter().map(place).collect(), triangles: triangles.clone() }, all)
        }
        Places::Array(sizes) => {
            let size = |from_last: usize| sizes.iter().rev().nth(from_last).copied().unwrap_or(1);
            let shape = [size(2), size(1), size(0)];
            let layer = shape[1] * shape[2];
            if all.len() <= MOST_VERTICES || shape[0] == 1 {
                return (FieldPlaces::Array { shape, first: 0 }, all);
            }
            // The layer of the most persistent extremum, a maximum if there is one.
            let best = lists.last().and_then(|list| list.pairs.first()).map_or(0, |pair| pair.extremum);
            let first = best / layer * layer;
            (FieldPlaces::Array { shape: [1, shape[1], shape[2]], first }, first..first + layer)
        }
    }
}

fn direction(
    subject: &DomainField,
    list: &PairList,
    options: PersistenceOptions,
) -> Result<FieldDirection, topo::Error> {
    each!(&subject.values, field => on!(&subject.domain, domain => {
        Ok(told(&options.merge_tree(domain, field, list.kind)?, list, field.len()))
    }))
}

/// One direction, with a basin for every vertex.
fn told<S: FieldScalar>(tree: &MergeTree<usize, S>, list: &PairList, vertices: usize) -> FieldDirection {
    let pairs: Vec<Pair> = list.essential().chain(list.finite()).take(MOST_PAIRS).copied().collect();
    let number: HashMap<usize, u32> = (0..).zip(&pairs).map(|(k, pair)| (pair.extremum, k)).collect();
    let thresholds = thresholds(&pairs, list.floor);
    let finest = tree.segmentation(S::threshold(thresholds.last().copied().unwrap_or(0.0)));
    let (mut levels, mut survivors) = (Vec::new(), Vec::new());
    for threshold in thresholds {
        let level = tree.segmentation(S::threshold(threshold));
        let survivor = |&v: &usize| {
            let extremum = level.label(v).map(|label| level.extrema()[label]);
            extremum.and_then(|extremum| number.get(&extremum).copied()).unwrap_or(NO_SEGMENT)
        };
        survivors.extend(finest.extrema().iter().map(survivor));
        // Of many essential classes only so many may be wanted.
        let n = level.extrema().iter().filter(|&extremum| number.contains_key(extremum)).count();
        levels.push(json!({ "n": n, "threshold": value(threshold) }));
    }
    let basin = |v| finest.label(v).map_or(NO_SEGMENT, |label| label as u32);
    let parents: HashMap<usize, usize> =
        tree.branches().into_iter().filter_map(|branch| Some((branch.pair.extremum, branch.parent?))).collect();
    let row = |pair: &Pair| -> Value {
        let parent = parents.get(&pair.extremum).and_then(|parent| number.get(parent));
        let [birth, persistence] = [pair.birth, pair.persistence].map(|number| value(number.to_f64()));
        json!([pair.extremum, pair.saddle, birth, pair.death.map(|death| value(death.to_f64())), persistence, parent])
    };
    let meta = json!({
        "kind": list.kind.name(),
        "pairs": pairs.iter().map(row).collect::<Vec<_>>(),
        "all": list.pairs.len(),
        "levels": levels,
        "basins": finest.extrema().len(),
    });
    FieldDirection { meta, basins: (0..vertices).map(basin).collect(), survivors }
}

/// A value as the page reads it: JSON has no number that is infinite.
fn value(number: f64) -> Value {
    match number {
        f64::INFINITY => json!("Infinity"),
        f64::NEG_INFINITY => json!("-Infinity"),
        _ => json!(number),
    }
}

/// For each level the persistence that its extrema are above, rising in their number; the last is `floor`.
fn thresholds(pairs: &[Pair], floor: f64) -> Vec<f64> {
    let mut found: Vec<f64> = Vec::new();
    for count in (1..=EACH).chain(MORE) {
        let next = pairs.get(count).filter(|pair| pair.saddle.is_some()).map(|pair| pair.persistence.to_f64());
        let is_last = count >= pairs.len();
        let threshold = if is_last { Some(floor) } else { next };
        // As persistent as those before, or a class that never ends: there is no level between.
        if let Some(threshold) = threshold.filter(|threshold| found.last().is_none_or(|last| threshold < last)) {
            found.push(threshold);
        }
        if is_last {
            break;
        }
    }
    if found.is_empty() { vec![floor] } else { found }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::persistence::Wanted;
    use crate::input::Values;
    use std::path::PathBuf;
    use topo::{Connectivity, Kind};

    /// A picture of bumps.
    fn bumps(rows: usize, columns: usize) -> DomainField {
        let at = |k: usize| {
            let [y, x] = [k / columns, k % columns].map(|i| i as f64);
            (0.9 * x).sin() * (0.7 * y).cos() + 0.3 * (0.31 * x * y).sin()
        };
        DomainField {
            path: PathBuf::from("bumps"),
            domain: super::super::field::Domain::Plane(topo::Grid::new([rows, columns], Connectivity::Freudenthal)),
            values: Values::F64((0..rows * columns).map(at).collect()),
            places: Places::Array(vec![rows, columns]),
            grid: None,
        }
    }

    #[test]
    fn each_level_s_segments_are_those_of_its_threshold() {
        let subject = bumps(24, 31);
        let Values::F64(field) = &subject.values else { panic!("they are") };
        let options = PersistenceOptions::new();
        for kind in [Kind::Minimum, Kind::Maximum] {
            let wanted = Wanted { options, min_persistence: 0.0, top: None };
            let list = PairList::new(&subject, kind, &wanted).unwrap();
            let shown = direction(&subject, &list, options).unwrap();
            let levels = shown.meta["levels"].as_array().unwrap();
            assert!(levels.len() > 10);
            let basins = shown.meta["basins"].as_u64().unwrap() as usize;
            for (k, level) in levels.iter().enumerate() {
                let threshold = level["threshold"].as_f64().unwrap();
                let grid = topo::Grid::new([24, 31], Connectivity::Freudenthal);
                let segments = options.segmentation(&grid, field, kind, threshold).unwrap();
                assert_eq!(level["n"], segments.extrema().len());
                for (v, label) in segments.labels().enumerate() {
                    let pair = shown.survivors[k * basins + shown.basins[v] as usize];
                    assert_eq!(list.pairs[pair as usize].extremum, segments.extrema()[label.unwrap()]);
                }
            }
        }
    }

    #[test]
    fn the_first_pairs_survive_each_level_though_some_never_end() {
        // Two strips, one of small values that never end and one of large ones that do.
        let mut values: Vec<f64> = (0..200).map(|k| 5.0 * (0.7 * k as f64).sin() + 0.1 * k as f64).collect();
        values.extend((0..200).map(|k| 0.01 * (0.9 * k as f64).sin()));
        values[199] = f64::NAN;
        values[60] = f64::NEG_INFINITY;
        let subject = DomainField {
            path: PathBuf::from("strips"),
            domain: super::super::field::Domain::Plane(topo::Grid::new([1, 400], Connectivity::Freudenthal)),
            values: Values::F64(values),
            places: Places::Array(vec![1, 400]),
            grid: None,
        };
        let options = PersistenceOptions::new().nan(topo::NanPolicy::Mask);
        let list =
            PairList::new(&subject, Kind::Minimum, &Wanted { options, min_persistence: 0.0, top: None }).unwrap();
        assert_eq!(list.essential, 2);
        let shown = direction(&subject, &list, options).unwrap();
        let pairs = shown.meta["pairs"].as_array().unwrap();
        assert!(pairs.iter().any(|pair| pair[2] == "-Infinity"));
        let levels = shown.meta["levels"].as_array().unwrap();
        let basins = shown.meta["basins"].as_u64().unwrap() as usize;
        assert!(levels.len() > 5);
        for (k, level) in levels.iter().enumerate() {
            let mut seen: Vec<u32> = shown.survivors[k * basins..][..basins].to_vec();
            seen.sort_unstable();
            seen.dedup();
            assert_eq!(seen, (0..level["n"].as_u64().unwrap() as u32).collect::<Vec<_>>());
        }
    }

    #[test]
    fn where_few_pairs_are_wanted_no_level_has_more() {
        let subject = bumps(24, 31);
        let numbers = |top, min_persistence| {
            let wanted = Wanted { options: PersistenceOptions::new(), min_persistence, top };
            let list = PairList::new(&subject, Kind::Maximum, &wanted).unwrap();
            let shown = direction(&subject, &list, wanted.options).unwrap();
            let levels = shown.meta["levels"].as_array().unwrap().clone();
            levels.iter().map(|level| level["n"].as_u64().unwrap()).collect::<Vec<_>>()
        };
        assert_eq!(numbers(Some(3), 0.0), [1, 2, 3]);
        assert_eq!(numbers(Some(1), 0.0), [1]);
        let all = numbers(None, 0.0);
        let some = numbers(None, 0.5);
        assert!(some.len() > 3 && some.len() < all.len() && all.starts_with(&some), "{some:?} {all:?}");
    }

    #[test]
    fn a_parent_stands_before_its_children() {
        let subject = bumps(40, 40);
        let wanted = Wanted { options: PersistenceOptions::new(), min_persistence: 0.0, top: None };
        let list = PairList::new(&subject, Kind::Maximum, &wanted).unwrap();
        let shown = direction(&subject, &list, wanted.options).unwrap();
        let pairs = shown.meta["pairs"].as_array().unwrap();
        let has_parent_before =
            |(k, pair): (usize, &Value)| pair[5].as_u64().is_some_and(|parent| (parent as usize) < k);
        assert!(pairs.iter().enumerate().skip(1).all(has_parent_before));
        assert!(pairs[0][5].is_null() && pairs[0][1].is_null());
    }
}
