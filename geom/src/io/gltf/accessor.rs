//! Numbers of a glTF: accessors, which are windows into buffers, with single elements replaced where they are sparse.

use std::borrow::Cow;
use std::collections::HashMap;

use super::super::MOST_EXPANSION;
use super::super::error::{Fault, Place};
use super::document::{self, Document, Sparse};
use crate::counted::counted;
use crate::surface::ScalarType;

/// The buffers with what the document says of them.
pub(super) struct Buffers<'a> {
    document: &'a Document,
    bytes: Vec<Cow<'a, [u8]>>,
}

/// A table of numbers, read where they stand.
pub(super) struct Accessor<'a> {
    /// From the first element on; empty where all are zeros but the replaced ones.
    bytes: &'a [u8],
    stride: usize,
    pub(super) scalar: ScalarType,
    pub(super) width: usize,
    pub(super) count: usize,
    pub(super) is_normalized: bool,
    /// Elements that stand elsewhere.
    replaced: HashMap<u32, &'a [u8]>,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(document: &'a Document, bytes: Vec<Cow<'a, [u8]>>) -> Self {
        Self { document, bytes }
    }

    /// How many bytes all buffers have.
    pub(super) fn size(&self) -> usize {
        self.bytes.iter().map(|bytes| bytes.len()).sum()
    }

    /// An accessor; `what` is what it is for, in messages.
    pub(super) fn accessor(&self, index: usize, what: &str) -> Result<Accessor<'_>, Fault> {
        let wrong = |found: String, expected: &str| {
            Fault::unexpected(Place::File, format!("{found} in accessor {index} (for {what})"), expected)
        };
        let accessor = self.document.accessors.get(index);
        let accessor = accessor.ok_or_else(|| wrong("nothing".into(), "an accessor of that number"))?;
        let scalar = scalar(accessor.component_type).ok_or_else(|| {
            wrong(format!("component type {}", accessor.component_type), "5120 to 5123, 5125 or 5126")
        })?;
        let width = width(&accessor.shape)
            .ok_or_else(|| wrong(format!("type {:?}", accessor.shape), "SCALAR, VEC2, VEC3, VEC4 or a matrix"))?;
        let size = width * scalar.size();
        let (bytes, stride) = match accessor.buffer_view {
            Some(view) => {
                let (bytes, stride) = self.view(view)?;
                (bytes.get(accessor.byte_offset..).unwrap_or(&[]), stride.unwrap_or(size))
            }
            None => (&[][..], size),
        };
        let needed = accessor.count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size));
        let is_there = match accessor.buffer_view {
            Some(_) => stride >= size && needed.is_some_and(|needed| needed <= bytes.len()),
            // Zeros take no room in the file, so they may be as many as a compressed file could hold.
            None => needed.is_some_and(|needed| needed <= MOST_EXPANSION.saturating_mul(self.size())),
        };
        if !is_there {
            return Err(wrong(
                format!(
                    "{} of {}, {} apart,",
                    counted(accessor.count, "element", "elements"),
                    counted(size, "byte", "bytes"),
                    counted(stride, "byte", "bytes")
                ),
                "no more than its buffer holds",
            ));
        }
        let replaced = match &accessor.sparse {
            Some(sparse) => self.replaced(sparse, accessor, size).map_err(|found| wrong(found, "sound sparse data"))?,
            None => HashMap::new(),
        };
        let (count, is_normalized) = (accessor.count, accessor.normalized);
        Ok(Accessor { bytes, stride, scalar, width, count, is_normalized, replaced })
    }

    /// The bytes of a view, and how far apart its elements are.
    pub(super) fn view(&self, index: usize) -> Result<(&[u8], Option<usize>), Fault> {
        let wrong = |found: String| Fault::unexpected(Place::File, found, "no more than its buffer holds");
        let view = self.document.buffer_views.get(index).ok_or_else(|| wrong(format!("no buffer view {index}")))?;
        let buffer = self.bytes.get(view.buffer).ok_or_else(|| wrong(format!("no buffer {}", view.buffer)))?;
        let bytes = buffer.get(view.byte_offset..).and_then(|bytes| bytes.get(..view.byte_length));
        let bytes = bytes
            .ok_or_else(|| wrong(format!("{} in buffer view {index}", counted(view.byte_length, "byte", "bytes"))))?;
        Ok((bytes, view.byte_stride))
    }

    fn replaced(
        &self,
        sparse: &Sparse,
        accessor: &document::Accessor,
        size: usize,
    ) -> Result<HashMap<u32, &[u8]>, String> {
        let part = |part: &document::SparsePart, size: usize| {
            let (bytes, _) = self.view(part.buffer_view).ok()?;
            let length = sparse.count.checked_mul(size)?;
            bytes.get(part.byte_offset..)?.get(..length)
        };
        let missing =
            || format!("{} not there", counted(sparse.count, "sparse element that is", "sparse elements that are"));
        let kind = scalar(sparse.indices.component_type).filter(|kind| !kind.is_float()).ok_or_else(missing)?;
        let indices = part(&sparse.indices, kind.size()).ok_or_else(missing)?;
        let values = part(&sparse.values, size).ok_or_else(missing)?;
        let pairs = indices.chunks_exact(kind.size()).zip(values.chunks_exact(size));
        pairs
            .map(|(index, value)| match kind.decode(index) {
                index if index >= 0.0 && index < accessor.count as f64 => Ok((index as u32, value)),
                index => Err(format!("the sparse index {index}")),
            })
            .collect()
    }
}

impl Accessor<'_> {
    /// A number as it stands.
    pub(super) fn raw(&self, element: usize, component: usize) -> f64 {
        let at = component * self.scalar.size();
        let replaced = if self.replaced.is_empty() { None } else { self.replaced.get(&(element as u32)) };
        let bytes = match replaced {
            Some(bytes) => bytes.get(at..),
            None => self.bytes.get(element * self.stride + at..),
        };
        self.scalar.decode(bytes.unwrap_or(&[]))
    }

    /// A number as it is meant: an integer that stands for a share as that share.
    pub(super) fn number(&self, element: usize, component: usize) -> f64 {
        let x = self.raw(element, component);
        if self.is_normalized { (x / self.scalar.one()).max(-1.0) } else { x }
    }

    /// How many elements are replaced: each costs as much as an element.
    pub(super) fn extra_cost(&self) -> usize {
        self.replaced.len()
    }
}

fn scalar(component_type: u32) -> Option<ScalarType> {
    Some(match component_type {
        5120 => ScalarType::I8,
        5121 => ScalarType::U8,
        5122 => ScalarType::I16,
        5123 => ScalarType::U16,
        5125 => ScalarType::U32,
        5126 => ScalarType::F32,
        _ => return None,
    })
}

/// How many numbers an element has. Columns of small matrices are padded, which nothing here reads.
fn width(shape: &str) -> Option<usize> {
    Some(match shape {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" | "MAT2" => 4,
        "MAT3" => 9,
        "MAT4" => 16,
        _ => return None,
    })
}
