//! glTF 2.0 in: binary (`.glb`), and as JSON with its buffers inside or in files beside it.
//!
//! All triangles of the scene are one model, which keeps the tree of its nodes ([`Attributes::nodes`]): nodes with their transformations, meshes as often as they stand there, strips and
//! fans cut into triangles. A vertex of glTF has one normal and one texture coordinate, so files split vertices wherever these jump;
//! within a node vertices at the same place are joined again, numbered by first appearance, and what differed stays at corners.
//! Faces come in the order of nodes, primitives and indices. v is counted upwards, as everywhere else, and colours, which
//! glTF has linear, become sRGB.
//!
//! Sparse accessors and integers (`KHR_mesh_quantization`) are read. Compressed geometry is refused by name. Tangents, skins,
//! morph targets, animations and textures are passed over, and said to be ([`Attributes::left`]).
//!
//! Source: Khronos Group, *glTF 2.0 Specification*, §3 and §4. The gltf crate is not used: it refuses files for what has nothing to do
//! with their surface, such as bounds that are missing, and does not look whether an accessor is within its buffer.

mod accessor;
mod container;
mod document;
mod placement;

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use serde_json::Value;

use super::colour::to_srgb;
use super::error::{Fault, Place};
use super::joined::Joined;
use super::transformation::Transformation;
use super::write_glb::{GENERATOR, is_plain};
use crate::counted::counted;
use crate::surface::{
    Attribute, AttributeDomain, Attributes, BaseColourPicture, Meaning, Model, Polygons, ScalarType, SceneNode,
    Skipped, TextureCoordinates,
};
use accessor::{Accessor, Buffers};
use container::Container;
pub(super) use container::{MAGIC, beside};
use document::{Document, Primitive};
use placement::scene;

/// So many corners may be made of however small a file, and of a larger one so many for each byte: an index takes one at least, and
/// a mesh may stand in the scene several times.
const FREE_CORNERS: usize = 1 << 22;
const CORNERS_PER_BYTE: usize = 16;

/// Reads a glTF; `folder` is where the files beside it are.
pub(super) fn read(bytes: &[u8], folder: Option<&Path>) -> Result<Model, Fault> {
    let Container { json, binary, surplus } = Container::open(bytes)?;
    let document = Document::read(json)?;
    let buffers = Buffers::new(&document, container::buffers(&document, binary, folder)?);
    let budget = FREE_CORNERS + CORNERS_PER_BYTE * (json.len() + buffers.size());
    let mut draft = Draft { budget, ..Draft::default() };
    let (nodes, instances) = scene(&document)?;
    for (number, instance) in instances.iter().enumerate() {
        let mesh = document.meshes.get(instance.mesh);
        let mesh = mesh.ok_or_else(|| Fault::unexpected(Place::File, "a node with a mesh that is not there", "one"))?;
        for primitive in &mesh.primitives {
            draft.primitive(&buffers, primitive, number as u32, &instance.place)?;
        }
        draft.face_node.resize(draft.polygons.face_count(), instance.node);
    }
    draft.skipped.surplus += surplus;
    draft.finish(&document, nodes)
}

/// A model under construction; its vertices are still split.
#[derive(Default)]
struct Draft {
    /// How many corners may still come.
    budget: usize,
    points: Vec<[f64; 3]>,
    /// What vertices that are joined have in common: the instance, and the bits of the place in its mesh.
    places: Vec<(u32, [u64; 3])>,
    polygons: Polygons,
    uv: Vec<[f64; 2]>,
    has_uv: bool,
    tables: Vec<Table>,
    face_material: Vec<u32>,
    face_node: Vec<u32>,
    skipped: Skipped,
    left: Vec<&'static str>,
}

/// A table with the row of each vertex.
struct Table {
    name: String,
    rows: Attribute,
    of_vertex: Vec<u32>,
}

