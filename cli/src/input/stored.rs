//! Numbers as they lie in binary files: integers of 8 to 64 bits, floats of 16 to 64, in both byte orders.

use super::error::Problem;
use super::values::Values;
use std::io::{self, Read};

/// How a value is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stored {
    pub(super) class: Class,
    pub(super) bytes: usize,
    pub(super) is_big_endian: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Class {
    Signed,
    Unsigned,
    Float,
}

impl Stored {
    /// So many values in the order in which they are stored.
    pub(super) fn values(self, reader: &mut impl Read, count: u64) -> Result<Values, Problem> {
        Ok(match (self.class, self.bytes) {
            (Class::Signed, 1) => Values::I32(self.decode(reader, count, |b: [u8; 1]| i8::from_le_bytes(b).into())?),
            (Class::Signed, 2) => Values::I32(self.decode(reader, count, |b| i16::from_le_bytes(b).into())?),
            (Class::Signed, 4) => Values::I32(self.decode(reader, count, i32::from_le_bytes)?),
            (Class::Signed, _) => Values::I64(self.decode(reader, count, i64::from_le_bytes)?),
            (Class::Unsigned, 1) => Values::I32(self.decode(reader, count, |b: [u8; 1]| b[0].into())?),
            (Class::Unsigned, 2) => Values::I32(self.decode(reader, count, |b| u16::from_le_bytes(b).into())?),
            (Class::Unsigned, 4) => Values::I64(self.decode(reader, count, |b| u32::from_le_bytes(b).into())?),
            (Class::Unsigned, _) => Values::U64(self.decode(reader, count, u64::from_le_bytes)?),
            (Class::Float, 2) => Values::F32(self.decode(reader, count, |b| half(u16::from_le_bytes(b)))?),
            (Class::Float, 4) => Values::F32(self.decode(reader, count, f32::from_le_bytes)?),
            (Class::Float, _) => Values::F64(self.decode(reader, count, f64::from_le_bytes)?),
        })
    }

    /// Decodes values of `N` bytes, given to `decode` in little endian. Memory grows with what comes in.
    fn decode<const N: usize, T>(
        self,
        reader: &mut impl Read,
        claimed: u64,
        decode: impl Fn([u8; N]) -> T,
    ) -> Result<Vec<T>, Problem> {
        let mut values = Vec::new();
        let mut block = vec![0; N << 13];
        while (values.len() as u64) < claimed {
            let wanted = (claimed - values.len() as u64).min(1 << 13) as usize * N;
            let got = fill(reader, &mut block[..wanted])?;
            for item in block[..got].chunks_exact(N) {
                let mut item: [u8; N] = item.try_into().expect("chunks are of this length");
                if self.is_big_endian {
                    item.reverse();
                }
                values.push(decode(item));
            }
            if got < wanted {
                return Err(Problem::CutShort { claimed, present: values.len() as u64 });
            }
        }
        Ok(values)
    }
}

/// Reads until the buffer is full or the file ends.
pub(super) fn fill(reader: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match reader.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(got) => filled += got,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(filled)
}

/// A float of 16 bits: 1 of sign, 5 of exponent, 10 of fraction (IEEE 754-2008).
fn half(bits: u16) -> f32 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f32::from(bits & 0x3ff) / 1024.0);
    let magnitude = match exponent {
        0 => fraction * 2f32.powi(-14),
        31 if fraction == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        _ => (1.0 + fraction) * 2f32.powi(exponent - 15),
    };
    if bits >> 15 == 0 { magnitude } else { -magnitude }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_what_they_stand_for() {
        let told = [0x3c00, 0xc000, 0x3555, 0x0001, 0x7bff, 0xfc00].map(half);
        assert_eq!(told, [1.0, -2.0, 0.333_251_95, 5.960_464_5e-8, 65504.0, f32::NEG_INFINITY]);
        assert!(half(0x7e00).is_nan());
    }
}
