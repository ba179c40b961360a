//! glTF 2.0 out, as one binary file with the texture in it.
//!
//! A vertex of glTF has one texture coordinate, normal and so on, so vertices are split into wedges. Positions are f32. Where the model came from a glTF, its
//! tree of nodes is written again with names and transformations, each with its own triangles as a mesh, in its own coordinates; what stands in several places is
//! written as often, as each has its own map. Otherwise there is one node, and positions are taken from the
//! middle of the model, which the node moves back, so that a model far from the origin keeps its digits. glTF counts v
//! downwards from the upper edge of the image. Normals are those of the model; where it has none there are none, and viewers
//! shade each triangle flat. Colours are linear, in f32, as `MeshLab` reads of integers the low byte. Other numbers of vertices are
//! attributes whose names begin with `_`, in f32 too. Faces of one material are a primitive with vertices of its own, as many readers take all
//! that a primitive names.
//!
//! Source: Khronos Group, *glTF 2.0 Specification*, §3 and §4.

use std::collections::HashMap;
use std::io::Write;

use serde_json::{Map, Value, json};

use super::cells::Cells;
use super::colour::to_linear;
use super::error::WriteError;
use super::frame::Frame;
use super::wedge::Wedges;
use crate::surface::{Attribute, AttributeDomain, Meaning, Model, NodePlace, SceneNode, Triangles};
use crate::vector::normal;

/// The name that files of ours carry.
pub(super) const GENERATOR: &str = "cones";

/// A PNG that a GLB shows on its map.
#[derive(Debug, Clone, Copy)]
pub enum GlbTexture<'a> {
    /// For the map to be looked at, on what has no material with a [look](crate::Attributes::looks) of its own: [`read_bytes`](super::read_bytes) passes over it without a word.
    Checker(&'a [u8]),
    /// The texture of the surface, on all of it, by one material of that name in place of the model's.
    Baked {
        /// The PNG.
        png: &'a [u8],
        /// What the material and the picture are called.
        name: &'a str,
        /// What becomes of its alpha, in glTF's words: `OPAQUE`, `MASK` or `BLEND`.
        alpha_mode: &'a str,
    },
}

/// Writes a model's triangles as `.glb`, with a texture coordinate for each corner and with these a texture. Without texture coordinates the model's own are written, if each corner has one; a map of some corners alone a GLB cannot hold.
///
/// # Errors
/// When texture coordinates or triangles do not fit the model, when it is larger than 4 GB, or when writing fails.
pub fn write_glb(
    model: &Model,
    uv: Option<&[[f64; 2]]>,
    triangles: &Triangles,
    texture: Option<GlbTexture<'_>>,
    mut out: impl Write,
) -> Result<(), WriteError> {
    let own = if uv.is_none() { model.whole_uv() } else { None };
    let uv = uv.or(own.as_deref());
    let tables: Vec<&Attribute> = model.attributes().tables.iter().filter(|table| is_written(table)).collect();
    let of_corners: Vec<&Attribute> =
        tables.iter().copied().filter(|table| table.domain() == AttributeDomain::Corners).collect();
    let wedges = Wedges::split(model, uv, &of_corners)?;
    Cells::new(model, Some(triangles))?;
    let frames = Frames { of_nodes: Frame::of_nodes(model), middle: Frame::middle(model) };
    let mut binary = Binary::default();
    let content = Content { model, uv, tables, frames: &frames };
    let texture = texture.filter(|_| uv.is_some());
    let only = texture.and_then(GlbTexture::name);
    let (parts, materials) = parts(model, &frames, &wedges, triangles, only);
    let mut meshes: Vec<Mesh> = Vec::new();
    for part in parts {
        let known = meshes.iter().position(|mesh| mesh.node == part.node).unwrap_or_else(|| {
            meshes.push(Mesh { node: part.node, primitives: Vec::new() });
            meshes.len() - 1
        });
        meshes[known].primitives.push(content.primitive(part, &wedges, &mut binary));
    }
    let texture = texture.filter(|_| materials.iter().any(|(_, look)| look.is_none()));
    let image = texture.map(|texture| texture.image(&mut binary));
    let materials: Vec<Value> = materials.iter().map(|(name, look)| material(*name, *look, texture)).collect();
    let json = document(model, &frames, &binary, meshes, materials, image);
    write_chunks(json.to_string().into_bytes(), binary.bytes, &mut out)
}

