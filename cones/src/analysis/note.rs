//! What a user should know of what was decided on the way.

use std::fmt;

use crate::cut::Symmetry;
use geom::counted;

/// Something that was decided or could not be had; its `Display` is one sentence without an end. Components are counted from
/// 0 in the order of their first faces, vertices are those of the model.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// A component's edges were lengthened by up to 1e-4 of their mean, because of needle triangles.
    Mollified {
        /// The component.
        component: usize,
    },
    /// The curvature could not be diffused and is taken as it is.
    NotSmoothed {
        /// The component.
        component: usize,
    },
    /// Fewer cones were asked for than the components need.
    FewerThanNeeded {
        /// How many were asked for.
        asked: usize,
        /// How many are needed, and taken.
        needed: usize,
        /// By how many components.
        components: usize,
    },
    /// Fewer extrema are persistent enough than the components need cones.
    FewExtrema {
        /// The threshold.
        threshold: f64,
        /// How many extrema are above it.
        above: usize,
        /// How many cones are taken.
        taken: usize,
        /// On how many components.
        components: usize,
    },
    /// More cones than are optimised: they are placed by persistence.
    PlacedByPersistence {
        /// The component.
        component: usize,
        /// How many cones it gets.
        cones: usize,
    },
    /// So many cones cannot take a component's curvature: more are taken.
    MoreForCurvature {
        /// The component.
        component: usize,
        /// How many were asked for.
        asked: usize,
        /// How many are taken.
        taken: usize,
    },
    /// A component has fewer vertices that can be cones.
    FewVertices {
        /// The component.
        component: usize,
        /// How many cones were asked for.
        asked: usize,
        /// How many there are.
        there: usize,
    },
    /// Harmonic curvatures are out of bounds: optimal ones are taken.
    HarmonicOutOfBounds {
        /// The component.
        component: usize,
        /// At how many cones they are.
        count: usize,
        /// Of how many.
        cones: usize,
        /// The first such cone.
        first: u32,
    },
    /// Another number of cones than the one chosen gave a better map.
    OtherNumber {
        /// The component.
        component: usize,
        /// How many were chosen.
        chosen: usize,
        /// How many are taken.
        taken: usize,
        /// Why the chosen ones did not do.
        cause: Failure,
    },
    /// Triangles that stay folded over became islands of their own.
    Detached {
        /// The component.
        component: usize,
        /// How many triangles.
        triangles: usize,
        /// A vertex there.
        first: u32,
    },
    /// Polygons that would lie over themselves in the map became islands of their own, as flat as they are.
    PolygonsDetached {
        /// The component.
        component: usize,
        /// How many polygons.
        polygons: usize,
        /// A vertex of one.
        first: u32,
    },
    /// No cones could flatten a component: it is unfolded with a cone at every vertex, cut to shreds.
    Unfolded {
        /// The component.
        component: usize,
        /// What failed last.
        cause: Failure,
    },
    /// Surfaces were refined for their needles, but no cones flattened this one so: they are taken as they are.
    NotRefined {
        /// The component.
        component: usize,
    },
    /// The area distortion that was asked for was not reached.
    TargetMissed {
        /// The component.
        component: usize,
        /// What was asked for.
        target: f64,
        /// What was reached.
        reached: f64,
        /// With how many cones.
        cones: usize,
    },
    /// A component's layout lies over itself.
    Overlap {
        /// The component.
        component: usize,
        /// How many pairs of triangles lie over each other.
        pairs: usize,
        /// How much of its area they have in common, at most 1.
        share: f64,
    },
    /// Edges that were to be avoided are cut, since there is hardly another way.
    AvoidedCut {
        /// The component.
        component: usize,
        /// How many edges.
        edges: usize,
        /// The vertices of one of them.
        first: [u32; 2],
    },
    /// Rounded for a texture, fewer cones than were placed distort less: the others are left out.
    RoundedAway {
        /// The component.
        component: usize,
        /// How many cones were placed.
        placed: usize,
        /// How many are left.
        left: usize,
    },
    /// A texture does not keep its directions across all seams, though curvatures were rounded for it.
    SeamsDoNotTile {
        /// What the texture is like.
        symmetry: Symmetry,
        /// How many seams there are, pieces without branches.
        seams: usize,
        /// Across how many of them it does not.
        broken: usize,
        /// Whether cones turn by other angles, as given curvatures are not rounded.
        are_given: bool,
    },
    /// A surface that was refined before they were named has not all edges that were to be kept as seams.
    SeamsNotKept {
        /// How many edges it lacks.
        lost: usize,
        /// How many there are of the input.
        of: usize,
    },
    /// Edges that were to be cut are on the boundary: the surface is open there already.
    SeamsOpen {
        /// How many.
        edges: usize,
        /// Of how many that were given.
        of: usize,
    },
    /// Seams run to small holes that could be filled for computing.
    SmallHoles {
        /// To how many.
        holes: usize,
    },
    /// No cones flattened a surface with its small holes filled: they are not.
    NotFilled {
        /// How many would have been.
        holes: usize,
    },
    /// Edges that were to be cut and avoided are cut.
    AvoidedGiven {
        /// How many.
        edges: usize,
    },
    /// A surface is refined otherwise than for the map that cones are given of, so that their vertices are not there: they were chosen anew as for that map.
    RefinedOtherwise {
        /// How many were given.
        cones: usize,
        /// How many were chosen.
        taken: usize,
    },
    /// There are too many islands for the margin that was asked for.
    NarrowMargin {
        /// How many texels were asked for.
        asked: f64,
        /// How many texels islands are apart at least.
        kept: f64,
    },
    /// The cones that were to be flattened, given ones for example, make a bad map.
    Distorted {
        /// The component.
        component: usize,
        /// The area distortion D.
        area: f64,
        /// The quasi-conformal distortion.
        angles: f64,
        /// By this factor lengths change most against the mean, the logarithm to base e.
        log: f64,
    },
}

