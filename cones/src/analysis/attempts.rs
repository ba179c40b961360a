//! What is tried where a component cannot be flattened well with the cones that were chosen: other numbers of them,
//! detaching what folds over, unfolding it as it is. The attempt that measures best is kept, never merely the last one.

use geom::Watch;

use super::choosing::{TARGET_DISTORTION, TOLERABLE_DISTORTION};
use super::component::Component;
use super::cones::{Configuration, ROUNDING};
use super::finer;
use super::flat::Flat;
use super::note::{Failure, Note};
use super::observer::{Stage, Task, Times};
use super::options::{ConeChoice, Options, Refining};
use super::refined::{MOST_NEEDLES, needle_share};
use crate::curvature::CurvatureError;
use crate::cut::SeamPlan;
use crate::error::Error;
use crate::field::Operators;
use crate::placement::{MOST_OPTIMISED, MOST_ORDERED, MOST_STRETCH, area_distortion, corners, is_hopeless, stretch};

/// So many times cones are added where a measured distortion is above the one that was asked for.
const MAX_ADDITIONS: usize = 6;
/// Where no more than one triangle in so many stays folded over, it is better to detach these than to try other cones.
const DETACHED_AT_ONCE: usize = 1000;
/// Other cones end the search if they have at most this many times the area distortion that was predicted for the chosen
/// ones, at most this quasi-conformal distortion, and no more than [`MOST_DETACHED`].
const GOOD_ENOUGH: f64 = 1.25;
/// A surface is rough where the curvature at its vertices, whatever its sign, is greater than this by the mean over its area: .9 to 1.4 on a ball whose
/// vertices noise moves by .7 of an edge and on rougher ones, .06 to .9 on gears and other parts of few triangles, .007 on a dragon, of which as much is
/// measured as is predicted.
const ROUGH: f64 = 0.05;
/// An area distortion that no cones should have: where more is predicted for the chosen ones, others are measured by this.
pub(super) const BAD: f64 = 2.0;
/// A map with a larger area distortion is not good enough, even where that was predicted and angles are kept.
pub(super) const RUINED: f64 = 4.0;
/// A larger change of lengths, as a logarithm, is not good enough: a needle that is sixty times as long makes the square large for all.
const LARGEST_LOG_SCALE: f64 = 3.0;
/// Where a refined surface has no flat metric, so many other numbers of cones are tried before it is taken as it was: of 160 files that are
/// refined none needed any, and on one (`convhull_LSP_merged.stl`, 25,000 vertices for 1,800) eight failed in 50 s, where its own
/// triangles take one.
const FEW_REFINED: usize = 2;
/// Where no more triangles than this were detached,
const FEW_DETACHED: usize = 16;
/// and no larger share, the cones stay unless hardly more of them leave none: on Suzanne, 968 triangles of Blender's, the same two fold over with 12, 14 and 56.
const LITTLE_DETACHED: f64 = 0.01;
/// The share of detached triangles up to which other cones can end the search.
const MOST_DETACHED: f64 = 0.05;
/// Where more cones leave the logarithm of the largest change of lengths above so many times what it was, the next number but one is
/// tried: raptor's is 48 with 8 to 128 cones and 4.3 with 256.
const LESS_STRETCH: f64 = 0.9;
/// Above this quasi-conformal distortion it is tried to give a surface with few corners a cone at each. A prism of 32 sides
/// whose triangles are needles has 1.84 with 4 cones, and 1 with all of its 64.
const MOST_CONFORMAL: f64 = 1.02;
/// Above this more cones are tried, so many times as many: on few triangles a map that is linear on each bends angles the more the more
/// curvature is left between cones. A jaw of 148 triangles has 1.50 with 3 cones, 1.05 with 8; the bones of a hand have 1.23 with 4, 1.10 with 8.
const BENT: f64 = 1.15;
const MORE: [f64; 2] = [1.25, 2.0];
/// They are taken if they leave at most so many times as much above 1 with seams as long, less the longer these get: noisy table legs of 986 vertices would take
/// 132 and 122 cones for 22 and 18, with seams of 11 for 3.5 and 3.1, to come from 1.29 to 1.12. After so many that are not no more are tried.
const LESS_BENT: f64 = 0.9;
const IN_VAIN: usize = 2;
/// A net's seams are at most so many times longer: 1.6 times on that prism, where they go round both rims, 2.1 times
/// on a dodecahedron. Spheres of as many corners would be cut to peel, thrice as long.
const LONGEST_NET: f64 = 2.25;
/// And those of more corners than [`MOST_ORDERED`], up to so many: heat sinks, combs and stairs of 96 to 1,600 corners have nets with seams as long
/// as those of any other map, or shorter, where low-poly animals would be cut to peel. They may be longer by what the other map distorts, as logarithms.
const MOST_OF_NET: usize = 2048;
const LONGEST_LARGE_NET: f64 = 1.25;
/// Or so long over the root of the area, where angles are [`BENT`] with hardly any seams: a cone of 24 sides, as high as wide and open below,
/// has 1.42 with no cone, and 1 with one at its tip.
const SHORT_NET: f64 = 1.0;
/// A net whose distortions are no more than this, as logarithms, is as good as any map can be.
const EXACT: f64 = 0.01;
/// What a share of detached triangles costs beside the logarithms of the distortions: one in a hundred as much as a product of
/// both that is 1.28 times larger. Detached triangles are islands of one to a few, or stretched.
const DETACHED_COST: f64 = 25.0;

