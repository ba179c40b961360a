//! Bytes as VTK's XML files hold them: raw or as base64, a number of bytes before them, or in blocks compressed by zlib.
//!
//! Format: "VTK File Formats" of the VTK User's Guide. Base64 may end in padding and go on: the header of compressed blocks is encoded by
//! itself. Compressed blocks are told of before the first: how many there are, the size of each and of the last, if that is
//! smaller, and the compressed size of each.

use super::error::Problem;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use std::io::{self, Cursor, Read};

/// How a file writes the numbers before its bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeaderNumbers {
    pub(super) bytes: usize,
    pub(super) is_big_endian: bool,
}

impl HeaderNumbers {
    fn read(self, reader: &mut impl Read) -> Result<u64, Problem> {
        let mut bytes = [0; 8];
        reader.read_exact(&mut bytes[..self.bytes])?;
        if self.is_big_endian {
            bytes[..self.bytes].reverse();
        }
        Ok(u64::from_le_bytes(bytes))
    }

    /// The bytes behind the number of them, which must be as many as are expected.
    pub(super) fn plain<R: Read>(self, mut reader: R, expected: u64) -> Result<io::Take<R>, Problem> {
        let bytes = self.read(&mut reader)?;
        check_size(bytes, expected)?;
        Ok(reader.take(bytes))
    }

    /// The bytes of compressed blocks, which must come to as many as are expected.
    pub(super) fn compressed<R: Read>(self, mut reader: R, expected: u64) -> Result<Blocks<R>, Problem> {
        let [count, size, last] = [self.read(&mut reader)?, self.read(&mut reader)?, self.read(&mut reader)?];
        let whole = if last == 0 { count } else { count.saturating_sub(1) };
        check_size(whole.saturating_mul(size).saturating_add(if count == 0 { 0 } else { last }), expected)?;
        // Memory grows with what comes in.
        let sizes = (0..count).map(|_| self.read(&mut reader)).collect::<Result<Vec<u64>, _>>()?;
        Ok(Blocks { reader, sizes: sizes.into_iter(), size, block: Cursor::default() })
    }
}

fn check_size(found: u64, expected: u64) -> Result<(), Problem> {
    let is_right = found == expected;
    is_right.then_some(()).ok_or_else(|| Problem::Vti(format!("an array has {found} bytes where {expected} should be")))
}

/// Blocks, each compressed by itself.
#[derive(Debug)]
pub(super) struct Blocks<R> {
    reader: R,
    /// The compressed sizes of those that are to come.
    sizes: std::vec::IntoIter<u64>,
    /// Of a block that is not compressed, at most.
    size: u64,
    block: Cursor<Vec<u8>>,
}

impl<R: Read> Read for Blocks<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let got = self.block.read(buffer)?;
            let Some(size) = (if got == 0 && !buffer.is_empty() { self.sizes.next() } else { None }) else {
                return Ok(got);
            };
            let (mut compressed, mut block) = (Vec::new(), Vec::new());
            self.reader.by_ref().take(size).read_to_end(&mut compressed)?;
            ZlibDecoder::new(&compressed[..]).take(self.size).read_to_end(&mut block)?;
            self.block = Cursor::new(block);
        }
    }
}

/// The bytes that base64 stands for; white space is passed over.
#[derive(Debug)]
pub(super) struct Base64<'a> {
    letters: &'a [u8],
    /// Bytes of the last group of four letters, and those that have not been read.
    group: [u8; 3],
    left: std::ops::Range<usize>,
}

impl<'a> Base64<'a> {
    pub(super) fn new(letters: &'a [u8]) -> Self {
        Self { letters, group: [0; 3], left: 0..0 }
    }

    /// Decodes the next group, if there is one.
    fn decode(&mut self) -> io::Result<()> {
        let (mut group, mut count) = ([b'='; 4], 0);
        while let (Some((&letter, rest)), true) = (self.letters.split_first(), count < 4) {
            self.letters = rest;
            if !letter.is_ascii_whitespace() {
                group[count] = letter;
                count += 1;
            }
        }
        let decoded = if count == 0 { Ok(0) } else { STANDARD.decode_slice(group, &mut self.group) };
        self.left = 0..decoded.map_err(io::Error::other)?;
        Ok(())
    }
}

impl Read for Base64<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut filled = 0;
        while filled < buffer.len() {
            if self.left.is_empty() {
                self.decode()?;
            }
            let Some(place) = self.left.next() else { break };
            buffer[filled] = self.group[place];
            filled += 1;
        }
        Ok(filled)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_goes_on_behind_padding() {
        let text = format!(" {}\n{}{}", STANDARD.encode("a"), STANDARD.encode("bcde"), STANDARD.encode("fgh"));
        let mut told = String::new();
        Base64::new(text.as_bytes()).read_to_string(&mut told).expect("it is base64");
        assert_eq!(told, "abcdefgh");
        assert!(Base64::new(b"ab!d").read_to_string(&mut told).is_err());
    }
}
