//! Distances of diagrams and their matchings, against what their definition says.

use proptest::prelude::*;
use topo::{Diagram, Error, Kind, Matching, Wasserstein};

type Point = (f64, f64);

fn norm(steps: &[f64], power: f64) -> f64 {
    match power {
        f64::INFINITY => steps.iter().copied().fold(0.0, f64::max),
        _ => steps.iter().map(|step| step.powf(power)).sum::<f64>().powf(power.recip()),
    }
}

/// The step between two points, or from one to the diagonal.
fn step(p: Option<Point>, q: Option<Point>, ground: f64) -> f64 {
    match (p, q) {
        (Some(p), Some(q)) => norm(&[(p.0 - q.0).abs(), (p.1 - q.1).abs()], ground),
        (Some(p), None) | (None, Some(p)) => norm(&[(p.1 - p.0).abs() / 2.0; 2], ground),
        (None, None) => 0.0,
    }
}

/// The least norm of all ways to match, by trying them.
fn least(a: &[Point], b: &[Point], order: f64, ground: f64, steps: &mut Vec<f64>) -> f64 {
    let Some((&first, rest)) = a.split_first() else {
        let alone = b.iter().map(|&point| step(Some(point), None, ground));
        return norm(&steps.iter().copied().chain(alone).collect::<Vec<_>>(), order);
    };
    let mut best = f64::INFINITY;
    for partner in (0..b.len()).map(Some).chain([None]) {
        let mut others = b.to_vec();
        let partner = partner.map(|place| others.remove(place));
        steps.push(step(Some(first), partner, ground));
        best = best.min(least(rest, &others, order, ground, steps));
        steps.pop();
    }
    best
}

/// A matching uses every point once, and its steps have the norm that it says.
fn check(matching: &Matching, a: &Diagram, b: &Diagram, order: f64, ground: f64) {
    for (side, diagram) in [a, b].into_iter().enumerate() {
        let mut used: Vec<usize> = matching.finite.iter().filter_map(|pair| pair[side]).collect();
        used.sort_unstable();
        assert!(used.into_iter().eq(0..diagram.finite.len()));
        let mut used: Vec<usize> = matching.essential.iter().map(|pair| pair[side]).collect();
        used.sort_unstable();
        assert!(used.into_iter().eq(0..diagram.essential.len()));
    }
    let finite = matching.finite.iter().map(|&[p, q]| step(p.map(|p| a.finite[p]), q.map(|q| b.finite[q]), ground));
    let essential = matching.essential.iter().map(|&[p, q]| (a.essential[p] - b.essential[q]).abs());
    let expected = norm(&finite.chain(essential).collect::<Vec<_>>(), order);
    assert!((matching.distance - expected).abs() <= 1e-9 * expected, "{} is not {expected}", matching.distance);
}

fn diagram(count: impl Into<prop::collection::SizeRange>) -> impl Strategy<Value = Diagram> {
    // On a raster, where many steps are equal, or anywhere; near the diagonal, on it, and far from it.
    let raster = (-4..=4i32, 0..=4i32).prop_map(|(birth, width)| (f64::from(birth), f64::from(birth + width)));
    let anywhere =
        (-4.0..4.0f64, prop_oneof![0.0..0.1f64, 0.0..4.0f64]).prop_map(|(birth, width)| (birth, birth + width));
    let finite =
        prop_oneof![proptest::collection::vec(raster, count.into()), proptest::collection::vec(anywhere, 0..6usize),];
    finite.prop_map(|finite| Diagram { kind: Kind::Minimum, finite, essential: vec![0.0] })
}

fn power() -> impl Strategy<Value = f64> {
    prop_oneof![Just(1.0), Just(2.0), Just(3.0), Just(1.5), Just(f64::INFINITY)]
}

/// Numbers in 0..1 that look random.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut bits = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        (bits >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn many(count: usize, seed: u64, width: impl Fn(f64) -> f64) -> Diagram {
    let mut random = random(seed);
    let point = |_| {
        let birth = random();
        (birth, birth + width(random()))
    };
    Diagram { kind: Kind::Minimum, finite: (0..count).map(point).collect(), essential: vec![seed as f64] }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn distances_are_the_least_of_all_matchings(a in diagram(0..5), b in diagram(0..6), order in power(), ground in power()) {
        let expected = least(&a.finite, &b.finite, order, ground, &mut Vec::new());
        let measure = Wasserstein::new(order).ground(ground);
        let matching = measure.matching(&a, &b).expect("alike");
        check(&matching, &a, &b, order, ground);
        prop_assert!((matching.distance - expected).abs() <= 1e-9 * expected);
        let distance = measure.distance(&a, &b).expect("alike");
        prop_assert!((distance - expected).abs() <= 1e-9 * expected);
    }
}

#[test]
fn an_auction_is_as_near_as_it_must_be() {
    let widths: [fn(f64) -> f64; 3] = [|x| x, |x| x.powi(6), |x| 5.0 + x];
    for (width, seed) in widths.into_iter().zip(1..) {
        for (rows, columns) in [(300, 300), (210, 350), (0, 250)] {
            let (a, b) = (many(rows, seed, width), many(columns, 10 + seed, width));
            for (order, ground) in [(1.0, f64::INFINITY), (2.0, 2.0), (2.5, 1.0)] {
                let measure = Wasserstein::new(order).ground(ground);
                let exact = measure.relative_error(0.0).matching(&a, &b).expect("alike");
                check(&exact, &a, &b, order, ground);
                for error in [0.5, 0.01, 1e-6, 1e-15] {
                    let near = measure.relative_error(error).matching(&a, &b).expect("alike");
                    check(&near, &a, &b, order, ground);
                    let part = near.distance / exact.distance;
                    assert!((1.0 - 1e-12..=1.0 + error + 1e-12).contains(&part), "{part} with {error}");
                }
            }
        }
    }
}

