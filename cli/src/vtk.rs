//! Polygonal data in VTK's XML format (`.vtp`), which `ParaView` opens.
//!
//! Format: "VTK File Formats" of the VTK User's Guide. Arrays stand in place as base64: a header of one 64-bit number, their length in
//! bytes, and their numbers, little-endian. Cells are ordered as VTK orders them: single points, lines, polygons.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write;

/// Numbers of points or cells.
#[derive(Clone, Debug)]
pub(crate) enum Numbers {
    Integers(Vec<i64>),
    /// So many for each point or cell, in a row.
    Floats(usize, Vec<f64>),
}

/// Points, cells on them, and what is known of either by name.
#[derive(Clone, Debug, Default)]
pub(crate) struct PolyData {
    pub(crate) points: Vec<[f64; 3]>,
    /// Points that are cells.
    pub(crate) verts: Vec<usize>,
    /// Chains of points.
    pub(crate) lines: Vec<Vec<usize>>,
    pub(crate) polygons: Vec<Vec<usize>>,
    /// What is coloured by at first, of points and of cells.
    pub(crate) scalars: [&'static str; 2],
    /// The array of points that holds texture coordinates.
    pub(crate) texture: Option<&'static str>,
    pub(crate) of_points: Vec<(&'static str, Numbers)>,
    pub(crate) of_cells: Vec<(&'static str, Numbers)>,
}

impl PolyData {
    /// The document.
    pub(crate) fn text(&self) -> String {
        let texture = self.texture.map_or_else(String::new, |name| format!(" TCoords=\"{name}\""));
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
             <PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n\
             <PointData Scalars=\"{}\"{texture}>\n",
            self.points.len(),
            self.verts.len(),
            self.lines.len(),
            self.polygons.len(),
            self.scalars[0]
        );
        self.of_points.iter().for_each(|(name, numbers)| text += &array(name, numbers));
        let _ = writeln!(text, "</PointData>\n<CellData Scalars=\"{}\">", self.scalars[1]);
        self.of_cells.iter().for_each(|(name, numbers)| text += &array(name, numbers));
        text += "</CellData>\n<Points>\n";
        text += &array("Points", &Numbers::Floats(3, self.points.as_flattened().to_vec()));
        text += "</Points>\n";
        let verts: Vec<Vec<usize>> = self.verts.iter().map(|&v| vec![v]).collect();
        for (name, cells) in [("Verts", &verts), ("Lines", &self.lines), ("Polys", &self.polygons)] {
            text += &cells_of(name, cells);
        }
        text + "</Piece>\n</PolyData>\n</VTKFile>\n"
    }
}

fn cells_of(name: &str, cells: &[Vec<usize>]) -> String {
    let mut end = 0;
    let mut ends = Vec::with_capacity(cells.len());
    for cell in cells {
        end += cell.len() as i64;
        ends.push(end);
    }
    let connectivity = cells.iter().flatten().map(|&v| v as i64).collect();
    format!(
        "<{name}>\n{}{}</{name}>\n",
        array("connectivity", &Numbers::Integers(connectivity)),
        array("offsets", &Numbers::Integers(ends))
    )
}

fn array(name: &str, numbers: &Numbers) -> String {
    let (kind, components, bytes): (_, _, Vec<u8>) = match numbers {
        Numbers::Integers(all) => ("Int64", 1, all.iter().flat_map(|x| x.to_le_bytes()).collect()),
        Numbers::Floats(components, all) => {
            ("Float64", *components, all.iter().flat_map(|x| x.to_le_bytes()).collect())
        }
    };
    let whole = [&(bytes.len() as u64).to_le_bytes(), bytes.as_slice()].concat();
    let data = STANDARD.encode(whole);
    format!(
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\">\n{data}\n</DataArray>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_behind_their_length() {
        let data = PolyData { points: vec![[1.0, 2.0, 3.0]], verts: vec![0], ..PolyData::default() };
        let text = data.text();
        let points = text.split("Name=\"Points\"").nth(1).and_then(|rest| rest.lines().nth(1)).unwrap();
        let bytes = STANDARD.decode(points).unwrap();
        assert_eq!(bytes[..8], 24_u64.to_le_bytes());
        assert_eq!(bytes[16..24], 2.0_f64.to_le_bytes());
        assert!(text.contains("NumberOfPolys=\"0\"") && text.ends_with("</VTKFile>\n"));
    }
}
