//! The fans of triangles round vertices.

use super::{NONE, RUN, Soup, next, number, prev};
use crate::mesh::{Id, VertexId};
use crate::parallel::{all, map};
use crate::rows::Rows;
use crate::surface::repair::{RepairKind, RepairLog};

impl Soup {
    /// Numbers the fans: each is a vertex of its own. Returns the fan of each halfedge's tail and the vertex of each fan,
    /// which are in the order of the vertices.
    pub(in crate::surface) fn fans(&self, log: &mut RepairLog) -> (Vec<u32>, Vec<VertexId>) {
        if let Some(lone) = self.lone_fans() {
            return lone;
        }
        let mut fan = vec![NONE; self.tail.len()];
        let mut vertex: Vec<VertexId> = Vec::new();
        for corner in 0..self.tail.len() {
            if fan[corner] != NONE {
                continue;
            }
            let number = vertex.len() as u32;
            vertex.push(self.tail[corner]);
            // Counter-clockwise over twin(prev), then clockwise over next(twin).
            let mut h = corner;
            while fan[h] == NONE {
                fan[h] = number;
                match self.twin[prev(h)] {
                    NONE => break,
                    g => h = g as usize,
                }
            }
            h = corner;
            while self.twin[h] != NONE {
                h = next(self.twin[h] as usize);
                if fan[h] != NONE {
                    break;
                }
                fan[h] = number;
            }
        }
        let of_vertex = Rows::sorted(self.vertex_count, (0..).zip(&vertex).map(|(number, v)| (v.index(), number)));
        for v in (0..self.vertex_count).filter(|&v| of_vertex.row(v).len() > 1) {
            log.note(RepairKind::NonManifoldVertex, v);
        }
        let order = of_vertex.into_items();
        let mut rank = vec![0; order.len()];
        number(&order, &mut rank);
        fan.iter_mut().for_each(|fan| *fan = rank[*fan as usize]);
        (fan, order.into_iter().map(|number| vertex[number as usize]).collect())
    }

    /// The same where each vertex has one fan; none if one has several.
    fn lone_fans(&self) -> Option<(Vec<u32>, Vec<VertexId>)> {
        // How many halfedges start at each vertex, and one of them.
        let mut starting = vec![(0, 0); self.vertex_count];
        for (h, v) in self.tail.iter().enumerate() {
            let (count, any) = &mut starting[v.index()];
            (*count, *any) = (*count + 1, h as u32);
        }
        let is_lone = |v: usize| starting[v].0 == 0 || self.fan_size(starting[v].1 as usize) == starting[v].0;
        if !all(self.vertex_count, RUN, is_lone) {
            return None;
        }
        let vertex: Vec<VertexId> =
            (0..).map(VertexId).zip(&starting).filter(|(_, s)| s.0 > 0).map(|(v, _)| v).collect();
        let mut fan = vec![NONE; self.vertex_count];
        (0..).zip(&vertex).for_each(|(number, v)| fan[v.index()] = number);
        Some((map(self.tail.len(), |h| fan[self.tail[h].index()]), vertex))
    }

    /// How many halfedges the fan has that one is in.
    fn fan_size(&self, start: usize) -> u32 {
        let (mut h, mut size) = (start, 1);
        loop {
            match self.twin[prev(h)] {
                NONE => break,
                g if g as usize == start => return size,
                g => h = g as usize,
            }
            size += 1;
        }
        // It ends at the boundary: the rest is clockwise.
        h = start;
        while self.twin[h] != NONE {
            h = next(self.twin[h] as usize);
            size += 1;
        }
        size
    }
}
