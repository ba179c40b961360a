//! The rows of a comparison, and its columns with their definitions.

use geom::counted;
use geom::distortion::Distortion;
use serde_json::{Map, Value, json};

use super::printed::Printed;
use super::trial::{Trial, TrialTimes};
use super::variant::Variant;

/// A method on a mesh.
#[derive(Debug)]
pub(super) struct Row {
    pub(super) mesh: String,
    pub(super) vertices: usize,
    /// How many cones were asked for.
    pub(super) asked: usize,
    pub(super) variant: Variant,
    /// What came of it, or why nothing did.
    pub(super) result: Result<Outcome, String>,
    /// The seconds of the floor.
    pub(super) floor: f64,
    /// What the paper prints for it.
    pub(super) printed: Option<Printed>,
}

/// What a method has reached.
#[derive(Clone, Debug)]
pub(super) struct Outcome {
    pub(super) cones: usize,
    pub(super) quasi_conformal: f64,
    pub(super) area: f64,
    pub(super) area_inverse: f64,
    pub(super) u_l2: f64,
    pub(super) flipped: usize,
    pub(super) overlap: f64,
    pub(super) curvature_left: Option<f64>,
    pub(super) seconds: TrialTimes,
    pub(super) note: String,
}

impl Outcome {
    /// What a trial has reached, and what its plan notes.
    pub(super) fn new(trial: &Trial, map: &Distortion, overlap: f64, mut notes: Vec<String>) -> Self {
        if trial.broken > 0 {
            notes.push(format!("the metric breaks {}", counted(trial.broken, "triangle", "triangles")));
        }
        Self {
            cones: trial.cones,
            quasi_conformal: map.quasi_conformal.mean,
            area: map.area.mean,
            area_inverse: map.area_inverse_mean,
            u_l2: map.u_l2,
            flipped: map.flipped,
            overlap,
            curvature_left: trial.curvature_left,
            seconds: trial.seconds,
            note: notes.join("; "),
        }
    }

    /// Keeps the least of each time.
    pub(super) fn keep_best(&mut self, other: TrialTimes) {
        let TrialTimes { preparing, detection, flattening, whole } = &mut self.seconds;
        *preparing = preparing.min(other.preparing);
        *detection = detection.min(other.detection);
        *flattening = flattening.min(other.flattening);
        *whole = whole.min(other.whole);
    }
}

/// A column: its key in CSV and JSON, its head in Markdown, what it means, and its value in a row.
pub(super) struct Column {
    pub(super) key: &'static str,
    pub(super) head: &'static str,
    pub(super) meaning: &'static str,
    pub(super) value: fn(&Row) -> Cell,
}

/// What stands in a table.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Cell {
    Empty,
    Text(String),
    Count(usize),
    /// With so many decimals in text.
    Number(f64, usize),
    /// In scientific notation.
    Small(f64),
}

impl Cell {
    pub(super) fn text(&self) -> String {
        match self {
            Self::Empty => String::new(),
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Number(x, decimals) => format!("{x:.decimals$}"),
            Self::Small(x) => format!("{x:.0e}"),
        }
    }

    pub(super) fn json(&self) -> Value {
        match self {
            Self::Empty => Value::Null,
            Self::Text(text) => json!(text),
            Self::Count(count) => json!(count),
            Self::Number(x, _) | Self::Small(x) => json!(x),
        }
    }
}

/// A value of the outcome, empty where there is none.
fn of(row: &Row, value: impl Fn(&Outcome) -> Cell) -> Cell {
    row.result.as_ref().map_or(Cell::Empty, value)
}

/// A value that the paper prints, empty where it does not.
fn printed(row: &Row, value: impl Fn(&Printed) -> Option<f64>) -> Cell {
    row.printed.as_ref().and_then(value).map_or(Cell::Empty, |x| Cell::Number(x, 3))
}

