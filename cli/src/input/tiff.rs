//! Pictures and elevation models in TIFF, `GeoTIFF` among them: one value at each place, by the crate `tiff`.
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
use std::path::Path;

/// Reads the first picture of a file.
pub(super) fn read(path: &Path) -> Result<Array, ReadError> {
    decode(path).map_err(|problem| problem.in_file(path))
}

fn decode(path: &Path) -> Result<Array, Problem> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut decoder = Decoder::new(BufReader::new(file))?;
    let (width, height) = decoder.dimensions()?;
    let pixels = u64::from(width) * u64::from(height);
    check_expansion(pixels, length)?;
    memory::check(pixels, WIDEST)?;
    let no_data = no_data(&mut decoder)?;
    let mut decoder = decoder.with_limits(Limits::unlimited());
    let values = values(decoder.read_image()?).ok_or_else(|| Problem::Type("a float of 16 bits".to_owned()))?;
    match values.len() {
        0 => Err(Problem::Empty),
        count if count as u64 == pixels => {
            Ok(Array { values: without(values, no_data), shape: vec![height as usize, width as usize] })
        }
        count => Err(Problem::Samples(count / pixels.max(1) as usize)),
    }
}

/// Bytes that reading takes for each pixel at most: as it is decoded, and as a float beside that.
const WIDEST: usize = 16;

/// The value that says that there is none.
fn no_data(decoder: &mut Decoder<BufReader<File>>) -> Result<Option<f64>, TiffError> {
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
