//! Colours: most files have them in sRGB, glTF linear (IEC 61966-2-1).

/// A share of light as sRGB has it.
pub(super) fn to_srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// A value of sRGB as the share of light.
pub(super) fn to_linear(srgb: f64) -> f64 {
    if srgb <= 0.040_45 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_bits_of_srgb_come_back_through_sixteen_linear_ones() {
        for byte in 0..=255_u8 {
            let linear = (to_linear(f64::from(byte) / 255.0) * 65535.0).round() / 65535.0;
            assert_eq!((to_srgb(linear) * 255.0).round() as u8, byte);
        }
    }
}