pub(super) const COLUMNS: [Column; 18] = [
    Column {
        key: "mesh",
        head: "mesh",
        meaning: "the file or built-in shape",
        value: |row| Cell::Text(row.mesh.clone()),
    },
    Column {
        key: "vertices",
        head: "vertices",
        meaning: "vertices of the surface that was computed with",
        value: |row| Cell::Count(row.vertices),
    },
    Column { key: "n", head: "N", meaning: "how many cones were asked for", value: |row| Cell::Count(row.asked) },
    Column {
        key: "method",
        head: "method",
        meaning: "rule for cones; `+smooth`: extrema of the conformal factor of the diffused curvature; `+harmonic` curvatures as in the \
                  paper, else optimal ones; flattened by Newton's method, or by `+linear` metric scaling or `+lscm` with the same cones \
                  on the same cut; `alternating+harmonic` is the paper, `refactoring+harmonic` [BCGB08]",
        value: |row| Cell::Text(row.variant.name()),
    },
    Column {
        key: "cones",
        head: "cones",
        meaning: "how many cones were taken, by all methods with the same cones as many as `cones unwrap` takes; where it is not N the note \
                  says why; times are for these, tries that failed left out",
        value: |row| of(row, |o| Cell::Count(o.cones)),
    },
    Column {
        key: "quasi_conformal",
        head: "qc",
        meaning: "mean of the ratio σ₁/σ₂ of a triangle's singular values, weighted by area: 1 where angles are kept",
        value: |row| of(row, |o| Cell::Number(o.quasi_conformal, 4)),
    },
    Column {
        key: "area_inverse_mean",
        head: "areal",
        meaning: "mean of 1/r, weighted by area, r a triangle's area ratio after one global scaling: closest to the paper's Table 1",
        value: |row| of(row, |o| Cell::Number(o.area_inverse, 3)),
    },
    Column {
        key: "area_mean",
        head: "D",
        meaning: "mean of max(r, 1/r), weighted by area: the paper's Fig. 1; 1 where areas are kept",
        value: |row| of(row, |o| Cell::Number(o.area, 3)),
    },
    Column {
        key: "u_l2",
        head: "u L2",
        meaning: "L2 norm, weighted by area, of the centred log scale ½ log r after flattening",
        value: |row| of(row, |o| Cell::Number(o.u_l2, 4)),
    },
    Column {
        key: "flipped",
        head: "flipped",
        meaning: "triangles turned over in the plane",
        value: |row| of(row, |o| Cell::Count(o.flipped)),
    },
    Column {
        key: "overlap",
        head: "overlap",
        meaning: "share of the layout, each part in one island, that is covered more than once; `cones unwrap` takes it apart",
        value: |row| of(row, |o| Cell::Number(o.overlap, 4)),
    },
    Column {
        key: "curvature_left",
        head: "K left",
        meaning: "largest difference between the scaled metric's curvature and what it should be, radians; none without metric scaling",
        value: |row| of(row, |o| o.curvature_left.map_or(Cell::Empty, Cell::Small)),
    },
    Column {
        key: "floor_seconds",
        head: "floor s",
        meaning: "seconds to order and factor the Laplacian of this mesh once, in the same rounds",
        value: |row| Cell::Number(row.floor, 4),
    },
    Column {
        key: "detection_seconds",
        head: "detection s",
        meaning: "seconds from the surface to the places of the cones: intrinsic Delaunay triangulation, Laplacian, factorizations, rule",
        value: |row| of(row, |o| Cell::Number(o.seconds.detection, 4)),
    },
    Column {
        key: "detection_floors",
        head: "/ floor",
        meaning: "detection in floors",
        value: |row| of(row, |o| Cell::Number(o.seconds.detection / row.floor, 2)),
    },
    Column {
        key: "flattening_seconds",
        head: "flattening s",
        meaning: "seconds for the cones' curvatures, the cut, metric scaling and layout",
        value: |row| of(row, |o| Cell::Number(o.seconds.flattening, 4)),
    },
    Column {
        key: "whole_seconds",
        head: "whole s",
        meaning: "seconds for all, preparing the mesh included, reading and writing not",
        value: |row| of(row, |o| Cell::Number(o.seconds.whole, 4)),
    },
    Column {
        key: "note",
        head: "note",
        meaning: "what else there is to know",
        value: |row| match &row.result {
            Err(reason) => Cell::Text(format!("failed: {reason}")),
            Ok(outcome) if outcome.note.is_empty() => Cell::Empty,
            Ok(outcome) => Cell::Text(outcome.note.clone()),
        },
    },
];

pub(super) const PRINTED: [Column; 4] = [
    Column {
        key: "paper_detection_seconds",
        head: "paper: detection s",
        meaning: "what the paper prints, on its machine of 2017 (where left out: for the row with fewest cones)",
        value: |row| printed(row, |p| p.detection),
    },
    Column {
        key: "paper_flattening_seconds",
        head: "paper: flattening s",
        meaning: "what the paper prints as parameterization",
        value: |row| printed(row, |p| Some(p.flattening)),
    },
    Column {
        key: "paper_areal",
        head: "paper: areal",
        meaning: "what the paper prints",
        value: |row| printed(row, |p| Some(p.areal)),
    },
    Column {
        key: "paper_quasi_conformal",
        head: "paper: qc",
        meaning: "what the paper prints",
        value: |row| printed(row, |p| Some(p.quasi_conformal)),
    },
];

/// A row as a JSON object.
pub(super) fn object(columns: &[&Column], row: &Row) -> Value {
    let entries = columns.iter().map(|column| (column.key.to_owned(), (column.value)(row).json()));
    Value::Object(entries.collect::<Map<_, _>>())
}
