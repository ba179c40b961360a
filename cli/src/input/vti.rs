//! Image data of VTK's XML format (`.vti`), as VTK, `ParaView` and ITK write them.
//!
//! Format: "VTK File Formats" of the VTK User's Guide. Read: numbers as text, base64 or raw, in place or appended, compressed by zlib or not,
//! on points or on cells, in one piece. Not read: other compressions, bits, several pieces. Elements and their attributes come from the
//! crate `quick-xml`; raw bytes, which are no XML, are cut off before.

use super::array::Array;
use super::error::{Problem, ReadError};
use super::grey::check_expansion;
use super::memory;
use super::npz::chosen;
use super::stored::{Class, Stored};
use super::values::Values;
use super::vtk_blocks::{Base64, HeaderNumbers};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::path::Path;
use std::str::FromStr;

/// Reads the array of a name, that of the active scalars, or the only one.
pub(super) fn read(path: &Path, name: Option<&str>) -> Result<Array, ReadError> {
    let bytes = std::fs::read(path).map_err(|error| Problem::from(error).in_file(path))?;
    decode(&bytes, name).map_err(|problem| problem.in_file(path))
}

fn decode(bytes: &[u8], name: Option<&str>) -> Result<Array, Problem> {
    let begin = find(bytes, b"<AppendedData").unwrap_or(bytes.len());
    let (document, appended) = bytes.split_at(begin);
    let image = Image::read(document)?;
    let active = image.active.as_deref().filter(|&active| image.arrays.iter().any(|array| array.name == active));
    let names = image.arrays.iter().map(|array| array.name.clone()).collect();
    let name = chosen(names, name.or(active))?;
    let array = image.arrays.iter().find(|array| array.name == name).ok_or(Problem::Empty)?;
    image.values(array, appended, bytes.len() as u64)
}

/// Where something begins.
fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|window| window == what)
}

fn wrong(what: impl Into<String>) -> Problem {
    Problem::Vti(what.into())
}

/// What a file says of its image.
#[derive(Debug)]
struct Image {
    numbers: HeaderNumbers,
    is_compressed: bool,
    /// How many points there are along x, y and z.
    points: [u64; 3],
    /// The name of the scalars that are shown at first.
    active: Option<String>,
    arrays: Vec<DataArray>,
}

#[derive(Debug)]
struct DataArray {
    name: String,
    stored: Stored,
    components: u64,
    is_of_cells: bool,
    place: Place,
}

/// Where the numbers are.
#[derive(Debug)]
enum Place {
    Ascii(String),
    Base64(String),
    /// Bytes, or letters of base64, behind the mark at the beginning of what is appended.
    Appended(usize),
}

impl Image {
    fn read(document: &[u8]) -> Result<Self, Problem> {
        let mut reader = Reader::from_reader(document);
        let numbers = HeaderNumbers { bytes: 4, is_big_endian: false };
        let mut image = Self { numbers, is_compressed: false, points: [0; 3], active: None, arrays: Vec::new() };
        let (mut whole, mut pieces, mut is_of_cells) = (None, 0, None);
        loop {
            let event = reader.read_event().map_err(|error| wrong(error.to_string()))?;
            let (element, has_content) = match &event {
                Event::Start(element) => (element, true),
                Event::Empty(element) => (element, false),
                Event::End(end) if matches!(end.name().as_ref(), "PointData" | "CellData") => {
                    is_of_cells = None;
                    continue;
                }
                Event::Eof => break,
                _ => continue,
            };
            match element.name().as_ref() {
                "VTKFile" => image.take_file(element)?,
                "ImageData" => whole = Some(extent(element, "WholeExtent")?),
                "Piece" => {
                    pieces += 1;
                    if pieces > 1 || whole.is_none_or(|whole| extent(element, "Extent").ok() != Some(whole)) {
                        return Err(wrong("the image is in several pieces: save it as one"));
                    }
                }
                name @ ("PointData" | "CellData") if has_content => {
                    is_of_cells = Some(name == "CellData");
                    image.active = image.active.or(attribute(element, "Scalars")?);
                }
                "DataArray" => {
                    let Some(is_of_cells) = is_of_cells else { continue };
                    let text = if has_content { text_of(&mut reader)? } else { String::new() };
                    image.arrays.push(DataArray::new(element, text, is_of_cells, image.numbers.is_big_endian)?);
                }
                _ => {}
            }
        }
        image.points = whole.ok_or_else(|| wrong("there is no ImageData with a WholeExtent"))?;
        Ok(image)
    }

