//! Where cones are put: every method, and the one place that dispatches them.
//!
//! A method is one variant of [`Placement`] and what it stands for in the `match`es below; nothing outside this folder asks
//! which method it has.

mod automatic;
mod coarse_to_fine;
pub(crate) mod configuration;
mod energy_model;
mod exchange;
mod iterative;
mod level;
mod many;
mod matching_pursuit;
mod moved_off;
mod nested;
mod prediction;
mod pursuit;
mod quantized;
mod refactoring;
mod refined;
mod separation;
mod swap_table;

use std::sync::{Arc, OnceLock};

use geom::{Interrupted, Mesh, PoissonError, VertexId, Watch};

use crate::curvature::{ConeCurvatures, CurvatureRule};
use crate::field::Operators;
use crate::hierarchy::ConeHierarchy;

pub(crate) use automatic::{Automatic, Goal, corners};
pub(crate) use energy_model::EnergyTerms;
pub use energy_model::{ConeSet, EnergyModel};
pub(crate) use level::{CoarseLevel, size_of_level};
pub(crate) use moved_off::moved_off;
pub use nested::Nested;
pub(crate) use nested::{ComponentOrder, cones_of_sequence, curve_of_sequence};
pub use prediction::Prediction;
pub(crate) use prediction::{MOST_STRETCH, Predictor, area_distortion, distortion_of, is_hopeless, stretch};
pub(crate) use pursuit::BLOCK;
pub use pursuit::pursuit;
pub(crate) use quantized::quantized;
pub use refined::refined;

/// More cones than this are not optimised: those are placed by persistence.
pub const MOST_OPTIMISED: usize = 512;

/// More cones than this are placed many at a time, and have no nested order by [`Placement::Pursuit`]: what looks for each
/// cone by itself takes a time that grows with the third power of their number.
pub const MOST_ORDERED: usize = 64;

/// How cones are placed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Placement {
    /// The most persistent maximum, minimum, second maximum, second minimum, … of the conformal factor, as in the paper.
    Alternating,
    /// The extrema of the conformal factor by persistence, whatever their sign.
    Persistence,
    /// The highest and the lowest point of the conformal factor, level by level with it pinned to 0 at the cones
    /// (Ben-Chen, Gotsman & Bunin 2008), on one factorization.
    Iterative,
    /// As [`Iterative`](Self::Iterative), with a factorization for each level, as published: the same cones for far more
    /// time, to compare with.
    Refactoring,
    /// One by one where the pinned conformal factor is largest in absolute value (Sawhney & Crane 2017).
    Greedy,
    /// The best set found of this very number; not nested.
    #[default]
    Refined,
    /// The best nested order found, for every number.
    Pursuit,
}

/// How thoroughly the best cones are looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Search {
    /// On a coarse level of a surface that has many vertices, then round what is found there on the surface itself.
    #[default]
    CoarseToFine,
    /// On all vertices. Takes six to eight times as long, for norms that are less than half a hundredth better on average.
    Full,
}

/// How components of one model share cones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sharing {
    /// By what cones bring, from curves that serve one number only.
    BriefCurves,
    /// By what cones bring, for every number.
    Curves,
    /// By the persistence of their extrema.
    Persistence,
}

/// Where cones were placed.
pub(crate) struct Placed {
    pub(crate) cones: Vec<VertexId>,
    /// Their optimal curvatures, where the search has found them.
    pub(crate) curvatures: Option<ConeCurvatures>,
}

impl From<Vec<VertexId>> for Placed {
    fn from(cones: Vec<VertexId>) -> Self {
        Self { cones, curvatures: None }
    }
}

/// A connected surface that cones are placed on.
#[derive(Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub(crate) operators: &'a Operators,
    /// The triangulation that will be laid out.
    pub(crate) input: &'a Mesh,
    pub(crate) hierarchy: &'a ConeHierarchy,
    /// Found when they are first asked for.
    pub(crate) terms: &'a OnceLock<Arc<EnergyTerms>>,
    /// Made when it is first asked for; none where it cannot be made.
    pub(crate) level: &'a OnceLock<Option<CoarseLevel>>,
    pub(crate) search: Search,
    pub(crate) watch: Watch<'a>,
}

