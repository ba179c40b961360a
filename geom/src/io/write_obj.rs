//! Wavefront OBJ out: the text as it came, with a map added.
//!
//! A model that came from an OBJ goes back as its own text: every line in its place with its own digits, line ends and
//! comments. Faces change in one respect, the texture index of each corner. The new `vt` lines stand before the first face,
//! so that readers in one pass know them, and old `vt` lines, which nothing uses any more, are left out. If polylines or
//! surfaces refer to the old ones too, they stay and their numbers must stay true: then the new lines come after the last old
//! one and after the last reference counted backwards. Where a material is asked for, it stands before the first face, and the
//! text's own ones are left out.
//!
//! Other models are written with the shortest digits that read back as the same f64, with their normals, their colours behind the
//! vertices, and the names of their materials. A map that nobody gives is the model's own: the text's, or what was put in its place.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::ops::Range;

use super::cells::Cells;
use super::error::WriteError;
use super::lines::write_lines;
use super::look::{Look, one_word};
use super::obj::is_face;
use super::text::{Line, Lines, block_size, joined_blocks};
use super::wedge::Wedges;
use crate::parallel::{join, of_runs};
use crate::surface::{Model, Triangles};

/// What an OBJ is to hold besides the model.
#[derive(Debug, Clone, Copy, Default)]
pub struct ObjContent<'a> {
    /// A texture coordinate for each corner of the model; none leaves the model's own, whether all corners have one or some. Corners of a vertex that
    /// have the same share a `vt` line.
    pub uv: Option<&'a [[f64; 2]]>,
    /// Triangles to write in the place of polygons.
    pub triangles: Option<&'a Triangles>,
    /// A material for all faces: what the text already has of materials is left out.
    pub material: Option<Material<'a>>,
    /// The way from the new file's folder to that of the old one, with `/` at its end, for the names of the material libraries that the text names.
    pub libraries: Option<&'a str>,
}

/// A material of a `.mtl` file.
#[derive(Debug, Clone, Copy)]
pub struct Material<'a> {
    /// The file's name.
    pub library: &'a str,
    /// The material's name in it.
    pub name: &'a str,
}

/// Writes a model as OBJ; see [`ObjContent`].
///
/// ```
/// use geom::io::{ObjContent, read_bytes, write_obj};
///
/// let text = "v 0 0 0.50\nv 1 0 0\nv 0 1 0\n\nf 1 2 3 # the only one\n";
/// let model = read_bytes(text.into(), "triangle.obj")?;
/// let uv = [[0.0, 0.0], [1.0, 0.0], [0.0, 0.1]];
/// let mut out = Vec::new();
/// write_obj(&model, &ObjContent { uv: Some(&uv), ..ObjContent::default() }, &mut out)?;
/// assert_eq!(String::from_utf8(out)?, "\
/// v 0 0 0.50\nv 1 0 0\nv 0 1 0\n
/// vt 0.0 0.0\nvt 1.0 0.0\nvt 0.0 0.1
/// f 1/1 2/2 3/3 # the only one\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When texture coordinates or triangles do not fit the model, or when writing fails.
pub fn write_obj(model: &Model, content: &ObjContent, out: impl Write) -> Result<(), WriteError> {
    let text = model.obj_text();
    let (texture, addition) = join(
        || content.uv.map_or_else(|| Ok(Texture::own(model)), |uv| Texture::given(model, uv).map(Some)),
        || text.map(|text| Addition::place(text, block_size(text))),
    );
    let job = Job { model, content, texture: texture? };
    let cells = Cells::new(model, content.triangles)?;
    match text.zip(addition) {
        Some((text, addition)) => job.rewrite((text, &addition), cells, out)?,
        None => job.write(cells, out)?,
    }
    Ok(())
}

/// So many faces are gathered, to be written on all threads.
const AT_ONCE: usize = 1 << 16;

/// The `vt` lines that are written.
struct Texture<'a> {
    /// What each corner has.
    uv: Cow<'a, [[f64; 2]]>,
    /// A corner for each line.
    first: Vec<u32>,
    /// The line of each corner; [`NO_LINE`] where it has none.
    of_corner: Vec<u32>,
}

/// Stands for a corner without a line.
const NO_LINE: u32 = u32::MAX;

