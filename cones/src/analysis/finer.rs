//! Refined models in smaller triangles, where the first ones are too coarse for their cones.
//!
//! A map is linear on each triangle, which bends angles where the log scale factor changes much across one: round cones above all. How large
//! triangles may be is known once there is a map. Those that are small from the start would cost polyhedra their exact nets, since few cones
//! bend angles little then, too; a net bends none, and stays.

use super::Analysis;
use super::atlas::Atlas;
use super::options::Options;
use crate::error::Error;

/// A map that bends angles by more than this on average is made once more: the mean of σ₁/σ₂,
const BENT: f64 = 1.06;
/// where the refined model has no more vertices than this. `cheese`, which has more, takes 256 cones so instead of 512, and is bent by 1.093 for 1.071.
const MOST_VERTICES: usize = 50_000;

impl Analysis {
    /// The analysis and its map, or those of the same model in smaller triangles where it was refined, these were too coarse, and that gives a better
    /// map.
    pub(super) fn or_finer(
        self,
        atlas: Atlas,
        options: &Options,
        finer: impl FnOnce() -> Result<Self, Error>,
    ) -> Result<(Self, Atlas), Error> {
        let is_small = self.refined().is_some_and(|r| r.is_complete && r.model.vertex_count() <= MOST_VERTICES);
        let coarse = if is_small { self.distortion(&atlas) } else { None };
        let Some(coarse) = coarse.filter(|coarse| coarse.angles > BENT) else { return Ok((self, atlas)) };
        let (mut taken, left) = match finer().and_then(|finer| Ok((finer.atlas(options)?, finer))) {
            Ok((other, finer)) if finer.distortion(&other).is_some_and(|other| other.cost() < coarse.cost()) => {
                ((finer, other), (self, atlas))
            }
            Ok((other, finer)) => ((self, atlas), (finer, other)),
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            Err(_) => return Ok((self, atlas)),
        };
        taken.1.times += left.0.times();
        taken.1.times += left.1.times;
        Ok(taken)
    }

    /// What a map does to the surfaces, on average.
    fn distortion(&self, atlas: &Atlas) -> Option<Distortion> {
        let on_surface = atlas.triangles.corners.iter().zip(&atlas.islands).filter(|(_, island)| island.is_some());
        let corners = || on_surface.clone().map(|(corners, _)| corners);
        let vertices: Vec<[u32; 3]> = corners().map(|t| t.map(|c| self.corner_vertices()[c as usize])).collect();
        let uv: Vec<[[f64; 2]; 3]> = corners().map(|t| t.map(|c| atlas.uv[c as usize])).collect();
        let measured = geom::distortion::measure(self.points(), &vertices, &uv).ok()?;
        Some(Distortion { areas: measured.area.mean, angles: measured.quasi_conformal.mean })
    }
}

/// The area distortion D and the mean of σ₁/σ₂.
struct Distortion {
    areas: f64,
    angles: f64,
}

impl Distortion {
    /// What maps are compared by: the logarithms of both.
    fn cost(&self) -> f64 {
        self.areas.ln() + self.angles.ln()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::observer::Silent;
    use crate::{ConeChoice, FreeSeams, Preparation, Refining};
    use geom::{Model, shapes};

    fn refined(model: &Model, cones: ConeChoice) -> [(Analysis, Atlas); 2] {
        let preparation = Preparation { refine: Refining::Always, ..Preparation::default() };
        let options = Options { preparation, cones, free_seams: FreeSeams::Never, ..Options::default() };
        let first = Analysis::with(model, preparation).unwrap();
        let atlas = first.atlas(&options).unwrap();
        [(first, atlas), Analysis::unwrapped(model, &options, Silent).unwrap()]
    }

    #[test]
    fn what_bends_angles_is_made_again_in_smaller_triangles() {
        let [(first, atlas), (finer, other)] = refined(&shapes::sphere(40).into(), ConeChoice::Count(2));
        let [before, after] = [first.distortion(&atlas), finer.distortion(&other)].map(Option::unwrap);
        assert!(
            before.angles > BENT && after.angles - 1.0 < 0.7 * (before.angles - 1.0),
            "{} {}",
            before.angles,
            after.angles
        );
        assert!(finer.refined().unwrap().model.vertex_count() > 2 * first.refined().unwrap().model.vertex_count());
        assert!(other.times.total() > atlas.times.total());
    }

    #[test]
    fn what_bends_no_angles_stays_as_it_is() {
        let [(first, atlas), (same, again)] = refined(&shapes::cylinder(64).into(), ConeChoice::Automatic);
        assert_eq!(first.refined().unwrap().model.vertex_count(), same.refined().unwrap().model.vertex_count());
        assert_eq!(atlas.uv, again.uv);
    }
}