/// Margins are computed to this share.
const ROUNDED: f64 = 1e-6;

impl Note {
    /// That islands are nearer to each other than was asked for, where they are: both in texels.
    pub fn of_margin(asked: f64, kept: f64) -> Option<Self> {
        (kept < asked * (1.0 - ROUNDED)).then_some(Self::NarrowMargin { asked, kept })
    }

    /// The component that it is about, unless it is about all of them.
    pub fn component(&self) -> Option<usize> {
        self.clone().component_mut().copied()
    }

    /// Whether it is of the cones that were chosen, whatever map is made with them.
    pub(crate) fn is_of_cones(&self) -> bool {
        matches!(
            self,
            Self::FewerThanNeeded { .. }
                | Self::FewExtrema { .. }
                | Self::PlacedByPersistence { .. }
                | Self::MoreForCurvature { .. }
                | Self::FewVertices { .. }
                | Self::HarmonicOutOfBounds { .. }
                | Self::OtherNumber { .. }
                | Self::RoundedAway { .. }
                | Self::TargetMissed { .. }
        )
    }

    fn component_mut(&mut self) -> Option<&mut usize> {
        match self {
            Self::FewerThanNeeded { .. }
            | Self::FewExtrema { .. }
            | Self::SeamsDoNotTile { .. }
            | Self::SeamsOpen { .. }
            | Self::AvoidedGiven { .. }
            | Self::SmallHoles { .. }
            | Self::NotFilled { .. }
            | Self::NarrowMargin { .. }
            | Self::SeamsNotKept { .. }
            | Self::RefinedOtherwise { .. } => None,
            Self::Mollified { component }
            | Self::NotSmoothed { component }
            | Self::PlacedByPersistence { component, .. }
            | Self::MoreForCurvature { component, .. }
            | Self::FewVertices { component, .. }
            | Self::HarmonicOutOfBounds { component, .. }
            | Self::OtherNumber { component, .. }
            | Self::Detached { component, .. }
            | Self::PolygonsDetached { component, .. }
            | Self::Unfolded { component, .. }
            | Self::NotRefined { component }
            | Self::Distorted { component, .. }
            | Self::AvoidedCut { component, .. }
            | Self::RoundedAway { component, .. }
            | Self::TargetMissed { component, .. }
            | Self::Overlap { component, .. } => Some(component),
        }
    }

