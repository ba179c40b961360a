//! Seams whose sides move for themselves, where rigid ones cost too much.
//!
//! The sides of a cone metric's seams are congruent, which lets islands be attached elsewhere and textures run on. On coarse triangles it
//! is dear: of all their linear images with rigid seams none bends angles much less than the metric's own. So once islands are as they are to be, the
//! layout is brought nearer to an isometry with all seams free ([`Relaxation`]). After each step what overlaps is looked up; a step that
//! brings about overlap is shortened, and in the end the corners that would lie over something are held where they are.

use std::collections::BTreeSet;

use geom::{EdgeData, FaceId, Id, Watch};
use num_complex::Complex64;

use super::attempts::RUINED;
use super::choosing::TARGET_DISTORTION;
use super::component::Component;
use super::flat::{Flat, Freed};
use super::note::Note;
use super::observer::{Stage, Task, Times};
use super::options::{FreeSeams, Islands, Options};
use super::quality::Quality;
use super::reseaming::map;
use crate::error::Error;
use crate::flatten::{Layout, Relaxation};
use crate::uv::overlaps_on_islands;

/// Above this quasi-conformal distortion seams are set free.
const COARSE: f64 = 1.1;
/// How much areas count beside angles: λ of [`Relaxation`]. The second where the first leaves more than was asked for, or than [`TARGET_DISTORTION`] where
/// nothing was.
const AREAS: [f64; 2] = [0.05, 0.15];
/// So many steps at most, those after which corners are held included.
const STEPS: usize = 60;
/// Corners that shorten a step to less than this are held, where it gains too little for another.
const BLOCKED: f64 = 0.125;
/// So often a step is halved where it brings about overlap, before corners are held.
const HALVINGS: usize = 2;

impl Options {
    /// Whether seams may become loose where triangles fold over.
    pub(super) fn may_loosen(&self) -> bool {
        self.free_seams != FreeSeams::Never && self.quantize.is_none()
    }

    /// Whether a layout is better with free seams.
    fn frees_seams(&self, flat: &Flat) -> bool {
        self.quantize.is_none()
            && match self.free_seams {
                FreeSeams::Auto => flat.quality.quasi_conformal > COARSE || flat.misses_areas,
                FreeSeams::Never => false,
                FreeSeams::Always => true,
            }
    }
}

impl Component {
    /// Sets a layout's seams free where that is asked for, or [`COARSE`] triangles ask for it.
    ///
    /// # Errors
    /// If the observer has said stop.
    pub(crate) fn free_seams(
        &self,
        flat: &mut Flat,
        options: &Options,
        task: &Task,
        times: &mut Times,
    ) -> Result<(), Error> {
        if flat.is_unfolded || !options.frees_seams(flat) {
            return Ok(());
        }
        let stage = (Stage::Layout, self.index);
        let freed = task.stage(stage, times, |watch| match self.kept(flat, watch)? {
            Some(kept) => Ok(Some(kept)),
            None => self.freed(flat, options, Some(options.islands), watch),
        })??;
        // Less may have been promised, where all may overlap.
        let now = freed.as_ref().map_or(&flat.quality, |(_, quality)| quality).area_distortion();
        flat.notes.retain(|note| !matches!(note, Note::TargetMissed { .. }));
        self.note_missed_target(flat, now, options);
        let Some((layout, quality)) = freed else { return Ok(()) };
        (flat.layout, flat.quality) = (layout, quality);
        flat.size = (-flat.quality.mean_log_scale()).exp() / self.surface.scale;
        let is_overlap = |note: &Note| matches!(note, Note::Overlap { .. });
        if options.islands != Islands::Single && flat.notes.iter().any(is_overlap) {
            // It may have come apart.
            let mesh = &self.surface.mesh;
            let map = map(mesh, &flat.layout, &flat.seams.cut);
            let overlaps = task.stage(stage, times, |watch| overlaps_on_islands(mesh, &map, watch))??;
            flat.notes.retain(|note| !is_overlap(note));
            self.note_overlap(flat, &map, &overlaps);
        }
        Ok(())
    }

    /// Finds what the layout is worth once its seams are free, if they are to be and nothing is in the way: of one that is [ruined](RUINED) too
    /// much would be.
    pub(super) fn promised(&self, flat: &mut Flat, options: &Options, watch: Watch) -> Result<(), Error> {
        if options.frees_seams(flat) && flat.quality.area_distortion() <= RUINED {
            let freed = self.freed(flat, options, None, watch)?;
            flat.freed = freed.map(|(layout, quality)| Freed { from: flat.layout.position.clone(), layout, quality });
        }
        flat.promised = flat.freed.as_ref().map_or(&flat.quality, |freed| &freed.quality).clone();
        Ok(())
    }

