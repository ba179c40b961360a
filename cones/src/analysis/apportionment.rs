//! Apportionment: how the connected components of a model share cones.
//!
//! Each part has a curve: its energy for every number of cones, times its area. On the lower convex hulls of the curves
//! every further cone brings less than the one before, so taking steps by what they bring for each cone is optimal at the
//! ends of hull edges, and with the same curves every total is a prefix of the next.
//!
//! Curves are known in blocks, as orders are found in blocks, and a hull must not depend on how far its curve is known:
//! so hulls have a corner wherever a block ends, and the totals of a nested order are prefixes of each other. For
//! [`Placement::Refined`], which has no order, up to a block of cones cheaper curves are found that
//! do depend on how far they go: there a part may get fewer cones of a larger total.

use std::sync::Arc;

use geom::{Interrupted, Watch};

use super::component::Component;
use super::instances::of_shapes;
use crate::curvature::least_cones;
use crate::field::Operators;
use crate::placement::{BLOCK, ConeSet, Nested, Placement, Search, Sharing, searched_order, whole_blocks};

/// What cones bring to one connected part.
#[derive(Clone, Debug)]
pub(crate) struct EnergyCurve {
    /// The area.
    area: f64,
    /// The energy with N cones, for N from 0 on; infinite where so many cannot take the part's curvature.
    energy: Vec<f64>,
}

impl EnergyCurve {
    /// The curve of an order of cones; `area` is that of the component in the model. Beyond the order's whole blocks the
    /// energy is taken to fall like 1/N, as it does about.
    fn of_order(operators: &Operators, nested: &Nested, area: f64, most: usize) -> Self {
        let least = least_cones(operators);
        let is_torus = !operators.is_bordered() && operators.mesh.euler_characteristic() == 0;
        // One cone on a torus can have no curvature.
        let allowed = |count: usize| count >= least && !(is_torus && count == 1);
        let energy = |(count, set): (usize, &ConeSet)| {
            if allowed(count) && set.shortfall == 0.0 { set.energy } else { f64::INFINITY }
        };
        let known = whole_blocks(operators, most);
        let mut energy: Vec<f64> = nested.sets.iter().enumerate().map(energy).collect();
        if energy.len() == known + 1 {
            let last = energy[known];
            energy.extend((known + 1..=most).map(|count| last * known as f64 / count as f64));
        }
        Self { area, energy }
    }
}

/// How many cones each component gets, `total` in all, or as many as all of them need.
///
/// # Errors
/// If the watch has said stop.
pub(crate) fn counts(
    components: &[Arc<Component>],
    (placement, search): (Placement, Search),
    total: usize,
    watch: Watch,
) -> Result<Vec<usize>, Interrupted> {
    let least: Vec<usize> = components.iter().map(|component| component.least()).collect();
    let spare = total.saturating_sub(least.iter().sum());
    if let [alone] = least[..] {
        return Ok(vec![total.max(alone)]);
    }
    if spare == 0 {
        return Ok(least);
    }
    let curves = |is_brief: bool| -> Result<Vec<EnergyCurve>, Interrupted> {
        let curve = |component: &Arc<Component>| {
            let most = component.least() + spare;
            let nested = searched_order(component.ground(search, watch), most, is_brief)?;
            Ok(EnergyCurve::of_order(&component.operators, &nested, component.area, most))
        };
        of_shapes(components, curve).into_iter().collect()
    };
    let sequence = match placement.sharing() {
        Sharing::BriefCurves => return Ok(at_least(share_out(&curves(true)?, total), &least)),
        Sharing::Curves => sequence(&curves(false)?, total),
        Sharing::Persistence => by_persistence(components, total),
    };
    let mut counts = vec![0; components.len()];
    sequence.into_iter().for_each(|p| counts[p] += 1);
    Ok(at_least(counts, &least))
}

fn at_least(counts: Vec<usize>, least: &[usize]) -> Vec<usize> {
    counts.into_iter().zip(least).map(|(count, &least)| count.max(least)).collect()
}

/// The components that get the first cone, the second, …, where each has such an order; up to where one of them is known no
/// further.
pub(crate) fn sequence_of(
    components: &[Arc<Component>],
    nested: &[Nested],
    placement: Placement,
    total: usize,
) -> Vec<usize> {
    let mut left: Vec<usize> = nested.iter().map(|order| order.cones().len()).collect();
    let is_all = |p: usize| nested[p].cones().len() == components[p].inner_vertices();
    let mut known = Vec::new();
    for p in longest_sequence_of(components, nested, placement, total) {
        left[p] -= 1;
        known.push(p);
        if left[p] == 0 && !is_all(p) {
            break;
        }
    }
    known
}

