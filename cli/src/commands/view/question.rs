//! What the page asks for, as JSON.

use crate::input::cone_file;
use cones::{ConeChoice, CurvatureRule, Options, Placement, SeamOptions};
use serde::Deserialize;

/// A question about cones or their map.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct Question {
    /// Who asks, and the how-manieth time: a newer question stops those before.
    pub(super) tab: String,
    pub(super) serial: u64,
    /// So many cones, or as many as the surface asks for.
    n: Option<usize>,
    /// Or these vertices, each with its curvature in radians or none of them with one.
    given: Option<Vec<(u32, Option<f64>)>>,
    /// Or what a file of cones says.
    recipe: Option<String>,
    /// Edges that are cut, and edges that are not, besides those of the command line.
    cut: Vec<[u32; 2]>,
    avoid: Vec<[u32; 2]>,
    method: Option<Placement>,
    angles: Option<CurvatureRule>,
}

/// Why a question has no answer.
pub(super) type Unclear = String;

impl Question {
    pub(super) fn parse(body: &[u8]) -> Result<Self, Unclear> {
        serde_json::from_slice(body).map_err(|error| format!("the question is unclear: {error}"))
    }

    /// What the page asks for first.
    pub(super) fn of(n: Option<usize>, method: Placement, angles: CurvatureRule) -> Self {
        Self { n, method: Some(method), angles: Some(angles), ..Self::default() }
    }

    pub(super) fn placement(&self) -> Placement {
        self.method.unwrap_or_default()
    }

    pub(super) fn rule(&self) -> CurvatureRule {
        self.angles.unwrap_or_default()
    }

    /// The library's options for at most so many cones; `base` has what the page does not choose.
    pub(super) fn options(&self, base: &Options, most: usize) -> Result<Options, Unclear> {
        let cones = match (&self.recipe, &self.given, self.n) {
            (Some(text), ..) => ConeChoice::Recipe(Box::new(cone_file::recipe(text)?)),
            (None, Some(given), _) => ConeChoice::Given(given.clone()),
            (None, None, None) => ConeChoice::Automatic,
            (None, None, Some(n)) if n <= most => ConeChoice::Count(n),
            (None, None, Some(n)) => return Err(format!("{n} cones are more than the page shows")),
        };
        // The refactoring baseline takes a factorization for each cone.
        let placement = match self.placement() {
            Placement::Refactoring => Placement::Iterative,
            placement => placement,
        };
        let seams = SeamOptions {
            given: [&base.seams.given[..], &self.cut].concat(),
            avoid: [&base.seams.avoid[..], &self.avoid].concat(),
            ..base.seams.clone()
        };
        Ok(Options { cones, placement, rule: self.rule(), seams, ..base.clone() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn questions_are_read_or_refused_with_a_reason() {
        let options = |text: &str| Question::parse(text.as_bytes())?.options(&Options::default(), 64);
        let asked = options(r#"{"tab":"a","serial":3,"n":8,"method":"pursuit","angles":"harmonic"}"#).unwrap();
        assert_eq!((asked.cones, asked.placement), (ConeChoice::Count(8), Placement::Pursuit));
        assert_eq!(options("{}").unwrap().cones, ConeChoice::Automatic);
        let given = options(r#"{"n":5,"given":[[3,null],[4,1.5]]}"#).unwrap();
        assert_eq!(given.cones, ConeChoice::Given(vec![(3, None), (4, Some(1.5))]));
        let recipe = options(r##"{"n":5,"given":[[3,1.5]],"recipe":"#: charts\n3 1.5"}"##).unwrap().cones;
        assert!(matches!(recipe, ConeChoice::Recipe(recipe) if recipe.charts && recipe.cones.len() == 1));
        let pinned = options(r#"{"n":5,"cut":[[3,4]],"avoid":[[1,2],[2,5]]}"#).unwrap().seams;
        assert_eq!((pinned.given, pinned.avoid), (vec![[3, 4]], vec![[1, 2], [2, 5]]));
        for wrong in [
            "",
            "{",
            r#"{"n":-1}"#,
            r#"{"n":1e9}"#,
            r#"{"n":65}"#,
            r#"{"x":1}"#,
            r#"{"given":[[1]]}"#,
            r#"{"recipe":"a hare"}"#,
            r#"{"cut":[[1]]}"#,
            "\u{0}",
        ] {
            assert!(options(wrong).is_err(), "{wrong}");
        }
    }
}
