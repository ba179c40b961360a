//! Of flattening a surface.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use cones::internals::{Layout, Operators, Scaling, Seams, cone_curvatures, scale};
use cones::uv::{Rotations, overlaps};
use cones::{
    Analysis, ConeChoice, CurvatureError, CurvatureRule, Error, FreeSeams, Handles, Islands, Limbs, Note, Options,
    Placement, Preparation, Progress, Refining, SeamOptions, Search, Symmetry, unwrap_model,
};
use geom::vector::{length, normal};
use geom::{Double, Id, Mesh, Metric, Model, PrepareError, VertexData, VertexId, Watch, angle_defects};

use super::{assert_close, metric_of};
use crate::decode::{self, Bytes, Moves};
use crate::encode::{self, Format};
use crate::oracle::{check_map, signed_area};
use crate::solids;

/// Triangles of less height than this, relative to the extent of the whole map, may be lost in rounding.
const NEEDLE: f64 = 1e-9;

/// All ways to a set of cones but [`Refactoring`](Placement::Refactoring), which is [`Iterative`](Placement::Iterative) made slow.
const METHODS: [Placement; 6] = [
    Placement::Persistence,
    Placement::Alternating,
    Placement::Iterative,
    Placement::Greedy,
    Placement::Refined,
    Placement::Pursuit,
];

/// What a law came to on its input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reached {
    /// It says nothing of this input.
    Nothing,
    /// Newton's method got stuck on a surface with a boundary, and so nothing was checked.
    Stuck,
    /// It was checked on a surface without a boundary.
    Closed,
    /// It was checked on a surface with a boundary.
    Bordered,
}

impl Reached {
    fn on(mesh: &Mesh) -> Self {
        if mesh.boundary_loops().is_empty() { Self::Closed } else { Self::Bordered }
    }
}

/// Any cones of any small surface give a metric that is flat but there, a layout whose seams match up to rigid motions,
/// and each of these motions turns by the curvature that the seam encloses.
pub fn cones_flatten(bytes: &[u8]) -> Reached {
    let bytes = &mut Bytes::new(bytes);
    let shape = decode::surface(bytes);
    let mesh = shape.mesh();
    let metric = metric_of(&mesh, &shape);
    let operators = Operators::new(&mesh, &metric).expect("connected, with triangles that have area");
    let count = 3 + bytes.below(6);
    let vertices = decode::inner_vertices(bytes, &mesh, count);
    let chosen = match cone_curvatures(&operators, &mesh, &vertices, CurvatureRule::Optimal, Watch::NONE) {
        Err(CurvatureError::TooFew { .. }) => return Reached::Nothing,
        chosen => chosen.expect("the only other outcome"),
    };
    let total: f64 = chosen.curvature.iter().sum();
    if !operators.is_bordered() {
        assert_close(total, TAU * mesh.euler_characteristic() as f64, 1e-9, 1.0);
    }
    let mut target = VertexData::constant(mesh.vertex_count(), 0.0);
    vertices.iter().zip(&chosen.curvature).for_each(|(&v, &k)| target[v] = k);
    let scaling = match scale(&mesh, &metric, &operators, &target, &chosen.predicted, Watch::NONE) {
        // With given log scale factors on the boundary Newton's method may get stuck, rarely.
        Err(_) if operators.is_bordered() => return Reached::Stuck,
        scaling => scaling.expect("a discretely conformal metric"),
    };
    assert_flat_but_at_cones(&mesh, &scaling, &target);

    let seams = Seams::new(&mesh, metric.lengths(), &vertices, Watch::NONE).expect("cones enough to cut open");
    let layout = Layout::new(&mesh, &scaling, &seams.cut, Watch::NONE).expect("nobody says stop");
    assert!(layout.cut.is_disk());
    let size = scaling.metric.lengths().iter().fold(0.0_f64, |m, &l| m.max(l));
    for h in mesh.halfedges() {
        let Some(g) = mesh.twin(h) else { continue };
        let [here, there] = [h, g].map(|h| layout.corner(mesh.next(h)) - layout.corner(h));
        let turned = here + layout.seam_rotation[h] * there;
        assert!(turned.norm() <= 1e-6 * size, "the sides of {h:?} differ by {:e}", turned.norm());
    }
    if mesh.euler_characteristic() == 2 {
        assert_holonomy(&mesh, &seams, &layout, &target);
    }
    Reached::on(&mesh)
}

