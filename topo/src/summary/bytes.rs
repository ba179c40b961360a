//! Summaries as plain bytes, and the check of what is read.
//!
//! Of noise a summary has three vertices for each that is kept on the border, so what is written for each decides what travels between
//! machines. Names rise, and parents are near: as differences in *varints* (seven bits a byte, the lowest first, the top bit says that there
//! are more; LEB128) a vertex of an `f32` field takes 9 to 10 bytes in place of 24 as plain numbers. Values are little-endian.
//!
//! In order: `topo sum`, the version, the kind, whether zeros are kept, the least number of the type of the values (which tells the types
//! apart); the number of pairs, of pairs of zero persistence and of vertices. For each pair: the extremum less the one before it and one
//! more; twice how far it is to the saddle, less one if that is backwards, and 0 if there is none; birth and end. For each vertex: twice its name less the
//! one before it and one more, plus one if it is open; then how many of its blocks are joined, and how many are missing but one; its
//! parent as one more than a saddle is, 0 if it has none; its value.

use super::Summary;
use super::reduced::{Place, Reduced};
use crate::error::Error;
use crate::filtration::Kind;
use crate::pairing::NONE;
use crate::persistence::Pair;
use crate::scalar::Scalar;
use num_traits::{Bounded, FromBytes, ToBytes};

const MAGIC: &[u8; 8] = b"topo sum";
const VERSION: u8 = 2;
/// Twice a number of 64 bits and one more, in groups of seven.
const MOST_BITS: u32 = 70;

/// What has been read and may be anything.
#[derive(Debug)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
pub(super) struct Unchecked<S> {
    kind: Kind,
    keep_zeros: bool,
    pairs: Vec<Pair<u64, S>>,
    zero_count: usize,
    tree: Reduced<S>,
}

impl<S: Scalar> TryFrom<Unchecked<S>> for Summary<S> {
    type Error = &'static str;

    fn try_from(read: Unchecked<S>) -> Result<Self, &'static str> {
        let Unchecked { kind, keep_zeros, pairs, zero_count, tree } = read;
        let has_nan = pairs.iter().any(|pair| pair.birth.is_nan() || pair.end.is_nan())
            || tree.places.iter().any(|place| place.value.is_nan());
        let is_tree = tree.parents.len() == tree.places.len()
            && tree.places.len() < NONE as usize
            && tree.parents.iter().all(|&parent| parent == NONE || (parent as usize) < tree.places.len());
        let is_sorted = pairs.is_sorted_by(|a, b| a.extremum < b.extremum)
            && tree.places.is_sorted_by(|a, b| a.name < b.name)
            && tree.places.iter().all(|place| place.is_open() || place.blocks == [0; 2]);
        if has_nan || !is_tree || !is_sorted {
            return Err("this is no summary: a value is NaN, vertices are out of order, or one has no such parent");
        }
        Ok(Self { kind, keep_zeros, pairs, zero_count, tree })
    }
}

impl<S: Scalar + ToBytes + Bounded> Summary<S> {
    /// The summary as bytes, the same on every machine: some 5 and those of its value a vertex.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([VERSION, u8::from(self.kind == Kind::Maximum), u8::from(self.keep_zeros)]);
        bytes.extend(S::min_value().to_le_bytes().as_ref());
        let places = &self.tree.places;
        for count in [self.pairs.len(), self.zero_count, places.len()] {
            write(&mut bytes, count as u128);
        }
        let mut least = 0;
        for pair in &self.pairs {
            write(&mut bytes, u128::from(pair.extremum) - least);
            write(&mut bytes, pair.saddle.map_or(0, |saddle| folded(pair.extremum, saddle)));
            bytes.extend(pair.birth.to_le_bytes().as_ref());
            bytes.extend(pair.end.to_le_bytes().as_ref());
            least = u128::from(pair.extremum) + 1;
        }
        least = 0;
        for ((place, &parent), number) in places.iter().zip(&self.tree.parents).zip(0..) {
            write(&mut bytes, (u128::from(place.name) - least) << 1 | u128::from(place.is_open()));
            if place.is_open() {
                write(&mut bytes, place.blocks[0].into());
                write(&mut bytes, u128::from(place.blocks[1] - place.blocks[0] - 1));
            }
            write(&mut bytes, if parent == NONE { 0 } else { 1 + folded(number, u64::from(parent)) });
            bytes.extend(place.value.to_le_bytes().as_ref());
            least = u128::from(place.name) + 1;
        }
        bytes
    }
}

