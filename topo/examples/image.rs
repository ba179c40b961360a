//! The segments of a picture: every pixel goes to its bright blob, and blobs too faint to matter are merged.
//!
//! Without an argument a picture of coins is made up; otherwise the argument is a binary PGM file (8 bit). The segments
//! are written beside it as `segments.pgm` in the current folder, and drawn as characters.
//!
//! `cargo run --release --example image [picture.pgm] [contrast]`

use std::error::Error;
use topo::{Connectivity, Grid, Kind};

struct Picture {
    rows: usize,
    columns: usize,
    pixels: Vec<u8>,
}

/// Bright coins on a dark, unevenly lit table.
fn coins() -> Picture {
    const COINS: [(i32, i32, i32); 6] =
        [(20, 22, 12), (18, 60, 15), (25, 100, 11), (56, 30, 16), (60, 70, 10), (55, 104, 14)];
    let (rows, columns) = (80, 128);
    let pixel = |row: i32, column: i32| {
        let light = 30 + row / 4 + column / 8;
        let dome = COINS.iter().map(|&(y, x, radius)| {
            let distance = (row - y).pow(2) + (column - x).pow(2);
            (140 * (radius * radius - distance) / (radius * radius)).max(0)
        });
        let grain = (row * 7919 + column * 104_729) % 23;
        (light + dome.sum::<i32>() + grain).min(255) as u8
    };
    let pixels = (0..rows).flat_map(|row| (0..columns).map(move |column| pixel(row, column))).collect();
    Picture { rows: rows as usize, columns: columns as usize, pixels }
}

/// Reads a binary PGM without comments.
fn read_pgm(path: &str) -> Result<Picture, Box<dyn Error>> {
    let bytes = std::fs::read(path)?;
    let words: Vec<&[u8]> = bytes.splitn(5, u8::is_ascii_whitespace).collect();
    let [b"P5", columns, rows, b"255", pixels] = words[..] else {
        return Err(format!("{path} is not an 8-bit binary PGM file without comments").into());
    };
    let number = |word: &[u8]| -> Result<usize, Box<dyn Error>> { Ok(std::str::from_utf8(word)?.parse()?) };
    Ok(Picture { rows: number(rows)?, columns: number(columns)?, pixels: pixels.to_vec() })
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let picture = arguments.next().map_or_else(|| Ok(coins()), |path| read_pgm(&path))?;
    let contrast: u8 = arguments.next().map_or(Ok(60), |contrast| contrast.parse())?;

    let grid = Grid::new([picture.rows, picture.columns], Connectivity::Full);
    let blobs = topo::superlevel(&grid, &picture.pixels)?;
    let segments = topo::segmentation(&grid, &picture.pixels, Kind::Maximum, contrast)?;
    println!(
        "{} × {} pixels, {} bright spots, {} stand out by more than {contrast}",
        picture.columns,
        picture.rows,
        blobs.len(),
        segments.extrema().len()
    );
    for (blob, size) in segments.extrema().iter().zip(segments.sizes()) {
        let [row, column] = grid.position(*blob);
        println!("  brightness {:3} at row {row}, column {column}; {size} pixels", picture.pixels[*blob]);
    }
    draw(&picture, |pixel| segments.label(pixel));
    write_pgm("segments.pgm", &picture, |pixel| segments.label(pixel))?;
    println!("wrote segments.pgm");
    Ok(())
}

/// Letters for segments, dots where the picture is dark.
fn draw(picture: &Picture, label: impl Fn(usize) -> Option<usize>) {
    for row in (0..picture.rows).step_by(picture.rows.div_ceil(30).max(1)) {
        let pixels = (0..picture.columns)
            .step_by(picture.columns.div_ceil(100).max(1))
            .map(|column| row * picture.columns + column);
        let letter = |pixel: usize| {
            let letter = label(pixel).map_or('?', |segment| char::from(b'A' + (segment % 26) as u8));
            if picture.pixels[pixel] < 100 { '.' } else { letter }
        };
        println!("{}", pixels.map(letter).collect::<String>());
    }
}

fn write_pgm(path: &str, picture: &Picture, label: impl Fn(usize) -> Option<usize>) -> std::io::Result<()> {
    let mut bytes = format!("P5\n{} {}\n255\n", picture.columns, picture.rows).into_bytes();
    bytes.extend(
        (0..picture.pixels.len()).map(|pixel| label(pixel).map_or(0, |segment| (segment * 97 % 200 + 55) as u8)),
    );
    std::fs::write(path, bytes)
}