impl Draft {
    fn primitive(
        &mut self,
        buffers: &Buffers,
        primitive: &Primitive,
        instance: u32,
        place: &Transformation,
    ) -> Result<(), Fault> {
        if !primitive.targets.is_empty() {
            self.left.push("morph targets");
        }
        match primitive.mode {
            0 => {
                self.skipped.points += 1;
                self.left.push("points");
            }
            1..=3 => {
                self.skipped.lines += 1;
                self.left.push("lines");
            }
            4..=6 => {}
            mode => {
                let found = format!("a primitive of mode {mode}");
                return Err(Fault::unexpected(Place::File, found, "0 to 6"));
            }
        }
        let position = primitive.attributes.get("POSITION");
        let Some(&position) = position.filter(|_| primitive.mode > 3) else { return self.spend(16) };
        let position = buffers.accessor(position, "positions")?;
        if position.width != 3 {
            return Err(Fault::unexpected(
                Place::File,
                format!("positions of {}", counted(position.width, "number", "numbers")),
                "3",
            ));
        }
        let indices = match primitive.indices {
            Some(index) => indices(&buffers.accessor(index, "indices")?, position.count)?,
            None => (0..u32::try_from(position.count).unwrap_or(u32::MAX)).collect(),
        };
        self.spend(16 + indices.len() + position.extra_cost())?;
        let (used, corners) = compact(&indices, position.count);
        let first = self.points.len() as u32;
        for &element in &used {
            // Adding 0 makes one of the two zeros.
            let local = [0, 1, 2].map(|k| position.number(element as usize, k) + 0.0);
            self.points.push(place.point(local));
            self.places.push((instance, local.map(f64::to_bits)));
        }
        self.attributes(buffers, primitive, place, &used)?;
        self.triangles(primitive, &corners, first, place.mirrors());
        Ok(())
    }

    fn spend(&mut self, cost: usize) -> Result<(), Fault> {
        self.budget = self.budget.checked_sub(cost).ok_or_else(|| {
            let found = "more corners than a file of its size should have: one mesh stands in the scene over and over";
            Fault::unexpected(Place::File, found, "each mesh a few times")
        })?;
        Ok(())
    }

    fn triangles(&mut self, primitive: &Primitive, corners: &[u32], first: u32, is_mirrored: bool) {
        let mut push = |[a, b, c]: [u32; 3]| {
            let [b, c] = if is_mirrored { [c, b] } else { [b, c] };
            self.polygons.push(&[a, b, c].map(|v| first + v));
            self.face_material.push(primitive.material.map_or(Attribute::NONE, |material| material as u32));
        };
        let is_flat = |[a, b, c]: [u32; 3]| a == b || b == c || c == a;
        match primitive.mode {
            4 => corners.as_chunks::<3>().0.iter().for_each(|&triangle| push(triangle)),
            5 => {
                let strip = corners.windows(3).enumerate();
                let turned = strip.map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] });
                // Those that merely turn the strip are left out.
                turned.filter(|&t| !is_flat(t)).for_each(push);
            }
            _ => corners.windows(2).skip(1).for_each(|t| push([corners[0], t[0], t[1]])),
        }
        if primitive.mode == 4 {
            self.skipped.surplus += corners.len() % 3;
        }
    }

    fn attributes(
        &mut self,
        buffers: &Buffers,
        primitive: &Primitive,
        place: &Transformation,
        used: &[u32],
    ) -> Result<(), Fault> {
        self.uv.resize(self.points.len(), [f64::NAN; 2]);
        for (name, &index) in &primitive.attributes {
            let kind = match name.as_str() {
                "POSITION" => continue,
                "TANGENT" => {
                    self.left.push("tangents");
                    continue;
                }
                name if name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_") => {
                    self.left.push("skins");
                    continue;
                }
                name => name,
            };
            let accessor = buffers.accessor(index, kind)?;
            self.spend(accessor.extra_cost())?;
            if used.iter().any(|&element| element as usize >= accessor.count) {
                let found = format!(
                    "{} of {kind} for {}",
                    counted(accessor.count, "element", "elements"),
                    counted(used.len(), "vertex", "vertices")
                );
                return Err(Fault::unexpected(Place::File, found, "one for each"));
            }
            if kind == "TEXCOORD_0" {
                let first = self.uv.len() - used.len();
                self.has_uv = true;
                for (uv, &element) in self.uv[first..].iter_mut().zip(used) {
                    *uv = [accessor.number(element as usize, 0), 1.0 - accessor.number(element as usize, 1)];
                }
            } else {
                self.rows(kind, &accessor, place, used);
            }
        }
        Ok(())
    }

    /// Takes the rows of the latest vertices.
    fn rows(&mut self, name: &str, accessor: &Accessor, place: &Transformation, used: &[u32]) {
        let known = self.tables.iter().position(|table| table.name == name).unwrap_or_else(|| {
            let (name, of_vertex) = (name.to_owned(), Vec::new());
            self.tables.push(Table { rows: empty(&name, accessor), name, of_vertex });
            self.tables.len() - 1
        });
        let Table { rows, of_vertex, .. } = &mut self.tables[known];
        of_vertex.resize(self.points.len() - used.len(), Attribute::NONE);
        let (width, meaning) = (rows.width().unwrap_or(1), rows.meaning().clone());
        for &element in used {
            of_vertex.push(rows.rows() as u32);
            let number = |k| if k < accessor.width { accessor.number(element as usize, k) } else { 1.0 };
            match meaning {
                Meaning::Normal => place.normal([0, 1, 2].map(number)).into_iter().for_each(|x| rows.push(x)),
                Meaning::Colour => {
                    let share = |k| if k < 3 { to_srgb(number(k)) } else { number(k) };
                    (0..width).for_each(|k| rows.push(share(k) * ScalarType::U16.one()));
                }
                Meaning::Other(_) => (0..width).for_each(|k| rows.push(number(k))),
            }
        }
    }

    fn finish(self, document: &Document, nodes: Vec<SceneNode>) -> Result<Model, Fault> {
        let Self { mut points, mut polygons, uv, has_uv, face_material, mut face_node, skipped, .. } = self;
        // The node of a file of ours says where the middle is, unless it has a name.
        let says_nothing =
            is_ours(document) && matches!(&nodes[..], [node] if node.name.is_empty() && node.mesh.is_empty());
        let nodes = if says_nothing { Vec::new() } else { nodes };
        if nodes.is_empty() {
            face_node.clear();
        }
        let joined = Joined::of_places(self.places.into_iter());
        let vertices = points.len();
        let table = |Table { rows, mut of_vertex, .. }: Table| {
            of_vertex.resize(vertices, Attribute::NONE);
            if of_vertex.contains(&Attribute::NONE) {
                rows.at_corners(polygons.corners.iter().map(|&v| of_vertex[v as usize]).collect())
            } else {
                rows
            }
        };
        let tables = joined.tables(self.tables.into_iter().map(table).collect(), &polygons.corners);
        let uv = has_uv.then(|| TextureCoordinates::new(uv, polygons.corners.clone()));
        joined.apply(&mut points, &mut polygons.corners);
        let looks = looks(document);
        let attributes = Attributes {
            tables,
            materials: material_names(document, &looks),
            looks,
            pictures: pictures(document),
            images: image_files(document),
            other_maps: other_maps(document),
            face_material,
            nodes,
            face_node,
            left: left(document, &self.left),
            ..Attributes::default()
        };
        Ok(Model::new(points, polygons)?.with_uv(uv).with_skipped(skipped).with_attributes(attributes))
    }
}

