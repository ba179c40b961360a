//! Triangles of a map that take no room of their own.

use std::collections::HashMap;

use super::triangle::Triangle;

/// A corner: its vertex, and where it is in the plane.
pub(super) type Corner = (u32, [u64; 2]);

/// The corners of triangles, by which it is told whether they are the same ones, or lie side by side.
#[derive(Clone, Copy)]
pub(crate) struct Corners<'a> {
    /// The vertices of each triangle.
    pub(crate) vertices: &'a [[u32; 3]],
    /// Its image.
    pub(crate) uv: &'a [Triangle],
}

impl Corners<'_> {
    /// What corners that are the same have in common.
    pub(super) fn corner(self, t: u32, k: usize) -> Corner {
        // Adding 0 makes -0 positive.
        (self.vertices[t as usize][k], self.uv[t as usize][k].map(|x| (x + 0.0).to_bits()))
    }

    fn sorted(self, t: u32) -> [Corner; 3] {
        let mut corners = [0, 1, 2].map(|k| self.corner(t, k));
        corners.sort_unstable();
        corners
    }

    /// For each triangle the one whose room it shares: itself as a rule; of several with the same corners the first in `order`, which names all
    /// triangles; for one that has a vertex twice any that has a corner of it, if there is one.
    pub(crate) fn companions(self, order: impl IntoIterator<Item = u32>) -> Vec<Option<u32>> {
        let mut companions = vec![None; self.vertices.len()];
        let mut known = HashMap::with_capacity(self.vertices.len());
        let mut collapsed = Vec::new();
        for t in order {
            let own = self.sorted(t);
            if own[0].0 == own[1].0 || own[1].0 == own[2].0 {
                collapsed.push(t);
            } else {
                companions[t as usize] = Some(*known.entry(own).or_insert(t));
            }
        }
        if !collapsed.is_empty() {
            let mut of_corner: HashMap<Corner, u32> = HashMap::new();
            for t in leaders(&companions) {
                (0..3).for_each(|k| _ = of_corner.entry(self.corner(t, k)).or_insert(t));
            }
            for t in collapsed {
                companions[t as usize] = (0..3).find_map(|k| of_corner.get(&self.corner(t, k)).copied());
            }
        }
        companions
    }

    /// Numbers for some of the triangles, of which those that have two corners in common have the same one: from 0 in the order of their first.
    pub(crate) fn connected(self, triangles: &[u32]) -> Vec<u32> {
        let mut beside: Vec<Vec<usize>> = vec![Vec::new(); triangles.len()];
        let mut first: HashMap<[Corner; 2], usize> = HashMap::new();
        for (place, &t) in triangles.iter().enumerate() {
            let [a, b, c] = self.sorted(t);
            for ends in [[a, b], [b, c], [a, c]] {
                let other = *first.entry(ends).or_insert(place);
                if other != place {
                    beside[place].push(other);
                    beside[other].push(place);
                }
            }
        }
        let mut number = vec![None; triangles.len()];
        let mut next = 0;
        for start in 0..triangles.len() {
            let mut waiting = if number[start].is_none() { vec![start] } else { continue };
            while let Some(place) = waiting.pop() {
                if number[place].is_none() {
                    number[place] = Some(next);
                    waiting.extend(beside[place].iter().filter(|&&other| number[other].is_none()));
                }
            }
            next += 1;
        }
        number.into_iter().flatten().collect()
    }
}

/// The triangles that take room of their own, of their companions.
pub(crate) fn leaders(companions: &[Option<u32>]) -> Vec<u32> {
    (0..).zip(companions).filter_map(|(t, &companion)| (companion == Some(t)).then_some(t)).collect()
}