    /// What was promised, where the layout has stayed as it was and nothing overlaps.
    fn kept(&self, flat: &mut Flat, watch: Watch) -> Result<Option<(Layout, Quality)>, Error> {
        let mesh = &self.surface.mesh;
        let Some(freed) = flat.freed.take().filter(|freed| freed.from == flat.layout.position) else { return Ok(None) };
        for layout in [&flat.layout, &freed.layout] {
            if !overlaps_on_islands(mesh, &map(mesh, layout, &flat.seams.cut), watch)?.pairs.is_empty() {
                return Ok(None);
            }
        }
        Ok(Some((freed.layout, freed.quality)))
    }

    /// The layout with free seams, if that is better; `islands` as in [`relaxed`](Self::relaxed).
    fn freed(
        &self,
        flat: &Flat,
        options: &Options,
        islands: Option<Islands>,
        watch: Watch,
    ) -> Result<Option<(Layout, Quality)>, Error> {
        let target = options.cones.wanted().unwrap_or(TARGET_DISTORTION);
        let mut best: Option<(Layout, Quality)> = None;
        for areas in AREAS {
            let (first, before) =
                best.as_ref().map_or((&flat.layout, &flat.quality), |(layout, quality)| (layout, quality));
            let mut layout = first.clone();
            layout.position = self.relaxed((first, &flat.seams.cut), areas, islands, watch)?;
            let quality = Quality::of(&self.surface.mesh, &self.metric, &layout);
            let is_better = quality.cost() < before.cost(); // not so with NaN either
            if !is_better {
                break;
            }
            let is_done = quality.area_distortion() <= target;
            best = Some((layout, quality));
            if is_done {
                break;
            }
        }
        Ok(best)
    }

    /// The layout's positions, nearer to an isometry. What becomes of islands says what may overlap: with nothing said all may, in single
    /// islands what lies over itself already.
    fn relaxed(
        &self,
        (first, cut): (&Layout, &EdgeData<bool>),
        areas: f64,
        islands: Option<Islands>,
        watch: Watch,
    ) -> Result<Vec<Complex64>, Error> {
        let mesh = &self.surface.mesh;
        let mut layout = first.clone();
        let Some(mut relaxation) = Relaxation::new(mesh, &self.metric, &layout, areas) else {
            return Ok(layout.position);
        };
        let mut pairs = |position: Vec<Complex64>| -> Result<BTreeSet<[u32; 2]>, Error> {
            layout.position = position;
            let overlaps = overlaps_on_islands(mesh, &map(mesh, &layout, cut), watch)?;
            Ok(overlaps.pairs.iter().map(|pair| pair.triangles).collect())
        };
        // What lies over something already and could not be parted may go on to.
        let there = if islands.is_some() { pairs(relaxation.position())? } else { BTreeSet::new() };
        let may_overlap = islands.is_none_or(|islands| islands == Islands::Single && !there.is_empty());
        let mut overlapping = |position| -> Result<Vec<usize>, Error> {
            if may_overlap {
                return Ok(Vec::new());
            }
            let faces: BTreeSet<u32> = pairs(position)?.difference(&there).flatten().copied().collect();
            let corners = faces.into_iter().flat_map(|f| mesh.sides(FaceId(f)));
            Ok(corners.map(|h| first.cut.wedge(h).index()).collect())
        };
        for k in 0..STEPS {
            watch.ask(k as f64 / STEPS as f64)?;
            let direction = match relaxation.direction(watch) {
                Ok(Some(direction)) => direction,
                Err(geom::CholeskyError::Interrupted(_)) => return Err(Error::Interrupted),
                Ok(None) | Err(_) => break,
            };
            let Some((mut length, mut step)) = relaxation.step(&direction, 1.0) else { break };
            let mut over = overlapping(relaxation.unscaled(&step.position))?;
            let mut is_short = false;
            for _ in 0..HALVINGS {
                if over.is_empty() {
                    break;
                }
                let Some(shorter) = relaxation.step(&direction, 0.5 * length) else { break };
                (length, step) = shorter;
                is_short = true;
                over = overlapping(relaxation.unscaled(&step.position))?;
            }
            let to_hold = if !over.is_empty() {
                over
            } else if relaxation.take(step) || is_short {
                continue;
            } else if length < BLOCKED {
                // Needles that keep all the others from moving on.
                relaxation.in_the_way(&direction, BLOCKED)
            } else {
                break;
            };
            if to_hold.into_iter().filter(|&wedge| relaxation.hold(wedge)).count() == 0 {
                break;
            }
        }
        Ok(relaxation.position())
    }
}
