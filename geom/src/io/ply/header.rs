//! The header: which elements follow, how many, and what each is made of.

use super::super::error::{Fault, Place};
use super::super::text::{Line, Lines, Words};
use crate::surface::ScalarType;

/// What the header says.
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// The lines of comments, with their keywords.
    pub(super) comments: Vec<String>,
    /// How many lines it has.
    pub(super) lines: u64,
}

impl Header {
    pub(super) fn count_of(&self, name: &str) -> u64 {
        let counts = self.elements.iter().filter(|element| element.name == name).map(|element| element.count);
        counts.fold(0, u64::saturating_add)
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Encoding {
    Text,
    Binary(ByteOrder),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// Where the header speaks of it.
    pub(super) line: u64,
}

pub(super) struct Property {
    pub(super) name: String,
    pub(super) shape: Shape,
}

/// One number, or a counted list of them.
#[derive(Debug, Clone, Copy)]
pub(super) enum Shape {
    One(ScalarType),
    List { count: ScalarType, item: ScalarType },
}

/// The type of that name: those of the first version and those with their number of bits.
fn scalar_named(word: &[u8]) -> Option<ScalarType> {
    Some(match word {
        b"char" | b"int8" => ScalarType::I8,
        b"uchar" | b"uint8" => ScalarType::U8,
        b"short" | b"int16" => ScalarType::I16,
        b"ushort" | b"uint16" => ScalarType::U16,
        b"int" | b"int32" => ScalarType::I32,
        b"uint" | b"uint32" => ScalarType::U32,
        b"float" | b"float32" => ScalarType::F32,
        b"double" | b"float64" => ScalarType::F64,
        _ => return None,
    })
}

/// The header, and the byte at which the elements start.
pub(super) fn read(bytes: &[u8]) -> Result<(Header, usize), Fault> {
    let mut lines = Lines::new(bytes);
    let magic = lines.next().filter(|line| line.words().next() == Some(b"ply"));
    let magic = magic.ok_or_else(|| Fault::unexpected(Place::Line(1), "another word", "`ply`"))?;
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut comments = Vec::new();
    for line in lines {
        let mut words = line.words();
        match words.next() {
            Some(b"end_header") => {
                let encoding =
                    encoding.ok_or_else(|| Fault::unexpected(line.place(), "`end_header`", "a `format` before it"))?;
                let payload = after(&line, bytes, line_end_after(&magic, bytes));
                return Ok((Header { encoding, elements, comments, lines: line.number }, payload));
            }
            Some(b"format") => encoding = Some(read_encoding(words)?),
            Some(b"element") => elements.push(read_element(words, line.number)?),
            Some(b"property") => match elements.last_mut() {
                Some(element) => element.properties.push(read_property(words)?),
                None => return Err(Fault::unexpected(line.place(), "a property", "an element before it")),
            },
            Some(b"comment" | b"obj_info") => comments.push(String::from_utf8_lossy(line.text).trim().to_owned()),
            None => {}
            Some(_) if words.is_last() => return Err(Fault::cut_short(line.place(), "a statement of the header")),
            Some(word) => return Err(words.unexpected(word, "a statement of the header, or `end_header`")),
        }
    }
    Err(Fault::cut_short(Place::File, "a line `end_header`"))
}

/// The line end of the first line: binary data may start with bytes that look like one, so `end_header` is followed by
/// just the same.
fn line_end_after<'a>(line: &Line, bytes: &'a [u8]) -> &'a [u8] {
    let rest = &bytes[line.start + line.text.len()..];
    &rest[..if rest.starts_with(b"\r\n") { 2 } else { rest.len().min(1) }]
}

fn after(line: &Line, bytes: &[u8], line_end: &[u8]) -> usize {
    let end = line.start + line.text.len();
    if bytes[end..].starts_with(line_end) { end + line_end.len() } else { (end + 1).min(bytes.len()) }
}

fn read_encoding(mut words: Words) -> Result<Encoding, Fault> {
    match words.expect("encoding")? {
        b"ascii" => Ok(Encoding::Text),
        b"binary_little_endian" => Ok(Encoding::Binary(ByteOrder::Little)),
        b"binary_big_endian" => Ok(Encoding::Binary(ByteOrder::Big)),
        word => Err(words.unexpected(word, "`ascii`, `binary_little_endian` or `binary_big_endian`")),
    }
}

fn read_element(mut words: Words, line: u64) -> Result<Element, Fault> {
    let name = String::from_utf8_lossy(words.expect("name of an element")?).into_owned();
    let count = words.natural("number of elements")?;
    Ok(Element { name, count, properties: Vec::new(), line })
}

fn read_property(mut words: Words) -> Result<Property, Fault> {
    let shape = match words.clone().next() {
        Some(b"list") => {
            words.next();
            Shape::List { count: read_scalar(&mut words)?, item: read_scalar(&mut words)? }
        }
        _ => Shape::One(read_scalar(&mut words)?),
    };
    let name = String::from_utf8_lossy(words.expect("name of a property")?).into_owned();
    Ok(Property { name, shape })
}

fn read_scalar(words: &mut Words) -> Result<ScalarType, Fault> {
    let word = words.expect("type of a property")?;
    scalar_named(word).ok_or_else(|| words.unexpected(word, "a type such as `float`, `double`, `uchar` or `int`"))
}
