//! A model's map, whoever made it, taken apart until no island lies over itself.

use geom::{
    EdgeData, EdgeId, Interrupted, Model, PrepareError, Prepared, Surface, Triangles, Watch, Weld, are, prepare_watched,
};
use thiserror::Error;

use super::companions::{Corners, leaders};
use super::map::UvMap;
use super::overlap::{Overlaps, overlaps_watched, rounding_depth};
use super::repack::images;
use super::separate::separate_deeper;
use super::triangle::Triangle;

/// The two sides of an edge whose ends are this near, over the map's extent, are the same: files round.
const ROUNDING: f64 = 1e-6;

/// Why a map cannot be taken apart.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum PartError {
    /// The model has no surface.
    #[error(transparent)]
    Prepare(PrepareError),
    /// Texture coordinates are one for each corner of the model's faces.
    #[error("there {} for {corners} corners of faces", are(*found, "texture coordinate", "texture coordinates"))]
    TextureCount {
        /// How many texture coordinates there are.
        found: usize,
        /// How many corners there are.
        corners: usize,
    },
    /// The work was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl From<PrepareError> for PartError {
    fn from(error: PrepareError) -> Self {
        match error {
            PrepareError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Prepare(error),
        }
    }
}

/// A model's map whose islands do not lie over themselves.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Parted {
    /// The position of each corner of the model.
    pub uv: Vec<[f64; 2]>,
    /// The island of each of the model's triangles, numbered from 0; none for those that have a vertex twice and no corner in common with any
    /// other. Copies of triangles are on the island of the one that they lie on, or on one of their own where they lie elsewhere.
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
/// so that they may lie over each other until they are packed ([`repack`](super::repack)). A map without any overlap comes back as it is, to the bit. `weld` takes vertices for one, as many files have several along seams. Triangles that
/// belong to no surface, of repeated vertices or copies, go where the triangle goes with which they have corners in common.
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
/// Triangles with coordinates that are not finite lie over nothing, and what single precision [explains](rounding_depth) is no overlap.
///
/// # Errors
/// If there are more or fewer positions than corners, the model has no surface, or the work is stopped.
pub fn part(model: &Model, uv: &[[f64; 2]], weld: Weld, watch: Watch) -> Result<Parted, PartError> {
    let (found, corners) = (uv.len(), model.corner_count());
    if found != corners {
        return Err(PartError::TextureCount { found, corners });
    }
    let Prepared { surfaces, triangles, left_out, .. } = prepare_watched(model, weld, watch.within(0.0, 0.1))?;
    let images = images(&triangles.corners, uv);
    let mut vertices = triangles.vertices(model);
    weld.apply(model, &mut vertices);
    let corners = Corners { vertices: &vertices, uv: &images };
    let companions = companions_of(corners, &left_out);
    let deeper_than = rounding_depth(&images);
    let overlaps = overlaps_of(&images, &companions, watch.within(0.1, 0.3))?;
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
        let position = surface.mesh.halfedges().map(|h| uv[surface.corner[h] as usize]).collect();
        if parted.overlaps.pairs.is_empty() {
            maps.push(UvMap::new(&surface.mesh, position));
            continue;
        }
        let map = UvMap::nearly(&surface.mesh, position, ROUNDING * parted.overlaps.extent);
        let share = |k: usize| 0.3 + 0.6 * k as f64 / surfaces.len() as f64;
        let watch = watch.within(share(k), share(k + 1));
        let done = separate_deeper(&surface.mesh, &lengths(surface), None, (map, deeper_than), watch)?;
        parted.left += done.left.pairs.len();
        parted.added_seam += done.added_seam / surface.scale;
        maps.push(done.map);
    }
    for (surface, map) in surfaces.iter().zip(&maps) {
        parted.put(surface, map);
    }
    parted.put_left_out(&triangles, corners, (&left_out, &companions));
    Ok(parted)
}

/// The companions of triangles, which are on surfaces where any are.
fn companions_of(corners: Corners, left_out: &[u32]) -> Vec<Option<u32>> {
    let mut is_left_out = vec![false; corners.vertices.len()];
    left_out.iter().for_each(|&t| is_left_out[t as usize] = true);
    let on_surface = (0..).zip(&is_left_out).filter_map(|(t, is_left_out)| (!is_left_out).then_some(t));
    corners.companions(on_surface.chain(left_out.iter().copied()))
}

/// The pairs of triangles that lie over each other, without those that only lie where others of the same corners do.
fn overlaps_of(images: &[Triangle], companions: &[Option<u32>], watch: Watch) -> Result<Overlaps, Interrupted> {
    let kept = leaders(companions);
    let kept_images: Vec<Triangle> = kept.iter().map(|&t| images[t as usize]).collect();
    let mut overlaps = overlaps_watched(&kept_images, rounding_depth(&kept_images), |_| true, watch)?;
    for pair in &mut overlaps.pairs {
        pair.triangles = pair.triangles.map(|t| kept[t as usize]);
    }
    Ok(overlaps)
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

    /// Puts triangles that belong to no surface on islands: on those of which they have corners, or on ones of their own.
    fn put_left_out(
        &mut self,
        triangles: &Triangles,
        corners: Corners,
        (left_out, companions): (&[u32], &[Option<u32>]),
    ) {
        let mut of_corner = vec![None; self.uv.len()];
        for (own, &island) in triangles.corners.iter().zip(&self.islands) {
            own.iter().filter(|_| island.is_some()).for_each(|&c| of_corner[c as usize] = island);
        }
        let (copies, alone): (Vec<u32>, Vec<u32>) = left_out.iter().partition(|&&t| companions[t as usize] != Some(t));
        let mut apart = Vec::new();
        for t in alone {
            self.islands[t as usize] = triangles.corners[t as usize].iter().find_map(|&c| of_corner[c as usize]);
            if self.islands[t as usize].is_none() {
                apart.push(t);
            }
        }
        let numbers = corners.connected(&apart);
        for (&t, &number) in apart.iter().zip(&numbers) {
            self.islands[t as usize] = Some(self.island_count as u32 + number);
        }
        self.island_count += numbers.iter().max().map_or(0, |&last| last as usize + 1);
        for t in copies {
            let Some(companion) = companions[t as usize] else { continue };
            self.islands[t as usize] = self.islands[companion as usize];
            let own = triangles.corners[t as usize];
            for (k, c) in own.into_iter().enumerate().filter(|&(_, c)| of_corner[c as usize].is_none()) {
                // The rest of a triangle that has a vertex twice goes where one of its corners does, so that it lies over nothing.
                let same = (0..3).find(|&other| corners.corner(companion, other) == corners.corner(t, k));
                let at = same.or_else(|| {
                    let shared =
                        |other: &usize| (0..3).any(|k| corners.corner(t, k) == corners.corner(companion, *other));
                    (0..3).find(shared)
                });
                if let Some(other) = at {
                    self.uv[c as usize] = self.uv[triangles.corners[companion as usize][other] as usize];
                }
            }
        }
    }
}

/// The edges' lengths in space; none inside a polygon can be cut.
fn lengths(surface: &Surface) -> EdgeData<f64> {
    let metric = surface.metric();
    let length = |e: EdgeId| if surface.diagonal[e] { f64::INFINITY } else { metric.length(e) };
    surface.mesh.edges().map(length).collect()
}