    /// Whether no metric was found for the cones that were chosen on a component.
    pub fn lacks_metric(&self) -> bool {
        matches!(self, Self::OtherNumber { cause: Failure::Metric, .. } | Self::Unfolded { cause: Failure::Metric, .. })
    }

    /// The same of another component, given its vertex for each one of this component.
    pub(crate) fn said_of(mut self, other: usize, vertex: impl Fn(u32) -> u32) -> Self {
        if let Some(component) = self.component_mut() {
            *component = other;
        }
        match &mut self {
            Self::HarmonicOutOfBounds { first, .. }
            | Self::Detached { first, .. }
            | Self::PolygonsDetached { first, .. } => *first = vertex(*first),
            Self::AvoidedCut { first, .. } => *first = first.map(vertex),
            _ => {}
        }
        self
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let needing = |components: &usize| match components {
            1 => "this surface needs".to_owned(),
            _ => format!("these {components} parts need"),
        };
        let cones = |count: &usize| counted(*count, "cone", "cones");
        match self {
            Self::Mollified { .. } => {
                write!(f, "edges were lengthened by up to 1e-4 of their mean, because of needle triangles")
            }
            Self::NotSmoothed { .. } => write!(f, "the curvature could not be diffused: taking it as it is"),
            Self::FewerThanNeeded { asked, needed, components } => {
                write!(f, "{} asked for, but {} at least {needed}: taking {needed}", cones(asked), needing(components))
            }
            Self::FewExtrema { threshold, above, taken, components } => write!(
                f,
                "{} more persistent than {threshold}, but {} more cones: taking {taken}",
                if *above == 1 { "1 extremum is".to_owned() } else { format!("{above} extrema are") },
                needing(components)
            ),
            Self::PlacedByPersistence { cones, .. } => {
                write!(f, "{cones} cones are too many to be optimised: they are placed by persistence")
            }
            Self::MoreForCurvature { asked, taken, .. } => {
                write!(f, "{} cannot take this surface's curvature: taking {taken}", cones(asked))
            }
            Self::FewVertices { asked, there, .. } => {
                let inner =
                    if *there == 1 { "is only 1 inner vertex" } else { &format!("are only {there} inner vertices") };
                write!(f, "{} asked for, but there {inner}", cones(asked))
            }
            Self::HarmonicOutOfBounds { count, cones: of, first, .. } => write!(
                f,
                "harmonic curvature is out of bounds at {count} of {} (first at vertex {first}): taking optimal \
                 curvatures within bounds",
                cones(of)
            ),
            Self::OtherNumber { chosen, taken, cause, .. } => {
                write!(f, "{} could not be flattened well ({cause}): taking {taken}", cones(chosen))
            }
            Self::Detached { triangles: 1, first, .. } => {
                write!(f, "1 triangle folds over, near vertex {first}: it is an island of its own")
            }
            Self::Detached { triangles, first, .. } => {
                write!(
                    f,
                    "{triangles} triangles fold over, the first near vertex {first}: they are islands of their own"
                )
            }
            Self::PolygonsDetached { polygons: 1, first, .. } => {
                write!(f, "1 polygon would lie over itself in the map, at vertex {first}: it is an island of its own")
            }
            Self::PolygonsDetached { polygons, first, .. } => {
                write!(
                    f,
                    "{polygons} polygons would lie over themselves in the map, the first at vertex {first}: they are \
                     islands of their own"
                )
            }
            Self::Unfolded { cause, .. } => {
                write!(f, "no cones could flatten this surface ({cause}): unfolding it with a cone at every vertex")
            }
            Self::NotRefined { .. } => {
                write!(f, "no cones could flatten this surface in even triangles: taking all in their own, unrefined")
            }
            Self::AvoidedCut { edges: 1, first: [a, b], .. } => {
                write!(
                    f,
                    "a seam runs along an edge that was to be avoided, from vertex {a} to {b}: there is hardly another way"
                )
            }
            Self::AvoidedCut { edges, first: [a, b], .. } => write!(
                f,
                "seams run along {edges} edges that were to be avoided, one from vertex {a} to {b}: there is hardly another way"
            ),
            Self::RoundedAway { placed, left, .. } => {
                write!(
                    f,
                    "rounded so that a texture keeps its directions across seams, the curvatures of {} distort less than those of all \
                     {placed}: taking {left}",
                    cones(left)
                )
            }
            Self::SeamsDoNotTile { symmetry, seams, broken, are_given } => write!(
                f,
                "a texture that looks the same after 1/{} of a turn does not keep its directions across {broken} of {}: {}",
                symmetry.order(),
                counted(*seams, "seam", "seams"),
                if *are_given {
                    "given curvatures are not rounded"
                } else {
                    "no cone sets how handles and boundaries turn"
                }
            ),
            Self::SeamsNotKept { lost, of } => write!(
                f,
                "{lost} of {} of the input's seams {} of the map: even triangles have other edges, leave them as they are to keep these",
                counted(*of, "edge", "edges"),
                if *lost == 1 { "is no seam" } else { "are no seams" }
            ),
            Self::SeamsOpen { of: 1, .. } => {
                write!(f, "the edge that was to be cut is on the boundary, where the surface is open already")
            }
            Self::SeamsOpen { edges: 1, of } => {
                write!(f, "1 of {of} edges that were to be cut is on the boundary, where the surface is open already")
            }
            Self::SeamsOpen { edges, of } => {
                write!(
                    f,
                    "{edges} of {of} edges that were to be cut are on the boundary, where the surface is open already"
                )
            }
            Self::SmallHoles { holes: 1 } => {
                write!(f, "a seam runs to a small hole: with --fill-holes none need run there")
            }
            Self::SmallHoles { holes } => {
                write!(f, "seams run to {holes} small holes: with --fill-holes none need run there")
            }
            Self::NotFilled { holes } => write!(
                f,
                "no cones could flatten the surface with {} filled: taking it as it is",
                counted(*holes, "small hole", "small holes")
            ),
            Self::AvoidedGiven { edges: 1 } => {
                write!(f, "an edge that was to be avoided was to be cut, too: it is cut")
            }
            Self::AvoidedGiven { edges } => {
                write!(f, "{edges} edges that were to be avoided were to be cut, too: they are cut")
            }
            Self::RefinedOtherwise { cones: count, taken } => write!(
                f,
                "with these options the surface is refined otherwise than for the {} given, and has not their vertices: {taken} are \
                 chosen anew, as those were",
                cones(count)
            ),
            Self::NarrowMargin { asked, kept } => {
                write!(
                    f,
                    "a margin of {asked} texel{} was asked for, but islands are {kept:.2} texels apart: there are too many",
                    if *asked == 1.0 { "" } else { "s" }
                )
            }
            Self::TargetMissed { target, reached, cones: count, .. } => {
                write!(f, "an area distortion of {target} was not reached: {reached:.3} with {}", cones(count))
            }
            Self::Overlap { pairs: 1, .. } => write!(f, "two triangles of the layout lie over each other"),
            Self::Overlap { pairs, share, .. } => {
                write!(f, "{:.2} % of the layout lies over itself: {pairs} pairs of triangles", 100.0 * share)
            }
            Self::Distorted { area, angles, log, .. } => write!(
                f,
                "these cones make a bad map: area distortion {}, quasi-conformal {}, lengths changed up to {} times",
                short(*area),
                short(*angles),
                short(log.exp())
            ),
        }
    }
}

