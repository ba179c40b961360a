//! A field with its domain, as `topo` takes it, and where its vertices are, as people look for them.

use super::args::{ConnectivityName, FieldArgs};
use crate::error::CommandError;
use crate::input::{Array, Form, Network, Source, Values, each, edges_beside, heading, read_array, significant};
use crate::report::table::{counted, cut};
use crate::{commands::shared::warn, input, input::told, output};
use geom::{Model, Repair, RepairKind, Weld};
use serde::Serialize;
use std::path::{Path, PathBuf};
use topo::{Adjacency, Connectivity, Domain as _, Grid, Scalar as _, TriangleMesh};

/// What is asked about.
#[derive(Debug)]
pub(crate) struct DomainField {
    pub(crate) path: PathBuf,
    pub(crate) domain: Domain,
    pub(crate) values: Values,
    pub(crate) places: Places,
    /// How the domain came about, for reports.
    pub(crate) grid: Option<GridReport>,
}

/// The domains there are.
#[derive(Debug)]
pub(crate) enum Domain {
    Path(topo::Path),
    /// Pictures, and rings as pictures of one row.
    Plane(Grid<2>),
    Volume(Grid<3>),
    Mesh(TriangleMesh),
    Network(Adjacency),
}

/// Does the same on each kind of domain.
macro_rules! on {
    ($domain:expr, $name:ident => $body:expr) => {
        match $domain {
            $crate::commands::persistence::Domain::Path($name) => $body,
            $crate::commands::persistence::Domain::Plane($name) => $body,
            $crate::commands::persistence::Domain::Volume($name) => $body,
            $crate::commands::persistence::Domain::Mesh($name) => $body,
            $crate::commands::persistence::Domain::Network($name) => $body,
        }
    };
}
pub(crate) use on;

/// Where the vertices are.
#[derive(Debug)]
pub(crate) enum Places {
    /// In an array of this shape, the slowest axis first.
    Array(Vec<usize>),
    /// On a mesh.
    Mesh { points: Vec<[f64; 3]>, triangles: Vec<[u32; 3]> },
    /// They have names only.
    Network(Vec<String>),
}

/// What an array was taken for.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct GridReport {
    pub(crate) shape: Vec<usize>,
    pub(crate) connectivity: &'static str,
    pub(crate) periodic: Vec<&'static str>,
}

impl DomainField {
    /// Reads what the arguments name.
    pub(crate) fn read(args: &FieldArgs) -> Result<Self, CommandError> {
        let path = &args.input;
        let is_csv = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
        let form = match path {
            _ if is_csv && args.edges.is_some() => Form::Network,
            _ if !input::is_standard(path) => Form::of(path)?,
            // No ending tells what it is.
            _ if args.field.is_some() => Form::Mesh,
            _ => Form::Array,
        };
        let misplaced = [
            (args.field.is_some() && form != Form::Mesh, "--field", "a mesh"),
            (args.edges.is_some() && form != Form::Network, "--edges", "a network"),
            (args.connectivity.is_some() && form != Form::Array, "--connectivity", "an array"),
            (args.periodic.is_some() && form != Form::Array, "--periodic", "an array"),
            (args.layer.is_some() && form != Form::Array, "--layer", "an array"),
            (args.array.is_some() && form != Form::Array, "--array", "an array"),
        ];
        if let Some(&(_, option, of)) = misplaced.iter().find(|(is_misplaced, ..)| *is_misplaced) {
            return Err(CommandError::Misplaced { path: path.clone(), option, of });
        }
        match form {
            Form::Array => Self::array(args),
            Form::Network => Self::network(path, args.edges.as_deref()),
            Form::Mesh => Self::mesh(path, args.field.as_ref().ok_or_else(|| CommandError::NoField(path.clone()))?),
        }
    }

    fn array(args: &FieldArgs) -> Result<Self, CommandError> {
        let Array { values, shape } = read_array(&args.input, args.array.as_deref())?.layer(args.layer, &args.input)?;
        if let Some(names) = heading(&args.input) {
            output::warn(&format!("{}: the first line, {names}, is taken for names of columns", told(&args.input)));
        }
        let periodic = args.periodic.unwrap_or_default().zyx;
        if let Some(axis) = (0..3 - shape.len()).find(|&axis| periodic[axis]) {
            return Err(CommandError::NoAxis { path: args.input.clone(), axis: AXES[axis], axes: shape.len() });
        }
        let name = args.connectivity.unwrap_or(ConnectivityName::Freudenthal);
        let domain = grid(&shape, name.connectivity(), periodic);
        let connectivity = match name {
            ConnectivityName::Axis => "axis",
            ConnectivityName::Full => "full",
            ConnectivityName::Freudenthal => "freudenthal",
        };
        let periodic = (0..3).filter(|&axis| periodic[axis]).map(|axis| AXES[axis]).collect();
        let grid = GridReport { shape: shape.clone(), connectivity, periodic };
        Ok(Self { path: args.input.clone(), domain, values, places: Places::Array(shape), grid: Some(grid) })
    }

