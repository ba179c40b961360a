//! `cones bake`: the textures of a model, transferred to another map of it.

mod faces;
mod lying;
mod margins;
mod raster;
mod tree;

use crate::commands::shared::{MaterialFiles, listed, material_text, non_negative, overlap, texture, whole};
use crate::error::CommandError;
use crate::input::{self, Texels};
use crate::output::{self, Files};
use crate::report::table::{counted, labelled};
use crate::report::{SCHEMA, overlap_text};
use clap::Args;
use cones::report::OverlapReport;
use cones::uv::Triangle;
use faces::Image;
use geom::io::{GlbTexture, ObjContent, Picture, Textures, read_picture, write_glb, write_obj};
use geom::{Attribute, Meaning, Model, Weld};
use margins::filled;
use raster::{Piece, rasterized};
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The new map is of the same surface, whatever its triangles: the same faces, as `cones unwrap`, `pack` and `islands` write them, or others on it, as of `--refine` or a coarser
/// one. Texels are means of what the old textures show on them, in linear light; what is between islands has the colour of the nearest texel.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BakeArgs {
    /// The model with its textures and the map that they are for: OBJ, PLY or glTF, the pictures PNG or JPEG
    #[arg(value_name = "OLD")]
    old: PathBuf,
    /// The same surface with another map, in the unit square: OBJ, PLY or glTF
    #[arg(value_name = "NEW")]
    new: PathBuf,
    /// Where to write the texture: .png; .glb, which is NEW with the texture in it; or .obj, which is NEW with one material (.mtl) and the texture (.png) beside it
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// The side of the texture in texels [default: a power of two, as fine as the old textures are]
    #[arg(long, value_name = "TEXELS", value_parser = whole::<usize>("number of texels", 1..=LARGEST), allow_negative_numbers = true)]
    texture_size: Option<usize>,
    /// How many texels around islands have the colour of the nearest one; what is farther away has the mean of all
    #[arg(long, value_name = "TEXELS", value_parser = whole::<usize>("number of texels", 0..=WIDEST), allow_negative_numbers = true, default_value_t = 16)]
    padding: usize,
    /// How far NEW may be from OLD where its faces are others, as a share of OLD's size
    #[arg(long, value_name = "SHARE", value_parser = non_negative, allow_negative_numbers = true, default_value_t = 1e-3)]
    max_distance: f64,
    /// Print JSON in place of the text
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  cones unwrap scan.obj -o new.obj
  cones bake scan.obj new.obj -o textured.obj
  cones bake scan.glb new.glb -o textured.glb --texture-size 4096 --padding 32
  cones bake scan.obj coarse.glb -o textured.glb --max-distance 0.01";

/// The largest texture: what graphics cards take.
const LARGEST: usize = 1 << 14;
/// The widest padding.
const WIDEST: usize = 512;
/// Texture sizes that are chosen: no one asked for more than 8192, and less than 64 is of no use.
const CHOSEN: std::ops::RangeInclusive<usize> = 1 << 6..=1 << 13;
/// A power of two that is smaller than as fine as the old textures by so little is fine enough.
const FINE_ENOUGH: f64 = 0.9;
/// What a texel takes while all of them are computed, in bytes.
const TEXEL: usize = 16;
/// Coordinates may be beyond the unit square by so much: files round.
const ROUNDING: f64 = 1e-6;
#[derive(Debug, Serialize)]
struct BakeReport {
    schema: u32,
    old: String,
    new: String,
    /// Faces of the old model.
    faces: usize,
    /// Its textures.
    textures: Vec<String>,
    /// How many of its faces that the new map has show nothing.
    bare_faces: usize,
    /// Whether the new model has the same faces.
    same_faces: bool,
    /// Along the texture's side.
    texels: usize,
    /// The share of them on islands.
    fill: f64,
    /// The pairs of triangles of the new map that lie over each other.
    overlap_pairs: usize,
    written: Vec<String>,
}

/// The material's name.
const NAME: &str = "baked";

