//! One connected surface of a model, from its operators to its layout.
//!
//! Components know nothing of each other, so they can be worked on at the same time.

use std::time::{Duration, Instant};

use geom::{Id, Metric, PoissonError, Surface, VertexData, VertexId, angle_defects};

use crate::angles::{AnglesError, ConeCurvatures, cone_curvatures};
use crate::atlas::Stage;
use crate::detach::detach;
use crate::distortion::area_distortion;
use crate::error::Error;
use crate::factor::ConformalFactor;
use crate::hierarchy::{Candidate, ConeHierarchy, Method};
use crate::layout::Layout;
use crate::mend::{MendError, mend};
use crate::operators::Operators;
use crate::options::{ConeChoice, Options};
use crate::scaling::{Scaling, scale};
use crate::seams::{Seams, seam_lengths};

/// More cones than this are not optimised: `refined` takes a time that grows with the third power of their number.
pub(crate) const MOST_OPTIMISED: usize = 64;
/// So many times cones are added where a measured distortion is above the one that was asked for.
const MAX_ADDITIONS: usize = 6;
/// Where the cones that were asked for have failed, others are not tried if linear theory predicts that with them somewhere
/// lengths change by more than this factor against the mean. A scan whose noise has made tiny handles comes there, and
/// Newton's method would take long to fail again.
const MOST_STRETCH: f64 = 3000.0;
/// Where no more than one triangle in so many stays flipped, it is better to detach these than to try other cones.
const DETACHED_AT_ONCE: usize = 1000;
/// What is said where lengths were mollified.
const MOLLIFIED: &str = "edges were lengthened by up to 1e-4 of their mean, because of needle triangles";

/// Told of each stage as it begins, by whichever thread begins it.
pub(crate) type OnStage<'a> = &'a (dyn Fn(Stage) + Sync);

/// A connected surface with all that is needed to choose cones.
pub(crate) struct Component<'a> {
    options: &'a Options,
    pub(crate) surface: &'a Surface,
    metric: Metric,
    /// The area in the model's units.
    pub(crate) area: f64,
    pub(crate) operators: Operators,
    /// φ
    pub(crate) factor: VertexData<f64>,
    pub(crate) hierarchy: ConeHierarchy,
    pub(crate) record: Record<'a>,
}

/// The time each stage took, and what the user should know.
pub(crate) struct Record<'a> {
    pub(crate) on_stage: OnStage<'a>,
    pub(crate) times: Vec<(Stage, Duration)>,
    pub(crate) warnings: Vec<String>,
}

impl<'a> Record<'a> {
    pub(crate) fn new(on_stage: OnStage<'a>) -> Self {
        Self { on_stage, times: Stage::ALL.map(|stage| (stage, Duration::ZERO)).to_vec(), warnings: Vec::new() }
    }

    pub(crate) fn begin(&self, stage: Stage) -> Instant {
        (self.on_stage)(stage);
        Instant::now()
    }

    pub(crate) fn end(&mut self, stage: Stage, began: Instant) {
        self.times.iter_mut().filter(|(s, _)| *s == stage).for_each(|(_, time)| *time += began.elapsed());
    }

