//! Table 1 of the paper as it is printed, and which file stands in for each of its models.

/// What the paper prints for one method on one model. Times in seconds, on its machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Printed {
    /// None where the paper leaves it out, since one detection serves all numbers of cones.
    pub(crate) detection: Option<f64>,
    pub(crate) flattening: f64,
    pub(crate) areal: f64,
    pub(crate) quasi_conformal: f64,
}

/// A row of the paper's table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PaperRow {
    pub(crate) cones: usize,
    /// The paper's method.
    pub(crate) ours: Printed,
    /// That of Ben-Chen, Gotsman & Bunin, as the paper ran it.
    pub(crate) published: Printed,
}

/// A model of the paper.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PaperModel {
    pub(crate) name: &'static str,
    /// Its size as printed.
    pub(crate) vertices: &'static str,
    /// The file that stands in for it, if there is one.
    pub(crate) file: Option<&'static str>,
    /// How the file relates to the paper's.
    pub(crate) remark: &'static str,
    pub(crate) rows: &'static [PaperRow],
}

const fn row(
    cones: usize,
    detection: [Option<f64>; 2],
    flattening: [f64; 2],
    areal: [f64; 2],
    qc: [f64; 2],
) -> PaperRow {
    let [ours, published] = [0, 1];
    PaperRow {
        cones,
        ours: Printed {
            detection: detection[ours],
            flattening: flattening[ours],
            areal: areal[ours],
            quasi_conformal: qc[ours],
        },
        published: Printed {
            detection: detection[published],
            flattening: flattening[published],
            areal: areal[published],
            quasi_conformal: qc[published],
        },
    }
}

/// The models of Table 1 in its order.
pub(crate) const MODELS: [PaperModel; 7] = [
    PaperModel {
        name: "Planck",
        vertices: "28K",
        file: Some("table1_resized/planck_28000.obj"),
        remark: "not the paper's file: the same bust, subdivided from 10,000 vertices and decimated to its size",
        rows: &[row(16, [Some(0.246), Some(5.842)], [2.793, 1.550], [1.559, 1.199], [1.018, 1.013])],
    },
    PaperModel {
        name: "Armchair",
        vertices: "40K",
        file: None,
        remark: "no file of it is known",
        rows: &[row(16, [Some(0.265), Some(6.147)], [2.385, 2.754], [1.396, 1.513], [1.014, 1.015])],
    },
    PaperModel {
        name: "Rabbit",
        vertices: "57K",
        file: Some("table1/rabbit_46646.obj"),
        remark: "not the paper's file: a rabbit that looks the same, remeshed, with fewer vertices",
        rows: &[row(16, [Some(0.312), Some(10.077)], [4.184, 4.277], [1.113, 1.172], [1.009, 1.009])],
    },
    PaperModel {
        name: "OctaFlower",
        vertices: "32K",
        file: Some("table1_resized/octaflower_31970.obj"),
        remark: "not the paper's file: the same shape, subdivided from 7,994 vertices to its size",
        rows: &[row(16, [Some(0.184), Some(5.896)], [1.638, 2.396], [1.017, 1.117], [1.009, 1.008])],
    },
    PaperModel {
        name: "Hygeia",
        vertices: "33K",
        file: Some("table1_resized/igea_33587.obj"),
        remark: "not the paper's file: the scan of 134,345 vertices decimated to its size",
        rows: &[row(16, [Some(0.188), Some(4.404)], [1.441, 1.174], [1.125, 1.184], [1.021, 1.022])],
    },
    PaperModel {
        name: "Fandisk",
        vertices: "29K",
        file: Some("table1_resized/fandisk_28910.obj"),
        remark: "not the paper's file: the same part, subdivided from 7,229 vertices to its size",
        rows: &[
            row(4, [Some(0.211), Some(1.454)], [1.997, 1.888], [1.578, 1.611], [1.017, 1.015]),
            row(8, [None, Some(2.767)], [2.064, 1.910], [1.426, 1.583], [1.013, 1.012]),
            row(26, [None, Some(6.764)], [1.888, 1.874], [1.371, 1.587], [1.008, 1.012]),
        ],
    },
    PaperModel {
        name: "Moai",
        vertices: "10K",
        file: Some("table1/moai_10002.obj"),
        remark: "of the paper's size; may be its own file",
        rows: &[
            row(5, [Some(0.055), Some(0.329)], [0.281, 0.249], [1.285, 1.233], [1.043, 1.041]),
            row(22, [None, Some(1.023)], [0.248, 0.247], [1.227, 1.231], [1.034, 1.033]),
            row(34, [None, Some(1.497)], [0.238, 0.249], [1.171, 1.249], [1.036, 1.034]),
        ],
    },
];
