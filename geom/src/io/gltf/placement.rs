//! Where meshes stand: the tree of nodes with their transformations.

use super::super::error::{Fault, Place};
use super::super::transformation::Transformation;
use super::document::Document;
use crate::surface::{Attribute, SceneNode};

/// A mesh that stands in the scene.
pub(super) struct Instance {
    pub(super) mesh: usize,
    /// Its node in the scene.
    pub(super) node: u32,
    pub(super) place: Transformation,
}

/// The nodes of the scene in the order of a walk down the tree, and the meshes with where they stand. Without scenes all nodes are there,
/// and without nodes all meshes. A mesh with a skin stays where it was made, as its node does not move it.
pub(super) fn scene(document: &Document) -> Result<(Vec<SceneNode>, Vec<Instance>), Fault> {
    if document.nodes.is_empty() {
        let of = |mesh| Instance { mesh, node: Attribute::NONE, place: Transformation::IDENTITY };
        return Ok((Vec::new(), (0..document.meshes.len()).map(of).collect()));
    }
    let scene = document.scenes.get(document.scene.unwrap_or(0));
    let roots = scene.map_or_else(|| roots(document), |scene| scene.nodes.clone());
    let mut is_met = vec![false; document.nodes.len()];
    let (mut nodes, mut instances) = (Vec::new(), Vec::new());
    let mut stack: Vec<(usize, Option<u32>, Transformation)> =
        roots.iter().rev().map(|&node| (node, None, Transformation::IDENTITY)).collect();
    while let Some((number, parent, outer)) = stack.pop() {
        let node = document.nodes.get(number);
        let node = node.ok_or_else(|| Fault::unexpected(Place::File, format!("no node {number}"), "one"))?;
        if std::mem::replace(&mut is_met[number], true) {
            let found = format!("node {number} in two places of the scene");
            return Err(Fault::unexpected(Place::File, found, "a tree"));
        }
        let (place, index) = (node.place(), nodes.len() as u32);
        let here = outer.after(&Transformation::of(&place));
        if let Some(mesh) = node.mesh {
            let place = if node.skin.is_some() { Transformation::IDENTITY } else { here };
            instances.push(Instance { mesh, node: index, place });
        }
        let mesh = node.mesh.and_then(|mesh| document.meshes.get(mesh)?.name.clone()).unwrap_or_default();
        nodes.push(SceneNode { name: node.name.clone().unwrap_or_default(), mesh, parent, place });
        stack.extend(node.children.iter().rev().map(|&child| (child, Some(index), here)));
    }
    Ok((nodes, instances))
}

/// The nodes that are no children.
fn roots(document: &Document) -> Vec<usize> {
    let mut is_child = vec![false; document.nodes.len()];
    for &child in document.nodes.iter().flat_map(|node| &node.children) {
        if let Some(is_child) = is_child.get_mut(child) {
            *is_child = true;
        }
    }
    (0..is_child.len()).filter(|&node| !is_child[node]).collect()
}