impl<'a> Texture<'a> {
    /// Those of a map that has a finite texture coordinate for each corner.
    fn given(model: &Model, uv: &'a [[f64; 2]]) -> Result<Self, WriteError> {
        let Wedges { of_corner, first } = Wedges::new(model, uv)?;
        Ok(Self { uv: uv.into(), first, of_corner })
    }

    /// Those of the model's own map, of which corners may have nothing; none where there is no map, or the model's text has it.
    fn own(model: &Model) -> Option<Self> {
        let own = model.uv_beside_text()?;
        let uv: Vec<_> = (0..model.corner_count()).map(|corner| own.corner(corner).unwrap_or([f64::NAN; 2])).collect();
        let Wedges { mut of_corner, mut first } = Wedges::unchecked(model, Some(&uv), &[]);
        let is_there = |&corner: &u32| !uv[corner as usize][0].is_nan();
        let mut lines = 0..;
        let line: Vec<u32> =
            first.iter().map(|c| if is_there(c) { lines.next().unwrap_or(NO_LINE) } else { NO_LINE }).collect();
        of_corner.iter_mut().for_each(|wedge| *wedge = line[*wedge as usize]);
        first.retain(is_there);
        Some(Self { uv: uv.into(), first, of_corner })
    }

    fn line(&self, corner: usize) -> Option<u32> {
        Some(self.of_corner[corner]).filter(|&line| line != NO_LINE)
    }
}

struct Job<'a> {
    model: &'a Model,
    content: &'a ObjContent<'a>,
    texture: Option<Texture<'a>>,
}