/// The same beyond that, where those whose orders end get no more.
pub(super) fn longest_sequence_of(
    components: &[Arc<Component>],
    nested: &[Nested],
    placement: Placement,
    total: usize,
) -> Vec<usize> {
    let mut left: Vec<usize> = nested.iter().map(|order| order.cones().len()).collect();
    if let [alone] = left[..] {
        return vec![0; total.min(alone)];
    }
    let curve = |(c, nested): (&Arc<Component>, &Nested)| {
        EnergyCurve::of_order(&c.operators, nested, c.area, nested.cones().len())
    };
    let sequence = match placement.sharing() {
        Sharing::BriefCurves | Sharing::Curves => {
            sequence(&components.iter().zip(nested).map(curve).collect::<Vec<EnergyCurve>>(), total)
        }
        Sharing::Persistence => by_persistence(components, total),
    };
    let is_there = |p: &usize| left[*p].checked_sub(1).map(|less| left[*p] = less).is_some();
    sequence.into_iter().filter(is_there).collect()
}

fn by_persistence(components: &[Arc<Component>], total: usize) -> Vec<usize> {
    let persistences = |c: &Arc<Component>| c.hierarchy.extrema().iter().map(|e| e.persistence).collect();
    let parts: Vec<(f64, Vec<f64>)> = components.iter().map(|c| (c.area, persistences(c))).collect();
    let limits: Vec<[usize; 2]> = components.iter().map(|c| [c.least(), c.inner_vertices()]).collect();
    sequence_by_persistence(&parts, &limits, total)
}

/// One edge of a hull: so many cones that each bring so much.
#[derive(Clone, Copy)]
struct Step {
    part: usize,
    from: usize,
    to: usize,
    gain: f64,
}

/// How many cones each part gets, `total` in all: first of all what each needs at least (the fewest with finite energy),
/// even where that is more than the total. Where a part has a number that it cannot have, the cones go to others.
fn share_out(parts: &[EnergyCurve], total: usize) -> Vec<usize> {
    let mut counts: Vec<usize> = parts.iter().map(least).collect();
    let mut left = total.saturating_sub(counts.iter().sum());
    for Step { part, from, to, .. } in steps(parts) {
        // Where the edge is too long for what is left, the part of it that is allowed.
        let reach = to.min(from + left);
        let allowed = |&count: &usize| parts[part].energy[count].is_finite();
        if counts[part] == from {
            counts[part] = (from..=reach).rev().find(allowed).unwrap_or(from);
            left -= counts[part] - from;
        }
    }
    counts
}

/// The parts that get the first cone, the second, … of `total`, or fewer if there are no more: what each needs first, the
/// largest part before the others, then by gain. As [`share_out`], but for the numbers that a part cannot have: they are
/// passed through.
fn sequence(parts: &[EnergyCurve], total: usize) -> Vec<usize> {
    let least: Vec<usize> = parts.iter().map(least).collect();
    let areas: Vec<f64> = parts.iter().map(|part| part.area).collect();
    let more = steps(parts).into_iter().flat_map(|step| std::iter::repeat_n(step.part, step.to - step.from));
    needed(&areas, &least).into_iter().chain(more).take(total).collect()
}

/// As [`sequence`], one by one where area times the persistence of the next extremum is largest. For each part its area,
/// the persistences of its extrema, and how many cones it must and can have.
fn sequence_by_persistence(parts: &[(f64, Vec<f64>)], limits: &[[usize; 2]], total: usize) -> Vec<usize> {
    let areas: Vec<f64> = parts.iter().map(|(area, _)| *area).collect();
    let mut counts: Vec<usize> = limits.iter().map(|[least, _]| *least).collect();
    let mut sequence = needed(&areas, &counts);
    while sequence.len() < total {
        let gain = |p: usize| parts[p].0 * parts[p].1.get(counts[p]).unwrap_or(&0.0);
        let open = (0..parts.len()).filter(|&p| counts[p] < limits[p][1]);
        let Some(best) = open.max_by(|&p, &q| gain(p).total_cmp(&gain(q)).then(q.cmp(&p))) else { break };
        counts[best] += 1;
        sequence.push(best);
    }
    sequence.truncate(total);
    sequence
}

