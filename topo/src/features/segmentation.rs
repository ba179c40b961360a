//! A domain cut into the basins of its extrema.
//!
//! Every vertex belongs to the extremum at the end of its steepest descent (or ascent). Basins of extrema that are no
//! more persistent than a threshold are given to the basin beyond their saddle, into which a flood would spill.

use super::branches::Branches;
use crate::domain::Domain;
use crate::error::Error;
use crate::filtration::{Direction, Falling, Filtration, Kind, Rising};
use crate::options::PersistenceOptions;
use crate::pairing::UnionFind;
use crate::scalar::Scalar;

/// Every vertex with its extremum.
///
/// ```
/// use topo::{Kind, Path, segmentation};
///
/// let field = [0.0, 5.0, 3.0, 4.0, 2.0, 9.0, 1.0];
/// let valleys = segmentation(&Path::new(7), &field, Kind::Minimum, 1.0)?;
/// assert_eq!(valleys.extrema(), [0, 4, 6]); // vertex 2 is a valley only 1 deep
/// assert_eq!(valleys.labels().collect::<Vec<_>>(), [Some(0), Some(0), Some(1), Some(1), Some(1), Some(2), Some(2)]);
/// # Ok::<(), topo::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Segmentation<V> {
    extrema: Vec<V>,
    segments: Vec<Option<u32>>,
}

impl<V: Copy> Segmentation<V> {
    pub(crate) fn new<G: Domain<Vertex = V>, S: Scalar, D: Direction>(
        domain: G,
        filtration: &Filtration<'_, S, D>,
        threshold: S::Width,
    ) -> Self {
        let branches = Branches::new(domain, filtration);
        let mut groups = UnionFind::new(branches.extrema.len());
        let mut survives = vec![true; branches.extrema.len()];
        for end in branches.short(filtration, threshold) {
            survives[end.extremum as usize] = false;
            let (from, to) = (groups.find(end.extremum), groups.find(end.beyond));
            groups.join(from, to);
        }
        // Every branch spills into another component, so spills close no circle: each group is a tree of them, with one
        // extremum that did not spill, whichever member is the root of the union-find.
        let mut segment_of_group = vec![None; branches.extrema.len()];
        let survivors: Vec<u32> =
            (0..).zip(&survives).filter(|&(_, &survives)| survives).map(|(basin, _)| basin).collect();
        for (segment, &basin) in (0u32..).zip(&survivors) {
            segment_of_group[groups.find(basin) as usize] = Some(segment);
        }
        let segments =
            branches.basins.iter().map(|basin| basin.and_then(|basin| segment_of_group[groups.find(basin) as usize]));
        let segments = segments.collect();
        let vertex = |&basin: &u32| domain.vertex(branches.extrema[basin as usize] as usize);
        Self { extrema: survivors.iter().map(vertex).collect(), segments }
    }

    /// The extremum of each segment.
    pub fn extrema(&self) -> &[V] {
        &self.extrema
    }

    /// The segment of the vertex with an index, as a place among the [extrema](Self::extrema); `None` if the vertex is
    /// masked or there is none.
    pub fn label(&self, index: usize) -> Option<usize> {
        self.segments.get(index).copied().flatten().map(|segment| segment as usize)
    }

    /// The [label](Self::label) of every vertex by index.
    pub fn labels(&self) -> impl ExactSizeIterator<Item = Option<usize>> {
        self.segments.iter().map(|segment| segment.map(|segment| segment as usize))
    }

    /// Number of vertices of each segment.
    pub fn sizes(&self) -> Vec<usize> {
        let mut sizes = vec![0; self.extrema.len()];
        self.labels().flatten().for_each(|segment| sizes[segment] += 1);
        sizes
    }
}

impl PersistenceOptions {
    /// [`segmentation`](fn@crate::segmentation) with these options.
    ///
    /// # Errors
    /// If the field does not fit the domain, see [`Error`].
    pub fn segmentation<G: Domain, S: Scalar>(
        self,
        domain: G,
        field: &[S],
        kind: Kind,
        threshold: S::Width,
    ) -> Result<Segmentation<G::Vertex>, Error> {
        let count = domain.vertex_count();
        Ok(match kind {
            Kind::Minimum => {
                Segmentation::new(domain, &Filtration::<S, Rising>::new(field, count, self.nan)?, threshold)
            }
            Kind::Maximum => {
                Segmentation::new(domain, &Filtration::<S, Falling>::new(field, count, self.nan)?, threshold)
            }
        })
    }
}

/// The basins of all minima or maxima that are more persistent than a threshold.
///
/// # Errors
/// If the field does not fit the domain, see [`Error`].
pub fn segmentation<G: Domain, S: Scalar>(
    domain: G,
    field: &[S],
    kind: Kind,
    threshold: S::Width,
) -> Result<Segmentation<G::Vertex>, Error> {
    PersistenceOptions::new().segmentation(domain, field, kind, threshold)
}
