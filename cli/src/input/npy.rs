//! `NumPy`'s array files: magic, version, a dictionary of three keys as text, then the values.
//!
//! Format: `NumPy` Enhancement Proposal 1 (Kern 2007) and numpy.lib.format for versions 2 and 3. The header is read by a
//! scanner of its own grammar, with nothing in it that nests, and believed only as far as the file is long. Read: booleans,
//! integers of 8 to 64 bits, floats of 16 to 64, both byte orders, C and Fortran order. Not read: complex numbers, long
//! doubles, dates, records, objects.

use super::array::{Array, to_c_order};
use super::error::{Fault, FilePosition, Problem, ReadError};
use super::grey::check_expansion;
use super::memory;
use super::stored::{Class, Stored, fill};
use super::values::{Values, each};
use super::{ending, is_standard};
use flate2::read::MultiGzDecoder;
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;

const MAGIC: &[u8; 6] = b"\x93NUMPY";
/// No header of three keys is longer; `NumPy` itself stops at 10,000.
const LONGEST_HEADER: usize = 1 << 16;

/// Reads an array, also a gzipped one, and from standard input where the path is `-`.
pub(super) fn read(path: &Path) -> Result<Array, ReadError> {
    let decoded = if is_standard(path) {
        decode(&mut io::stdin().lock(), None, |_| Ok(()))
    } else {
        let file = File::open(path).map_err(|error| Problem::from(error).in_file(path))?;
        // What is no plain file has no length to hold the header against.
        let length = file.metadata().ok().filter(std::fs::Metadata::is_file).map(|metadata| metadata.len());
        let mut reader = BufReader::with_capacity(1 << 16, file);
        match ending(path).as_str() {
            "gz" => {
                let check = |count| check_expansion(count, length.unwrap_or(0));
                decode(&mut BufReader::new(MultiGzDecoder::new(reader)), None, check)
            }
            _ => decode(&mut reader, length, |_| Ok(())),
        }
    };
    decoded.map_err(|(place, problem)| problem.at(place, path))
}

/// Reads an array of a file of so many bytes that expands to another number of them.
pub(super) fn read_compressed(reader: &mut impl Read, compressed: u64, length: u64) -> Result<Array, Problem> {
    decode(reader, Some(length), |count| check_expansion(count, compressed)).map_err(|(_, problem)| problem)
}

fn decode(
    reader: &mut impl Read,
    length: Option<u64>,
    check: impl FnOnce(u64) -> Result<(), Problem>,
) -> Result<Array, Fault> {
    let in_file = |problem| (FilePosition::File, problem);
    let (header, start) = Header::read(reader)?;
    header
        .check(length.map(|length| length.saturating_sub(start)))
        .and_then(|()| check(header.count))
        .map_err(in_file)?;
    let values = header.item.values(reader, header.count).map_err(in_file)?;
    let shape: Vec<usize> = header.shape.iter().map(|&length| length as usize).collect();
    Ok(Array { values: if header.is_fortran { to_c_order(values, &shape) } else { values }, shape })
}

/// What the header says.
#[derive(Debug, PartialEq)]
struct Header {
    item: Stored,
    is_fortran: bool,
    shape: Vec<u64>,
    count: u64,
}

impl Header {
    /// The header and how many bytes it takes.
    fn read(reader: &mut impl Read) -> Result<(Self, u64), Fault> {
        let unreadable = |error: io::Error| (FilePosition::File, error.into());
        let mut start = [0; 10];
        let got = fill(reader, &mut start).map_err(unreadable)?;
        if got < start.len() || start[..6] != *MAGIC {
            let found = match got {
                0 => "an empty file",
                _ if MAGIC.starts_with(&start[..got.min(6)]) => "the end of the file",
                _ => "content that does not begin with \\x93NUMPY",
            };
            return Err((FilePosition::File, Problem::unexpected(found, "a NumPy array")));
        }
        let mut length = usize::from(u16::from_le_bytes([start[8], start[9]]));
        let mut before = start.len();
        match start[6] {
            1 => {}
            2 | 3 => {
                let mut high = [0; 2];
                fill(reader, &mut high).map_err(unreadable)?;
                length += usize::from(u16::from_le_bytes(high)) << 16;
                before += 2;
            }
            version => {
                let found = format!("version {version} of the format");
                return Err((FilePosition::Byte(6), Problem::unexpected(found, "1, 2 or 3")));
            }
        }
        if length > LONGEST_HEADER {
            let expected = format!("no more than {LONGEST_HEADER}");
            return Err((FilePosition::Byte(8), Problem::unexpected(format!("a header of {length} bytes"), expected)));
        }
        let mut text = vec![0; length];
        if fill(reader, &mut text).map_err(unreadable)? < length {
            return Err((FilePosition::File, Problem::unexpected("the end of the file", "the rest of the header")));
        }
        let header = Scanner { text: &text, at: 0, before }.header()?;
        Ok((header, (before + length) as u64))
    }

