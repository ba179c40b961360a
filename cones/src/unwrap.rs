//! The whole method: the stages in order, nothing else.

use std::time::{Duration, Instant};

use geom::{
    EdgeData, Id, Metric, Model, PoissonError, Prepared, Surface, VertexData, VertexId, angle_defects, prepare,
};
use topo::Extremum;

use crate::angles::{AnglesError, ConeCurvatures, cone_curvatures, least_cones};
use crate::atlas::{Atlas, Cone, Extraction, NumberOfCones, Stage, Topology};
use crate::automatic::{MOST_AUTOMATIC, TARGET_DISTORTION, automatic, shortest};
use crate::distortion::area_distortion;
use crate::error::Error;
use crate::factor::ConformalFactor;
use crate::hierarchy::{Candidate, ConeHierarchy, Method, kind_of};
use crate::layout::Layout;
use crate::mend::mend;
use crate::operators::Operators;
use crate::options::{ConeChoice, Options};
use crate::reduced::Reduced;
use crate::scaling::{Scaling, scale};
use crate::seams::{Chain, Seams};
use crate::share::{Part, share_out};
use crate::shelf::Shelf;

/// More cones than this are not optimised: `refined` takes a time that grows with the third power of their number.
const MOST_OPTIMISED: usize = 64;
/// So many times cones are added where a measured distortion is above the one that was asked for.
const MAX_ADDITIONS: usize = 6;
/// Where the cones that were asked for have failed, others are not tried if linear theory predicts that with them somewhere
/// lengths change by more than this factor against the mean. A scan whose noise has made tiny handles comes there, and
/// Newton's method would take long to fail again.
const MOST_STRETCH: f64 = 3000.0;
/// What is said where lengths were mollified.
const MOLLIFIED: &str = "edges were lengthened by up to 1e-4 of their mean, because of needle triangles";

/// Unwraps a model: cones, seams, flattening. `on_stage` hears of each stage as it begins.
///
/// # Errors
/// If the model has no surface, or one that cannot be flattened.
pub fn unwrap(model: &Model, options: &Options, on_stage: &mut dyn FnMut(Stage)) -> Result<Atlas, Error> {
    let mut run = Run::new(model, options, on_stage)?;
    let mut uv = vec![None; model.corner_count()];
    let mut seams = Vec::new();
    let mut curvature_error = 0.0_f64;
    let analysed = run.analyse_all()?;
    let mut shelf = Shelf::new(analysed.iter().map(|a| a.area).sum());
    for (index, (analysed, choice)) in analysed.iter().zip(run.first_choices(&analysed)?).enumerate() {
        let flat = run.flatten_within(index, analysed, choice)?;
        let surface = &run.prepared.surfaces[index];
        curvature_error = curvature_error.max(flat.scaling.error);
        let size = flat.size(surface, &analysed.operators);
        let position = shelf.place(&flat.layout, size);
        for h in surface.mesh.halfedges() {
            uv[surface.corner[h] as usize] = Some(position(flat.layout.corner(h)));
        }
        let of_model = |chain: &Chain| chain.vertices.iter().map(|&v| surface.vertex[v]).collect();
        seams.extend(flat.seams.chains.iter().map(of_model));
        run.note_cones(index, &flat.cones, &flat.curvatures);
    }
    let Run { prepared, found, .. } = run;
    Ok(Atlas {
        uv: fill_corners(model, uv),
        topology: found.topology,
        triangles: prepared.triangles,
        left_out: prepared.left_out,
        seams,
        curvature_error,
        repairs: prepared.repairs,
        cones: found.cones,
        factor: found.factor,
        persistence: found.persistence,
        number: found.number,
        times: found.times,
        warnings: found.warnings,
    })
}

