//! A domain cut into parts, each with an extremum: into basins, or into the components of a sublevel set.
//!
//! Every vertex belongs to the extremum at the end of its steepest descent (or ascent). Basins of extrema that are no
//! more persistent than a threshold are given to the basin beyond their saddle, into which a flood would spill.

use super::branches::{Branches, spilled};
use crate::domain::Domain;
use crate::error::{Error, check_threshold};
use crate::filtration::{Direction, Falling, Filtration, Kind, Rising};
use crate::options::PersistenceOptions;
use crate::pairing::{NONE, Pointing};
use crate::scalar::Scalar;
use crate::watch::Watch;

/// Every vertex with its extremum.
///
/// ```
/// use topo::{Kind, Path, segmentation};
///
/// let field = [0.0, 5.0, 3.0, 4.0, 2.0, 9.0, 1.0];
/// let valleys = segmentation(&Path::new(7), &field, Kind::Minimum, 1.0)?;
/// assert_eq!(valleys.extrema(), [0, 4, 6]); // vertex 2 is a valley only 1 deep
/// assert_eq!(valleys.labels().collect::<Vec<_>>(), [Some(0), Some(0), Some(1), Some(1), Some(1), Some(2), Some(2)]);
/// assert_eq!(valleys.vertices(1).collect::<Vec<_>>(), [2, 3, 4]);
/// # Ok::<(), topo::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Segmentation<V> {
    extrema: Vec<V>,
    /// For each vertex its segment, [`NONE`] if it has none.
    segments: Vec<u32>,
}

impl<V: Copy> Segmentation<V> {
    /// From the extremum of each segment, and the segment of each vertex, [`NONE`] if it has none.
    pub(crate) fn new(extrema: Vec<V>, segments: Vec<u32>) -> Self {
        Self { extrema, segments }
    }

    fn of_field<G: Domain<Vertex = V>, S: Scalar, D: Direction>(
        domain: G,
        filtration: &Filtration<'_, S, D>,
        threshold: S::Width,
    ) -> Result<Self, Error> {
        let branches = Branches::new(domain, filtration, Pointing::Labels)?;
        let kept = branches.longer(filtration, threshold);
        Self::of_branches(branches, &kept, &|extremum| domain.vertex(extremum as usize), filtration.watch())
    }

    fn of_branches(
        branches: Branches,
        kept: &[bool],
        name: &dyn Fn(u32) -> V,
        watch: Watch<'_>,
    ) -> Result<Self, Error> {
        let segment_of_basin = spilled(&branches.ends, kept);
        let survivors = branches.extrema.iter().zip(kept).filter(|&(_, &kept)| kept);
        let extrema = survivors.map(|(&extremum, _)| name(extremum)).collect();
        let labels = branches.basins.into_labels(watch, |basin| of_basin(&segment_of_basin, basin));
        if watch.stops() { Err(Error::Interrupted) } else { Ok(Self::new(extrema, labels)) }
    }

    /// The extremum of each segment.
    pub fn extrema(&self) -> &[V] {
        &self.extrema
    }

    /// The segment of the vertex with an index, as a place among the [extrema](Self::extrema); `None` if the vertex is
    /// in no segment or there is none.
    pub fn label(&self, index: usize) -> Option<usize> {
        self.segments.get(index).copied().and_then(label)
    }

    /// The [label](Self::label) of every vertex by index.
    pub fn labels(&self) -> impl ExactSizeIterator<Item = Option<usize>> {
        self.segments.iter().copied().map(label)
    }

    /// The vertices of a segment by rising index. O(all vertices).
    pub fn vertices(&self, segment: usize) -> impl Iterator<Item = usize> {
        self.labels().enumerate().filter(move |&(_, label)| label == Some(segment)).map(|(index, _)| index)
    }

    /// Number of vertices of each segment.
    pub fn sizes(&self) -> Vec<usize> {
        let mut sizes = vec![0; self.extrema.len()];
        self.labels().flatten().for_each(|segment| sizes[segment] += 1);
        sizes
    }

    /// The sum over each segment of what its vertices weigh, such as their areas.
    ///
    /// # Errors
    /// If there is not one weight for every vertex.
    pub fn sums(&self, weights: &[f64]) -> Result<Vec<f64>, Error> {
        let vertices = self.segments.len();
        if weights.len() != vertices {
            return Err(Error::Length { values: weights.len(), vertices });
        }
        let mut sums = vec![0.0; self.extrema.len()];
        for (label, weight) in self.labels().zip(weights) {
            if let Some(segment) = label {
                sums[segment] += weight;
            }
        }
        Ok(sums)
    }
}

/// The segment of a basin, or of a vertex in none.
pub(super) fn of_basin(segment_of_basin: &[u32], basin: u32) -> u32 {
    segment_of_basin.get(basin as usize).copied().unwrap_or(NONE)
}

fn label(segment: u32) -> Option<usize> {
    (segment != NONE).then_some(segment as usize)
}

impl PersistenceOptions {
    /// [`segmentation`](fn@crate::segmentation) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, or the threshold is NaN, see [`Error`].
    pub fn segmentation<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
        kind: Kind,
        threshold: S::Width,
    ) -> Result<Segmentation<G::Vertex>, Error> {
        self.segmentation_watched(domain, field, kind, threshold, Watch::NONE)
    }

    /// [`segmentation`](fn@crate::segmentation) with these options that can be stopped.
    ///
    /// # Errors
    /// If the field does not fit the domain, or the threshold is NaN, see [`Error`]; [`Error::Interrupted`] if the watch has stopped the work.
    pub fn segmentation_watched<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
        kind: Kind,
        threshold: S::Width,
        watch: Watch<'_>,
    ) -> Result<Segmentation<G::Vertex>, Error> {
        check_threshold(threshold)?;
        let count = domain.vertex_count();
        watch.held(|watch| match kind {
            Kind::Minimum => {
                let filtration = Filtration::<S, Rising>::new(field, count, self.nan)?.watched(watch);
                Segmentation::of_field(domain, &filtration, threshold)
            }
            Kind::Maximum => {
                let filtration = Filtration::<S, Falling>::new(field, count, self.nan)?.watched(watch);
                Segmentation::of_field(domain, &filtration, threshold)
            }
        })
    }
}

/// The basins of all minima or maxima that are more persistent than a threshold. For several thresholds see
/// [`MergeTree::segmentation`](crate::MergeTree::segmentation).
///
/// # Errors
/// If the field does not fit the domain, or the threshold is NaN, see [`Error`].
pub fn segmentation<G: Domain, S: Scalar>(
    domain: G,
    field: &[S],
    kind: Kind,
    threshold: S::Width,
) -> Result<Segmentation<G::Vertex>, Error> {
    PersistenceOptions::new().segmentation(domain, field, kind, threshold)
}
