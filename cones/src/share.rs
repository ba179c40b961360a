//! Sharing out cones over the connected parts of a model.
//!
//! Each part has a curve: its energy for every number of cones, times its area. On the lower convex hulls of the curves
//! every further cone brings less than the one before, so taking steps by what they bring for each cone is optimal at the
//! ends of hull edges, and every total is a prefix of the next.

/// What cones bring to one connected part.
#[derive(Clone, Debug)]
pub struct Part {
    /// The area.
    pub area: f64,
    /// The energy with N cones, for N from 0 on; infinite where so many cannot take the part's curvature.
    pub energy: Vec<f64>,
}

/// One edge of a hull: so many cones that each bring so much.
struct Step {
    part: usize,
    from: usize,
    to: usize,
    gain: f64,
}

/// How many cones each part gets, `total` in all: first of all what each needs at least (the fewest with finite energy),
/// even where that is more than the total.
pub fn share_out(parts: &[Part], total: usize) -> Vec<usize> {
    let mut counts: Vec<usize> = parts.iter().map(least).collect();
    let mut left = total.saturating_sub(counts.iter().sum());
    let mut steps: Vec<Step> = parts.iter().enumerate().flat_map(|(index, part)| hull(index, part)).collect();
    steps.sort_by(|a, b| b.gain.total_cmp(&a.gain).then((a.part, a.from).cmp(&(b.part, b.from))));
    for Step { part, from, to, .. } in steps {
        debug_assert!(counts[part] <= from, "hull edges come in order");
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

/// The fewest cones that a part can have.
fn least(part: &Part) -> usize {
    part.energy.iter().position(|energy| energy.is_finite()).unwrap_or(0)
}

/// The edges of the lower convex hull of a part's curve, from its least number on.
fn hull(index: usize, part: &Part) -> Vec<Step> {
    let gain = |from: usize, to: usize| part.area * (part.energy[from] - part.energy[to]) / (to - from) as f64;
    let mut corners: Vec<usize> = Vec::new();
    for count in (0..part.energy.len()).filter(|&count| part.energy[count].is_finite()) {
        while let [.., a, b] = corners[..] {
            if gain(a, b) > gain(b, count) {
                break;
            }
            corners.pop();
        }
        corners.push(count);
    }
    let edges = corners.windows(2).map(|ends| (ends[0], ends[1]));
    edges.map(|(from, to)| Step { part: index, from, to, gain: gain(from, to) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The least energy in all, over all ways to share.
    fn by_enumeration(parts: &[Part], total: usize) -> f64 {
        let Some((first, others)) = parts.split_first() else { return if total == 0 { 0.0 } else { f64::INFINITY } };
        let with = |count: usize| first.area * first.energy[count] + by_enumeration(others, total - count);
        (0..first.energy.len().min(total + 1)).map(with).fold(f64::INFINITY, f64::min)
    }

    fn cost(parts: &[Part], counts: &[usize]) -> f64 {
        parts.iter().zip(counts).map(|(part, &count)| part.area * part.energy[count]).sum()
    }

    prop_compose! {
        /// A convex curve, from a least number on.
        fn part()(area in 0.1..3.0f64, least in 0usize..4, drops in prop::collection::vec(0.01..1.0f64, 8)) -> Part {
            let mut drops = drops;
            drops.sort_by(f64::total_cmp);
            let mut energy = vec![0.0];
            drops.iter().for_each(|drop| energy.push(energy[energy.len() - 1] + drop));
            energy.reverse();
            Part { area, energy: [vec![f64::INFINITY; least], energy].concat() }
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
    fn a_part_gets_no_number_that_it_cannot_have() {
        let torus = Part { area: 1.0, energy: vec![1.0, f64::INFINITY, 0.2, 0.15] };
        let disk = Part { area: 1.0, energy: vec![0.5, 0.4, 0.35] };
        assert_eq!(share_out(&[torus.clone(), disk.clone()], 1), [0, 1]);
        assert_eq!(share_out(&[torus.clone(), disk.clone()], 2), [2, 0]);
        assert_eq!(share_out(&[torus, disk], 3), [2, 1]);
    }

    #[test]
    fn each_part_gets_what_it_needs() {
        let sphere = Part { area: 1.0, energy: [vec![f64::INFINITY; 3], vec![0.3, 0.2]].concat() };
        assert_eq!(share_out(&[sphere.clone(), sphere], 4), [3, 3]);
    }
}