/// |K - K^T| < 1e-9 inside, by the angle defects of the metric itself; its triangulation goes back to the input's.
fn assert_flat_but_at_cones(mesh: &Mesh, scaling: &Scaling, target: &VertexData<f64>) {
    scaling.triangulation.check();
    let sums = scaling.metric.angle_sums(&scaling.triangulation);
    for v in mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)) {
        assert_close(TAU - sums[v], target[v], 1e-9, 1.0);
    }
    let mut undone = scaling.triangulation.clone();
    for &h in scaling.flips.iter().rev() {
        undone.unflip(h);
    }
    let is_whole = undone.face_count() == 2 * mesh.face_count();
    let is_back = match undone.face_count() > mesh.face_count() {
        false => undone == *mesh.triangulation(),
        true if is_whole => undone == *Double::new(mesh).mesh.triangulation(),
        true => (1..10).any(|rings| undone == *Double::collar(mesh, rings).mesh.triangulation()),
    };
    assert!(is_back, "flips undone backwards leave the input");
}

/// On a sphere seams are a tree: each of its edges parts the cones in two, and the rotation across it is the curvature on
/// one side.
fn assert_holonomy(mesh: &Mesh, seams: &Seams, layout: &Layout, target: &VertexData<f64>) {
    for e in mesh.edges().filter(|&e| seams.cut[e]) {
        let h = mesh.halfedge(e);
        let enclosed = curvature_behind(mesh, seams, mesh.head(h), mesh.tail(h), target);
        let turn = layout.seam_rotation[h].arg();
        let error = [enclosed - turn, enclosed + turn].map(|x| (x - TAU * (x / TAU).round()).abs());
        assert!(error[0].min(error[1]) < 1e-6, "a turn by {turn} round the curvature {enclosed}");
    }
}

/// The target curvature of the part of a tree of seams that is reached from `v` without going back to `from`.
fn curvature_behind(mesh: &Mesh, seams: &Seams, v: VertexId, from: VertexId, target: &VertexData<f64>) -> f64 {
    let mut sum = 0.0;
    let mut stack = vec![(v, from)];
    while let Some((v, from)) = stack.pop() {
        sum += target[v];
        let on = geom::edges_at(mesh, v).filter(|&(e, w)| seams.cut[e] && w != from);
        stack.extend(on.map(|(_, w)| (w, v)));
    }
    sum
}

/// Where every inner vertex is a cone with the curvature that it has, nothing needs to be scaled: the layout is the surface
/// unfolded, every edge as long as in space.
pub fn every_vertex_a_cone_unfolds(bytes: &[u8]) -> Reached {
    let shape = decode::surface(&mut Bytes::new(bytes));
    let mesh = shape.mesh();
    let metric = Metric::from_points(&mesh, &shape.points);
    let defects = angle_defects(&mesh, &metric);
    let inner = |v: &VertexId| !mesh.is_boundary_vertex(*v);
    let given: Vec<_> = mesh.vertices().filter(inner).map(|v| (v.0, Some(defects[v]))).collect();
    let longest = metric.lengths().iter().fold(0.0_f64, |m, &l| m.max(l));
    if mesh.faces().any(|f| metric.sides(&mesh, f).area() < 1e-5 * longest * longest) {
        return Reached::Nothing; // what a sliver does to angles is another law's subject
    }
    let angles = metric.angle_sums(&mesh);
    if mesh.vertices().any(|v| mesh.is_boundary_vertex(v) && angles[v] > TAU - 1e-9) {
        return Reached::Nothing; // more than a full turn at the rim is narrowed
    }
    let model = solids::model(&shape).expect("ordinary numbers");
    let options = Options { cones: ConeChoice::Given(given), islands: Islands::Single, ..Options::default() };
    let atlas = unwrap_model(&model, &options).expect("nothing needs to be done");
    let found = check_map(&model, &atlas);
    assert!(found.stretch < 1e-8, "{found:?}");
    assert_eq!((found.flipped, found.torn, found.euler), (0, 0, vec![1]));
    Reached::on(&mesh)
}

