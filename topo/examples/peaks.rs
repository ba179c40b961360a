//! The peaks of an elevation model by prominence, with their key saddles, isolation and parents.
//!
//! The argument is an ESRI ASCII grid (`ncols`, `nrows`, …, `NODATA_value`, then rows from north to south); places
//! without data are masked. Without an argument an island is made up.
//!
//! `cargo run --release --example peaks [elevation.asc]`

use std::collections::HashMap;
use std::error::Error;
use topo::{Connectivity, Grid, Kind, NanPolicy, PersistenceOptions};

struct Elevation {
    rows: usize,
    columns: usize,
    heights: Vec<f64>,
}

/// Reads an ESRI ASCII grid.
fn read_asc(path: &str) -> Result<Elevation, Box<dyn Error>> {
    let text = std::fs::read_to_string(path)?;
    let mut words = text.split_whitespace().peekable();
    let mut header = HashMap::new();
    while let Some(key) = words.next_if(|word| word.starts_with(char::is_alphabetic)) {
        header.insert(key.to_lowercase(), words.next().ok_or("a header line without a value")?);
    }
    let count = |key: &str| -> Result<usize, Box<dyn Error>> {
        Ok(header.get(key).ok_or_else(|| format!("no {key} in the header"))?.parse()?)
    };
    let no_data: Option<f64> = header.get("nodata_value").map(|value| value.parse()).transpose()?;
    let height = |word: &str| word.parse().map(|height| if Some(height) == no_data { f64::NAN } else { height });
    Ok(Elevation {
        rows: count("nrows")?,
        columns: count("ncols")?,
        heights: words.map(height).collect::<Result<_, _>>()?,
    })
}

/// An island with ridges; the sea has no data.
fn island() -> Elevation {
    let (rows, columns) = (120, 160);
    let height = |row: usize, column: usize| {
        let (y, x) = (row as f64 / 60.0 - 1.0, column as f64 / 80.0 - 1.0);
        let ridges = (5.0 * x + 2.0 * y).sin() * (4.0 * y - x).cos() + 0.4 * (13.0 * x).sin() * (11.0 * y).cos();
        let height = 1400.0 * (1.0 - x * x - y * y) + 420.0 * ridges;
        if height > 0.0 { height.round() } else { f64::NAN }
    };
    let heights = (0..rows).flat_map(|row| (0..columns).map(move |column| height(row, column))).collect();
    Elevation { rows, columns, heights }
}

fn main() -> Result<(), Box<dyn Error>> {
    let elevation = std::env::args().nth(1).map_or_else(|| Ok(island()), |path| read_asc(&path))?;
    let grid = Grid::new([elevation.rows, elevation.columns], Connectivity::Full);
    let options = PersistenceOptions::new().nan(NanPolicy::Mask);
    let peaks = options.superlevel(&grid, &elevation.heights)?;
    let first = peaks.top(12);
    let summits: Vec<usize> = first.iter().map(|peak| peak.extremum).collect();
    let isolation = topo::isolation(&grid, &elevation.heights, Kind::Maximum, &summits)?;
    let tree = options.merge_tree(&grid, &elevation.heights, Kind::Maximum)?;
    let parents: HashMap<usize, usize> =
        tree.branches().iter().filter_map(|peak| Some((peak.pair.extremum, peak.parent?))).collect();
    println!(
        "{} peaks, {} of them the highest of an island; the most prominent:",
        peaks.len(),
        peaks.essential().count()
    );
    println!("prominence  height  isolation  (row, column)  key saddle            parent");
    let place = |vertex: usize| format!("{:?}", grid.position(vertex));
    for (peak, isolation) in first.iter().zip(isolation) {
        let saddle = match (peak.saddle, peak.death()) {
            (Some(saddle), Some(height)) => format!("{height:.0} at {}", place(saddle)),
            _ => "highest of its island".to_owned(),
        };
        println!(
            "{:10.0}  {:6.0}  {:>9}  {:13}  {saddle:20}  {}",
            peak.persistence(),
            peak.birth,
            isolation.map_or_else(|| "–".to_owned(), |distance| format!("{distance:.1}")),
            place(peak.extremum),
            parents.get(&peak.extremum).map_or_else(|| "–".to_owned(), |&parent| place(parent)),
        );
    }
    println!("\npeaks below the highest that are more prominent than");
    let curve = peaks.diagram().persistence_curve();
    for threshold in [0.0, 50.0, 100.0, 200.0, 400.0] {
        let place = curve.partition_point(|&(from, _)| from <= threshold);
        println!("{threshold:6.0}: {}", curve[place - 1].1);
    }
    Ok(())
}