impl<'a> GlbTexture<'a> {
    fn name(self) -> Option<&'a str> {
        match self {
            Self::Checker(_) => None,
            Self::Baked { name, .. } => Some(name),
        }
    }

    /// Appends the picture, and tells what the document says of it.
    fn image(self, binary: &mut Binary) -> Value {
        let (Self::Checker(png) | Self::Baked { png, .. }) = self;
        let mut image = json!({"bufferView": binary.view(None, png.iter().copied()), "mimeType": "image/png"});
        if let Some(name) = self.name() {
            image["name"] = name.into();
        }
        image
    }
}

/// Whether a table can be written: normals, colours, and rows of up to four numbers.
pub(super) fn is_written(table: &Attribute) -> bool {
    table.domain() != AttributeDomain::Faces && table.width().is_some_and(|width| width <= 4)
}

/// Names that glTF has for kinds of buffers and numbers.
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const U32: u32 = 5125;
const F32: u32 = 5126;

fn bounds(points: &[[f32; 3]]) -> [[f32; 3]; 2] {
    let mut bounds = [points[0]; 2];
    for point in points {
        for axis in 0..3 {
            bounds[0][axis] = bounds[0][axis].min(point[axis]);
            bounds[1][axis] = bounds[1][axis].max(point[axis]);
        }
    }
    bounds
}

/// The binary chunk, the views into it, and the accessors of these.
#[derive(Default)]
struct Binary {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Binary {
    /// Appends bytes, and tells the number of their view.
    fn view(&mut self, target: Option<u32>, bytes: impl Iterator<Item = u8>) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let mut view = json!({"buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start});
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.views.push(view);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn accessor(&mut self, view: usize, component: u32, count: usize, kind: &str) -> usize {
        self.accessors.push(json!({"bufferView": view, "componentType": component, "count": count, "type": kind}));
        self.accessors.len() - 1
    }

    /// Appends elements of floats.
    fn floats(&mut self, numbers: impl Iterator<Item = f32>, kind: &str) -> usize {
        let start = self.bytes.len();
        let view = self.view(Some(ARRAY_BUFFER), numbers.flat_map(f32::to_le_bytes));
        let width = KINDS.iter().position(|&other| other == kind).unwrap_or(0) + 1;
        let count = (self.bytes.len() - start) / (4 * width);
        self.accessor(view, F32, count, kind)
    }
}

/// What elements of one to four numbers are called.
const KINDS: [&str; 4] = ["SCALAR", "VEC2", "VEC3", "VEC4"];

/// What all primitives are made of.
struct Content<'a> {
    model: &'a Model,
    uv: Option<&'a [[f64; 2]]>,
    tables: Vec<&'a Attribute>,
    frames: &'a Frames,
}

impl Content<'_> {
    /// Writes the triangles of a node and a material with their vertices.
    fn primitive(&self, mut part: Part, wedges: &Wedges, binary: &mut Binary) -> Value {
        let mut used = part.indices.clone();
        used.sort_unstable();
        used.dedup();
        if used.len() < wedges.first.len() {
            let place: HashMap<u32, u32> = used.iter().zip(0..).map(|(&wedge, place)| (wedge, place)).collect();
            part.indices.iter_mut().for_each(|index| *index = place[index]);
        }
        let corners: Vec<u32> = used.iter().map(|&wedge| wedges.first[wedge as usize]).collect();
        let attributes = self.attributes(&corners, self.frames.of(part.node), binary);
        let count = part.indices.len();
        let view = binary.view(Some(ELEMENT_ARRAY_BUFFER), part.indices.into_iter().flat_map(u32::to_le_bytes));
        let accessor = binary.accessor(view, U32, count, "SCALAR");
        json!({"attributes": attributes, "indices": accessor, "material": part.material})
    }

