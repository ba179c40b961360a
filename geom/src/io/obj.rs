//! Wavefront OBJ, read in f64.
//!
//! What shapes a surface is taken: `v`, `vt` and `f`. Corners may be `v`, `v/vt`, `v//vn` or `v/vt/vn`, with negative indices
//! counted back from the latest vertex, and may name vertices that come later. Normals, colours behind a vertex and the names of
//! materials are [`Attributes`](crate::Attributes), for other formats. Groups stay in the text, and lines, points and free-form
//! statements are counted. The text is kept, for the writer.
//!
//! Source: Wavefront Technologies, *Advanced Visualizer* appendix B1, *Object Files (.obj)*. The obj-rs crate is not used
//! because it reads f32, panics on free-form curves, and refuses vertex colours and byte-order marks.

mod appearance;
mod blocks;

use super::error::{Fault, Place};
use super::text::{Line, Lines, Words, block_size, integer, number};
use crate::parallel::try_each;
use crate::surface::{Model, ModelError, Polygons, Skipped, TextureCoordinates};
use appearance::Appearance;
use blocks::{Blocks, Counts};

/// Statements that are kept in the text but say nothing about the surface.
const APPEARANCE: [&[u8]; 19] = [
    b"vn",
    b"g",
    b"o",
    b"s",
    b"mg",
    b"usemtl",
    b"mtllib",
    b"usemap",
    b"maplib",
    b"lod",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"shadow_obj",
    b"trace_obj",
    b"call",
    b"csh",
    b"ctech",
    b"stech",
];

/// Statements of free-form curves and surfaces, the superseded ones included.
const FREE_FORM: [&[u8]; 20] = [
    b"vp", b"cstype", b"deg", b"bmat", b"step", b"curv", b"curv2", b"surf", b"parm", b"trim", b"hole", b"scrv", b"sp",
    b"end", b"con", b"bzp", b"bsp", b"cdc", b"cdp", b"res",
];

/// Whether an OBJ file may start with this word.
pub(super) fn is_keyword(word: &[u8]) -> bool {
    matches!(word, b"v" | b"vt" | b"l" | b"p")
        || is_face(word)
        || APPEARANCE.contains(&word)
        || FREE_FORM.contains(&word)
}

/// Whether this word opens a face; `fo` is what early versions wrote.
pub(super) fn is_face(word: &[u8]) -> bool {
    matches!(word, b"f" | b"fo")
}

pub(super) fn read(text: Vec<u8>) -> Result<Model, Fault> {
    let size = block_size(&text);
    read_in_blocks(text, size)
}

fn read_in_blocks(text: Vec<u8>, size: usize) -> Result<Model, Fault> {
    let draft = Draft::of(&Blocks::new(&text, size))?;
    let (vertices, faces) = (draft.points.len(), draft.polygons.face_count());
    match draft.finish() {
        Ok(model) => Ok(model.with_obj_text(text)),
        Err(ModelError::Index { face, index, .. }) => {
            let found = format!("vertex {}", u64::from(index) + 1);
            Err(Fault::unexpected(line_of_face(&text, face), found, format!("a vertex from 1 to {vertices}")))
        }
        Err(ModelError::NoVertices) if faces > 0 => {
            Err(Fault::unexpected(line_of_face(&text, 0), "a face", "vertices (`v x y z`) for it"))
        }
        Err(ModelError::NoVertices) => {
            Err(Fault::unexpected(Place::File, "no line that begins with `v`", "vertices, as lines `v x y z`"))
        }
        Err(error @ ModelError::ManyCorners { face, .. }) => Err(Fault::new(line_of_face(&text, face), error.into())),
        Err(error) => Err(error.into()),
    }
}

fn line_of_face(text: &[u8], face: usize) -> Place {
    let mut faces = Lines::joined(text).filter(|line| line.words().next().is_some_and(is_face));
    faces.nth(face).map_or(Place::File, |line| line.place())
}

/// A model under construction.
#[derive(Default)]
struct Draft {
    points: Vec<[f64; 3]>,
    polygons: Polygons,
    uv_points: Vec<[f64; 2]>,
    /// One a corner, once any corner had one.
    uv_corners: Vec<u32>,
    skipped: Skipped,
    appearance: Appearance,
}

impl Draft {
    /// What all blocks say, or the first of their errors.
    fn of(blocks: &Blocks) -> Result<Self, Fault> {
        let mut drafts: Vec<Self> = (0..blocks.len()).map(|_| Self::default()).collect();
        try_each(0, &mut drafts, &|k, draft| {
            let before = || blocks.before(k);
            let taken = blocks.lines(k).try_for_each(|line| draft.take(&line, &before));
            taken.map_err(|fault| fault.after_lines(before().lines))
        })?;
        let joined = drafts.into_iter().reduce(|mut joined, next| {
            joined.append(next);
            joined
        });
        Ok(joined.unwrap_or_default())
    }

