//! What is done where a component's layout lies over itself.

use geom::Id;
use num_complex::Complex64;

use super::component::Component;
use super::flat::Flat;
use super::note::Note;
use super::observer::{Stage, Task, Times};
use super::options::{Islands, Options};
use super::reseaming::{Reseaming, map};
use crate::cut::SeamPlan;
use crate::error::Error;
use crate::uv::{NEGLIGIBLE_DEPTH, Overlaps, UvMap, overlaps_watched};

impl Component {
    /// Islands as they are written: parted where the layout lies over itself, and nearer to an isometry where seams may move.
    ///
    /// # Errors
    /// If the observer has said stop.
    pub(crate) fn finish(
        &self,
        flat: &mut Flat,
        (options, plan, share): (&Options, &SeamPlan, f64),
        task: &Task,
        times: &mut Times,
    ) -> Result<(), Error> {
        if options.islands == Islands::Single {
            self.free_seams(flat, options, task, times)?;
            return self.part_islands(flat, (options.islands, plan, share), task, times);
        }
        self.part_islands(flat, (options.islands, plan, share), task, times)?;
        self.free_seams(flat, options, task, times)
    }

    /// Opens the layout along other seams and takes it apart where it lies over itself, or says that it does. `share` is the component's
    /// of the model's area.
    ///
    /// # Errors
    /// If the observer has said stop.
    fn part_islands(
        &self,
        flat: &mut Flat,
        (islands, plan, share): (Islands, &SeamPlan, f64),
        task: &Task,
        times: &mut Times,
    ) -> Result<(), Error> {
        let mesh = &self.surface.mesh;
        let stage = (Stage::Islands, self.index);
        if islands == Islands::Single {
            let map = map(mesh, &flat.layout, &flat.seams.cut);
            let cut = &flat.layout.cut;
            let asked = |[f, g]: [u32; 2]| cut.island(geom::FaceId(f)) == cut.island(geom::FaceId(g));
            let overlaps =
                task.stage(stage, times, |watch| overlaps_watched(map.triangles(), NEGLIGIBLE_DEPTH, asked, watch))??;
            self.note_overlap(flat, &map, &overlaps);
            flat.notes.extend(self.note_avoided(plan, &flat.seams));
            return Ok(());
        }
        let done = task.stage(stage, times, |watch| {
            Reseaming::new(mesh, flat, plan, islands == Islands::Pack, share).best(watch)
        })??;
        self.note_overlap(flat, &done.map, &done.left);
        if done.map.cut == flat.seams.cut {
            flat.notes.extend(self.note_avoided(plan, &flat.seams));
            return Ok(());
        }
        let cut = done.map.opened(mesh);
        let mut opened = vec![Complex64::ZERO; cut.wedge_count()];
        for (h, [x, y]) in done.map.position.iter_ids() {
            opened[cut.wedge(h).index()] = Complex64::new(*x, *y);
        }
        flat.layout.cut = cut;
        flat.layout.position = opened;
        flat.seams.cut = done.map.cut;
        flat.seams.string(mesh, plan.lengths());
        flat.notes.extend(self.note_avoided(plan, &flat.seams));
        Ok(())
    }

    /// Says what lies over itself on the islands of a map of the layout.
    pub(super) fn note_overlap(&self, flat: &mut Flat, map: &UvMap, overlaps: &Overlaps) {
        let pairs = overlaps.pairs.len();
        if pairs > 0 {
            // Islands lie over each other, too, until they are packed.
            let share = match map.islands(&self.surface.mesh).count() {
                1 => overlaps.share(map.triangles()),
                _ => overlaps.pairs.iter().map(|pair| pair.area).sum::<f64>() / flat.layout.area(&self.surface.mesh),
            };
            let share = share.min(1.0);
            flat.notes.push(Note::Overlap { component: self.index, pairs, share });
        }
    }
}