/// Writes a number in groups of seven bits.
fn write(bytes: &mut Vec<u8>, mut number: u128) {
    while number > 0x7f {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

/// How far it is from one number to another, as a number that is small if it is near, whichever way it is; 0 if they are the same.
fn folded(from: u64, to: u64) -> u128 {
    if to >= from { u128::from(to - from) << 1 } else { (u128::from(from - to) << 1) - 1 }
}

/// The number that is so far from another.
fn unfolded(from: u64, distance: u128) -> Option<u64> {
    let steps = u64::try_from(distance.div_ceil(2)).ok()?;
    if distance.is_multiple_of(2) { from.checked_add(steps) } else { from.checked_sub(steps) }
}

impl<S> Summary<S>
where
    S: Scalar + Bounded + ToBytes + FromBytes<Bytes = <S as ToBytes>::Bytes>,
{
    /// The summary that has been written as [bytes](Self::to_bytes).
    ///
    /// # Errors
    /// If the bytes are something else, or of another type of numbers. No more is allocated than there are bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        let mut reader = Reader { bytes, at: 0 };
        reader.expect(MAGIC)?;
        reader.expect(&[VERSION])?;
        let [is_maximum, keep_zeros] = [reader.flag()?, reader.flag()?];
        reader.expect(S::min_value().to_le_bytes().as_ref())?;
        let kind = if is_maximum { Kind::Maximum } else { Kind::Minimum };
        let [pair_count, zero_count, vertex_count] = [reader.count()?, reader.count()?, reader.count()?];
        // Nothing is reserved by the counts: lists grow as bytes are read.
        let (mut pairs, mut least) = (Vec::new(), 0);
        for _ in 0..pair_count {
            pairs.push(reader.pair(&mut least)?);
        }
        let mut tree = Reduced::default();
        least = 0;
        for number in 0..vertex_count {
            let (place, parent) = reader.place(number as u64, &mut least)?;
            tree.places.push(place);
            tree.parents.push(parent);
        }
        if reader.at != bytes.len() {
            return Err(Error::Bytes { at: reader.at });
        }
        Self::try_from(Unchecked { kind, keep_zeros, pairs, zero_count, tree }).map_err(|_| Error::Bytes { at: 0 })
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Error> {
        let end = self.at.saturating_add(count);
        let taken = self.bytes.get(self.at..end).ok_or(Error::Bytes { at: self.at })?;
        self.at = end;
        Ok(taken)
    }

    fn expect(&mut self, what: &[u8]) -> Result<(), Error> {
        let at = self.at;
        if self.take(what.len())? == what { Ok(()) } else { Err(Error::Bytes { at }) }
    }

    fn flag(&mut self) -> Result<bool, Error> {
        match self.take(1)? {
            [0] => Ok(false),
            [1] => Ok(true),
            _ => Err(Error::Bytes { at: self.at - 1 }),
        }
    }

    /// A number in groups of seven bits; one that is longer than it need be is refused, so that bytes are read in one way only.
    fn varint(&mut self) -> Result<u128, Error> {
        let (start, mut number) = (self.at, 0);
        for shift in (0..MOST_BITS).step_by(7) {
            let byte = self.take(1)?[0];
            number |= u128::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                let is_short = byte != 0 || shift == 0;
                return is_short.then_some(number).ok_or(Error::Bytes { at: start });
            }
        }
        Err(Error::Bytes { at: start })
    }

    /// A number of some type.
    fn count<N: TryFrom<u128>>(&mut self) -> Result<N, Error> {
        let at = self.at;
        N::try_from(self.varint()?).map_err(|_| Error::Bytes { at })
    }

    fn value<S>(&mut self) -> Result<S, Error>
    where
        S: Bounded + ToBytes + FromBytes<Bytes = <S as ToBytes>::Bytes>,
    {
        let mut value = S::min_value().to_le_bytes();
        let bytes = self.take(value.as_ref().len())?;
        value.as_mut().copy_from_slice(bytes);
        Ok(S::from_le_bytes(&value))
    }

    /// A name of at least `least`, given how much more it is; the next one is more.
    fn name(&self, more: u128, least: &mut u128) -> Result<u64, Error> {
        let name = u64::try_from(more + *least).map_err(|_| Error::Bytes { at: self.at })?;
        *least = u128::from(name) + 1;
        Ok(name)
    }

    fn pair<S>(&mut self, least: &mut u128) -> Result<Pair<u64, S>, Error>
    where
        S: Bounded + ToBytes + FromBytes<Bytes = <S as ToBytes>::Bytes>,
    {
        let more = self.varint()?;
        let extremum = self.name(more, least)?;
        let (at, distance) = (self.at, self.varint()?);
        let saddle = unfolded(extremum, distance).ok_or(Error::Bytes { at })?;
        Ok(Pair { extremum, saddle: (distance != 0).then_some(saddle), birth: self.value()?, end: self.value()? })
    }

    /// A vertex of the tree, and its parent.
    fn place<S>(&mut self, number: u64, least: &mut u128) -> Result<(Place<S>, u32), Error>
    where
        S: Bounded + ToBytes + FromBytes<Bytes = <S as ToBytes>::Bytes>,
    {
        let (at, more) = (self.at, self.varint()?);
        let name = self.name(more >> 1, least)?;
        let mut blocks = [0; 2];
        if more & 1 != 0 {
            let [joined, missing]: [u32; 2] = [self.count()?, self.count()?];
            let all = joined.checked_add(missing).and_then(|all| all.checked_add(1));
            blocks = [joined, all.ok_or(Error::Bytes { at })?];
        }
        let (at, distance) = (self.at, self.varint()?);
        let parent = match distance.checked_sub(1) {
            None => NONE,
            Some(distance) => {
                let parent = unfolded(number, distance).and_then(|parent| u32::try_from(parent).ok());
                parent.filter(|&parent| parent != NONE).ok_or(Error::Bytes { at })?
            }
        };
        Ok((Place { name, value: self.value()?, blocks }, parent))
    }
}
