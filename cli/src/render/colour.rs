//! The pictures' colours, in linear light, and their way into an sRGB file.

/// Red, green and blue in linear light, 0 to 1.
pub(crate) type Colour = [f64; 3];

pub(crate) const PAPER: Colour = [1.0, 1.0, 1.0];
/// Seams, outlines.
pub(crate) const INK: Colour = srgb(0x1d, 0x21, 0x2b);
/// The two colours of the checkerboard: quiet, so that cones and seams stand out.
pub(crate) const CHECKER: [Colour; 2] = [srgb(0xf4, 0xf1, 0xea), srgb(0x8f, 0xa6, 0xb8)];
/// Where a surface shows its inside.
pub(crate) const INSIDE: Colour = srgb(0xd9, 0xb9, 0x9b);
/// Where a layout lies over itself, mixed with the checkerboard.
pub(crate) const OVERLAP: Colour = srgb(0xf0, 0x8a, 0x1d);
/// What the checkerboard of one island among several is mixed with, in turn: none of the colours of cones, overlaps and flips.
pub(crate) const ISLANDS: [Colour; 8] = [
    srgb(0x4c, 0x9a, 0xa8),
    srgb(0x7f, 0xb0, 0x7a),
    srgb(0x8d, 0x7f, 0xc4),
    srgb(0x5b, 0xb0, 0x9a),
    srgb(0x6b, 0x93, 0xd6),
    srgb(0x9a, 0xa3, 0x8f),
    srgb(0xb0, 0x7a, 0xb5),
    srgb(0x7d, 0x8a, 0x99),
];
/// A triangle laid out upside down.
pub(crate) const FLIPPED: Colour = srgb(0xe0, 0x1b, 0x84);
/// A cone of negative curvature, a maximum of the conformal factor.
pub(crate) const MAXIMUM: Colour = srgb(0xd6, 0x27, 0x28);
/// A cone of positive curvature, a minimum of the conformal factor.
pub(crate) const MINIMUM: Colour = srgb(0x1f, 0x5f, 0xd0);

/// sRGB's curve undone by a cubic, within a step of the 255: constants cannot take powers.
pub(super) const fn srgb(r: u8, g: u8, b: u8) -> Colour {
    const fn linear(c: u8) -> f64 {
        let x = c as f64 / 255.0;
        x * (x * (x * 0.305_306 + 0.682_171) + 0.012_523)
    }
    [linear(r), linear(g), linear(b)]
}

/// A colour as the 8-bit sRGB values of a file (IEC 61966-2-1).
pub(crate) fn encode(colour: Colour) -> [u8; 3] {
    colour.map(|x| {
        let x = x.clamp(0.0, 1.0);
        let curved = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        (255.0 * curved).round() as u8
    })
}

/// The light of the 8-bit sRGB values of a file: [`encode`] undone.
pub(crate) fn decode(pixel: [u8; 3]) -> Colour {
    pixel.map(|c| {
        let x = f64::from(c) / 255.0;
        if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
    })
}

/// [`encode`] by a table, for the many pixels of a picture.
#[derive(Debug)]
pub(crate) struct Encoder(Vec<u8>);

impl Encoder {
    /// Finer than the curve is steep, so that no value is off by more than one.
    const STEPS: f64 = 4096.0;

    pub(crate) fn new() -> Self {
        Self((0..=Self::STEPS as usize).map(|i| encode([i as f64 / Self::STEPS; 3])[0]).collect())
    }

    pub(crate) fn encode(&self, colour: Colour) -> [u8; 3] {
        colour.map(|x| self.0[(x.clamp(0.0, 1.0) * Self::STEPS + 0.5) as usize])
    }
}

/// `#rrggbb`, for SVG.
pub(crate) fn hex(colour: Colour) -> String {
    let [r, g, b] = encode(colour);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A vivid colour as the 8-bit sRGB values of a file: `turn` goes once round the hues from 0 to 1, `value` is its lightness.
pub(crate) fn encode_hue(turn: f64, value: f64) -> [u8; 3] {
    let channel = |shift: f64| {
        let distance = 6.0 * ((turn + shift).rem_euclid(1.0) - 0.5).abs();
        let vivid = (distance - 1.0).clamp(0.0, 1.0);
        (255.0 * value * (0.35 + 0.65 * vivid)).round() as u8
    };
    [0.0, 2.0 / 3.0, 1.0 / 3.0].map(channel)
}

/// Between two colours: `a` at 0, `b` at 1.
pub(crate) fn mix(a: Colour, b: Colour, t: f64) -> Colour {
    std::array::from_fn(|i| a[i] + t * (b[i] - a[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_named_colour_comes_out_as_it_was_named() {
        assert_eq!(hex(PAPER), "#ffffff");
        let named = [0x8f, 0xa6, 0xb8];
        let near = encode(CHECKER[1]).iter().zip(named).all(|(&a, b)| a.abs_diff(b) <= 1);
        assert!(near, "{:?}", encode(CHECKER[1]));
    }
}
