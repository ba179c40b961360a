//! Files: OBJ, PLY, OFF, STL and glTF in, OBJ, PLY and glTF out, each also gzipped.
//!
//! [`read`] makes a [`Model`] of a file. Numbers are read as f64 wherever the format writes them in decimal, vertices and
//! faces keep their order and polygons stay polygons. A file is known by its content; its extension is asked only where the
//! content does not tell. Memory is bounded by what a file holds, not by what its header claims, and a gzipped one may
//! expand to a hundred times its size.
//!
//! [`write_obj`] gives an OBJ back line for line with texture coordinates added.
//!
//! Not read: binary OFF, vertices in more than three dimensions, curves and free-form surfaces (they are counted in
//! [`Model::skipped`]).

mod cells;
mod colour;
mod error;
mod frame;
mod gltf;
mod joined;
mod lines;
mod look;
mod not_kept;
mod obj;
mod off;
mod ply;
mod refined_obj;
mod stl;
#[cfg(test)]
mod tests;
mod text;
mod textures;
mod transformation;
mod triangulated;
mod wedge;
mod write_glb;
mod write_obj;
mod write_ply;

use std::fs;
use std::io::{self, Read, Write};
use std::path::Path;

use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;

use crate::surface::Model;
use error::Fault;
use text::Lines;

pub use error::{Place, Problem, ReadError, WriteError};
pub use not_kept::{MeshFormat, NotKept, not_kept};
pub use refined_obj::{refine_obj, with_split_edges};
pub use textures::{Picture, Texture, Textures};
pub use triangulated::triangulated;
pub use write_glb::{GlbTexture, write_glb};
pub use write_obj::{Material, ObjContent, write_obj};
pub use write_ply::write_ply;

/// How many times its size a gzip file may expand to. Meshes of programs and scanners compress 2 to 13 times, a regular
/// grid in text STL 42 times, one byte repeated 1030 times.
const MOST_EXPANSION: usize = 100;

/// So many bytes of a picture are read.
const MOST_OF_PICTURE: u64 = 1 << 30;

/// The formats that can be read.
#[derive(Debug, Clone, Copy)]
enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Khronos' scenes, binary or JSON.
    Gltf,
    /// Geomview's object file format.
    Off,
    /// Stanford's polygon file format.
    Ply,
    /// Stereolithography, text or binary.
    Stl,
}

/// Reads a mesh file.
///
/// # Errors
/// When the file is missing, unreadable, of no known format, damaged, or holds no surface.
pub fn read(path: impl AsRef<Path>) -> Result<Model, ReadError> {
    let path = path.as_ref();
    let bytes = load(path).map_err(|problem| Fault::from(problem).in_file(path))?;
    read_beside(bytes, path, Some(path.parent().unwrap_or(Path::new(""))))
}

/// Reads a mesh file that is already in memory.
///
/// `name` stands for the path in messages, and its extension is asked where the content does not tell the format.
///
/// ```
/// let model = geom::io::read_bytes(b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n".to_vec(), "triangle.off")?;
/// assert_eq!((model.vertex_count(), model.face_count()), (3, 1));
/// # Ok::<(), geom::io::ReadError>(())
/// ```
///
/// # Errors
/// When the bytes are of no known format, damaged, or hold no surface.
pub fn read_bytes(bytes: Vec<u8>, name: impl AsRef<Path>) -> Result<Model, ReadError> {
    read_beside(bytes, name.as_ref(), None)
}

/// Reads a mesh file that comes through a pipe, to its end; the content tells the format. `name` stands for the path in messages.
///
/// # Errors
/// When the pipe breaks, or as [`read_bytes`].
pub fn read_stream(mut input: impl Read, name: impl AsRef<Path>) -> Result<Model, ReadError> {
    let mut bytes = Vec::new();
    match input.read_to_end(&mut bytes) {
        Ok(_) => read_bytes(bytes, name),
        Err(error) => Err(Fault::from(Problem::Io(error)).in_file(name.as_ref())),
    }
}

/// The bytes of a picture of the [`Textures`] of a model that was read from `path`; of a file of its own the first gigabyte.
///
/// # Errors
/// When the picture is unknown, its file missing, unreadable, a pipe or a device, and of one in a glTF as [`read`].
pub fn read_picture(path: impl AsRef<Path>, picture: &Picture) -> Result<Vec<u8>, ReadError> {
    let path = path.as_ref();
    let (file, read) = match picture {
        Picture::File(file) => (&**file, load_named(file, MOST_OF_PICTURE).map_err(Fault::from)),
        Picture::Image(number) => {
            let bytes = load(path).and_then(decompress).map_err(Fault::from);
            (path, bytes.and_then(|bytes| gltf::image(&bytes, *number, path.parent())))
        }
        Picture::Unknown(name) => (Path::new(name), Err(Problem::Missing.into())),
    };
    read.map_err(|fault| fault.in_file(file))
}

