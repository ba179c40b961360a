//! Boxes into which a grid is cut, each with one layer of the next ones.

use crate::domain::{Domain, Grid};
use crate::error::{Error, check_vertex_count};
use core::ops::Range;

/// A box of a grid that is cut by planes right through: what a chunk of a chunked array holds.
///
/// A tile is named by the vertices that are its own, a range along each axis. Beyond the upper end of each range it also
/// has the layer after it, if there is one (round the end of a periodic axis it is the first): so each edge lies in a tile.
/// Its values are those of all these vertices, as [`shape`](Self::shape) says.
///
/// ```text
///    own    own
///   a b c | d e       the first tile has the values of a b c d, the second those of d e;
///   f g h | i j       d and i are shared
/// ```
///
/// All tiles of a grid must be made by the same cuts. Other partitions are summed up with
/// [`Summary::of_block`](crate::Summary::of_block).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tile<const D: usize> {
    grid: Grid<D>,
    domain: Grid<D>,
    start: [usize; D],
    /// For each axis whether the first and the last layer of the tile are shared with others.
    shared: [[bool; 2]; D],
}

impl<const D: usize> Tile<D> {
    /// The tile with the vertices in a range along each axis for its own.
    ///
    /// # Errors
    /// If a range is empty or goes beyond the grid, or the grid or the tile has more vertices than can be numbered.
    pub fn new(grid: &Grid<D>, own: [Range<usize>; D]) -> Result<Self, Error> {
        let (lengths, periodic) = (grid.shape(), grid.periodic_axes());
        if lengths.iter().try_fold(1u64, |count, &length| count.checked_mul(length as u64)).is_none() {
            return Err(Error::TooLarge { vertices: usize::MAX });
        }
        let (mut shape, mut round, mut shared) = ([0; D], [false; D], [[false; 2]; D]);
        for axis in 0..D {
            let (Range { start, end }, length) = (own[axis].clone(), lengths[axis]);
            if start >= end || end > length {
                return Err(Error::Tile { axis });
            }
            let is_cut = end - start < length;
            shared[axis] = [start > 0, end < length].map(|goes_on| is_cut && (goes_on || periodic[axis]));
            shape[axis] = end - start + usize::from(shared[axis][1]);
            // Only so do edges between all vertices of the tile lie in it, which the choice of what is kept asks for.
            round[axis] = periodic[axis] && shape[axis] == length;
        }
        let domain = Grid::new(shape, grid.connectivity()).periodic(round);
        check_vertex_count((&domain).vertex_count())?;
        Ok(Self { grid: *grid, domain, start: own.map(|own| own.start), shared })
    }

    /// All tiles of a grid that is cut into parts of so many vertices along each axis; the last axis goes fastest.
    ///
    /// # Errors
    /// If the parts of an axis do not make up the grid or one of them is empty.
    pub fn cut(grid: &Grid<D>, parts: [&[usize]; D]) -> Result<Vec<Self>, Error> {
        let mut tiles: Vec<Vec<Range<usize>>> = vec![Vec::new()];
        for (axis, (parts, length)) in parts.into_iter().zip(grid.shape()).enumerate() {
            let mut start = 0usize;
            let mut ranges = Vec::with_capacity(parts.len());
            for &part in parts {
                let next = start.checked_add(part).ok_or(Error::Tile { axis })?;
                ranges.push(start..next);
                start = next;
            }
            if start != length {
                return Err(Error::Tile { axis });
            }
            let extended =
                |tile: &Vec<Range<usize>>, range: &Range<usize>| [&tile[..], core::slice::from_ref(range)].concat();
            tiles = tiles.iter().flat_map(|tile| ranges.iter().map(move |range| extended(tile, range))).collect();
        }
        tiles.into_iter().map(|own| Self::new(grid, core::array::from_fn(|axis| own[axis].clone()))).collect()
    }

    /// The position in the grid of the first vertex.
    pub fn start(&self) -> [usize; D] {
        self.start
    }

    /// How many vertices the tile has along each axis, its own and the layer after them.
    pub fn shape(&self) -> [usize; D] {
        self.domain.shape()
    }

    /// The vertex of the whole grid that a vertex of the tile is.
    pub fn vertex(&self, of_tile: usize) -> u64 {
        let (position, lengths) = (self.domain.position(of_tile), self.grid.shape());
        (0..D).fold(0, |vertex, axis| {
            let at = self.start[axis] + position[axis];
            let at = if at < lengths[axis] { at } else { at - lengths[axis] };
            vertex * lengths[axis] as u64 + at as u64
        })
    }

    /// The values of the tile out of those of the whole grid.
    ///
    /// # Errors
    /// If the field has not one value for each vertex of the grid.
    pub fn values<S: Copy>(&self, field: &[S]) -> Result<Vec<S>, Error> {
        let vertices = (&self.grid).vertex_count();
        if field.len() != vertices {
            return Err(Error::Length { values: field.len(), vertices });
        }
        Ok((0..(&self.domain).vertex_count()).map(|v| field[self.vertex(v) as usize]).collect())
    }

    /// The grid that the tile is by itself.
    pub(super) fn domain(&self) -> &Grid<D> {
        &self.domain
    }

    /// Whether its vertices are not in the order of the whole grid's, because it goes round the end of an axis.
    pub(super) fn goes_round(&self) -> bool {
        let ends = self.start.iter().zip(self.shape());
        ends.zip(self.grid.shape()).any(|((start, length), whole)| start + length > whole)
    }

    /// The shared vertices that enter and are to be kept, by rising index, each with the number of tiles that have it.
    ///
    /// A vertex is left out if one of its neighbours enters before it that lies in all planes of cuts that it lies in: all
    /// tiles that have the vertex have that neighbour too, with the edge between, and so each finds the same.
    pub(super) fn shared(&self, precedes: &dyn Fn(u32, u32) -> bool, enters: &dyn Fn(u32) -> bool) -> Vec<(u32, u32)> {
        let mut kept = Vec::new();
        self.for_each_on_border(|v| {
            let planes = self.planes(v);
            let is_in_all =
                |u: usize| planes.iter().zip(self.planes(u)).all(|(&plane, other)| plane == 0 || plane == other);
            let mut is_kept = enters(v as u32);
            if is_kept {
                (&self.domain).for_each_neighbor(v, |u| is_kept &= !(precedes(u as u32, v as u32) && is_in_all(u)));
            }
            if is_kept {
                kept.push((v as u32, 1 << planes.iter().filter(|&&plane| plane != 0).count()));
            }
        });
        kept
    }

    /// For each axis whether a vertex lies in no plane that is shared, in the first, or in the last.
    fn planes(&self, vertex: usize) -> [u8; D] {
        let (position, shape) = (self.domain.position(vertex), self.domain.shape());
        core::array::from_fn(|axis| match self.shared[axis] {
            [true, _] if position[axis] == 0 => 1,
            [_, true] if position[axis] + 1 == shape[axis] => 2,
            _ => 0,
        })
    }

    fn for_each_on_border(&self, mut visit: impl FnMut(usize)) {
        let count = (&self.domain).vertex_count();
        let row = self.domain.shape()[D - 1];
        for start in (0..count).step_by(row) {
            if self.planes(start)[..D - 1].iter().any(|&plane| plane != 0) {
                (start..start + row).for_each(&mut visit);
            } else {
                let ends = [(self.shared[D - 1][0], start), (self.shared[D - 1][1], start + row - 1)];
                ends.into_iter().filter(|end| end.0).for_each(|end| visit(end.1));
            }
        }
    }
}