    pub(crate) fn warn(&mut self, warning: String) {
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    /// Adds the times and the new warnings of another.
    pub(crate) fn absorb(&mut self, other: Record) {
        self.times.iter_mut().zip(other.times).for_each(|((_, sum), (_, time))| *sum += time);
        other.warnings.into_iter().for_each(|warning| self.warn(warning));
    }
}

/// A flattened surface.
pub(crate) struct Flat {
    pub(crate) cones: Vec<Candidate>,
    pub(crate) curvatures: Vec<f64>,
    pub(crate) seams: Seams,
    pub(crate) layout: Layout,
    /// The log scale factor of each vertex.
    u: VertexData<f64>,
    /// The largest curvature left beside the cones, in radians.
    pub(crate) error: f64,
    /// What to multiply the layout by so that its mean log scale is 0 in the model's units.
    pub(crate) size: f64,
    /// The area distortion that the log scale factors make.
    distortion: f64,
    /// Whether no cones could flatten the surface, so that each inner vertex is one.
    pub(crate) is_unfolded: bool,
}

/// Cones to begin with.
pub(crate) enum Choice {
    /// So many of the hierarchy.
    Count(usize),
    /// These, or others where they fail.
    Found(Vec<VertexId>),
    /// These, perhaps with curvatures.
    Given(Vec<VertexId>, Option<Vec<f64>>),
}

impl Choice {
    pub(crate) fn count(&self) -> usize {
        match self {
            Self::Count(count) => *count,
            Self::Found(cones) | Self::Given(cones, _) => cones.len(),
        }
    }
}

impl<'a> Component<'a> {
    pub(crate) fn new(options: &'a Options, surface: &'a Surface, on_stage: OnStage<'a>) -> Result<Self, Error> {
        let mut record = Record::new(on_stage);
        let began = record.begin(Stage::Factor);
        let mut metric = surface.metric();
        let operators = match Operators::with_points(&surface.mesh, &metric, &surface.points) {
            Err(PoissonError::NotPositiveDefinite) => {
                metric = metric.mollified(&surface.mesh, Metric::MOLLIFICATION);
                record.warn(MOLLIFIED.to_owned());
                Operators::with_points(&surface.mesh, &metric, &surface.points)?
            }
            operators => operators?,
        };
        record.end(Stage::Factor, began);
        let began = record.begin(Stage::Hierarchy);
        let smoothed = options.smooth.then(|| ConformalFactor::smoothed(&operators));
        if let Some(Err(error)) = &smoothed {
            record.warn(format!("the curvature could not be diffused ({error}): taking it as it is"));
        }
        let factor = smoothed.and_then(Result::ok).unwrap_or_else(|| ConformalFactor::new(&operators));
        let hierarchy = ConeHierarchy::new(&operators, &factor);
        let area = metric.area(&surface.mesh) / surface.scale / surface.scale;
        record.end(Stage::Hierarchy, began);
        Ok(Self { options, surface, metric, area, operators, factor: factor.phi, hierarchy, record })
    }

    /// Runs a stage and adds up its time.
    pub(crate) fn stage<T>(&mut self, stage: Stage, work: impl FnOnce(&mut Self) -> T) -> T {
        let began = self.record.begin(stage);
        let done = work(self);
        self.record.end(stage, began);
        done
    }

    fn warn(&mut self, warning: String) {
        self.record.warn(warning);
    }

