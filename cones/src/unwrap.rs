//! The whole method: the stages in order, nothing else.
//!
//! Connected components are worked on at the same time, on the threads of the current rayon pool; what comes out does not
//! depend on how many there are.

use std::collections::HashMap;
use std::sync::Mutex;

use geom::{Model, Prepared, Repair, VertexId, prepare};
use rayon::prelude::*;
use topo::Extremum;

use crate::angles::{Angles, ConeCurvatures, least_cones};
use crate::atlas::{Atlas, Cone, Extraction, NumberOfCones, Stage, Topology};
use crate::automatic::{Automatic, MOST_AUTOMATIC, TARGET_DISTORTION, automatic, shortest};
use crate::component::{Choice, Component, MOST_OPTIMISED, OnStage, Record};
use crate::distortion::{Predicted, Whole};
use crate::error::Error;
use crate::hierarchy::{Candidate, Method, kind_of};
use crate::options::{ConeChoice, Options};
use crate::order::{ConeOrder, cone_order, counts, whole_curve};
use crate::pursuit::Nested;
use crate::reduced::Reduced;
use crate::seams::Chain;
use crate::settled::Settled;
use crate::shelf::Shelf;

/// An order of cones is found for so many in all, or for so many more than the parts of a model need.
const ORDERED: usize = 64;
const ORDERED_MORE: usize = 32;

/// Unwraps a model: cones, seams, flattening. `on_stage` hears of each stage as it begins, in any part of the model.
///
/// # Errors
/// If the model has no surface, or one that cannot be flattened.
pub fn unwrap(model: &Model, options: &Options, on_stage: &mut (dyn FnMut(Stage) + Send)) -> Result<Atlas, Error> {
    with_shared(on_stage, |on_stage| {
        let (prepared, record) = begin(model, options, on_stage)?;
        let (mut found, mut components, choices) = choose(model, &prepared, options, record)?;
        let flats = each(&mut components, choices, Component::flatten_within)?;
        let mut uv = vec![None; model.corner_count()];
        let mut seams = Vec::new();
        let mut curvature_error = 0.0_f64;
        let mut unfolded = 0;
        let mut shelf = Shelf::new(components.iter().map(|c| c.area).sum());
        for (component, flat) in components.into_iter().zip(flats) {
            let surface = component.surface;
            curvature_error = curvature_error.max(flat.error);
            unfolded += usize::from(flat.is_unfolded);
            for (h, position) in shelf.place(&flat.layout, &surface.mesh, flat.size).iter_ids() {
                uv[surface.corner[h] as usize] = Some(*position);
            }
            let of_model = |chain: &Chain| chain.vertices.iter().map(|&v| surface.vertex[v]).collect();
            seams.extend(flat.seams.chains.iter().map(of_model));
            found.take(model, component, &flat.cones, &flat.curvatures);
        }
        let uv = fill_corners(model, &prepared, uv);
        let Extraction { cones, factor, persistence, number, order, topology, times, repairs, warnings } =
            found.extraction(prepared.repairs);
        Ok(Atlas {
            uv,
            triangles: prepared.triangles,
            left_out: prepared.left_out,
            cones,
            seams,
            factor,
            persistence,
            number,
            order,
            topology,
            curvature_error,
            unfolded,
            times,
            repairs,
            warnings,
        })
    })
}

/// Finds a model's cones as [`unwrap`] would, without flattening it.
///
/// # Errors
/// If the model has no surface, or one whose Laplacian cannot be factored.
pub fn extract(
    model: &Model,
    options: &Options,
    on_stage: &mut (dyn FnMut(Stage) + Send),
) -> Result<Extraction, Error> {
    with_shared(on_stage, |on_stage| {
        let (prepared, record) = begin(model, options, on_stage)?;
        let (mut found, mut components, choices) = choose(model, &prepared, options, record)?;
        let chosen = each(&mut components, choices, |component, choice| component.choose(&choice))?;
        for (component, (cones, ConeCurvatures { curvature, .. })) in components.into_iter().zip(chosen) {
            found.take(model, component, &cones, &curvature);
        }
        Ok(found.extraction(prepared.repairs))
    })
}