/// The attempts on one component.
struct Attempts<'a> {
    component: &'a Component,
    options: &'a Options,
    plan: &'a SeamPlan,
    task: &'a Task,
    times: &'a mut Times,
}

impl Component {
    /// Flattens it with the cones chosen, and others where these fail.
    pub(crate) fn flatten_well(
        &self,
        chosen: &Result<Configuration, Error>,
        (options, plan): (&Options, &SeamPlan),
        task: &Task,
        times: &mut Times,
    ) -> Result<Flat, Error> {
        let mut attempts = Attempts { component: self, options, plan, task, times };
        let mut flat = attempts.flatten_with_enough(chosen.as_ref().map_err(Clone::clone))?;
        match options.cones {
            ConeChoice::Automatic => {
                if (flat.promised.quasi_conformal > MOST_CONFORMAL || !flat.detached.is_empty())
                    && let Some(net) = attempts.net(Some(&flat))?
                {
                    flat = net;
                }
                flat = attempts.less_bent(flat)?;
                let predicted = area_distortion(&self.operators, &flat.predicted);
                if predicted <= TARGET_DISTORTION && !is_ruin(&flat) {
                    flat = attempts.within(flat, TOLERABLE_DISTORTION)?;
                    attempts.free_where_missed(&mut flat, TOLERABLE_DISTORTION)?;
                }
            }
            ConeChoice::WithinDistortion(target) => {
                flat = attempts.within(flat, target)?;
                attempts.free_where_missed(&mut flat, target)?;
                let reached = flat.promised.area_distortion();
                self.note_missed_target(&mut flat, reached, options);
            }
            _ => {}
        }
        Ok(flat)
    }
}

impl Component {
    /// Says so where an area distortion was asked for and more is reached.
    pub(super) fn note_missed_target(&self, flat: &mut Flat, reached: f64, options: &Options) {
        if let Some(target) = options.cones.wanted().filter(|target| reached > *target + ROUNDING) {
            flat.notes.push(Note::TargetMissed { component: self.index, target, reached, cones: flat.cones.len() });
        }
    }

    /// Whether what is left between cones is bent by triangles that are no needles, so that maps with free seams distort less than is predicted.
    pub(super) fn is_rough(&self) -> bool {
        let Operators { mesh, metric, curvature, weight, .. } = &*self.operators;
        let bent: f64 = curvature.iter().zip(weight.iter()).map(|(curvature, weight)| curvature.abs() * weight).sum();
        let whole: f64 = weight.iter().sum();
        bent > ROUGH * whole && needle_share([(mesh.triangulation(), metric, 1.0)].into_iter()) <= MOST_NEEDLES
    }
}

