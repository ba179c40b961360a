//! A component flattened with given cones: one attempt.

use std::time::Instant;

use geom::{FaceId, VertexData, VertexId, angle_defects};
use num_complex::Complex64;

use super::component::Component;
use super::cones::Configuration;
use super::note::Note;
use super::observer::{Stage, Task, Times};
use super::quality::Quality;
use crate::cut::{SeamFigures, SeamPlan};
use crate::error::Error;
use crate::flatten::{
    DetachedShape, Fixed, FoldOvers, Layout, MOST_BENT, Scaling, Seams, detach, narrow_rims, relax, remove_fold_overs,
    scale_by, seam_lengths, stretch, whole_polygons,
};

/// Cones that somebody has chosen are doubted above this area distortion, this quasi-conformal distortion, or where lengths change
/// by more than this power of e against the mean. Four cones on a bunny come to 3.4, 1.1 and 2, three on a coarse sphere to 1.8, 1.5 and 2.3; vertices picked on another
/// mesh, or curvatures near 2π, to far more.
const DOUBTFUL: (f64, f64, f64) = (4.0, 2.0, 5.0);

/// Seams are rigid if the lengths of their two sides differ by no larger share on average.
pub(super) const RIGID_SEAMS: f64 = 1e-6;

/// Detached triangles keep the sides that they have in the layout if none has a larger σ₁/σ₂: thinner ones might come out without area.
const MOST_STRETCH: f64 = 1e3;
/// And if the logarithms of the distortions, added up, grow by no more than this. On `turbine` with 16 cones 18 triangles are detached, and
/// quasi-conformal distortion goes from 1.1458 to 1.1473; on needles (`thingi520644`, not refined) from 1.19 to 2.0.
const RIGID: f64 = 0.01;

/// A flattened component.
#[derive(Clone)]
pub(crate) struct Flat {
    pub(crate) cones: Vec<VertexId>,
    pub(crate) curvature: Vec<f64>,
    pub(crate) seams: Seams,
    pub(crate) layout: Layout,
    /// The log scale factor of each vertex as linear theory predicts it.
    pub(crate) predicted: VertexData<f64>,
    /// The log scale factor of each vertex.
    u: VertexData<f64>,
    /// The largest curvature left beside the cones, in radians.
    pub(crate) error: f64,
    /// What to multiply the layout by so that its mean log scale is 0 in the model's units.
    pub(crate) size: f64,
    pub(crate) quality: Quality,
    /// What it is compared by: its worth, or what that will be with free seams.
    pub(crate) promised: Quality,
    /// Whether areas come out worse than was asked for and predicted, for triangles too coarse for what they are to scale.
    pub(crate) misses_areas: bool,
    /// The layout with free seams that promises it.
    pub(crate) freed: Option<Freed>,
    /// What is folded over.
    pub(crate) fold_overs: Option<FoldOvers>,
    /// The triangles that were detached.
    pub(crate) detached: Vec<FaceId>,
    /// The triangles that lay over others before islands were parted.
    pub(crate) overlapped: Vec<FaceId>,
    /// Whether each inner vertex is a cone.
    pub(crate) is_unfolded: bool,
    /// Whether seams became loose so that triangles could be unfolded.
    pub(crate) is_loose: bool,
    pub(crate) notes: Vec<Note>,
}

/// A layout with free seams.
#[derive(Clone)]
pub(crate) struct Freed {
    /// The positions that it was found from.
    pub(crate) from: Vec<Complex64>,
    pub(crate) layout: Layout,
    pub(crate) quality: Quality,
}

