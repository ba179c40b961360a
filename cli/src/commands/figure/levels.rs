//! Figures without a map: the conformal factor with its extrema (Fig. 2), and a hierarchy of maxima on a terrain (Fig. 3).

use super::maps::Surface;
use super::sheet::SheetColumn;
use crate::commands::compare::Variant;
use crate::error::CommandError;
use crate::render::{Mark, Paint, Picture, Scene, Shot, View, draw_model};
use cones::Kind;
use geom::Model;
use std::path::Path;
use topo::{PersistenceOptions, TriangleMesh};

/// The peaks of the paper's terrain: eight hills round a ninth.
const HILLS: usize = 9;

/// The conformal factor, and the same with all of its extrema.
pub(super) fn factor(
    surface: &mut Surface<'_>,
    model: &Model,
    view: Option<View>,
    panel: [usize; 2],
) -> Result<Vec<SheetColumn>, CommandError> {
    let analysis = &surface.subject(Variant::PAPER)?.analysis;
    let (values, extrema) = (analysis.conformal_factor(), analysis.extrema());
    let mark = |e: &cones::ModelExtremum| Mark { vertex: e.vertex, positive: e.kind == Kind::Minimum };
    let field = Field { model, values: &values, title: "conformal factor", view, panel };
    let minima = extrema.iter().filter(|e| e.kind == Kind::Minimum).count();
    Ok(vec![
        SheetColumn {
            head: vec![format!("(a) {}: conformal factor", surface.name)],
            panels: vec![field.drawn(Vec::new())],
            foot: Vec::new(),
        },
        SheetColumn {
            head: vec![format!("(b) {minima} minima, {} maxima", extrema.len() - minima)],
            panels: vec![field.drawn(extrema.iter().map(mark).collect())],
            foot: Vec::new(),
        },
    ])
}

/// The maxima of the height at four levels of their hierarchy.
pub(super) fn terrain(
    name: &str,
    model: &Model,
    view: Option<View>,
    panel: [usize; 2],
) -> Result<Vec<SheetColumn>, CommandError> {
    let heights: Vec<f64> = model.points().iter().map(|p| p[2]).collect();
    let path = || Path::new(name).to_owned();
    let triangles = model.triangles().vertices(model);
    let mesh =
        TriangleMesh::new(heights.len(), &triangles).map_err(|error| CommandError::Domain { path: path(), error })?;
    let pairs = PersistenceOptions::new()
        .superlevel(&mesh, &heights)
        .map_err(|error| CommandError::Persistence { path: path(), error })?;
    let peaks: Vec<(usize, f64)> = pairs.ranked().into_iter().map(|pair| (pair.extremum, pair.persistence())).collect();
    let between = ((HILLS * peaks.len()) as f64).sqrt() as usize;
    let mut counts = vec![peaks.len(), between, HILLS, 1];
    counts.iter_mut().for_each(|count| *count = (*count).min(peaks.len()));
    let field = Field { model, values: &heights, title: "height", view, panel };
    let column = |(letter, count): (char, usize)| {
        let marks = peaks[..count].iter().map(|&(v, _)| Mark { vertex: v as u32, positive: false }).collect();
        let least = peaks[..count].last().map_or(0.0, |&(_, persistence)| persistence);
        SheetColumn {
            head: vec![format!(
                "({letter}) {count} {}, persistence from {least:.4}",
                if count == 1 { "maximum" } else { "maxima" }
            )],
            panels: vec![field.drawn(marks)],
            foot: Vec::new(),
        }
    };
    Ok(('a'..).zip(counts).map(column).collect())
}

/// A field on a surface, to be drawn with some marks.
struct Field<'a> {
    model: &'a Model,
    values: &'a [f64],
    title: &'static str,
    view: Option<View>,
    panel: [usize; 2],
}

impl Field<'_> {
    fn drawn(&self, marks: Vec<Mark>) -> Picture {
        let triangles = self.model.triangles().vertices(self.model);
        let uv = vec![[[0.0; 2]; 3]; triangles.len()];
        let paint = Paint::field(self.values, &triangles, self.title);
        let scene = Scene::new(self.model.points(), triangles, uv, Vec::new(), Vec::new());
        // One view for all panels, whatever is marked on them.
        let view = Some(self.view.unwrap_or_else(|| View::best(&scene)));
        draw_model(&Scene { cones: marks, ..scene }, &paint, Shot { view, size: Some(self.panel) })
    }
}
