//! What a user may say about seams.

use std::f64::consts::PI;

/// The weight that nobody has to ask for; see [`SeamOptions::weight`].
pub(crate) const DEFAULT_WEIGHT: f64 = 0.5;

/// Where seams should run. Edges are named by two vertices of the model, in either order.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct SeamOptions {
    /// How much seams may lengthen to run straight, along sharp edges and in hidden places: from 0, as short as they can be, to 1 (what is
    /// beyond counts as the nearer of the two, NaN as 0).
    pub weight: f64,
    /// Edges that are cut; of those on the boundary a note says how many there are. Others are cut besides, until each island is a disk with all cones on its boundary.
    /// [`Analysis::atlas`](crate::Analysis::atlas) opens surfaces along them first and flattens what that leaves by itself, unless the two sides are to be congruent
    /// ([`FreeSeams::Never`](crate::FreeSeams::Never), [`Options::quantize`](crate::Options::quantize)) or cones are given, or their numbers for each part. Then, as in
    /// [`Analysis::flatten_with`](crate::Analysis::flatten_with), a cut that ends
    /// away from cones and from other seams lies closed in the plane: there is no curvature to open it.
    pub given: Vec<[u32; 2]>,
    /// Edges that are cut as well, such as the [seams that a file has](geom::texture_seams), but passed over where they are none of
    /// the surface's or it is open there.
    pub kept: Vec<[u32; 2]>,
    /// Edges that are cut only where there is hardly another way; those that are given, too, are cut. Cones are placed at vertices that other edges lead to.
    pub avoid: Vec<[u32; 2]>,
}

impl Default for SeamOptions {
    fn default() -> Self {
        Self { weight: DEFAULT_WEIGHT, given: Vec::new(), kept: Vec::new(), avoid: Vec::new() }
    }
}

impl SeamOptions {
    /// Whether it says something of some edges.
    pub(crate) fn names_edges(&self) -> bool {
        self.named().next().is_some()
    }

    /// The edges that it says something of.
    pub(crate) fn named(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.given.iter().chain(&self.kept).chain(&self.avoid).copied()
    }

    /// The same of the parts that each edge is in now.
    pub(crate) fn in_parts<'a>(&'a self, parts: impl Fn(&'a [u32; 2]) -> &'a [[u32; 2]]) -> Self {
        let of = |edges: &'a [[u32; 2]]| edges.iter().flat_map(&parts).copied().collect();
        Self { weight: self.weight, given: of(&self.given), kept: of(&self.kept), avoid: of(&self.avoid) }
    }
}

/// The rotations that a texture of hatches or bricks, which is to cross seams, looks the same after.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Symmetry {
    /// By a quarter of a turn: squares.
    Fourfold,
    /// By a sixth of a turn: triangles and hexagons.
    Sixfold,
}

impl Symmetry {
    /// How often it is in a turn.
    pub fn order(self) -> u32 {
        match self {
            Self::Fourfold => 4,
            Self::Sixfold => 6,
        }
    }

    /// The least rotation, in radians: what cones' curvatures are multiples of.
    pub fn angle(self) -> f64 {
        2.0 * PI / f64::from(self.order())
    }
}
