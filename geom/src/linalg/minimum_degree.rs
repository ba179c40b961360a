//! Orders of elimination of small sets, by minimum degree.
//!
//! The vertex with the fewest neighbours left is eliminated next, and joins these to each other (Tinney & Walker 1967). Neighbours
//! outside of the set are eliminated later; they count too (a *halo*: Pellegrini, Roman & Amestoy 2000), so that the set is
//! eliminated towards its rim. Degrees are exact: neighbourhoods are sets of bits, and joining them takes a few instructions.

use super::graph::Graph;

/// The set and its halo have at most so many vertices together; farther ones of the halo do not count.
const MOST: usize = 256;
const WORDS: usize = MOST / 64;
/// So many vertices can be ordered at a time.
pub(crate) const LARGEST_SET: usize = 128;

/// A set of places.
type Bits = [u64; WORDS];

/// The elimination of a small set of vertices of a graph.
pub(crate) struct MinimumDegree {
    /// The neighbours that each vertex of the set has left, by places: first the set, then its halo, both ascending.
    near: Vec<Bits>,
}

impl MinimumDegree {
    /// Of a set of no more than [`LARGEST_SET`] vertices, which becomes sorted.
    pub(crate) fn new(graph: &Graph, set: &mut [u32]) -> Self {
        debug_assert!(set.len() <= LARGEST_SET, "a larger set is split before");
        set.sort_unstable();
        let mut halo: Vec<u32> = Vec::new();
        for &v in &*set {
            halo.extend(graph.neighbors(v).iter().filter(|w| set.binary_search(w).is_err()));
        }
        halo.sort_unstable();
        halo.dedup();
        let place = |w: &u32| match set.binary_search(w) {
            Ok(place) => place,
            Err(_) => set.len() + halo.binary_search(w).unwrap_or(MOST),
        };
        let neighborhood = |&v: &u32| {
            let mut bits = [0; WORDS];
            for place in graph.neighbors(v).iter().map(place).filter(|&place| place < MOST) {
                bits[place / 64] |= 1 << (place % 64);
            }
            bits
        };
        Self { near: set.iter().map(neighborhood).collect() }
    }

    /// Sorts the set in the order of its elimination.
    pub(crate) fn sort(mut self, set: &mut [u32]) {
        let vertex = set.to_vec();
        let mut degree: Vec<u32> = self.near.iter().map(size).collect();
        for step in set {
            let next = (0..vertex.len()).min_by_key(|&k| degree[k]).unwrap_or(0);
            *step = vertex[next];
            degree[next] = u32::MAX;
            let joined = std::mem::take(&mut self.near[next]);
            for place in members(&joined).take_while(|&place| place < vertex.len()) {
                let near = &mut self.near[place];
                near.iter_mut().zip(joined).for_each(|(near, joined)| *near |= joined);
                remove(near, place);
                remove(near, next);
                degree[place] = size(near);
            }
        }
    }
}

fn size(bits: &Bits) -> u32 {
    bits.iter().map(|word| word.count_ones()).sum()
}

fn remove(bits: &mut Bits, place: usize) {
    bits[place / 64] &= !(1 << (place % 64));
}

/// The members of a set, ascending.
fn members(bits: &Bits) -> impl Iterator<Item = usize> {
    bits.iter().enumerate().flat_map(|(k, &word)| {
        let rest = |word: &u64| Some(word & (word - 1)).filter(|&word| word != 0);
        let words = std::iter::successors(Some(word).filter(|&word| word != 0), rest);
        words.map(move |word| 64 * k + word.trailing_zeros() as usize)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_that_leads_out_of_the_set_is_eliminated_towards_its_halo() {
        let near = |v: u32| [v.checked_sub(1), (v < 9).then_some(v + 1)].into_iter().flatten();
        let graph = Graph::from_rows((0..10).map(near));
        let mut set = [3, 0, 2, 1, 4];
        MinimumDegree::new(&graph, &mut set).sort(&mut set);
        assert_eq!(set, [0, 1, 2, 3, 4]);
    }

    #[test]
    fn each_step_has_the_fewest_neighbors_left() {
        // Also with a halo that is larger than what counts of it.
        for n in [1, 40, 128] {
            let near = |v: u32| {
                (0..n).filter(move |&w| w != v && (v * w + v + w).is_multiple_of(7)).chain(n..n + 10 * (v % 40))
            };
            let mut graph_rows: Vec<Vec<u32>> = (0..n).map(|v| near(v).collect()).collect();
            graph_rows.resize(n as usize + 400, Vec::new());
            let graph = Graph::from_rows(graph_rows.into_iter());
            let mut set: Vec<u32> = (0..n).rev().collect();
            MinimumDegree::new(&graph, &mut set).sort(&mut set);
            let mut left: Vec<std::collections::BTreeSet<u32>> =
                (0..n).map(|v| near(v).filter(|&w| w < MOST as u32).collect()).collect();
            let mut order = set.clone();
            for (k, &v) in set.iter().enumerate() {
                assert!(set[k..].iter().all(|&w| left[w as usize].len() >= left[v as usize].len()));
                let joined = std::mem::take(&mut left[v as usize]);
                for &w in joined.iter().filter(|&&w| w < n) {
                    left[w as usize].extend(&joined);
                    left[w as usize].retain(|&x| x != v && x != w);
                }
            }
            order.sort_unstable();
            assert!(order.into_iter().eq(0..n));
        }
    }
}