/// Lets several threads tell the listener of stages.
fn with_shared<T>(on_stage: &mut (dyn FnMut(Stage) + Send), work: impl FnOnce(OnStage) -> T) -> T {
    let listener = Mutex::new(on_stage);
    // A listener that has panicked hears no more.
    work(&|stage| {
        if let Ok(mut on_stage) = listener.lock() {
            on_stage(stage);
        }
    })
}

/// The model made into surfaces; what the options say about its vertices is right.
fn begin<'a>(model: &Model, options: &Options, on_stage: OnStage<'a>) -> Result<(Prepared, Record<'a>), Error> {
    let mut record = Record::new(on_stage);
    let began = record.begin(Stage::Prepare);
    let prepared = prepare(model, options.weld)?;
    record.end(Stage::Prepare, began);
    check_given(model, options, &prepared)?;
    Ok((prepared, record))
}

/// The components with the cones to begin with, and what is told of them so far.
fn choose<'a, 'b: 'a>(
    model: &Model,
    prepared: &'a Prepared,
    options: &'a Options,
    record: Record<'b>,
) -> Result<(Found<'b>, Vec<Component<'a>>, Vec<Choice>), Error> {
    let surfaces = prepared.surfaces.par_iter().with_max_len(1);
    let components: Vec<Result<Component, Error>> =
        surfaces.map(|surface| Component::new(options, surface, record.on_stage)).collect();
    let mut components = components.into_iter().collect::<Result<Vec<Component>, Error>>()?;
    let mut found = Found::new(model, &components, record);
    let choices = found.first_choices(options, &mut components)?;
    found.note_order(options, &components, &choices);
    Ok((found, components, choices))
}

/// Does the same with each component; the first error in the components' order.
fn each<'a, I: Send, T: Send>(
    components: &mut [Component<'a>],
    inputs: Vec<I>,
    work: impl Fn(&mut Component<'a>, I) -> Result<T, Error> + Sync,
) -> Result<Vec<T>, Error> {
    let pairs = components.par_iter_mut().zip(inputs).with_max_len(1);
    let done: Vec<Result<T, Error>> = pairs.map(|(component, input)| work(component, input)).collect();
    done.into_iter().collect()
}

/// What is told of a model beside its layout.
struct Found<'a> {
    topology: Topology,
    cones: Vec<Cone>,
    factor: Vec<f64>,
    persistence: Vec<f64>,
    number: Option<NumberOfCones>,
    order: Option<ConeOrder>,
    record: Record<'a>,
}

impl<'a> Found<'a> {
    fn new(model: &Model, components: &[Component], record: Record<'a>) -> Self {
        let mut factor = vec![f64::NAN; model.vertex_count()];
        let mut persistence: Vec<f64> = Vec::new();
        for component in components {
            for (v, phi) in component.factor.iter_ids() {
                factor[component.surface.vertex[v] as usize] = *phi;
            }
            persistence.extend(component.hierarchy.extrema().iter().map(|e| e.persistence));
        }
        persistence.sort_by(|a, b| b.total_cmp(a));
        let topology = Topology::of(components.iter().map(|c| c.surface));
        Self { topology, cones: Vec::new(), factor, persistence, number: None, order: None, record }
    }

    /// Takes over a component's cones, times and warnings.
    fn take(&mut self, model: &Model, component: Component, cones: &[Candidate], curvatures: &[f64]) {
        for (candidate, &curvature) in cones.iter().zip(curvatures) {
            let vertex = component.surface.vertex[candidate.vertex];
            self.cones.push(Cone {
                vertex,
                position: model.points()[vertex as usize],
                kind: kind_of(candidate, curvature),
                persistence: candidate.extremum.map(|e: Extremum<_, _>| e.persistence),
                curvature,
            });
        }
        self.record.absorb(component.record);
    }

