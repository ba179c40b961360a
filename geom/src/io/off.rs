//! Geomview's object file format, text.
//!
//! A keyword `[ST][C][N]OFF`, the numbers of vertices, faces and edges, then a line a vertex and a line a face. Normals,
//! colours and texture coordinates behind a vertex and colours behind a face are skipped, and said to be ([`Attributes::left`]); the number of edges is not used and
//! may be missing. The keyword may be missing too, and the counts may stand on its line.
//!
//! Source: The Geometry Center, *Geomview manual*, section *OFF: indexed face sets*. We read by lines where the manual
//! reads by words, because files disagree about how many numbers a colour has.

use super::error::{Fault, Place, Problem};
use super::text::{Line, Lines, Words};
use crate::surface::{Attributes, Model, Polygons, Skipped};

/// Whether the word is, or starts with, the keyword of this format.
pub(super) fn is_keyword(word: &[u8]) -> bool {
    after_keyword(word).is_some()
}

/// What follows the keyword in the same word: some writers forget the line end behind it.
fn after_keyword(word: &[u8]) -> Option<&[u8]> {
    let at = word.windows(3).position(|letters| letters == b"OFF")?;
    let (prefix, rest) = (&word[..at], &word[at + 3..]);
    let prefix = prefix.strip_prefix(b"ST").unwrap_or(prefix);
    (prefix.iter().all(|letter| b"CN4n".contains(letter)) && rest.iter().all(u8::is_ascii_digit)).then_some(rest)
}

pub(super) fn read(text: &[u8]) -> Result<Model, Fault> {
    let mut lines = Lines::new(text);
    let (vertices, faces) = read_counts(&mut lines)?;
    let (points, has_more_at_vertices) = read_points(&mut lines, vertices, text.len())?;
    let (polygons, has_more_at_faces) = read_faces(&mut lines, faces, points.len(), text.len())?;
    let surplus = lines.filter(|line| line.words().next().is_some()).count();
    let left = [(has_more_at_vertices, at_vertices(text)), (has_more_at_faces, "colours of faces")];
    let left = left.into_iter().filter(|(is_there, _)| *is_there).map(|(_, what)| what.to_owned()).collect();
    let attributes = Attributes { left, ..Attributes::default() };
    let skipped = Skipped { surplus, ..Skipped::default() };
    Ok(Model::new(points, polygons)?.with_skipped(skipped).with_attributes(attributes))
}

/// What the numbers behind a vertex are by the keyword.
fn at_vertices(text: &[u8]) -> &'static str {
    let first = Lines::new(text).next_filled().and_then(|line| line.words().next()).unwrap_or_default();
    let prefix = &first[..first.windows(3).position(|letters| letters == b"OFF").unwrap_or(0)];
    match [prefix.starts_with(b"ST"), prefix.contains(&b'C'), prefix.contains(&b'N')] {
        [false, false, true] => "normals",
        [true, false, false] => "texture coordinates",
        [false, true, false] | [false, false, false] => "colours",
        _ => "colours and other numbers of vertices",
    }
}

fn read_counts(lines: &mut Lines) -> Result<(u64, u64), Fault> {
    let missing = || Fault::unexpected(Place::File, "no header", "the numbers of vertices and faces");
    let line = lines.next_filled().ok_or_else(missing)?;
    let mut words = line.words();
    let first = words.clone().next().unwrap_or_default();
    let Some(rest) = after_keyword(first) else {
        return counts(words);
    };
    if first[..first.len() - rest.len()].iter().any(|letter| b"4n".contains(letter)) {
        return Err(words.unexpected(first, "a surface in three dimensions (OFF, COFF, NOFF, STOFF)"));
    }
    if !rest.is_empty() {
        let glued = Line { text: &line.text[words_start(&words, rest)..], ..line };
        return counts(glued.words());
    }
    words.next();
    match words.clone().next() {
        Some(b"BINARY") => Err(words.unexpected(b"BINARY", "OFF as text: save it as text, or as PLY")),
        Some(_) => counts(words),
        None => counts(lines.next_filled().ok_or_else(missing)?.words()),
    }
}

/// Where the rest of the first word starts in its line.
fn words_start(words: &Words, rest: &[u8]) -> usize {
    let mut words = words.clone();
    words.next();
    words.end() - rest.len()
}

fn counts(mut words: Words) -> Result<(u64, u64), Fault> {
    Ok((words.natural("number of vertices")?, words.natural("number of faces")?))
}

fn cut_short([one, many]: [&str; 2], claimed: u64, present: usize) -> Fault {
    let what = if claimed == 1 { one } else { many };
    Problem::CutShort { what: what.into(), claimed, present: present as u64 }.into()
}

/// The points, and whether there are numbers behind any.
fn read_points(lines: &mut Lines, claimed: u64, size: usize) -> Result<(Vec<[f64; 3]>, bool), Fault> {
    let (mut points, mut has_more) = (Vec::with_capacity(plausible(claimed, size)), false);
    while (points.len() as u64) < claimed {
        let line = lines.next_filled().ok_or_else(|| cut_short(["vertex", "vertices"], claimed, points.len()))?;
        let mut words = line.words();
        points.push(words.point()?);
        has_more |= words.next().is_some();
    }
    Ok((points, has_more))
}

/// The faces, and whether there are numbers behind any.
fn read_faces(lines: &mut Lines, claimed: u64, vertices: usize, size: usize) -> Result<(Polygons, bool), Fault> {
    let (mut polygons, mut has_more) = (Polygons::with_capacity(plausible(claimed, size)), false);
    while (polygons.face_count() as u64) < claimed {
        let line = lines.next_filled().ok_or_else(|| cut_short(["face", "faces"], claimed, polygons.face_count()))?;
        has_more |= read_face(line.words(), vertices, &mut polygons)?;
    }
    Ok((polygons, has_more))
}

/// A face, and whether there are numbers behind it.
fn read_face(mut words: Words, vertices: usize, polygons: &mut Polygons) -> Result<bool, Fault> {
    let corners = words.natural("number of corners of a face")?;
    if corners < 3 {
        return Err(Fault::few_corners(words.place(), corners as usize));
    }
    for _ in 0..corners {
        let vertex = words.natural("index of a vertex")?;
        if vertex >= vertices as u64 {
            let expected = format!("a vertex from 0 to {}", vertices.saturating_sub(1));
            return Err(Fault::unexpected(words.place(), format!("vertex {vertex}"), expected));
        }
        polygons.corners.push(vertex as u32);
    }
    polygons.end_face();
    Ok(words.next().is_some())
}

/// As many items as are claimed, but no more than lines of five numbers or words could be in the file.
fn plausible(claimed: u64, size: usize) -> usize {
    claimed.min(size as u64 / 6) as usize
}