    fn network(path: &Path, edges: Option<&Path>) -> Result<Self, CommandError> {
        let beside = edges_beside(path);
        let edges = edges.or(beside.as_deref()).ok_or_else(|| CommandError::NoEdges(path.to_owned()))?;
        let network = Network::read(path, edges)?;
        warn_of_idle(network.idle_edges(), edges);
        let Network { values, names, edges } = network;
        let domain = Domain::Network(Adjacency::from_edges(names.len(), &edges).map_err(domain_failure(path))?);
        Ok(Self { path: path.to_owned(), domain, values, places: Places::Network(names), grid: None })
    }

    /// A mesh with a field. Copies of a vertex, as files have them along seams and creases, are joined as for a map, and have one value; where a
    /// file gives them several the surface stays split.
    pub(crate) fn mesh(path: &Path, source: &Source) -> Result<Self, CommandError> {
        let (model, _) = input::read_model(path)?;
        let triangles = model.triangles().vertices(&model);
        let mut joined = triangles.clone();
        let first = Weld::Auto.of(&model).unwrap_or_default();
        if !first.is_empty() {
            joined.iter_mut().flatten().for_each(|v| *v = first[*v as usize]);
        }
        let mut values = match source.values(path, &model, &joined)? {
            Some(values) => values,
            None => Values::F64(conformal_factor(path, &model)?),
        };
        let differing = if source.is_computed() { None } else { differing(&values, &first) };
        if let Some(copy) = differing {
            output::warn(&format!(
                "{}: the value of vertex {copy} is not that of vertex {}, at the same place: the surface stays split along its seams",
                told(path),
                first[copy]
            ));
            joined.clone_from(&triangles);
        } else {
            share(&mut values, &first);
            // An edge to the first one keeps a copy, which is no corner any more, from being a part by itself.
            joined.extend((0..).zip(&first).filter(|&(v, &first)| v != first).map(|(v, &first)| [first, v, v]));
        }
        let domain = TriangleMesh::new(model.vertex_count(), &joined).map_err(domain_failure(path))?;
        let places = Places::Mesh { points: model.points().to_vec(), triangles };
        Ok(Self { path: path.to_owned(), domain: Domain::Mesh(domain), values, places, grid: None })
    }

    /// What kind of domain it is, in a word.
    pub(crate) fn kind(&self) -> &'static str {
        match self.places {
            Places::Array(_) => "grid",
            Places::Mesh { .. } => "mesh",
            Places::Network(_) => "network",
        }
    }

    pub(crate) fn vertex_count(&self) -> usize {
        self.values.len()
    }

    /// The number of edges of the domain. O(edges), but on a grid.
    pub(crate) fn edge_count(&self) -> usize {
        self.grid.as_ref().and_then(grid_edges).unwrap_or_else(|| self.counted_edges())
    }

    fn counted_edges(&self) -> usize {
        on!(&self.domain, domain => {
            let mut later = Vec::new();
            let count = |v: usize| {
                later.clear();
                domain.for_each_neighbor(v, |u| if u > v { later.push(u) });
                later.sort_unstable();
                later.dedup();
                later.len()
            };
            (0..domain.vertex_count()).map(count).sum()
        })
    }
}

/// The first copy of a vertex that has not the value of the first one.
fn differing(values: &Values, first: &[u32]) -> Option<usize> {
    // Keys are equal where numbers are, and where both are NaN.
    each!(values, field => (0..first.len()).find(|&v| field[v].key() != field[first[v] as usize].key()))
}

/// Gives all copies of a vertex the value of the first one.
fn share(values: &mut Values, first: &[u32]) {
    each!(values, field => (0..).zip(first).for_each(|(v, &first): (usize, _)| field[v] = field[first as usize]));
}

/// Says which edges of a network join nothing that is not joined without them.
fn warn_of_idle([loops, repeated]: [usize; 2], edges: &Path) {
    let kinds = [
        (loops, "edge from a node to itself", "edges from a node to itself"),
        (repeated, "edge that is listed before", "edges that are listed before"),
    ];
    let told = kinds.iter().filter(|kind| kind.0 > 0).map(|&(count, one, many)| counted(count, one, many));
    let told: Vec<String> = told.collect();
    if !told.is_empty() {
        output::warn(&format!("{}: left out {}", edges.display(), told.join(" and ")));
    }
}