    fn extraction(self, repairs: Vec<Repair>) -> Extraction {
        let Self { topology, cones, factor, persistence, number, order, record } = self;
        let Record { times, warnings, .. } = record;
        Extraction { cones, factor, persistence, number, order, topology, times, repairs, warnings }
    }

    /// The cones of each surface that the options ask for.
    fn first_choices(&mut self, options: &Options, components: &mut [Component]) -> Result<Vec<Choice>, Error> {
        let least: Vec<usize> = components.iter().map(|c| least_cones(&c.operators)).collect();
        let counts = match &options.cones {
            ConeChoice::Automatic => {
                return Ok(self.find_number(options, components, TARGET_DISTORTION, MOST_AUTOMATIC));
            }
            ConeChoice::WithinDistortion(target) => {
                return Ok(self.find_number(options, components, *target, MOST_OPTIMISED));
            }
            ConeChoice::Count(total) => {
                let needed: usize = least.iter().sum();
                if *total < needed {
                    self.record.warn(too_few(*total, needed, components.len()));
                }
                let began = self.record.begin(Stage::Hierarchy);
                let counts = counts(components, options.method_for(total.saturating_sub(needed)), *total);
                self.record.end(Stage::Hierarchy, began);
                counts
            }
            ConeChoice::MinPersistence(threshold) => {
                let above = |c: &Component| c.hierarchy.count_above(&c.operators, *threshold);
                let above: Vec<usize> = components.iter().map(above).collect();
                let counts: Vec<usize> = above.iter().zip(&least).map(|(above, least)| *above.max(least)).collect();
                let [above, taken] = [&above, &counts].map(|counts| counts.iter().sum::<usize>());
                if above < taken {
                    let subject = subject(components.len());
                    self.record.warn(format!(
                        "{above} extrema are more persistent than {threshold}, but {subject} more cones: taking {taken}"
                    ));
                }
                counts
            }
            ConeChoice::Given(given) => return components.iter().map(|c| c.given(given)).collect(),
        };
        Ok(counts.into_iter().map(Choice::Count).collect())
    }

    /// As few cones in each surface as keep the predicted area distortion within a target.
    fn find_number(
        &mut self,
        options: &Options,
        components: &mut [Component],
        target: f64,
        most: usize,
    ) -> Vec<Choice> {
        let Options { method, angles, .. } = *options;
        let find = |component: &mut Component| {
            component.stage(Stage::Hierarchy, |Component { surface, operators, hierarchy, .. }| {
                let input = &surface.mesh;
                let mut reduced = Reduced::new(operators, input);
                match method {
                    Method::Refined => automatic(&mut reduced, angles, target, most),
                    method => {
                        let order = hierarchy.cones(operators, input, method, most);
                        let order: Vec<VertexId> = order.iter().map(|cone| cone.vertex).collect();
                        shortest(&mut reduced, &order, angles, target)
                    }
                }
            })
        };
        let found: Vec<Automatic> = components.par_iter_mut().with_max_len(1).map(find).collect();
        let (predicted, curve) = match &found[..] {
            [alone] => (alone.predicted, alone.curve.clone()),
            _ => {
                let predicted = predict_whole(components, &found, angles);
                let nested: Vec<Nested> = found.iter().map(|found| found.nested.clone()).collect();
                (predicted, whole_curve(components, &nested, (method, angles), (2 * predicted.count).max(most)))
            }
        };
        let is_met = found.iter().all(|found| found.is_met);
        let (chosen, predicted) = (predicted.count, predicted.area_distortion);
        self.number = Some(NumberOfCones { target, chosen, predicted, is_met, curve });
        found.into_iter().map(|found| Choice::Found(found.set.cones)).collect()
    }

