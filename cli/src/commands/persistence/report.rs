//! The pairs as JSON, as a table of comma-separated values, and as text.

use super::args::PersistenceArgs;
use super::field::{DomainField, GridReport, Places};
use super::pairs::{Pair, PairList};
use super::{ROWS, direction};
use crate::input::{Number, six_digits};
use crate::report::SCHEMA;
use crate::report::table::{columns, counted, thousands};
use serde::Serialize;
use std::time::Duration;
use topo::Kind;

/// The report of `cones persistence`. Its keys are stable.
#[derive(Debug, Serialize)]
pub(super) struct PersistenceReport {
    schema: u32,
    input: FieldInput,
    sublevel: Option<Direction>,
    superlevel: Option<Direction>,
    pub(super) times: PairingTimes,
}

#[derive(Debug, Serialize)]
struct FieldInput {
    path: String,
    vertices: usize,
    edges: usize,
    /// grid, mesh or network.
    domain: &'static str,
    #[serde(flatten)]
    grid: Option<GridReport>,
}

/// The pairs of one direction.
#[derive(Debug, Serialize)]
struct Direction {
    pairs: Vec<PairReport>,
    essential: Vec<Essential>,
    /// How many finite pairs are persistent enough, whether listed or not.
    count: usize,
    /// The sum of their persistences.
    total_persistence: Number,
    zero_pairs: usize,
}

#[derive(Debug, Serialize)]
struct PairReport {
    extremum: usize,
    saddle: usize,
    birth: Number,
    death: Number,
    persistence: Number,
    #[serde(flatten)]
    names: Names,
}

#[derive(Debug, Serialize)]
struct Essential {
    extremum: usize,
    birth: Number,
    range: Number,
    #[serde(flatten)]
    names: Names,
}

/// In networks, whose vertices have names.
#[derive(Debug, Serialize)]
struct Names {
    #[serde(skip_serializing_if = "Option::is_none")]
    extremum_name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    saddle_name: Option<String>,
}

/// What each step took; nothing for one that did not run.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct PairingTimes {
    pub(crate) read: Option<f64>,
    pub(crate) sublevel: Option<f64>,
    pub(crate) superlevel: Option<f64>,
    pub(crate) write: Option<f64>,
}

impl PairingTimes {
    /// Notes what a direction took.
    pub(crate) fn add(&mut self, kind: Kind, time: Duration) {
        let slot = match kind {
            Kind::Minimum => &mut self.sublevel,
            Kind::Maximum => &mut self.superlevel,
        };
        *slot = Some(time.as_secs_f64());
    }
}

impl PersistenceReport {
    /// A report without pairs.
    pub(super) fn new(subject: &DomainField, args: &PersistenceArgs, read: Duration) -> Self {
        Self {
            schema: SCHEMA,
            input: FieldInput {
                path: args.of.input.display().to_string(),
                vertices: subject.vertex_count(),
                edges: subject.edge_count(),
                domain: subject.kind(),
                grid: subject.grid.clone(),
            },
            sublevel: None,
            superlevel: None,
            times: PairingTimes { read: Some(read.as_secs_f64()), ..PairingTimes::default() },
        }
    }

    /// Adds the pairs of a direction.
    pub(super) fn add(&mut self, list: &PairList, places: &Places, time: Duration) {
        self.times.add(list.kind, time);
        let slot = match list.kind {
            Kind::Minimum => &mut self.sublevel,
            Kind::Maximum => &mut self.superlevel,
        };
        *slot = Some(Direction::new(list, places));
    }

    /// The report for people: what went in, and the first rows of each direction, as many as `top` or else a few.
    pub(super) fn text(&self, places: &Places, lists: &[PairList], top: Option<usize>) -> String {
        let rows = top.unwrap_or(ROWS);
        // What --top leaves out is in no file either.
        let more = if top.is_some() { "a greater --top gives more" } else { "--top and --pairs give more" };
        let FieldInput { path, vertices, edges, .. } = &self.input;
        let mut text = if matches!(&self.input.grid, Some(grid) if grid.shape.len() == 1 && grid.periodic.is_empty()) {
            format!("{path}: {}\n", self.domain())
        } else {
            let (vertices, edges) = (counted(*vertices, "vertex", "vertices"), counted(*edges, "edge", "edges"));
            format!("{path}: {}, {vertices}, {edges}\n", self.domain())
        };
        for list in lists {
            text += &format!("\n{}\n", summary(list));
            if !list.pairs.is_empty() && rows > 0 {
                text += &format!("\n{}", table(list, places, rows));
            }
            let listed = list.pairs.len().min(rows);
            let all = list.count + list.essential;
            if listed < all {
                text += &format!("… and {} less persistent; {more}\n", thousands(all - listed));
            }
        }
        text
    }