/// Finds a model's cones as [`unwrap`] would, without flattening it.
///
/// # Errors
/// If the model has no surface, or one whose Laplacian cannot be factored.
pub fn extract(model: &Model, options: &Options, on_stage: &mut dyn FnMut(Stage)) -> Result<Extraction, Error> {
    let mut run = Run::new(model, options, on_stage)?;
    let analysed = run.analyse_all()?;
    for (index, (analysed, choice)) in analysed.iter().zip(run.first_choices(&analysed)?).enumerate() {
        let (cones, curvatures) = run.choose(index, analysed, &choice)?;
        run.note_cones(index, &cones, &curvatures.curvature);
    }
    let Run { prepared, found, .. } = run;
    Ok(Extraction {
        topology: found.topology,
        repairs: prepared.repairs,
        cones: found.cones,
        factor: found.factor,
        persistence: found.persistence,
        number: found.number,
        times: found.times,
        warnings: found.warnings,
    })
}

/// One call of [`unwrap`] or [`extract`]: what it works on and what it has found.
struct Run<'a> {
    options: &'a Options,
    prepared: Prepared,
    found: Found,
    on_stage: &'a mut dyn FnMut(Stage),
    model: &'a Model,
}

#[derive(Default)]
struct Found {
    cones: Vec<Cone>,
    factor: Vec<f64>,
    persistence: Vec<f64>,
    number: Option<NumberOfCones>,
    topology: Topology,
    times: Vec<(Stage, Duration)>,
    warnings: Vec<String>,
}

/// A surface with all that is needed to choose cones.
struct Analysed {
    metric: Metric,
    /// The area in the model's units.
    area: f64,
    operators: Operators,
    hierarchy: ConeHierarchy,
}

/// A flattened surface.
struct Flat {
    cones: Vec<Candidate>,
    curvatures: Vec<f64>,
    seams: Seams,
    scaling: Scaling,
    layout: Layout,
}

impl Flat {
    /// What to multiply the layout by so that its mean log scale is 0 in the model's units.
    fn size(&self, surface: &Surface, operators: &Operators) -> f64 {
        let mean: f64 = operators.weight.iter().zip(self.scaling.u.iter()).map(|(w, u)| w * u).sum();
        (-mean).exp() / surface.scale
    }
}

/// Cones to begin with.
enum Choice {
    /// So many of the hierarchy.
    Count(usize),
    /// These, or others where they fail.
    Found(Vec<VertexId>),
    /// These, perhaps with curvatures.
    Given(Vec<VertexId>, Option<Vec<f64>>),
}

impl<'a> Run<'a> {
    fn new(model: &'a Model, options: &'a Options, on_stage: &'a mut dyn FnMut(Stage)) -> Result<Self, Error> {
        on_stage(Stage::Prepare);
        let start = Instant::now();
        let prepared = prepare(model, options.weld)?;
        let mut found = Found { factor: vec![f64::NAN; model.vertex_count()], ..Found::default() };
        found.topology = Topology::of(&prepared.surfaces);
        found.times = Stage::ALL.map(|stage| (stage, Duration::ZERO)).to_vec();
        found.times[0].1 = start.elapsed();
        let run = Self { options, prepared, found, on_stage, model };
        run.check_given()?;
        Ok(run)
    }

    /// Runs a stage and adds up its time.
    fn stage<T>(&mut self, stage: Stage, work: impl FnOnce(&mut Self) -> T) -> T {
        (self.on_stage)(stage);
        let start = Instant::now();
        let done = work(self);
        self.found.times.iter_mut().filter(|(s, _)| *s == stage).for_each(|(_, time)| *time += start.elapsed());
        done
    }