impl Job<'_> {
    /// Writes a model that has no text of its own.
    fn write(&self, cells: Cells, mut out: impl Write) -> io::Result<()> {
        let look = Look::of(self.model);
        write_lines(self.model.vertex_count(), &mut out, |v, text| {
            let [x, y, z] = self.model.points()[v];
            write!(text, "v {x:?} {y:?} {z:?}")?;
            look.colour(v, text)?;
            text.write_all(b"\n")
        })?;
        look.normals(&mut out)?;
        self.material("\n", &mut out)?;
        self.texture("\n", &mut out)?;
        // The corners of each line, and where it begins with another material.
        let (mut corner, mut start) = (Vec::new(), vec![0]);
        let mut materials = BTreeMap::new();
        let mut material = None;
        cells.for_each(|face, corners| {
            let next = self.model.attributes().material(face).filter(|_| self.content.material.is_none());
            if next != material {
                materials.insert(start.len() - 1, next);
                material = next;
            }
            corner.extend_from_slice(corners);
            start.push(corner.len());
            Ok(())
        })?;
        write_lines(start.len() - 1, &mut out, |number, text| {
            if let Some(material) = materials.get(&number) {
                writeln!(text, "usemtl {}", material.map_or_else(|| "none".into(), one_word))?;
            }
            self.cell(&corner[start[number]..start[number + 1]], &look, text)
        })
    }

    /// Writes the line of a polygon.
    fn cell(&self, corners: &[u32], look: &Look, text: &mut Vec<u8>) -> io::Result<()> {
        text.write_all(b"f")?;
        for &corner in corners {
            write!(text, " {}", self.model.corners()[corner as usize] + 1)?;
            let line = self.texture.as_ref().and_then(|texture| texture.line(corner as usize)).map(|line| line + 1);
            match (line, look.normal(corner as usize)) {
                (Some(line), Some(normal)) => write!(text, "/{line}/{}", normal + 1)?,
                (Some(line), None) => write!(text, "/{line}")?,
                (None, Some(normal)) => write!(text, "//{}", normal + 1)?,
                (None, None) => {}
            }
        }
        text.write_all(b"\n")
    }

    /// The lines of the material that is added.
    fn material(&self, line_end: &str, mut out: impl Write) -> io::Result<()> {
        let Some(Material { library, name }) = self.content.material else { return Ok(()) };
        write!(out, "mtllib {library}{line_end}usemtl {name}{line_end}")
    }

    /// The lines of the texture coordinates.
    fn texture(&self, line_end: &str, mut out: impl Write) -> io::Result<()> {
        let Some(Texture { uv, first, .. }) = &self.texture else { return Ok(()) };
        write_lines(first.len(), &mut out, |number, text| {
            let [u, v] = uv[first[number] as usize];
            write!(text, "vt {u:?} {v:?}{line_end}")
        })
    }

    /// Writes the text of the model with the addition in it.
    fn rewrite(&self, (text, addition): (&[u8], &Addition), mut cells: Cells, out: impl Write) -> io::Result<()> {
        let line_end = line_end_of(text);
        let mut copy = Copy { text, at: 0, out };
        let mut faces = Vec::new();
        let (mut face, mut added, mut is_dropped) = (0, false, false);
        let is_old = |word: &[u8]| match word {
            b"vt" => addition.drops_old && self.texture.is_some(),
            b"mtllib" | b"usemtl" => self.content.material.is_some(),
            _ => false,
        };
        for line in Lines::joined(text) {
            if std::mem::take(&mut is_dropped) {
                copy.at = line.start;
            }
            if !added && line.start >= addition.at {
                self.faces(&mut faces, addition, &mut copy)?;
                copy.until(addition.at)?;
                self.texture(line_end, &mut copy.out)?;
                added = true;
            }
            if line.words().next().is_some_and(is_old) {
                self.faces(&mut faces, addition, &mut copy)?;
                copy.until(line.start)?;
                copy.at = text.len();
                is_dropped = true;
            }
            if let Some(way) = self.content.libraries.filter(|_| !is_dropped)
                && line.words().next() == Some(b"mtllib")
            {
                self.faces(&mut faces, addition, &mut copy)?;
                copy.libraries(&line, way)?;
            }
            if line.words().next().is_some_and(is_face) {
                if face == 0 {
                    copy.until(line.start)?;
                    self.material(line_end, &mut copy.out)?;
                }
                faces.push(Face { line, face, triangles: cells.triangles_of(face) });
                face += 1;
                if faces.len() == AT_ONCE {
                    self.faces(&mut faces, addition, &mut copy)?;
                }
            }
        }
        self.faces(&mut faces, addition, &mut copy)?;
        copy.until(text.len())?;
        if !added {
            let is_end = |&byte: &u8| byte == b'\n' || byte == b'\r';
            let last = &text[..text.len() - usize::from(text.last().is_some_and(is_end))];
            let last = last.strip_suffix(b"\r").unwrap_or(last);
            // A backslash at the very end would continue that line with what is added.
            let missing = usize::from(last.len() == text.len()) + usize::from(last.ends_with(b"\\"));
            (0..missing).try_for_each(|_| copy.out.write_all(line_end.as_bytes()))?;
            self.texture(line_end, &mut copy.out)?;
        }
        Ok(())
    }

    /// Writes the text to the end of the last of some faces, and forgets them.
    fn faces(&self, faces: &mut Vec<Face>, addition: &Addition, copy: &mut Copy<impl Write>) -> io::Result<()> {
        let Copy { text, at, out } = copy;
        let (text, first) = (*text, *at);
        write_lines(faces.len(), out, |k, out| {
            // Each with what is between the one before and itself.
            let at = if k == 0 { first } else { faces[k - 1].line.end() };
            let mut copy = Copy { text, at, out };
            self.face(&faces[k], addition, &mut copy)?;
            copy.until(faces[k].line.end())
        })?;
        *at = faces.last().map_or(first, |face| face.line.end());
        faces.clear();
        Ok(())
    }

    /// Writes the line of a face, or in its place the lines of its triangles.
    fn face(&self, face: &Face, addition: &Addition, copy: &mut Copy<impl Write>) -> io::Result<()> {
        let corners = self.model.face_corners(face.face);
        let words = corner_words(&face.line);
        match face.triangles {
            Some(triangles) if corners.len() > 3 && !triangles.is_empty() => {
                copy.until(words[0].start)?;
                for (i, triangle) in triangles.iter().enumerate() {
                    if i > 0 {
                        write!(copy.out, "{}f ", line_end_of(copy.text))?;
                    }
                    for (j, &corner) in triangle.iter().enumerate() {
                        copy.out.write_all(if j > 0 { b" " } else { b"" })?;
                        let word = &copy.text[words[corner as usize - corners.start].clone()];
                        self.corner(word, corner as usize, addition, &mut copy.out)?;
                    }
                }
                copy.at = words[words.len() - 1].end;
            }
            _ => {
                for (word, corner) in words.into_iter().zip(corners) {
                    copy.until(word.start)?;
                    copy.at = word.end;
                    self.corner(&copy.text[word], corner, addition, &mut copy.out)?;
                }
            }
        }
        Ok(())
    }

    /// Writes a corner: vertex and normal as they stand, the texture index new.
    fn corner(&self, word: &[u8], corner: usize, addition: &Addition, out: &mut impl Write) -> io::Result<()> {
        let Some(texture) = &self.texture else { return out.write_all(word) };
        let mut parts = word.split(|&b| b == b'/');
        out.write_all(parts.next().unwrap_or_default())?;
        let normal = parts.nth(1).filter(|normal| !normal.is_empty());
        match texture.line(corner) {
            Some(line) => write!(out, "/{}", addition.known + u64::from(line) + 1)?,
            None if normal.is_some() => out.write_all(b"/")?,
            None => {}
        }
        normal.map_or(Ok(()), |normal| out.write_all(b"/").and_then(|()| out.write_all(normal)))
    }
}

