//! How long work goes on that is to stop: for each watched function the longest time from one question to its watch to the next,
//! the time from an answer in the middle that it must end to its return, and its own time watched and not.
//!
//! `cargo bench -p cones-geom --bench stopping`, for a hare of 134,000 vertices; `-- FILE` for another surface.

use std::hint::black_box;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use geom::distortion::{measure, measure_watched};
use geom::{
    HalfedgeId, Id, Intrinsic, Mesh, Metric, Model, Poisson, ShortestPaths, VertexData, VertexId, Watch, delaunay,
    delaunay_watched, io, laplacian, maximum_spanning_cotree, maximum_spanning_cotree_watched, minimum_spanning_tree,
    minimum_spanning_tree_watched, prepare, prepare_watched, ptolemaic_delaunay, ptolemaic_delaunay_watched, shapes,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = match std::env::args().skip(1).find(|argument| !argument.starts_with('-')) {
        Some(path) => io::read(Path::new(&path))?,
        None => Model::from(shapes::hare(134_000)),
    };
    println!("{:<24}{:>10}{:>10}{:>10}{:>10}   ms", "", "plain", "watched", "unasked", "to return");
    row("prepare", || prepare(&model, geom::Weld::Auto), |watch| prepare_watched(&model, geom::Weld::Auto, watch));
    let surface = prepare(&model, geom::Weld::Auto)?.surfaces.swap_remove(0);
    let mesh = &surface.mesh;
    let metric = surface.metric();
    row("delaunay", || delaunay(mesh, &metric), |watch| delaunay_watched(mesh, &metric, watch));
    let intrinsic = delaunay(mesh, &metric);
    let u: Vec<f64> = (0..mesh.vertex_count()).map(|v| 1.5 * (v as f64 * 1e-3).sin()).collect();
    let flipped = |watch: Option<Watch>| ptolemaic(intrinsic.clone(), &u, watch);
    row("ptolemaic_delaunay", || flipped(None), |watch| flipped(Some(watch)));
    let matrix = laplacian(&intrinsic.triangulation, &intrinsic.metric);
    let points = &surface.points[..];
    row("Poisson::new", || Poisson::new(&matrix, &[]), |watch| Poisson::new_watched(matrix.clone(), &[], None, watch));
    row(
        "Poisson::with_points",
        || Poisson::with_points(&matrix, &[], points),
        |watch| Poisson::new_watched(matrix.clone(), &[], Some(points), watch),
    );
    let poisson = Poisson::with_points(&matrix, &[], points)?;
    row("Poisson::another", || poisson.another(&matrix), |watch| poisson.another_watched(matrix.clone(), watch));
    let dipoles: Vec<Vec<(VertexId, f64)>> =
        (0..32).map(|k| vec![(VertexId(k), 1.0), (VertexId(3000 + k), -1.0)]).collect();
    row(
        "Poisson::solve_sparse",
        || poisson.solve_sparse(&dipoles),
        |watch| poisson.solve_sparse_watched(&dipoles, watch),
    );
    let dense: Vec<VertexData<f64>> = dipoles.iter().map(|dipole| spread(dipole, mesh)).collect();
    row("Poisson::solve_many", || poisson.solve_many(&dense), |watch| poisson.solve_many_watched(&dense, watch));
    let lengths = metric.lengths();
    let source = [(VertexId(0), 0)];
    row(
        "ShortestPaths::new",
        || ShortestPaths::new(mesh, lengths, source),
        |watch| ShortestPaths::new_watched(mesh, lengths, source, watch),
    );
    row(
        "minimum_spanning_tree",
        || minimum_spanning_tree(mesh, lengths),
        |watch| minimum_spanning_tree_watched(mesh, lengths, watch),
    );
    let tree = minimum_spanning_tree(mesh, lengths);
    row(
        "maximum_spanning_cotree",
        || maximum_spanning_cotree(mesh, lengths, &tree),
        |watch| maximum_spanning_cotree_watched(mesh, lengths, &tree, watch),
    );
    let triangles: Vec<[u32; 3]> = mesh.faces().map(|f| mesh.corners(f).map(|v| v.0)).collect();
    let uv: Vec<[[f64; 2]; 3]> =
        triangles.iter().map(|t| t.map(|v| [points[v as usize][0], points[v as usize][1]])).collect();
    row(
        "distortion::measure",
        || measure(points, &triangles, &uv),
        |watch| measure_watched(points, &triangles, &uv, watch),
    );
    Ok(())
}

fn ptolemaic(intrinsic: Intrinsic, u: &[f64], watch: Option<Watch>) -> (Metric, Vec<HalfedgeId>) {
    let Intrinsic { mut triangulation, mut metric, mut flips } = intrinsic;
    let scaled = match watch {
        None => ptolemaic_delaunay(&mut triangulation, &mut metric, u, &mut flips),
        Some(watch) => ptolemaic_delaunay_watched(&mut triangulation, &mut metric, u, &mut flips, watch),
    };
    (scaled, flips)
}

fn spread(entries: &[(VertexId, f64)], mesh: &Mesh) -> VertexData<f64> {
    let mut all = VertexData::constant(mesh.vertex_count(), 0.0);
    entries.iter().for_each(|&(v, value)| all[VertexId::new(v.index())] = value);
    all
}

/// Times a function, each figure the least of three.
fn row<T, U>(name: &str, plain: impl Fn() -> T, watched: impl Fn(Watch) -> U) {
    let unwatched = least(|| timed(|| drop(black_box(plain()))));
    let told = least(|| timed(|| drop(black_box(watched(Watch::new(&|_| ControlFlow::Continue(())))))));
    let unasked = least(|| longest_pause(&watched));
    let to_return = least(|| return_time(&watched));
    let [unwatched, told, unasked, to_return] =
        [unwatched, told, unasked, to_return].map(|time| 1e3 * time.as_secs_f64());
    println!("{name:<24}{unwatched:>10.1}{told:>10.1}{unasked:>10.1}{to_return:>10.1}");
}

fn least(time: impl Fn() -> Duration) -> Duration {
    (0..3).map(|_| time()).min().unwrap_or_default()
}

fn timed(work: impl FnOnce()) -> Duration {
    let start = Instant::now();
    work();
    start.elapsed()
}

/// The longest time from the start to the first question, from one to the next, from the last to the end.
fn longest_pause<U>(watched: impl Fn(Watch) -> U) -> Duration {
    let state = Mutex::new((Instant::now(), Duration::ZERO));
    let observer = |_| {
        if let Ok(mut state) = state.lock() {
            *state = (Instant::now(), state.1.max(state.0.elapsed()));
        }
        ControlFlow::Continue(())
    };
    let result = watched(Watch::new(&observer));
    _ = observer(1.0);
    drop(black_box(result));
    state.into_inner().map(|state| state.1).unwrap_or_default()
}

/// The time from the answer that the work must end, given when half of it is done, to the return.
fn return_time<U>(watched: impl Fn(Watch) -> U) -> Duration {
    let stopped = Mutex::new(None);
    let observer = |fraction: f64| {
        if fraction < 0.5 {
            return ControlFlow::Continue(());
        }
        if let Ok(mut stopped) = stopped.lock() {
            stopped.get_or_insert_with(Instant::now);
        }
        ControlFlow::Break(())
    };
    drop(black_box(watched(Watch::new(&observer))));
    stopped.into_inner().ok().flatten().map_or(Duration::ZERO, |at| at.elapsed())
}