    fn analyse(&mut self, index: usize) -> Result<Analysed, Error> {
        let (metric, operators) = self.stage(Stage::Factor, |run| {
            let surface = &run.prepared.surfaces[index];
            let metric = surface.metric();
            match Operators::with_points(&surface.mesh, &metric, &surface.points) {
                Err(PoissonError::NotPositiveDefinite) => {
                    let metric = metric.mollified(&surface.mesh, Metric::MOLLIFICATION);
                    let operators = Operators::with_points(&surface.mesh, &metric, &surface.points);
                    run.warn(MOLLIFIED.to_owned());
                    operators.map(|operators| (metric, operators))
                }
                operators => operators.map(|operators| (metric, operators)),
            }
        })?;
        self.stage(Stage::Hierarchy, |run| {
            let smoothed = run.options.smooth.then(|| ConformalFactor::smoothed(&operators));
            if let Some(Err(error)) = &smoothed {
                run.warn(format!("the curvature could not be diffused ({error}): taking it as it is"));
            }
            let factor = smoothed.and_then(Result::ok).unwrap_or_else(|| ConformalFactor::new(&operators));
            let hierarchy = ConeHierarchy::new(&operators, &factor);
            let surface = &run.prepared.surfaces[index];
            for (v, phi) in factor.phi.iter_ids() {
                run.found.factor[surface.vertex[v] as usize] = *phi;
            }
            let area = metric.area(&surface.mesh) / surface.scale / surface.scale;
            Ok(Analysed { metric, area, operators, hierarchy })
        })
    }

    fn analyse_all(&mut self) -> Result<Vec<Analysed>, Error> {
        let analysed: Result<Vec<Analysed>, Error> =
            (0..self.prepared.surfaces.len()).map(|index| self.analyse(index)).collect();
        let extrema = analysed.iter().flatten().flat_map(|a| a.hierarchy.extrema());
        self.found.persistence = extrema.map(|e| e.persistence).collect();
        self.found.persistence.sort_by(|a, b| b.total_cmp(a));
        analysed
    }

    /// The cones of each surface that the options ask for.
    fn first_choices(&mut self, analysed: &[Analysed]) -> Result<Vec<Choice>, Error> {
        let least: Vec<usize> = analysed.iter().map(|a| least_cones(&a.operators)).collect();
        let counts = match &self.options.cones {
            ConeChoice::Automatic => return Ok(self.find_number(analysed, TARGET_DISTORTION, MOST_AUTOMATIC)),
            ConeChoice::WithinDistortion(target) => return Ok(self.find_number(analysed, *target, MOST_OPTIMISED)),
            ConeChoice::Count(total) => {
                let needed: usize = least.iter().sum();
                if *total < needed {
                    self.warn(too_few(*total, needed, analysed.len()));
                }
                self.share(analysed, least, *total)
            }
            ConeChoice::MinPersistence(threshold) => {
                let above = |a: &Analysed| a.hierarchy.count_above(&a.operators, *threshold);
                analysed.iter().zip(least).map(|(a, least)| above(a).max(least)).collect()
            }
            ConeChoice::Given(given) => return (0..analysed.len()).map(|index| self.given(index, given)).collect(),
        };
        Ok(counts.into_iter().map(Choice::Count).collect())
    }

    /// As few cones in each surface as keep the predicted area distortion within a target.
    fn find_number(&mut self, analysed: &[Analysed], target: f64, most: usize) -> Vec<Choice> {
        let whole: f64 = analysed.iter().map(|a| a.area).sum();
        let mut number = NumberOfCones { target, predicted: 0.0, is_met: true, curve: Vec::new() };
        let mut choices = Vec::new();
        for (surface, a) in (0..).zip(analysed) {
            let found = self.stage(Stage::Hierarchy, |run| {
                let input = &run.prepared.surfaces[surface].mesh;
                let mut reduced = Reduced::new(&a.operators, input);
                match run.options.method {
                    Method::Refined => automatic(&mut reduced, target, most),
                    method => {
                        let order = a.hierarchy.cones(&a.operators, input, method, most);
                        let order: Vec<VertexId> = order.iter().map(|cone| cone.vertex).collect();
                        shortest(&mut reduced, &order, target)
                    }
                }
            });
            number.predicted += found.predicted.area_distortion * a.area / whole;
            number.is_met &= found.is_met;
            number.curve = found.curve;
            choices.push(Choice::Found(found.set.cones));
        }
        if analysed.len() > 1 {
            number.curve.clear();
        }
        self.found.number = Some(number);
        choices
    }