/// The conformal factor φ of each vertex; NaN where it is on no surface.
fn conformal_factor(path: &Path, model: &Model) -> Result<Vec<f64>, CommandError> {
    let analysis =
        cones::Analysis::new(model).map_err(|error| CommandError::Unwrap { path: path.to_owned(), error })?;
    // What is said of vertices at one place ends in an option that fields do not have.
    let is_of_copies = |repair: &&Repair| matches!(repair.kind, RepairKind::Welded | RepairKind::Unwelded);
    let (copies, repairs): (Vec<_>, Vec<_>) = analysis.repairs().iter().partition(is_of_copies);
    copies.iter().for_each(|repair| output::warn(&repair.kind.counted(repair.count)));
    let repairs: Vec<Repair> = repairs.into_iter().cloned().collect();
    warn(&repairs, analysis.notes(), analysis.topology().components);
    Ok(analysis.conformal_factor())
}

/// The most letters of a name in a table.
const NAME: usize = 16;

/// The names of (z, y, x).
const AXES: [&str; 3] = ["z", "y", "x"];

fn domain_failure(path: &Path) -> impl Fn(topo::Error) -> CommandError + '_ {
    |error| CommandError::Domain { path: path.to_owned(), error }
}

fn grid(shape: &[usize], connectivity: Connectivity, [z, y, x]: [bool; 3]) -> Domain {
    match *shape {
        [d, r, c] => Domain::Volume(Grid::new([d, r, c], connectivity).periodic([z, y, x])),
        [r, c] => Domain::Plane(Grid::new([r, c], connectivity).periodic([y, x])),
        [n] if x => Domain::Plane(Grid::new([1, n], connectivity).periodic([false, true])),
        _ => Domain::Path(topo::Path::new(shape.iter().product())),
    }
}

/// The number of edges of a grid: for each offset to a later neighbour the places from which it stays inside. None where
/// two steps round a ring come to the same neighbour, and edges must be counted one by one.
fn grid_edges(grid: &GridReport) -> Option<usize> {
    let axes: Vec<(usize, bool)> = (0..)
        .zip(&grid.shape)
        .map(|(axis, &length)| (length, grid.periodic.contains(&AXES[axis + 3 - grid.shape.len()])))
        .collect();
    if axes.iter().any(|&(length, is_ring)| is_ring && length < 3) {
        return None;
    }
    let along =
        |length: usize, is_ring: bool, step: i32| if step == 0 || is_ring { length } else { length.saturating_sub(1) };
    let offsets = (0..3i32.pow(axes.len() as u32))
        .map(|code| -> Vec<i32> { (0..axes.len() as u32).map(|axis| code / 3i32.pow(axis) % 3 - 1).collect() });
    let is_edge = |offset: &Vec<i32>| match grid.connectivity {
        "axis" => offset.iter().sum::<i32>() == 1 && offset.iter().filter(|step| **step != 0).count() == 1,
        "freudenthal" => offset.iter().all(|&step| step >= 0) && offset.contains(&1),
        // Of an offset and its opposite the one whose first step is forward.
        _ => offset.iter().find(|step| **step != 0) == Some(&1),
    };
    let edges = |offset: Vec<i32>| {
        let along = axes.iter().zip(offset).map(|(&(length, is_ring), step)| along(length, is_ring, step));
        // An axis without vertices may stand beside one that is absurdly long.
        along.fold(1, usize::saturating_mul)
    };
    Some(offsets.filter(is_edge).map(edges).sum())
}

impl Places {
    /// The head of the table's column of places.
    pub(crate) fn head(&self) -> &'static str {
        match self {
            Self::Array(shape) => ["x", "y, x", "z, y, x"][shape.len().clamp(1, 3) - 1],
            Self::Mesh { .. } => "x, y, z",
            Self::Network(_) => "name",
        }
    }

    /// Where a vertex is, for people.
    pub(crate) fn told(&self, vertex: usize) -> String {
        match self {
            Self::Array(shape) => index(shape, vertex).iter().map(usize::to_string).collect::<Vec<_>>().join(", "),
            Self::Mesh { points, .. } => {
                points[vertex].iter().map(|&x| significant(x, 4)).collect::<Vec<_>>().join(", ")
            }
            Self::Network(names) => cut(&names[vertex], NAME),
        }
    }

    /// The name of a vertex, if vertices have names.
    pub(crate) fn name(&self, vertex: usize) -> Option<&str> {
        if let Self::Network(names) = self { Some(&names[vertex]) } else { None }
    }

    /// A vertex's name, or else its number, for people.
    pub(crate) fn short(&self, vertex: usize) -> String {
        self.name(vertex).map_or_else(|| vertex.to_string(), |name| cut(name, NAME))
    }

    /// Whether vertices are anywhere in space.
    pub(super) fn are_in_space(&self) -> bool {
        !matches!(self, Self::Network(_))
    }

    /// Where a vertex is in space, if it is anywhere: an array's axes are x, y and z.
    pub(crate) fn point(&self, vertex: usize) -> Option<[f64; 3]> {
        match self {
            Self::Array(shape) => {
                let mut point = [0.0; 3];
                index(shape, vertex).iter().rev().zip(&mut point).for_each(|(&i, x)| *x = i as f64);
                Some(point)
            }
            Self::Mesh { points, .. } => Some(points[vertex]),
            Self::Network(_) => None,
        }
    }
}