impl Attempts<'_> {
    /// So many cones; why there are none in the inner error.
    fn place(&mut self, count: usize) -> Result<Result<Configuration, Error>, Error> {
        match self.component.place(self.options, count, self.task, self.times) {
            Err(Error::Interrupted) => Err(Error::Interrupted),
            placed => Ok(placed),
        }
    }

    /// The chosen cones, or more where these are predicted to leave too much to distort: unless on a rough surface less is measured, or more cones do
    /// not gain what their seams cost. (A ball whose vertices are moved in and out by .7 of an edge has 1.24 with 32 cones and seams of 4; it takes
    /// 329 to have 1.3 predicted, with seams of 13.)
    fn flatten_with_enough(&mut self, chosen: Result<&Configuration, Error>) -> Result<Flat, Error> {
        let (Ok(configuration), Some(goal)) = (&chosen, self.options.cones.goal()) else { return self.flatten(chosen) };
        let predicted = area_distortion(&self.component.operators, &configuration.predicted);
        if predicted <= goal {
            return self.flatten(chosen);
        }
        let first = match predicted <= BAD && self.component.is_rough() {
            true => Some(self.attempt(configuration)?),
            false => None,
        };
        let is_enough = |flat: &Flat| flat.promised.area_distortion() <= goal && flat.promised.quasi_conformal <= BENT;
        let first = match first {
            Some(Ok(flat)) if self.is_sound(&flat) && is_enough(&flat) => return Ok(flat),
            first => first,
        };
        let Some(more) = self.component.enough(configuration, goal, self.options, self.task, self.times)? else {
            return match first {
                Some(first) => self.flatten_from(configuration, first),
                None => self.flatten(chosen),
            };
        };
        let more = self.flatten(Ok(&more))?;
        let is_asked_for = self.options.cones != ConeChoice::Automatic;
        let is_better = |first: &Flat| cost(first) < cost(&more) * self.seam_price([first, &more]);
        Ok(match first {
            Some(Ok(first)) if !is_asked_for && self.is_sound(&first) && is_better(&first) => first,
            _ => more,
        })
    }

    /// The first attempt if it succeeds, else the best of several.
    fn flatten(&mut self, chosen: Result<&Configuration, Error>) -> Result<Flat, Error> {
        let configuration = match chosen {
            Ok(configuration) => configuration,
            Err(error) => return self.unfold(failure(error)?),
        };
        // Whoever has said how many shall have so many: these are tried in any case.
        let is_hopeless = self.options.cones == ConeChoice::Automatic
            && is_hopeless(&self.component.operators, &configuration.predicted);
        let first = match is_hopeless {
            true => {
                Err(Failure::Stretched { log: stretch(&self.component.operators, configuration.predicted.clone()) })
            }
            false => self.attempt(configuration)?,
        };
        self.flatten_from(configuration, first)
    }

    /// A first attempt if it has succeeded, else the best of several.
    fn flatten_from(&mut self, configuration: &Configuration, first: Result<Flat, Failure>) -> Result<Flat, Error> {
        let predicted = area_distortion(&self.component.operators, &configuration.predicted);
        let enough = GOOD_ENOUGH * predicted.min(BAD);
        // Cones that would stretch too much are put off: only those that would change lengths least are tried, and only where
        // nothing better is found.
        let mut log = stretch(&self.component.operators, configuration.predicted.clone());
        let mut stretched: Option<(f64, Configuration)> = match &first {
            Err(Failure::Stretched { .. }) => Some((log, configuration.clone())),
            _ => None,
        };
        let mut is_nearly_sound = false;
        let (mut best, cause) = match first {
            Ok(flat) => {
                let (area, angles) = (flat.promised.area_distortion(), flat.promised.quasi_conformal);
                let is_as_predicted = area <= enough || angles <= GOOD_ENOUGH && area <= RUINED;
                let (is_sound, triangles) = (self.is_sound(&flat), flat.detached.len());
                let is_good = is_as_predicted || self.options.cones != ConeChoice::Automatic;
                if is_sound && is_good {
                    return Ok(flat);
                }
                is_nearly_sound = is_good && self::is_nearly_sound(&flat);
                let cause = match is_sound || triangles == 0 {
                    true => Failure::Distorted { area, angles },
                    false => Failure::FoldOvers { triangles },
                };
                (Some(flat), cause)
            }
            Err(failure) => (None, failure),
        };
        let count = configuration.vertices.len();
        let mut last = cause;
        let most = count.max(self.component.most_cones());
        let is_automatic = self.options.cones == ConeChoice::Automatic;
        let net = if is_automatic && !is_nearly_sound { self.net(best.as_ref())? } else { None };
        let is_exact = net.as_ref().is_some_and(|net| net.promised.cost() <= EXACT);
        best = net.or(best);
        let mut others = match is_nearly_sound {
            _ if is_exact => Vec::new(),
            true => near_counts(count, most),
            false => other_counts(count, most, &cause),
        };
        if is_doubling(&cause) && self.has_its_own_triangles() {
            others.truncate(FEW_REFINED);
        }
        let mut others = others.into_iter();
        while let Some(other) = others.next() {
            let flat = match self.other(other, &mut stretched)? {
                Ok(flat) => flat,
                Err(failure) => {
                    if let Failure::Stretched { log: now } = failure {
                        let is_futile = now > MOST_STRETCH.ln().max(LESS_STRETCH * log);
                        if is_futile && others.len() > 1 && is_doubling(&cause) {
                            others.next();
                        }
                        log = now;
                    }
                    last = failure;
                    continue;
                }
            };
            let is_enough = flat.promised.area_distortion() <= enough
                && flat.promised.quasi_conformal <= GOOD_ENOUGH
                && flat.promised.largest_log_scale() <= LARGEST_LOG_SCALE
                && detached_share(&flat) <= if is_nearly_sound { 0.0 } else { MOST_DETACHED };
            let is_worth_it = is_enough || !is_nearly_sound;
            if is_worth_it && best.as_ref().is_none_or(|best| cost(&flat) < cost(best)) {
                best = Some(flat);
            }
            if is_enough {
                break;
            }
        }
        if best.as_ref().is_none_or(|best| detached_share(best) > MOST_DETACHED)
            && let Some((_, configuration)) = stretched
            && let Ok(flat) = self.attempt(&configuration)?
            && best.as_ref().is_none_or(|best| cost(&flat) < cost(best))
        {
            best = Some(flat);
        }
        let Some(mut best) = best else { return self.unfold(last) };
        let taken = best.cones.len();
        if taken != count {
            best.notes.push(Note::OtherNumber { component: self.component.index, chosen: count, taken, cause });
        }
        Ok(best)
    }

    /// An attempt with another number of cones. Where lengths would change too much there is none yet; the configuration that
    /// would change them least is kept.
    fn other(
        &mut self,
        count: usize,
        stretched: &mut Option<(f64, Configuration)>,
    ) -> Result<Result<Flat, Failure>, Error> {
        let configuration = match self.place(count)? {
            Ok(configuration) => configuration,
            Err(error) => return Ok(Err(failure(error)?)),
        };
        let log = stretch(&self.component.operators, configuration.predicted.clone());
        let predicted = area_distortion(&self.component.operators, &configuration.predicted);
        if log <= MOST_STRETCH.ln() && predicted <= RUINED {
            return self.attempt(&configuration);
        }
        if stretched.as_ref().is_none_or(|(least, _)| log < *least) {
            *stretched = Some((log, configuration));
        }
        Ok(Err(Failure::Stretched { log }))
    }

    /// A flattening, what folds over detached; why there is none in the inner error.
    fn attempt(&mut self, configuration: &Configuration) -> Result<Result<Flat, Failure>, Error> {
        match self.component.flatten(configuration, (self.plan, self.options.may_loosen()), self.task, self.times) {
            Err(error) => Ok(Err(failure(error)?)),
            Ok(mut flat) => {
                self.component.detach_fold_overs(&mut flat);
                let stage = (Stage::Layout, self.component.index);
                let promised = |watch: Watch| self.component.promised(&mut flat, self.options, watch);
                self.task.stage(stage, self.times, promised)??;
                Ok(Ok(flat))
            }
        }
    }

    /// Free seams where more cones do not bring about what they are predicted to: where coarse triangles part two scales, as needles round the foot of a
    /// statue on its ground, which linear theory knows nothing of.
    fn free_where_missed(&mut self, flat: &mut Flat, target: f64) -> Result<(), Error> {
        let predicted = area_distortion(&self.component.operators, &flat.predicted);
        if flat.promised.area_distortion() > target && predicted <= target {
            flat.misses_areas = true;
            let stage = (Stage::Layout, self.component.index);
            let promised = |watch: Watch| self.component.promised(flat, self.options, watch);
            self.task.stage(stage, self.times, promised)??;
        }
        Ok(())
    }

    /// More cones where a map distorts areas more than was asked for, until it does not.
    fn within(&mut self, mut flat: Flat, target: f64) -> Result<Flat, Error> {
        let mut count = flat.cones.len();
        for _ in 0..MAX_ADDITIONS {
            if flat.promised.area_distortion() <= target || count >= MOST_OPTIMISED {
                break;
            }
            let more = self.place((count + 1 + count / 8).min(MOST_OPTIMISED))?;
            let next = self.flatten(more.as_ref().map_err(Clone::clone))?;
            count = next.cones.len().max(count + 1);
            if cost(&next) < cost(&flat) {
                flat = next;
            }
        }
        Ok(flat)
    }

    /// More cones where angles are bent too much, as long as that helps.
    fn less_bent(&mut self, mut flat: Flat) -> Result<Flat, Error> {
        // Before a surface is refined as far as it will be, smaller triangles do more.
        let most_bent = if self.component.is_finest { finer::BENT } else { BENT };
        let bent = |flat: &Flat| (flat.promised.quasi_conformal - 1.0) / (most_bent - 1.0);
        let most = self.component.most_cones().min(MOST_OPTIMISED);
        let (mut count, mut in_vain) = (flat.cones.len().max(most.saturating_sub(1).min(2)), 0);
        let is_ruin = is_ruin(&flat);
        while !is_ruin && bent(&flat) > 1.0 && count < most && in_vain < IN_VAIN {
            let more = (count as f64 * bent(&flat).clamp(MORE[0], MORE[1])).ceil() as usize;
            count = more.max(count + 1).min(most);
            let Ok(configuration) = self.place(count)? else { break };
            match self.attempt(&configuration)? {
                Ok(other)
                    if (self.is_sound(&other) || other.detached.len() <= flat.detached.len() && !is_ruined(&other))
                        && bent(&other) * self.longer([&flat, &other]) <= LESS_BENT * bent(&flat)
                        && cost(&other) < cost(&flat) =>
                {
                    (flat, in_vain) = (other, 0);
                }
                _ => in_vain += 1,
            }
        }
        Ok(flat)
    }

    /// A cone at each corner of a surface that has few, if that gives a better map than there is with seams not much longer: a polyhedron's net, exact.
    fn net(&mut self, flat: Option<&Flat>) -> Result<Option<Flat>, Error> {
        let Component { operators, metric, surface, .. } = self.component;
        // Curvatures that are rounded are not those that corners have.
        let most = if self.options.quantize.is_none() { MOST_OF_NET } else { MOST_ORDERED };
        let cones = flat.map_or(0, |flat| flat.cones.len());
        let Some(corners) = corners(operators, most).filter(|corners| corners.len() > cones) else { return Ok(None) };
        let longest = match flat.filter(|flat| !is_ruin(flat) && detached_share(flat) <= MOST_DETACHED) {
            None => f64::INFINITY, // any is better
            Some(flat) => {
                let is_bent = flat.promised.quasi_conformal >= BENT;
                let short = if is_bent { SHORT_NET * metric.area(&surface.mesh).sqrt() } else { 0.0 };
                let times = if corners.len() <= MOST_ORDERED { LONGEST_NET } else { LONGEST_LARGE_NET + cost(flat) };
                short.max(times * self.seams(flat))
            }
        };
        let configured = match self.options.quantize {
            None => Ok(self.component.with_own_curvatures(corners)),
            Some(_) => {
                let stage = (Stage::Curvature, self.component.index);
                let with_curvatures = |watch: Watch| self.component.with_curvatures(corners, self.options, watch);
                self.task.stage(stage, self.times, with_curvatures)?
            }
        };
        match configured {
            Ok(configuration) => {
                let net = self.attempt(&configuration)?.ok().filter(|net| self.is_sound(net));
                let is_better = |net: &Flat| flat.is_none_or(|flat| cost(net) < cost(flat));
                Ok(net.filter(|net| is_better(net) && self.seams(net) <= longest))
            }
            Err(CurvatureError::Interrupted(stop)) => Err(stop.into()),
            Err(_) => Ok(None),
        }
    }

    /// By what factor a map must distort less than another to be worth its seams.
    fn seam_price(&self, maps: [&Flat; 2]) -> f64 {
        self.longer(maps).sqrt()
    }

    /// How much longer a map's seams are than another's, with a side of its square.
    fn longer(&self, [before, after]: [&Flat; 2]) -> f64 {
        let Component { metric, surface, .. } = self.component;
        let side = metric.area(&surface.mesh).sqrt();
        (side + self.seams(after)) / (side + self.seams(before))
    }

    /// How long a map's seams are.
    fn seams(&self, flat: &Flat) -> f64 {
        let Component { surface, metric, .. } = self.component;
        let cut = surface.mesh.edges().filter(|&e| flat.seams.cut[e]);
        cut.map(|e| metric.length(e)).sum()
    }

    /// Whether so few triangles were detached that no other cones need be tried. Loose seams let ruins unfold, too.
    fn is_sound(&self, flat: &Flat) -> bool {
        flat.detached.len() <= self.component.surface.mesh.face_count() / DETACHED_AT_ONCE && !is_ruined(flat)
    }

    /// Whether it was refined, but only for its needles, and can be taken as it was.
    fn has_its_own_triangles(&self) -> bool {
        self.component.may_be_unrefined() && self.options.preparation.refine == Refining::Needles
    }

    /// The last resort; an error where the surface may be taken as it was before it was refined.
    fn unfold(&mut self, cause: Failure) -> Result<Flat, Error> {
        if self.has_its_own_triangles() {
            return Err(Error::NotFlatRefined { component: self.component.index });
        }
        let mut flat = self.component.unfold(self.plan, self.task, self.times)?;
        flat.notes.push(Note::Unfolded { component: self.component.index, cause });
        Ok(flat)
    }
}