#[test]
fn diagrams_that_hardly_differ_are_told_apart() {
    let one = many(400, 5, |x| x);
    for change in [1e-3, 1e-6, 1e-12] {
        let mut random = random(9);
        let mut moved = |(birth, death): &Point| (birth + change * random(), death + change * random());
        let mut other = Diagram { finite: one.finite.iter().map(&mut moved).collect(), ..one.clone() };
        other.finite.reverse();
        for order in [1.0, 2.0] {
            let measure = Wasserstein::new(order);
            let near = measure.distance(&one, &other).expect("alike");
            let exact = measure.relative_error(0.0).distance(&one, &other).expect("alike");
            assert!((0.999..=1.011).contains(&(near / exact)), "{near} is not {exact}");
        }
    }
}

#[test]
fn equal_diagrams_of_many_equal_points_are_no_distance_apart() {
    let heap = Diagram { kind: Kind::Maximum, finite: vec![(3.0, 1.0); 300], essential: vec![] };
    let flat = Diagram { kind: Kind::Maximum, finite: vec![(2.0, 2.0); 300], essential: vec![] };
    for order in [1.0, 2.0, f64::INFINITY] {
        assert_eq!(heap.wasserstein(&heap, order), Ok(0.0));
        assert_eq!(flat.wasserstein(&flat, order), Ok(0.0));
    }
    assert_eq!(heap.wasserstein(&flat, 1.0), Ok(300.0));
    assert_eq!(heap.bottleneck(&flat), Ok(1.0));
}

#[test]
fn what_has_no_points_off_the_diagonal_is_of_either_kind() {
    let maxima = Diagram { kind: Kind::Maximum, finite: vec![(7.0, 2.0), (5.0, 4.0)], essential: vec![] };
    let minima = |finite: &[(f64, f64)], essential: &[f64]| Diagram {
        kind: Kind::Minimum,
        finite: finite.to_vec(),
        essential: essential.to_vec(),
    };
    for nothing in [minima(&[], &[]), minima(&[(3.0, 3.0)], &[])] {
        assert_eq!((maxima.bottleneck(&nothing), nothing.bottleneck(&maxima)), (Ok(2.5), Ok(2.5)));
        assert_eq!(maxima.wasserstein(&nothing, 1.0), Ok(3.0));
    }
    for other in [minima(&[(3.0, 4.0)], &[]), minima(&[], &[0.0])] {
        assert_eq!(maxima.bottleneck(&other), Err(Error::Directions));
    }
}

#[test]
fn numbers_of_any_size_are_compared() {
    for unit in [f64::MIN_POSITIVE, 1e-200, 1e200, 1e300] {
        let points = |count: usize| (0..count).map(|i| (0.0, unit * (1.0 + (i % 7) as f64))).collect();
        for (m, n) in [(3, 5), (250, 300)] {
            let [a, b] = [m, n].map(|count| Diagram { kind: Kind::Minimum, finite: points(count), essential: vec![] });
            for order in [1.0, 2.0, 50.0, f64::INFINITY] {
                let distance = a.wasserstein(&b, order).expect("alike");
                assert!(distance > 0.0 && distance.is_finite() && distance >= unit / 2.0, "{distance} of {unit}");
            }
        }
    }
    let wide = Diagram { kind: Kind::Minimum, finite: vec![(f64::MIN, f64::MAX); 2], essential: vec![] };
    let none = Diagram { kind: Kind::Minimum, finite: vec![], essential: vec![] };
    assert_eq!(wide.bottleneck(&none), Ok(f64::MAX));
    assert_eq!(Wasserstein::new(2.0).ground(1.0).distance(&wide, &none), Ok(f64::INFINITY));
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let of = |kind| Diagram { kind, finite: vec![(0.0, 1.0)], essential: vec![] };
    let (minima, maxima) = (of(Kind::Minimum), of(Kind::Maximum));
    assert_eq!(minima.bottleneck(&maxima), Err(Error::Directions));
    assert_eq!(minima.wasserstein(&maxima, 1.0), Err(Error::Directions));
    for order in [0.5, f64::NAN, f64::NEG_INFINITY] {
        assert_eq!(minima.wasserstein(&minima, order), Err(Error::Order));
        assert_eq!(Wasserstein::new(1.0).ground(order).distance(&minima, &minima), Err(Error::Order));
    }
    assert_eq!(Wasserstein::new(1.0).relative_error(-1.0).distance(&minima, &minima), Err(Error::RelativeError));
    let nan = Diagram { finite: vec![(0.0, 1.0), (f64::NAN, 0.0)], ..minima.clone() };
    assert_eq!(minima.bottleneck(&nan), Err(Error::Point { point: 1 }));
    let more = Diagram { essential: vec![1.0], ..minima.clone() };
    let unmatched = Wasserstein::new(2.0).matching(&minima, &more).expect("alike");
    assert_eq!(unmatched.distance, f64::INFINITY);
    assert!(unmatched.finite.is_empty() && unmatched.essential.is_empty());
}
