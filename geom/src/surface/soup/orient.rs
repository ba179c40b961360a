//! Triangles turned until neighbours agree.

use std::collections::VecDeque;

use super::{NONE, RUN, Soup};
use crate::mesh::Id;
use crate::parallel::all;
use crate::surface::repair::{RepairKind, RepairLog};

impl Soup {
    /// Turns triangles until twins run in opposite directions; unglues them where that cannot be, but never inside a polygon.
    pub(in crate::surface) fn orient(&mut self, log: &mut RepairLog) {
        let is_oriented = |h: usize| self.twin[h] == NONE || !self.run_alike(h, self.twin[h] as usize);
        if all(self.tail.len(), RUN, is_oriented) {
            return;
        }
        let faces = self.triangle.len();
        let mut turned: Vec<Option<bool>> = vec![None; faces];
        let mut component = Vec::new();
        for seed in 0..faces {
            if turned[seed].is_some() {
                continue;
            }
            component.clear();
            self.turn_polygon((seed, false), &mut turned, &mut component);
            // Where neighbours disagree it is gone on last: what cannot be oriented is opened there.
            let mut disagreeing = VecDeque::new();
            let mut at = 0;
            loop {
                while at < component.len() {
                    let f: usize = component[at];
                    at += 1;
                    for h in 3 * f..3 * f + 3 {
                        let g = self.twin[h] as usize;
                        if self.twin[h] == NONE || turned[g / 3].is_some() {
                            continue;
                        }
                        match self.run_alike(h, g) {
                            true => disagreeing.push_back(h),
                            false => self.turn_polygon((g / 3, turned[f] == Some(true)), &mut turned, &mut component),
                        }
                    }
                }
                let Some(h) = disagreeing.pop_front() else { break };
                let g = self.twin[h] as usize;
                if turned[g / 3].is_none() {
                    self.turn_polygon((g / 3, turned[h / 3] == Some(false)), &mut turned, &mut component);
                }
            }
            // The way most of them were is the right way.
            let majority = component.iter().filter(|&&f| turned[f] == Some(true)).count() * 2 > component.len();
            for &f in &component {
                turned[f] = turned[f].map(|t| t ^ majority);
            }
        }
        for h in 0..self.tail.len() {
            let g = self.twin[h] as usize;
            if self.twin[h] != NONE && (turned[h / 3] != turned[g / 3]) != self.run_alike(h, g) {
                log.note(RepairKind::NonOrientableEdge, self.tail[h].index());
                self.twin[g] = NONE;
                self.twin[h] = NONE;
            }
        }
        let turned: Vec<usize> = (0..faces).filter(|&f| turned[f] == Some(true)).collect();
        self.note_faces(turned.iter().copied(), RepairKind::FlippedFace, log);
        turned.into_iter().for_each(|f| self.turn(f));
    }

    /// Decides whether a triangle is turned, and with it the others of its polygon, which share its corners: all are listed.
    fn turn_polygon(&self, (first, turns): (usize, bool), turned: &mut [Option<bool>], listed: &mut Vec<usize>) {
        let mut at = listed.len();
        turned[first] = Some(turns);
        listed.push(first);
        while at < listed.len() {
            let f = listed[at];
            at += 1;
            for h in 3 * f..3 * f + 3 {
                let g = self.twin[h] as usize;
                let is_inside = self.twin[h] != NONE && self.triangle[g / 3].1 == self.triangle[f].1;
                if is_inside && turned[g / 3].is_none() {
                    turned[g / 3] = turned[f].map(|f| f ^ self.run_alike(h, g));
                    listed.push(g / 3);
                }
            }
        }
    }

    /// Whether two halfedges with the same ends run in the same direction.
    fn run_alike(&self, h: usize, g: usize) -> bool {
        self.tail[h] == self.tail[g]
    }

    /// Reverses a triangle: corners 0, 1, 2 become 0, 2, 1, and so sides 01, 12, 20 become 02, 21, 10.
    fn turn(&mut self, f: usize) {
        let [a, b, c] = [3 * f, 3 * f + 1, 3 * f + 2];
        self.tail.swap(b, c);
        self.corner.swap(b, c);
        self.twin.swap(a, c);
        for h in [a, b, c] {
            let g = self.twin[h];
            if g != NONE {
                // A twin within the same triangle would be an edge with repeated ends, and there is none.
                self.twin[g as usize] = h as u32;
            }
        }
    }
}