/// Why an attempt failed, if it was not stopped.
fn failure(error: Error) -> Result<Failure, Error> {
    match error {
        Error::Interrupted => Err(error),
        Error::Curvature(_) => Ok(Failure::Curvature),
        Error::Seams(_) => Ok(Failure::Cut),
        _ => Ok(Failure::Metric),
    }
}

/// What attempts are compared by: the logarithms of both distortions, and the share of triangles that were detached.
fn cost(flat: &Flat) -> f64 {
    let cost = flat.promised.cost() + DETACHED_COST * detached_share(flat);
    if cost.is_nan() { f64::INFINITY } else { cost }
}

/// Whether angles are bent so much that a few more cones will not help; a net may.
fn is_ruin(flat: &Flat) -> bool {
    flat.is_unfolded || flat.promised.quasi_conformal > RUINED
}

/// Whether so few triangles were detached that only numbers of cones near to this one are tried.
fn is_nearly_sound(flat: &Flat) -> bool {
    !is_ruined(flat) && flat.detached.len() <= FEW_DETACHED && detached_share(flat) <= LITTLE_DETACHED
}

/// Whether loose seams let a ruin unfold.
fn is_ruined(flat: &Flat) -> bool {
    flat.is_loose && flat.quality.area_distortion() > RUINED
}