/// Whatever is done to a good mesh, it unwraps.
pub fn insults_unwrap(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let options = options(bytes);
    let moves = if bytes.coin() { Moves::Anywhere } else { Moves::Near };
    let shape = decode::insulted(bytes, moves);
    unwraps(&solids::model(&shape).expect("coordinates are bounded and indices in range"), &options);
}

/// Any bytes as a file, or a file of a small surface with any damage: what can be read unwraps.
pub fn files_unwrap(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let options = options(bytes);
    let format = Format::of(bytes.byte());
    let file = if bytes.coin() {
        bytes.rest().to_vec()
    } else {
        let mut file = encode::file(&decode::surface(bytes), format);
        encode::damage(&mut file, bytes);
        file
    };
    if let Ok(model) = geom::io::read_bytes(file, format.name()) {
        unwraps(&model, &options);
    }
}

/// A small surface, whole or insulted, with any options: it becomes a map without overlap unless a note says so, or what was said of cones and
/// edges is refused.
pub fn options_unwrap(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let shape = if bytes.coin() { decode::surface(bytes) } else { decode::insulted(bytes, Moves::Near) };
    let model = solids::model(&shape).expect("coordinates are bounded and indices in range");
    let options = any_options(bytes, &model);
    let is_named = |error: &Error| match error {
        Error::Prepare(PrepareError::NoArea { .. }) => true,
        Error::NumbersWithoutParts { .. } => matches!(options.cones, ConeChoice::Each(_)),
        Error::NoSuchEdge { .. } => options.seams != SeamOptions::default(),
        error => {
            // Their metrics may be none that is found, and seams through them none that cut the surface open.
            let is_of_cones = !matches!(error, Error::Interrupted | Error::NotFlatRefined { .. });
            is_of_cones && matches!(options.cones, ConeChoice::Given(_))
        }
    };
    let (analysis, atlas) = match Analysis::unwrapped(&model, &options, |_: Progress| ControlFlow::Continue(())) {
        Err(error) if is_named(&error) => return,
        unwrapped => unwrapped.unwrap_or_else(|error| panic!("{error} with {options:?}")),
    };
    let model = analysis.refined().map_or(&model, |refined| &refined.model);
    assert_eq!(atlas.uv.len(), model.corner_count());
    assert!(atlas.uv.iter().flatten().all(|x| x.is_finite()), "a corner has no finite position");
    let place = |t: &u32| atlas.triangles.corners[*t as usize].map(|c| atlas.uv[c as usize]);
    let triangles: Vec<[[f64; 2]; 3]> = atlas.on_surface().iter().map(place).collect();
    let is_told = atlas.notes.iter().any(|note| matches!(note, Note::Overlap { .. }));
    if options.islands != Islands::Single && !is_told {
        let found = overlaps(&triangles);
        assert!(found.pairs.is_empty(), "{} pairs overlap with {options:?}", found.pairs.len());
    }
}

/// Each face of a model gets a finite position in each corner, none flipped against its neighbours unless it is a needle, or
/// nothing has any area.
fn unwraps(model: &Model, options: &Options) {
    let atlas = match unwrap_model(model, options) {
        Err(Error::Prepare(PrepareError::NoArea { .. })) => return,
        atlas => atlas.expect("there is always a way"),
    };
    assert_eq!(atlas.uv.len(), model.corner_count());
    assert!(atlas.uv.iter().flatten().all(|x| x.is_finite()), "a corner has no finite position");
    assert!(atlas.cones.iter().all(|cone| cone.curvature <= TAU));
    assert!(atlas.curvature_error < 1e-9);
    let is_told = |note: &&Note| matches!(note, Note::Unfolded { .. });
    assert_eq!(atlas.unfolded, atlas.notes.iter().filter(is_told).count());
    let extent = atlas.uv.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    for surface in geom::prepare(model, options.preparation.weld).expect("it was unwrapped").surfaces {
        let metric = surface.metric();
        for f in surface.mesh.faces() {
            // Not the sides' area, which rounding makes ten million times larger where a triangle is a line.
            let [a, b, c] = surface.mesh.corners(f).map(|v| surface.points[v.index()]);
            let double_area = length(normal([a, b, c]));
            let height = double_area / metric.sides(&surface.mesh, f).0.into_iter().fold(0.0, f64::max) / surface.scale;
            let uv = surface.mesh.sides(f).map(|h| atlas.uv[surface.corner[h] as usize]);
            assert!(signed_area(uv) > 0.0 || height < NEEDLE * extent, "{f} is flipped: {uv:?}");
        }
    }
}