    /// The order of the cones for every number of them, if it is asked for.
    fn note_order(&mut self, options: &Options, components: &[Component], choices: &[Choice]) {
        if !options.order {
            return;
        }
        let began = self.record.begin(Stage::Hierarchy);
        let needed: usize = components.iter().map(|c| least_cones(&c.operators)).sum();
        let taken: usize = choices.iter().map(Choice::count).sum();
        let method = match options.cones {
            ConeChoice::Count(asked) => options.method_for(asked.saturating_sub(needed)),
            _ => options.method_for(0),
        };
        let total = taken.max(ORDERED).max(if components.len() > 1 { needed + ORDERED_MORE } else { 0 });
        self.order = Some(cone_order(components, (method, options.angles), total));
        self.record.end(Stage::Hierarchy, began);
    }
}

/// What is predicted for all components together, with the cones that were found for each.
fn predict_whole(components: &[Component], found: &[Automatic], angles: Angles) -> Predicted {
    let mut whole = Whole::new(components.len());
    for (part, (Component { operators, area, .. }, found)) in components.iter().zip(found).enumerate() {
        let u = Settled::new(operators, &found.set, angles).log_scale(operators);
        whole.put(part, operators, *area, found.set.cones.len(), u);
    }
    whole.predicted()
}

/// Given cones must be vertices of a surface, each once.
fn check_given(model: &Model, options: &Options, prepared: &Prepared) -> Result<(), Error> {
    let ConeChoice::Given(given) = &options.cones else { return Ok(()) };
    let mut on_surface = vec![false; model.vertex_count()];
    for surface in &prepared.surfaces {
        surface.vertex.iter().for_each(|&v| on_surface[v as usize] = true);
    }
    for (k, &(vertex, _)) in given.iter().enumerate() {
        if !on_surface.get(vertex as usize).copied().unwrap_or(false) {
            return Err(Error::NoSuchCone { vertex, count: model.vertex_count() });
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

fn too_few(asked: usize, needed: usize, parts: usize) -> String {
    format!("{asked} cones asked for, but {} at least {needed}: taking {needed}", subject(parts))
}

fn subject(parts: usize) -> String {
    if parts == 1 { "this surface needs".to_owned() } else { format!("these {parts} parts need") }
}

/// Corners that no surface has get the positions of a triangle on the same three vertices, of another corner at their
/// vertex, or the origin.
fn fill_corners(model: &Model, prepared: &Prepared, mut uv: Vec<Option<[f64; 2]>>) -> Vec<[f64; 2]> {
    let vertex = |corner: &u32| model.corners()[*corner as usize];
    let sorted = |t: usize| {
        let mut corners = prepared.triangles.corners[t];
        corners.sort_unstable_by_key(vertex);
        corners
    };
    let place = |t: usize| sorted(t).map(|corner| vertex(&corner));
    let mut original: HashMap<[u32; 3], Option<[u32; 3]>> =
        prepared.left_out.iter().map(|&t| (place(t as usize), None)).collect();
    if !original.is_empty() {
        for t in prepared.surfaces.iter().flat_map(|surface| surface.triangle.iter().map(|&t| t as usize)) {
            original.entry(place(t)).and_modify(|first| _ = first.get_or_insert_with(|| sorted(t)));
        }
    }
    for &t in &prepared.left_out {
        let Some(Some(from)) = original.get(&place(t as usize)) else { continue };
        for (to, from) in sorted(t as usize).into_iter().zip(from) {
            uv[to as usize] = uv[to as usize].or(uv[*from as usize]);
        }
    }
    let mut of_vertex = vec![[0.0; 2]; model.vertex_count()];
    for (uv, &v) in uv.iter().zip(model.corners()) {
        if let Some(uv) = uv {
            of_vertex[v as usize] = *uv;
        }
    }
    uv.into_iter().zip(model.corners()).map(|(uv, &v)| uv.unwrap_or(of_vertex[v as usize])).collect()
}