fn detached_share(flat: &Flat) -> f64 {
    flat.detached.len() as f64 / flat.quality.ratios.len().max(1) as f64
}

/// What to try where so many cones cannot be flattened. Metrics that are hard to find get easier with more cones. Triangles
/// that stay folded over are needles near cones: fewer near fewer cones, and fewer where more cones need less curvature
/// each. (On `thingi79741`, 99.7 % needles, the 14 cones chosen leave 219 triangles folded over and a quasi-conformal
/// distortion of 1.76, 56 cones 159 and 1.20; 3 cones none, but 4.1 with an area distortion of 7. On `cheese` 38 to 158 cones leave 520 to 680, 512
/// leave 73. Each attempt takes seconds there, so that few are made.)
fn other_counts(chosen: usize, most: usize, cause: &Failure) -> Vec<usize> {
    let count = chosen.max(1);
    let mut counts = match cause {
        Failure::Distorted { area, .. } if *area > RUINED => {
            [2, 4, 8, 16].map(|times| (times * count).min(MOST_OPTIMISED.max(count))).to_vec()
        }
        Failure::Distorted { .. } => vec![count + 1 + count / 4, 2 * count, 4 * count],
        Failure::FoldOvers { .. } => {
            let most = MOST_OPTIMISED.max(count + 1);
            vec![(4 * count).min(most), (16 * count).min(most), count / 4]
        }
        _ => {
            let doubled = std::iter::successors(Some(2 * chosen.max(2)), |count| Some(2 * count));
            doubled
                .enumerate()
                .take_while(|&(k, count)| k < 4 || count <= MOST_OPTIMISED)
                .map(|(_, count)| count)
                .collect()
        }
    };
    counts.dedup();
    counts.retain(|&other| other != chosen && other <= most);
    counts
}

