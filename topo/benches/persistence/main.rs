//! Time per vertex on smooth noise, beside what any method that sorts must spend: `sort_unstable` of the keys.
//!
//! Memory is reported too: `max alloc` over the number of vertices is what a call takes beyond its input.
//!
//! Run `cargo bench -p cones-topo`; with `--features rayon` the grids and the mesh use all threads.

mod terrain;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use std::sync::OnceLock;
use topo::{Connectivity, Diagram, Domain, Grid, Kind, Path, PersistenceOptions, Scalar, Summary, Tile, TriangleMesh};

#[global_allocator]
static ALLOCATIONS: divan::AllocProfiler = divan::AllocProfiler::system();

fn main() {
    divan::main();
}

const SHAPES: [[usize; 3]; 4] = [[1, 1024, 1024], [1, 4096, 4096], [128, 128, 128], [256, 256, 256]];

/// The field of one of the shapes, made once.
fn field(shape: usize) -> &'static [f64] {
    static FIELDS: [OnceLock<Vec<f64>>; 4] = [const { OnceLock::new() }; 4];
    FIELDS[shape].get_or_init(|| terrain::on_grid(SHAPES[shape]))
}

fn names(shape: usize) -> &'static str {
    ["2d 1024", "2d 4096", "3d 128", "3d 256"][shape]
}

#[derive(Clone, Copy)]
struct Shape(usize);

impl std::fmt::Display for Shape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(names(self.0))
    }
}

const ALL: [Shape; 4] = [Shape(0), Shape(1), Shape(2), Shape(3)];

#[divan::bench(args = ALL, sample_count = 5, sample_size = 1)]
fn floor_sort_unstable(bencher: Bencher<'_, '_>, shape: Shape) {
    sort_floor(bencher, field(shape.0));
}

fn sort_floor(bencher: Bencher<'_, '_>, field: &[f64]) {
    bencher.counter(ItemsCount::new(field.len())).with_inputs(|| keys(field)).bench_local_values(|mut keys| {
        keys.sort_unstable();
        keys
    });
}

fn keys(field: &[f64]) -> Vec<(u64, u32)> {
    field.iter().zip(0..).filter_map(|(value, vertex)| Some((value.key()?, vertex))).collect()
}

fn bench_sublevel<G: Domain>(bencher: Bencher<'_, '_>, domain: G, field: &[f64]) {
    bencher.counter(ItemsCount::new(field.len())).bench_local(|| topo::sublevel(domain, black_box(field)));
}

fn bench_grid(bencher: Bencher<'_, '_>, shape: Shape, connectivity: Connectivity) {
    match SHAPES[shape.0] {
        [1, ny, nx] => bench_sublevel(bencher, &Grid::new([ny, nx], connectivity), field(shape.0)),
        shape_3d => bench_sublevel(bencher, &Grid::new(shape_3d, connectivity), field(shape.0)),
    }
}

#[divan::bench(args = ALL, sample_count = 5, sample_size = 1)]
fn sublevel_freudenthal(bencher: Bencher<'_, '_>, shape: Shape) {
    bench_grid(bencher, shape, Connectivity::Freudenthal);
}

#[divan::bench(args = ALL, sample_count = 5, sample_size = 1)]
fn sublevel_axis(bencher: Bencher<'_, '_>, shape: Shape) {
    bench_grid(bencher, shape, Connectivity::Axis);
}

#[divan::bench(args = ALL, sample_count = 5, sample_size = 1)]
fn sublevel_full(bencher: Bencher<'_, '_>, shape: Shape) {
    bench_grid(bencher, shape, Connectivity::Full);
}

#[divan::bench(args = [Shape(0)], sample_count = 5, sample_size = 1)]
fn plain_sweep(bencher: Bencher<'_, '_>, shape: Shape) {
    let [_, ny, nx] = SHAPES[shape.0];
    let grid = Grid::new([ny, nx], Connectivity::Freudenthal);
    let field = field(shape.0);
    let options = PersistenceOptions::new().plain_sweep();
    bencher.counter(ItemsCount::new(field.len())).bench_local(|| options.sublevel(&grid, black_box(field)));
}

/// What is read off from the same scan, on the smallest picture and volume.
mod features {
    use super::*;

    const SMALL: [Shape; 2] = [Shape(0), Shape(2)];

    fn on_grid<R>(
        bencher: Bencher<'_, '_>,
        shape: Shape,
        of_2d: fn(&Grid<2>, &[f64]) -> R,
        of_3d: fn(&Grid<3>, &[f64]) -> R,
    ) {
        let field = field(shape.0);
        let bencher = bencher.counter(ItemsCount::new(field.len()));
        match SHAPES[shape.0] {
            [1, ny, nx] => {
                let grid = Grid::new([ny, nx], Connectivity::Freudenthal);
                bencher.bench_local(|| of_2d(&grid, black_box(field)));
            }
            shape => {
                let grid = Grid::new(shape, Connectivity::Freudenthal);
                bencher.bench_local(|| of_3d(&grid, black_box(field)));
            }
        }
    }