pub(crate) fn run(args: &BakeArgs) -> Result<(), CommandError> {
    let output = Output::of(&args.output)?;
    output::check_json(args.json, &[&args.output])?;
    output.check(args, &[])?;
    let [old, new] = [input::read_model(&args.old)?.0, input::read_model(&args.new)?.0];
    let textures = Textures::of(&old, &args.old);
    output.check(args, &[textures.files(), Textures::of(&new, &args.new).files()].concat())?;
    if old.uv().is_none() {
        return Err(CommandError::NoTexture(args.old.clone()));
    }
    let uv = texture(&args.new, &new)?;
    check_square(&args.new, &new, &uv)?;
    let show = Show::new(&args.old, &textures)?;
    let same = faces::images(&old, &new, &uv);
    let same_faces = same.is_some();
    let side = args.texture_size.unwrap_or_else(|| match &same {
        Some(images) => fine_side(show.pixels(images), show.squares(images)),
        None => fine_side(show.pixels(&of_old(&old)), squares(&new, &uv)),
    });
    input::check_memory(side, TEXEL, &args.output)?;
    let images = match same {
        Some(images) => images,
        None => lying::images(&old, (&new, &uv), side, args.max_distance).map_err(|(face, share)| {
            let (old, new) = (args.old.clone(), args.new.clone());
            if share.is_finite() {
                CommandError::BakePlaces { old, new, face, share }
            } else {
                CommandError::BakeNoArea(old)
            }
        })?,
    };
    let texels = rasterized(&show.pieces(&images, side), &show.pictures, side);
    let fill = texels.iter().flatten().count() as f64 / texels.len() as f64;
    let pixels = filled(&texels, side, args.padding);
    output.write(args, (&old, &new), (&pixels, side))?;
    let bare_faces = show.bare_faces(&images);
    let overlap = overlap(&new, &uv, Weld::Auto);
    warn(args, bare_faces, overlap);
    warn_of_other_maps(args, textures.other_maps());
    let report = BakeReport {
        schema: SCHEMA,
        old: args.old.display().to_string(),
        new: args.new.display().to_string(),
        faces: old.face_count(),
        textures: textures.list().iter().map(|texture| texture.name.clone()).collect(),
        bare_faces,
        same_faces,
        texels: side,
        fill,
        overlap_pairs: overlap.pairs,
        written: output.files(args).map(|path| path.display().to_string()).collect(),
    };
    if args.json { output::print_json(&report) } else { output::summary(&text(&report, args, &output)) }
}

/// What is written.
enum Output {
    Picture,
    Glb,
    Obj(MaterialFiles),
}

impl Output {
    fn of(path: &Path) -> Result<Self, CommandError> {
        Ok(match output::extension(path, &["png", "glb", "obj"])? {
            "obj" => Self::Obj(MaterialFiles::beside(path, NAME)),
            "glb" => Self::Glb,
            _ => Self::Picture,
        })
    }

    /// All files, the one that is named at first.
    fn files<'a>(&'a self, args: &'a BakeArgs) -> impl Iterator<Item = &'a Path> {
        let beside = if let Self::Obj(files) = self { Some(files.paths()) } else { None };
        std::iter::once(&*args.output).chain(beside.into_iter().flatten())
    }

    /// Refuses what cannot be written, and what is an input or one of `others`.
    fn check(&self, args: &BakeArgs, others: &[PathBuf]) -> Result<(), CommandError> {
        let inputs: Vec<&Path> = [&args.old, &args.new].into_iter().chain(others).map(|path| &**path).collect();
        output::check(&inputs, &self.files(args).collect::<Vec<_>>())
    }

    /// Writes the texture, and what belongs to it.
    fn write(
        &self,
        args: &BakeArgs,
        (old, new): (&Model, &Model),
        (pixels, side): (&[[u8; 4]], usize),
    ) -> Result<(), CommandError> {
        let mut files = Files::new();
        let path = &*args.output;
        match self {
            Self::Picture => files.write(path, |out| Ok(write_png(pixels, side, out)?))?,
            Self::Glb => files.write(path, |out| {
                let mut png = Vec::new();
                write_png(pixels, side, &mut png)?;
                let alpha_mode = if is_opaque(pixels) { "OPAQUE" } else { alpha_mode(old) };
                let texture = GlbTexture::Baked { png: &png, name: NAME, alpha_mode };
                write_glb(&uncoloured(old, new), None, &new.triangles(), Some(texture), out)
            })?,
            Self::Obj(beside) => {
                files.write(beside.picture(), |out| Ok(write_png(pixels, side, out)?))?;
                beside.write_material(&mut files)?;
                let content = ObjContent { material: Some(beside.material()), ..ObjContent::default() };
                files.write(path, |out| write_obj(new, &content, out))?;
            }
        }
        files.finish()
    }
}