    /// Shares out cones over the surfaces by what they bring, as far as the method is one that asks for that.
    fn share(&self, analysed: &[Analysed], least: Vec<usize>, total: usize) -> Vec<usize> {
        let spare = total.saturating_sub(least.iter().sum());
        if analysed.len() == 1 || !matches!(self.method(spare), Method::Refined | Method::Pursuit) {
            return share_by_persistence(analysed, least, total);
        }
        let surfaces = self.prepared.surfaces.iter().zip(analysed).zip(&least);
        let part = |((surface, a), &least): ((&Surface, &Analysed), &usize)| {
            Part::new(&mut Reduced::new(&a.operators, &surface.mesh), a.area, least + spare)
        };
        let parts: Vec<Part> = surfaces.map(part).collect();
        share_out(&parts, total).into_iter().zip(least).map(|(count, least)| count.max(least)).collect()
    }

    /// The given cones that lie on a surface.
    fn given(&self, index: usize, given: &[(u32, Option<f64>)]) -> Result<Choice, Error> {
        let surface = &self.prepared.surfaces[index];
        let here: Vec<(VertexId, u32, Option<f64>)> = given
            .iter()
            .filter_map(|&(vertex, k)| {
                let v = surface.vertex.iter().position(|&v| v == vertex)?;
                Some((VertexId::new(v), vertex, k))
            })
            .collect();
        if let Some(&(_, vertex, _)) = here.iter().find(|(v, _, _)| surface.mesh.is_boundary_vertex(*v)) {
            return Err(Error::ConeOnBoundary(vertex));
        }
        let cones = here.iter().map(|&(v, _, _)| v).collect();
        let curvatures: Option<Vec<f64>> = here.iter().map(|&(_, _, k)| k).collect();
        Ok(Choice::Given(cones, curvatures.filter(|k| !k.is_empty())))
    }

    /// Cones with curvatures within bounds. Where the number that was asked for cannot have any, more are taken.
    fn choose(
        &mut self,
        index: usize,
        analysed: &Analysed,
        choice: &Choice,
    ) -> Result<(Vec<Candidate>, ConeCurvatures), Error> {
        self.stage(Stage::Hierarchy, |run| match choice {
            Choice::Count(count) => run.choose_count(index, analysed, *count),
            Choice::Found(cones) => {
                let curvatures = run.curvatures(index, &analysed.operators, cones)?;
                Ok((analysed.hierarchy.candidates(cones), curvatures))
            }
            Choice::Given(cones, curvatures) => run.choose_given(index, analysed, cones, curvatures.clone()),
        })
    }

    fn choose_count(
        &mut self,
        index: usize,
        analysed: &Analysed,
        asked: usize,
    ) -> Result<(Vec<Candidate>, ConeCurvatures), Error> {
        let Analysed { operators, hierarchy, .. } = analysed;
        let mut count = asked;
        loop {
            let input = &self.prepared.surfaces[index].mesh;
            let method = self.method(count);
            let cones = hierarchy.cones(operators, input, method, count);
            let vertices: Vec<VertexId> = cones.iter().map(|c| c.vertex).collect();
            match self.curvatures(index, operators, &vertices) {
                Err(AnglesError::TooFew { .. }) if cones.len() == count => count += 1 + count / 4,
                Err(error) => return Err(error.into()),
                Ok(curvatures) => {
                    if count > MOST_OPTIMISED && method != self.options.method {
                        self.warn(format!("more than {MOST_OPTIMISED} cones are chosen by persistence"));
                    }
                    if count > asked {
                        self.warn(format!("{asked} cones cannot take this surface's curvature: taking {count}"));
                    } else if cones.len() < asked {
                        self.warn(format!(
                            "{asked} cones asked for, but there are only {} inner vertices",
                            cones.len()
                        ));
                    }
                    return Ok((cones, curvatures));
                }
            }
        }
    }

