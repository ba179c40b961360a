//! The segmentation: each vertex with the extremum it belongs to.

use super::explain;
use super::field::{DomainField, Places, on};
use super::picture::segmented;
use crate::error::CommandError;
use crate::input::{FieldScalar, each, write_labels};
use crate::output::{self, Files};
use crate::render::encode_hue;
use std::io::{self, Write};
use std::path::Path;
use topo::{Kind, PersistenceOptions, Segmentation};

/// Whether segments can be written in the form a path asks for: colours need a mesh or a picture.
pub(super) fn check(path: &Path, places: &Places) -> Result<(), CommandError> {
    let refused = |of| Err(CommandError::SegmentsAs { path: path.to_owned(), of });
    match (output::extension(path, &["npy", "ply", "png"])?, places) {
        ("ply", Places::Array(_) | Places::Network(_)) => refused("a mesh"),
        ("png", Places::Array(shape)) if shape.len() == 2 && !shape.contains(&0) => Ok(()),
        ("png", _) => refused("a picture"),
        _ => Ok(()),
    }
}

/// Writes the segments of the extrema that are more persistent than a threshold, in a form that was [checked](check).
pub(super) fn write(
    files: &mut Files,
    path: &Path,
    subject: &DomainField,
    kind: Kind,
    options: PersistenceOptions,
    threshold: f64,
) -> Result<(), CommandError> {
    let segments = segments(subject, kind, options, threshold).map_err(|error| explain(&subject.path, error))?;
    let extremum = |segment: Option<usize>| segment.map(|segment| segments.extrema()[segment]);
    match (output::extension(path, &["npy", "ply", "png"])?, &subject.places) {
        ("ply", Places::Mesh { points, triangles }) => {
            let colours: Vec<[u8; 3]> = segments.labels().map(colour).collect();
            files.write(path, |out| Ok(write_ply(points, triangles, &colours, out)?))
        }
        ("png", Places::Array(shape)) if shape.len() == 2 => {
            let picture = segmented(segments.labels().map(colour), &subject.values.to_f64(), [shape[0], shape[1]]);
            files.write_png(path, &picture)
        }
        (_, places) => {
            let shape = if let Places::Array(shape) = places { shape.clone() } else { vec![subject.vertex_count()] };
            files.write(path, |out| Ok(write_labels(&shape, segments.labels().map(extremum), out)?))
        }
    }
}

fn segments(
    subject: &DomainField,
    kind: Kind,
    options: PersistenceOptions,
    threshold: f64,
) -> Result<Segmentation<usize>, topo::Error> {
    fn threshold_of<S: FieldScalar>(_: &[S], threshold: f64) -> S::Width {
        S::threshold(threshold)
    }
    each!(&subject.values, field => on!(&subject.domain, domain => {
        options.segmentation(domain, field, kind, threshold_of(field, threshold))
    }))
}

/// A colour of its own for each segment; black for none. Hues a golden section of the circle apart differ for long.
fn colour(segment: Option<usize>) -> [u8; 3] {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    segment.map_or([0; 3], |segment| {
        let turn = segment as f64 * GOLDEN;
        encode_hue(turn.fract(), [0.75, 0.5, 0.95][segment % 3])
    })
}

/// A mesh with colours at its vertices: binary, little endian.
fn write_ply(points: &[[f64; 3]], triangles: &[[u32; 3]], colours: &[[u8; 3]], out: &mut dyn Write) -> io::Result<()> {
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\nproperty list uchar int vertex_indices\n\
         end_header\n",
        points.len(),
        triangles.len()
    )?;
    for (point, colour) in points.iter().zip(colours) {
        for x in point {
            out.write_all(&x.to_le_bytes())?;
        }
        out.write_all(colour)?;
    }
    for triangle in triangles {
        out.write_all(&[3])?;
        for v in triangle {
            out.write_all(&v.to_le_bytes())?;
        }
    }
    Ok(())
}