    /// Appends what the next block says.
    fn append(&mut self, mut next: Self) {
        let corners = self.polygons.corners.len();
        append_rows(&mut self.uv_corners, corners, &next.uv_corners);
        self.appearance.append(next.appearance, [self.polygons.face_count(), next.polygons.face_count()], corners);
        self.points.append(&mut next.points);
        self.polygons.append(&next.polygons);
        self.uv_points.append(&mut next.uv_points);
        self.skipped.lines += next.skipped.lines;
        self.skipped.points += next.skipped.points;
        self.skipped.free_form += next.skipped.free_form;
        self.skipped.unknown += next.skipped.unknown;
    }

    fn take(&mut self, line: &Line, before: &impl Fn() -> Counts) -> Result<(), Fault> {
        let mut words = line.words();
        let Some(keyword) = words.next() else { return Ok(()) };
        match keyword {
            b"v" => {
                self.points.push(words.point()?);
                self.appearance.colour(words);
            }
            b"vn" => self.appearance.normal(words),
            b"usemtl" => self.appearance.material(words),
            b"mtllib" => self.appearance.libraries(words),
            b"g" | b"o" => self.appearance.group(),
            b"vt" => self.uv_points.push(texture_point(&mut words)?),
            b"l" => self.skipped.lines += 1,
            b"p" => self.skipped.points += 1,
            _ if is_face(keyword) => self.face(words, before)?,
            _ if APPEARANCE.contains(&keyword) => {}
            _ if FREE_FORM.contains(&keyword) => self.skipped.free_form += 1,
            _ if keyword[0].is_ascii_alphabetic() && keyword.iter().all(u8::is_ascii_graphic) => {
                self.skipped.unknown += 1;
            }
            _ => return Err(words.unexpected(keyword, "a statement such as `v` or `f`")),
        }
        Ok(())
    }

    /// Takes a face; what comes `before` the block is asked only where indices are counted back, or wrong.
    fn face(&mut self, mut words: Words, before: &impl Fn() -> Counts) -> Result<(), Fault> {
        let mut corners = 0;
        while let Some(word) = words.next() {
            let (v, vt, vn) =
                split(word).ok_or_else(|| words.unexpected(word, "a corner such as `7`, `7/3` or `7/3/5`"))?;
            let points = || before().points + self.points.len();
            let vertex = resolve(v, points).ok_or_else(|| words.unexpected(word, legal_indices(points())))?;
            self.texture_corner(vt, before);
            self.appearance.corner(self.polygons.corners.len(), vn, before);
            self.polygons.corners.push(vertex);
            corners += 1;
        }
        if corners < 3 {
            return Err(match words.is_last() {
                true => Fault::cut_short(words.place(), "at least 3 corners of a face"),
                false => Fault::few_corners(words.place(), corners),
            });
        }
        self.appearance.face(self.polygons.face_count());
        self.polygons.end_face();
        Ok(())
    }

    /// Notes the texture coordinate of the corner that is about to be pushed.
    fn texture_corner(&mut self, vt: Option<i64>, before: &impl Fn() -> Counts) {
        let corner = self.polygons.corners.len();
        if let Some(vt) = vt {
            let index = resolve(vt, || before().uv_points + self.uv_points.len());
            self.uv_corners.resize(corner, TextureCoordinates::NONE);
            self.uv_corners.push(index.unwrap_or(TextureCoordinates::NONE - 1));
        }
    }

    fn finish(mut self) -> Result<Model, ModelError> {
        let corners = self.polygons.corners.len();
        let known = self.uv_points.len();
        let is_lost = |&&i: &&u32| i != TextureCoordinates::NONE && i as usize >= known;
        self.skipped.texture_references = self.uv_corners.iter().filter(is_lost).count();
        self.skipped.normal_references = self.appearance.missing_normals();
        let uv = (!self.uv_corners.is_empty()).then(|| {
            self.uv_corners.resize(corners, TextureCoordinates::NONE);
            TextureCoordinates::new(self.uv_points, self.uv_corners)
        });
        let attributes = self.appearance.attributes(self.points.len(), self.polygons.face_count(), corners);
        let model = Model::new(self.points, self.polygons)?;
        Ok(model.with_uv(uv).with_skipped(self.skipped).with_attributes(attributes))
    }
}

/// `vt u [v [w]]`; what is not finite is a point that no corner can use, and no reason to refuse the surface.
fn texture_point(words: &mut Words) -> Result<[f64; 2], Fault> {
    let word = words.expect("texture coordinate")?;
    let u = texture_number(words, word)?;
    let v = words.next().map_or(Ok(0.0), |word| texture_number(words, word))?;
    Ok([u, v])
}

