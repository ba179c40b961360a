//! Temporary.
pub(crate) struct Corner {
    pub(crate) position: [f64; 2],
    pub(crate) variable: Option<u32>,
    pub(crate) rotation: [f64; 2],
}
pub(crate) struct Triangle {
    pub(crate) corners: [u32; 3],
    pub(crate) sides: [f64; 3],
}
pub(crate) struct Patch {
    pub(crate) corners: Vec<Corner>,
    pub(crate) triangles: Vec<Triangle>,
    pub(crate) variable_count: usize,
}
pub(crate) fn untangle(_p: &Patch) -> Option<Vec<[f64; 2]>> {
    None
}
