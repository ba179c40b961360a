//! 0-dimensional persistence of a scalar field on any graph: which hills and valleys matter, and how much.
//!
//! # In five lines each
//!
//! **Peaks** by prominence, each with its key saddle. An adjacency list and a number for each vertex are enough:
//!
//! ```
//! let neighbors: Vec<Vec<usize>> = vec![vec![1], vec![0, 2], vec![1, 3], vec![2, 4], vec![3]];
//! let height: Vec<f32> = vec![1.0, 5.0, 2.0, 9.0, 0.0];
//! let graph = topo::Adjacency::new(&neighbors)?;
//! for peak in topo::superlevel(&graph, &height)?.ranked() {
//!     println!("vertex {} stands out by {}, saddle {:?}", peak.extremum, peak.persistence(), peak.saddle);
//! }
//! # assert_eq!(topo::superlevel(&graph, &height)?.ranked()[1].saddle, Some(2));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Segments** of a picture, one for each bright spot with a contrast above 50, as a watershed gives them:
//!
//! ```
//! let picture: [u8; 12] = [9, 90, 8, 7, 80, 9, 9, 95, 8, 7, 60, 9];
//! let grid = topo::Grid::new([2, 6], topo::Connectivity::Full);
//! let segments = topo::segmentation(&grid, &picture, topo::Kind::Maximum, 50)?;
//! let labels: Vec<Option<usize>> = segments.labels().collect();
//! println!("{} segments of {:?} pixels", segments.extrema().len(), segments.sizes());
//! # assert_eq!((labels[1], labels[4], labels.len()), (Some(1), Some(0), 12));
//! # Ok::<(), topo::Error>(())
//! ```
//!
//! **Clusters**: `ToMATo` (Chazal, Guibas, Oudot & Skraba 2013), the basins of a density on a neighbour graph, by prominence or by number
//! ([`MergeTree::clusters`]); or single linkage of weighted edges:
//!
//! ```
//! let near = topo::Adjacency::from_edges(6, &[[0, 1], [1, 2], [2, 3], [3, 4], [4, 5]])?;
//! let density = [2.0, 5.0, 1.0, 1.5, 6.0, 3.0];
//! let dense = topo::segmentation(&near, &density, topo::Kind::Maximum, 1.0)?;
//! let linked = topo::single_linkage(4, &[(0, 1, 0.3), (1, 2, 5.0), (2, 3, 0.4)])?.clusters(2);
//! println!("{:?}, {linked:?}", dense.sizes());
//! # assert_eq!((dense.sizes(), linked), (vec![3, 3], vec![0, 0, 1, 1]));
//! # Ok::<(), topo::Error>(())
//! ```
//!
//! **Distances** of fields, whatever their domains, as distances of their diagrams:
//!
//! ```
//! let [one, other] = [[0.0, 6.0, 2.0, 9.0, 5.0], [0.0, 6.0, 1.5, 9.0, 8.0]];
//! let path = topo::Path::new(5);
//! let (a, b) = (topo::sublevel(&path, &one)?.diagram(), topo::sublevel(&path, &other)?.diagram());
//! println!("bottleneck {}, Wasserstein {}", a.bottleneck(&b)?, a.wasserstein(&b, 2.0)?);
//! # assert_eq!(a.bottleneck(&b)?, 2.0);
//! # Ok::<(), topo::Error>(())
//! ```
//!
//! **Contours**: how isolines and isosurfaces appear, merge, split and vanish, and the region that each of them sweeps:
//!
//! ```
//! let picture: [u8; 18] = [9, 9, 9, 9, 9, 9, 9, 90, 8, 7, 80, 9, 9, 9, 9, 9, 9, 9];
//! let grid = topo::Grid::new([3, 6], topo::Connectivity::Freudenthal);
//! let tree = topo::contour_tree(&grid, &picture)?.simplify(50);
//! let regions: Vec<Option<usize>> = tree.labels().collect();
//! println!("{} contours at level 30; of {regions:?} the sizes are {:?}", tree.contours_at(30), tree.sizes());
//! # assert_eq!((tree.contours_at(30), tree.sizes().iter().sum::<usize>()), (2, 18));
//! # Ok::<(), topo::Error>(())
//! ```
//!
//! **Tiles** of a field that no memory holds, read one at a time or each on a machine of its own:
//!
//! ```
//! # let (grid, field, options) = (topo::Grid::new([4, 6], topo::Connectivity::Axis), [1.0; 24], topo::PersistenceOptions::new());
//! let mut whole = topo::Summary::empty(topo::Kind::Maximum, options);
//! for tile in topo::Tile::cut(&grid, [&[2, 2], &[3, 3]])? {
//!     whole = whole.join(topo::Summary::of_tile(&tile, &tile.values(&field)?, topo::Kind::Maximum, options)?)?;
//! }
//! println!("{} peaks, those of the whole field", whole.finish()?.len());
//! # Ok::<(), topo::Error>(())
//! ```
//!
//! # What is computed
//!
//! Let water rise over a landscape, or rather: take the vertices of a graph in the order of their values. The *sublevel
//! set* at a level, all vertices up to it, falls into connected components. A component is *born* at a local minimum;
//! at a saddle components meet, and by the *elder rule* only the eldest lives on, the others *die*. Each minimum is
//! thus paired with a saddle, and the difference of their values is its *persistence*: how far the water must rise for
//! the valley to lose its identity.
//!
//! ```text
//!  9       D                          minimum   dies at   persistence
//!  6      ╱ ╲               B            x       nowhere   9, the range
//!  4     ╱   ╲       A     ╱ ╲           c       D         9 - 3 = 6
//!  3    c     ╲     ╱ ╲   ╱   ╲          b       B         6 - 2 = 4
//!  2           ╲   ╱   ╲ ╱     b         a       A         4 - 1 = 3
//!  1            ╲ ╱     a
//!  0             x
//! ```
//!
//! ```
//! let [c, d, x, a_top, a, b_top, b] = [3.0, 9.0, 0.0, 4.0, 1.0, 6.0, 2.0];
//! let valleys = topo::sublevel(&topo::Path::new(7), &[c, d, x, a_top, a, b_top, b])?;
//! let lives: Vec<_> = valleys.ranked().iter().map(|valley| (valley.birth, valley.death(), valley.persistence())).collect();
//! assert_eq!(lives, [(x, None, 9.0), (c, Some(d), 6.0), (b, Some(b_top), 4.0), (a, Some(a_top), 3.0)]);
//! # Ok::<(), topo::Error>(())
//! ```
//!
//! Downwards the same happens to *superlevel sets* and maxima; there persistence is what mountaineers call prominence.
//! The eldest component of each connected part of the graph never dies. Its class is *essential*: it has no saddle, and
//! for ranking it counts as persistent as the range of the field.
//!
//! # From pairs to features
//!
//! Persistence ranks extrema; most of what one wants to know is one step from there.
//!
//! ```
//! use topo::{Kind, Path};
//!
//! let path = Path::new(7);
//! let landscape = [3.0, 9.0, 0.0, 4.0, 1.0, 6.0, 2.0]; // as above
//!
//! // The most prominent features: highest peak, lowest valley, next peak, next valley.
//! let hierarchy = topo::persistence(&path, &landscape)?.hierarchy();
//! let first: Vec<usize> = hierarchy.alternating(4).map(|extremum| extremum.vertex).collect();
//! assert_eq!(first, [1, 2, 5, 0]);
//!
//! // What is under water at level 5: three lakes, one of three vertices.
//! let tree = topo::merge_tree(&path, &landscape, Kind::Minimum)?;
//! let lakes: Vec<_> = tree.at(5.0).iter().map(|lake| (lake.extremum, lake.size)).collect();
//! assert_eq!(lakes, [(0, 1), (2, 3), (6, 1)]);
//!
//! // Which vertices drain into which valley, valleys no deeper than 3 being given to the next.
//! let basins = topo::segmentation(&path, &landscape, Kind::Minimum, 3.0)?;
//! assert_eq!(basins.extrema(), [0, 2, 6]);
//! assert_eq!(basins.sizes(), [1, 5, 1]);
//!
//! // The landscape without them, nowhere changed by more than 3.
//! let simple = topo::simplify(&path, &landscape, 3.0)?;
//! assert_eq!(simple, [3.0, 9.0, 0.0, 4.0, 4.0, 6.0, 2.0]);
//!
//! // How far apart the two are as diagrams: the valley from 1 to 4 has gone, half its depth from the diagonal.
//! let [before, after] = [&landscape[..], &simple].map(|field| topo::sublevel(&path, field).map(|pairs| pairs.diagram()));
//! assert_eq!(before?.bottleneck(&after?)?, 1.5);
//! # Ok::<(), topo::Error>(())
//! ```
//!
//! For n vertices, e extrema, m edges; a scan is what the pairs take.
//!
//! | to get | call | takes |
//! |---|---|---|
//! | pairs of minima or of maxima, by index | [`sublevel`], [`superlevel`] | a scan: O(n + m), and O(e log e) |
//! | the most persistent ones first, or some of them | [`Pairs::ranked`], [`Pairs::top`] | O(e log e), O(e) |
//! | both kinds, and extrema ranked by persistence | [`persistence`](fn@persistence), [`Persistence::hierarchy`] | two scans |
//! | holes of pictures, cavities of volumes | [`holes`](fn@holes) | a scan, and a copy of the field |
//! | all there is of a picture: pairs and holes | [`pairs_and_holes`](fn@pairs_and_holes) | a scan, and O(e log e) |
//! | how components merge: nodes, arcs, parents, sizes | [`merge_tree`](fn@merge_tree), [`MergeTree::branches`] | two to three scans |
//! | the components at a level, their vertices, heights, sums | [`MergeTree::at`], [`MergeTree::components`] | O(n) |
//! | the tree of the branches that are large enough | [`MergeTree::simplify`], [`MergeTree::filter`] | O(n), O(n log e) |
//! | how contours appear, merge, split and vanish | [`contour_tree`](fn@contour_tree), [`ContourTree::simplify`] | two trees and O(n log e), or O(n log n + m) |
//! | loops of a graph too, all paired | [`extended_persistence`](fn@extended_persistence) | two scans, and O(m log m) |
//! | the basin of each extremum | [`segmentation`](fn@segmentation); for many thresholds [`MergeTree::segmentation`] | two to three scans; O(n) |
//! | a field without small extrema | [`simplify`](fn@simplify) | a tree and more, until nothing changes |
//! | on a grid, how far it is to a more extreme vertex | [`isolation`](fn@isolation) | O(n log n) for all |
//! | clusters of weighted edges | [`single_linkage`](fn@single_linkage) | O(m log m) |
//! | diagrams, curves, vectors for learning | [`Pairs::diagram`], [`Diagram`] | O(e log e) |
//! | distances, with the matching | [`Diagram::bottleneck`], [`Diagram::wasserstein`], [`Wasserstein`] | see there |
//! | the pairs of a field in blocks, one at a time or on many machines | [`Summary`], [`Tile`] | a scan a block; what the borders hold |
//! | the same with NaN masked, with zero persistence | [`PersistenceOptions`] | |
//! | pairs, and distances, that can be stopped | [`PersistenceOptions::sublevel_watched`], [`Wasserstein::distance_watched`], [`Watch`] | |
//!
//! For mountains: prominence is [`Pair::persistence`], the key col [`Pair::saddle`], the parent [`Branch::parent`].
//!
//! # On what
//!
//! On every undirected petgraph graph with compact indices, named by its own node identifiers. The field is on the vertices: nothing
//! here looks at the weights of nodes and edges but [`weighted_edges`](fn@weighted_edges), with which edges of a petgraph graph are
//! clustered by their weights.
//!
//! ```
//! use petgraph::graph::UnGraph;
//! use petgraph::graphmap::UnGraphMap;
//! use petgraph::stable_graph::StableUnGraph;
//! use petgraph::{Undirected, csr::Csr};
//!
//! let edges = [(0, 1), (1, 2), (2, 3)];
//! let field = [3, 7, 1, 4];
//!
//! let graph = UnGraph::<(), ()>::from_edges(edges);
//! let valleys = topo::sublevel(&graph, &field)?;
//! assert_eq!(valleys[1].extremum, petgraph::graph::NodeIndex::new(2)); // 1, the lowest
//! assert_eq!(valleys[0].death(), Some(7));
//!
//! let mut csr = Csr::<(), (), Undirected>::with_nodes(4);
//! edges.into_iter().for_each(|(a, b)| drop(csr.add_edge(a, b, ())));
//! assert_eq!(topo::sublevel(&csr, &field)?[0].saddle, Some(1));
//!
//! let map = UnGraphMap::<&str, ()>::from_edges([("Ulm", "Bonn"), ("Bonn", "Kiel")]);
//! assert_eq!(topo::superlevel(&map, &[478, 60, 5])?.top(1)[0].extremum, "Ulm");
//!
//! // The indices of a stable graph have holes; a plain graph made from it has none.
//! let mut stable = StableUnGraph::<i32, ()>::default();
//! let [a, b, c] = [8, 3, 9].map(|value| stable.add_node(value));
//! stable.extend_with_edges([(a, b), (b, c), (a, c)]);
//! stable.remove_node(b);
//! let compact = UnGraph::from(stable);
//! let field: Vec<i32> = compact.node_weights().copied().collect();
//! assert_eq!(topo::sublevel(&compact, &field)?.len(), 1);
//! # Ok::<(), topo::Error>(())
//! ```
//!
//! And on domains of this crate that are faster for what they know: [`Grid`] (series, pictures, volumes), [`Path`],
//! [`TriangleMesh`], [`Rings`], [`Adjacency`], [`CsrGraph`]. Edges, triangles and lists name vertices by integers of any type. A mask is a field with NaN where the domain ends, see [`NanPolicy::Mask`].
//!
//! # What is fixed
//!
//! - Vertices are ordered by (value, index), for superlevel sets in exactly the reverse order; -0.0 equals 0.0.
//! - Infinities are values; two equal ones are 0 apart. NaN is refused, or masked on request.
//! - Pairs whose extremum and saddle have equal values, as plateaus make them, are counted and dropped, or kept on
//!   request.
//! - At a saddle where k components meet k - 1 pairs end. Repeated edges and loops change nothing.
//! - Differences of integers do not overflow; `f32` differences are taken in `f64`.
//! - Results are the same with the feature `rayon` and without, for any number of threads.
//!
//! With the feature `serde` results and options are written and read. JSON has no infinities: values that are infinite need
//! a format that has.
//!
//! # How fast
//!
//! Nothing sorts all vertices. Most of them are found to be regular by a look at their neighbours; the rest is a graph
//! of basins, which are paired by the elder rule. Joins are put in order digit by digit. On smooth fields a grid takes a quarter to a half of the
//! time that sorting its values takes, and 5 bytes a vertex; see `benches/persistence`. The plain method is there too
//! ([`PersistenceOptions::plain_sweep`]), and both are tested to agree vertex by vertex.

mod domain;
mod error;
mod features;
mod filtration;
mod options;
mod pairing;
mod parallel;
mod persistence;
mod scalar;
mod summary;
mod watch;

pub use domain::{Adjacency, Connectivity, CsrGraph, Domain, Grid, Path, Rings, TriangleMesh};
pub use error::Error;
pub use features::{
    Branch, ContourArc, ContourNode, ContourTree, Dendrogram, Diagram, Extended, Extremum, Hierarchy, Hole, Holes,
    LevelComponent, Link, Loop, Matching, MergeTree, Node, Segmentation, Wasserstein, contour_tree,
    extended_persistence, holes, holes_watched, isolation, merge_tree, pairs_and_holes, pairs_and_holes_watched,
    segmentation, simplify, single_linkage, weighted_edges,
};
#[doc(hidden)]
pub use filtration::{Direction, Filtration};
pub use filtration::{Kind, NanPolicy};
pub use options::PersistenceOptions;
#[doc(hidden)]
pub use pairing::{Basins, Merge, Pointing};
pub use persistence::{Pair, PairColumns, Pairs, Persistence, persistence, sublevel, superlevel};
pub use scalar::Scalar;
pub use summary::{Summary, Tile};
pub use watch::Watch;

/// The example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