/// A factor with three digits, or its power of ten where it is large.
fn short(factor: f64) -> String {
    if factor < 1e4 { format!("{factor:.2}") } else { format!("{factor:.0e}") }
}

/// Why an attempt to flatten a component failed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Failure {
    /// The cones cannot take the curvature.
    Curvature,
    /// The surface could not be cut open through them.
    Cut,
    /// No metric was found.
    Metric,
    /// Triangles stay folded over.
    FoldOvers {
        /// How many.
        triangles: usize,
    },
    /// The map distorts far more than was predicted.
    Distorted {
        /// Its area distortion.
        area: f64,
        /// Its mean quasi-conformal distortion.
        angles: f64,
    },
    /// Lengths would change too much.
    Stretched {
        /// By this factor, the logarithm to base e.
        log: f64,
    },
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Curvature => write!(f, "they cannot take its curvature"),
            Self::Cut => write!(f, "they do not cut it open"),
            Self::Metric => write!(f, "no flat metric was found"),
            Self::FoldOvers { triangles: 1 } => write!(f, "1 triangle folds over"),
            Self::FoldOvers { triangles } => write!(f, "{triangles} triangles fold over"),
            Self::Distorted { area, angles } => {
                write!(f, "areas are distorted by {area:.2} and angles by {angles:.2}, far more than predicted")
            }
            Self::Stretched { .. } => write!(f, "lengths would change a thousandfold"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_said_of_another_component_names_its_vertices() {
        let first = Note::Detached { component: 2, triangles: 1, first: 30 };
        assert_eq!(first.said_of(5, |v| v + 100), Note::Detached { component: 5, triangles: 1, first: 130 });
        let of_all = Note::FewerThanNeeded { asked: 1, needed: 2, components: 3 };
        assert_eq!(of_all.clone().said_of(5, |v| v + 100), of_all);
    }

    #[test]
    fn notes_are_sentences_for_one_and_for_many() {
        let said = |note: Note| note.to_string();
        let rounded = |left| said(Note::RoundedAway { component: 0, placed: 38, left });
        assert_eq!(
            rounded(29),
            "rounded so that a texture keeps its directions across seams, the curvatures of 29 cones distort less than those of all 38: \
             taking 29"
        );
        assert!(rounded(1).contains("the curvatures of 1 cone distort"));
        let few = |there| said(Note::FewVertices { component: 0, asked: 8, there });
        assert_eq!(few(1), "8 cones asked for, but there is only 1 inner vertex");
        let open = |edges, of| said(Note::SeamsOpen { edges, of });
        assert_eq!(open(1, 1), "the edge that was to be cut is on the boundary, where the surface is open already");
        assert!(open(1, 2).starts_with("1 of 2 edges that were to be cut is on"), "{}", open(1, 2));
        let holes = |holes| said(Note::SmallHoles { holes });
        assert!(
            holes(1).starts_with("a seam runs to a small hole:") && holes(5).starts_with("seams run to 5 small holes:")
        );
        let margin = |asked| said(Note::NarrowMargin { asked, kept: 0.5 });
        assert!(
            margin(1.0).starts_with("a margin of 1 texel was") && margin(2.0).starts_with("a margin of 2 texels was")
        );
        let kept = |lost, of| said(Note::SeamsNotKept { lost, of });
        assert!(kept(1, 1).starts_with("1 of 1 edge of the input's seams is no seam of the map:"), "{}", kept(1, 1));
        assert!(kept(1, 9).starts_with("1 of 9 edges of the input's seams is no seam of the map:"), "{}", kept(1, 9));
        assert!(kept(3, 9).starts_with("3 of 9 edges of the input's seams are no seams of the map:"), "{}", kept(3, 9));
        let harmonic = Note::HarmonicOutOfBounds { component: 0, count: 1, cones: 1, first: 7 };
        assert!(said(harmonic).starts_with("harmonic curvature is out of bounds at 1 of 1 cone (first at vertex 7)"));
        assert_eq!(few(3), "8 cones asked for, but there are only 3 inner vertices");
        let missed = said(Note::TargetMissed { component: 0, target: 1.1, reached: 1.5, cones: 1 });
        assert!(missed.ends_with("1.500 with 1 cone"), "{missed}");
    }
}