impl<'a> Ground<'a> {
    /// The energy model, with an empty pool: what is found never depends on what was asked before.
    ///
    /// # Errors
    /// If the watch has said stop.
    pub(crate) fn energy_model(&self) -> Result<EnergyModel<'a>, Interrupted> {
        let terms = match self.terms.get() {
            Some(terms) => terms,
            None => {
                let watch = self.watch.within(f64::NAN, f64::NAN);
                let found = EnergyTerms::new(self.operators, self.input, watch)?;
                self.terms.get_or_init(|| Arc::new(found))
            }
        };
        Ok(EnergyModel::with_terms(self.operators, Arc::clone(terms), self.watch))
    }

    /// The coarse level to search on: none for surfaces with few vertices, or where a full search is asked for.
    ///
    /// # Errors
    /// If the watch has said stop.
    pub(crate) fn level(&self) -> Result<Option<&'a CoarseLevel>, Interrupted> {
        if self.search == Search::Full || self.operators.mesh.vertex_count() < level::LEAST_VERTICES {
            return Ok(None);
        }
        if let Some(level) = self.level.get() {
            return Ok(level.as_ref());
        }
        let made = match CoarseLevel::new(self.operators, self.input, self.watch.within(f64::NAN, f64::NAN)) {
            Ok(level) => Some(level),
            Err(PoissonError::Interrupted(interrupted)) => return Err(interrupted),
            Err(_) => None,
        };
        Ok(self.level.get_or_init(|| made).as_ref())
    }

    /// The best nested order of so many cones.
    fn pursued(self, count: usize) -> Result<Nested, Interrupted> {
        match self.level()? {
            Some(level) => coarse_to_fine::order_from(self, level, count),
            None => Ok(pursuit(&mut self.energy_model()?, count)),
        }
    }

    /// The best cones of so many, for this number alone.
    fn refined(self, count: usize) -> Result<Placed, PoissonError> {
        if count > MOST_ORDERED {
            return self.many(count);
        }
        if let Some(level) = self.level()?
            && let Some(placed) = coarse_to_fine::refined_from(self, level, count)?
        {
            return Ok(placed);
        }
        // On needles the curvatures found by themselves are better, and here they cost little.
        Ok(refined(&mut self.energy_model()?, count).cones.into())
    }
}

impl Ground<'_> {
    /// So many cones that they are placed many at a time.
    fn many(self, count: usize) -> Result<Placed, PoissonError> {
        let watch = self.watch.within(f64::NAN, f64::NAN);
        let made = match self.search {
            Search::CoarseToFine => CoarseLevel::for_many(self.operators, self.input, count, watch)?,
            Search::Full => None,
        };
        let Some(level) = made else { return Ok(many::many_cones(&mut self.energy_model()?, count).cones.into()) };
        let set = many::many_cones(&mut level.energy_model(self.watch), count);
        if level::has_middle(&self.operators.mesh)
            && let Some(middle) = self.level()?.and_then(CoarseLevel::middle)
            && let Some(placed) = coarse_to_fine::with_curvatures_of(self, middle, level.of_surface(&set.cones))?
        {
            return Ok(placed);
        }
        Ok(coarse_to_fine::on_surface(&self.energy_model()?, &level, &set).into())
    }
}

