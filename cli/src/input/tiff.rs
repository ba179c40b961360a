//! Pictures and elevation models in TIFF, `GeoTIFF` among them: one value at each place, by the crate `tiff`.
//!
//! Several pages of one size are a volume, the first axis from page to page; coarser copies of a page and masks are passed over. Values are
//! those that are stored, also where zero stands for white.
//!
//! The value that GDAL's tag of no data names, mostly -9999 or the least float, becomes NaN, so that `--nan mask` leaves such places out
//! of the domain; integers become floats where there is such a tag. Where on the Earth the places are is not read.

use super::array::Array;
use super::error::{Problem, ReadError};
use super::grey::check_expansion;
use super::memory;
use super::values::Values;
use ::tiff::TiffError;
use ::tiff::decoder::{Decoder, DecodingResult, Limits};
use ::tiff::tags::Tag;
use std::fs::File;
use std::io::BufReader;
use std::ops::Not;
use std::path::Path;

/// Reads the picture, or all pages of several.
pub(super) fn read(path: &Path) -> Result<Array, ReadError> {
    decode(path).map_err(|problem| problem.in_file(path))
}

fn decode(path: &Path) -> Result<Array, Problem> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    // No tag is longer than its file; pictures are held against that and the memory that is free.
    let limits = |most: u64| {
        let mut limits = Limits::unlimited();
        limits.decoding_buffer_size = usize::try_from(most).unwrap_or(usize::MAX);
        limits
    };
    let mut decoder = Decoder::new(BufReader::new(file))?.with_limits(limits(length));
    let mut volume: Option<Volume> = None;
    let mut no_data = None;
    for page in 1.. {
        if !is_auxiliary(&mut decoder)? {
            let size = decoder.dimensions()?;
            let before = volume.as_ref().map_or(0, |volume| volume.pages) as u64;
            let pixels = (before + 1).saturating_mul(u64::from(size.0) * u64::from(size.1));
            check_expansion(pixels, length)?;
            memory::check(pixels, WIDEST)?;
            no_data = no_data.or(no_data_of(&mut decoder)?);
            decoder = decoder.with_limits(limits(length.max(pixels.saturating_mul(WIDEST as u64))));
            let values = page_values(&mut decoder, size)?;
            match &mut volume {
                None => volume = Some(Volume { size, pages: 1, values }),
                Some(volume) => {
                    if volume.size != size || !volume.values.append(values) {
                        return Err(Problem::Pages { page });
                    }
                    volume.pages += 1;
                }
            }
        }
        if !decoder.more_images() {
            break;
        }
        decoder.next_image()?;
    }
    let Volume { size: (width, height), pages, values } = volume.ok_or(Problem::Empty)?;
    let shape = [pages, height as usize, width as usize];
    let shape = if pages == 1 { shape[1..].to_vec() } else { shape.to_vec() };
    Ok(Array { values: without(values, no_data), shape })
}

/// Bytes that reading takes for each pixel at most: as it is decoded, and as a float beside that.
const WIDEST: usize = 16;

/// The pages so far, all of one size.
struct Volume {
    size: (u32, u32),
    pages: usize,
    values: Values,
}

type Pages = Decoder<BufReader<File>>;

/// Whether a page is no field of its own but a coarser copy of another one, or a mask.
fn is_auxiliary(decoder: &mut Pages) -> Result<bool, TiffError> {
    const COARSER: u32 = 1;
    const MASK: u32 = 4;
    let kind: Option<u32> = decoder.find_tag_unsigned(Tag::NewSubfileType)?;
    Ok(kind.is_some_and(|kind| kind & (COARSER | MASK) != 0))
}

/// The values of a page as they are stored.
fn page_values(decoder: &mut Pages, (width, height): (u32, u32)) -> Result<Values, Problem> {
    let bits = decoder.colortype()?.bit_depth();
    if bits < 8 {
        return Err(Problem::Bits(bits));
    }
    let is_white_zero = decoder.find_tag_unsigned::<u16>(Tag::PhotometricInterpretation)? == Some(0);
    let formats = decoder.find_tag_unsigned_vec::<u16>(Tag::SampleFormat)?.unwrap_or_default();
    if is_white_zero && formats.iter().any(|&format| format != UNSIGNED) {
        return Err(Problem::WhiteIsZero);
    }
    let mut pixels = decoder.read_image()?;
    if is_white_zero {
        invert(&mut pixels);
    }
    let values = values(pixels).ok_or_else(|| Problem::Type("a float of 16 bits".to_owned()))?;
    match (values.len(), u64::from(width) * u64::from(height)) {
        (0, _) => Err(Problem::Empty),
        (count, pixels) if count as u64 == pixels => Ok(values),
        (count, pixels) => Err(Problem::Samples(count / pixels.max(1) as usize)),
    }
}

/// What `SampleFormat` says of whole numbers without a sign, as it is understood where there is no such tag.
const UNSIGNED: u16 = 1;

/// Undoes what the decoder does where zero stands for white: it shows lightness, and a field has the numbers of its file. Of floats and signed
/// numbers it cannot be undone.
fn invert(pixels: &mut DecodingResult) {
    fn each<T: Copy + Not<Output = T>>(values: &mut [T]) {
        values.iter_mut().for_each(|value| *value = !*value);
    }
    match pixels {
        DecodingResult::U8(values) => each(values),
        DecodingResult::U16(values) => each(values),
        DecodingResult::U32(values) => each(values),
        DecodingResult::U64(values) => each(values),
        _ => {}
    }
}

/// The value that says that there is none.
fn no_data_of(decoder: &mut Pages) -> Result<Option<f64>, TiffError> {
    let text = decoder.find_tag(Tag::GdalNodata)?.map(|value| value.into_string()).transpose()?;
    Ok(text.and_then(|text| text.trim_matches(['\0', ' ']).parse().ok()))
}

/// Numbers of the types that fields consist of here.
fn values(pixels: DecodingResult) -> Option<Values> {
    fn widened<T: Into<i32>>(values: Vec<T>) -> Values {
        Values::I32(values.into_iter().map(Into::into).collect())
    }
    Some(match pixels {
        DecodingResult::U8(values) => widened(values),
        DecodingResult::I8(values) => widened(values),
        DecodingResult::U16(values) => widened(values),
        DecodingResult::I16(values) => widened(values),
        DecodingResult::U32(values) => Values::I64(values.into_iter().map(i64::from).collect()),
        DecodingResult::I32(values) => Values::I32(values),
        DecodingResult::U64(values) => Values::U64(values),
        DecodingResult::I64(values) => Values::I64(values),
        DecodingResult::F32(values) => Values::F32(values),
        DecodingResult::F64(values) => Values::F64(values),
        _ => return None,
    })
}

/// Puts NaN where there are no data.
fn without(values: Values, no_data: Option<f64>) -> Values {
    let Some(no_data) = no_data.filter(|value| !value.is_nan()) else { return values };
    match values {
        // The tag is text, and may have been written with more digits than the values have.
        Values::F32(mut field) => {
            field.iter_mut().filter(|value| **value == no_data as f32).for_each(|value| *value = f32::NAN);
            Values::F32(field)
        }
        values => {
            let mut field = values.to_f64();
            field.iter_mut().filter(|value| **value == no_data).for_each(|value| *value = f64::NAN);
            Values::F64(field)
        }
    }
}
