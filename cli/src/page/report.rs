//! The page as a file of its own, with a surface and maps of it inside.
//!
//! The data is a [`Container`] of [packed] arrays, deflated and written in base64 at the end of the page, where it is read
//! by its element's name. Names of arrays of the map of level k end in `.k`.

use super::packed::{self, MOST_LOG_AREA, MOST_LOG_STRETCH, Numbering, Range};
use super::{Container, Map, PAGE, Stretches, Surface};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde_json::{Value, json};
use std::io::{self, Write};

/// Where the built page takes its data.
const PLACE: &str = "<script id=\"data\" type=\"application/octet-stream\"></script>";

/// What is known with one number of cones.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    /// Cones, prediction and, where there is a map, its report.
    pub(crate) meta: Value,
    /// Chains of vertices; those of the map where there is one.
    pub(crate) seams: Vec<Vec<u32>>,
    pub(crate) map: Option<LevelMap>,
}

/// A map, packed.
#[derive(Clone, Debug)]
pub(crate) struct LevelMap {
    range: Range<2>,
    coordinates: Vec<u8>,
    others: Vec<u8>,
    log_area: Vec<u8>,
    stretch: Vec<u8>,
    island: Vec<u8>,
}

/// A surface that maps are packed for.
#[derive(Debug)]
pub(crate) struct Report<'a> {
    surface: &'a Surface,
    numbering: Numbering,
}

impl<'a> Report<'a> {
    pub(crate) fn new(surface: &'a Surface) -> Self {
        Self { surface, numbering: Numbering::new(surface.points.len(), &surface.triangles) }
    }

    /// A map of the surface in few bytes.
    pub(crate) fn pack(&self, map: &Map, stretches: &Stretches) -> LevelMap {
        let (range, coordinates, others) = packed::coordinates(&self.numbering, &self.surface.triangles, &map.uv);
        LevelMap {
            range,
            coordinates,
            others,
            log_area: packed::logarithms(stretches.log_area.iter().map(|&x| f64::from(x)), MOST_LOG_AREA),
            stretch: packed::logarithms(stretches.stretch.iter().map(|&x| f64::from(x).ln()), MOST_LOG_STRETCH),
            island: packed::sequence(map.island.iter().copied()),
        }
    }

    /// The page with all of it inside. `meta` is what the server would send with the surface, `foreseen` the cones for
    /// every number of them.
    ///
    /// # Errors
    /// None that memory does not have.
    pub(crate) fn html(&self, meta: &Value, foreseen: &Value, levels: &[Level]) -> io::Result<String> {
        let Self { surface, numbering } = self;
        let wide = |v: u32| surface.points[v as usize].map(f64::from);
        let factor = |v: u32| [f64::from(surface.factor[v as usize])];
        let points = Range::of(numbering.vertex.iter().map(|&v| wide(v)));
        let factors = Range::of(numbering.vertex.iter().map(|&v| factor(v)));
        let ranges =
            |level: &Level| level.map.as_ref().map(|map| json!({ "low": map.range.low, "step": map.range.step }));
        let levels_meta: Vec<Value> =
            levels.iter().map(|level| json!({ "meta": level.meta, "range": ranges(level) })).collect();
        let meta = json!({
            "surface": meta,
            "foreseen": foreseen,
            "levels": levels_meta,
            "vertices": numbering.vertex.len(),
            "triangles": surface.triangles.len(),
            "points": { "low": points.low, "step": points.step },
            "factor": { "low": factors.low, "step": factors.step },
            "most_log_area": MOST_LOG_AREA,
            "most_log_stretch": MOST_LOG_STRETCH,
        });
        let mut container = Container::new(meta)
            .bytes("vertex", &packed::sequence(numbering.vertex.iter().copied()))
            .bytes("triangles", &numbering.triangles(&surface.triangles))
            .bytes("points", &numbering.values(points, wide))
            .bytes("factor", &numbering.values(factors, factor));
        for (k, level) in levels.iter().enumerate() {
            container = container.bytes(&format!("seams.{k}"), &packed::chains(numbering, &level.seams));
            if let Some(map) = &level.map {
                container = container
                    .bytes(&format!("uv.{k}"), &map.coordinates)
                    .bytes(&format!("others.{k}"), &map.others)
                    .bytes(&format!("log_area.{k}"), &map.log_area)
                    .bytes(&format!("stretch.{k}"), &map.stretch)
                    .bytes(&format!("island.{k}"), &map.island);
            }
        }
        with_data(container)
    }
}

/// The page with data inside.
pub(crate) fn with_data(container: Container) -> io::Result<String> {
    let mut deflated = ZlibEncoder::new(Vec::new(), Compression::best());
    deflated.write_all(&container.finish())?;
    let data = STANDARD.encode(deflated.finish()?);
    let filled = PLACE.replace("><", &format!(">{data}<"));
    Ok(PAGE.replacen(PLACE, &filled, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_one_place_for_data() {
        assert_eq!(PAGE.matches(PLACE).count(), 1);
    }

    #[test]
    fn the_page_asks_for_nothing_from_elsewhere() {
        let is_loaded = |text: &str| text.starts_with("http") || text.starts_with("//");
        for attribute in ["src=\"", "href=\"", "url("] {
            assert!(!PAGE.split(attribute).skip(1).any(is_loaded), "{attribute}");
        }
    }
}