impl Placement {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Alternating,
        Self::Persistence,
        Self::Iterative,
        Self::Refactoring,
        Self::Greedy,
        Self::Refined,
        Self::Pursuit,
    ];

    /// Its name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Alternating => "alternating",
            Self::Persistence => "persistence",
            Self::Iterative => "iterative",
            Self::Refactoring => "refactoring",
            Self::Greedy => "greedy",
            Self::Refined => "refined",
            Self::Pursuit => "pursuit",
        }
    }

    /// What it does, in a line.
    pub fn description(self) -> &'static str {
        match self {
            Self::Alternating => "As in the paper: the most persistent maximum, minimum, maximum, …",
            Self::Persistence => "By persistence, whatever their kind",
            Self::Iterative => "Highest and lowest point of the conformal factor, again and again",
            Self::Refactoring => "The same with a factorization for each level, as published: to compare with",
            Self::Greedy => "Where the conformal factor is farthest from 0, again and again",
            Self::Refined => "The best set for this number of cones",
            Self::Pursuit => "The best order, good for every number of cones",
        }
    }

    /// Whether the first cones of a number are those of each smaller one.
    pub fn is_nested(self) -> bool {
        self != Self::Refined
    }

    /// Whether it reads the extrema of the conformal factor, so that diffusing the curvature first changes its cones.
    pub fn reads_extrema(self) -> bool {
        matches!(self, Self::Alternating | Self::Persistence)
    }

    fn is_optimised(self) -> bool {
        matches!(self, Self::Refined | Self::Pursuit)
    }

    /// The method that places so many cones: so many that optimising them would take minutes are placed by persistence.
    pub fn for_count(self, count: usize) -> Self {
        let most = if self == Self::Refined { MOST_OPTIMISED } else { MOST_ORDERED };
        if self.is_optimised() && count > most { Self::Persistence } else { self }
    }

    /// The method whose order is used where one is needed for every number.
    pub(crate) fn nested(self) -> Self {
        if self == Self::Refined { Self::Pursuit } else { self }
    }

    pub(crate) fn sharing(self) -> Sharing {
        match self {
            Self::Refined => Sharing::BriefCurves,
            Self::Pursuit => Sharing::Curves,
            _ => Sharing::Persistence,
        }
    }

    /// `count` cones; fewer only where there is no room for more.
    ///
    /// # Errors
    /// If a Laplacian cannot be factored, by [`Refactoring`](Self::Refactoring).
    pub(crate) fn cones(self, ground: Ground, count: usize) -> Result<Placed, PoissonError> {
        let Ground { operators, hierarchy, watch, .. } = ground;
        let cones = match self {
            Self::Alternating => hierarchy.alternating(operators, count, watch),
            Self::Persistence => hierarchy.by_persistence(operators, count, watch),
            Self::Iterative => iterative::iterative(operators, count, watch),
            Self::Refactoring => refactoring::iterative_refactoring(operators, count, watch)?,
            Self::Greedy => iterative::greedy(operators, count, watch),
            Self::Refined => return ground.refined(count),
            Self::Pursuit => ground.pursued(count)?.cones().to_vec(),
        };
        Ok(cones.into())
    }

    /// `count` cones as [`cones`](Self::cones), but the best set is looked for with many cones moved at a time: of 48 it takes a tenth
    /// of the time, for an area distortion a hundredth worse.
    ///
    /// # Errors
    /// As [`cones`](Self::cones).
    pub(crate) fn quick_cones(self, ground: Ground, count: usize) -> Result<Placed, PoissonError> {
        if self == Self::Refined { ground.many(count) } else { self.cones(ground, count) }
    }

    /// A nested order of at least so many cones, as far as there are so many; an optimised one is found in whole blocks, at
    /// most [`MOST_ORDERED`] cones.
    ///
    /// # Errors
    /// As [`cones`](Self::cones).
    pub(crate) fn order(self, ground: Ground, count: usize) -> Result<Nested, PoissonError> {
        if self.is_optimised() {
            return Ok(ground.pursued(whole_blocks(ground.operators, count))?);
        }
        let order = self.cones(ground, count)?.cones;
        Ok(Nested::new(&mut ground.energy_model()?.putting_columns_off(), &order))
    }

    /// As few cones as keep the predicted area distortion within a target, as a goal says it.
    ///
    /// # Errors
    /// As [`cones`](Self::cones).
    pub(crate) fn fewest(self, ground: Ground, rule: CurvatureRule, goal: Goal) -> Result<Automatic, PoissonError> {
        if self == Self::Refined
            && let Some(level) = ground.level()?
        {
            return coarse_to_fine::fewest_from(ground, level, rule, goal);
        }
        let mut model = ground.energy_model()?;
        if self == Self::Refined {
            let choose = if goal.to_knee { automatic::automatic_to_knee } else { automatic::automatic };
            return Ok(choose(&mut model, rule, goal));
        }
        let order = self.cones(ground, goal.most)?.cones;
        Ok(automatic::shortest(&mut model.putting_columns_off(), &order, rule, goal.target))
    }

    /// The draft that [`fewest`](Self::fewest) would find of at most so many cones if the surface's handles were opened: of its coarse level, opened there. Nothing
    /// where that cannot be had.
    ///
    /// # Errors
    /// As [`cones`](Self::cones).
    pub(crate) fn draft_opened(
        self,
        ground: Ground,
        rule: CurvatureRule,
        (target, most): (f64, usize),
    ) -> Result<Option<Automatic>, PoissonError> {
        let level = if self == Self::Refined { ground.level()? } else { None };
        let Some(level) = level else { return Ok(None) };
        let opened = level.with_handles_opened(ground.input, ground.watch.within(0.0, 0.5))?;
        let goal = Goal { target, most, to_knee: false, is_draft: true, is_part: false };
        Ok(opened
            .map(|opened| automatic::automatic(&mut opened.energy_model(ground.watch.within(0.5, 1.0)), rule, goal)))
    }
}

/// The best nested order found on the coarse level of a surface, in the level's vertices, or on the surface itself where it has none:
/// in whole blocks, or for few cones up to just so many. That is cheaper, but orders of different lengths may differ.
///
/// # Errors
/// If the watch has said stop.
pub(crate) fn searched_order(ground: Ground, count: usize, is_brief: bool) -> Result<Nested, Interrupted> {
    let model = &mut match ground.level()? {
        Some(level) => level.energy_model(ground.watch),
        None => ground.energy_model()?,
    };
    let least = count.max(crate::curvature::least_cones(ground.operators));
    Ok(if is_brief && least <= BLOCK {
        pursuit::brief_pursuit(model, least)
    } else {
        pursuit(model, whole_blocks(ground.operators, count))
    })
}

/// The length of the order that a curve up to `most` cones is read from.
pub(crate) fn whole_blocks(operators: &Operators, most: usize) -> usize {
    most.max(crate::curvature::least_cones(operators)).next_multiple_of(BLOCK).min(LONGEST_CURVE)
}

/// Curves are computed up to this number of cones. Beyond, the energy is taken to fall like 1/N, as it does about.
const LONGEST_CURVE: usize = 2 * BLOCK;