    fn choose_given(
        &mut self,
        index: usize,
        analysed: &Analysed,
        cones: &[VertexId],
        curvatures: Option<Vec<f64>>,
    ) -> Result<(Vec<Candidate>, ConeCurvatures), Error> {
        let Analysed { operators, hierarchy, .. } = analysed;
        let curvatures = match curvatures {
            None => self.curvatures(index, operators, cones)?,
            Some(curvature) => {
                let sum: f64 = curvature.iter().sum();
                let total = operators.total_curvature();
                if !operators.is_bordered() && (sum - total).abs() > 1e-6 {
                    return Err(Error::CurvatureSum { sum, total });
                }
                if let Some(k) = curvature.iter().find(|k| k.is_nan() || **k >= 2.0 * std::f64::consts::PI) {
                    return Err(Error::CurvatureTooLarge(*k));
                }
                ConeCurvatures::given(operators, cones, curvature)
            }
        };
        Ok((hierarchy.candidates(cones), curvatures))
    }

    fn curvatures(
        &mut self,
        index: usize,
        operators: &Operators,
        cones: &[VertexId],
    ) -> Result<ConeCurvatures, AnglesError> {
        let surface = &self.prepared.surfaces[index];
        let curvatures = cone_curvatures(operators, &surface.mesh, cones, self.options.angles)?;
        if !curvatures.out_of_bounds.is_empty() {
            let first = surface.vertex[curvatures.out_of_bounds[0]];
            let count = curvatures.out_of_bounds.len();
            self.warn(format!(
                "harmonic curvature is out of bounds at {count} of {} cones (first at vertex {first}): taking optimal \
                 curvatures within bounds",
                cones.len()
            ));
        }
        Ok(curvatures)
    }

    /// Flattens a surface, with further cones until its area distortion is what was asked for.
    fn flatten_within(&mut self, index: usize, analysed: &Analysed, choice: Choice) -> Result<Flat, Error> {
        let mut flat = self.flatten(index, analysed, choice)?;
        let ConeChoice::WithinDistortion(target) = self.options.cones else { return Ok(flat) };
        let mut reached = area_distortion(&analysed.operators, &flat.scaling.u);
        for _ in 0..MAX_ADDITIONS {
            let count = flat.cones.len();
            if reached <= target || count >= MOST_OPTIMISED {
                break;
            }
            flat = self.flatten(index, analysed, Choice::Count((count + 1 + count / 8).min(MOST_OPTIMISED)))?;
            reached = area_distortion(&analysed.operators, &flat.scaling.u);
        }
        if reached > target {
            self.warn(format!(
                "an area distortion of {target} was not reached: {reached:.3} with {} cones",
                flat.cones.len()
            ));
        }
        Ok(flat)
    }

    /// Flattens a surface. Where a set of cones fails, other numbers are tried, and in the end the surface is unfolded as it
    /// is; given cones are not replaced.
    fn flatten(&mut self, index: usize, analysed: &Analysed, mut choice: Choice) -> Result<Flat, Error> {
        let mut others: Option<std::vec::IntoIter<usize>> = None;
        loop {
            let is_given = matches!(choice, Choice::Given(..));
            let (cones, curvatures) = match self.choose(index, analysed, &choice) {
                Err(error) if !is_given => return self.unfold(index, analysed, &error),
                chosen => chosen?,
            };
            let count = cones.len();
            let stretch = others.as_ref().map(|_| stretch(&analysed.operators, &curvatures));
            let flat = match stretch.filter(|stretch| *stretch > MOST_STRETCH) {
                Some(stretch) => Err(Error::Stretched(stretch)),
                None => self.flatten_with(index, analysed, cones, curvatures),
            };
            let error = match flat {
                Err(error) if !is_given => error,
                done => return done,
            };
            match others.get_or_insert_with(|| other_counts(count, &error).into_iter()).next() {
                Some(other) => {
                    self.warn(format!("{count} cones could not be flattened ({error}): trying {other}"));
                    choice = Choice::Count(other);
                }
                None => return self.unfold(index, analysed, &error),
            }
        }
    }

