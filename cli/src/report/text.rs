//! A report as a few lines of text.

use super::seams::seam_text;
use super::table::{counted, labelled, thousands};
use super::{InputReport, UnwrapReport};
use cones::report::{DistortionReport, OverlapReport, RefinedReport, Report};
use cones::{Islands, Options, Prediction};
use geom::{Repair, RepairKind};

/// Above this quasi-conformal distortion finer triangles are worth a thought.
const BENT: f64 = 1.1;
/// Where less of the square is filled more cuts may be worth it: coils and rings fill some hundredths.
const SPARSE: f64 = 0.3;

impl UnwrapReport {
    /// What a user wants to know first, line by line.
    pub(crate) fn text(&self) -> String {
        let times: Vec<String> = self.times.stages().map(|(name, time)| format!("{name} {time:.2}")).collect();
        let total = self.times.total();
        let memory = self.peak_memory.map_or_else(String::new, |peak| format!("; {} MB at most", peak / 1_000_000));
        let cones = thousands(self.map.cones.len());
        let extrema = counted(self.map.hierarchy.extrema, "extremum", "extrema");
        [
            labelled("surface", &self.input.text()),
            self.refined_text(),
            labelled("cones", &format!("{cones} ({}; φ has {extrema})", self.rule)),
            self.number_text(),
            distortion_text(&self.map.distortion, self.map.islands.len()),
            seam_text(&self.map.seams),
            self.advice(),
            labelled("time", &format!("{total:.2} s: {}{memory}", times.join(", "))),
        ]
        .concat()
    }

    /// What is written in place of the input, if the surface was refined.
    fn refined_text(&self) -> String {
        let Some(RefinedReport { vertices, faces, complete, .. }) = &self.map.refined else { return String::new() };
        let (vertices, triangles) =
            (counted(*vertices, "vertex", "vertices"), counted(*faces, "triangle", "triangles"));
        let how = if *complete { "to even triangles" } else { "in part" };
        labelled("refined", &format!("{how}; written as {vertices}, {triangles}"))
    }

    /// What there is to do where triangles are too coarse to keep angles, or islands leave most of the square empty.
    fn advice(&self) -> String {
        let Report { refined, distortion, .. } = &self.map;
        let is_bent = self.may_advise_refining && refined.is_none() && distortion.quasi_conformal.mean > BENT;
        // Tiles are as empty as the density that was asked for leaves them, and of single triangles there is nothing to cut.
        let can_be_cut = !self.is_udim && self.map.islands.iter().any(|island| island.faces > 1);
        let is_sparse = self.islands == Islands::OverlapFree && distortion.fill < SPARSE && can_be_cut;
        let advice = [
            (is_bent, "--refine writes finer triangles, on which angles are mostly kept better"),
            (is_sparse, "--islands pack cuts islands that leave most of the square empty"),
        ];
        advice.into_iter().filter(|(is_due, _)| *is_due).map(|(_, text)| labelled("advice", text)).collect()
    }

    /// Why so many cones, if nobody has said how many.
    fn number_text(&self) -> String {
        let Some(number) = &self.map.number else { return String::new() };
        let others: Vec<String> =
            self.beside().iter().map(|p| format!("{} cones {}", p.count, short(p.area_distortion, 2))).collect();
        let (predicted, target, reached) = (number.predicted, number.target, self.map.distortion.area_mean);
        let (of_each, shared) = match self.input.topology.components > 1 {
            true => (" on each part", "shared among parts by what they bring, as -n does: "),
            false => ("", ""),
        };
        let others = if others.is_empty() { String::new() } else { format!("; {shared}{}", others.join(", ")) };
        let target = match number.is_met {
            true => format!(", target {target}{of_each}"),
            false => format!(", {} reached: target {target}{of_each} not met", short(reached, 2)),
        };
        let text = format!("automatic: area distortion {} predicted{target}{others}", short(predicted, 2));
        labelled("number", &text)
    }
}

/// Above this a distortion is told by its power of ten alone.
const LARGE: f64 = 1e4;

/// A distortion in a few letters, with so many decimals.
fn short(distortion: f64, decimals: usize) -> String {
    if distortion < LARGE { format!("{distortion:.decimals$}") } else { format!("{distortion:.0e}") }
}

