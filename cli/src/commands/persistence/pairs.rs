//! The pairs of one direction, told in one form whatever the field's numbers and domain.

use super::field::{DomainField, on};
use crate::input::{FieldScalar, Number, each};
use topo::{Kind, PersistenceOptions};

/// An extremum with the saddle at which it joins an elder one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    pub(crate) extremum: usize,
    /// None for an essential class.
    pub(crate) saddle: Option<usize>,
    pub(crate) birth: Number,
    /// The value at the saddle; none for an essential class.
    pub(crate) death: Option<Number>,
    /// Of an essential class the range of its component.
    pub(crate) persistence: Number,
}

/// The pairs of one direction, most persistent first.
#[derive(Debug)]
pub(crate) struct PairList {
    pub(crate) kind: Kind,
    /// Those asked for.
    pub(crate) pairs: Vec<Pair>,
    /// How many finite pairs are above the least persistence.
    pub(crate) count: usize,
    /// The sum of their persistences.
    pub(crate) total: f64,
    /// How many essential classes there are.
    pub(crate) essential: usize,
    /// How many pairs of either sort have any persistence, whatever is asked for.
    pub(crate) persistent: usize,
    /// What is no more persistent than this is not among the pairs.
    pub(crate) floor: f64,
    /// How many finite pairs have no persistence.
    pub(crate) zero_pairs: usize,
}

/// Which pairs are wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    pub(crate) options: PersistenceOptions,
    /// Zero keeps what the options keep.
    pub(crate) min_persistence: f64,
    pub(crate) top: Option<usize>,
}

impl PairList {
    /// The pairs of a subject.
    pub(crate) fn new(subject: &DomainField, kind: Kind, wanted: &Wanted) -> Result<Self, topo::Error> {
        each!(&subject.values, field => on!(&subject.domain, domain => {
            let pairs = match kind {
                Kind::Minimum => wanted.options.sublevel(domain, field)?,
                Kind::Maximum => wanted.options.superlevel(domain, field)?,
            };
            Ok(Self::told(&pairs, wanted))
        }))
    }

    fn told<S: FieldScalar>(pairs: &topo::Pairs<usize, S>, wanted: &Wanted) -> Self {
        let least = wanted.min_persistence;
        let persists = |pair: &&topo::Pair<usize, S>| {
            pair.is_essential() || least == 0.0 || S::width_number(pair.persistence()).to_f64() > least
        };
        let essential = pairs.essential().count();
        let ranked = pairs.ranked();
        let kept: Vec<Pair> = ranked.iter().filter(persists).map(tell).collect();
        let finite = || kept.iter().filter(|pair| pair.saddle.is_some());
        let top = wanted.top.unwrap_or(usize::MAX);
        let next = kept.iter().skip(top).find(|pair| pair.saddle.is_some());
        Self {
            floor: next.map_or(least, |pair| pair.persistence.to_f64()),
            kind: pairs.kind(),
            count: finite().count(),
            // The sum of no floats is -0.
            total: finite().fold(0.0, |sum, pair| sum + pair.persistence.to_f64()),
            essential,
            persistent: ranked.iter().filter(|pair| S::width_number(pair.persistence()).to_f64() > 0.0).count(),
            zero_pairs: pairs.zero_count(),
            pairs: kept.into_iter().take(top).collect(),
        }
    }

    /// The finite pairs asked for.
    pub(crate) fn finite(&self) -> impl Iterator<Item = &Pair> {
        self.pairs.iter().filter(|pair| pair.saddle.is_some())
    }

    /// The essential classes asked for.
    pub(crate) fn essential(&self) -> impl Iterator<Item = &Pair> {
        self.pairs.iter().filter(|pair| pair.saddle.is_none())
    }
}

fn tell<S: FieldScalar>(pair: &topo::Pair<usize, S>) -> Pair {
    Pair {
        extremum: pair.extremum,
        saddle: pair.saddle,
        birth: pair.birth.number(),
        death: pair.death().map(S::number),
        persistence: S::width_number(pair.persistence()),
    }
}