/// A face of the text.
struct Face<'a> {
    line: Line<'a>,
    face: usize,
    /// What stands in its place, if that is asked for.
    triangles: Option<&'a [[u32; 3]]>,
}

/// Where the words behind the keyword stand in the text.
fn corner_words(line: &Line) -> Vec<Range<usize>> {
    let mut words = line.words();
    words.next();
    let mut ranges = Vec::with_capacity(4);
    while let Some(word) = words.next() {
        let end = line.start + words.end();
        ranges.push(end - word.len()..end);
    }
    ranges
}

/// A text of which parts are copied and others replaced.
struct Copy<'a, W> {
    text: &'a [u8],
    at: usize,
    out: W,
}

impl<W: Write> Copy<'_, W> {
    fn until(&mut self, end: usize) -> io::Result<()> {
        self.out.write_all(&self.text[self.at..end])?;
        self.at = end;
        Ok(())
    }

    /// Copies up to the last name of material libraries on a line, with the way to them. Names may have spaces: one ends with its ending.
    fn libraries(&mut self, line: &Line, way: &str) -> io::Result<()> {
        let mut is_first = true;
        for word in corner_words(line) {
            let name = &self.text[word.clone()];
            let is_absolute = name.starts_with(b"/") || name.starts_with(b"\\") || name.get(1) == Some(&b':');
            let ends = name.to_ascii_lowercase().ends_with(b".mtl");
            if std::mem::replace(&mut is_first, ends) && !is_absolute {
                self.until(word.start)?;
                self.out.write_all(way.as_bytes())?;
            }
        }
        Ok(())
    }
}

/// What a text, or a block of it, says of texture coordinates.
#[derive(Clone, Default)]
struct Mentions {
    /// Where the first face is, and how many `vt` lines come before it.
    first_face: Option<(usize, u64)>,
    /// How many `vt` lines there are.
    known: u64,
    /// Whether polylines or surfaces refer to them.
    is_used_elsewhere: bool,
    /// Where the last line ends that is one of them, or refers to one counted backwards.
    last_use: usize,
}

impl Mentions {
    fn take(&mut self, mut lines: Lines) {
        while let Some(line) = lines.next() {
            let mut words = line.words();
            match words.next() {
                Some(b"vt") => {
                    self.known += 1;
                    self.last_use = lines.position();
                }
                Some(b"l" | b"surf") => {
                    let textured = words.clone().any(|word| word.contains(&b'/'));
                    self.is_used_elsewhere |= textured;
                    if textured && words.any(|word| word.contains(&b'-')) {
                        self.last_use = lines.position();
                    }
                }
                Some(word) if self.first_face.is_none() && is_face(word) => {
                    self.first_face = Some((line.start, self.known));
                }
                _ => {}
            }
        }
    }

    /// The same with those of the next block.
    fn joined(self, next: &Self) -> Self {
        Self {
            first_face: self.first_face.or(next.first_face.map(|(at, known)| (at, self.known + known))),
            known: self.known + next.known,
            is_used_elsewhere: self.is_used_elsewhere || next.is_used_elsewhere,
            last_use: self.last_use.max(next.last_use),
        }
    }
}

