//! Finished pictures: put beside each other, made smaller, written on, and as PNG files.

use super::colour::{Colour, decode, encode, mix};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use std::io::{self, Write};

/// A finished picture: rows of 8-bit sRGB pixels.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) pixels: Vec<[u8; 3]>,
}

/// How large letters are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Letters {
    Small,
    Large,
}

impl Letters {
    /// The height of a line in pixels.
    pub(crate) fn height(self) -> usize {
        self.raster().val()
    }

    /// The width of a text in pixels.
    pub(crate) fn width(self, text: &str) -> usize {
        get_raster_width(FontWeight::Regular, self.raster()) * text.chars().count()
    }

    fn raster(self) -> RasterHeight {
        match self {
            Self::Small => RasterHeight::Size16,
            Self::Large => RasterHeight::Size24,
        }
    }
}

impl Picture {
    /// An empty one.
    pub(crate) fn blank(width: usize, height: usize, paper: Colour) -> Self {
        Self { width, height, pixels: vec![encode(paper); width * height] }
    }

    /// Each pixel as a square of so many.
    pub(crate) fn enlarged(&self, factor: usize) -> Self {
        let (width, height) = (self.width * factor, self.height * factor);
        let row = |y: usize| &self.pixels[y * self.width..(y + 1) * self.width];
        let wide = |y: usize| row(y / factor).iter().flat_map(|&pixel| std::iter::repeat_n(pixel, factor));
        Self { width, height, pixels: (0..height).flat_map(wide).collect() }
    }

    /// Puts another on it with the upper left corner at a place; what reaches beyond is cut off.
    pub(crate) fn place(&mut self, other: &Self, [x, y]: [usize; 2]) {
        let columns = other.width.min(self.width.saturating_sub(x));
        for row in 0..other.height.min(self.height.saturating_sub(y)) {
            let (to, from) = ((y + row) * self.width + x, row * other.width);
            self.pixels[to..to + columns].copy_from_slice(&other.pixels[from..from + columns]);
        }
    }

    /// Fills a rectangle from its upper left corner on.
    pub(crate) fn fill(&mut self, [x, y]: [usize; 2], [width, height]: [usize; 2], colour: Colour) {
        self.place(&Self::blank(width, height, colour), [x, y]);
    }

    /// Writes a line of ASCII with its upper left corner at a place; what reaches beyond is cut off.
    pub(crate) fn write(&mut self, text: &str, [x, y]: [usize; 2], letters: Letters, colour: Colour) {
        for (k, letter) in text.chars().enumerate() {
            let shape = |letter| get_raster(letter, FontWeight::Regular, letters.raster());
            let Some(glyph) = shape(letter).or_else(|| shape('?')) else { continue };
            let left = x + k * glyph.width();
            for (row, coverage) in glyph.rows().enumerate() {
                for (column, &share) in coverage.iter().enumerate() {
                    if left + column < self.width && y + row < self.height && share > 0 {
                        let pixel = &mut self.pixels[(y + row) * self.width + left + column];
                        *pixel = encode(mix(decode(*pixel), colour, f64::from(share) / 255.0));
                    }
                }
            }
        }
    }

    /// The same picture so large that it fits into a rectangle, each pixel the mean of those that it covers; never larger than it is.
    pub(crate) fn fitted(&self, [width, height]: [usize; 2]) -> Self {
        let ratio = (width as f64 / self.width.max(1) as f64).min(height as f64 / self.height.max(1) as f64);
        if ratio >= 1.0 {
            return self.clone();
        }
        let [width, height] = [self.width, self.height].map(|size| ((ratio * size as f64).floor() as usize).max(1));
        let across = |y: usize| {
            let row = &self.pixels[y * self.width..(y + 1) * self.width];
            row.iter().map(|&pixel| decode(pixel)).collect::<Vec<Colour>>()
        };
        let rows: Vec<Vec<Colour>> = (0..self.height).map(|y| reduced(&across(y), width)).collect();
        let mut pixels = vec![[0; 3]; width * height];
        for x in 0..width {
            let column: Vec<Colour> = rows.iter().map(|row| row[x]).collect();
            for (y, colour) in reduced(&column, height).into_iter().enumerate() {
                pixels[y * width + x] = encode(colour);
            }
        }
        Self { width, height, pixels }
    }

    /// This one with another below it.
    pub(crate) fn above(&self, other: &Self, paper: Colour) -> Self {
        let mut both = Self::blank(self.width.max(other.width), self.height + other.height, paper);
        both.place(self, [0, 0]);
        both.place(other, [0, self.height]);
        both
    }

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

/// A line of colours as fewer of them, each the mean of what it covers.
fn reduced(line: &[Colour], count: usize) -> Vec<Colour> {
    let step = line.len() as f64 / count as f64;
    let mean = |k: usize| {
        let (low, high) = (k as f64 * step, ((k + 1) as f64 * step).min(line.len() as f64));
        let mut sum = [0.0; 3];
        let last = (high.ceil() as usize).min(line.len());
        for (i, colour) in line.iter().enumerate().take(last).skip(low as usize) {
            let share = (high.min((i + 1) as f64) - low.max(i as f64)).max(0.0);
            sum = std::array::from_fn(|channel| sum[channel] + share * colour[channel]);
        }
        sum.map(|x| x / (high - low))
    };
    (0..count).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smaller_picture_has_the_mean_light_of_the_larger_one() {
        let mut picture = Picture::blank(90, 60, [1.0; 3]);
        picture.fill([0, 0], [45, 60], [0.0; 3]);
        let half = picture.fitted([31, 100]);
        assert_eq!((half.width, half.height), (31, 20));
        let light: f64 = half.pixels.iter().map(|&p| decode(p)[0]).sum::<f64>() / half.pixels.len() as f64;
        assert!((light - 0.5).abs() < 0.01, "{light}");
        assert_eq!(picture.fitted([900, 900]).width, 90);
    }

    #[test]
    fn letters_are_dark_where_they_are_and_stay_on_the_page() {
        let mut picture = Picture::blank(40, 20, [1.0; 3]);
        picture.write("H_\u{3c6}", [30, 4], Letters::Small, [0.0; 3]);
        assert!(picture.pixels.iter().any(|p| p[0] < 60));
        assert!(picture.pixels.iter().all(|p| p[0] == p[1]));
        picture.write("x", [500, 500], Letters::Large, [0.0; 3]);
    }
}
