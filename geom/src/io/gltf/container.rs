//! Where a glTF's JSON and its buffers are: in one binary file, in the JSON itself, or in files beside it.

use std::borrow::Cow;
use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::super::error::{Fault, Place, Problem};
use super::super::text::{Lines, quote};
use super::document::Document;
use crate::counted::counted;

/// What a binary glTF begins with.
pub(in super::super) const MAGIC: &[u8] = b"glTF";
const HEADER: usize = 12;

/// The JSON, and the binary chunk behind it if there is one, and how many bytes follow the end.
pub(super) struct Container<'a> {
    pub(super) json: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
    pub(super) surplus: usize,
}

impl<'a> Container<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        if !bytes.starts_with(MAGIC) {
            let mut words = Lines::new(bytes).next_filled().into_iter().flat_map(|line| line.words());
            let first = words.next().unwrap_or_default();
            if !first.starts_with(b"{") {
                let found = format!("content that begins with {}", quote(&first[..first.len().min(MAGIC.len())]));
                return Err(Fault::unexpected(Place::Byte(0), found, "`glTF` of a .glb, or `{` of a .gltf"));
            }
            return Ok(Self { json: bytes, binary: None, surplus: 0 });
        }
        let word = |at: usize| bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
        let (Some(version), Some(length)) = (word(4), word(8)) else {
            return Err(Problem::CutShort {
                what: "bytes of a header".into(),
                claimed: HEADER as u64,
                present: bytes.len() as u64,
            }
            .into());
        };
        if version != 2 {
            return Err(Fault::unexpected(Place::Byte(4), format!("version {version}"), "glTF of version 2"));
        }
        let length = length as usize;
        let whole = bytes.get(..length).ok_or_else(|| cut_short(length, bytes.len()))?;
        let mut at = HEADER;
        let (mut json, mut binary) = (None, None);
        while at < whole.len() {
            let (kind, chunk, next) = chunk(whole, at)?;
            match kind {
                b"JSON" if json.is_none() => json = Some(chunk),
                b"BIN\0" if binary.is_none() => binary = Some(chunk),
                _ => {}
            }
            at = next;
        }
        let json = json.ok_or_else(|| Fault::unexpected(Place::Byte(HEADER as u64), "no JSON chunk", "one"))?;
        Ok(Self { json, binary, surplus: bytes.len() - length })
    }
}

fn cut_short(claimed: usize, present: usize) -> Fault {
    Problem::CutShort {
        what: if claimed == 1 { "byte" } else { "bytes" }.into(),
        claimed: claimed as u64,
        present: present as u64,
    }
    .into()
}

/// The kind and the content of the chunk at a byte, and where the next one begins.
fn chunk(bytes: &[u8], at: usize) -> Result<(&[u8], &[u8], usize), Fault> {
    let head = bytes.get(at..at + 8);
    let head = head.ok_or_else(|| Fault::unexpected(Place::Byte(at as u64), "the end of the file", "a chunk"))?;
    let length = head.first_chunk().copied().map_or(0, u32::from_le_bytes) as usize;
    let content = bytes.get(at + 8..).and_then(|rest| rest.get(..length));
    let content = content.ok_or_else(|| {
        let found = format!("a chunk of {}", counted(length, "byte", "bytes"));
        Fault::unexpected(Place::Byte(at as u64), found, format!("at most the {} that are left", bytes.len() - at - 8))
    })?;
    Ok((&head[4..], content, at + 8 + length.next_multiple_of(4)))
}

/// The bytes of all buffers. `folder` is where files beside the glTF are; without it they cannot be read.
pub(super) fn buffers<'a>(
    document: &Document,
    binary: Option<&'a [u8]>,
    folder: Option<&Path>,
) -> Result<Vec<Cow<'a, [u8]>>, Fault> {
    let load = |(i, buffer): (usize, &super::document::Buffer)| {
        let bytes: Cow<[u8]> = match (&buffer.uri, binary) {
            (None, Some(binary)) if i == 0 => Cow::Borrowed(binary),
            (None, _) => return Err(Fault::unexpected(Place::File, format!("buffer {i} without data"), "a `uri`")),
            (Some(uri), _) => Cow::Owned(load(uri, "a buffer", folder)?),
        };
        match bytes.len() {
            present if present < buffer.byte_length => {
                let what = format!("byte{} of buffer {i}", if buffer.byte_length == 1 { "" } else { "s" });
                Err(Problem::CutShort { what, claimed: buffer.byte_length as u64, present: present as u64 }.into())
            }
            _ => Ok(bytes),
        }
    };
    document.buffers.iter().enumerate().map(load).collect()
}

/// The bytes at a `uri`, of which `what` says what they are for.
pub(super) fn load(uri: &str, what: &str, folder: Option<&Path>) -> Result<Vec<u8>, Fault> {
    if let Some(data) = uri.strip_prefix("data:") {
        let encoded = data.split_once(";base64,").map(|(_, encoded)| encoded);
        return encoded
            .and_then(|encoded| STANDARD.decode(encoded).ok())
            .ok_or_else(|| Fault::unexpected(Place::File, "data in a `uri` that cannot be decoded", "base64"));
    }
    let quoted = super::super::text::quote(uri.as_bytes());
    let path = beside(uri)
        .ok_or_else(|| Fault::unexpected(Place::File, format!("{what} at {quoted}"), "a file beside the glTF"))?;
    let path = folder.map(|folder| folder.join(path)).ok_or_else(|| {
        let found = format!("{what} in another file, {quoted}");
        Fault::unexpected(Place::File, found, "a .glb, which has all in one, or the path of the .gltf")
    })?;
    super::super::load_named(&path, u64::MAX).map_err(|problem| {
        let found = format!("{what} in {}, of which it is said that {problem}", path.display());
        Fault::unexpected(Place::File, found, "that file beside the .gltf")
    })
}

/// The path of a relative `uri`: no other place than below the glTF's folder or beside it.
pub(in super::super) fn beside(uri: &str) -> Option<PathBuf> {
    let path = PathBuf::from(unescaped(uri)?);
    let is_plain = |part: Component| matches!(part, Component::Normal(_) | Component::CurDir | Component::ParentDir);
    (!uri.contains("://") && path.components().all(is_plain)).then_some(path)
}

/// The text with `%20` and the like as characters.
fn unescaped(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        if *first == b'%' && tail.len() >= 2 {
            bytes.push(u8::from_str_radix(std::str::from_utf8(&tail[..2]).ok()?, 16).ok()?);
            rest = &tail[2..];
        } else {
            bytes.push(*first);
            rest = tail;
        }
    }
    String::from_utf8(bytes).ok()
}
