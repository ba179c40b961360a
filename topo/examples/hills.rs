//! Eight hills round a higher ninth, under noise (Fig. 3 of "Conformal Factor Persistence for Fast Hierarchical Cone
//! Extraction"): the hierarchy of maxima finds the nine, the central one first.
//!
//! `cargo run --release --example hills [seed]`

use topo::{Connectivity, Grid};

const SIDE: usize = 200;
const NOISE: f64 = 0.25;

/// Height of the smooth hills, in units of the noise-free eight.
fn hills(x: f64, y: f64) -> f64 {
    let bump = |cx: f64, cy: f64, height: f64| height * (-((x - cx).powi(2) + (y - cy).powi(2)) / 0.02).exp();
    let ring = (0..8).map(|k| {
        let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 8.0).sin_cos();
        bump(0.7 * cos, 0.7 * sin, 1.0)
    });
    ring.sum::<f64>() + bump(0.0, 0.0, 2.0)
}

/// Numbers in -0.5..0.5 (xorshift, Marsaglia 2003).
fn noise(seed: u64) -> impl Iterator<Item = f64> {
    let mut state = seed | 1;
    std::iter::repeat_with(move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    })
}

fn main() -> Result<(), topo::Error> {
    let seed = std::env::args().nth(1).and_then(|seed| seed.parse().ok()).unwrap_or(42);
    let at = |index: usize| (index as f64 + 0.5) / SIDE as f64 * 2.2 - 1.1;
    let smooth = (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| hills(at(column), at(row))));
    let terrain: Vec<f64> = smooth.zip(noise(seed)).map(|(height, noise)| height + NOISE * noise).collect();

    let grid = Grid::new([SIDE, SIDE], Connectivity::Freudenthal);
    let persistence = topo::persistence(&grid, &terrain)?;
    let hierarchy = persistence.hierarchy();
    println!("{} maxima on {SIDE} × {SIDE} vertices; the most persistent:", persistence.maxima.len());
    println!("rank  persistence  height  position");
    for (rank, maximum) in (1..=12).zip(hierarchy.of_kind(topo::Kind::Maximum)) {
        let [row, column] = grid.position(maximum.vertex);
        let bar = "#".repeat((maximum.persistence * 20.0) as usize);
        println!(
            "{rank:4}  {:11.3}  {:6.3}  ({:5.2}, {:5.2})  {bar}",
            maximum.persistence,
            maximum.value,
            at(column),
            at(row)
        );
    }
    draw(&terrain, &persistence.maxima[..9.min(persistence.maxima.len())]);
    Ok(())
}

/// The terrain in characters, with the peaks by their rank.
fn draw(terrain: &[f64], peaks: &[topo::Pair<usize, f64>]) {
    const ROWS: usize = 30;
    const COLUMNS: usize = 60;
    for row in 0..ROWS {
        let line = (0..COLUMNS).map(|column| {
            let cell = |vertex: usize| (vertex / SIDE * ROWS / SIDE, vertex % SIDE * COLUMNS / SIDE) == (row, column);
            let rank = peaks.iter().position(|peak| cell(peak.extremum));
            let height = terrain[(row * SIDE / ROWS) * SIDE + column * SIDE / COLUMNS];
            let shade = b" .:-=+*%@"[(height * 4.5).clamp(0.0, 8.0) as usize];
            rank.map_or(char::from(shade), |rank| char::from(b'1' + rank as u8))
        });
        println!("{}", line.collect::<String>());
    }
}