    /// Holds what the header claims against what is there and what there is memory for.
    fn check(&self, present: Option<u64>) -> Result<(), Problem> {
        if self.shape.is_empty() || self.shape.len() > 3 {
            return Err(Problem::Axes(self.shape.len()));
        }
        let present = present.map_or(self.count, |bytes| bytes / self.item.bytes as u64);
        if present < self.count {
            return Err(Problem::CutShort { claimed: self.count, present });
        }
        // Putting values into another order takes their room once more.
        let copies = if self.is_fortran { 2 } else { 1 };
        memory::check(self.count, copies * self.item.bytes.max(4))
    }
}

/// Goes through the header's text.
struct Scanner<'a> {
    text: &'a [u8],
    at: usize,
    /// Bytes of the file before the text.
    before: usize,
}

impl Scanner<'_> {
    /// `{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }`, the keys in any order.
    fn header(&mut self) -> Result<Header, Fault> {
        let (mut item, mut is_fortran, mut shape) = (None, None, None);
        self.expect(b'{')?;
        while !self.take(b'}') {
            let key = self.quoted()?;
            self.expect(b':')?;
            match key.as_str() {
                "descr" => item = Some(self.item()?),
                "fortran_order" => is_fortran = Some(self.boolean()?),
                "shape" => shape = Some(self.tuple()?),
                _ => return Err(self.fault(format!("the key {key:?}"), "descr, fortran_order or shape")),
            }
            if !self.take(b',') {
                self.expect(b'}')?;
                break;
            }
        }
        let (Some(item), Some(is_fortran), Some(shape)) = (item, is_fortran, shape) else {
            return Err(self.fault("the header's end", "the keys descr, fortran_order and shape"));
        };
        let product = shape.iter().try_fold(1u64, |product, &length| product.checked_mul(length));
        let count = match product {
            Some(count) => count,
            // An axis without vertices leaves none, however long the others are.
            None if shape.contains(&0) => 0,
            None => return Err((FilePosition::File, Problem::Shape(shape))),
        };
        Ok(Header { item, is_fortran, shape, count })
    }

    fn item(&mut self) -> Result<Stored, Fault> {
        if self.peek() == Some(b'[') {
            return Err((self.place(), Problem::Type("record".into())));
        }
        let name = self.quoted()?;
        parse_item(&name).ok_or_else(|| (self.place(), Problem::Type(name)))
    }

    fn boolean(&mut self) -> Result<bool, Fault> {
        for (word, value) in [("True", true), ("False", false)] {
            if self.rest().starts_with(word.as_bytes()) {
                self.at += word.len();
                return Ok(value);
            }
        }
        Err(self.fault_here("True or False"))
    }

    fn tuple(&mut self) -> Result<Vec<u64>, Fault> {
        let mut lengths = Vec::new();
        self.expect(b'(')?;
        while !self.take(b')') {
            lengths.push(self.integer()?);
            if !self.take(b',') {
                self.expect(b')')?;
                break;
            }
        }
        Ok(lengths)
    }

    fn integer(&mut self) -> Result<u64, Fault> {
        let digits = self.rest().iter().take_while(|byte| byte.is_ascii_digit()).count();
        let text = std::str::from_utf8(&self.text[self.at..self.at + digits]).unwrap_or_default();
        let value = text.parse().map_err(|_| self.fault_here("the length of an axis"))?;
        self.at += digits;
        // Python 2 wrote long integers so.
        self.take(b'L');
        Ok(value)
    }

    fn quoted(&mut self) -> Result<String, Fault> {
        let quote = self.peek().filter(|byte| matches!(byte, b'\'' | b'"'));
        let quote = quote.ok_or_else(|| self.fault_here("a word in quotes"))?;
        let length = self.text[self.at + 1..].iter().position(|&byte| byte == quote);
        let length = length.ok_or_else(|| self.fault_here("a word in quotes"))?;
        let word = String::from_utf8_lossy(&self.text[self.at + 1..self.at + 1 + length]).into_owned();
        self.at += length + 2;
        Ok(word)
    }

    fn expect(&mut self, byte: u8) -> Result<(), Fault> {
        if self.take(byte) { Ok(()) } else { Err(self.fault_here(&format!("{:?}", char::from(byte)))) }
    }

    fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    /// The next byte that is no space.
    fn peek(&mut self) -> Option<u8> {
        self.rest().first().copied()
    }

    fn rest(&mut self) -> &[u8] {
        self.at += self.text[self.at..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        &self.text[self.at..]
    }

    fn place(&self) -> FilePosition {
        FilePosition::Byte((self.before + self.at) as u64)
    }

    fn fault(&self, found: impl Into<String>, expected: &str) -> Fault {
        (self.place(), Problem::unexpected(found, expected))
    }

    fn fault_here(&mut self, expected: &str) -> Fault {
        let found = match self.peek() {
            Some(byte) => format!("{:?}", char::from(byte)),
            None => "the header's end".into(),
        };
        self.fault(found, expected)
    }
}

