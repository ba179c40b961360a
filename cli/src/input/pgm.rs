//! Portable grey maps: P2 in decimal, P5 in bytes, of one or two bytes a value.
//!
//! Format: the manual page `pgm(5)` of Netpbm. Only the first picture of a file is read.

use super::array::Array;
use super::error::{Fault, FilePosition, Problem, ReadError};
use super::memory;
use super::values::Values;
use std::path::Path;

/// Reads a picture.
pub(super) fn read(path: &Path) -> Result<Array, ReadError> {
    let bytes = std::fs::read(path).map_err(|error| Problem::from(error).in_file(path))?;
    parse(&bytes).map_err(|(place, problem)| problem.at(place, path))
}

fn parse(bytes: &[u8]) -> Result<Array, Fault> {
    let is_binary = match bytes.get(..2) {
        Some(b"P5") => true,
        Some(b"P2") => false,
        _ => {
            let found = if bytes.is_empty() { "an empty file" } else { "content that begins otherwise" };
            return Err((FilePosition::Byte(0), Problem::unexpected(found, "P2 or P5, a grey map")));
        }
    };
    let mut words = Words { bytes, at: 2 };
    let width = words.number("the width", u32::MAX)?;
    let height = words.number("the height", u32::MAX)?;
    let most = words.number("the greatest value, from 1 to 65535,", 65535)?;
    if most == 0 {
        return Err(words.fault("0", "the greatest value, from 1 to 65535,"));
    }
    let claimed = u64::from(width) * u64::from(height);
    let size = if most < 256 { 1 } else { 2 };
    // In decimal a value takes a digit and a space; the last one needs no space.
    let (start, room) = if is_binary { (words.at + 1, size) } else { (words.at, 2) };
    let rest = bytes.get(start..).unwrap_or_default();
    let present = (rest.len() + usize::from(!is_binary)) as u64 / room;
    if present < claimed {
        return Err((FilePosition::File, Problem::CutShort { claimed, present }));
    }
    memory::check(claimed, 4).map_err(|problem| (FilePosition::File, problem))?;
    let values = match (is_binary, size) {
        (false, _) => (0..claimed).map(|_| Ok(words.number("a value", most)? as i32)).collect::<Result<_, Fault>>()?,
        (true, 1) => rest.iter().take(claimed as usize).map(|&value| value.into()).collect(),
        (true, _) => {
            rest.chunks_exact(2).take(claimed as usize).map(|b| u16::from_be_bytes([b[0], b[1]]).into()).collect()
        }
    };
    Ok(Array { values: Values::I32(values), shape: vec![height as usize, width as usize] })
}

/// The words of the text, comments left out.
struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Words<'_> {
    fn number(&mut self, what: &str, most: u32) -> Result<u32, Fault> {
        self.skip_space();
        let rest = &self.bytes[self.at..];
        let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let text = std::str::from_utf8(&rest[..digits]).unwrap_or_default();
        let number = text.parse().ok().filter(|number| *number <= most);
        let word = rest.iter().take_while(|byte| !byte.is_ascii_whitespace()).take(20).count();
        let number = number.ok_or_else(|| match word {
            0 => self.fault("the end", what),
            _ => self.fault(format!("{:?}", String::from_utf8_lossy(&rest[..word])), what),
        })?;
        self.at += digits;
        Ok(number)
    }

    fn skip_space(&mut self) {
        while let Some(&byte) = self.bytes.get(self.at) {
            if byte == b'#' {
                self.at += self.bytes[self.at..].iter().take_while(|&&byte| byte != b'\n').count();
            } else if byte.is_ascii_whitespace() {
                self.at += 1;
            } else {
                break;
            }
        }
    }

    fn fault(&self, found: impl Into<String>, expected: &str) -> Fault {
        (FilePosition::Byte(self.at as u64), Problem::unexpected(found, expected))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_kinds_hold_the_same_picture() {
        let decimal = parse(b"P2\n# by hand\n3 2 255\n0 1 2\n3 4 255\n").expect("it is right");
        let binary = parse(b"P5 3 2 255\n\x00\x01\x02\x03\x04\xff").expect("it is right");
        assert_eq!(decimal.values, Values::I32(vec![0, 1, 2, 3, 4, 255]));
        assert_eq!((binary.values, binary.shape), (decimal.values, vec![2, 3]));
        let wide = parse(b"P5 1 1 65535\n\x01\x02").expect("it is right");
        assert_eq!(wide.values, Values::I32(vec![258]));
    }

    #[test]
    fn damage_is_named_with_its_place() {
        for (bytes, told) in [
            (&b""[..], "P2 or P5"),
            (b"P5", "the width"),
            (b"P5 4000000000 4000000000 255\n", "cut short"),
            (b"P5 2 2 70000\n", "65535"),
            (b"P2 2 1 9\n3 x\n", "\"x\""),
            (b"P2 2 1 9\n3 10\n", "\"10\""),
        ] {
            let (_, problem) = parse(bytes).expect_err("it is damaged");
            assert!(problem.to_string().contains(told), "{problem}");
        }
    }
}
