//! Models refined, and refined ones in smaller triangles, where the map shows that triangles are too coarse for their cones.
//!
//! A map is linear on each triangle, which bends angles where the log scale factor changes much across one: round cones above all. How large
//! triangles may be is known once there is a map. Those that are small from the start would cost polyhedra their exact nets, since few cones
//! bend angles little then, too; a net bends none, and stays.

use std::sync::Arc;

use geom::Model;
use rayon::prelude::*;

use super::Analysis;
use super::atlas::Atlas;
use super::choosing::TARGET_DISTORTION;
use super::component::Component;
use super::note::Note;
use super::options::{ConeChoice, Options, Refining};
use super::sizing::Sizing;
use crate::error::Error;
use crate::placement::{MOST_OPTIMISED, corners};

/// A map that bends angles by more than this on average is made once more: the mean of σ₁/σ₂,
pub(super) const BENT: f64 = 1.06;
/// where what it is computed on has no more vertices than this.
pub(super) const MOST_VERTICES: usize = 50_000;

/// What an area distortion below the target counts for, as a share of what it would above.
const BELOW_TARGET: f64 = 0.25;

/// Of a model with no more vertices than this that would be refined it is looked first whether it has exact nets as it is,
const MOST_OF_NETS: usize = 5_000;
/// of so many islands for each part at most,
const MOST_ISLANDS: usize = 2;
/// whose distortions are no larger: edges that are lengthened for the sake of needles bend angles by some ten-thousandths.
const EXACT: f64 = 1.001;

impl Analysis {
    /// The analysis with its map, if that is exact: the net of polyhedra of few corners, which no refining makes better.
    pub(super) fn net_as_it_is(
        model: &Model,
        made: impl FnOnce() -> Result<Self, Error>,
        options: &Options,
    ) -> Result<Option<(Self, Atlas)>, Error> {
        if model.vertex_count() > MOST_OF_NETS {
            return Ok(None);
        }
        let has_few_corners = |analysis: &Self| {
            let few = |component: &Arc<Component>| corners(&component.operators, MOST_OPTIMISED).is_some();
            analysis.components().iter().all(few)
        };
        let net = made().and_then(|analysis| match has_few_corners(&analysis) {
            true => analysis.atlas(options).map(|atlas| Some((analysis, atlas))),
            false => Ok(None),
        });
        let is_exact = |(analysis, atlas): &(Self, Atlas)| {
            let is_whole = atlas.detached.is_empty()
                && atlas.unfolded == 0
                && !atlas.notes.iter().any(|note| matches!(note, Note::Overlap { .. }));
            is_whole
                && atlas.island_count() <= MOST_ISLANDS * analysis.components().len()
                && analysis.distortion(atlas).is_some_and(|distortion| distortion.areas.max(distortion.angles) <= EXACT)
        };
        match net {
            Err(Error::Interrupted) => Err(Error::Interrupted),
            net => Ok(net.ok().flatten().filter(is_exact)),
        }
    }

    /// The analysis and its map, or those of the same model refined, or in smaller triangles where it was, if these were too coarse and that
    /// gives a better map. `made` takes how large triangles may be where.
    pub(super) fn or_finer(
        self,
        atlas: Atlas,
        options: &Options,
        made: impl Fn(Option<Arc<Sizing>>) -> Result<Self, Error>,
    ) -> Result<(Self, Atlas), Error> {
        let mut taken = (self, atlas);
        if taken.0.refined().is_none() && options.preparation.refine == Refining::Needles {
            taken = taken.0.or_other(taken.1, options, |_, _, _| made(None).map(Some))?;
        }
        if taken.0.refined().is_some_and(|refined| refined.is_complete) {
            taken = taken.0.or_other(taken.1, options, |analysis, atlas, measured| {
                Sizing::of(analysis, atlas, measured).map(|sizing| made(Some(Arc::new(sizing)))).transpose()
            })?;
        }
        Ok(taken)
    }