    /// The last resort: with a cone of its own curvature at every inner vertex a metric is flat as it is. Always there, not
    /// distorted at all, and cut to shreds.
    fn unfold(&mut self, index: usize, analysed: &Analysed, error: &Error) -> Result<Flat, Error> {
        self.warn(format!("a part could not be flattened ({error}): unfolding it with a cone at every vertex"));
        let surface = &self.prepared.surfaces[index];
        let (mesh, metric) = (&surface.mesh, &analysed.metric);
        let defects = angle_defects(mesh, metric);
        let inner: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
        let seams = Seams::new(mesh, &seam_lengths(surface, metric), &inner)?;
        let scaling = Scaling::none(mesh, metric);
        let layout = Layout::new(mesh, &scaling, &seams.cut);
        let curvatures = inner.iter().map(|&v| defects[v]).collect();
        let cones = inner.into_iter().map(|vertex| Candidate { vertex, extremum: None }).collect();
        Ok(Flat { cones, curvatures, seams, scaling, layout })
    }

    fn flatten_with(
        &mut self,
        index: usize,
        analysed: &Analysed,
        cones: Vec<Candidate>,
        curvatures: ConeCurvatures,
    ) -> Result<Flat, Error> {
        let vertices: Vec<VertexId> = cones.iter().map(|c| c.vertex).collect();
        let seams = self.stage(Stage::Cut, |run| {
            let surface = &run.prepared.surfaces[index];
            Seams::new(&surface.mesh, &seam_lengths(surface, &analysed.metric), &vertices)
        })?;
        let scaling = self.stage(Stage::Scale, |run| {
            let mesh = &run.prepared.surfaces[index].mesh;
            let mut target = VertexData::constant(mesh.vertex_count(), 0.0);
            for (&v, &k) in vertices.iter().zip(&curvatures.curvature) {
                target[v] = k;
            }
            scale(mesh, &analysed.metric, &analysed.operators, &target, &curvatures.predicted)
        })?;
        let layout = self.stage(Stage::Layout, |run| {
            let surface = &run.prepared.surfaces[index];
            let mut layout = Layout::new(&surface.mesh, &scaling, &seams.cut);
            let mut is_cone = VertexData::constant(surface.mesh.vertex_count(), false);
            vertices.iter().for_each(|&v| is_cone[v] = true);
            mend(&surface.mesh, &analysed.metric, &scaling, &is_cone, &mut layout).map(|_| layout)
        })?;
        if scaling.mollified {
            self.warn(MOLLIFIED.to_owned());
        }
        Ok(Flat { cones, curvatures: curvatures.curvature, seams, scaling, layout })
    }

    fn note_cones(&mut self, index: usize, cones: &[Candidate], curvatures: &[f64]) {
        let surface = &self.prepared.surfaces[index];
        for (candidate, &curvature) in cones.iter().zip(curvatures) {
            let vertex = surface.vertex[candidate.vertex];
            self.found.cones.push(Cone {
                vertex,
                position: self.model.points()[vertex as usize],
                kind: kind_of(candidate, curvature),
                persistence: candidate.extremum.map(|e: Extremum<_, _>| e.persistence),
                curvature,
            });
        }
    }

    /// Given cones must be vertices of a surface, each once.
    fn check_given(&self) -> Result<(), Error> {
        let ConeChoice::Given(given) = &self.options.cones else { return Ok(()) };
        let mut on_surface = vec![false; self.model.vertex_count()];
        for surface in &self.prepared.surfaces {
            surface.vertex.iter().for_each(|&v| on_surface[v as usize] = true);
        }
        for (k, &(vertex, _)) in given.iter().enumerate() {
            if !on_surface.get(vertex as usize).copied().unwrap_or(false) {
                return Err(Error::NoSuchCone { vertex, count: self.model.vertex_count() });
            }
            if given[..k].iter().any(|&(v, _)| v == vertex) {
                return Err(Error::RepeatedCone(vertex));
            }
        }
        let known = given.iter().filter(|(_, k)| k.is_some()).count();
        if known != 0 && known != given.len() {
            return Err(Error::SomeCurvatures { known, given: given.len() });
        }
        Ok(())
    }