    /// The given cones that lie on this surface.
    pub(crate) fn given(&self, given: &[(u32, Option<f64>)]) -> Result<Choice, Error> {
        let surface = self.surface;
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
    pub(crate) fn choose(&mut self, choice: &Choice) -> Result<(Vec<Candidate>, ConeCurvatures), Error> {
        self.stage(Stage::Hierarchy, |this| match choice {
            Choice::Count(count) => this.choose_count(*count),
            Choice::Found(cones) => Ok((this.hierarchy.candidates(cones), this.curvatures(cones)?)),
            Choice::Given(cones, curvatures) => this.choose_given(cones, curvatures.clone()),
        })
    }

    fn choose_count(&mut self, asked: usize) -> Result<(Vec<Candidate>, ConeCurvatures), Error> {
        let mut count = asked;
        loop {
            let method = self.options.method_for(count);
            let cones = self.hierarchy.cones(&self.operators, &self.surface.mesh, method, count);
            let vertices: Vec<VertexId> = cones.iter().map(|c| c.vertex).collect();
            match self.curvatures(&vertices) {
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
        cones: &[VertexId],
        curvatures: Option<Vec<f64>>,
    ) -> Result<(Vec<Candidate>, ConeCurvatures), Error> {
        let curvatures = match curvatures {
            None => self.curvatures(cones)?,
            Some(curvature) => {
                let sum: f64 = curvature.iter().sum();
                let total = self.operators.total_curvature();
                if !self.operators.is_bordered() && (sum - total).abs() > 1e-6 {
                    return Err(Error::CurvatureSum { sum, total });
                }
                if let Some(k) = curvature.iter().find(|k| k.is_nan() || **k >= 2.0 * std::f64::consts::PI) {
                    return Err(Error::CurvatureTooLarge(*k));
                }
                ConeCurvatures::given(&self.operators, cones, curvature)
            }
        };
        Ok((self.hierarchy.candidates(cones), curvatures))
    }

    fn curvatures(&mut self, cones: &[VertexId]) -> Result<ConeCurvatures, AnglesError> {
        let curvatures = cone_curvatures(&self.operators, &self.surface.mesh, cones, self.options.angles)?;
        if !curvatures.out_of_bounds.is_empty() {
            let first = self.surface.vertex[curvatures.out_of_bounds[0]];
            let count = curvatures.out_of_bounds.len();
            self.warn(format!(
                "harmonic curvature is out of bounds at {count} of {} cones (first at vertex {first}): taking optimal \
                 curvatures within bounds",
                cones.len()
            ));
        }
        Ok(curvatures)
    }

    /// Flattens the surface, with further cones until its area distortion is what was asked for.
    pub(crate) fn flatten_within(&mut self, choice: Choice) -> Result<Flat, Error> {
        let mut flat = self.flatten(choice)?;
        let ConeChoice::WithinDistortion(target) = self.options.cones else { return Ok(flat) };
        for _ in 0..MAX_ADDITIONS {
            let count = flat.cones.len();
            if flat.distortion <= target || count >= MOST_OPTIMISED {
                break;
            }
            flat = self.flatten(Choice::Count((count + 1 + count / 8).min(MOST_OPTIMISED)))?;
        }
        if flat.distortion > target {
            self.warn(format!(
                "an area distortion of {target} was not reached: {:.3} with {} cones",
                flat.distortion,
                flat.cones.len()
            ));
        }
        Ok(flat)
    }

    /// Flattens the surface. Where a set of cones fails, other numbers are tried; given cones are not replaced. In the end
    /// what stays flipped is detached, or the surface unfolded as it is.
    fn flatten(&mut self, mut choice: Choice) -> Result<Flat, Error> {
        let mut others: Option<std::vec::IntoIter<usize>> = None;
        let mut best: Option<(Flat, MendError)> = None;
        loop {
            let is_given = matches!(choice, Choice::Given(..));
            let (cones, curvatures) = match self.choose(&choice) {
                Err(error) if !is_given => return self.unfold(&error),
                chosen => chosen?,
            };
            let count = cones.len();
            let stretch = others.as_ref().map(|_| stretch(&self.operators, &curvatures));
            let error = match stretch.filter(|stretch| *stretch > MOST_STRETCH) {
                Some(stretch) => Error::Stretched(stretch),
                None => match self.flatten_with(cones, curvatures) {
                    Ok((flat, None)) => return Ok(flat),
                    Ok((flat, Some(flipped))) => {
                        if is_given || flipped.bad.len() <= self.surface.mesh.face_count() / DETACHED_AT_ONCE {
                            return Ok(self.detach(flat, &flipped));
                        }
                        if best.as_ref().is_none_or(|(_, least)| flipped.bad.len() < least.bad.len()) {
                            best = Some((flat, flipped.clone()));
                        }
                        flipped.into()
                    }
                    Err(error) if is_given => return Err(error),
                    Err(error) => error,
                },
            };
            match others.get_or_insert_with(|| other_counts(count, &error).into_iter()).next() {
                Some(other) => {
                    self.warn(format!("{count} cones could not be flattened ({error}): trying {other}"));
                    choice = Choice::Count(other);
                }
                None => {
                    return match best {
                        Some((flat, flipped)) => Ok(self.detach(flat, &flipped)),
                        None => self.unfold(&error),
                    };
                }
            }
        }
    }

    /// Makes islands of the triangles that stay flipped.
    fn detach(&mut self, mut flat: Flat, flipped: &MendError) -> Flat {
        self.warn(format!("{flipped}: {} triangles there are islands of their own", flipped.bad.len()));
        let Flat { seams, layout, u, .. } = &mut flat;
        let lengths = seam_lengths(self.surface, &self.metric);
        detach(&self.surface.mesh, &self.metric, u, &lengths, &flipped.bad, seams, layout);
        flat
    }

    /// The last resort: with a cone of its own curvature at every inner vertex a metric is flat as it is. Always there, not
    /// distorted at all, and cut to shreds.
    fn unfold(&mut self, error: &Error) -> Result<Flat, Error> {
        self.warn(format!("a part could not be flattened ({error}): unfolding it with a cone at every vertex"));
        let mesh = &self.surface.mesh;
        let defects = angle_defects(mesh, &self.metric);
        let inner: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
        let seams = Seams::of_surface(self.surface, &self.metric, &inner)?;
        let scaling = Scaling::none(mesh, &self.metric);
        let layout = Layout::new(mesh, &scaling, &seams.cut);
        let curvatures = inner.iter().map(|&v| defects[v]).collect();
        let cones = inner.into_iter().map(|vertex| Candidate { vertex, extremum: None }).collect();
        Ok(Flat { is_unfolded: true, ..self.flat(cones, curvatures, seams, layout, scaling) })
    }

    /// A flattening, and what stays flipped in it.
    fn flatten_with(
        &mut self,
        cones: Vec<Candidate>,
        curvatures: ConeCurvatures,
    ) -> Result<(Flat, Option<MendError>), Error> {
        let vertices: Vec<VertexId> = cones.iter().map(|c| c.vertex).collect();
        let mesh = &self.surface.mesh;
        let seams = self.stage(Stage::Cut, |this| Seams::of_surface(this.surface, &this.metric, &vertices))?;
        let scaling = self.stage(Stage::Scale, |this| {
            let mut target = VertexData::constant(mesh.vertex_count(), 0.0);
            for (&v, &k) in vertices.iter().zip(&curvatures.curvature) {
                target[v] = k;
            }
            scale(mesh, &this.metric, &this.operators, &target, &curvatures.predicted)
        })?;
        let (layout, mended) = self.stage(Stage::Layout, |this| {
            let mut layout = Layout::new(mesh, &scaling, &seams.cut);
            let mut is_cone = VertexData::constant(mesh.vertex_count(), false);
            vertices.iter().for_each(|&v| is_cone[v] = true);
            let mended = mend(mesh, &this.metric, &scaling, &is_cone, &mut layout);
            (layout, mended)
        });
        if scaling.mollified {
            self.warn(MOLLIFIED.to_owned());
        }
        Ok((self.flat(cones, curvatures.curvature, seams, layout, scaling), mended.err()))
    }

    fn flat(
        &self,
        cones: Vec<Candidate>,
        curvatures: Vec<f64>,
        seams: Seams,
        layout: Layout,
        scaling: Scaling,
    ) -> Flat {
        let mean: f64 = self.operators.weight.iter().zip(scaling.u.iter()).map(|(w, u)| w * u).sum();
        let size = (-mean).exp() / self.surface.scale;
        let distortion = area_distortion(&self.operators, &scaling.u);
        let Scaling { u, error, .. } = scaling;
        Flat { cones, curvatures, seams, layout, u, error, size, distortion, is_unfolded: false }
    }
}

impl Options {
    /// How `count` cones are chosen: a threshold of persistence speaks of extrema by persistence, and so many cones that
    /// optimising them would take minutes are chosen by it too, whatever the method.
    pub(crate) fn method_for(&self, count: usize) -> Method {
        match (&self.cones, self.method) {
            (ConeChoice::MinPersistence(_), _) => Method::Persistence,
            (_, Method::Refined | Method::Pursuit) if count > MOST_OPTIMISED => Method::Persistence,
            (_, method) => method,
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mend::MendError;
    use crate::unwrap;
    use geom::{Model, shapes};
    use std::f64::consts::PI;

    fn model(parts: &[shapes::Shape]) -> Model {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for part in parts {
            let first = points.len() as u32;
            points.extend_from_slice(&part.points);
            triangles.extend(part.triangles.iter().map(|t| t.map(|v| first + v)));
        }
        Model::from_triangles(points, &triangles).unwrap()
    }

    fn area(points: [[f64; 3]; 3]) -> f64 {
        let sides = [0, 1].map(|k| [0, 1, 2].map(|i| points[k + 1][i] - points[0][i]));
        let [a, b] = sides;
        0.5 * (0..3).map(|i| (a[i] * b[(i + 1) % 3] - a[(i + 1) % 3] * b[i]).powi(2)).sum::<f64>().sqrt()
    }

    #[test]
    fn a_bordered_surface_takes_any_given_curvature_and_a_closed_one_only_all_of_its_own() {
        let given = |shape: shapes::Shape, curvatures: [f64; 3]| {
            let cones = [70, 150, 230].into_iter().zip(curvatures.map(Some)).collect();
            unwrap(&model(&[shape]), &Options { cones: ConeChoice::Given(cones), ..Options::default() }, &mut |_| ())
        };
        let hill = given(shapes::terrain(400, 2), [0.3, -0.2, 0.1]).unwrap();
        assert_eq!(hill.cones.iter().map(|cone| cone.curvature).collect::<Vec<_>>(), [0.3, -0.2, 0.1]);
        assert!(given(shapes::sphere(400), [1.5 * PI, 1.5 * PI, PI]).is_ok());
        let wrong = given(shapes::sphere(400), [1.0, 1.0, 1.0]).unwrap_err();
        assert!(matches!(wrong, Error::CurvatureSum { .. }), "{wrong}");
        let wide = given(shapes::terrain(400, 2), [7.0, 0.0, 0.0]).unwrap_err();
        assert!(matches!(wide, Error::CurvatureTooLarge(_)), "{wide}");
    }

    #[test]
    fn several_parts_get_as_many_cones_as_are_asked_for() {
        let model = model(&[shapes::hare(300), shapes::sphere(200)]);
        for method in [Method::Refined, Method::Pursuit, Method::Persistence] {
            for count in [6, 7, 9, 12] {
                let options = Options { cones: ConeChoice::Count(count), method, ..Options::default() };
                let found = crate::extract(&model, &options, &mut |_| ()).unwrap();
                assert_eq!(found.cones.len(), count, "{method:?}");
            }
        }
    }

    #[test]
    fn the_parts_of_a_model_are_laid_out_at_one_scale() {
        let parts = [shapes::hare(500), shapes::terrain(400, 2), shapes::sphere(300)];
        let ends: Vec<usize> = parts
            .iter()
            .scan(0, |end, part| {
                *end += part.triangles.len();
                Some(*end)
            })
            .collect();
        let model = model(&parts);
        let options = Options { cones: ConeChoice::Count(9), ..Options::default() };
        let atlas = unwrap(&model, &options, &mut |_| ()).unwrap();
        // For each part the mean of the log scale.
        let mut sums = [[0.0; 2]; 3];
        for (t, corners) in atlas.triangles.corners.iter().enumerate() {
            let part = ends.iter().position(|&end| t < end).unwrap();
            let here = area(corners.map(|c| model.points()[model.corners()[c as usize] as usize]));
            let there = area(corners.map(|c| [atlas.uv[c as usize][0], atlas.uv[c as usize][1], 0.0]));
            sums[part][0] += here;
            sums[part][1] += here * 0.5 * (there / here).ln();
        }
        let means = sums.map(|[area, sum]| sum / area);
        assert!(means.iter().all(|mean| (mean - means[0]).abs() < 0.01), "{means:?}");
    }

    #[test]
    fn more_cones_are_tried_for_a_metric_and_fewer_too_for_needles() {
        assert_eq!(other_counts(8, &Error::Stretched(1e4)), [16, 32, 64, 128]);
        assert_eq!(other_counts(0, &Error::Stretched(1e4)), [4, 8, 16, 32]);
        let flipped = Error::Mend(MendError { faces: 1, vertices: 0, near: vec![VertexId(0)], bad: Vec::new() });
        assert_eq!(other_counts(8, &flipped), [11, 4, 2, 16, 32]);
    }
}
