//! A method to compare: a rule for cones, a rule for their curvatures, a way of flattening.

use cones::{Baseline, CurvatureRule, FreeSeams, Handles, Options, Placement, Preparation};

/// A way from cones with curvatures to the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flattening {
    /// Newton's method, as in `cones unwrap`.
    Exact,
    /// As others do it, along the same cut.
    By(Baseline),
}

/// A method to compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Variant {
    pub(crate) placement: Placement,
    /// Whether the curvature is diffused before extrema are looked for.
    pub(crate) smooth: bool,
    pub(crate) rule: CurvatureRule,
    pub(crate) flattening: Flattening,
}

impl Variant {
    /// The paper.
    pub(crate) const PAPER: Self = Self {
        placement: Placement::Alternating,
        smooth: false,
        rule: CurvatureRule::Harmonic,
        flattening: Flattening::Exact,
    };
    /// The paper with the metric scaling of its time.
    pub(super) const PAPER_LINEAR: Self = Self { flattening: Flattening::By(Baseline::LinearScaling), ..Self::PAPER };
    /// The method that the paper compares with.
    pub(crate) const PUBLISHED: Self = Self { placement: Placement::Refactoring, ..Self::PAPER };
    /// The same with one factorization.
    pub(crate) const REUSING: Self = Self { placement: Placement::Iterative, ..Self::PAPER };
    /// Ours.
    pub(crate) const REFINED: Self =
        Self { placement: Placement::Refined, rule: CurvatureRule::Optimal, ..Self::PAPER };
    /// No metric scaling, on the cut of ours.
    pub(crate) const LSCM: Self = Self { flattening: Flattening::By(Baseline::LeastSquares), ..Self::REFINED };

    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        match text {
            "linear" => return Ok(Self::PAPER_LINEAR),
            "lscm" => return Ok(Self::LSCM),
            _ => {}
        }
        let mut words = text.split('+');
        let name = words.next().unwrap_or_default();
        let Some(placement) = Placement::ALL.into_iter().find(|placement| placement.name() == name) else {
            return Err(format!("known are {}, linear and lscm", Placement::ALL.map(Placement::name).join(", ")));
        };
        let mut variant = Self { placement, ..Self::REFINED };
        for word in words {
            match word {
                "smooth" if placement.reads_extrema() => variant.smooth = true,
                "smooth" => {
                    return Err(format!(
                        "{name} looks for no extrema: leave \"+smooth\" to alternating and persistence"
                    ));
                }
                "harmonic" => variant.rule = CurvatureRule::Harmonic,
                "optimal" => variant.rule = CurvatureRule::Optimal,
                "newton" => variant.flattening = Flattening::Exact,
                "linear" => variant.flattening = Flattening::By(Baseline::LinearScaling),
                "lscm" => variant.flattening = Flattening::By(Baseline::LeastSquares),
                _ => return Err(format!("{word:?} is none of smooth, harmonic, optimal, newton, linear, lscm")),
            }
        }
        Ok(variant)
    }

    /// Its name, which [`parse`](Self::parse) takes. Optimal curvatures and Newton's method go without saying.
    pub(crate) fn name(self) -> String {
        let placement = self.placement.name();
        let smooth = if self.smooth { "+smooth" } else { "" };
        let rule = if self.rule == CurvatureRule::Harmonic { "+harmonic" } else { "" };
        let flattening = match self.flattening {
            Flattening::Exact => "",
            Flattening::By(Baseline::LinearScaling) => "+linear",
            Flattening::By(_) => "+lscm",
        };
        format!("{placement}{smooth}{rule}{flattening}")
    }

    pub(crate) fn help() -> String {
        "Which methods, each RULE[+smooth][+ANGLES][+FLATTENING]:\n\n\
         RULE        alternating (the paper), persistence, greedy, refined,\n\
         \x20           pursuit, iterative [BCGB08] with one factorization, or\n\
         \x20           refactoring: as published, a factorization a level\n\
         smooth      for alternating and persistence: diffuse the curvature\n\
         \x20           before extrema are looked for\n\
         ANGLES      optimal curvatures, or harmonic ones, as in the paper\n\
         FLATTENING  newton, which leaves no curvature; linear, one solve as\n\
         \x20           in the paper; or lscm, no metric scaling\n\n\
         linear alone is alternating+harmonic+linear, lscm refined+lscm\n\n\
         [default: alternating+harmonic, refactoring+harmonic, persistence,\n\
         refined, linear, lscm]"
            .to_owned()
    }

    /// This method with the curvature diffused first, where it looks for extrema.
    pub(super) fn smoothed(self) -> Self {
        Self { smooth: self.placement.reads_extrema(), ..self }
    }

    /// The method of `cones unwrap` that has the same cones: flattened exactly, and with one factorization.
    pub(super) fn leader(self) -> Self {
        Self { placement: self.one_factorization(), flattening: Flattening::Exact, ..self }
    }

    /// The library's options for it, but for the number of cones.
    pub(crate) fn options(self) -> Options {
        // All methods on the same surface.
        let preparation = Preparation { smooth: self.smooth, handles: Handles::Never, ..Preparation::default() };
        // What is compared is cone metrics.
        let free_seams = FreeSeams::Never;
        Options { placement: self.placement, rule: self.rule, preparation, free_seams, ..Options::default() }
    }

    /// The method that finds the same cones with one factorization.
    fn one_factorization(self) -> Placement {
        if self.placement == Placement::Refactoring { Placement::Iterative } else { self.placement }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parsed_to_what_they_name() {
        for (name, placement) in Placement::ALL.map(|placement| (placement.name(), placement)) {
            for angles in ["", "+harmonic"] {
                for flattening in ["", "+linear", "+lscm"] {
                    let plain = format!("{name}{angles}{flattening}");
                    let variant = Variant::parse(&plain).unwrap();
                    assert_eq!(variant.name(), plain);
                    let smooth = Variant::parse(&format!("{name}+smooth{angles}{flattening}"));
                    if placement.reads_extrema() {
                        assert_eq!(smooth, Ok(variant.smoothed()));
                        assert_eq!(Variant::parse(&variant.smoothed().name()), smooth);
                    } else {
                        assert!(smooth.is_err());
                        assert_eq!(variant.smoothed(), variant);
                    }
                }
            }
        }
        assert_eq!(Variant::parse("alternating+harmonic"), Ok(Variant::PAPER));
        assert_eq!(Variant::parse("refined"), Ok(Variant::REFINED));
        assert!(Variant::parse("refined+best").is_err());
        assert!(Variant::parse("").is_err());
    }
}