    fn take_file(&mut self, element: &BytesStart<'_>) -> Result<(), Problem> {
        let kind = attribute(element, "type")?.unwrap_or_default();
        if kind != "ImageData" {
            return Err(wrong(format!("it holds {kind}, and ImageData are read")));
        }
        self.numbers.is_big_endian = attribute(element, "byte_order")?.is_some_and(|order| order == "BigEndian");
        self.numbers.bytes = match attribute(element, "header_type")?.as_deref() {
            None | Some("UInt32") => 4,
            Some("UInt64") => 8,
            Some(other) => return Err(wrong(format!("its headers are of type {other}"))),
        };
        self.is_compressed = match attribute(element, "compressor")?.as_deref() {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                return Err(wrong(format!("it is compressed by {other}, and vtkZLibDataCompressor is read")));
            }
        };
        Ok(())
    }

    /// The numbers of an array, given what is appended to the document, and how long the file is.
    fn values(&self, array: &DataArray, appended: &[u8], length: u64) -> Result<Array, Problem> {
        let of_cells = |points: u64| if array.is_of_cells { points.saturating_sub(1).max(1) } else { points };
        let [x, y, z] = self.points.map(of_cells);
        let mut shape: Vec<u64> = [z, y, x].into_iter().filter(|&length| length != 1).collect();
        if shape.is_empty() {
            shape.push(1);
        }
        if array.components != 1 {
            shape.push(array.components);
        }
        let count = shape.iter().try_fold(1u64, |count, &length| count.checked_mul(length));
        let count =
            count.filter(|count| count.checked_mul(8).is_some()).ok_or_else(|| Problem::Shape(shape.clone()))?;
        match shape.len() {
            _ if count == 0 => return Err(Problem::Empty),
            0..=3 => check_expansion(count, length)?,
            _ => return Err(Problem::Samples(array.components as usize)),
        }
        memory::check(count, array.stored.bytes.max(4))?;
        let values = match &array.place {
            Place::Ascii(text) => array.stored.parsed(text, count)?,
            Place::Base64(text) => self.decoded(array.stored, Base64::new(text.as_bytes()), count)?,
            Place::Appended(offset) => self.appended(array.stored, appended, *offset, count)?,
        };
        Ok(Array { values, shape: shape.into_iter().map(|length| length as usize).collect() })
    }

    fn appended(&self, stored: Stored, appended: &[u8], offset: usize, count: u64) -> Result<Values, Problem> {
        let end = find(appended, b">").ok_or_else(|| wrong("an array is said to be appended, and nothing is"))?;
        let tag = String::from_utf8_lossy(&appended[..end]);
        let mark = find(&appended[end..], b"_").ok_or_else(|| wrong("what is appended does not begin with _"))?;
        let from = appended.get(end + mark + 1..).and_then(|all| all.get(offset..));
        let bytes = from.ok_or_else(|| wrong("an array is said to begin behind the end of the file"))?;
        if tag.contains("\"raw\"") || tag.contains("'raw'") {
            self.decoded(stored, bytes, count)
        } else {
            self.decoded(stored, Base64::new(bytes), count)
        }
    }

    fn decoded(&self, stored: Stored, reader: impl std::io::Read, count: u64) -> Result<Values, Problem> {
        let expected = count * stored.bytes as u64;
        if self.is_compressed {
            stored.values(&mut self.numbers.compressed(reader, expected)?, count)
        } else {
            stored.values(&mut self.numbers.plain(reader, expected)?, count)
        }
    }
}