/// The indices of a primitive, all of vertices that are there.
fn indices(accessor: &Accessor, vertices: usize) -> Result<Vec<u32>, Fault> {
    if accessor.width != 1 || !matches!(accessor.scalar, ScalarType::U8 | ScalarType::U16 | ScalarType::U32) {
        return Err(Fault::unexpected(Place::File, "indices that are no unsigned integers", "unsigned integers"));
    }
    (0..accessor.count)
        .map(|i| match accessor.raw(i, 0) {
            index if index < vertices as f64 => Ok(index as u32),
            index => {
                let expected = format!("a vertex from 0 to {}", vertices.saturating_sub(1));
                Err(Fault::unexpected(Place::File, format!("vertex {index} in a primitive"), expected))
            }
        })
        .collect()
}

/// The elements that are used, in order of their numbers, and the place of each index among them.
fn compact(indices: &[u32], count: usize) -> (Vec<u32>, Vec<u32>) {
    let mut used = indices.to_vec();
    used.sort_unstable();
    used.dedup();
    if used.len() == count {
        return (used, indices.to_vec());
    }
    let place: HashMap<u32, u32> = used.iter().zip(0..).map(|(&element, place)| (element, place)).collect();
    let corners = indices.iter().map(|index| place[index]).collect();
    (used, corners)
}

/// A table without rows for an attribute of that name.
fn empty(name: &str, accessor: &Accessor) -> Attribute {
    let other = |name: &str| {
        let scalar = if accessor.is_normalized { ScalarType::F32 } else { accessor.scalar };
        Attribute::new(Meaning::Other(name.to_owned()), AttributeDomain::Vertices, scalar, accessor.width)
    };
    match name {
        "NORMAL" => Attribute::new(Meaning::Normal, AttributeDomain::Vertices, ScalarType::F32, 3),
        "COLOR_0" => {
            Attribute::new(Meaning::Colour, AttributeDomain::Vertices, ScalarType::U16, accessor.width.clamp(3, 4))
        }
        // Names of a program's own begin with `_`.
        name => other(name.strip_prefix('_').unwrap_or(name)),
    }
}

