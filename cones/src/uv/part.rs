//! A model's map, whoever made it, taken apart until no island lies over itself.

use geom::{EdgeData, EdgeId, Model, PrepareError, Prepared, Surface, Watch, Weld, prepare_watched};

use super::map::UvMap;
use super::overlap::{NEGLIGIBLE_DEPTH, Overlaps, overlaps_watched};
use super::separate::separate;
use super::triangle::Triangle;

/// A model's map whose islands do not lie over themselves.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Parted {
    /// The position of each corner of the model.
    pub uv: Vec<[f64; 2]>,
    /// The island of each of the model's triangles, numbered from 0; none for those that belong to no surface.
    pub islands: Vec<Option<u32>>,
    /// How many islands there are.
    pub island_count: usize,
    /// The pairs of triangles that lay over each other, on one island or on two.
    pub overlaps: Overlaps,
    /// How many pairs on one island could not be parted, as triangles of one polygon cannot.
    pub left: usize,
    /// How much longer the seams are now, in the model's unit.
    pub added_seam: f64,
}

/// Cuts islands that lie over themselves, attaches what was cut off where the two sides of a seam are congruent. Islands stay where they were,
/// so that they may lie over each other until they are packed ([`pack`](super::pack)). A map without any overlap comes back as it is, to the bit. `weld` takes vertices for one, as many files have several along seams. Triangles that
/// belong to no surface (of repeated vertices, copies) keep their positions unless another triangle has their corner.
///
/// ```
/// use cones::uv::part;
/// use geom::Watch;
/// // Two triangles of a strip, the second folded back over the first.
/// let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
/// let model = geom::Model::from_triangles(points, &[[0, 1, 2], [2, 1, 3]])?;
/// let [a, b, c] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
/// let parted = part(&model, &[a, b, c, c, b, a], geom::Weld::Auto, Watch::NONE)?;
/// assert_eq!((parted.overlaps.pairs.len(), parted.island_count), (1, 2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Triangles with coordinates that are not finite lie over nothing.
///
/// # Errors
/// If the model has no surface, or the work is stopped.
///
/// # Panics
/// If there is a corner without a position.
pub fn part(model: &Model, uv: &[[f64; 2]], weld: Weld, watch: Watch) -> Result<Parted, PrepareError> {
    let Prepared { surfaces, triangles, .. } = prepare_watched(model, weld, watch.within(0.0, 0.1))?;
    let images: Vec<Triangle> = triangles.corners.iter().map(|corners| corners.map(|c| uv[c as usize])).collect();
    let overlaps = overlaps_watched(&images, NEGLIGIBLE_DEPTH, |_| true, watch.within(0.1, 0.3))?;
    let mut parted = Parted {
        uv: uv.to_vec(),
        islands: vec![None; triangles.len()],
        island_count: 0,
        overlaps,
        left: 0,
        added_seam: 0.0,
    };
    let mut maps = Vec::new();
    for (k, surface) in surfaces.iter().enumerate() {
        let map = UvMap::new(&surface.mesh, surface.mesh.halfedges().map(|h| uv[surface.corner[h] as usize]).collect());
        if parted.overlaps.pairs.is_empty() {
            maps.push(map);
            continue;
        }
        let share = |k: usize| 0.3 + 0.6 * k as f64 / surfaces.len() as f64;
        let done = separate(&surface.mesh, &lengths(surface), None, map, watch.within(share(k), share(k + 1)))?;
        parted.left += done.left.pairs.len();
        parted.added_seam += done.added_seam / surface.scale;
        maps.push(done.map);
    }
    for (surface, map) in surfaces.iter().zip(&maps) {
        parted.put(surface, map);
    }
    Ok(parted)
}

impl Parted {
    /// Writes down the positions of a surface's corners.
    fn put(&mut self, surface: &Surface, map: &UvMap) {
        let islands = map.islands(&surface.mesh);
        for (f, &triangle) in surface.triangle.iter_ids() {
            let island = self.island_count + islands.of(f) as usize;
            self.islands[triangle as usize] = Some(island as u32);
            for h in surface.mesh.sides(f) {
                self.uv[surface.corner[h] as usize] = map.position[h];
            }
        }
        self.island_count += islands.count();
    }
}

/// The edges' lengths in space; none inside a polygon can be cut.
fn lengths(surface: &Surface) -> EdgeData<f64> {
    let metric = surface.metric();
    let length = |e: EdgeId| if surface.diagonal[e] { f64::INFINITY } else { metric.length(e) };
    surface.mesh.edges().map(length).collect()
}
