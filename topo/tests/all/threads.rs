//! Every public type can be sent to, and shared between, threads.

use topo::{
    Adjacency, Branch, Connectivity, ContourArc, ContourNode, ContourTree, Diagram, Error, Extremum, Grid, Hierarchy,
    Kind, LevelComponent, MergeTree, NanPolicy, Node, Pair, Pairs, Path, Persistence, PersistenceOptions, Rings,
    Segmentation, TriangleMesh,
};

fn goes_between_threads<T: Send + Sync + 'static>() {}

#[test]
fn public_types_go_between_threads() {
    goes_between_threads::<(Adjacency, Grid<3>, Path, TriangleMesh, Connectivity)>();
    goes_between_threads::<Rings<&Adjacency, fn(usize) -> bool>>();
    goes_between_threads::<(Pair<usize, f64>, Pairs<usize, f64>, Persistence<usize, f64>)>();
    goes_between_threads::<(Extremum<usize, f64>, Hierarchy<usize, f64>, Diagram, Segmentation<usize>)>();
    goes_between_threads::<(MergeTree<usize, f64>, Node<usize, f64>, Branch<usize, f64>, LevelComponent<usize, f64>)>();
    goes_between_threads::<(ContourTree<usize, f64>, ContourNode<usize, f64>, ContourArc)>();
    goes_between_threads::<(PersistenceOptions, NanPolicy, Error, Kind)>();
}