/// Refuses a map that one picture is not enough for.
fn check_square(path: &Path, model: &Model, uv: &[[f64; 2]]) -> Result<(), CommandError> {
    let is_outside = |&p: &[f64; 2]| p.iter().any(|x| !(-ROUNDING..=1.0 + ROUNDING).contains(x));
    let Some(corner) = uv.iter().position(is_outside) else { return Ok(()) };
    let face = model.face_start().partition_point(|&start| start as usize <= corner) - 1;
    let [u, v] = uv[corner];
    Err(CommandError::OutsideSquare { path: path.to_owned(), face, u, v })
}

/// The pictures of textures.
fn pictures(path: &Path, textures: &Textures) -> Result<Vec<Texels>, CommandError> {
    if textures.list().is_empty() {
        return Err(CommandError::NoTextures(path.to_owned()));
    }
    let picture = |texture: &geom::io::Texture| -> Result<Texels, CommandError> {
        let (path, name) = (path.to_owned(), texture.name.clone());
        let called = match &texture.picture {
            _ if texture.is_moved => return Err(CommandError::MovedTexture { path, name }),
            Picture::Unknown(_) => return Err(CommandError::UnknownPicture { path, name }),
            Picture::Image(_) if input::is_standard(&path) => return Err(CommandError::PictureInPipe { name }),
            Picture::Image(_) => path.join(name),
            Picture::File(file) => file.clone(),
        };
        Ok(Texels::decode(&read_picture(path, &texture.picture)?, &called)?)
    };
    textures.list().iter().map(picture).collect()
}

/// What the old textures show.
struct Show<'a> {
    textures: &'a Textures,
    /// Those of the textures, and at last a white one for what has a colour alone.
    pictures: Vec<Texels>,
}

impl<'a> Show<'a> {
    fn new(path: &Path, textures: &'a Textures) -> Result<Self, CommandError> {
        let mut pictures = pictures(path, textures)?;
        pictures.push(Texels { width: 1, height: 1, pixels: vec![[u8::MAX; 4]], has_alpha: false });
        Ok(Self { textures, pictures })
    }

    /// What an image shows: where, of which picture, and by what that is multiplied. None if nothing says.
    fn shown(&self, image: &Image) -> Option<(Triangle, usize, [f64; 4])> {
        let face = image.face as usize;
        let colour = self.textures.colour(face);
        match self.textures.of_face(face) {
            Some(texture) => Some((image.old?, texture, colour.unwrap_or([1.0; 4]))),
            None => Some(([[0.5; 2]; 3], self.pictures.len() - 1, colour?)),
        }
    }

    fn pieces(&self, images: &[Image], side: usize) -> Vec<Piece> {
        let piece = |image: &Image| {
            let (old, picture, factor) = self.shown(image)?;
            Piece::new(old, image.new, (picture as u32, &self.pictures[picture], factor), side)
        };
        images.iter().filter_map(piece).collect()
    }

    /// How many pixels of pictures there are on images.
    fn pixels(&self, images: &[Image]) -> f64 {
        let pixels = images.iter().filter_map(|image| {
            let texture = self.textures.of_face(image.face as usize)?;
            let Texels { width, height, .. } = self.pictures[texture];
            Some(area(image.old?) * width as f64 * height as f64)
        });
        pixels.filter(|pixels| pixels.is_finite()).sum()
    }

    /// How many faces show nothing.
    fn bare_faces(&self, images: &[Image]) -> usize {
        let bare = images.iter().filter(|image| self.shown(image).is_none());
        bare.map(|image| image.face).collect::<BTreeSet<u32>>().len()
    }

    /// How large the new images are of what shows pictures.
    fn squares(&self, images: &[Image]) -> f64 {
        let has_picture = |image: &&Image| self.textures.of_face(image.face as usize).is_some() && image.old.is_some();
        images.iter().filter(has_picture).map(|image| area(image.new)).sum()
    }
}

/// The triangles of a model on themselves.
fn of_old(old: &Model) -> Vec<Image> {
    let uv: Vec<[f64; 2]> = (0..old.corner_count())
        .map(|corner| old.uv().and_then(|uv| uv.corner(corner)).unwrap_or([f64::NAN; 2]))
        .collect();
    faces::images(old, old, &uv).unwrap_or_default()
}