    /// The analysis and its map, or another one and its if this one bends angles and that one is better.
    fn or_other(
        self,
        atlas: Atlas,
        options: &Options,
        other: impl FnOnce(&Self, &Atlas, &geom::distortion::Distortion) -> Result<Option<Self>, Error>,
    ) -> Result<(Self, Atlas), Error> {
        let vertices: usize = self.components().iter().map(|component| component.surface.mesh.vertex_count()).sum();
        let measured = if vertices <= MOST_VERTICES { self.measures(&atlas) } else { None };
        let Some(measured) = measured.filter(|measured| measured.quasi_conformal.mean > BENT) else {
            return Ok((self, atlas));
        };
        let target = match options.cones {
            ConeChoice::Automatic => TARGET_DISTORTION,
            ConeChoice::WithinDistortion(target) => target,
            _ => 1.0,
        };
        let before = Distortion::of(&measured).cost(target);
        let other = other(&self, &atlas, &measured);
        let mapped = other.and_then(|other| other.map(|other| Ok((other.atlas(options)?, other))).transpose());
        let (mut taken, left) = match mapped {
            Ok(None) => return Ok((self, atlas)),
            Ok(Some((map, other))) if other.distortion(&map).is_some_and(|after| after.cost(target) < before) => {
                ((other, map), (self, atlas))
            }
            Ok(Some((map, other))) => ((self, atlas), (other, map)),
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            Err(_) => return Ok((self, atlas)),
        };
        taken.1.times += left.0.times();
        taken.1.times += left.1.times;
        Ok(taken)
    }

    /// What a map does to the surfaces, on average.
    fn distortion(&self, atlas: &Atlas) -> Option<Distortion> {
        self.measures(atlas).as_ref().map(Distortion::of)
    }

    /// What a map does to each component, on average.
    pub(super) fn distortion_of_parts(&self, atlas: &Atlas) -> Vec<Option<Distortion>> {
        let mut triangles = vec![Vec::new(); self.components().len()];
        let part_of = self.triangle_components().into_iter().enumerate();
        part_of.for_each(|(t, part)| part.into_iter().for_each(|part| triangles[part].push(t)));
        let measured = |triangles: &Vec<usize>| self.measures_on(atlas, triangles.iter().copied());
        triangles.par_iter().map(|triangles| measured(triangles).as_ref().map(Distortion::of)).collect()
    }

    /// The measures of a map, on the triangles that are on islands.
    pub(super) fn measures(&self, atlas: &Atlas) -> Option<geom::distortion::Distortion> {
        self.measures_on(atlas, 0..atlas.islands.len())
    }

    /// The same of some triangles.
    fn measures_on(
        &self,
        atlas: &Atlas,
        triangles: impl Iterator<Item = usize> + Clone,
    ) -> Option<geom::distortion::Distortion> {
        let corners = || triangles.clone().filter(|&t| atlas.islands[t].is_some()).map(|t| &atlas.triangles.corners[t]);
        let vertices: Vec<[u32; 3]> = corners().map(|t| t.map(|c| self.corner_vertices()[c as usize])).collect();
        let uv: Vec<[[f64; 2]; 3]> = corners().map(|t| t.map(|c| atlas.uv[c as usize])).collect();
        geom::distortion::measure(self.points(), &vertices, &uv).ok()
    }
}

/// The area distortion D and the mean of σ₁/σ₂.
pub(super) struct Distortion {
    pub(super) areas: f64,
    pub(super) angles: f64,
}

impl Distortion {
    pub(super) fn of(measured: &geom::distortion::Distortion) -> Self {
        Self { areas: measured.area.mean, angles: measured.quasi_conformal.mean }
    }

