//! Ways over a mesh along its edges: shortest paths, spanning trees, cuts.

mod cut;
mod dijkstra;
mod distance;
mod handles;
mod island;
mod islands;
mod path;
mod queue;
mod separation;

pub use cut::CutMesh;
pub use distance::{EdgeDistances, distance_along_edges, vertices_around};
pub use handles::{HandleLoop, handle_loops};
pub use island::{OpenedIsland, open_islands};
pub use islands::{Islands, open_vertices};
pub use path::{
    ShortestPaths, edges_at, kruskal, maximum_spanning_cotree, maximum_spanning_cotree_watched,
    minimum_spanning_forest, minimum_spanning_tree, minimum_spanning_tree_watched, other_end,
};
pub use separation::{Side, shortest_separation};
