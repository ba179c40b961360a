//! A surface to be shown in the page, asked for cones and maps.

use super::unwrapped::{corner_uv, vertices};
use crate::error::CommandError;
use crate::page;
use crate::render::{Mark, Scene, extent};
use crate::report::table::counted;
use crate::report::{SCHEMA, Times, on_seams, repair_text};
use cones::report::{Quality, SeamReport, UvSize, sentences};
use cones::{
    Analysis, Atlas, Cone, ConeChoice, CurvatureRule, MOST_ORDERED, ModelExtremum, Note, Options, Placement,
    RefinedModel,
};
use geom::{Model, Triangles, Watch};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// So many parts have each as many cones in the page as a single one.
const MANY_PARTS: usize = 16;

/// A surface with its analysis, and what is the same for all of its maps.
#[derive(Debug)]
pub(crate) struct Subject<'a> {
    /// How messages call it.
    path: PathBuf,
    pub(crate) model: &'a Model,
    pub(crate) analysis: Analysis,
    /// What maps have in common: where seams run, what becomes of islands.
    pub(crate) options: Options,
    /// The triangles that lie on a surface, by number, by corners, by vertices.
    triangles: Vec<u32>,
    corners: Vec<[u32; 3]>,
    vertices: Vec<[u32; 3]>,
    /// For each vertex the first at its place, where these are merged.
    first: Option<Vec<u32>>,
}

/// A map of a subject.
#[derive(Debug)]
pub(crate) struct Shown {
    pub(crate) atlas: Atlas,
    /// For each corner of the model, on tiles of unit size.
    pub(crate) uv: Vec<[f64; 2]>,
}