    /// What maps are compared by: the logarithms of both, that of areas where it misses what is wanted; below, where there are more cones for it, it
    /// counts less.
    fn cost(&self, target: f64) -> f64 {
        let missed = (self.areas / target).ln();
        let missed = if missed > 0.0 { missed } else { BELOW_TARGET * missed };
        missed + self.angles.ln()
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
            before.angles > BENT && after.angles - 1.0 < 0.8 * (before.angles - 1.0),
            "{} {}",
            before.angles,
            after.angles
        );
        let [fewer, more] = [&first, &finer].map(|analysis| analysis.refined().unwrap().model.vertex_count());
        assert!(fewer < more && more < 10_000, "{fewer} {more}");
        // Its times are those of both maps. One of them may have had to wait for other tests.
        let options = Options { cones: ConeChoice::Count(2), free_seams: FreeSeams::Never, ..Options::default() };
        let again = || first.atlas(&options).unwrap().times.total();
        assert!(other.times.total() > again().min(again()).min(atlas.times.total()));
    }

    #[test]
    fn models_without_needles_are_refined_where_that_is_asked_for_and_angles_are_bent() {
        let unwrapped = |vertices, refine| {
            let options = Options {
                preparation: Preparation { refine, ..Preparation::default() },
                cones: ConeChoice::Count(2),
                free_seams: FreeSeams::Never,
                ..Options::default()
            };
            let (analysis, atlas) = Analysis::unwrapped(&shapes::sphere(vertices).into(), &options, Silent).unwrap();
            assert_eq!(
                analysis.topology().faces,
                shapes::sphere(vertices).triangles.len(),
                "those of the model, refined or not"
            );
            (analysis.refined().is_some(), analysis.distortion(&atlas).unwrap().angles)
        };
        let [(is_never, bent), (is_refined, less), (is_fine, _)] =
            [(40, Refining::Never), (40, Refining::Needles), (4000, Refining::Needles)].map(|(n, r)| unwrapped(n, r));
        assert_eq!([is_never, is_refined, is_fine], [false, true, false]);
        assert!(bent > BENT && less < bent, "{bent} {less}");
    }

    #[test]
    fn a_beam_is_not_refined_where_that_is_left_to_the_program() {
        // All its sides are needles.
        let corner = |k: u32| [f64::from(k & 1), f64::from(k >> 1 & 1), 100.0 * f64::from(k >> 2)];
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let beam = Model::from_triangles((0..8).map(corner).collect(), &triangles).unwrap();
        let unwrapped = |refine| {
            let preparation = Preparation { refine, ..Preparation::default() };
            let options = Options { preparation, ..Options::default() };
            let (analysis, atlas) = Analysis::unwrapped(&beam, &options, Silent).unwrap();
            let Distortion { areas, angles } = analysis.distortion(&atlas).unwrap();
            (analysis.refined().is_some(), areas.max(angles) <= EXACT)
        };
        assert_eq!(unwrapped(Refining::Needles), (false, true));
        assert_eq!(unwrapped(Refining::Always), (true, true));
    }

    #[test]
    fn more_cones_are_taken_where_smaller_triangles_still_bend_angles() {
        // A ball with a spike at every fifth vertex, whose net would be cut to peel.
        let mut ball = shapes::sphere(100);
        ball.points.iter_mut().step_by(5).for_each(|point| *point = point.map(|x| 1.6 * x));
        let [(first, atlas), (finer, other)] = refined(&ball.into(), ConeChoice::Automatic);
        let [before, after] = [first.distortion(&atlas), finer.distortion(&other)].map(Option::unwrap);
        assert!(before.angles > BENT && after.angles <= BENT, "{} {}", before.angles, after.angles);
        assert!(other.cones.len() > atlas.cones.len());
    }

    #[test]
    fn areas_below_the_target_count_less_than_above() {
        let cost = |areas, angles| Distortion { areas, angles }.cost(1.25);
        assert!(cost(1.25, 1.05) < cost(1.1, 1.1) && cost(1.1, 1.05) < cost(1.25, 1.05));
        assert!(cost(1.25, 1.1) < cost(1.4, 1.05));
    }

    #[test]
    fn what_bends_no_angles_stays_as_it_is() {
        let [(first, atlas), _] = refined(&shapes::cylinder(64).into(), ConeChoice::Automatic);
        let made = |_: Option<Arc<Sizing>>| unreachable!("it is good enough");
        let (same, again) = first.clone().or_finer(atlas.clone(), &Options::default(), made).unwrap();
        assert_eq!((same.id(), again.uv), (first.id(), atlas.uv));
    }
}
