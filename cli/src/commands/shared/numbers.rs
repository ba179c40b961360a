//! Numbers on the command line.

pub(crate) fn vertex_count(text: &str) -> Result<usize, String> {
    let most = geom::shapes::MAX_VERTICES;
    text.parse().ok().filter(|n| (1..=most).contains(n)).ok_or_else(|| format!("not a number from 1 to {most}"))
}

pub(crate) fn non_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x >= 0.0 && x.is_finite() => Ok(x),
        _ => Err("not a number of at least 0".into()),
    }
}

/// A number from 0 to 1.
pub(super) fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (0.0..=1.0).contains(&x) => Ok(x),
        _ => Err("not a number from 0 to 1".into()),
    }
}

/// An area distortion.
pub(super) fn distortion(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(d) if d > 1.0 && d.is_finite() => Ok(d),
        _ => Err("not a number above 1, which is no distortion".into()),
    }
}