/// What each part needs, the largest part first.
fn needed(areas: &[f64], least: &[usize]) -> Vec<usize> {
    let mut parts: Vec<usize> = (0..areas.len()).collect();
    parts.sort_by(|&p, &q| areas[q].total_cmp(&areas[p]).then(p.cmp(&q)));
    parts.into_iter().flat_map(|p| std::iter::repeat_n(p, least[p])).collect()
}

/// The fewest cones that a part can have.
fn least(part: &EnergyCurve) -> usize {
    part.energy.iter().position(|energy| energy.is_finite()).unwrap_or(0)
}

/// The edges of all hulls, what brings most first, those of a part in their order.
fn steps(parts: &[EnergyCurve]) -> Vec<Step> {
    let hulls: Vec<Vec<Step>> = parts.iter().enumerate().map(|(index, part)| hull(index, part)).collect();
    let mut at = vec![0; parts.len()];
    let mut steps = Vec::new();
    let mut next = |steps: &mut Vec<Step>| {
        let offered = hulls.iter().zip(&at).filter_map(|(hull, &at)| hull.get(at));
        let best = *offered.max_by(|a, b| a.gain.total_cmp(&b.gain).then(b.part.cmp(&a.part)))?;
        at[best.part] += 1;
        steps.push(best);
        Some(())
    };
    while next(&mut steps).is_some() {}
    steps
}