/// A type as `NumPy` names it: byte order, class, size.
fn parse_item(name: &str) -> Option<Stored> {
    let (order, rest) = name.split_at_checked(1)?;
    let (class, size) = rest.split_at_checked(1)?;
    let bytes = size.parse().ok()?;
    let class = match (class, bytes) {
        ("i", 1 | 2 | 4 | 8) => Class::Signed,
        ("u", 1 | 2 | 4 | 8) | ("b", 1) => Class::Unsigned,
        ("f", 2 | 4 | 8) => Class::Float,
        _ => return None,
    };
    let is_big_endian = match order {
        "<" | "|" => false,
        ">" => true,
        "=" => cfg!(target_endian = "big"),
        _ => return None,
    };
    Some(Stored { class, bytes, is_big_endian })
}

/// Writes labels as an array of `<i4`; what has none is -1.
pub(crate) fn write_labels(
    shape: &[usize],
    labels: impl Iterator<Item = Option<usize>>,
    mut out: impl Write,
) -> io::Result<()> {
    write_header("<i4", shape, &mut out)?;
    for label in labels {
        out.write_all(&label.map_or(-1, |label| label as i32).to_le_bytes())?;
    }
    Ok(())
}

/// Writes values as an array of their type.
pub(crate) fn write_values(shape: &[usize], values: &Values, mut out: impl Write) -> io::Result<()> {
    let name = match values {
        Values::I32(_) => "<i4",
        Values::I64(_) => "<i8",
        Values::U64(_) => "<u8",
        Values::F32(_) => "<f4",
        Values::F64(_) => "<f8",
    };
    write_header(name, shape, &mut out)?;
    each!(values, field => field.iter().try_for_each(|value| out.write_all(&value.to_le_bytes())))
}

fn write_header(name: &str, shape: &[usize], out: &mut impl Write) -> io::Result<()> {
    let lengths: String = shape.iter().map(|length| format!("{length}, ")).collect();
    let mut header = format!("{{'descr': '{name}', 'fortran_order': False, 'shape': ({}), }}", lengths.trim_end());
    // Values begin at a multiple of 64 bytes, a line's end before them.
    let padding = 64 - (10 + header.len() + 1) % 64;
    header += &" ".repeat(padding % 64);
    header.push('\n');
    out.write_all(MAGIC)?;
    out.write_all(&[1, 0])?;
    out.write_all(&(header.len() as u16).to_le_bytes())?;
    out.write_all(header.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(text: &str) -> Result<Header, Fault> {
        Scanner { text: text.as_bytes(), at: 0, before: 10 }.header()
    }

    #[test]
    fn keys_may_come_in_any_order_and_quotes() {
        let usual = header("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }  \n").expect("it is right");
        assert_eq!((&usual.shape[..], usual.count, usual.is_fortran), (&[3, 4][..], 12, false));
        let odd = header("{\"shape\":(12L,),\"fortran_order\":True,\"descr\":\">u2\"}").expect("it is right");
        assert_eq!(odd.item, Stored { class: Class::Unsigned, bytes: 2, is_big_endian: true });
    }

    #[test]
    fn what_is_wrong_in_a_header_is_named_with_its_place() {
        for (text, told) in [
            ("", "'{'"),
            ("{'descr': '<f8'", "'}'"),
            ("{'descr': '<f8', 'shape': (3)}", "fortran_order"),
            ("{'descr': '<c16', 'fortran_order': False, 'shape': (3,)}", "<c16"),
            ("{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (3,)}", "record"),
            ("{'shape': (-3,)}", "axis"),
            ("{'shape': (99999999999999999999,)}", "axis"),
            ("{'colour': 3}", "colour"),
            ("{'descr': 'é8'}", "é8"),
        ] {
            let (place, problem) = header(text).expect_err(text);
            assert!(problem.to_string().contains(told), "{text}: {problem}");
            assert!(matches!(place, FilePosition::Byte(10..)), "{text}");
        }
    }

    #[test]
    fn a_shape_too_large_to_count_is_refused() {
        let (_, problem) = header("{'descr': '<f8', 'fortran_order': False, 'shape': (4294967296, 4294967296, 9)}")
            .expect_err("2⁶⁴ is too large");
        assert!(matches!(problem, Problem::Shape(_)));
    }
}
