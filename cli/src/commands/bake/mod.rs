//! `cones bake`: the textures of a model, transferred to another map of it.

mod faces;
mod margins;
mod raster;

use crate::commands::shared::{MaterialFiles, material_text, overlap, texture, whole};
use crate::error::CommandError;
use crate::input::{self, Problem, Texels};
use crate::output::{self, Files};
use crate::report::overlap_text;
use crate::report::table::{counted, labelled};
use clap::Args;
use cones::uv::Triangle;
use faces::{Pair, pairs};
use geom::io::{ObjContent, Picture, Textures, read_image, write_obj};
use geom::{Model, Weld};
use margins::filled;
use raster::{Piece, rasterized};
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// The new map is the same surface: faces in the same order at the same places, polygons or their triangles, as `cones unwrap`, `pack` and `islands`
/// write them. Texels are means of what the old textures show on them, in linear light; what is between islands has the colour of the nearest texel.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BakeArgs {
    /// The model with its textures and the map that they are for: OBJ, PLY or glTF, the pictures PNG or JPEG
    #[arg(value_name = "OLD")]
    old: PathBuf,
    /// The same surface with another map, in the unit square: OBJ, PLY or glTF
    #[arg(value_name = "NEW")]
    new: PathBuf,
    /// Where to write the texture: .png; or .obj, which is NEW with one material (.mtl) and the texture (.png) beside it
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// The side of the texture in texels [default: a power of two, as fine as the old textures are]
    #[arg(long, value_name = "TEXELS", value_parser = whole::<usize>("number of texels", 1..=LARGEST), allow_negative_numbers = true)]
    texture_size: Option<usize>,
    /// How many texels around islands have the colour of the nearest one; what is farther away has the mean of all
    #[arg(long, value_name = "TEXELS", value_parser = whole::<usize>("number of texels", 0..=WIDEST), allow_negative_numbers = true, default_value_t = 16)]
    padding: usize,
}

const EXAMPLES: &str = "\
Examples:
  cones unwrap scan.obj -o new.obj
  cones bake scan.obj new.obj -o textured.obj
  cones bake scan.glb new.glb -o new.png --texture-size 4096 --padding 32";

/// The largest texture: what graphics cards take.
const LARGEST: usize = 1 << 14;
/// The widest padding.
const WIDEST: usize = 512;
/// Texture sizes that are chosen: no one asked for more than 8192, and less than 64 is of no use.
const CHOSEN: std::ops::RangeInclusive<usize> = 1 << 6..=1 << 13;
/// A power of two that is smaller than as fine as the old textures by so little is fine enough.
const FINE_ENOUGH: f64 = 0.9;
/// So many bytes of a picture are read.
const MOST_OF_PICTURE: u64 = 1 << 30;
/// Coordinates may be beyond the unit square by so much: files round.
const ROUNDING: f64 = 1e-6;
/// The material's name.
const NAME: &str = "baked";

pub(crate) fn run(args: &BakeArgs) -> Result<(), CommandError> {
    let model_files = check_outputs(args, &[])?;
    let [old, new] = [input::read_model(&args.old)?.0, input::read_model(&args.new)?.0];
    check_outputs(args, &named(args, [&old, &new]))?;
    let textures = Textures::of(&old, &args.old);
    if old.uv().is_none() {
        return Err(CommandError::NoTexture(args.old.clone()));
    }
    let pairs = pairs((&args.old, &old), (&args.new, &new))?;
    let surface = Surface { old: &old, new_uv: texture(&args.new, &new)?, pairs, textures: &textures };
    check_square(&args.new, &new, &surface.new_uv)?;
    let pictures = pictures(&args.old, &textures)?;
    let side = args.texture_size.unwrap_or_else(|| surface.fine_side(&pictures));
    let texels = rasterized(&surface.pieces(&pictures, side), &pictures, side);
    let share = texels.iter().flatten().count() as f64 / texels.len() as f64;
    let pixels = filled(&texels, side, args.padding);
    write(args, &new, model_files.as_ref(), (&pixels, side))?;
    surface.warn(args, overlap(&new, &surface.new_uv, Weld::Auto));
    output::summary(&summary(args, &surface, (side, share)))
}

/// Endings and places of the outputs; what is beside an OBJ. `others` are not to be overwritten either.
fn check_outputs(args: &BakeArgs, others: &[PathBuf]) -> Result<Option<MaterialFiles>, CommandError> {
    let is_model = output::extension(&args.output, &["png", "obj"])? == "obj";
    let beside = is_model.then(|| MaterialFiles::beside(&args.output, NAME));
    let inputs: Vec<&Path> = [&args.old, &args.new].into_iter().chain(others).map(|path| &**path).collect();
    let outputs: Vec<&Path> =
        std::iter::once(&*args.output).chain(beside.iter().flat_map(MaterialFiles::paths)).collect();
    output::check(&inputs, &outputs)?;
    Ok(beside)
}

