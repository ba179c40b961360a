//! Stereolithography, text and binary: a soup of triangles, welded here.
//!
//! Binary is 80 bytes of comment, the number of triangles, and 50 bytes for each (normal, three points in f32, 16 bits
//! of attributes), little endian. Text is `facet normal … outer loop vertex x y z … endloop endfacet` between `solid` and
//! `endsolid`. Which of them a file is, its size and its words tell: the comment of many binary files starts with `solid`.
//!
//! Points with equal coordinates (-0 equals 0) become one vertex, numbered by first appearance. Nothing else is welded, and
//! triangles that thereby get a vertex twice stay in the model. Normals are not read. Names of solids and the attributes of triangles, as which some programs
//! write colours, are passed over, and said to be ([`Attributes::left`]).
//!
//! Source: 3D Systems, *Stereolithography Interface Specification*, 1989. The `stl_io` crate is not used because it reads
//! text in f32, goes by the first line, and does not say where a file is wrong; tests compare with it.

use std::collections::HashMap;

use super::error::{Fault, Place, Problem};
use super::text::{Lines, Words, quote};
use crate::counted::counted;
use crate::surface::{Attributes, Model, Polygons, Skipped, is_coordinate};

const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Whether the content is surely of this format.
pub(super) fn is_stl(bytes: &[u8]) -> bool {
    claimed_size(bytes) == Some(bytes.len() as u64) || is_text(bytes)
}

/// The size that the count in a binary file implies.
fn claimed_size(bytes: &[u8]) -> Option<u64> {
    claimed_triangles(bytes).map(|n| HEADER as u64 + TRIANGLE as u64 * n)
}

fn claimed_triangles(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEADER - 4..HEADER)?.try_into().ok()?;
    Some(u64::from(u32::from_le_bytes(count)))
}

/// Text starts with `solid`, and its second line with `facet` or `endsolid`.
fn is_text(bytes: &[u8]) -> bool {
    let mut lines = Lines::new(bytes);
    let mut starts_with = |keywords: &[&[u8]]| {
        let word = lines.next_filled().and_then(|line| line.words().next());
        word.is_some_and(|word| keywords.iter().any(|keyword| word.eq_ignore_ascii_case(keyword)))
    };
    starts_with(&[b"solid"]) && starts_with(&[b"facet", b"endsolid"])
}

pub(super) fn read(bytes: &[u8]) -> Result<Model, Fault> {
    let is_binary = claimed_size(bytes) == Some(bytes.len() as u64) || !(is_text(bytes) || looks_like_text(bytes));
    if is_binary { read_binary(bytes) } else { read_text(bytes) }
}

/// Whether the content is text of any kind. No binary file begins so: the number of its triangles has a byte 0 if there are fewer than
/// sixteen million.
fn looks_like_text(bytes: &[u8]) -> bool {
    bytes.iter().take(HEADER).all(|&byte| byte >= b' ' || byte.is_ascii_whitespace())
}

fn read_binary(bytes: &[u8]) -> Result<Model, Fault> {
    let Some(claimed) = claimed_triangles(bytes) else {
        let found = format!("a file of {} that is no text", counted(bytes.len(), "byte", "bytes"));
        return Err(Fault::unexpected(Place::File, found, format!("at least {HEADER} bytes of binary STL")));
    };
    let records = bytes[HEADER..].chunks_exact(TRIANGLE);
    let present = records.len() as u64;
    if present < claimed {
        let what = if claimed == 1 { "triangle" } else { "triangles" }.into();
        return Err(Fault::new(Place::Byte(bytes.len() as u64), Problem::CutShort { what, claimed, present }));
    }
    let mut soup = Soup::default();
    for (i, record) in records.take(claimed as usize).enumerate() {
        let start = HEADER + TRIANGLE * i + 12;
        for (corner, point) in record[12..48].chunks_exact(12).enumerate() {
            soup.push(binary_point(point, start + 12 * corner)?);
        }
        soup.polygons.end_face();
    }
    if bytes[HEADER..].chunks_exact(TRIANGLE).take(claimed as usize).any(|record| record[48..] != [0; 2]) {
        soup.left.push("attributes of triangles".to_owned());
    }
    soup.finish(bytes.len() - HEADER - TRIANGLE * claimed as usize)
}