impl DataArray {
    fn new(element: &BytesStart<'_>, text: String, is_of_cells: bool, is_big_endian: bool) -> Result<Self, Problem> {
        let type_name = attribute(element, "type")?.unwrap_or_default();
        let (class, bits) =
            match type_name.find(|letter: char| letter.is_ascii_digit()).map(|at| type_name.split_at(at)) {
                Some(("Int", bits)) => (Class::Signed, bits),
                Some(("UInt", bits)) => (Class::Unsigned, bits),
                Some(("Float", bits @ ("32" | "64"))) => (Class::Float, bits),
                _ => return Err(Problem::Type(type_name)),
            };
        let bytes = match bits {
            "8" => 1,
            "16" => 2,
            "32" => 4,
            "64" => 8,
            _ => return Err(Problem::Type(type_name)),
        };
        let place = match attribute(element, "format")?.as_deref() {
            None | Some("ascii") => Place::Ascii(text),
            Some("binary") => Place::Base64(text),
            Some("appended") => Place::Appended(number(element, "offset")?.unwrap_or(0)),
            Some(other) => return Err(wrong(format!("an array is of the format {other}"))),
        };
        Ok(Self {
            name: attribute(element, "Name")?.unwrap_or_default(),
            stored: Stored { class, bytes, is_big_endian },
            components: number(element, "NumberOfComponents")?.unwrap_or(1),
            is_of_cells,
            place,
        })
    }
}

impl Stored {
    /// So many numbers that are written as text.
    fn parsed(self, text: &str, count: u64) -> Result<Values, Problem> {
        fn all<T: FromStr>(text: &str, count: u64) -> Result<Vec<T>, Problem> {
            let word = |word: &str| word.parse().map_err(|_| Problem::unexpected(format!("{word:?}"), "a number"));
            let values = text.split_ascii_whitespace().map(word).collect::<Result<Vec<T>, _>>()?;
            let is_right = values.len() as u64 == count;
            is_right
                .then_some(values)
                .ok_or_else(|| wrong(format!("an array has not the {count} numbers of its image")))
        }
        Ok(match (self.class, self.bytes) {
            (Class::Float, 4) => Values::F32(all(text, count)?),
            (Class::Float, _) => Values::F64(all(text, count)?),
            (Class::Unsigned, 8) => Values::U64(all(text, count)?),
            (Class::Signed, 8) | (Class::Unsigned, 4) => Values::I64(all(text, count)?),
            _ => Values::I32(all(text, count)?),
        })
    }
}

/// The text of an element that has been entered, without that of elements in it.
fn text_of(reader: &mut Reader<&[u8]>) -> Result<String, Problem> {
    let (mut text, mut depth) = (String::new(), 0);
    loop {
        match reader.read_event().map_err(|error| wrong(error.to_string()))? {
            Event::Start(_) => depth += 1,
            Event::End(_) if depth == 0 => return Ok(text),
            Event::End(_) => depth -= 1,
            Event::Text(part) if depth == 0 => text.push_str(part.as_ref()),
            Event::Eof => return Err(wrong("it ends within an array: it is cut short or damaged")),
            _ => {}
        }
    }
}

fn attribute(element: &BytesStart<'_>, name: &str) -> Result<Option<String>, Problem> {
    let found = element.try_get_attribute(name).map_err(|error| wrong(error.to_string()))?;
    let text = found.map(|found| found.value.into_owned());
    text.map(|text| Ok(quick_xml::escape::unescape(&text).map_err(|error| wrong(error.to_string()))?.into_owned()))
        .transpose()
}

fn number<T: FromStr>(element: &BytesStart<'_>, name: &str) -> Result<Option<T>, Problem> {
    let text = attribute(element, name)?;
    text.map(|text| text.trim().parse().map_err(|_| wrong(format!("{name} is {text:?}")))).transpose()
}