    /// How `count` cones are chosen: a threshold of persistence speaks of extrema by persistence, and so many cones that
    /// optimising them would take minutes are chosen by it too, whatever the method.
    fn method(&self, count: usize) -> Method {
        match (&self.options.cones, self.options.method) {
            (ConeChoice::MinPersistence(_), _) => Method::Persistence,
            (_, Method::Refined | Method::Pursuit) if count > MOST_OPTIMISED => Method::Persistence,
            (_, method) => method,
        }
    }

    fn warn(&mut self, warning: String) {
        if !self.found.warnings.contains(&warning) {
            self.found.warnings.push(warning);
        }
    }
}

/// The cones of each surface, `total` in all: all least sets first, then one by one where area times the persistence of
/// the next extremum is largest. Every total is a prefix.
fn share_by_persistence(analysed: &[Analysed], least: Vec<usize>, total: usize) -> Vec<usize> {
    let mut counts = least;
    let gain = |a: &Analysed, count: usize| a.area * a.hierarchy.extrema().get(count).map_or(0.0, |e| e.persistence);
    for _ in counts.iter().sum()..total {
        let gains = analysed.iter().zip(&counts).map(|(a, &count)| gain(a, count)).enumerate();
        let Some((best, _)) = gains.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))) else { break };
        counts[best] += 1;
    }
    counts
}

fn too_few(asked: usize, needed: usize, parts: usize) -> String {
    let subject = if parts == 1 { "this surface needs".to_owned() } else { format!("these {parts} parts need") };
    format!("{asked} cones asked for, but {subject} at least {needed}: taking {needed}")
}

/// What to try where so many cones cannot be flattened. Metrics that are hard to find get easier with more cones; triangles
/// that stay flipped are needles near cones, of which there are fewer near fewer cones.
fn other_counts(count: usize, error: &Error) -> Vec<usize> {
    match error {
        Error::Mend(_) => vec![count + 1 + count / 4, count / 2, count / 4, 2 * count, 4 * count],
        _ => (1..=4).map(|k| count.max(2) << k).collect(),
    }
}

/// By which factor lengths change most against the mean, as linear theory predicts it.
fn stretch(operators: &Operators, curvatures: &ConeCurvatures) -> f64 {
    let mut u = curvatures.predicted.clone();
    operators.subtract_mean(&mut u);
    u.iter().fold(0.0_f64, |most, u| most.max(u.abs())).exp()
}

/// The lengths that seams count: those of space, but no seam runs inside a polygon.
fn seam_lengths(surface: &Surface, metric: &Metric) -> EdgeData<f64> {
    let length = |(e, &l): (geom::EdgeId, &f64)| if surface.diagonal[e] { f64::INFINITY } else { l };
    metric.lengths().iter_ids().map(length).collect()
}

/// Corners that no surface has get the position of another corner at their vertex, or the origin.
fn fill_corners(model: &Model, uv: Vec<Option<[f64; 2]>>) -> Vec<[f64; 2]> {
    let mut of_vertex = vec![[0.0; 2]; model.vertex_count()];
    for (uv, &v) in uv.iter().zip(model.corners()) {
        if let Some(uv) = uv {
            of_vertex[v as usize] = *uv;
        }
    }
    uv.into_iter().zip(model.corners()).map(|(uv, &v)| uv.unwrap_or(of_vertex[v as usize])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mend::MendError;

    #[test]
    fn more_cones_are_tried_for_a_metric_and_fewer_too_for_needles() {
        assert_eq!(other_counts(8, &Error::Stretched(1e4)), [16, 32, 64, 128]);
        assert_eq!(other_counts(0, &Error::Stretched(1e4)), [4, 8, 16, 32]);
        let flipped = Error::Mend(MendError { faces: 1, vertices: 0, near: vec![VertexId(0)] });
        assert_eq!(other_counts(8, &flipped), [11, 4, 2, 16, 32]);
    }
}
