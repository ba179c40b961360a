//! The part of a glTF's JSON that shapes a surface. What is not named here is passed over.

use std::collections::BTreeMap;

use serde::de::{Error, IgnoredAny};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;
use serde_json::{Map, Value};

use super::super::error::{Fault, Place};
use crate::surface::NodePlace;

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Document {
    pub(super) asset: Asset,
    pub(super) scene: Option<usize>,
    pub(super) scenes: Vec<Scene>,
    pub(super) nodes: Vec<Node>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) accessors: Vec<Accessor>,
    pub(super) buffer_views: Vec<View>,
    pub(super) buffers: Vec<Buffer>,
    pub(super) materials: Vec<Material>,
    pub(super) extensions_required: Vec<String>,
    pub(super) animations: Vec<IgnoredAny>,
    pub(super) cameras: Vec<IgnoredAny>,
    pub(super) textures: Vec<Value>,
    pub(super) images: Vec<Image>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Asset {
    pub(super) version: String,
    pub(super) generator: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Scene {
    pub(super) nodes: Vec<usize>,
}

/// Transformations are boxed, as most of many nodes have none.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) mesh: Option<usize>,
    pub(super) children: Vec<usize>,
    pub(super) skin: Option<IgnoredAny>,
    matrix: Option<Box<[f64; 16]>>,
    translation: Option<Box<[f64; 3]>>,
    rotation: Option<Box<[f64; 4]>>,
    scale: Option<Box<[f64; 3]>>,
}

impl Node {
    /// Where it is.
    pub(super) fn place(&self) -> NodePlace {
        match &self.matrix {
            Some(matrix) => NodePlace::Matrix(matrix.clone()),
            None => NodePlace::Parts {
                translation: self.translation.as_deref().copied(),
                rotation: self.rotation.as_deref().copied(),
                scale: self.scale.as_deref().copied(),
            },
        }
    }
}

#[derive(Debug, Deserialize)]
pub(super) struct Mesh {
    pub(super) name: Option<String>,
    pub(super) primitives: Vec<Primitive>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Primitive {
    pub(super) attributes: BTreeMap<String, usize>,
    pub(super) indices: Option<usize>,
    #[serde(default = "triangles")]
    pub(super) mode: u32,
    pub(super) material: Option<usize>,
    #[serde(default)]
    pub(super) targets: Vec<IgnoredAny>,
}

/// The mode of triangles, which is that of a primitive that names none.
pub(super) fn triangles() -> u32 {
    4
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: usize,
    #[serde(rename = "type")]
    pub(super) shape: String,
    pub(super) sparse: Option<Sparse>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: usize,
    pub(super) indices: SparsePart,
    pub(super) values: SparsePart,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    /// Of indices only.
    #[serde(default)]
    pub(super) component_type: u32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct View {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
    pub(super) byte_length: usize,
}

/// A picture, of which nothing is refused: what says nothing of where it is, is nowhere.
#[derive(Debug, Default)]
pub(super) struct Image {
    pub(super) name: Option<String>,
    pub(super) uri: Option<String>,
    pub(super) view: Option<usize>,
}

impl<'de> Deserialize<'de> for Image {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut said = Value::deserialize(deserializer)?;
        let mut text = |key: &str| match said.get_mut(key).map(Value::take) {
            Some(Value::String(text)) => Some(text),
            _ => None,
        };
        let (name, uri) = (text("name").filter(|name| !name.is_empty()), text("uri"));
        let view = said.get("bufferView").and_then(Value::as_u64).and_then(|view| usize::try_from(view).ok());
        Ok(Self { name, uri, view })
    }
}

impl Image {
    /// What it is called: by its name, that of its file, or its number.
    pub(super) fn called(&self, number: usize) -> String {
        let file = self.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
        self.name.as_deref().or(file).map_or_else(|| format!("image {number}"), str::to_owned)
    }
}

#[derive(Debug, Default)]
pub(super) struct Material {
    pub(super) name: Option<String>,
    /// The number of the texture of its base colour, and whether that is placed otherwise than by the first coordinates.
    pub(super) base_colour: Option<(usize, bool)>,
    /// What else it has textures for.
    pub(super) other_maps: Vec<String>,
    /// All else that is said of it, but for textures, which are for other coordinates than those that are written, and extensions; nothing if
    /// that is more than JSON can hold here, as a number may be.
    pub(super) look: Map<String, Value>,
}

impl<'de> Deserialize<'de> for Material {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Default, Deserialize)]
        #[serde(default)]
        struct Named {
            name: Option<String>,
        }
        let text = Box::<RawValue>::deserialize(deserializer)?;
        let Named { name } = serde_json::from_str(text.get()).map_err(Error::custom)?;
        let mut look: Map<String, Value> = serde_json::from_str(text.get()).unwrap_or_default();
        let base_colour = look.get("pbrMetallicRoughness").and_then(|look| texture(look.get("baseColorTexture")?));
        look.retain(|key, _| !matches!(key.as_str(), "name" | "extensions" | "extras"));
        let mut other_maps = Vec::new();
        leave_out_textures(&mut look, &mut other_maps);
        other_maps.retain(|map| map != "baseColorTexture");
        Ok(Self { name, base_colour, other_maps, look })
    }
}

