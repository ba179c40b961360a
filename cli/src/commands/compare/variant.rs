//! A method to compare: a rule for cones, a rule for their curvatures, a way of flattening.

use cones::{
    Angles, ConeHierarchy, ConformalFactor, Method, Operators, Options, Reduced, greedy, iterative,
    iterative_refactoring, pursuit, refined,
};
use geom::{Mesh, PoissonError, VertexId};

/// A rule for cones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// One that the library has.
    Of(Method),
    /// The iterative method as published: a factorization for each level.
    Refactoring,
}

impl Rule {
    /// The library's method that finds the same cones.
    fn method(self) -> Method {
        match self {
            Self::Of(method) => method,
            Self::Refactoring => Method::Iterative,
        }
    }

    fn looks_for_extrema(self) -> bool {
        matches!(self, Self::Of(Method::Alternating | Method::Persistence))
    }
}

/// A way from cones with curvatures to the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Flattening {
    /// Newton's method, as in `cones unwrap`.
    Exact,
    /// Lengths scaled by one linear solve.
    Linear,
    /// No metric scaling: the least conformal energy with this cut.
    Lscm,
}

/// A method to compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Variant {
    pub(super) rule: Rule,
    /// Whether the curvature is diffused before extrema are looked for.
    pub(super) smooth: bool,
    pub(super) angles: Angles,
    pub(super) flattening: Flattening,
}

/// Optimising more cones than this takes minutes, so more are chosen by persistence, as in `cones unwrap`.
pub(super) const MOST_CONES: usize = 64;

const RULES: [(&str, Rule); 7] = [
    ("alternating", Rule::Of(Method::Alternating)),
    ("persistence", Rule::Of(Method::Persistence)),
    ("iterative", Rule::Of(Method::Iterative)),
    ("refactoring", Rule::Refactoring),
    ("greedy", Rule::Of(Method::Greedy)),
    ("refined", Rule::Of(Method::Refined)),
    ("pursuit", Rule::Of(Method::Pursuit)),
];

impl Variant {
    /// The paper.
    pub(super) const PAPER: Self = Self {
        rule: Rule::Of(Method::Alternating),
        smooth: false,
        angles: Angles::Harmonic,
        flattening: Flattening::Exact,
    };
    /// The paper with the metric scaling of its time.
    pub(super) const PAPER_LINEAR: Self = Self { flattening: Flattening::Linear, ..Self::PAPER };
    /// The method that the paper compares with.
    pub(super) const PUBLISHED: Self = Self { rule: Rule::Refactoring, ..Self::PAPER };
    /// The same with one factorization.
    pub(super) const REUSING: Self = Self { rule: Rule::Of(Method::Iterative), ..Self::PAPER };
    /// Ours.
    pub(super) const REFINED: Self = Self { rule: Rule::Of(Method::Refined), angles: Angles::Optimal, ..Self::PAPER };
    /// No metric scaling, on the cut of ours.
    const LSCM: Self = Self { flattening: Flattening::Lscm, ..Self::REFINED };

    pub(super) fn parse(text: &str) -> Result<Self, String> {
        match text {
            "linear" => return Ok(Self::PAPER_LINEAR),
            "lscm" => return Ok(Self::LSCM),
            _ => {}
        }
        let mut words = text.split('+');
        let name = words.next().unwrap_or_default();
        let Some(&(_, rule)) = RULES.iter().find(|(known, _)| *known == name) else {
            return Err(format!("known are {}, linear and lscm", RULES.map(|(name, _)| name).join(", ")));
        };
        let mut variant = Self { rule, ..Self::REFINED };
        for word in words {
            match word {
                "smooth" if rule.looks_for_extrema() => variant.smooth = true,
                "smooth" => {
                    return Err(format!(
                        "{name} looks for no extrema: leave \"+smooth\" to alternating and persistence"
                    ));
                }
                "harmonic" => variant.angles = Angles::Harmonic,
                "optimal" => variant.angles = Angles::Optimal,
                "newton" => variant.flattening = Flattening::Exact,
                "linear" => variant.flattening = Flattening::Linear,
                "lscm" => variant.flattening = Flattening::Lscm,
                _ => return Err(format!("{word:?} is none of smooth, harmonic, optimal, newton, linear, lscm")),
            }
        }
        Ok(variant)
    }

    /// Its name, which [`parse`](Self::parse) takes. Optimal curvatures and Newton's method go without saying.
    pub(super) fn name(self) -> String {
        let rule = RULES.iter().find(|(_, rule)| *rule == self.rule).map_or("", |(name, _)| name);
        let smooth = if self.smooth { "+smooth" } else { "" };
        let angles = if self.angles == Angles::Harmonic { "+harmonic" } else { "" };
        let flattening = match self.flattening {
            Flattening::Exact => "",
            Flattening::Linear => "+linear",
            Flattening::Lscm => "+lscm",
        };
        format!("{rule}{smooth}{angles}{flattening}")
    }

    pub(super) fn help() -> String {
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
        Self { smooth: self.rule.looks_for_extrema(), ..self }
    }

    /// The method of `cones unwrap` that has the same cones: flattened exactly, and with one factorization.
    pub(super) fn leader(self) -> Self {
        Self { rule: Rule::Of(self.rule.method()), flattening: Flattening::Exact, ..self }
    }

    /// The library's options for it, but for the number of cones.
    pub(super) fn options(self) -> Options {
        Options { method: self.rule.method(), angles: self.angles, smooth: self.smooth, ..Options::default() }
    }

    /// The cones of a surface.
    pub(super) fn cones(self, operators: &Operators, mesh: &Mesh, count: usize) -> Result<Vec<VertexId>, PoissonError> {
        Ok(match self.rule {
            Rule::Refactoring => iterative_refactoring(operators, count)?,
            Rule::Of(Method::Iterative) => iterative(operators, count),
            Rule::Of(Method::Greedy) => greedy(operators, count),
            Rule::Of(Method::Refined | Method::Pursuit) if count > MOST_CONES => {
                self.extrema(operators, mesh, Method::Persistence, count)
            }
            Rule::Of(Method::Refined) => refined(&mut Reduced::new(operators, mesh), count).cones,
            Rule::Of(Method::Pursuit) => pursuit(&mut Reduced::new(operators, mesh), count).cones().to_vec(),
            Rule::Of(method @ (Method::Alternating | Method::Persistence)) => {
                self.extrema(operators, mesh, method, count)
            }
        })
    }

    /// The first extrema of the conformal factor.
    fn extrema(self, operators: &Operators, mesh: &Mesh, method: Method, count: usize) -> Vec<VertexId> {
        let smoothed = self.smooth.then(|| ConformalFactor::smoothed(operators));
        // What cannot be diffused is taken as it is, as in `cones unwrap`, which says so.
        let factor = smoothed.and_then(Result::ok).unwrap_or_else(|| ConformalFactor::new(operators));
        let hierarchy = ConeHierarchy::new(operators, &factor);
        hierarchy.cones(operators, mesh, method, count).iter().map(|cone| cone.vertex).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parsed_to_what_they_name() {
        for (name, rule) in RULES {
            for angles in ["", "+harmonic"] {
                for flattening in ["", "+linear", "+lscm"] {
                    let plain = format!("{name}{angles}{flattening}");
                    let variant = Variant::parse(&plain).unwrap();
                    assert_eq!(variant.name(), plain);
                    let smooth = Variant::parse(&format!("{name}+smooth{angles}{flattening}"));
                    if rule.looks_for_extrema() {
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
