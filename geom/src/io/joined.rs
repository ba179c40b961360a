//! Vertices that a file has split, for its texture coordinates or its normals, joined again.

use std::collections::HashMap;

use crate::surface::Attribute;

/// Which vertex each one of a file becomes.
pub(super) struct Joined {
    of: Vec<u32>,
    count: usize,
}

impl Joined {
    /// By what the file says: the first vertices are themselves, each later one is a copy of one of these, at its place. None
    /// where that is not so, or nothing is split.
    pub(super) fn of_sources(sources: &[f64], points: &[[f64; 3]]) -> Option<Self> {
        let own = (0..sources.len()).take_while(|&v| sources[v] == v as f64).count();
        let is_copy = |v: usize| {
            let source = sources[v];
            source >= 0.0 && source < own as f64 && points.get(source as usize) == points.get(v)
        };
        let holds = own < sources.len() && sources.len() == points.len() && (own..points.len()).all(is_copy);
        holds.then(|| Self { of: sources.iter().map(|&source| source as u32).collect(), count: own })
    }

    /// By their places, as bits, in groups that stay apart; numbered by first appearance.
    pub(super) fn of_places<K: std::hash::Hash + Eq>(places: impl Iterator<Item = K>) -> Self {
        let mut numbers = HashMap::new();
        let of = places
            .map(|place| {
                let next = numbers.len() as u32;
                *numbers.entry(place).or_insert(next)
            })
            .collect();
        Self { of, count: numbers.len() }
    }

    /// Tables of the split vertices, whose corners are given, as tables of the joined ones.
    pub(super) fn tables(&self, tables: Vec<Attribute>, corners: &[u32]) -> Vec<Attribute> {
        let joined = |table: Attribute| {
            let is_of_vertices =
                table.domain() == crate::surface::AttributeDomain::Vertices && table.rows() == self.of.len();
            if is_of_vertices { table.joined(&self.of, self.count, corners) } else { table }
        };
        tables.into_iter().map(joined).collect()
    }

    /// Joins the vertices.
    pub(super) fn apply(&self, points: &mut Vec<[f64; 3]>, corners: &mut [u32]) {
        let mut joined = vec![None; self.count];
        for (point, &new) in points.iter().zip(&self.of) {
            joined[new as usize].get_or_insert(*point);
        }
        *points = joined.into_iter().map(Option::unwrap_or_default).collect();
        // What is out of range stays so, and is refused with its face.
        corners.iter_mut().for_each(|corner| *corner = self.of.get(*corner as usize).copied().unwrap_or(u32::MAX));
    }
}