/// The number of a texture that a material names, and whether it is placed otherwise than by the first coordinates.
fn texture(named: &Value) -> Option<(usize, bool)> {
    let number = usize::try_from(named.get("index")?.as_u64()?).ok()?;
    let is_second = named.get("texCoord").is_some_and(|set| set.as_u64() != Some(0));
    let is_moved = named.get("extensions").is_some_and(|extensions| extensions.get("KHR_texture_transform").is_some());
    Some((number, is_second || is_moved))
}

fn leave_out_textures(look: &mut Map<String, Value>, left_out: &mut Vec<String>) {
    let is_texture = |key: &String| key.ends_with("Texture");
    left_out.extend(look.keys().filter(|key| is_texture(key)).cloned());
    look.retain(|key, _| !is_texture(key));
    look.values_mut().filter_map(Value::as_object_mut).for_each(|look| leave_out_textures(look, left_out));
}

/// Beginnings of the names of extensions that say how a surface looks and not where it is.
const HARMLESS: [&str; 9] = [
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_animation_",
    "KHR_xmp",
    "KHR_mesh_quantization",
    "EXT_texture_",
    "EXT_lights_",
    "MSFT_texture_",
];

/// Whether a document is of version 1, which has names for meshes where version 2 has numbers.
fn is_of_version_1(json: &[u8]) -> bool {
    let document: serde_json::Value = serde_json::from_slice(json).unwrap_or_default();
    document.get("meshes").is_some_and(serde_json::Value::is_object) && document.get("accessors").is_some()
}

impl Document {
    /// Reads the JSON, and refuses what is not glTF 2 or needs what is not read here.
    pub(super) fn read(json: &[u8]) -> Result<Self, Fault> {
        let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
        let document: Self = serde_json::from_slice(json).map_err(|error| {
            let found = match is_of_version_1(json) {
                true => "glTF of version 1".to_owned(),
                false => format!("JSON that is no glTF ({error})"),
            };
            Fault::unexpected(Place::File, found, "glTF of version 2")
        })?;
        if !document.asset.version.starts_with("2.") {
            let found = format!("the version {:?}", document.asset.version);
            return Err(Fault::unexpected(Place::File, found, "glTF of version 2"));
        }
        let is_foreign = |name: &&String| !HARMLESS.iter().any(|known| name.starts_with(known));
        match document.extensions_required.iter().find(is_foreign) {
            Some(name) => {
                let found = format!("the required extension `{name}`");
                let advice = if name.contains("compression") || name.contains("meshopt") {
                    "a glTF without compressed geometry: export or convert it without compression"
                } else {
                    "a glTF whose geometry needs no extension: export it without"
                };
                Err(Fault::unexpected(Place::File, found, advice))
            }
            None => Ok(document),
        }
    }
}