impl Component {
    /// Flattens with given cones: cut, metric, layout, and fold-overs removed as far as possible.
    ///
    /// # Errors
    /// If the surface cannot be cut open, no metric is found, or the observer has said stop.
    pub(crate) fn flatten(
        &self,
        configuration: &Configuration,
        (plan, may_loosen): (&SeamPlan, bool),
        task: &Task,
        times: &mut Times,
    ) -> Result<Flat, Error> {
        let Self { index, surface, metric, operators, .. } = self;
        let mesh = &surface.mesh;
        let whole = self.whole();
        let Configuration { vertices, curvature, predicted, notes } = configuration;
        let began = Instant::now();
        let (mut of_cut, mut of_scale) = (Times::default(), Times::default());
        // Neither needs the other.
        let (seams, scaling) = rayon::join(
            || task.stage((Stage::Cut, *index), &mut of_cut, |watch| self.cut_whole(plan, vertices, watch)),
            || {
                task.stage((Stage::Scale, *index), &mut of_scale, |watch| {
                    let mut target = VertexData::constant(mesh.vertex_count(), 0.0);
                    for (&v, &k) in vertices.iter().zip(curvature) {
                        target[v] = k;
                    }
                    let factor = operators.factor_again(watch)?;
                    // Other attempts would need it, but few surfaces have any.
                    self.let_factor_go();
                    scale_by(factor, (whole.0, whole.1, operators), &target, predicted, watch)
                })
            },
        );
        *times += Times::on_clock([of_cut, of_scale], began.elapsed());
        let (whole, mut scaling) = (seams??, scaling??);
        let mut notes = notes.clone();
        if scaling.mollified {
            notes.push(Note::Mollified { component: *index });
        }
        task.stage((Stage::Layout, *index), times, |watch| -> Result<Flat, Error> {
            let seams = self.own_seams(&whole, plan, vertices);
            let mut layout = self.lay_out(&mut scaling, (&whole, &seams), watch.within(0.0, 0.3))?;
            let of_loop = self.handles.of_vertex.as_ref();
            let is_side = of_loop.map(|of_loop| of_loop.iter().map(Option::is_some).collect());
            let is_cone = VertexData::constant(mesh.vertex_count(), false);
            let mut fixed = Fixed { is_cone, is_side, may_loosen };
            vertices.iter().for_each(|&v| fixed.is_cone[v] = true);
            let removed = remove_fold_overs(mesh, metric, &scaling, &fixed, &mut layout, watch.within(0.3, 0.9));
            watch.ask(0.9)?;
            let mut quality = Quality::of(mesh, metric, &layout);
            if quality.bent_share > MOST_BENT {
                relax(mesh, metric, &scaling, &fixed, &mut layout, watch.within(0.9, 1.0));
                watch.ask(1.0)?;
                quality = Quality::of(mesh, metric, &layout);
            }
            if narrow_rims(mesh, metric, &scaling, &fixed, &mut layout, watch.within(1.0, 1.0)) > 0 {
                quality = Quality::of(mesh, metric, &layout);
            }
            watch.ask(1.0)?;
            let is_loose =
                may_loosen && SeamFigures::laid_out(surface, metric, &seams, &layout).mean_mismatch() > RIGID_SEAMS;
            let flat = self.flat((vertices.clone(), curvature.clone()), seams, (layout, quality), scaling, notes);
            Ok(Flat { fold_overs: removed.err(), predicted: predicted.clone(), is_loose, ..flat })
        })?
    }

    /// The last resort: with a cone of its own curvature at every inner vertex a metric is flat as it is. Always there, not
    /// distorted at all, and cut to shreds.
    ///
    /// # Errors
    /// If the surface cannot be cut open.
    pub(crate) fn unfold(&self, plan: &SeamPlan, task: &Task, times: &mut Times) -> Result<Flat, Error> {
        let (mesh, metric) = self.whole();
        let defects = angle_defects(mesh, metric);
        let inner: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
        let whole = task.stage((Stage::Cut, self.index), times, |watch| self.cut_whole(plan, &inner, watch))??;
        task.stage((Stage::Layout, self.index), times, |watch| -> Result<Flat, Error> {
            let mut scaling = Scaling::none(mesh, metric);
            let seams = self.own_seams(&whole, plan, &inner);
            let layout = self.lay_out(&mut scaling, (&whole, &seams), watch)?;
            let curvature = inner.iter().map(|&v| defects[v]).collect();
            let quality = Quality::of(&self.surface.mesh, &self.metric, &layout);
            Ok(Flat {
                is_unfolded: true,
                ..self.flat((inner, curvature), seams, (layout, quality), scaling, Vec::new())
            })
        })?
    }