/// The edges of the lower convex hull of a part's curve, block by block, from its least number on.
fn hull(index: usize, part: &EnergyCurve) -> Vec<Step> {
    let gain = |from: usize, to: usize| part.area * (part.energy[from] - part.energy[to]) / (to - from) as f64;
    let mut corners: Vec<usize> = Vec::new();
    let mut first = 0;
    for count in (0..part.energy.len()).filter(|&count| part.energy[count].is_finite()) {
        while let [.., a, b] = corners[first..] {
            if gain(a, b) > gain(b, count) {
                break;
            }
            corners.pop();
        }
        corners.push(count);
        if count.is_multiple_of(BLOCK) {
            first = corners.len() - 1;
        }
    }
    let edges = corners.windows(2).map(|ends| (ends[0], ends[1]));
    edges.map(|(from, to)| Step { part: index, from, to, gain: gain(from, to) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placement::{EnergyModel, pursuit};
    use geom::Mesh;
    use geom::{Metric, shapes};
    use proptest::prelude::*;

    /// The least energy in all, over all ways to share.
    fn by_enumeration(parts: &[EnergyCurve], total: usize) -> f64 {
        let Some((first, others)) = parts.split_first() else { return if total == 0 { 0.0 } else { f64::INFINITY } };
        let with = |count: usize| first.area * first.energy[count] + by_enumeration(others, total - count);
        (0..first.energy.len().min(total + 1)).map(with).fold(f64::INFINITY, f64::min)
    }

    fn cost(parts: &[EnergyCurve], counts: &[usize]) -> f64 {
        parts.iter().zip(counts).map(|(part, &count)| part.area * part.energy[count]).sum()
    }

    prop_compose! {
        /// A convex curve, from a least number on.
        fn part()(area in 0.1..3.0f64, least in 0usize..4, drops in prop::collection::vec(0.01..1.0f64, 8)) -> EnergyCurve {
            let mut drops = drops;
            drops.sort_by(f64::total_cmp);
            let mut energy = vec![0.0];
            drops.iter().for_each(|drop| energy.push(energy[energy.len() - 1] + drop));
            energy.reverse();
            EnergyCurve { area, energy: [vec![f64::INFINITY; least], energy].concat() }
        }
    }

    proptest! {
        #[test]
        fn convex_curves_are_shared_out_in_the_best_way(parts in prop::collection::vec(part(), 1..4), more in 0usize..12) {
            let needed: usize = parts.iter().map(least).sum();
            let counts = share_out(&parts, needed + more);
            let expected = by_enumeration(&parts, counts.iter().sum());
            prop_assert!((cost(&parts, &counts) - expected).abs() < 1e-9);
        }

        #[test]
        fn every_total_is_a_prefix_of_the_next(parts in prop::collection::vec(part(), 1..5), total in 0usize..20) {
            let before = share_out(&parts, total);
            let after = share_out(&parts, total + 1);
            prop_assert!(before.iter().zip(&after).all(|(a, b)| a <= b));
        }
    }

    #[test]
    fn a_sequence_gives_every_total_and_does_not_depend_on_how_far_curves_are_known() {
        let energy = |rate: f64, n: usize| (1.0 + (n as f64).sin() / 20.0) / (1.0 + rate * n as f64);
        let parts = |most: usize| {
            let part = |(area, rate)| EnergyCurve { area, energy: (0..=most).map(|n| energy(rate, n)).collect() };
            [(1.0, 0.5), (0.3, 2.0), (2.0, 0.1)].map(part)
        };
        let longest = sequence(&parts(2 * BLOCK), 60);
        for total in 0..=60usize {
            assert_eq!(sequence(&parts(total.max(1).next_multiple_of(BLOCK)), total), longest[..total]);
            let count = |p: usize| longest[..total].iter().filter(|&&q| q == p).count();
            assert_eq!(share_out(&parts(2 * BLOCK), total), [0, 1, 2].map(count));
        }
    }

    #[test]
    fn by_persistence_parts_come_by_area_and_persistence_as_far_as_they_have_room() {
        let parts = [(1.0, vec![5.0, 4.0, 0.5]), (2.0, vec![9.0, 2.5, 1.0])];
        let limits = [[1, 3], [1, 5]];
        assert_eq!(sequence_by_persistence(&parts, &limits, 20), [1, 0, 1, 0, 1, 0, 1, 1]);
        assert_eq!(sequence_by_persistence(&parts, &limits, 3), [1, 0, 1]);
        let alike = [(1.0, vec![2.0, 1.0]), (1.0, vec![2.0, 1.0])];
        assert_eq!(sequence_by_persistence(&alike, &[[0, 2]; 2], 9), [0, 1, 0, 1], "of equals the first comes first");
    }

    #[test]
    fn a_part_gets_no_number_that_it_cannot_have() {
        let torus = EnergyCurve { area: 1.0, energy: vec![1.0, f64::INFINITY, 0.2, 0.15] };
        let disk = EnergyCurve { area: 1.0, energy: vec![0.5, 0.4, 0.35] };
        assert_eq!(share_out(&[torus.clone(), disk.clone()], 1), [0, 1]);
        assert_eq!(share_out(&[torus.clone(), disk.clone()], 2), [2, 0]);
        assert_eq!(share_out(&[torus, disk], 3), [2, 1]);
    }

    fn curve(operators: &Operators, mesh: &Mesh, most: usize) -> EnergyCurve {
        let nested = pursuit(&mut EnergyModel::new(operators, mesh), whole_blocks(operators, most));
        EnergyCurve::of_order(operators, &nested, 1.0, most)
    }

    #[test]
    fn curves_begin_with_what_a_part_needs_and_fall() {
        for (shape, allowed) in [
            (shapes::hare(500), vec![3, 4, 5, 6, 7]),
            (shapes::torus(1, 400), vec![0, 2, 3, 4, 5, 6, 7]),
            (shapes::terrain(400, 3), (0..8).collect()),
        ] {
            let mesh = shape.mesh();
            let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
            let part = curve(&operators, &mesh, 7);
            let finite: Vec<usize> = (0..8).filter(|&count| part.energy[count].is_finite()).collect();
            assert_eq!(finite, allowed);
            assert!(finite.windows(2).all(|pair| part.energy[pair[1]] <= part.energy[pair[0]] * (1.0 + 1e-9)));
        }
    }

    #[test]
    fn curves_go_on_beyond_what_is_computed() {
        let shape = shapes::square(900);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let part = curve(&operators, &mesh, 100);
        assert_eq!(part.energy.len(), 101);
        let shape = shapes::terrain(900, 3);
        let mesh = shape.mesh();
        let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).unwrap();
        let energy = curve(&operators, &mesh, 100).energy;
        assert!(energy[64] > 0.0 && (energy[100] - energy[64] * 0.64).abs() < 1e-12 * energy[64], "like 1/N");
    }

    #[test]
    fn each_part_gets_what_it_needs() {
        let sphere = EnergyCurve { area: 1.0, energy: [vec![f64::INFINITY; 3], vec![0.3, 0.2]].concat() };
        assert_eq!(share_out(&[sphere.clone(), sphere], 4), [3, 3]);
    }
}
