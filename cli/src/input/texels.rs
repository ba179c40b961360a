//! The pictures of textures: PNG and JPEG, known by their content.
//!
//! What they say of colour spaces is passed over: samples are sRGB, of 8 bits, as programs take the colours of textures. Of 16 bits the upper ones count.

use super::error::{Problem, ReadError};
use super::memory;
use png::{ColorType, Decoder, Transformations};
use std::io::Cursor;
use std::panic::catch_unwind;
use std::path::Path;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// The most pixels on a side: twice what graphics cards take.
const MOST: usize = 1 << 15;

/// What graphics cards take on a side: a picture of that size may be as small a file as it likes, as one is that is of one colour. Of a larger one a byte has so many pixels, at most.
const USUAL: usize = MOST / 2;
const FREE: u64 = (USUAL * USUAL) as u64;
const EXPANSION: u64 = 256;

/// A picture: rows from the top, each pixel red, green, blue and alpha in sRGB.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Texels {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) pixels: Vec<[u8; 4]>,
    /// Whether any pixel is not opaque.
    pub(crate) has_alpha: bool,
}

impl Texels {
    /// Decodes a file's bytes; `path` is how messages call it.
    pub(crate) fn decode(bytes: &[u8], path: &Path) -> Result<Self, ReadError> {
        let decoded = match bytes {
            [0x89, b'P', b'N', b'G', ..] => png(bytes),
            [0xff, 0xd8, 0xff, ..] => jpeg(bytes),
            _ => Err(Problem::Picture),
        };
        decoded.map_err(|problem| problem.in_file(path))
    }

    /// A picture of samples that are one to four for a pixel: grey, grey and alpha, and colours without alpha and with it.
    fn of_samples([width, height]: [usize; 2], samples: &[u8], per_pixel: usize) -> Self {
        let pixel = |s: &[u8]| match *s {
            [grey] => [grey, grey, grey, u8::MAX],
            [grey, alpha] => [grey, grey, grey, alpha],
            [red, green, blue] => [red, green, blue, u8::MAX],
            [red, green, blue, alpha, ..] => [red, green, blue, alpha],
            [] => [0; 4],
        };
        let pixels: Vec<[u8; 4]> = samples.chunks_exact(per_pixel).map(pixel).collect();
        let has_alpha = pixels.iter().any(|pixel| pixel[3] != u8::MAX);
        Self { width, height, pixels, has_alpha }
    }
}

/// Refuses pictures that are too large for a texture, for their file, or for the memory.
fn check([width, height]: [usize; 2], length: usize) -> Result<(), Problem> {
    if width == 0 || height == 0 || width.max(height) > MOST {
        return Err(Problem::TextureSize { width, height, most: MOST });
    }
    let pixels = width as u64 * height as u64;
    if pixels > FREE + EXPANSION * length as u64 {
        return Err(Problem::TextureSize { width, height, most: USUAL });
    }
    memory::check_picture(pixels, 8)
}

fn png(bytes: &[u8]) -> Result<Texels, Problem> {
    let mut decoder = Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::EXPAND | Transformations::STRIP_16);
    let mut reader = decoder.read_info()?;
    let (width, height) = reader.info().size();
    let size = [width as usize, height as usize];
    check(size, bytes.len())?;
    let per_pixel = match reader.output_color_type().0 {
        ColorType::Grayscale | ColorType::Indexed => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb => 3,
        ColorType::Rgba => 4,
    };
    let mut samples = vec![0; reader.output_buffer_size().ok_or(Problem::Shape(vec![height.into(), width.into()]))?];
    reader.next_frame(&mut samples)?;
    Ok(Texels::of_samples(size, &samples, per_pixel))
}

