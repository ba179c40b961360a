//! glTF 2.0 out, as one binary file with the texture in it.
//!
//! A vertex of glTF has one texture coordinate, so vertices are split into wedges. Positions are f32, taken from the middle of
//! the model, which the node moves back, so that a model far from the origin keeps its digits. glTF counts v
//! downwards from the upper edge of the image. There are no normals: viewers then shade each triangle flat.
//!
//! Source: Khronos Group, *glTF 2.0 Specification*, §3 and §4.

use std::io::Write;

use super::cells::Cells;
use super::error::WriteError;
use super::wedge::Wedges;
use crate::surface::{Model, Triangles};

/// Writes a model's triangles as `.glb`, with a texture coordinate for each corner and with these a PNG as the texture.
///
/// # Errors
/// When texture coordinates or triangles do not fit the model, when it is larger than 4 GB, or when writing fails.
pub fn write_glb(
    model: &Model,
    uv: Option<&[[f64; 2]]>,
    triangles: &Triangles,
    texture: Option<&[u8]>,
    mut out: impl Write,
) -> Result<(), WriteError> {
    let wedges = Wedges::split(model, uv, &[])?;
    Cells::new(model, Some(triangles))?;
    let frame = Frame::of(model);
    let positions = wedges.first.iter().map(|&corner| frame.local(model, corner)).collect::<Vec<_>>();
    let mut binary = Binary::default();
    let [low, high] = bounds(&positions);
    binary.push(Some(ARRAY_BUFFER), positions.iter().flatten().flat_map(|x| x.to_le_bytes()));
    let indices = triangles.corners.iter().flatten().map(|&corner| wedges.of_corner[corner as usize]);
    binary.push(Some(ELEMENT_ARRAY_BUFFER), indices.flat_map(u32::to_le_bytes));
    if let Some(uv) = uv {
        let texture_points = wedges.first.iter().map(|&corner| uv[corner as usize]);
        let flipped = texture_points.flat_map(|[u, v]| [u as f32, (1.0 - v) as f32]);
        binary.push(Some(ARRAY_BUFFER), flipped.flat_map(f32::to_le_bytes));
    }
    let texture = texture.filter(|_| uv.is_some());
    if let Some(texture) = texture {
        binary.push(None, texture.iter().copied());
    }
    let points = wedges.first.len();
    let json = Json {
        points,
        indices: 3 * triangles.len(),
        low,
        high,
        frame,
        has_uv: uv.is_some(),
        has_texture: texture.is_some(),
    };
    write_chunks(json.text(&binary).into_bytes(), binary.bytes, &mut out)
}

/// Names that glTF has for kinds of buffers and numbers.
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// How local f32 coordinates lie in the model's space.
struct Frame {
    centre: [f64; 3],
    scale: f64,
}

impl Frame {
    /// The middle of the model, and 1 as scale where f32 bears the size and its square, the size where not.
    fn of(model: &Model) -> Self {
        let (mut low, mut high) = (model.points()[0], model.points()[0]);
        for point in model.points() {
            for axis in 0..3 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let size = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        let is_moderate = (1e-15..=1e15).contains(&size) || size == 0.0;
        let centre = [0, 1, 2].map(|axis| 0.5 * low[axis] + 0.5 * high[axis]);
        Self { centre, scale: if is_moderate { 1.0 } else { size } }
    }

    fn local(&self, model: &Model, corner: u32) -> [f32; 3] {
        let point = model.points()[model.corners()[corner as usize] as usize];
        [0, 1, 2].map(|axis| ((point[axis] - self.centre[axis]) / self.scale) as f32)
    }
}

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

/// The binary chunk and the views into it.
#[derive(Default)]
struct Binary {
    bytes: Vec<u8>,
    views: Vec<String>,
}

impl Binary {
    fn push(&mut self, target: Option<u32>, bytes: impl Iterator<Item = u8>) {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let length = self.bytes.len() - start;
        let target = target.map_or(String::new(), |target| format!(r#","target":{target}"#));
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{length}{target}}}"#));
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }
}

/// What the JSON chunk says.
struct Json {
    points: usize,
    indices: usize,
    low: [f32; 3],
    high: [f32; 3],
    frame: Frame,
    has_uv: bool,
    has_texture: bool,
}

impl Json {
    fn text(&self, binary: &Binary) -> String {
        let Self { points, indices, frame: Frame { centre, scale }, .. } = self;
        let (low, high) = (self.low.map(f64::from), self.high.map(f64::from));
        let (attribute, accessor) = if self.has_uv {
            (
                r#","TEXCOORD_0":2"#,
                format!(r#",{{"bufferView":2,"componentType":{F32},"count":{points},"type":"VEC2"}}"#),
            )
        } else {
            ("", String::new())
        };
        let (colour, images) = self.texture();
        [
            r#"{"asset":{"version":"2.0","generator":"cones"},"scene":0,"scenes":[{"nodes":[0]}],"#.to_owned(),
            format!(r#""nodes":[{{"mesh":0,"translation":{centre:?},"scale":[{scale:?},{scale:?},{scale:?}]}}],"#),
            format!(r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0{attribute}}},"#),
            r#""indices":1,"material":0}]}],"materials":[{"doubleSided":true,"#.to_owned(),
            format!(r#""pbrMetallicRoughness":{{{colour}"metallicFactor":0,"roughnessFactor":0.8}}}}],{images}"#),
            format!(r#""accessors":[{{"bufferView":0,"componentType":{F32},"count":{points},"#),
            format!(r#""type":"VEC3","min":{low:?},"max":{high:?}}},"#),
            format!(r#"{{"bufferView":1,"componentType":{U32},"count":{indices},"type":"SCALAR"}}{accessor}],"#),
            format!(r#""bufferViews":[{}],"#, binary.views.join(",")),
            format!(r#""buffers":[{{"byteLength":{}}}]}}"#, binary.bytes.len()),
        ]
        .concat()
    }

    /// The material's colour, and the texture behind it.
    fn texture(&self) -> (&'static str, &'static str) {
        if !self.has_texture {
            return ("", "");
        }
        let images = concat!(
            r#""textures":[{"source":0,"sampler":0}],"images":[{"bufferView":3,"mimeType":"image/png"}],"#,
            r#""samplers":[{"wrapS":10497,"wrapT":10497,"magFilter":9729,"minFilter":9987}],"#
        );
        (r#""baseColorTexture":{"index":0},"#, images)
    }
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
