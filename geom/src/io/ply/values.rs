//! The numbers behind the header, one after the other. All of the format's types fit in f64 exactly.

use super::super::error::{Fault, Place};
use super::super::text::{Line, Lines, Words, number};
use super::header::{ByteOrder, Header};
use crate::surface::ScalarType;

/// Where numbers come from.
pub(super) trait Values {
    /// Whether nothing is left.
    fn at_end(&mut self) -> bool;

    /// How many lines or bytes are left.
    fn surplus(&mut self) -> usize;

    /// Goes to the next element.
    fn start_row(&mut self);

    /// Where we are, for messages.
    fn place(&self) -> Place;

    /// How many numbers of this type there can still be.
    fn room(&self, scalar: ScalarType) -> usize;

    /// The next number; `name` is the property's, for messages.
    fn scalar(&mut self, scalar: ScalarType, name: &str) -> Result<f64, Fault>;

    /// The next list, put in place of `list`. Its count is believed only as far as there are numbers.
    fn list(&mut self, count: ScalarType, item: ScalarType, name: &str, list: &mut Vec<f64>) -> Result<(), Fault> {
        let count = self.scalar(count, name)?;
        if !(count >= 0.0 && count <= self.room(item) as f64 && count.fract() == 0.0) {
            let found = format!("a list `{name}` of {count} number{}", if count == 1.0 { "" } else { "s" });
            return Err(Fault::unexpected(
                self.place(),
                found,
                format!("at most the {} that are left: the file is cut short or damaged", self.room(item)),
            ));
        }
        list.clear();
        for _ in 0..count as usize {
            let item = self.scalar(item, name)?;
            list.push(item);
        }
        Ok(())
    }

    /// Takes the next lists as long as they are triangles with indices below `vertices`, `most` at most, and says how many: what else there is comes
    /// by [`list`](Self::list), with its errors. Numbers in text have no faster way.
    fn triangles(&mut self, _lists: [ScalarType; 2], _vertices: u64, _most: u64, _put: impl FnMut([u32; 3])) -> u64 {
        0
    }
}

/// Numbers in text, an element a line.
pub(super) struct Text<'a> {
    lines: Lines<'a>,
    next: Option<Line<'a>>,
    words: Words<'a>,
    size: usize,
}

impl<'a> Text<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &Header, payload: usize) -> Self {
        let mut lines = Lines::after(bytes, payload, header.lines);
        let next = lines.next_filled();
        let words = Line { number: header.lines, start: payload, text: b"", is_last: false }.words();
        Self { lines, next, words, size: bytes.len() - payload }
    }
}

impl Values for Text<'_> {
    fn at_end(&mut self) -> bool {
        self.next.is_none()
    }

    fn surplus(&mut self) -> usize {
        let filled = self.lines.by_ref().filter(|line| line.words().next().is_some());
        filled.count() + usize::from(self.next.is_some())
    }

    fn start_row(&mut self) {
        if let Some(line) = self.next.take() {
            self.words = line.words();
            self.next = self.lines.next_filled();
        }
    }

    fn place(&self) -> Place {
        self.words.place()
    }

    fn room(&self, _: ScalarType) -> usize {
        self.size
    }

    fn scalar(&mut self, _: ScalarType, name: &str) -> Result<f64, Fault> {
        let word = self.words.next();
        let word = word.ok_or_else(|| self.words.ended(format!("`{name}`")))?;
        number(word).ok_or_else(|| self.words.unexpected(word, format!("a number for `{name}`")))
    }
}

/// Numbers in binary.
pub(super) struct Binary<'a> {
    bytes: &'a [u8],
    at: usize,
    order: ByteOrder,
}

impl<'a> Binary<'a> {
    pub(super) fn new(bytes: &'a [u8], at: usize, order: ByteOrder) -> Self {
        Self { bytes, at, order }
    }

    /// The next bytes, in little-endian order.
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut bytes: [u8; N] = *self.bytes.get(self.at..)?.first_chunk()?;
        if self.order == ByteOrder::Big {
            bytes.reverse();
        }
        self.at += N;
        Some(bytes)
    }

    fn decode(&mut self, scalar: ScalarType) -> Option<f64> {
        Some(match scalar {
            ScalarType::I8 => i8::from_le_bytes(self.take()?).into(),
            ScalarType::U8 => u8::from_le_bytes(self.take()?).into(),
            ScalarType::I16 => i16::from_le_bytes(self.take()?).into(),
            ScalarType::U16 => u16::from_le_bytes(self.take()?).into(),
            ScalarType::I32 => i32::from_le_bytes(self.take()?).into(),
            ScalarType::U32 => u32::from_le_bytes(self.take()?).into(),
            ScalarType::F32 => f32::from_le_bytes(self.take()?).into(),
            ScalarType::F64 => f64::from_le_bytes(self.take()?),
        })
    }
}

impl Values for Binary<'_> {
    fn at_end(&mut self) -> bool {
        self.at >= self.bytes.len()
    }

    fn surplus(&mut self) -> usize {
        self.bytes.len() - self.at
    }

    fn start_row(&mut self) {}

    fn place(&self) -> Place {
        Place::Byte(self.at as u64)
    }

    fn room(&self, scalar: ScalarType) -> usize {
        (self.bytes.len() - self.at) / scalar.size()
    }

    fn scalar(&mut self, scalar: ScalarType, name: &str) -> Result<f64, Fault> {
        let value = self.decode(scalar);
        value.ok_or_else(|| Fault::cut_short(self.place(), format!("a number for `{name}`")))
    }

    fn triangles(&mut self, lists: [ScalarType; 2], vertices: u64, most: u64, mut put: impl FnMut([u32; 3])) -> u64 {
        use ScalarType::{I8, I32, U8, U32};
        if !matches!(lists, [I8 | U8, I32 | U32]) {
            return 0;
        }
        let rows = self.bytes.get(self.at..).unwrap_or_default().as_chunks::<13>().0;
        let index = match self.order {
            ByteOrder::Little => u32::from_le_bytes,
            ByteOrder::Big => u32::from_be_bytes,
        };
        // As a signed number what is beyond would be negative.
        let vertices = vertices.min(1 << 31);
        let triangle = |&[count, corners @ ..]: &[u8; 13]| {
            let corners = [0, 4, 8].map(|at| index([corners[at], corners[at + 1], corners[at + 2], corners[at + 3]]));
            (count == 3 && corners.iter().all(|&v| u64::from(v) < vertices)).then_some(corners)
        };
        let mut count = 0;
        for corners in rows.iter().take(usize::try_from(most).unwrap_or(usize::MAX)).map_while(triangle) {
            put(corners);
            count += 1;
        }
        self.at += count * size_of::<[u8; 13]>();
        count as u64
    }
}
