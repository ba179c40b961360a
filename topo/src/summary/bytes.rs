//! Summaries as plain bytes, and the check of what is read.
//!
//! Numbers are little-endian. In order: `topo sum`, the version, the kind, whether zeros are kept, the least number of the
//! type of the values (which tells the types apart), four counts (pairs, pairs of zero persistence, vertices of the tree, open ones);
//! for each pair the extremum, the saddle (the extremum again if there is none), birth and end; for each vertex name, value
//! and parent; for each open one its number, how many of its blocks are joined and how many there are.

use super::Summary;
use super::reduced::{Place, Reduced};
use crate::error::Error;
use crate::filtration::Kind;
use crate::pairing::NONE;
use crate::persistence::Pair;
use crate::scalar::Scalar;
use num_traits::{Bounded, FromBytes, ToBytes};

const MAGIC: &[u8; 8] = b"topo sum";
const VERSION: u8 = 1;

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
    /// The summary as bytes, the same on every machine: some 20 a vertex and 32 a pair for values of eight bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([VERSION, u8::from(self.kind == Kind::Maximum), u8::from(self.keep_zeros)]);
        bytes.extend(S::min_value().to_le_bytes().as_ref());
        let places = &self.tree.places;
        for count in [self.pairs.len(), self.zero_count, places.len(), self.shared_count()] {
            bytes.extend((count as u64).to_le_bytes());
        }
        for pair in &self.pairs {
            bytes.extend(pair.extremum.to_le_bytes());
            bytes.extend(pair.saddle.unwrap_or(pair.extremum).to_le_bytes());
            bytes.extend(pair.birth.to_le_bytes().as_ref());
            bytes.extend(pair.end.to_le_bytes().as_ref());
        }
        for (place, parent) in places.iter().zip(&self.tree.parents) {
            bytes.extend(place.name.to_le_bytes());
            bytes.extend(place.value.to_le_bytes().as_ref());
            bytes.extend(parent.to_le_bytes());
        }
        for (place, number) in places.iter().zip(0u32..).filter(|(place, _)| place.is_open()) {
            [number, place.blocks[0], place.blocks[1]].iter().for_each(|part| bytes.extend(part.to_le_bytes()));
        }
        bytes
    }
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
        let counts: [u64; 4] = [reader.number()?, reader.number()?, reader.number()?, reader.number()?];
        let width = S::min_value().to_le_bytes().as_ref().len() as u64;
        let sizes =
            [counts[0].checked_mul(16 + 2 * width), counts[2].checked_mul(12 + width), counts[3].checked_mul(12)];
        let total = sizes.into_iter().try_fold(0u64, |total, size| total.checked_add(size?));
        if total != Some((bytes.len() - reader.at) as u64) {
            return Err(Error::Bytes { at: bytes.len() });
        }
        let pairs = (0..counts[0]).map(|_| reader.pair()).collect::<Result<_, _>>()?;
        let mut tree = Reduced::default();
        for _ in 0..counts[2] {
            tree.places.push(Place { name: reader.number()?, value: reader.number()?, blocks: [0; 2] });
            tree.parents.push(reader.number()?);
        }
        for _ in 0..counts[3] {
            let (at, number) = (reader.at, reader.number::<u32>()? as usize);
            let place = tree.places.get_mut(number).ok_or(Error::Bytes { at })?;
            place.blocks = [reader.number()?, reader.number()?];
        }
        let kind = if is_maximum { Kind::Maximum } else { Kind::Minimum };
        let zero_count = usize::try_from(counts[1]).map_err(|_| Error::Bytes { at: 0 })?;
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

    fn number<N>(&mut self) -> Result<N, Error>
    where
        N: Bounded + ToBytes + FromBytes<Bytes = <N as ToBytes>::Bytes>,
    {
        let mut number = N::min_value().to_le_bytes();
        let bytes = self.take(number.as_ref().len())?;
        number.as_mut().copy_from_slice(bytes);
        Ok(N::from_le_bytes(&number))
    }

    fn pair<S>(&mut self) -> Result<Pair<u64, S>, Error>
    where
        S: Bounded + ToBytes + FromBytes<Bytes = <S as ToBytes>::Bytes>,
    {
        let [extremum, saddle]: [u64; 2] = [self.number()?, self.number()?];
        let saddle = (saddle != extremum).then_some(saddle);
        Ok(Pair { extremum, saddle, birth: self.number()?, end: self.number()? })
    }
}
