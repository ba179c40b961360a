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

/// So many pixels are read from a file however small it is.
const FREE_PIXELS: u64 = 1 << 24;
/// Beyond that it has at most so many for each of its bytes. Heights have one or two, drawings in black and white some
/// fifty; a picture of one colour has 8000, and computing with it fills the memory.
const MOST_PIXELS_PER_BYTE: u64 = 100;

/// Reads a picture.
pub(super) fn read(path: &Path) -> Result<Array, ReadError> {
    decode(path).map_err(|problem| problem.in_file(path))
}

fn decode(path: &Path) -> Result<Array, Problem> {
    let file = File::open(path)?;
    let size = file.metadata()?.len();
    let mut decoder = Decoder::new(BufReader::new(file));
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info()?;
    let (width, height) = reader.info().size();
    let (colours, depth) = reader.output_color_type();
    let bytes = colours.samples() * if depth == BitDepth::Sixteen { 2 } else { 1 };
    let pixels = u64::from(width) * u64::from(height);
    if pixels > FREE_PIXELS.max(MOST_PIXELS_PER_BYTE.saturating_mul(size)) {
        return Err(Problem::Expansion { pixels, size });
    }
    memory::check(pixels, 4 + bytes)?;
    let size = reader.output_buffer_size().ok_or(Problem::Shape(vec![height.into(), width.into()]))?;
    let mut buffer = vec![0; size];
    reader.next_frame(&mut buffer)?;
    let samples: Vec<u32> = match depth {
        BitDepth::Sixteen => buffer.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]]).into()).collect(),
        _ => buffer.iter().map(|&sample| sample.into()).collect(),
    };
    let grey = |pixel: &[u32]| match colours {
        ColorType::Rgb | ColorType::Rgba => {
            (pixel.iter().zip(LUMA).map(|(sample, weight)| sample * weight).sum::<u32>() + 5000) / 10_000
        }
        _ => pixel[0],
    };
    let values = samples.chunks_exact(colours.samples()).map(|pixel| grey(pixel) as i32).collect();
    Ok(Array { values: Values::I32(values), shape: vec![height as usize, width as usize] })
}