    fn domain(&self) -> String {
        let Some(GridReport { shape, connectivity, periodic }) = &self.input.grid else {
            return self.input.domain.to_owned();
        };
        if let ([length], []) = (&shape[..], &periodic[..]) {
            return format!("series of {}", counted(*length, "position", "positions"));
        }
        let shape = shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" × ");
        let rings =
            if periodic.is_empty() { String::new() } else { format!(", periodic in {}", periodic.join(" and ")) };
        format!("grid of {shape}, {connectivity} neighbours{rings}")
    }
}

/// One sentence on a direction.
fn summary(list: &PairList) -> String {
    let extrema = match list.kind {
        Kind::Minimum => "minima",
        Kind::Maximum => "maxima",
    };
    let zeros = match list.zero_pairs {
        0 => String::new(),
        zeros => format!("; {} of zero persistence", thousands(zeros)),
    };
    let pairs = if list.count == 1 { "pair" } else { "pairs" };
    let classes = if list.essential == 1 { "class" } else { "classes" };
    format!(
        "{} ({extrema}): {} {pairs}, total persistence {}; {} essential {classes}{zeros}",
        direction(list.kind),
        thousands(list.count),
        six_digits(list.total),
        thousands(list.essential)
    )
}

fn table(list: &PairList, places: &Places, rows: usize) -> String {
    let head = ["#", list.kind.name(), places.head(), "saddle", "birth", "death", "persistence"];
    let mut cells = vec![head.map(String::from).to_vec()];
    for (i, pair) in list.pairs.iter().take(rows).enumerate() {
        cells.push(vec![
            (i + 1).to_string(),
            pair.extremum.to_string(),
            places.told(pair.extremum),
            pair.saddle.map_or_else(|| "–".to_owned(), |saddle| places.short(saddle)),
            pair.birth.short(),
            pair.death.map_or_else(|| "–".to_owned(), Number::short),
            pair.persistence.short(),
        ]);
    }
    columns(&cells)
}

impl Direction {
    fn new(list: &PairList, places: &Places) -> Self {
        let names = |pair: &Pair| Names {
            extremum_name: places.name(pair.extremum).map(str::to_owned),
            saddle_name: pair.saddle.and_then(|saddle| places.name(saddle)).map(str::to_owned),
        };
        let finite = |pair: &Pair| {
            Some(PairReport {
                extremum: pair.extremum,
                saddle: pair.saddle?,
                birth: pair.birth,
                death: pair.death?,
                persistence: pair.persistence,
                names: names(pair),
            })
        };
        let essential = |pair: &Pair| Essential {
            extremum: pair.extremum,
            birth: pair.birth,
            range: pair.persistence,
            names: names(pair),
        };
        Self {
            pairs: list.finite().filter_map(finite).collect(),
            essential: list.essential().map(essential).collect(),
            count: list.count,
            total_persistence: Number::Double(list.total),
            zero_pairs: list.zero_pairs,
        }
    }
}

/// All pairs as rows of a table under a head; saddle and death of an essential class are empty.
pub(super) fn rows(lists: &[PairList], places: &Places) -> Vec<Vec<String>> {
    let names = ["kind", "extremum", "saddle", "birth", "death", "persistence"];
    let heads = |of: &'static str| places.axes().iter().map(move |axis| format!("{of}_{axis}"));
    let head = names.iter().map(|&name| name.to_owned()).chain(heads("extremum")).chain(heads("saddle")).collect();
    let row = |kind: Kind, pair: &Pair| {
        let mut row = vec![
            kind.name().to_owned(),
            pair.extremum.to_string(),
            pair.saddle.map_or_else(String::new, |saddle| saddle.to_string()),
            pair.birth.to_string(),
            pair.death.map_or_else(String::new, |death| death.to_string()),
            pair.persistence.to_string(),
        ];
        row.extend(places.cells(Some(pair.extremum)));
        row.extend(places.cells(pair.saddle));
        row
    };
    let rows = lists.iter().flat_map(|list| list.pairs.iter().map(move |pair| row(list.kind, pair)));
    std::iter::once(head).chain(rows).collect()
}

impl Places {
    /// What tells where a vertex is.
    fn axes(&self) -> &'static [&'static str] {
        match self {
            Self::Array(shape) => &["z", "y", "x"][3 - shape.len().clamp(1, 3)..],
            Self::Mesh { .. } => &["x", "y", "z"],
            Self::Network(_) => &["name"],
        }
    }

    /// Where a vertex is, axis by axis; nothing for none.
    fn cells(&self, vertex: Option<usize>) -> Vec<String> {
        let Some(vertex) = vertex else { return vec![String::new(); self.axes().len()] };
        match self {
            Self::Array(_) => self.told(vertex).split(", ").map(str::to_owned).collect(),
            Self::Mesh { points, .. } => points[vertex].iter().map(|x| format!("{x:?}")).collect(),
            Self::Network(names) => vec![names[vertex].clone()],
        }
    }
}