/// Any way to weld vertices.
pub(super) fn weld(bytes: &mut Bytes) -> geom::Weld {
    use geom::Weld;
    [Weld::Auto, Weld::Never, Weld::Always][usize::from(bytes.byte()) % 3]
}

/// Any options for a model at all.
fn any_options(bytes: &mut Bytes, model: &Model) -> Options {
    let vertex = |bytes: &mut Bytes| bytes.below(model.vertex_count() + 1) as u32;
    let edges = |bytes: &mut Bytes| -> Vec<[u32; 2]> {
        let any = |bytes: &mut Bytes| {
            let face = model.face(bytes.below(model.face_count().max(1)));
            let k = bytes.below(3);
            [face[k], face[(k + 1) % 3]]
        };
        let count = if model.face_count() > 0 && bytes.coin() { bytes.below(12) } else { 0 };
        (0..count).map(|_| any(bytes)).collect()
    };
    let mut options = options(bytes);
    match bytes.below(8) {
        0 => options.placement = Placement::Refactoring,
        1 => options.cones = ConeChoice::Each((0..1 + bytes.below(2)).map(|_| bytes.below(20)).collect()),
        2 => options.cones = ConeChoice::WithinDistortion(1.0 + 0.5 * bytes.signed().abs()),
        3 => {
            let are_known = bytes.coin();
            let given = (0..bytes.below(12)).map(|_| (vertex(bytes), are_known.then(|| TAU * bytes.signed())));
            options.cones = ConeChoice::Given(given.collect());
        }
        _ => {}
    }
    options.preparation.refine = [Refining::Never, Refining::Needles, Refining::Always][bytes.below(3)];
    options.preparation.handles = [Handles::Auto, Handles::Never, Handles::Always][bytes.below(3)];
    options.search = if bytes.coin() { Search::Full } else { Search::CoarseToFine };
    options.quantize = [None, None, Some(Symmetry::Fourfold), Some(Symmetry::Sixfold)][bytes.below(4)];
    options.islands = [Islands::OverlapFree, Islands::Single, Islands::Pack][bytes.below(3)];
    options.free_seams = [FreeSeams::Auto, FreeSeams::Never, FreeSeams::Always][bytes.below(3)];
    options.limbs = if bytes.coin() { Limbs::Never } else { Limbs::Auto };
    options.seams.weight = f64::from(bytes.byte()) / 255.0;
    options.seams.given = edges(bytes);
    options.seams.kept = edges(bytes);
    options.seams.avoid = edges(bytes);
    options.packing.rotations = [Rotations::Any, Rotations::Quarter, Rotations::None][bytes.below(3)];
    options.packing.margin = f64::from(bytes.byte() % 16);
    options
}

/// Any way to choose cones.
pub fn options(bytes: &mut Bytes) -> Options {
    Options {
        cones: match bytes.below(4) {
            0 => ConeChoice::Automatic,
            1 => ConeChoice::Count(bytes.below(4)),
            2 => ConeChoice::Count(bytes.below(40)),
            _ => ConeChoice::MinPersistence(bytes.signed().abs()),
        },
        placement: METHODS[bytes.below(METHODS.len())],
        rule: if bytes.coin() { CurvatureRule::Harmonic } else { CurvatureRule::Optimal },
        preparation: Preparation { smooth: bytes.byte() % 4 == 3, weld: weld(bytes), ..Preparation::default() },
        ..Options::default()
    }
}