/// What to try where few triangles stay folded over.
fn near_counts(count: usize, most: usize) -> Vec<usize> {
    let mut counts = vec![count + 1, count + 1 + count / 4, 2 * count];
    counts.retain(|&other| other > count && other <= most);
    counts.dedup();
    counts
}

/// Whether ever more cones are tried.
fn is_doubling(cause: &Failure) -> bool {
    !matches!(cause, Failure::Distorted { .. } | Failure::FoldOvers { .. })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Analysis, Atlas};
    use geom::{Model, shapes};

    fn measured(model: &Model, atlas: &Atlas) -> geom::distortion::Distortion {
        let corners = &atlas.triangles.corners;
        let triangles: Vec<[u32; 3]> = corners.iter().map(|t| t.map(|c| model.corners()[c as usize])).collect();
        let uv: Vec<[[f64; 2]; 3]> = corners.iter().map(|t| t.map(|c| atlas.uv[c as usize])).collect();
        geom::distortion::measure(model.points(), &triangles, &uv).unwrap()
    }

    #[test]
    fn where_few_triangles_bend_angles_more_cones_are_taken() {
        let model: Model = shapes::sphere(40).into();
        let analysis = Analysis::new(&model).unwrap();
        let rigid = Options { free_seams: crate::FreeSeams::Never, ..Options::default() };
        let bent = |atlas: &Atlas| measured(&model, atlas).quasi_conformal.mean;
        for options in [Options::default(), rigid] {
            let chosen = analysis.choose(&options).unwrap();
            let before = analysis.flatten_with(&chosen, &options).unwrap();
            let after = analysis.atlas(&options).unwrap();
            assert!(bent(&before) > BENT && bent(&after) <= BENT, "{} {}", bent(&before), bent(&after));
            assert!(after.cones.len() > chosen.len());
            assert_eq!(after.number.as_ref().map(|number| number.chosen), Some(after.cones.len()));
            // Whoever says how many shall have so many.
            let asked = Options { cones: ConeChoice::Count(chosen.len()), ..options };
            assert_eq!(analysis.atlas(&asked).unwrap().cones.len(), chosen.len());
        }
    }

    #[test]
    fn where_areas_come_out_worse_than_predicted_seams_are_set_free() {
        let analysis = Analysis::new(&shapes::sphere(100).into()).unwrap();
        let (task, component) = (analysis.task(), &analysis.components()[0]);
        let mut times = Times::default();
        for free_seams in [crate::FreeSeams::Auto, crate::FreeSeams::Never] {
            let options = Options { free_seams, ..Options::default() };
            let plan = analysis.plan(component, &options.seams, &task, &mut times).unwrap();
            let mut attempts = Attempts { component, options: &options, plan: &plan, task: &task, times: &mut times };
            for count in 8..12 {
                let configuration = attempts.place(count).unwrap().unwrap();
                let mut flat = attempts.attempt(&configuration).unwrap().ok().unwrap();
                let predicted = area_distortion(&component.operators, &flat.predicted);
                let before = flat.promised.area_distortion();
                assert!(before > predicted);
                attempts.free_where_missed(&mut flat, before).unwrap();
                assert_eq!((flat.misses_areas, flat.promised.area_distortion()), (false, before));
                attempts.free_where_missed(&mut flat, predicted).unwrap();
                assert!(flat.misses_areas);
                assert_eq!(flat.promised.area_distortion() < before, free_seams == crate::FreeSeams::Auto);
            }
        }
    }

    #[test]
    fn seams_are_set_free_for_the_areas_that_are_asked_for_and_what_misses_them_is_told() {
        let analysis = Analysis::new(&shapes::sphere(60).into()).unwrap();
        let (task, component) = (analysis.task(), &analysis.components()[0]);
        let mut times = Times::default();
        let [automatic, asked] = [ConeChoice::Automatic, ConeChoice::WithinDistortion(1.01)].map(|cones| {
            let options = Options { cones, free_seams: crate::FreeSeams::Always, ..Options::default() };
            let plan = analysis.plan(component, &options.seams, &task, &mut times).unwrap();
            let mut attempts = Attempts { component, options: &options, plan: &plan, task: &task, times: &mut times };
            let configuration = attempts.place(8).unwrap().unwrap();
            let mut flat = attempts.attempt(&configuration).unwrap().ok().unwrap();
            component.free_seams(&mut flat, &options, &task, &mut times).unwrap();
            flat
        });
        let areas = [&automatic, &asked].map(|flat| flat.quality.area_distortion());
        assert!(areas[0] <= TARGET_DISTORTION && areas[1] < areas[0] && areas[1] > 1.02, "{areas:?}");
        let told = |flat: &Flat| flat.notes.iter().any(|note| matches!(note, Note::TargetMissed { .. }));
        assert_eq!([told(&automatic), told(&asked)], [false, true]);
    }

    /// A plate with ribs, its profile drawn out: walls of four corners between two caps of 4 `ribs`.
    fn ribbed(ribs: u32) -> Model {
        let rib = |k: u32| [(0.0, 0.0), (0.0, 3.0), (0.6, 3.0), (0.6, 0.0)].map(|(x, y)| [f64::from(k) + x, y]);
        let mut profile: Vec<[f64; 2]> = (0..ribs).flat_map(rib).collect();
        let n = profile.len();
        (profile[0][1], profile[n - 1][1]) = (-0.5, -0.5);
        let n = n as u32;
        let points = [0.0, 9.0].iter().flat_map(|&z| profile.iter().map(move |&[x, y]| [x, y, z])).collect();
        let mut faces: Vec<Vec<u32>> = (0..n).map(|k| vec![(k + 1) % n, k, n + k, n + (k + 1) % n]).collect();
        faces.extend([(0..n).collect(), (n..2 * n).rev().collect()]);
        Model::from_polygons(points, faces).unwrap()
    }

    #[test]
    fn what_has_hundreds_of_corners_becomes_its_net_where_that_is_no_longer() {
        // Of 96 corners and of 320.
        for ribs in [12, 40] {
            let model = ribbed(ribs);
            let atlas = Analysis::new(&model).unwrap().atlas(&Options::default()).unwrap();
            let found = measured(&model, &atlas);
            assert!(found.quasi_conformal.max < 1.0 + 1e-6 && found.area.max < 1.0 + 1e-6, "{found:?}");
            assert_eq!(atlas.cones.len(), 8 * ribs as usize);
            assert!(!atlas.notes.iter().any(|note| matches!(note, Note::Overlap { .. })), "{:?}", atlas.notes);
        }
    }

    #[test]
    fn on_a_rough_surface_it_is_measured_whether_more_cones_are_needed() {
        let mut shape = shapes::sphere(1500);
        // Vertices moved in and out by up to 1.5 edges, whose length is √(8π / √3 n).
        let edge = (8.0 * std::f64::consts::PI / (3.0_f64.sqrt() * shape.points.len() as f64)).sqrt();
        let mut dice = 1_u64;
        for point in &mut shape.points {
            dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let dice = (dice >> 32) as f64 / f64::from(u32::MAX) - 0.5;
            *point = point.map(|x| x * (1.0 + 3.0 * edge * dice));
        }
        let model: Model = shape.into();
        let analysis = Analysis::new(&model).unwrap();
        let options = Options::default();
        let predicted = analysis.choose(&options).unwrap();
        let atlas = analysis.atlas(&options).unwrap();
        assert!(atlas.cones.len() <= 32 && predicted.len() > 2 * atlas.cones.len(), "{}", predicted.len());
        let area_distortion = measured(&model, &atlas).area.mean;
        assert!(area_distortion <= TOLERABLE_DISTORTION, "{area_distortion}");
        let figures = atlas.number.unwrap();
        assert!(figures.predicted > TOLERABLE_DISTORTION, "{}", figures.predicted);
    }

    #[test]
    fn near_numbers_are_tried_for_a_few_fold_overs() {
        assert_eq!(near_counts(12, 9999), [13, 16, 24]);
        assert_eq!(near_counts(3, 9999), [4, 6]);
        assert_eq!(near_counts(1, 9999), [2]);
        assert_eq!(near_counts(0, 9999), [1]);
        assert_eq!(near_counts(12, 14), [13]);
    }

    #[test]
    fn more_cones_are_tried_for_a_metric_and_fewer_too_for_needles() {
        assert_eq!(other_counts(8, 9999, &Failure::Stretched { log: 9.0 }), [16, 32, 64, 128, 256, 512]);
        assert_eq!(other_counts(0, 9999, &Failure::Metric), [4, 8, 16, 32, 64, 128, 256, 512]);
        assert_eq!(other_counts(0, 9999, &Failure::FoldOvers { triangles: 1 }), [4, 16]);
        assert_eq!(other_counts(0, 9999, &Failure::Distorted { area: 2.0, angles: 1.0 }), [2, 4]);
        assert_eq!(other_counts(0, 9999, &Failure::Distorted { area: 1e9, angles: 1.0 }), [2, 4, 8, 16]);
        assert_eq!(other_counts(512, 9999, &Failure::Distorted { area: 1e9, angles: 1.0 }), [0; 0]);
        assert_eq!(other_counts(300, 9999, &Failure::Metric), [600, 1200, 2400, 4800]);
        assert_eq!(other_counts(8, 9999, &Failure::FoldOvers { triangles: 1 }), [32, 128, 2]);
        assert_eq!(other_counts(256, 9999, &Failure::FoldOvers { triangles: 1 }), [512, 64]);
        assert_eq!(other_counts(8, 40, &Failure::Metric), [16, 32]);
        assert_eq!(other_counts(8, 8, &Failure::FoldOvers { triangles: 1 }), [2]);
    }
}