/// Whether a file was written here.
fn is_ours(document: &Document) -> bool {
    document.asset.generator.as_deref() == Some(GENERATOR)
}

/// What is known of the looks of materials. What we put on a map to look at it is none.
fn looks(document: &Document) -> Vec<String> {
    let is_ours = is_ours(document);
    let look = |material: &document::Material| {
        let look = &material.look;
        let says_nothing = look.is_empty() || is_ours && is_plain(look);
        if says_nothing { String::new() } else { Value::Object(look.clone()).to_string() }
    };
    document.materials.iter().map(look).collect()
}

/// The pictures of materials' base colours. That which we put on a map to look at it is none; one of ours that is more has a name.
fn pictures(document: &Document) -> Vec<Option<BaseColourPicture>> {
    let is_ours = is_ours(document);
    let picture = |material: &document::Material| {
        let (texture, is_moved) = material.base_colour?;
        let image = source(document.textures.get(texture)?)?;
        let named = document.images.get(image).filter(|image| !is_ours || image.name.is_some())?;
        Some(BaseColourPicture { image, name: named.called(image), is_moved })
    };
    let pictures: Vec<_> = document.materials.iter().map(picture).collect();
    if pictures.iter().any(Option::is_some) { pictures } else { Vec::new() }
}

/// The number of a texture's image; where it has none, as some that are compressed otherwise, that of an extension.
fn source(texture: &Value) -> Option<usize> {
    let own = |said: &Value| usize::try_from(said.get("source")?.as_u64()?).ok();
    own(texture).or_else(|| texture.get("extensions")?.as_object()?.values().find_map(own))
}

/// What else than base colours materials have textures for, each once.
fn other_maps(document: &Document) -> Vec<String> {
    let maps: BTreeSet<&String> = document.materials.iter().flat_map(|material| &material.other_maps).collect();
    maps.into_iter().cloned().collect()
}

/// Where images in other files are.
fn image_files(document: &Document) -> Vec<String> {
    let uris = document.images.iter().filter_map(|image| image.uri.clone());
    uris.filter(|uri| !uri.starts_with("data:")).collect()
}

/// The bytes of one of a glTF's images.
pub(super) fn image(bytes: &[u8], number: usize, folder: Option<&Path>) -> Result<Vec<u8>, Fault> {
    let Container { json, binary, .. } = Container::open(bytes)?;
    let document = Document::read(json)?;
    let image = document.images.get(number);
    let image = image.ok_or_else(|| Fault::unexpected(Place::File, format!("no image {number}"), "one"))?;
    match (&image.uri, image.view) {
        (Some(uri), _) => container::load(uri, "an image", folder),
        (None, Some(view)) => {
            let buffers = Buffers::new(&document, container::buffers(&document, binary, folder)?);
            buffers.view(view).map(|(bytes, _)| bytes.to_vec())
        }
        (None, None) => Err(Fault::unexpected(Place::File, format!("image {number} without data"), "a `uri`")),
    }
}

/// The names of materials. One without name and look that is the only one is no material worth a name.
fn material_names(document: &Document, looks: &[String]) -> Vec<String> {
    let materials = &document.materials;
    if materials.len() == 1 && materials[0].name.is_none() && looks[0].is_empty() {
        return Vec::new();
    }
    let name =
        |(i, material): (usize, &document::Material)| material.name.clone().unwrap_or_else(|| format!("material_{i}"));
    materials.iter().enumerate().map(name).collect()
}

/// What is passed over, each once.
fn left(document: &Document, seen: &[&str]) -> Vec<String> {
    let has_skin = document.nodes.iter().any(|node| node.skin.is_some());
    // What we put on a map to look at it is no loss: who writes another GLB puts it there again.
    let is_ours = is_ours(document);
    let kinds = [
        ("points", false),
        ("lines", false),
        ("tangents", false),
        ("morph targets", false),
        ("skins", has_skin),
        ("animations", !document.animations.is_empty()),
        ("cameras", !document.cameras.is_empty()),
        ("textures", document.images.iter().any(|image| !is_ours || image.name.is_some())),
    ];
    kinds.into_iter().filter(|(name, there)| *there || seen.contains(name)).map(|(name, _)| name.to_owned()).collect()
}