fn jpeg(bytes: &[u8]) -> Result<Texels, Problem> {
    let options = DecoderOptions::default().set_max_width(MOST).set_max_height(MOST).set_strict_mode(true);
    let options = options.jpeg_set_out_colorspace(ColorSpace::RGB);
    // The decoder promises not to panic on sound files only.
    let decoded = catch_unwind(|| {
        let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
        let told = |error: zune_jpeg::errors::DecodeErrors| {
            Problem::Jpeg(error.to_string().replace('"', "").trim().to_owned())
        };
        decoder.decode_headers().map_err(told)?;
        let (width, height) = decoder.dimensions().ok_or(Problem::Picture)?;
        check([width, height], bytes.len())?;
        let samples = decoder.decode().map_err(told)?;
        Ok(([width, height], samples))
    });
    let (size, samples) = decoded.unwrap_or_else(|_| Err(Problem::Jpeg("damaged".to_owned())))?;
    let per_pixel = samples.len() / (size[0] * size[1]);
    if !(1..=4).contains(&per_pixel) {
        return Err(Problem::Jpeg(format!("{} samples", samples.len())));
    }
    Ok(Texels::of_samples(size, &samples, per_pixel))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of two by two pixels as PNG.
    fn encoded(colour: ColorType, samples: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
        encoder.set_color(colour);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.write_header().unwrap().write_image_data(samples).unwrap();
        bytes
    }

    fn decode(bytes: &[u8]) -> Result<Texels, String> {
        Texels::decode(bytes, Path::new("a.png")).map_err(|error| error.to_string())
    }

    /// A JPEG of 8 by 8 pixels in one grey, 200.
    const JPEG: &[u8] = include_bytes!("../../tests/files/grey.jpg");

    #[test]
    fn pictures_of_any_kind_become_colours_with_alpha() {
        let grey = decode(&encoded(ColorType::Grayscale, &[0, 9, 128, 255])).unwrap();
        assert_eq!((grey.pixels[1], grey.has_alpha), ([9, 9, 9, 255], false));
        let clear =
            decode(&encoded(ColorType::Rgba, &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16])).unwrap();
        assert_eq!((clear.pixels[3], clear.has_alpha), ([13, 14, 15, 16], true));
        let jpeg = decode(JPEG).unwrap();
        assert_eq!((jpeg.width, jpeg.height, jpeg.has_alpha), (8, 8, false));
        assert!(jpeg.pixels.iter().all(|pixel| pixel[..3].iter().all(|&x| x.abs_diff(200) < 3)), "{:?}", jpeg.pixels);
    }

    #[test]
    fn damaged_pictures_are_refused_at_every_length_and_bit() {
        let png = encoded(ColorType::Rgb, &[200; 12]);
        for whole in [&png, JPEG] {
            for length in 0..whole.len() - 16 {
                assert!(decode(&whole[..length]).is_err(), "{length} of {}", whole.len());
            }
            for k in 0..8 * whole.len() {
                let mut bytes = whole.to_vec();
                bytes[k / 8] ^= 1 << (k % 8);
                // Some are other pictures.
                let _ = decode(&bytes);
            }
        }
        assert!(decode(b"GIF89a").unwrap_err().contains("neither a PNG nor a JPEG"));
    }

    /// A PNG whose header claims another size than it has.
    fn claiming(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = encoded(ColorType::Grayscale, &[0; 4]);
        bytes[16..20].copy_from_slice(&width.to_be_bytes());
        bytes[20..24].copy_from_slice(&height.to_be_bytes());
        let mut sum = flate2::Crc::new();
        sum.update(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&sum.sum().to_be_bytes());
        bytes
    }

    #[test]
    fn a_picture_that_would_fill_the_memory_is_refused_by_its_header() {
        let told = |width, height| decode(&claiming(width, height)).unwrap_err();
        assert!(told(40_000, 2).contains("at most 32768"), "{}", told(40_000, 2));
        assert!(check([8192, 8192], 25_000).is_ok(), "one of one colour");
        assert!(told(30_000, 30_000).contains("at most 16384"), "{}", told(30_000, 30_000));
    }
}
