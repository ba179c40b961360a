/// What pairing asks of a domain: how many vertices there are and which are neighbours, both by index.
pub(crate) trait Graph: Copy {
    /// Number of vertices.
    fn vertex_count(&self) -> usize;

    /// Calls `visit` with the index of every neighbour of the vertex with index `index`.
    fn for_each_neighbor(&self, index: usize, visit: impl FnMut(usize));
}