/// Where new texture coordinates go.
#[derive(Debug, PartialEq)]
struct Addition {
    /// The byte before which they are put.
    at: usize,
    /// How many `vt` lines come before.
    known: u64,
    /// Whether old `vt` lines are left out.
    drops_old: bool,
}

impl Addition {
    fn place(text: &[u8], block: usize) -> Self {
        let blocks = joined_blocks(text, block);
        let mentions = of_runs(blocks.len(), 1, |run| {
            let mut mentions = Mentions::default();
            run.for_each(|k| mentions.take(Lines::of_block(text, &blocks[k])));
            mentions
        });
        let mentions = mentions.iter().fold(Mentions::default(), Mentions::joined);
        let Mentions { first_face, known, is_used_elsewhere, last_use } = mentions;
        match first_face {
            Some((at, _)) if !is_used_elsewhere => Self { at, known: 0, drops_old: true },
            Some((at, known)) if at >= last_use => Self { at, known, drops_old: false },
            _ => Self { at: last_use, known, drops_old: false },
        }
    }
}

fn line_end_of(text: &[u8]) -> &'static str {
    match text.iter().position(|&b| b == b'\n' || b == b'\r') {
        Some(at) if text[at..].starts_with(b"\r\n") => "\r\n",
        Some(at) if text[at] == b'\r' => "\r",
        _ => "\n",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn material_libraries_are_named_from_the_new_folder_on() {
        let text = "mtllib a.mtl my b.MTL\nv 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib /c.mtl # d.mtl\nf 1 2 3\nmtllib\te.mtl\nf 3 2 1\n";
        let model = crate::io::read_bytes(text.into(), "a.obj").unwrap();
        let written = |content: &ObjContent| {
            let mut out = Vec::new();
            write_obj(&model, content, &mut out).unwrap();
            String::from_utf8(out).unwrap()
        };
        let content = ObjContent { libraries: Some("../in/"), ..ObjContent::default() };
        let named = text.replace("a.mtl my b", "../in/a.mtl ../in/my b").replace("\te.mtl", "\t../in/e.mtl");
        assert_eq!(written(&content), named);
        assert_eq!(written(&ObjContent::default()), text);
        let material = Some(Material { library: "own.mtl", name: "own" });
        assert!(!written(&ObjContent { material, ..content }).contains("../in/"));
    }

    #[test]
    fn of_two_errors_that_of_the_texture_coordinates_is_told() {
        let model = crate::io::read_bytes("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".into(), "a.obj").unwrap();
        let foreign = Triangles { corners: vec![[0, 1, 9]], face_of: vec![0] };
        let content = ObjContent { uv: Some(&[]), triangles: Some(&foreign), ..ObjContent::default() };
        let told = write_obj(&model, &content, Vec::new());
        assert!(matches!(told, Err(WriteError::TextureCount { found: 0, corners: 3 })), "{told:?}");
        let content = ObjContent { uv: None, ..content };
        assert!(matches!(write_obj(&model, &content, Vec::new()), Err(WriteError::ForeignTriangle { .. })));
    }

    #[test]
    fn blocks_have_the_place_of_the_whole() {
        let texts = [
            "v 0 0 0\nvt 0 0\nvt 1 0\nf 1/1 1/2 1/1\nvt 2 2\nf 1 1 1\n",
            "v 0 0 0\nvt 0 0\nvt 1 0\nf 1/1 1/2 1/1\nvt 2 2\nl 1/1 1/2\nf 1 1 1\n",
            "vt 0 0\nvt 1 0\nl 1/-1 \\\n 1/1\nv 0 0 0\nf 1 1 1\nf 1 1 1\n",
            "vt 0 0\nl 1/1 1/1\nf 1 1 1\nsurf 1/-1\n\n",
            "v 0 0 0\nvt 0 0\n",
            "",
        ];
        for text in texts {
            for size in 0..=text.len() {
                let [found, whole] = [size, text.len()].map(|size| Addition::place(text.as_bytes(), size));
                assert_eq!(found, whole, "blocks of {size} of {text}");
            }
        }
    }
}