/// The files that the models name.
fn named(args: &BakeArgs, models: [&Model; 2]) -> Vec<PathBuf> {
    let mut named = Vec::new();
    for (path, model) in [&args.old, &args.new].into_iter().zip(models) {
        let libraries = model.attributes().libraries.iter();
        named.extend(libraries.map(|library| output::folder_of(path).join(library)));
        let textures = Textures::of(model, path);
        named.extend(textures.list().iter().filter_map(|texture| match &texture.picture {
            Picture::File(path) => Some(path.clone()),
            _ => None,
        }));
    }
    named
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
        let name = texture.name.clone();
        if texture.is_moved {
            return Err(CommandError::MovedTexture { path: path.to_owned(), name });
        }
        match &texture.picture {
            Picture::Unknown(_) => Err(CommandError::UnknownPicture { path: path.to_owned(), name }),
            Picture::File(file) => {
                let mut bytes = Vec::new();
                // Devices have no end.
                let read = File::open(file).and_then(|file| file.take(MOST_OF_PICTURE).read_to_end(&mut bytes));
                read.map_err(|error| Problem::Io(error).in_file(file))?;
                Ok(Texels::decode(&bytes, file)?)
            }
            Picture::Image(number) => Ok(Texels::decode(&read_image(path, *number)?, &path.join(name))?),
        }
    };
    textures.list().iter().map(picture).collect()
}

/// A surface with both maps.
struct Surface<'a> {
    old: &'a Model,
    new_uv: Vec<[f64; 2]>,
    pairs: Vec<Pair>,
    textures: &'a Textures,
}

impl Surface<'_> {
    /// The old and the new image of a triangle, and its texture; none where it has none.
    fn images(&self, pair: &Pair) -> Option<(Triangle, Triangle, usize)> {
        let uv = self.old.uv()?;
        let [a, b, c] = pair.old.map(|corner| uv.corner(corner as usize));
        let texture = self.textures.of_face(pair.face as usize)?;
        Some(([a?, b?, c?], pair.new.map(|corner| self.new_uv[corner as usize]), texture))
    }

    fn pieces(&self, pictures: &[Texels], side: usize) -> Vec<Piece> {
        let piece = |pair: &Pair| {
            let (old, new, texture) = self.images(pair)?;
            Piece::new(old, new, (texture as u32, &pictures[texture]), side)
        };
        self.pairs.iter().filter_map(piece).collect()
    }

    /// The side of a texture on which the surface has as many texels as the old textures have pixels on it.
    fn fine_side(&self, pictures: &[Texels]) -> usize {
        let area = |[a, b, c]: Triangle| 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
        let areas = self.pairs.iter().filter_map(|pair| {
            let (old, new, texture) = self.images(pair)?;
            let pixels = pictures[texture].width as f64 * pictures[texture].height as f64;
            Some([area(old) * pixels, area(new)]).filter(|areas| areas.iter().all(|x| x.is_finite()))
        });
        let [pixels, squares] = areas.fold([0.0; 2], |sum, next| [sum[0] + next[0], sum[1] + next[1]]);
        let side = if squares > 0.0 { FINE_ENOUGH * (pixels / squares).sqrt() } else { 0.0 };
        (side.min(*CHOSEN.end() as f64) as usize).next_power_of_two().clamp(*CHOSEN.start(), *CHOSEN.end())
    }

    /// Says what is not as it should be.
    fn warn(&self, args: &BakeArgs, overlap: cones::report::OverlapReport) {
        let lacks = |pair: &&Pair| self.images(pair).is_none();
        let mut faces: Vec<u32> = self.pairs.iter().filter(lacks).map(|pair| pair.face).collect();
        faces.dedup();
        if !faces.is_empty() {
            let faces = counted(faces.len(), "face has", "faces have");
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
}

/// Writes the texture, and what belongs to it.
fn write(
    args: &BakeArgs,
    new: &Model,
    beside: Option<&MaterialFiles>,
    (pixels, side): (&[[u8; 4]], usize),
) -> Result<(), CommandError> {
    let mut files = Files::new();
    let picture = beside.map_or(&*args.output, MaterialFiles::picture);
    files.write(picture, |out| Ok(write_png(pixels, side, out)?))?;
    if let Some(beside) = beside {
        beside.write_material(&mut files)?;
        let content = ObjContent { material: Some(beside.material()), ..ObjContent::default() };
        files.write(&args.output, |out| write_obj(new, &content, out))?;
    }
    files.finish()
}

/// Writes a square picture as PNG, without alpha where all of it is opaque.
fn write_png(pixels: &[[u8; 4]], side: usize, out: &mut dyn Write) -> std::io::Result<()> {
    let is_opaque = pixels.iter().all(|pixel| pixel[3] == u8::MAX);
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

fn summary(args: &BakeArgs, surface: &Surface, (side, share): (usize, f64)) -> String {
    let faces = counted(surface.old.face_count(), "face", "faces");
    let textures = counted(surface.textures.list().len(), "texture", "textures");
    let share = 100.0 * share;
    let picture = format!("{side} × {side} texels, {share:.1} % of them on islands");
    let beside = MaterialFiles::beside(&args.output, NAME);
    let is_model = args.output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("obj"));
    let mut written = vec![args.output.display().to_string()];
    if is_model {
        written.extend(beside.paths().map(|path| path.display().to_string()));
    }
    let shown = material_text(NAME, &args.output);
    let shown = shown.lines().last().filter(|_| !is_model).map(|line| labelled("material", line));
    [
        labelled("surface", &format!("{faces}, {textures}")),
        labelled("texture", &picture),
        labelled("written", &written.join(", ")),
        shown.unwrap_or_default(),
    ]
    .concat()
}