/// The indices of an array's element, the slowest axis first.
fn index(shape: &[usize], vertex: usize) -> Vec<usize> {
    let mut rest = vertex;
    let mut index: Vec<usize> = shape
        .iter()
        .rev()
        .map(|&length| {
            let i = rest % length.max(1);
            rest /= length.max(1);
            i
        })
        .collect();
    index.reverse();
    index
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_found_by_their_indices() {
        assert_eq!(index(&[2, 3, 4], 23), [1, 2, 3]);
        assert_eq!(Places::Array(vec![2, 3, 4]).point(5), Some([1.0, 1.0, 0.0]));
        assert_eq!(Places::Array(vec![9]).told(5), "5");
    }

    #[test]
    fn edges_are_counted_once() {
        let names =
            [("axis", Connectivity::Axis), ("full", Connectivity::Full), ("freudenthal", Connectivity::Freudenthal)];
        for shape in [&[5][..], &[3, 4], &[1, 4], &[3, 3, 5]] {
            for (name, connectivity) in names {
                for periodic in [[false; 3], [false, false, true]] {
                    let axes = if periodic[2] { vec!["x"] } else { vec![] };
                    let subject = DomainField {
                        path: PathBuf::new(),
                        domain: grid(shape, connectivity, periodic),
                        values: Values::I32(vec![0; shape.iter().product()]),
                        places: Places::Array(shape.to_vec()),
                        grid: Some(GridReport { shape: shape.to_vec(), connectivity: name, periodic: axes }),
                    };
                    assert_eq!(subject.edge_count(), subject.counted_edges(), "{shape:?} {name} {periodic:?}");
                }
            }
        }
    }

    #[test]
    fn a_mesh_split_along_a_seam_has_the_field_of_the_whole_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        // Two pyramids on one square, as one octahedron and apart along the square, whose vertices the lower one has once more.
        let square = "v 1 0 0\nv 0 1.5 .2\nv -2 0 0\nv 0 -1 .1\n";
        let sides = |a: u32, b: u32, c: u32, d: u32, tip: u32| {
            [[a, b], [b, c], [c, d], [d, a]].map(|[p, q]| format!("f {p} {q} {tip}\n")).concat()
        };
        let tips = "v 0 0 1\nv 0 0 -2\n";
        let whole = format!("{square}{tips}{}{}", sides(1, 2, 3, 4, 5), sides(4, 3, 2, 1, 6));
        let split = format!("{square}{tips}{square}{}{}", sides(1, 2, 3, 4, 5), sides(10, 9, 8, 7, 6));
        std::fs::write(path("whole.obj"), whole).expect("it can be written");
        std::fs::write(path("split.obj"), split).expect("it can be written");
        std::fs::write(path("agree.txt"), "1\n2\n3\n4\n5\n6\n1\n2\n3\n4\n").expect("it can be written");
        std::fs::write(path("differ.txt"), "1\n2\n3\n4\n5\n6\n1\n2\n3\n7\n").expect("it can be written");
        let read = |name: &str, source: &Source| DomainField::mesh(&path(name), source).expect("it can be read");
        let essential = |subject: &DomainField| {
            let (Domain::Mesh(mesh), Values::F64(field)) = (&subject.domain, Values::F64(subject.values.to_f64()))
            else {
                panic!("a mesh")
            };
            let pairs = topo::persistence(mesh, &field).expect("no value is NaN");
            [pairs.minima, pairs.maxima].map(|pairs| pairs.essential().map(|pair| pair.birth).collect::<Vec<f64>>())
        };
        for name in ["phi", "curvature", "mean-curvature", "distance:0", "height:y"] {
            let source = Source::parse(name).expect("a field");
            let [whole, split] = ["whole.obj", "split.obj"].map(|file| read(file, &source));
            let expected = [0, 1, 2, 3, 4, 5, 0, 1, 2, 3].map(|v| whole.values.to_f64()[v]);
            assert_eq!(split.values.to_f64(), expected, "{name}");
            assert_eq!(essential(&split), essential(&whole), "{name}");
        }
        let parts = |values: &str| essential(&read("split.obj", &Source::File(path(values))))[0].len();
        assert_eq!([parts("agree.txt"), parts("differ.txt")], [1, 2]);
    }
}