/// How cones and their curvatures are chosen.
pub(super) fn rule(options: &Options) -> String {
    let method = if options.cones.is_given() { "" } else { "method " };
    format!("{method}{}, {} curvatures", options.method_name(), options.angles_name())
}

impl UnwrapReport {
    /// Points of the curve to compare with: the powers of two nearest to the number of cones, at most four, from four on.
    fn beside(&self) -> Vec<&Prediction> {
        let taken = self.map.cones.len();
        let powers = self.map.curve.iter().filter(|p| p.count >= 4 && p.count.is_power_of_two() && p.count != taken);
        let mut nearest: Vec<&Prediction> = powers.collect();
        let far = |p: &&Prediction| (p.count.ilog2() as f64 - (taken.max(1) as f64).log2()).abs();
        nearest.sort_by(|p, q| far(p).total_cmp(&far(q)));
        nearest.truncate(4);
        nearest.sort_by_key(|p| p.count);
        nearest
    }
}

impl InputReport {
    fn text(&self) -> String {
        let mut parts = vec![
            counted(self.topology.vertices, "vertex", "vertices"),
            counted(self.topology.faces, "triangle", "triangles"),
            format!("genus {}", self.topology.genus),
        ];
        parts.push(match self.topology.boundary_loops {
            0 => "closed".to_owned(),
            1 => "1 boundary loop".to_owned(),
            loops => format!("{loops} boundary loops"),
        });
        if self.topology.components > 1 {
            parts.push(format!("{} parts", self.topology.components));
        }
        parts.join(", ")
    }
}

/// Lines on areas, angles and faults of a map, and on how much of the square is filled.
pub(crate) fn distortion_text(distortion: &DistortionReport, islands: usize) -> String {
    let fill = format!("{:.1} % of {}", 100.0 * distortion.fill, tiles_text(distortion.tiles));
    distortion_text_filling(distortion, islands, &fill)
}

/// The same where what is filled is told otherwise.
pub(crate) fn distortion_text_filling(distortion: &DistortionReport, islands: usize, fill: &str) -> String {
    let DistortionReport { area_mean, u_l2, u_linf, seam_length, quasi_conformal: qc, .. } = distortion;
    let islands = counted(islands, "island", "islands");
    let [flipped, degenerate] = [distortion.flipped, distortion.degenerate].map(thousands);
    let overlap = overlap_text(distortion.overlap);
    [
        labelled("area", &format!("distortion {} (log scale: L2 {u_l2:.3}, largest {u_linf:.2})", short(*area_mean, 3))),
        labelled(
            "angles",
            &format!(
                "quasi-conformal {} (95 % up to {}, largest {})",
                short(qc.mean, 4),
                short(qc.p95, 3),
                short(qc.max, 2)
            ),
        ),
        labelled(
            "layout",
            &format!(
                "{islands}, {flipped} flipped, {degenerate} degenerate, {overlap} overlapping, seams {seam_length:.2} √area"
            ),
        ),
        labelled("fill", fill),
    ]
    .concat()
}

/// What is filled.
pub(crate) fn tiles_text(tiles: Option<usize>) -> String {
    match tiles {
        Some(0 | 1) => "the square".to_owned(),
        Some(tiles) => format!("{tiles} tiles"),
        None => "the smallest square about it".to_owned(),
    }
}

/// The share that overlaps, and pairs where the grid sees none.
pub(crate) fn overlap_text(overlap: OverlapReport) -> String {
    match overlap.pairs {
        0 => "none".to_owned(),
        pairs if overlap.share == 0.0 => counted(pairs, "pair", "pairs"),
        _ => format!("{:.2} %", 100.0 * overlap.share),
    }
}

/// A repair as a sentence, with what could be done about it.
pub(crate) fn repair_text(repair: &Repair) -> String {
    let remedy = match repair.kind {
        RepairKind::Unwelded => "; --weld joins them",
        RepairKind::TJunction => "; --split-edges closes it",
        RepairKind::Welded => "; --weld=never leaves them",
        _ => "",
    };
    format!("{repair}{remedy}")
}
