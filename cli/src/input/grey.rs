//! PNG pictures. Grey ones are read as they are, of colours the luma.

use super::array::Array;
use super::error::{Problem, ReadError};
use super::memory;
use super::values::Values;
use png::{BitDepth, ColorType, Decoder, Transformations};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// The weights of red, green and blue in the luma of sRGB (ITU-R BT.709), times 10,000.
const LUMA: [u32; 3] = [2126, 7152, 722];

/// A picture may have so many pixels whatever its size, and so many more for each byte of the file. One that is all of one
/// colour has up to a thousand a byte, eight thousand where a pixel is a bit: a few kilobytes that would take gigabytes.
const FREE: u64 = 1 << 24;
const EXPANSION: u64 = 256;

/// Refuses more pixels than a file of so many bytes may have.
pub(super) fn check_expansion(pixels: u64, length: u64) -> Result<(), Problem> {
    let is_plausible = pixels <= FREE + EXPANSION.saturating_mul(length);
    if is_plausible { Ok(()) } else { Err(Problem::Expansion { pixels, length }) }
}

/// Reads a picture.
pub(super) fn read(path: &Path) -> Result<Array, ReadError> {
    decode(path).map_err(|problem| problem.in_file(path))
}

fn decode(path: &Path) -> Result<Array, Problem> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut decoder = Decoder::new(BufReader::new(file));
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info()?;
    let (width, height) = reader.info().size();
    let pixels = u64::from(width) * u64::from(height);
    check_expansion(pixels, length)?;
    let (colours, depth) = reader.output_color_type();
    let sample = if depth == BitDepth::Sixteen { 2 } else { 1 };
    let bytes = colours.samples() * sample;
    memory::check(pixels, 4 + bytes)?;
    let size = reader.output_buffer_size().ok_or(Problem::Shape(vec![height.into(), width.into()]))?;
    let mut buffer = vec![0; size];
    reader.next_frame(&mut buffer)?;
    let value = |sample: &[u8]| sample.iter().fold(0, |value, &byte| value << 8 | u32::from(byte));
    let grey = |pixel: &[u8]| match colours {
        ColorType::Rgb | ColorType::Rgba => {
            let weighted = pixel.chunks_exact(sample).zip(LUMA).map(|(sample, weight)| value(sample) * weight);
            (weighted.sum::<u32>() + 5000) / 10_000
        }
        _ => value(&pixel[..sample]),
    };
    let values = buffer.chunks_exact(bytes).map(|pixel| grey(pixel) as i32).collect();
    Ok(Array { values: Values::I32(values), shape: vec![height as usize, width as usize] })
}