    /// Says where seams run that were to be avoided.
    pub(super) fn note_avoided(&self, plan: &SeamPlan, seams: &Seams) -> Option<Note> {
        let (edges, first) = plan.avoided(seams)?;
        let ends = self.surface.mesh.ends(first).map(|v| self.surface.vertex[v]);
        Some(Note::AvoidedCut { component: self.index, edges, first: ends })
    }

    fn flat(
        &self,
        (cones, curvature): (Vec<VertexId>, Vec<f64>),
        seams: Seams,
        (layout, quality): (Layout, Quality),
        scaling: Scaling,
        notes: Vec<Note>,
    ) -> Flat {
        let mean: f64 = self.operators.weight.iter().zip(scaling.u.iter()).map(|(w, u)| w * u).sum();
        let Scaling { u, error, .. } = scaling;
        Flat {
            cones,
            curvature,
            seams,
            layout,
            // Nothing is distorted, unless cones were placed.
            predicted: VertexData::constant(u.len(), 0.0),
            u,
            error,
            size: (-mean).exp() / self.surface.scale,
            promised: quality.clone(),
            misses_areas: false,
            freed: None,
            quality,
            fold_overs: None,
            detached: Vec::new(),
            overlapped: Vec::new(),
            is_unfolded: false,
            is_loose: false,
            notes,
        }
    }

    /// What there is to say of cones that nobody may replace, if the map that they make is a bad one. At cones that were placed lengths
    /// may change by more: they are as sharp as pays.
    pub(crate) fn doubt(&self, flat: &Flat, are_given: bool) -> Option<Note> {
        let (most_area, most_angle, most_log) = DOUBTFUL;
        let log = flat.quality.largest_log_scale();
        let (area, angles) = (flat.quality.area_distortion(), flat.quality.quasi_conformal);
        let is_good = area <= most_area && angles <= most_angle && (log <= most_log || !are_given);
        let component = self.index;
        (!is_good).then_some(Note::Distorted { component, area, angles, log })
    }

    /// Makes an island, as flat as it is, of each polygon that these triangles are in.
    pub(crate) fn detach_polygons(&self, flat: &mut Flat, faces: &[FaceId]) {
        let lengths = seam_lengths(&self.surface, &self.metric);
        let mesh = &self.surface.mesh;
        let whole = whole_polygons(mesh, &lengths, faces);
        let faces = (&whole[..], DetachedShape::AsInSpace);
        detach(mesh, &self.metric, &flat.u, &lengths, faces, &mut flat.seams, &mut flat.layout);
        flat.quality = Quality::of(mesh, &self.metric, &flat.layout);
        flat.detached.extend(whole.into_iter().filter(|f| !flat.detached.contains(f)).collect::<Vec<_>>());
    }

    /// Makes islands of the triangles that stay folded over, if there are any.
    pub(crate) fn detach_fold_overs(&self, flat: &mut Flat) {
        let Some(fold_overs) = flat.fold_overs.take() else { return };
        let lengths = seam_lengths(&self.surface, &self.metric);
        let mesh = &self.surface.mesh;
        let detached = |shape: DetachedShape| {
            let (mut seams, mut layout) = (flat.seams.clone(), flat.layout.clone());
            let faces = (&fold_overs.bad[..], shape);
            detach(mesh, &self.metric, &flat.u, &lengths, faces, &mut seams, &mut layout);
            let quality = Quality::of(mesh, &self.metric, &layout);
            (seams, layout, quality)
        };
        let [rigid, mut best] = [DetachedShape::AsLaidOut, DetachedShape::AsInSpace].map(detached);
        let most = fold_overs.bad.iter().map(|&f| {
            let corners = mesh.sides(f).map(|h| rigid.1.corner(h));
            stretch(self.metric.sides(mesh, f), corners).map_or(f64::INFINITY, |[stretch, _]| stretch)
        });
        if most.fold(1.0, f64::max) <= MOST_STRETCH && rigid.2.cost() <= best.2.cost() + RIGID {
            best = rigid;
        }
        (flat.seams, flat.layout, flat.quality) = best;
        flat.notes.push(Note::Detached {
            component: self.index,
            triangles: fold_overs.bad.len(),
            first: self.surface.vertex[fold_overs.near[0]],
        });
        flat.detached = fold_overs.bad;
    }
}