    /// Writes what vertices have, each given by one of its corners.
    fn attributes(&self, corners: &[u32], frame: &Frame, binary: &mut Binary) -> Map<String, Value> {
        let mut attributes = Map::new();
        attributes.insert("POSITION".into(), self.positions(corners, frame, binary).into());
        for table in &self.tables {
            let (name, accessor) = attribute((self.model, frame), corners, table, binary);
            attributes.entry(name).or_insert(accessor.into());
        }
        if let Some(uv) = self.uv {
            let points = corners.iter().map(|&corner| uv[corner as usize]);
            let flipped = points.flat_map(|[u, v]| [u as f32, (1.0 - v) as f32]);
            attributes.insert("TEXCOORD_0".into(), binary.floats(flipped, "VEC2").into());
        }
        attributes
    }

    fn positions(&self, corners: &[u32], frame: &Frame, binary: &mut Binary) -> usize {
        let point = |&corner: &u32| frame.point(self.model.points()[self.model.corners()[corner as usize] as usize]);
        let points: Vec<[f32; 3]> = corners.iter().map(point).collect();
        let accessor = binary.floats(points.iter().flatten().copied(), "VEC3");
        let [low, high] = bounds(&points).map(|bound| bound.map(f64::from));
        binary.accessors[accessor]["min"] = json!(low);
        binary.accessors[accessor]["max"] = json!(high);
        accessor
    }
}

/// Writes a table; its name and its accessor.
fn attribute(
    (model, frame): (&Model, &Frame),
    corners: &[u32],
    table: &Attribute,
    binary: &mut Binary,
) -> (String, usize) {
    let rows = || corners.iter().map(|&corner| (corner, table.row_at(model.corners(), corner as usize)));
    let width = table.width().unwrap_or(1);
    match table.meaning() {
        Meaning::Normal => {
            let numbers = rows().flat_map(|(corner, row)| direction((model, frame), table, corner, row));
            ("NORMAL".into(), binary.floats(numbers, "VEC3"))
        }
        Meaning::Colour => {
            let width = width.clamp(3, 4);
            let numbers = rows().flat_map(|(_, row)| colour(table, row).into_iter().take(width));
            ("COLOR_0".into(), binary.floats(numbers, KINDS[width - 1]))
        }
        Meaning::Other(name) => {
            let number = |row: Option<usize>, k| row.and_then(|row| table.row(row).nth(k)).unwrap_or(0.0) as f32;
            // What is not finite would be no glTF.
            let finite = |x: f32| if x.is_finite() { x } else { 0.0 };
            let numbers = rows().flat_map(|(_, row)| (0..width).map(move |k| finite(number(row, k))));
            let is_known = name.starts_with("TEXCOORD_") || name.starts_with("COLOR_");
            let name = if is_known { name.clone() } else { format!("_{name}") };
            (name, binary.floats(numbers, KINDS[width.clamp(1, 4) - 1]))
        }
    }
}

/// The normal of a corner, of length 1: its face's where the model has none there.
fn direction((model, frame): (&Model, &Frame), table: &Attribute, corner: u32, row: Option<usize>) -> [f32; 3] {
    let unit = |normal: [f64; 3]| {
        let [x, y, z] = frame.normal(normal);
        let length = (x * x + y * y + z * z).sqrt();
        (length > 0.0 && length.is_finite()).then(|| [x / length, y / length, z / length].map(|x| x as f32))
    };
    let own = row.and_then(|row| {
        let mut numbers = table.row(row);
        unit([numbers.next()?, numbers.next()?, numbers.next()?])
    });
    own.or_else(|| {
        let face = model.face_start().partition_point(|&start| start <= corner) - 1;
        let vertices = model.face(face);
        unit(normal([vertices[0], vertices[1], vertices[2]].map(|v| model.points()[v as usize])))
    })
    .unwrap_or([0.0, 0.0, 1.0])
}

/// Red, green, blue and alpha, linear; white where there is none.
fn colour(table: &Attribute, row: Option<usize>) -> [f32; 4] {
    let mut colour = [1.0; 4];
    let Some(row) = row else { return colour };
    for (k, (to, x)) in colour.iter_mut().zip(table.row(row)).enumerate() {
        let share = (x / table.scalar().one()).clamp(0.0, 1.0);
        *to = if k < 3 { to_linear(share) } else { share } as f32;
    }
    colour
}

/// The frames of nodes, and that of all that has none.
struct Frames {
    of_nodes: Vec<Option<Frame>>,
    middle: Frame,
}

impl Frames {
    fn of(&self, node: Option<u32>) -> &Frame {
        node.and_then(|node| self.of_nodes[node as usize].as_ref()).unwrap_or(&self.middle)
    }
}

/// The triangles of one node and one material.
struct Part {
    /// The node, if it has a frame.
    node: Option<u32>,
    /// The number of the material.
    material: usize,
    /// Their wedges.
    indices: Vec<u32>,
}

/// What stands at a node.
struct Mesh {
    node: Option<u32>,
    primitives: Vec<Value>,
}

/// A material's name and its look.
type Named<'a> = (Option<&'a str>, Option<&'a str>);

/// The triangles by their nodes and materials, and these, in the order of their first ones; `only` is one material in place of all.
fn parts<'a>(
    model: &'a Model,
    frames: &Frames,
    wedges: &Wedges,
    triangles: &Triangles,
    only: Option<&'a str>,
) -> (Vec<Part>, Vec<Named<'a>>) {
    let (mut number_of_part, mut number_of_material) = (HashMap::new(), HashMap::new());
    let (mut parts, mut materials): (Vec<Part>, Vec<Named>) = (Vec::new(), Vec::new());
    let attributes = model.attributes();
    for (corners, &face) in triangles.corners.iter().zip(&triangles.face_of) {
        let name = only.or_else(|| attributes.material(face as usize));
        let material = *number_of_material.entry(name).or_insert_with(|| {
            materials.push((name, attributes.look(face as usize).filter(|_| only.is_none())));
            materials.len() - 1
        });
        let node = attributes.node(face as usize).filter(|&node| frames.of_nodes[node as usize].is_some());
        let k = *number_of_part.entry((node, material)).or_insert_with(|| {
            parts.push(Part { node, material, indices: Vec::new() });
            parts.len() - 1
        });
        let [a, b, c] = corners.map(|corner| wedges.of_corner[corner as usize]);
        parts[k].indices.extend(if frames.of(node).mirrors() { [a, c, b] } else { [a, b, c] });
    }
    (parts, materials)
}