impl<'a> Subject<'a> {
    /// `model` is the one that maps are of: the refined one, where there is one.
    pub(crate) fn new(path: &Path, model: &'a Model, analysis: Analysis, options: Options) -> Self {
        let Triangles { corners: all, .. } = analysis.triangles();
        let mut is_kept = vec![true; all.len()];
        analysis.left_out().iter().for_each(|&t| is_kept[t as usize] = false);
        let triangles: Vec<u32> = (0..).zip(&is_kept).filter_map(|(t, kept)| kept.then_some(t)).collect();
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&t| all[t as usize]).collect();
        let first = analysis.weld().of(model);
        let mut vertices = vertices(model, &corners);
        if let Some(first) = &first {
            vertices.iter_mut().flatten().for_each(|v| *v = first[*v as usize]);
        }
        Self { path: path.to_owned(), model, analysis, options, triangles, corners, vertices, first }
    }

    /// The name of its file.
    pub(crate) fn name(&self) -> String {
        self.path.file_name().unwrap_or(self.path.as_os_str()).to_string_lossy().into_owned()
    }

    /// How many cones the page shows at most: as many as are optimised, for several parts as many more on each than these need.
    pub(crate) fn most(&self) -> usize {
        match self.analysis.topology().components {
            1 => self.most_in_order(),
            parts => self.analysis.least_cones() + MOST_ORDERED * parts.min(MANY_PARTS),
        }
    }

    /// How many of them an order is looked for of at most.
    fn most_in_order(&self) -> usize {
        let least = self.analysis.least_cones();
        let begin = if self.analysis.topology().components > 1 { least } else { 0 };
        (begin + MOST_ORDERED).max(least)
    }

    /// What is drawn of the surface.
    pub(crate) fn surface(&self) -> page::Surface {
        let used = || self.vertices.iter().flatten().map(|&v| self.model.points()[v as usize]);
        let (low, size) = extent(used());
        let high = used().fold(low, |high, p| std::array::from_fn(|i| f64::max(high[i], p[i])));
        let place = |p: &[f64; 3]| std::array::from_fn(|i| ((p[i] - 0.5 * (low[i] + high[i])) / size) as f32);
        let number = |x: f64| if x.is_finite() { x as f32 } else { 0.0 };
        page::Surface {
            points: self.model.points().iter().map(place).collect(),
            triangles: self.vertices.clone(),
            factor: self.analysis.conformal_factor().into_iter().map(number).collect(),
        }
    }

    /// For each vertex whether it can be a cone. In a refined model those cannot that the map's own even triangles lack, and nowhere those
    /// that are on no surface.
    pub(crate) fn usable(&self) -> Vec<u8> {
        self.analysis.conformal_factor().iter().map(|factor| u8::from(!factor.is_nan())).collect()
    }

    /// What the page says of the surface.
    pub(crate) fn meta(&self, chosen: &Chosen) -> Value {
        let methods = Placement::ALL.iter().filter(|placement| **placement != Placement::Refactoring);
        let methods: Vec<Value> = methods
            .map(|placement| json!({ "name": placement.name(), "description": placement.description() }))
            .collect();
        let topology = self.analysis.topology();
        json!({
            "schema": SCHEMA,
            "name": self.name(),
            "topology": topology,
            "least": self.analysis.least_cones(),
            "most": self.most(),
            "methods": methods,
            "chosen": chosen,
            "refined": self.analysis.refined().is_some(),
            "warnings": self.warnings(self.analysis.notes()),
        })
    }

    /// What was mended, whether it was refined, and notes, as sentences.
    fn warnings(&self, notes: &[Note]) -> Vec<String> {
        let repairs = self.analysis.repairs().iter().map(repair_text);
        let refined = self.analysis.refined().map(|RefinedModel { model, is_complete, .. }| {
            let vertices = counted(model.vertex_count(), "vertex", "vertices");
            let triangles = counted(model.face_count(), "triangle", "triangles");
            let how = if *is_complete { "to even triangles" } else { "in part" };
            format!("refined {how}; shown and saved as {vertices}, {triangles}")
        });
        repairs.chain(refined).chain(sentences(notes, self.analysis.topology().components)).collect()
    }

    /// What is known of a method's cones before they are flattened. Where it has no order of its own, or one that takes long, they are
    /// those of a preview; all others are nested.
    ///
    /// # Errors
    /// If the observer has said stop.
    pub(crate) fn foreseen(&self, placement: Placement, rule: CurvatureRule) -> Result<Foreseen, cones::Error> {
        let (analysis, least) = (&self.analysis, self.analysis.least_cones());
        let most = self.most_in_order();
        if matches!(placement, Placement::Refined | Placement::Pursuit) {
            let mut levels = Vec::new();
            // All that a single part can have; of many one in twelve.
            let next = |&n: &usize| Some(if n < most { n + 1 } else { n + n.div_ceil(12) });
            for n in std::iter::successors(Some(least.max(1)), next).take_while(|&n| n <= self.most()) {
                let preview = analysis.preview(n)?;
                if preview.cones.len() == n {
                    let cones = preview.cones.iter().map(|cone| (cone.vertex, Some(cone.curvature))).collect();
                    levels.push(ForeseenLevel { n, cones, predicted_area: preview.prediction.area_distortion });
                }
            }
            return Ok(Foreseen { extrema: analysis.extrema(), levels });
        }
        let order = analysis.order(placement, rule, most)?;
        let first = |n: usize| order.cones.iter().take(n).map(|cone| (cone.vertex, cone.curvature)).collect();
        let level = |point: &cones::Prediction| {
            let (n, predicted_area) = (point.count, point.area_distortion);
            ForeseenLevel { n, cones: first(n), predicted_area }
        };
        let levels = order.curve.iter().filter(|point| point.count <= most).map(level).collect();
        Ok(Foreseen { extrema: order.extrema, levels })
    }

    /// Unwraps it as far as the page shows it, with cones chosen or given by the options. What the map is like is
    /// [measured](Self::measure) apart from that, which takes a sixth of the time.
    ///
    /// # Errors
    /// As [`Analysis::atlas`].
    pub(crate) fn map(&self, analysis: &Analysis, options: &Options) -> Result<Shown, CommandError> {
        let atlas = analysis.atlas(options).map_err(|error| CommandError::Unwrap { path: self.path.clone(), error })?;
        let uv = atlas.uv_in(UvSize::Unit);
        Ok(Shown { atlas, uv })
    }

    /// Measures texture coordinates at the corners of the model.
    ///
    /// # Errors
    /// If they cannot be measured, or it is stopped.
    pub(crate) fn measure(&self, uv: &[[f64; 2]], cones: &[Cone], watch: Watch) -> Result<Quality, CommandError> {
        let first = |v: u32| self.first.as_ref().map_or(v, |first| first[v as usize]);
        let cones: Vec<u32> = cones.iter().map(|cone| first(cone.vertex)).collect();
        Quality::measure_watched(
            self.model.points(),
            &self.vertices,
            &corner_uv(&self.corners, uv),
            Some(&cones),
            watch,
        )
        .map_err(|error| CommandError::Measure { path: self.path.clone(), error })
    }

    /// What pictures are drawn of, with texture coordinates, seams and cones.
    pub(crate) fn scene(&self, uv: &[[f64; 2]], seams: Vec<Vec<u32>>, cones: &[Cone]) -> Scene {
        let marks = cones.iter().map(|c| Mark { vertex: c.vertex, positive: c.curvature >= 0.0 }).collect();
        Scene::new(self.model.points(), self.vertices.clone(), corner_uv(&self.corners, uv), seams, marks)
    }

    /// What pictures of a map are drawn of.
    pub(crate) fn scene_of(&self, shown: &Shown) -> Scene {
        let scene = self.scene(&shown.uv, shown.atlas.seams.clone(), &shown.atlas.cones);
        scene.packed(corner_uv(&self.corners, &shown.uv), shown.atlas.fill)
    }

    /// What is drawn of a map.
    pub(crate) fn drawn(&self, shown: &Shown) -> page::Map {
        let Shown { atlas, uv } = shown;
        let narrow = |p: [f64; 2]| p.map(|x| x as f32);
        let island = |&t: &u32| atlas.islands[t as usize].unwrap_or(0);
        page::Map {
            uv: self.corners.iter().map(|t| t.map(|c| narrow(uv[c as usize]))).collect(),
            island: self.triangles.iter().map(island).collect(),
            seams: atlas.seams.clone(),
        }
    }

    /// What a map is coloured by.
    pub(crate) fn stretches(&self, quality: &Quality) -> page::Stretches {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| self.model.points()[v as usize]);
            let [u, v] = [geom::vector::sub(b, a), geom::vector::sub(c, a)];
            geom::vector::length(geom::vector::cross(u, v))
        };
        let areas: Vec<f64> = self.vertices.iter().map(area).collect();
        page::Stretches {
            log_area: quality.log_areas(&areas).into_iter().map(|log| log as f32).collect(),
            stretch: quality.quasi_conformal.iter().map(|&stretch| stretch as f32).collect(),
        }
    }

    /// What the page says of a map at once.
    pub(crate) fn map_meta(&self, shown: &Shown, options: &Options) -> Value {
        let Shown { atlas, .. } = shown;
        let on_seams = on_seams(&SeamReport::new(atlas)).into_iter().map(|(label, text)| format!("{label}: {text}"));
        let warnings: Vec<String> = self.warnings(&atlas.notes).into_iter().chain(on_seams).collect();
        json!({
            "cones": atlas.cones,
            "method": options.method_name(),
            "angles": options.angles_name(),
            "number": atlas.number,
            "tiles": atlas.tiles,
            "fill": atlas.fill,
            "times": Times::default().with(atlas.times),
            "warnings": warnings,
        })
    }

    /// The area distortion that is predicted for the cones of a map: they are others than those of the curve.
    pub(crate) fn predicted(&self, options: &Options, atlas: &Atlas) -> Option<f64> {
        if let Some(number) = &atlas.number {
            return Some(number.predicted);
        }
        let given = atlas.cones.iter().map(|cone| (cone.vertex, Some(cone.curvature))).collect();
        let options = Options { cones: ConeChoice::Given(given), ..options.clone() };
        self.analysis.choose(&options).ok().map(|cones| cones.prediction().area_distortion)
    }

    /// What the page says of a map when it is measured.
    pub(crate) fn measured_meta(quality: &Quality, atlas: &Atlas) -> Value {
        let mut distortion = json!(quality.distortion);
        // Where the two sides of seams differ, what is left at these is no error.
        let is_rigid = atlas.freed == 0 && atlas.opened_handles == 0 && atlas.necks == 0 && !atlas.recipe().charts;
        if !is_rigid {
            distortion["curvature_error"] = Value::Null;
        }
        json!({ "distortion": distortion, "islands": quality.islands.len() })
    }
}

/// Cones of a method for every number of them.
#[derive(Clone, Debug, serde::Serialize)]
pub(crate) struct Foreseen {
    /// Of the conformal factor, the most persistent first.
    extrema: Vec<ModelExtremum>,
    pub(crate) levels: Vec<ForeseenLevel>,
}

/// So many cones.
#[derive(Clone, Debug, serde::Serialize)]
pub(crate) struct ForeseenLevel {
    pub(crate) n: usize,
    /// Vertices, each with its curvature as far as that is known.
    pub(crate) cones: Vec<(u32, Option<f64>)>,
    predicted_area: f64,
}

/// What the page begins with.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub(crate) struct Chosen {
    /// How many cones; as many as the surface asks for where it is none.
    pub(crate) n: Option<usize>,
    pub(crate) method: &'static str,
    pub(crate) angles: &'static str,
}

impl Chosen {
    pub(crate) fn new(n: Option<usize>, placement: Placement, rule: CurvatureRule) -> Self {
        Self { n, method: placement.name(), angles: rule.name() }
    }
}