    #[divan::bench(args = SMALL, sample_count = 5, sample_size = 1)]
    fn merge_tree(bencher: Bencher<'_, '_>, shape: Shape) {
        on_grid(
            bencher,
            shape,
            |g, f| topo::merge_tree(g, f, Kind::Minimum).map(|tree| tree.leaf_count()),
            |g, f| topo::merge_tree(g, f, Kind::Minimum).map(|tree| tree.leaf_count()),
        );
    }

    #[divan::bench(args = SMALL, sample_count = 5, sample_size = 1)]
    fn segmentation(bencher: Bencher<'_, '_>, shape: Shape) {
        on_grid(
            bencher,
            shape,
            |g, f| topo::segmentation(g, f, Kind::Minimum, 0.5),
            |g, f| topo::segmentation(g, f, Kind::Minimum, 0.5),
        );
    }

    #[divan::bench(args = SMALL, sample_count = 5, sample_size = 1)]
    fn holes(bencher: Bencher<'_, '_>, shape: Shape) {
        on_grid(bencher, shape, |g, f| topo::holes(g, f, Kind::Minimum), |g, f| topo::holes(g, f, Kind::Minimum));
    }
}

/// White noise, where a fifth to a seventh of all vertices are minima.
mod noise {
    use super::*;

    fn noise() -> Vec<f64> {
        (0..1 << 20).map(|v| terrain::hash(7, [v, 0, 0])).collect()
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn floor_sort_unstable(bencher: Bencher<'_, '_>) {
        sort_floor(bencher, &noise());
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn sublevel_freudenthal(bencher: Bencher<'_, '_>) {
        bench_sublevel(bencher, &Grid::new([1024, 1024], Connectivity::Freudenthal), &noise());
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn ranked(bencher: Bencher<'_, '_>) {
        let (grid, field) = (Grid::new([1024, 1024], Connectivity::Freudenthal), noise());
        bencher.bench_local(|| topo::sublevel(&grid, &field).map(|pairs| pairs.ranked()));
    }
}

/// Distances of diagrams of uniform points, to 1 %.
mod distances {
    use super::*;

    fn diagram(points: usize, seed: u64) -> Diagram {
        let point = |i: i64| (terrain::hash(seed, [i, 0, 0]), terrain::hash(seed, [i, 1, 0]));
        let finite = (0..points as i64).map(point).map(|(birth, width)| (birth, birth + width)).collect();
        Diagram { kind: Kind::Minimum, finite, essential: vec![] }
    }

    #[divan::bench(args = [200, 1000, 3000], sample_count = 3, sample_size = 1)]
    fn wasserstein(bencher: Bencher<'_, '_>, points: usize) {
        let (a, b) = (diagram(points, 1), diagram(points, 2));
        bencher.bench_local(|| a.wasserstein(&b, 2.0));
    }

    #[divan::bench(args = [200, 1000], sample_count = 3, sample_size = 1)]
    fn bottleneck(bencher: Bencher<'_, '_>, points: usize) {
        let (a, b) = (diagram(points, 1), diagram(points, 2));
        bencher.bench_local(|| a.bottleneck(&b));
    }
}

/// A picture in sixteen tiles, their values copied out of the whole, against the same in one piece.
mod tiles {
    use super::*;

    fn noise() -> &'static [f64] {
        static NOISE: OnceLock<Vec<f64>> = OnceLock::new();
        NOISE.get_or_init(|| (0..1 << 22).map(|v| terrain::hash(7, [v, 0, 0])).collect())
    }

    fn summary(tile: &Tile<2>, field: &[f64]) -> Summary<f64> {
        let values = tile.values(field).expect("of the grid");
        Summary::of_tile(tile, &values, Kind::Minimum, PersistenceOptions::new()).expect("it fits")
    }

    fn in_sixteen(bencher: Bencher<'_, '_>, side: usize, field: &[f64]) {
        let grid = Grid::new([side, side], Connectivity::Freudenthal);
        let tiles = Tile::cut(&grid, [&[side / 4; 4]; 2]).expect("the parts fit");
        bencher.counter(ItemsCount::new(field.len())).bench_local(|| {
            let join = |a: Summary<f64>, b| a.join(b).expect("alike");
            let rows = tiles.chunks(4).map(|row| row.iter().map(|tile| summary(tile, black_box(field))).reduce(join));
            rows.flatten().reduce(join).map(Summary::finish)
        });
    }

    /// How many vertices and bytes a tile comes to, those of its pairs aside.
    fn tell(field: &[f64], side: usize) {
        let grid = Grid::new([side, side], Connectivity::Freudenthal);
        let tiles = Tile::cut(&grid, [&[side / 4; 4]; 2]).expect("the parts fit");
        let mut summary = summary(&tiles[5], field);
        let pairs = summary.take_pairs().len();
        let bytes = summary.to_bytes().len() as f64 / (tiles[5].shape().iter().product::<usize>() * 8) as f64;
        eprintln!(
            "{pairs} pairs, {} vertices, {} shared, {bytes:.4} of the tile",
            summary.vertex_count(),
            summary.shared_count()
        );
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn smooth_in_one_piece(bencher: Bencher<'_, '_>) {
        bench_grid(bencher, Shape(1), Connectivity::Freudenthal);
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn smooth_in_sixteen(bencher: Bencher<'_, '_>) {
        tell(field(1), 4096);
        in_sixteen(bencher, 4096, field(1));
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn noise_in_one_piece(bencher: Bencher<'_, '_>) {
        bench_sublevel(bencher, &Grid::new([2048, 2048], Connectivity::Freudenthal), noise());
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn noise_in_sixteen(bencher: Bencher<'_, '_>) {
        tell(noise(), 2048);
        in_sixteen(bencher, 2048, noise());
    }
}

mod path {
    use super::*;

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn floor_sort_unstable(bencher: Bencher<'_, '_>) {
        sort_floor(bencher, field(0));
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn sublevel(bencher: Bencher<'_, '_>) {
        bench_sublevel(bencher, &Path::new(field(0).len()), field(0));
    }
}

mod mesh {
    //! A torus of a million vertices, with vertices numbered along a space-filling order as meshes mostly are.
    use super::*;
    use petgraph::graph::UnGraph;

    const SIDE: u32 = 1024;

    fn triangles() -> Vec<[u32; 3]> {
        let at = |y: u32, x: u32| number(y % SIDE, x % SIDE);
        let squares = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (y, x)));
        squares
            .flat_map(|(y, x)| {
                let [a, b, c, d] = [at(y, x), at(y, x + 1), at(y + 1, x + 1), at(y + 1, x)];
                [[a, b, c], [a, c, d]]
            })
            .collect()
    }

    /// Interleaves the bits of the coordinates (Morton 1966).
    fn number(y: u32, x: u32) -> u32 {
        (0..10).fold(0, |number, bit| number | (x >> bit & 1) << (2 * bit) | (y >> bit & 1) << (2 * bit + 1))
    }

    fn mesh_field() -> Vec<f64> {
        let rows = field(0);
        let mut numbered = vec![0.0; rows.len()];
        for y in 0..SIDE {
            for x in 0..SIDE {
                numbered[number(y, x) as usize] = rows[(y * SIDE + x) as usize];
            }
        }
        numbered
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn floor_sort_unstable(bencher: Bencher<'_, '_>) {
        sort_floor(bencher, &mesh_field());
    }

    fn mesh() -> TriangleMesh {
        TriangleMesh::new((SIDE * SIDE) as usize, &triangles()).expect("corners exist")
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn checking_triangles(bencher: Bencher<'_, '_>) {
        let triangles = triangles();
        bencher
            .counter(ItemsCount::new(SIDE * SIDE))
            .bench_local(|| TriangleMesh::new((SIDE * SIDE) as usize, black_box(&triangles)));
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn making_rings(bencher: Bencher<'_, '_>) {
        let bencher = bencher.counter(ItemsCount::new(SIDE * SIDE)).with_inputs(mesh);
        bencher.bench_local_values(|mesh| {
            (&mesh).for_each_neighbor(0, |_| ());
            mesh
        });
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn sublevel_triangles(bencher: Bencher<'_, '_>) {
        bench_sublevel(bencher, &mesh(), &mesh_field());
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn sublevel_rings(bencher: Bencher<'_, '_>) {
        let mesh = mesh();
        (&mesh).for_each_neighbor(0, |_| ());
        bench_sublevel(bencher, &mesh, &mesh_field());
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn sublevel_adjacency(bencher: Bencher<'_, '_>) {
        let field = mesh_field();
        let edges: Vec<_> =
            triangles().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(|e| e.map(|v| v as usize)).collect();
        let graph = topo::Adjacency::from_edges(field.len(), &edges).expect("ends exist");
        bench_sublevel(bencher, &graph, &field);
    }

    #[divan::bench(sample_count = 5, sample_size = 1)]
    fn sublevel_ungraph(bencher: Bencher<'_, '_>) {
        let field = mesh_field();
        let edges = triangles().into_iter().flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]);
        let graph = UnGraph::<(), ()>::from_edges(edges.filter(|(a, b)| a < b));
        bench_sublevel(bencher, &graph, &field);
    }
}