/// How many points an extent has along x, y and z: first and last along each.
fn extent(element: &BytesStart<'_>, name: &str) -> Result<[u64; 3], Problem> {
    let text = attribute(element, name)?.unwrap_or_default();
    let ends: Vec<i64> = text.split_ascii_whitespace().filter_map(|end| end.parse().ok()).collect();
    let points = |first: i64, last: i64| u64::try_from(last.checked_sub(first)?.checked_add(1)?).ok();
    match ends[..] {
        [a, b, c, d, e, f] => [points(a, b), points(c, d), points(e, f)].into_iter().collect::<Option<Vec<_>>>(),
        _ => None,
    }
    .and_then(|points| points.try_into().ok())
    .ok_or_else(|| wrong(format!("{name} is {text:?}, where six numbers should be")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Written by VTK 9.7.2 with all ways that it has of writing numbers: 4 × 3 × 2 of them, quarters of [`QUARTERS`], and beside it, where
    /// there are two arrays, those as `other` and twice those as the active `height`.
    const FILES: [&[u8]; 7] = [
        include_bytes!("../../tests/files/ascii.vti"),
        include_bytes!("../../tests/files/base64.vti"),
        include_bytes!("../../tests/files/base64-zlib.vti"),
        include_bytes!("../../tests/files/appended-base64.vti"),
        include_bytes!("../../tests/files/appended-base64-zlib.vti"),
        include_bytes!("../../tests/files/raw.vti"),
        include_bytes!("../../tests/files/raw-zlib.vti"),
    ];
    const QUARTERS: [u8; 24] = [9, 3, 1, 4, 2, 6, 5, 8, 7, 3, 0, 4, 1, 8, 2, 9, 3, 3, 7, 6, 5, 0, 2, 8];

    fn times(factor: f64) -> Vec<f64> {
        QUARTERS.iter().map(|&quarter| f64::from(quarter) / 4.0 * factor).collect()
    }

    #[test]
    fn files_are_read_however_vtk_writes_them() {
        for (file, bytes) in FILES.into_iter().enumerate() {
            let has_two = file >= 3;
            let array = decode(bytes, None).unwrap_or_else(|problem| panic!("file {file}: {problem}"));
            assert_eq!(array.shape, [2, 3, 4], "file {file}");
            assert_eq!(array.values, Values::F64(times(if has_two { 2.0 } else { 1.0 })), "file {file}");
            let other = decode(bytes, Some("other"));
            assert_eq!(other.is_ok(), has_two, "file {file}");
            assert!(other.map_or(true, |other| other.values == Values::F64(times(1.0))), "file {file}");
        }
    }

    #[test]
    fn values_of_cells_have_one_less_along_each_axis() {
        let cells = decode(include_bytes!("../../tests/files/cells.vti"), None).expect("it can be read");
        assert_eq!(cells.shape, [2, 3]);
        assert_eq!(cells.values.to_f64(), times(1.0)[..6]);
    }

    #[test]
    fn what_is_not_read_is_named() {
        let told = |bytes: &[u8], name| decode(bytes, name).expect_err("it is not read").to_string();
        assert!(told(include_bytes!("../../tests/files/lz4.vti"), None).contains("vtkLZ4DataCompressor"));
        assert!(told(FILES[3], Some("width")).contains("it has height, other"));
        let text = |from: &str, to: &str| String::from_utf8_lossy(FILES[0]).replace(from, to).into_bytes();
        assert!(told(&text("Piece Extent=\"2", "Piece Extent=\"3"), None).contains("pieces"));
        assert!(told(&text("ImageData\"", "PolyData\""), None).contains("PolyData"));
        assert!(told(&text("Float64", "Bit"), None).contains("Bit"));
        assert!(told(&text("0 2 -1", "0 900000 -900000"), None).contains("more than"));
        assert!(told(b"", None).contains("WholeExtent"));
    }

    #[test]
    fn what_is_cut_or_changed_is_refused_or_read_and_nothing_else() {
        for bytes in FILES {
            (0..bytes.len()).for_each(|length| drop(decode(&bytes[..length], None)));
            for place in 0..bytes.len() {
                let mut changed = bytes.to_vec();
                for byte in [0, 0xff, b'9', b'<', bytes[place] ^ 1] {
                    changed[place] = byte;
                    drop(decode(&changed, None));
                }
            }
        }
    }
}