/// The look of a material of ours.
fn plain() -> Value {
    json!({"doubleSided": true, "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.8}})
}

/// Whether a look is that of a material of ours.
pub(super) fn is_plain(look: &Map<String, Value>) -> bool {
    plain().as_object() == Some(look)
}

/// A material with its own look, or with the texture as its colour if there is one.
fn material(name: Option<&str>, look: Option<&str>, texture: Option<GlbTexture>) -> Value {
    let own: Option<Value> = look.and_then(|look| serde_json::from_str(look).ok()).filter(Value::is_object);
    let mut material = own.unwrap_or_else(|| {
        let mut material = plain();
        if texture.is_some() {
            material["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
        }
        if let Some(GlbTexture::Baked { alpha_mode: mode @ ("MASK" | "BLEND"), .. }) = texture {
            material["alphaMode"] = mode.into();
        }
        material
    });
    if let Some(name) = name {
        material["name"] = name.into();
    }
    material
}

/// The nodes of the scene with their meshes, and which of them hang on none. What has no node gets one at the end.
fn nodes(model: &Model, frames: &Frames, meshes: &[Mesh]) -> (Vec<Value>, Vec<usize>) {
    let known = &model.attributes().nodes;
    let mut nodes: Vec<Value> = known.iter().map(|node| Value::Object(placed(node))).collect();
    let mut roots = Vec::new();
    for (number, node) in known.iter().enumerate() {
        let parent = node.parent.map(|parent| parent as usize).filter(|&parent| parent < number);
        match parent.map(|parent| &mut nodes[parent]["children"]) {
            Some(Value::Array(children)) => children.push(number.into()),
            Some(none) => *none = json!([number]),
            None => roots.push(number),
        }
    }
    for (number, mesh) in meshes.iter().enumerate() {
        match (mesh.node, &frames.middle) {
            (Some(node), _) => nodes[node as usize]["mesh"] = number.into(),
            (None, Frame::Middle { centre, scale }) => {
                roots.push(nodes.len());
                nodes.push(json!({"mesh": number, "translation": centre, "scale": [scale, scale, scale]}));
            }
            (None, Frame::Node(_)) => {}
        }
    }
    (nodes, roots)
}

/// A node's name and place.
fn placed(node: &SceneNode) -> Map<String, Value> {
    let mut map = Map::new();
    let mut put = |key: &str, value: Value| map.insert(key.to_owned(), value);
    if !node.name.is_empty() {
        put("name", node.name.as_str().into());
    }
    match &node.place {
        NodePlace::Matrix(matrix) => {
            put("matrix", json!(matrix.as_slice()));
        }
        NodePlace::Parts { translation, rotation, scale } => {
            translation.map(|translation| put("translation", json!(translation)));
            rotation.map(|rotation| put("rotation", json!(rotation)));
            scale.map(|scale| put("scale", json!(scale)));
        }
    }
    map
}

fn document(
    model: &Model,
    frames: &Frames,
    binary: &Binary,
    meshes: Vec<Mesh>,
    materials: Vec<Value>,
    image: Option<Value>,
) -> Value {
    let (nodes, roots) = nodes(model, frames, &meshes);
    let mesh = |mesh: Mesh| {
        let name = mesh.node.map_or("", |node| &model.attributes().nodes[node as usize].mesh);
        let mut written = json!({"primitives": mesh.primitives});
        if !name.is_empty() {
            written["name"] = name.into();
        }
        written
    };
    let meshes: Vec<Value> = meshes.into_iter().map(mesh).collect();
    let mut document = json!({
        "asset": {"version": "2.0", "generator": GENERATOR},
        "scene": 0,
        "scenes": [{"nodes": roots}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "accessors": binary.accessors,
        "bufferViews": binary.views,
        "buffers": [{"byteLength": binary.bytes.len()}],
    });
    if let Some(image) = image {
        document["textures"] = json!([{"source": 0, "sampler": 0}]);
        document["images"] = json!([image]);
        document["samplers"] = json!([{"wrapS": 10497, "wrapT": 10497, "magFilter": 9729, "minFilter": 9987}]);
    }
    document
}

fn write_chunks(mut json: Vec<u8>, binary: Vec<u8>, out: &mut impl Write) -> Result<(), WriteError> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let bytes = 12 + 8 + json.len() as u64 + 8 + binary.len() as u64;
    let size = u32::try_from(bytes).map_err(|_| WriteError::TooLarge { bytes })?;
    out.write_all(b"glTF")?;
    for word in [2, size, json.len() as u32] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(&json)?;
    out.write_all(&(binary.len() as u32).to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    out.write_all(&binary)?;
    Ok(())
}