/// How large a map is.
fn squares(model: &Model, uv: &[[f64; 2]]) -> f64 {
    model.triangles().corners.iter().map(|corners| area(corners.map(|corner| uv[corner as usize]))).sum()
}

fn area([a, b, c]: Triangle) -> f64 {
    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
}

/// The side of a texture on which so large a part of the square has as many texels as there are pixels.
fn fine_side(pixels: f64, squares: f64) -> usize {
    let side = if squares > 0.0 { FINE_ENOUGH * (pixels / squares).sqrt() } else { 0.0 };
    (side.min(*CHOSEN.end() as f64) as usize).next_power_of_two().clamp(*CHOSEN.start(), *CHOSEN.end())
}

/// Says what is not as it should be.
fn warn(args: &BakeArgs, bare_faces: usize, overlap: OverlapReport) {
    if bare_faces > 0 {
        let faces = counted(bare_faces, "face has", "faces have");
        output::warn(&format!("{faces} no texture in {}: what is near fills them", args.old.display()));
    }
    if overlap.pairs > 0 {
        let share = overlap_text(overlap);
        let new = args.new.display();
        output::warn(&format!(
            "{new} lies over itself, {share}: there the texture is the mean of what should be apart, as cones islands puts it"
        ));
    }
}

/// Says what else materials show, which is left.
fn warn_of_other_maps(args: &BakeArgs, maps: &[String]) {
    if !maps.is_empty() {
        let (maps, old) = (listed(maps.iter().map(String::as_str)), args.old.display());
        output::warn(&format!(
            "of the materials of {old} the colours are transferred, and not {maps}: directions as of normals would have to be turned"
        ));
    }
}

/// The new model without colours, by which glTF multiplies the texture; that belongs to what is seen only where the old model is one.
fn uncoloured<'a>(old: &Model, new: &'a Model) -> Cow<'a, Model> {
    let is_colour = |table: &Attribute| *table.meaning() == Meaning::Colour;
    if !old.attributes().looks.is_empty() || !new.attributes().tables.iter().any(is_colour) {
        return Cow::Borrowed(new);
    }
    let mut attributes = new.attributes().clone();
    attributes.tables.retain(|table| !is_colour(table));
    Cow::Owned(new.clone().with_attributes(attributes))
}

/// What becomes of alpha: as the old materials of a glTF say, if they do.
fn alpha_mode(old: &Model) -> &'static str {
    let looks = &old.attributes().looks;
    let says = |mode: &str| looks.iter().any(|look| look.contains(mode));
    match () {
        () if says("\"MASK\"") && !says("\"BLEND\"") => "MASK",
        () if looks.is_empty() || says("\"BLEND\"") => "BLEND",
        () => "OPAQUE",
    }
}

fn is_opaque(pixels: &[[u8; 4]]) -> bool {
    pixels.iter().all(|pixel| pixel[3] == u8::MAX)
}

/// Writes a square picture as PNG, without alpha where all of it is opaque.
fn write_png(pixels: &[[u8; 4]], side: usize, out: &mut dyn Write) -> std::io::Result<()> {
    let is_opaque = is_opaque(pixels);
    let mut encoder = png::Encoder::new(out, side as u32, side as u32);
    encoder.set_color(if is_opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    if is_opaque {
        let colours: Vec<[u8; 3]> = pixels.iter().map(|&[red, green, blue, _]| [red, green, blue]).collect();
        writer.write_image_data(colours.as_flattened())?;
    } else {
        writer.write_image_data(pixels.as_flattened())?;
    }
    writer.finish()?;
    Ok(())
}

fn text(report: &BakeReport, args: &BakeArgs, output: &Output) -> String {
    let faces = counted(report.faces, "face", "faces");
    let textures = counted(report.textures.len(), "texture", "textures");
    let (side, fill) = (report.texels, 100.0 * report.fill);
    let shown = material_text(NAME, &args.output);
    let shown = shown.lines().last().filter(|_| matches!(output, Output::Picture));
    [
        labelled("surface", &format!("{faces}, {textures}")),
        labelled("texture", &format!("{side} × {side} texels, {fill:.1} % of them on islands")),
        labelled("written", &report.written.join(", ")),
        shown.map(|line| labelled("material", line)).unwrap_or_default(),
    ]
    .concat()
}