/// Writes what `content` writes, compressed with gzip.
///
/// # Errors
/// What `content` returns, and when writing fails.
pub fn gzip(out: impl Write, content: impl FnOnce(&mut dyn Write) -> Result<(), WriteError>) -> Result<(), WriteError> {
    let mut compressed = GzEncoder::new(out, Compression::default());
    content(&mut compressed)?;
    compressed.finish()?.flush()?;
    Ok(())
}

/// Reads a file whose other files, if it has any, are in a folder.
fn read_beside(bytes: Vec<u8>, name: &Path, folder: Option<&Path>) -> Result<Model, ReadError> {
    let read = || {
        let bytes = decompress(bytes)?;
        if bytes.is_empty() {
            return Err(Problem::Empty.into());
        }
        let format = Format::of_content(&bytes).or_else(|| Format::of_name(name)).ok_or(Problem::UnknownFormat)?;
        read_format(bytes, format, folder)
    };
    read().map_err(|fault| fault.in_file(name))
}

fn read_format(bytes: Vec<u8>, format: Format, folder: Option<&Path>) -> Result<Model, Fault> {
    match format {
        Format::Obj => obj::read(bytes),
        Format::Gltf => gltf::read(&bytes, folder),
        Format::Off => off::read(&bytes),
        Format::Ply => ply::read(&bytes),
        Format::Stl => stl::read(&bytes),
    }
}

/// The first `most` bytes of a file that another one names. A pipe may never begin and a device never end, so it is no file.
fn load_named(path: &Path, most: u64) -> Result<Vec<u8>, Problem> {
    let kind = fs::metadata(path).map_err(unreadable)?;
    if kind.is_dir() {
        return Err(Problem::Directory);
    }
    if !kind.is_file() {
        return Err(Problem::NoFile);
    }
    let mut bytes = Vec::new();
    fs::File::open(path).and_then(|file| file.take(most).read_to_end(&mut bytes)).map_err(unreadable)?;
    Ok(bytes)
}

fn load(path: &Path) -> Result<Vec<u8>, Problem> {
    if path.is_dir() {
        return Err(Problem::Directory);
    }
    fs::read(path).map_err(unreadable)
}

fn unreadable(error: io::Error) -> Problem {
    match error.kind() {
        io::ErrorKind::NotFound => Problem::Missing,
        _ => Problem::Io(error),
    }
}

/// The content of a gzip file, or the bytes as they are.
fn decompress(bytes: Vec<u8>) -> Result<Vec<u8>, Problem> {
    if !bytes.starts_with(b"\x1f\x8b") {
        return Ok(bytes);
    }
    let most = MOST_EXPANSION.saturating_mul(bytes.len());
    let mut content = Vec::new();
    MultiGzDecoder::new(&bytes[..]).take(most as u64 + 1).read_to_end(&mut content).map_err(Problem::Gzip)?;
    if content.len() > most { Err(Problem::Expansion { compressed: bytes.len() }) } else { Ok(content) }
}

impl Format {
    /// The format by the name's extension, with or without `.gz` behind it.
    fn of_name(name: &Path) -> Option<Self> {
        let extension = name.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "obj" => Some(Self::Obj),
            "glb" | "gltf" => Some(Self::Gltf),
            "off" | "coff" | "noff" | "cnoff" => Some(Self::Off),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "gz" => Self::of_name(Path::new(name.file_stem()?)),
            _ => None,
        }
    }

    /// The format where the content leaves no doubt.
    fn of_content(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(gltf::MAGIC) {
            return Some(Self::Gltf);
        }
        let first = Lines::new(bytes).next_filled()?;
        let word = first.words().next()?;
        match word {
            b"ply" => Some(Self::Ply),
            _ if word.starts_with(b"{") => Some(Self::Gltf),
            _ if off::is_keyword(word) => Some(Self::Off),
            _ if stl::is_stl(bytes) => Some(Self::Stl),
            _ if obj::is_keyword(word) => Some(Self::Obj),
            _ => None,
        }
    }
}
