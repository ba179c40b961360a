//! Which triangles of a map are measured.

use crate::uv::{Corners, Triangle, leaders};

/// The triangles of a map that are worth measuring, by number: all but those that unwrapping leaves out as well, which have a vertex twice, or lie
/// where another one on the same vertices does.
///
/// ```
/// use cones::report::worth_measuring;
///
/// let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
/// let vertices = [[0, 1, 2], [2, 1, 0], [2, 1, 3], [1, 2, 2], [0, 1, 2]];
/// let uv = [[a, b, c], [c, b, a], [c, b, d], [b, c, c], [d, b, c]];
/// assert_eq!(worth_measuring(&vertices, &uv), [0, 2, 4]);
/// ```
pub fn worth_measuring(vertices: &[[u32; 3]], uv: &[Triangle]) -> Vec<u32> {
    leaders(&Corners { vertices, uv }.companions(0..vertices.len() as u32))
}
