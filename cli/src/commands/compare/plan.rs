//! What `cones unwrap` does when it is asked for so many cones: how many each part gets, and why not as many as that.
//!
//! A surface may need more cones, or have a method's cones fail and others tried. A comparison follows: all methods with the
//! same cones follow the same plan, so that a baseline is flattened with the cones, and along the cut, of what it is compared with.

use cones::report::sentences;
use cones::{ConeChoice, Options, unwrap_model};
use thiserror::Error;

use super::prepared::PreparedModel;
use super::variant::Variant;

/// How many cones a method is run with.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// For each part.
    pub(super) counts: Vec<usize>,
    /// What `cones unwrap` warns of.
    pub(super) warnings: Vec<String>,
}

/// Why there is none.
#[derive(Debug, Error)]
enum PlanError {
    #[error(transparent)]
    Unwrap(#[from] cones::Error),
    /// With a cone at every vertex any surface is flat: no result of any method.
    #[error(
        "{} would be unfolded with a cone at every vertex, which compares with nothing ({warnings})",
        if *all == 1 { "the surface".to_owned() } else { format!("{parts} of {all} parts") }
    )]
    Unfolded { parts: usize, all: usize, warnings: String },
}

impl Plan {
    /// Unwraps a mesh, with cones by a method that `cones unwrap` has.
    fn new(subject: &PreparedModel, method: Variant, asked: usize) -> Result<Self, PlanError> {
        let options = Options { cones: ConeChoice::Count(asked), ..method.options() };
        let atlas = unwrap_model(&subject.model, &options)?;
        let all = subject.surfaces.len();
        let warnings = sentences(&atlas.notes, all);
        if atlas.unfolded > 0 {
            return Err(PlanError::Unfolded { parts: atlas.unfolded, all, warnings: warnings.join("; ") });
        }
        let mut counts = vec![0; all];
        atlas.cones.iter().for_each(|cone| counts[cone.component] += 1);
        Ok(Self { counts, warnings })
    }

    /// What there is to know about a method that follows this plan.
    pub(super) fn notes(&self, variant: Variant) -> Vec<String> {
        let leader = variant.leader();
        if variant.flattening == leader.flattening || self.warnings.is_empty() {
            return self.warnings.clone();
        }
        vec![format!("cut as for {}: {}", leader.name(), self.warnings.join("; "))]
    }
}

/// The plans of all methods on a mesh, each found once.
pub(super) struct Plans<'a> {
    subject: &'a PreparedModel,
    known: Vec<(Variant, usize, Result<Plan, String>)>,
}

impl<'a> Plans<'a> {
    pub(super) fn new(subject: &'a PreparedModel) -> Self {
        Self { subject, known: Vec::new() }
    }

    /// The plan of a method with so many cones, or why there is none.
    pub(super) fn of(&mut self, variant: Variant, asked: usize) -> Result<Plan, String> {
        let leader = variant.leader();
        if let Some((.., plan)) = self.known.iter().find(|(known, count, _)| (*known, *count) == (leader, asked)) {
            return plan.clone();
        }
        let plan = Plan::new(self.subject, leader, asked).map_err(|error| error.to_string());
        self.known.push((leader, asked, plan.clone()));
        plan
    }
}