fn texture_number(words: &Words, word: &[u8]) -> Result<f64, Fault> {
    number(word).ok_or_else(|| words.unexpected(word, "a number for a texture coordinate"))
}

/// The vertex, the texture index and the normal of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`.
fn split(word: &[u8]) -> Option<(i64, Option<i64>, Option<i64>)> {
    let mut parts = word.split(|&b| b == b'/');
    let v = integer(parts.next()?)?;
    let vt = match parts.next() {
        None | Some(b"") => None,
        Some(vt) => Some(integer(vt)?),
    };
    Some((v, vt, parts.next().and_then(integer)))
}

/// The index from 0 that an OBJ index means when `count` things have been listed so far; more may follow.
fn resolve(index: i64, count: impl FnOnce() -> usize) -> Option<u32> {
    let from_zero = if index < 0 { i64::try_from(count()).ok()? + index } else { index - 1 };
    u32::try_from(from_zero).ok()
}

/// Appends the next corners' or faces' indices where so many came before; those that none was noted for have none.
fn append_rows(indices: &mut Vec<u32>, before: usize, next: &[u32]) {
    if !next.is_empty() {
        indices.resize(before, u32::MAX);
        indices.extend_from_slice(next);
    }
}

fn legal_indices(count: usize) -> String {
    match count {
        0 => format!("a vertex index from 1 to {}, for no vertex comes before this line", u32::MAX),
        _ => format!("a vertex index from 1 to {}, or from -{count} to -1 counted back from this line", u32::MAX),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::sample::select;

    const LINES: [&str; 28] = [
        "v 0 1 2",
        "v 3 4.5 \\\n6e-1",
        "v 1 1 1 0.5 0 1",
        "v 1 1 1 0.5 0 255",
        "vt 0 1",
        "vt 0.5",
        "vn 0 0 1",
        "vn 0 x",
        "f 1 2 3",
        "f -1 -2 -3",
        "f 1/1 2 3/-1",
        "f -1//-1 -2/-1/-1 -3/2/1",
        "f 1 2 \\\r\n-1 \\\n-2",
        "f 1/-1/-2 2//3 3/9",
        "usemtl red",
        "usemtl blue  sky",
        "g part",
        "l 1 2",
        "p 1",
        "curv 0 1 1 2",
        "unknown",
        "# C:\\",
        "",
        " \\",
        "\u{feff}v 1 2 3",
        "f 1 2",
        "f 1 2 -9",
        "v 1 2",
    ];

    /// Those that can be wrong, the last ones, are rare.
    fn text() -> impl Strategy<Value = String> {
        let line = prop_oneof![300 => select(&LINES[..LINES.len() - 4]), 1 => select(&LINES[..])];
        let end = select(&["\n", "\n", "\n", "\r\n", "\r", "\n\n"]);
        let last = select(&["", "f 1 2 3", "f 1 2 3\n", "f 1 \\", "\r\n"]);
        let lines = proptest::collection::vec((line, end), 0..80);
        let head = select(&["", "\u{feff}", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"]);
        (head, lines, last).prop_map(|(head, lines, last)| {
            let lines: String = lines.into_iter().flat_map(|(line, end)| [line, end]).collect();
            [head, &lines, last].concat()
        })
    }

    fn read_as(text: &str, size: usize) -> String {
        format!("{:?}", read_in_blocks(text.into(), size))
    }

    proptest! {
        #[test]
        fn blocks_say_what_the_whole_says(text in text(), size in 1_usize..200) {
            prop_assert_eq!(read_as(&text, size), read_as(&text, text.len()));
        }
    }

    #[test]
    fn an_error_in_a_late_block_has_its_line_and_the_first_one_is_told() {
        let mut text = String::from("v 0 0 0\nv 1 0 \\\n0\n");
        for _ in 0..1000 {
            text.push_str("v 0 1 0 # one\nf -1 -2 -3\n");
        }
        let line = 1 + text.matches('\n').count() as u64;
        text.push_str("f 1 2 -9999999\nf 1 2\n");
        let fault = read_in_blocks(text.clone().into(), 4096).unwrap_err();
        let told = fault.in_file("a.obj".as_ref()).to_string();
        let points = text.matches('v').count();
        assert!(told.starts_with(&format!("a.obj, line {line}: found `-9999999`")), "{told}");
        assert!(told.contains(&format!("from -{points} to -1")), "{told}");
        text.truncate(text.find("f 1 2 -9").unwrap());
        assert!(read_as(&text, 4096) == read_as(&text, text.len()));
    }
}