fn binary_point(bytes: &[u8], at: usize) -> Result<[f64; 3], Fault> {
    let mut point = [0.0; 3];
    for (x, bytes) in point.iter_mut().zip(bytes.chunks_exact(4)) {
        *x = f32::from_le_bytes(bytes.try_into().expect("chunks of four bytes")).into();
    }
    match point.iter().find(|&&x| !is_coordinate(x)) {
        Some(x) => Err(Fault::unexpected(
            Place::Byte(at as u64),
            format!("a point with the coordinate {x:e}"),
            "finite numbers",
        )),
        None => Ok(point),
    }
}

fn read_text(text: &[u8]) -> Result<Model, Fault> {
    let mut soup = Soup::default();
    let mut lines = Lines::new(text);
    let mut state = State::Outside;
    while let Some(line) = lines.next_filled() {
        let mut words = line.words();
        let keyword = words.next().unwrap_or_default().to_ascii_lowercase();
        state = state.step(&keyword, &words)?;
        if keyword == b"solid" && soup.left.is_empty() && words.next().is_some() {
            soup.left.push("names of solids".to_owned());
        }
        if keyword == b"vertex" {
            soup.push(words.point()?);
        }
        if keyword == b"endloop" {
            soup.polygons.end_face();
        }
    }
    if !matches!(state, State::Outside | State::Ended) {
        return Err(Fault::cut_short(Place::Line(lines.number()), state.expects()));
    }
    soup.finish(0)
}

/// Where in a text file we are: which keywords may come.
#[derive(Debug, Clone, Copy)]
enum State {
    Outside,
    /// After a solid.
    Ended,
    Solid,
    Facet,
    Loop {
        vertices: u8,
    },
    LoopEnded,
}

impl State {
    fn step(self, keyword: &[u8], words: &Words) -> Result<Self, Fault> {
        match (self, keyword) {
            (Self::Outside | Self::Ended, b"solid") => Ok(Self::Solid),
            (Self::Solid, b"facet") => Ok(Self::Facet),
            (Self::Solid, b"endsolid") => Ok(Self::Ended),
            (Self::Facet, b"outer") => Ok(Self::Loop { vertices: 0 }),
            (Self::Loop { vertices }, b"vertex") if vertices < 3 => Ok(Self::Loop { vertices: vertices + 1 }),
            (Self::Loop { vertices: 3 }, b"endloop") => Ok(Self::LoopEnded),
            (Self::LoopEnded, b"endfacet") => Ok(Self::Solid),
            (Self::Outside, _) => {
                let found = format!("text that begins with {}", quote(keyword));
                Err(Fault::unexpected(words.place(), found, "`solid`, as in a text STL, or a binary STL"))
            }
            _ => Err(words.unexpected(keyword, self.expects())),
        }
    }

    fn expects(self) -> &'static str {
        match self {
            Self::Outside => "`solid`",
            Self::Ended => "`solid` or the end of the file",
            Self::Solid => "`facet` or `endsolid`",
            Self::Facet => "`outer loop`",
            Self::Loop { vertices: 3 } => "`endloop`",
            Self::Loop { .. } => "`vertex`",
            Self::LoopEnded => "`endfacet`",
        }
    }
}

/// Points and triangles, welded as they come.
#[derive(Default)]
struct Soup {
    points: Vec<[f64; 3]>,
    polygons: Polygons,
    vertex_of: HashMap<[u64; 3], u32>,
    /// What is passed over.
    left: Vec<String>,
}

impl Soup {
    fn push(&mut self, point: [f64; 3]) {
        // Adding 0 turns -0 into 0; equality of the coordinates is the definition of welding, so bits are compared.
        let key = point.map(|x| (x + 0.0).to_bits());
        let next = self.points.len() as u32;
        let vertex = *self.vertex_of.entry(key).or_insert(next);
        if vertex == next {
            self.points.push(point);
        }
        self.polygons.corners.push(vertex);
    }

    fn finish(self, surplus: usize) -> Result<Model, Fault> {
        let skipped = Skipped { surplus, ..Skipped::default() };
        let attributes = Attributes { left: self.left, ..Attributes::default() };
        Ok(Model::new(self.points, self.polygons)?.with_skipped(skipped).with_attributes(attributes))
    }
}
