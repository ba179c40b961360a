//! Small surfaces as files, whole or with damage.

use std::fmt::Write;

use base64::Engine;
use geom::shapes::Shape;

use crate::decode::Bytes;

/// The formats that surfaces are read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OBJ.
    Obj,
    /// OFF.
    Off,
    /// PLY in ASCII.
    PlyText,
    /// PLY, little-endian.
    PlyBinary,
    /// STL in ASCII.
    StlText,
    /// Binary STL.
    StlBinary,
    /// glTF in JSON, its buffer inside.
    Gltf,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Obj, Self::Off, Self::PlyText, Self::PlyBinary, Self::StlText, Self::StlBinary, Self::Gltf];

    /// The format that a byte stands for. The last came when inputs were stored already, which must go on meaning what they mean.
    pub fn of(byte: u8) -> Self {
        const FIRST: u8 = 6;
        const REST: u8 = 36 * FIRST;
        if byte < REST { Self::ALL[usize::from(byte % FIRST)] } else { Self::Gltf }
    }

    /// A file name of this format.
    pub fn name(self) -> &'static str {
        match self {
            Self::Obj => "a.obj",
            Self::Off => "a.off",
            Self::PlyText | Self::PlyBinary => "a.ply",
            Self::StlText | Self::StlBinary => "a.stl",
            Self::Gltf => "a.gltf",
        }
    }
}

/// A surface as a file.
pub fn file(shape: &Shape, format: Format) -> Vec<u8> {
    if format == Format::Gltf {
        return gltf(shape);
    }
    let Shape { points, triangles } = shape;
    let row = |p: &[f64; 3]| format!("{} {} {}", p[0], p[1], p[2]);
    let corners = || triangles.iter().map(|t| t.map(|v| points[v as usize]));
    let mut text = String::new();
    let _ = match format {
        Format::Obj => writeln!(text, "o a"),
        Format::Off => write!(text, "OFF\n{} {} 0\n", points.len(), triangles.len()),
        Format::PlyText | Format::PlyBinary => write!(
            text,
            "ply\nformat {} 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
             element face {}\nproperty list uchar int vertex_indices\nend_header\n",
            if format == Format::PlyText { "ascii" } else { "binary_little_endian" },
            points.len(),
            triangles.len()
        ),
        Format::StlText => writeln!(text, "solid a"),
        Format::StlBinary => write!(text, "{:80}", "a"),
        Format::Gltf => Ok(()),
    };
    let mut bytes = text.into_bytes();
    let mut line = |text: String| bytes.extend((text + "\n").bytes());
    match format {
        Format::Obj => {
            points.iter().for_each(|p| line(format!("v {}", row(p))));
            triangles.iter().for_each(|t| line(format!("f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1)));
        }
        Format::Off | Format::PlyText => {
            points.iter().for_each(|p| line(row(p)));
            triangles.iter().for_each(|t| line(format!("3 {} {} {}", t[0], t[1], t[2])));
        }
        Format::PlyBinary => {
            points.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
            for t in triangles {
                bytes.push(3);
                t.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
            }
        }
        Format::StlText => {
            for t in corners() {
                let vertices: String = t.iter().map(|p| format!("vertex {}\n", row(p))).collect();
                line(format!("facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet"));
            }
            line("endsolid a".into());
        }
        Format::StlBinary => {
            bytes.extend((triangles.len() as u32).to_le_bytes());
            for t in corners() {
                bytes.extend([0; 12]);
                t.iter().flatten().for_each(|&x| bytes.extend((x as f32).to_le_bytes()));
                bytes.extend([0; 2]);
            }
        }
        Format::Gltf => {}
    }
    bytes
}

/// A glTF, a value a line, so that values can be damaged one by one.
fn gltf(Shape { points, triangles }: &Shape) -> Vec<u8> {
    let mut binary = Vec::new();
    points.iter().flatten().for_each(|&x| binary.extend((x as f32).to_le_bytes()));
    triangles.iter().flatten().for_each(|v| binary.extend(v.to_le_bytes()));
    let (vertices, corners) = (points.len(), 3 * triangles.len());
    let data = base64::engine::general_purpose::STANDARD.encode(&binary);
    let json = serde_json::json!({
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0, "scale": [1, 2, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": vertices, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": corners, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 12 * vertices},
            {"buffer": 0, "byteOffset": 12 * vertices, "byteLength": 4 * corners},
        ],
        "buffers": [{"byteLength": binary.len(), "uri": format!("data:a/b;base64,{data}")}],
    });
    serde_json::to_vec_pretty(&json).expect("all keys are strings")
}

/// What stands in place of a number.
const WORDS: [&str; 16] = [
    "0",
    "-1",
    "1",
    "2",
    "-0",
    "nan",
    "inf",
    "1e300",
    "1e-300",
    "1e999",
    "99999999999999999999",
    "4294967295",
    "3",
    "4",
    "#",
    "",
];

/// Damages a file: words replaced, lines copied, moved and left out, bytes changed, its end cut off.
pub fn damage(file: &mut Vec<u8>, bytes: &mut Bytes) {
    while !bytes.is_empty() && !file.is_empty() {
        let at = bytes.below(file.len());
        let is_blank = |b: &u8| b.is_ascii_whitespace();
        let end_of = |from: usize, stop: &dyn Fn(&u8) -> bool| {
            file[from..].iter().position(stop).map_or(file.len(), |length| from + length)
        };
        match bytes.byte() % 6 {
            0 => {
                let start = file[..at].iter().rposition(is_blank).map_or(0, |before| before + 1);
                let word = WORDS[bytes.below(WORDS.len())];
                let end = end_of(start, &is_blank);
                file.splice(start..end, word.bytes());
            }
            1 => {
                let end = end_of(at, &|b| *b == b'\n');
                let to = bytes.below(file.len());
                let copy = file[at..end].to_vec();
                file.splice(to..to, copy);
            }
            2 => drop(file.drain(at..end_of(at, &|b| *b == b'\n'))),
            3 => file[at] = bytes.byte(),
            4 => file.insert(at, bytes.byte()),
            _ if bytes.byte() < 16 => file.truncate(at),
            _ => file[at] ^= 1 << bytes.below(8),
        }
    }
}
