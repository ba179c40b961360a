//! Blocks of any domain, and how their basins become a summary.

use super::Summary;
use super::order::{Order, Renumbered};
use super::reduced::Place;
use super::tile::Tile;
use crate::domain::Domain;
use crate::error::Error;
use crate::filtration::{Direction, Falling, Filtration, Kind, NanPolicy, Rising};
use crate::options::PersistenceOptions;
use crate::pairing::{Pointing, Remnant};
use crate::persistence::Pair;
use crate::scalar::Scalar;

impl<S: Scalar> Summary<S> {
    /// The summary of a tile of a grid, given its values as [`Tile::shape`] says: the scan of the pairs, and O(b log b) for
    /// b vertices on the tile's border.
    ///
    /// # Errors
    /// If there are more or fewer values, or one is NaN and is not to be masked.
    pub fn of_tile<const D: usize>(
        tile: &Tile<D>,
        values: &[S],
        kind: Kind,
        options: PersistenceOptions,
    ) -> Result<Self, Error> {
        match kind {
            Kind::Minimum => of_tile::<S, Rising, D>(tile, values, options),
            Kind::Maximum => of_tile::<S, Falling, D>(tile, values, options),
        }
    }

    /// The summary of a part of any domain, given for each of its vertices the value, the *name* (its index in the whole
    /// domain), and the number of blocks that have it, which is 1 where none is shared.
    ///
    /// Each edge of the whole domain must lie in at least one block; it may lie in several. So a block may be a set of
    /// vertices with all their edges and, as vertices that are shared, the other ends; or all triangles that a process has.
    ///
    /// ```
    /// use topo::{Kind, Path, PersistenceOptions, Summary};
    ///
    /// // The path 0 – 1 – 2 – 3 – 4 in two blocks that share vertex 2.
    /// let options = PersistenceOptions::new();
    /// let a = Summary::of_block(&Path::new(3), &[5, 9, 7], &[0, 1, 2], &[1, 1, 2], Kind::Minimum, options)?;
    /// let b = Summary::of_block(&Path::new(3), &[7, 8, 0], &[2, 3, 4], &[2, 1, 1], Kind::Minimum, options)?;
    /// let pairs: Vec<_> = b.join(a)?.finish()?.iter().map(|pair| (pair.extremum, pair.saddle)).collect();
    /// assert_eq!(pairs, [(0, Some(1)), (2, Some(3)), (4, None)]);
    /// # Ok::<(), topo::Error>(())
    /// ```
    ///
    /// # Errors
    /// If there is not one value, name and number for each vertex, two names are equal, or a value is NaN and is not to be
    /// masked.
    pub fn of_block<G: Domain>(
        domain: G,
        values: &[S],
        names: &[u64],
        blocks: &[u32],
        kind: Kind,
        options: PersistenceOptions,
    ) -> Result<Self, Error> {
        let vertices = domain.vertex_count();
        if let Some(values) = [values.len(), names.len(), blocks.len()].into_iter().find(|&length| length != vertices) {
            return Err(Error::Length { values, vertices });
        }
        let order = Order::by(names)?;
        let (values, names, blocks) = (order.sorted(values), order.sorted(names), order.sorted(blocks));
        let domain = Renumbered { domain, order: &order };
        match kind {
            Kind::Minimum => of_block::<S, Rising, G>(&domain, &values, &names, &blocks, options),
            Kind::Maximum => of_block::<S, Falling, G>(&domain, &values, &names, &blocks, options),
        }
    }
}

fn of_block<S: Scalar, F: Direction, G: Domain>(
    domain: &Renumbered<'_, G>,
    values: &[S],
    names: &[u64],
    blocks: &[u32],
    options: PersistenceOptions,
) -> Result<Summary<S>, Error> {
    let name = |v: u32| names[v as usize];
    let filtration = filtration::<S, F>(values, domain.order.len(), options.nan, name)?;
    let shared = blocks.iter().zip(0..).filter(|&(&blocks, v)| blocks > 1 && filtration.contains(v));
    let shared: Vec<(u32, u32)> = shared.map(|(&blocks, v)| (v, blocks)).collect();
    Ok(summary(domain, &filtration, &shared, name, options))
}

fn of_tile<S: Scalar, F: Direction, const D: usize>(
    tile: &Tile<D>,
    values: &[S],
    options: PersistenceOptions,
) -> Result<Summary<S>, Error> {
    let (domain, vertices) = (tile.domain(), tile.domain().vertex_count());
    if values.len() != vertices {
        return Err(Error::Length { values: values.len(), vertices });
    }
    if !tile.goes_round() {
        let name = |v: u32| tile.vertex(v as usize);
        let filtration = filtration::<S, F>(values, vertices, options.nan, name)?;
        let shared = tile.shared(&|u, v| filtration.precedes(u, v), &|v| filtration.contains(v));
        return Ok(summary(domain, &filtration, &shared, name, options));
    }
    let order = Order::by(&(0..vertices).map(|v| tile.vertex(v)).collect::<Vec<_>>())?;
    let (domain, values) = (Renumbered { domain, order: &order }, order.sorted(values));
    let name = |v: u32| tile.vertex(order.before(v) as usize);
    let filtration = filtration::<S, F>(&values, vertices, options.nan, name)?;
    let mut shared =
        tile.shared(&|u, v| filtration.precedes(order.rank(u), order.rank(v)), &|v| filtration.contains(order.rank(v)));
    shared.iter_mut().for_each(|shared| shared.0 = order.rank(shared.0));
    Ok(summary(&domain, &filtration, &shared, name, options))
}

/// A filtration of a block whose errors speak of names.
fn filtration<'a, S: Scalar, F: Direction>(
    values: &'a [S],
    vertices: usize,
    nan: NanPolicy,
    name: impl Fn(u32) -> u64,
) -> Result<Filtration<'a, S, F>, Error> {
    Filtration::new(values, vertices, nan).map_err(|error| match error {
        Error::NotANumber { vertex } => Error::NotANumber { vertex: name(vertex as u32) as usize },
        other => other,
    })
}

/// The summary of a block whose vertices are numbered by rising name, given the shared ones that are to be kept, each with
/// the number of blocks that have it.
fn summary<G: Domain, S: Scalar, F: Direction>(
    domain: G,
    filtration: &Filtration<'_, S, F>,
    shared: &[(u32, u32)],
    name: impl Fn(u32) -> u64,
    options: PersistenceOptions,
) -> Summary<S> {
    let open: Vec<u32> = shared.iter().map(|&(v, _)| v).collect();
    let Remnant { merges, mut edges } = domain.basins(filtration, Pointing::Any).pair_inside(filtration, &open);
    let mut summary = Summary::empty(F::KIND, options);
    let pair = |extremum: u32, saddle: u32| Pair {
        extremum: name(extremum),
        saddle: Some(name(saddle)),
        birth: filtration.value(extremum),
        end: filtration.value(saddle),
    };
    summary.add(merges.iter().map(|merge| pair(merge.extremum, merge.end)).collect());
    let mut left: Vec<u32> = edges.iter().flatten().copied().collect();
    left.sort_unstable();
    left.dedup();
    let mut places: Vec<Place<S>> =
        left.iter().map(|&v| Place { name: name(v), value: filtration.value(v), blocks: [0; 2] }).collect();
    let number = |v: u32| left.partition_point(|&other| other < v);
    shared.iter().for_each(|&(v, blocks)| places[number(v)].blocks = [1, blocks]);
    edges.iter_mut().for_each(|edge| *edge = edge.map(|v| number(v) as u32));
    summary.reduce(&places, &edges);
    summary
}
