//! Both the components of a picture's sublevel sets and those of what they leave out, from one order.
//!
//! Basins of the one and basins of the other are the vertices and the faces of a graph in the plane, whose edges are *crossings*: saddles
//! where a way between two basins of earlier vertices crosses one between two basins of later vertices. Edges of a minimum spanning tree
//! are the edges that the maximum spanning tree of the dual graph lacks (Tutte 1984, "Graph Theory"). So a crossing that ends no
//! component closes a hole: crossings are put in order once, and whatever is left over from components pairs the holes, backwards.

use super::by_value;
use super::descent::Descent;
use super::elder_rule::{Components, enters_before};
use super::merges::Merge;
use crate::filtration::{Direction, Filtration};
use crate::parallel::{self, BLOCK};
use crate::scalar::Scalar;
use crate::watch::Watch;

/// A vertex at which something may merge in the picture, or in what is left out.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossing {
    pub(crate) saddle: u32,
    /// Two neighbours, or their basins: earlier ones, and the later ones between them.
    pub(crate) sides: [[u32; 2]; 2],
}

/// What becomes of the components of both, by rising index of their extrema; the eldest have no end. Of what is left out the last extremum
/// is the frame, which is no vertex and elder than all. Crossings come by rising index of the saddle. Nonsense if the work is stopped.
pub(crate) fn pair_both<S: Scalar, D: Direction>(
    filtration: &Filtration<'_, S, D>,
    descents: [&Descent; 2],
    mut crossings: Vec<Crossing>,
) -> [Vec<Merge>; 2] {
    lead_down(&mut crossings, descents, filtration.watch());
    let order = by_value::in_order(filtration, crossings.len(), |place| crossings[place as usize].saddle);
    let [inside, outside] = descents.map(Descent::extrema);
    let value = |&extremum: &u32| filtration.field()[extremum as usize];
    let births: Vec<S> = inside.iter().map(value).collect();
    let is_elder = |a: u32, b: u32| enters_before::<S, D>(&births, a, b);
    let mut components = Components::new(inside);
    let mut closing = Vec::with_capacity(outside.len());
    for &place in order.chunks(BLOCK).take_while(|_| !filtration.stops()).flatten() {
        let Crossing { saddle, sides } = crossings[place as usize];
        if components.join(saddle, sides[0], is_elder).is_none() {
            closing.push(place);
        }
    }
    let (vertices, frame) = (&outside[..outside.len() - 1], outside.len() as u32 - 1);
    let births: Vec<S> = vertices.iter().map(value).collect();
    let is_elder = |a: u32, b: u32| a == frame || b != frame && enters_before::<S, D>(&births, b, a);
    let mut left_out = Components::new(outside);
    for &place in closing.rchunks(BLOCK).take_while(|_| !filtration.stops()).flat_map(|places| places.iter().rev()) {
        let Crossing { saddle, sides } = crossings[place as usize];
        left_out.join(saddle, sides[1], is_elder);
    }
    [components.merges, left_out.merges]
}

/// Replaces the sides of crossings by their basins, unless the watch stops.
fn lead_down(crossings: &mut [Crossing], descents: [&Descent; 2], watch: Watch<'_>) {
    parallel::map_blocks(crossings, 1, &|_, crossings| {
        if watch.stops() {
            return;
        }
        for crossing in crossings {
            for (sides, descent) in crossing.sides.iter_mut().zip(descents) {
                *sides = sides.map(|side| descent.basin(side));
            }
        }
    });
}
