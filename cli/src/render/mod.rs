//! Pictures of an unwrapped surface: the model with checkerboard, seams and cones, and its layout in the plane.
//!
//! A small rasteriser of our own draws them, so that a picture needs no window system and is the same on every machine.

mod ambient_occlusion;
mod camera;
mod canvas;
mod checker;
mod colour;
mod glyphs;
mod layout;
mod layout_svg;
mod light;
mod model;
mod scene;
mod svg;
mod view;

pub(crate) use canvas::Picture;
pub(crate) use checker::Checker;
pub(crate) use colour::{Colour, INK, MAXIMUM, MINIMUM, PAPER, encode, encode_hue, mix};
pub(crate) use layout::draw as draw_layout;
pub(crate) use layout_svg::draw as draw_layout_svg;
pub(crate) use model::draw as draw_model;
pub(crate) use model::draw_values;
pub(crate) use scene::{Mark, Scene, extent};
pub(crate) use svg::{Anchor, Svg};

use std::io::{self, Write};

impl Picture {
    /// The picture as a PNG file's bytes.
    pub(crate) fn png(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.write_png(&mut bytes)?;
        Ok(bytes)
    }

    /// Writes the picture as PNG.
    pub(crate) fn write_png(&self, out: impl Write) -> io::Result<()> {
        let (width, height) = (u32::try_from(self.width), u32::try_from(self.height));
        let (Ok(width), Ok(height)) = (width, height) else { return Err(io::ErrorKind::InvalidInput.into()) };
        let mut encoder = png::Encoder::new(out, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels.as_flattened())?;
        writer.finish()?;
        Ok(())
    }
}
