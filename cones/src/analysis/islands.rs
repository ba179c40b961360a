//! What is done where a component's layout lies over itself.

use std::collections::HashSet;

use geom::{EdgeData, FaceId, HalfedgeId, Id, Interrupted};
use num_complex::Complex64;

use super::component::Component;
use super::flat::Flat;
use super::note::Note;
use super::observer::{Stage, Task, Times};
use super::options::{Islands, Options};
use super::reseaming::{Reseaming, map};
use crate::cut::SeamPlan;
use crate::error::Error;
use crate::flatten::whole_polygons;
use crate::uv::{NEGLIGIBLE_DEPTH, Overlaps, UvMap, overlaps_on_islands, overlaps_watched};

/// Where other polygons lie over themselves once some are islands these become islands, too, so many times.
const ROUNDS: usize = 4;

/// How many pairs of triangles are said to lie over each other.
fn pairs_over_each_other(flat: &Flat) -> usize {
    let pairs = |note: &Note| if let Note::Overlap { pairs, .. } = note { *pairs } else { 0 };
    flat.notes.iter().map(pairs).sum()
}

impl Component {
    /// Islands as they are written: parted where the layout lies over itself, and nearer to an isometry where seams may move. Polygons that lie over
    /// themselves then become islands of their own.
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
        let before = self.surface.diagonal.contains(&true).then(|| flat.clone());
        self.part_islands(flat, (options.islands, plan, share), task, times)?;
        self.free_seams(flat, options, task, times)?;
        // No seam runs through a polygon.
        let Some(before) = before else { return Ok(()) };
        let mesh = &self.surface.mesh;
        let mut over_themselves = Vec::new();
        for _ in 0..ROUNDS {
            if pairs_over_each_other(flat) == 0 {
                break;
            }
            let more = task.stage((Stage::Islands, self.index), times, |watch| {
                let overlaps = overlaps_on_islands(mesh, &map(mesh, &flat.layout, &flat.seams.cut), watch)?;
                Ok::<_, Interrupted>(self.over_themselves(&overlaps, plan.lengths()))
            })??;
            over_themselves.extend(more);
            let Some(&first) = over_themselves.first() else { break };
            let mut other = before.clone();
            self.detach_polygons(&mut other, &over_themselves);
            other.notes.push(Note::PolygonsDetached {
                component: self.index,
                polygons: over_themselves.len(),
                first: self.surface.vertex[mesh.corners(first)[0]],
            });
            self.part_islands(&mut other, (options.islands, plan, share), task, times)?;
            self.free_seams(&mut other, options, task, times)?;
            if pairs_over_each_other(&other) >= pairs_over_each_other(flat) {
                break;
            }
            *flat = other;
        }
        Ok(())
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
            let asked = |[f, g]: [u32; 2]| cut.island(FaceId(f)) == cut.island(FaceId(g));
            let overlaps =
                task.stage(stage, times, |watch| overlaps_watched(map.triangles(), NEGLIGIBLE_DEPTH, asked, watch))??;
            self.note_overlap(flat, &map, &overlaps);
            flat.notes.extend(self.note_avoided(plan, &flat.seams));
            return Ok(());
        }
        let mut done = task.stage(stage, times, |watch| {
            Reseaming::new(mesh, flat, plan, islands == Islands::Pack, share).best(watch)
        })??;
        self.note_overlap(flat, &done.map, &done.left);
        self.shut(&mut done.map, &flat.cones, plan.given());
        flat.overlapped = done.overlaps.triangles().into_iter().map(FaceId).collect();
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

    /// A triangle of each polygon that lies over itself; `lengths` are infinite inside these.
    fn over_themselves(&self, overlaps: &Overlaps, lengths: &EdgeData<f64>) -> Vec<FaceId> {
        let mesh = &self.surface.mesh;
        let (mut found, mut known) = (Vec::new(), HashSet::new());
        for [f, g] in overlaps.pairs.iter().map(|pair| pair.triangles.map(FaceId)) {
            let is_diagonal = |&h: &HalfedgeId| lengths[mesh.edge(h)].is_infinite();
            if known.contains(&f) || !mesh.sides(f).iter().any(is_diagonal) {
                continue;
            }
            let polygon = whole_polygons(mesh, lengths, &[f]);
            if polygon.contains(&g) {
                known.extend(polygon);
                found.push(f);
            }
        }
        found
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

#[cfg(test)]
mod tests {
    use geom::Model;

    use super::super::options::ConeChoice;
    use super::super::{Analysis, Atlas};
    use super::*;

    /// A frame round a window, its front and back one polygon each, whose hole a slit joins to the bottom, with quads between them.
    fn window() -> Model {
        let outline = [
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.001, 1.0],
            [1.001, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
        ];
        let count = outline.len() as u32;
        let points = [0.0, 0.5].iter().flat_map(|&z| outline.map(|[x, y]| [x, y, z])).collect();
        let sides = (0..count).map(|i| vec![i, (i + 1) % count, count + (i + 1) % count, count + i]);
        let faces = [(0..count).rev().collect(), (count..2 * count).collect::<Vec<u32>>()].into_iter().chain(sides);
        Model::from_polygons(points, faces).unwrap()
    }

    fn atlas(islands: Islands) -> Atlas {
        let options = Options { cones: ConeChoice::Count(12), islands, ..Options::default() };
        Analysis::new(&window()).unwrap().atlas(&options).unwrap()
    }

    #[test]
    fn polygons_that_would_lie_over_themselves_become_islands_of_their_own() {
        let [single, free] = [Islands::Single, Islands::OverlapFree].map(atlas);
        let overlaps = |atlas: &Atlas| atlas.notes.iter().any(|note| matches!(note, Note::Overlap { .. }));
        let told = |note: &Note| matches!(note, Note::PolygonsDetached { component: 0, polygons: 1..=2, .. });
        assert!(overlaps(&single) && !single.notes.iter().any(told));
        assert!(!overlaps(&free) && free.notes.iter().any(told), "{:?}", free.notes);
        // The triangles of a polygon stay on one island.
        let of_polygon = |polygon: u32| -> Vec<u32> {
            let of = free.islands.iter().zip(&free.triangles.face_of);
            let mut islands: Vec<u32> =
                of.filter(|(_, face)| **face == polygon).map(|(island, _)| island.unwrap()).collect();
            islands.dedup();
            islands
        };
        assert!((0..13).all(|polygon| of_polygon(polygon).len() == 1));
        assert!(!free.detached.is_empty());
    }
}
