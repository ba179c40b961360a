//! Laws of packings, checked triangle by triangle.

use super::*;
use proptest::prelude::*;
use std::f64::consts::PI;

type Triangle = [[f64; 2]; 3];

/// The squared distance of a point to a segment.
fn to_segment(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length = u[0] * u[0] + u[1] * u[1];
    let t = if length > 0.0 { ((u[0] * v[0] + u[1] * v[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
    (v[0] - t * u[0]).powi(2) + (v[1] - t * u[1]).powi(2)
}

fn sides([a, b, c]: Triangle) -> [[[f64; 2]; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

fn left([a, b]: [[f64; 2]; 2], p: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

fn contains(triangle: Triangle, p: [f64; 2]) -> bool {
    let signs = sides(triangle).map(|side| left(side, p));
    signs.iter().all(|x| *x > 0.0) || signs.iter().all(|x| *x < 0.0)
}

fn cross(e: [[f64; 2]; 2], f: [[f64; 2]; 2]) -> bool {
    left(e, f[0]) * left(e, f[1]) < 0.0 && left(f, e[0]) * left(f, e[1]) < 0.0
}

/// The distance of two triangles: 0 where they meet.
fn distance(t: Triangle, s: Triangle) -> f64 {
    if contains(t, s[0]) || contains(s, t[0]) || sides(t).iter().any(|&e| sides(s).iter().any(|&f| cross(e, f))) {
        return 0.0;
    }
    let one_way = |t: Triangle, s: Triangle| {
        t.into_iter().flat_map(|p| sides(s).map(|side| to_segment(p, side))).fold(f64::MAX, f64::min)
    };
    one_way(t, s).min(one_way(s, t)).sqrt()
}

/// Asserts what holds for any packing; returns the placed triangles.
fn check(triangles: &[Triangle], island: &[u32], options: &PackOptions) -> (Packing, Vec<Triangle>) {
    let packing = pack(triangles, island, options, Watch::NONE).unwrap();
    let place = |(t, &i): (&Triangle, &u32)| t.map(|p| packing.place(i as usize, p));
    let placed: Vec<Triangle> = triangles.iter().zip(island).map(place).collect();
    let texel = 1.0 / f64::from(options.texture_size);
    let border = 0.5 * packing.margin * texel - 1e-9;
    for (t, &i) in placed.iter().zip(island) {
        let tile = packing.places[i as usize].tile;
        let corner = [tile % 10, tile / 10].map(f64::from);
        let inside = |p: &[f64; 2]| (0..2).all(|k| p[k] - corner[k] >= border && p[k] - corner[k] <= 1.0 - border);
        assert!(t.iter().all(inside), "{t:?} leaves tile {tile}");
        let [c, s] = packing.places[i as usize].turn;
        assert!((c.hypot(s) - 1.0).abs() < 1e-12);
    }
    for (k, (t, i)) in placed.iter().zip(island).enumerate() {
        for (s, j) in placed.iter().zip(island).take(k).filter(|(_, j)| *j != i) {
            let distance = distance(*t, *s);
            assert!(
                distance >= packing.margin * texel - 1e-9,
                "islands {i} and {j} are {} texels apart",
                distance / texel
            );
        }
    }
    (packing, placed)
}

/// A fan of triangles about a point: a star-shaped island with bays.
fn star(centre: [f64; 2], radii: &[f64]) -> Vec<Triangle> {
    let count = radii.len();
    let corner = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / count as f64;
        [centre[0] + radii[k % count] * angle.cos(), centre[1] + radii[k % count] * angle.sin()]
    };
    (0..count).map(|k| [centre, corner(k), corner(k + 1)]).collect()
}

fn islands(stars: &[Vec<Triangle>]) -> (Vec<Triangle>, Vec<u32>) {
    let numbered = (0..).zip(stars).flat_map(|(i, star)| star.iter().map(move |&t| (t, i)));
    numbered.unzip()
}

fn random_stars() -> impl Strategy<Value = Vec<Vec<Triangle>>> {
    let shape = ([-9.0..9.0f64, -9.0..9.0], prop::collection::vec(0.05..1.0f64, 3..9), -2.0..1.0f64);
    let one =
        shape.prop_map(|(centre, radii, size)| star(centre, &radii.iter().map(|r| r * size.exp()).collect::<Vec<_>>()));
    prop::collection::vec(one, 1..14)
}

fn random_options() -> impl Strategy<Value = PackOptions> {
    let rotations = prop_oneof![Just(Rotations::None), Just(Rotations::Quarter), Just(Rotations::Any)];
    (rotations, 0.0..20.0f64, prop_oneof![Just(256u32), Just(1024)]).prop_map(|(rotations, margin, texture_size)| {
        PackOptions { texture_size, margin, rotations, ..PackOptions::default() }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn islands_keep_their_margin_and_stay_in_the_square(stars in random_stars(), options in random_options()) {
        let (triangles, island) = islands(&stars);
        let (packing, placed) = check(&triangles, &island, &options);
        prop_assert_eq!(packing.tiles, 1);
        let area = |t: &Triangle| 0.5 * left([t[0], t[1]], t[2]);
        for (before, after) in triangles.iter().zip(&placed) {
            let expected = packing.scale.powi(2) * area(before);
            prop_assert!((area(after) - expected).abs() < 1e-10, "{} {expected}", area(after));
        }
        let covered: f64 = placed.iter().map(|t| area(t).abs()).sum();
        prop_assert!((covered - packing.fill).abs() < 1e-9);
    }

    #[test]
    fn tiles_take_islands_at_their_density(stars in random_stars(), density in 60.0..150.0f64) {
        let (triangles, island) = islands(&stars);
        let options = PackOptions {
            texture_size: 1024,
            tiles: Tiles::Udim { texel_density: density },
            ..PackOptions::default()
        };
        let (packing, _) = check(&triangles, &island, &options);
        prop_assert!((packing.scale * 1024.0 / density - 1.0).abs() < 1e-12);
        let mut tiles: Vec<u32> = packing.places.iter().map(|motion| motion.tile).collect();
        tiles.sort_unstable();
        tiles.dedup();
        prop_assert_eq!(tiles, (0..packing.tiles as u32).collect::<Vec<_>>());
    }

    /// Trial packings one after the other, of different islands and so on different grids, are those that each would be alone.
    #[test]
    fn cells_that_were_kept_are_those_made_anew(stars in random_stars(), options in random_options()) {
        let boundary = |star: &Vec<Triangle>| Side {
            edges: star.iter().map(|t| [t[1], t[2]]).collect(),
            area: star.iter().map(|t| 0.5 * left([t[0], t[1]], t[2])).sum(),
        };
        let sides: Vec<Side> = stars.iter().map(boundary).collect();
        let all: Vec<&Side> = sides.iter().collect();
        let kept = Rough::new(&all, &options);
        let halves = |rough: &Rough, side: &Side| [0.5, 2.0].map(|height| {
            let flat = |[x, y]: [f64; 2]| [x, height * y];
            let edges = side.edges.iter().map(|edge| edge.map(flat)).collect();
            rough.piece(&Side { edges, area: height * side.area })
        });
        let of_kept: Vec<_> = sides.iter().map(|side| halves(&kept, side)).collect();
        for k in 0..sides.len() {
            let places = [k, (k + 1) % sides.len()];
            for places in [&places[..1], &places[..sides.len().min(2)]] {
                let made = Rough::new(&all, &options);
                let anew: Vec<_> = places.iter().map(|&k| (k, halves(&made, &sides[k]))).collect();
                let anew: Vec<_> = anew.iter().map(|(k, halves)| (*k, halves)).collect();
                let again: Vec<_> = places.iter().map(|&k| (k, &of_kept[k])).collect();
                let [again, anew] = [(&kept, again), (&made, anew)].map(|(rough, others)| rough.fill_with(&others, Watch::NONE));
                prop_assert_eq!(again.unwrap(), anew.unwrap());
            }
        }
        prop_assert_eq!(kept.fill(Watch::NONE).unwrap(), Rough::new(&all, &options).fill(Watch::NONE).unwrap());
    }

    #[test]
    fn size_and_place_of_the_input_do_not_matter(exponent in -12..12i32) {
        let stars: Vec<_> = (0..5).map(|k| star([3.0 * f64::from(k), 1.0], &[1.0, 0.4, 0.8, 0.5, 1.0, 0.3])).collect();
        let (triangles, island) = islands(&stars);
        let scale = 10f64.powi(exponent);
        let scaled: Vec<Triangle> = triangles.iter().map(|t| t.map(|p| p.map(|x| scale * x))).collect();
        let [(one, _), (other, _)] = [&triangles, &scaled].map(|t| check(t, &island, &PackOptions::default()));
        prop_assert!((one.fill - other.fill).abs() < 0.02, "{} {}", one.fill, other.fill);
    }
}

#[test]
fn a_square_fills_its_tile_up_to_half_the_margin() {
    let turned = Complex64::cis(0.3);
    let corner = |x: f64, y: f64| {
        let z = turned * Complex64::new(x, y);
        [z.re + 40.0, z.im]
    };
    let [a, b, c, d] = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
    let (packing, _) = check(&[[a, b, c], [a, c, d]], &[0, 0], &PackOptions::default());
    let side: f64 = 1.0 - 4.0 / 1024.0;
    assert!((packing.fill - side * side).abs() < 1e-9, "{}", packing.fill);
}

/// A rectangle that is turned by an angle.
fn plank([x, y]: [f64; 2], [width, height]: [f64; 2], angle: f64) -> Vec<Triangle> {
    let corner = |u: f64, v: f64| {
        let z = Complex64::cis(angle) * Complex64::new(u * width, v * height);
        [x + z.re, y + z.im]
    };
    let [a, b, c, d] = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
    vec![[a, b, c], [a, c, d]]
}

/// How far the long sides of placed planks are from running along an axis.
fn slant(placed: &[Triangle]) -> f64 {
    let off = |t: &Triangle| (t[0][0] - t[1][0]).abs().min((t[0][1] - t[1][1]).abs());
    placed.iter().step_by(2).map(off).fold(0.0, f64::max)
}

const ROTATIONS: [Rotations; 3] = [Rotations::None, Rotations::Quarter, Rotations::Any];

#[test]
fn planks_lie_along_the_axes_where_they_need_not_lie_as_they_did() {
    let planks: Vec<_> = (1..8).map(|k| plank([f64::from(k), 0.0], [3.0, 0.2 * f64::from(k)], f64::from(k))).collect();
    for count in [1, 7] {
        let (triangles, island) = islands(&planks[..count]);
        for rotations in &ROTATIONS[..2] {
            let options = |align| PackOptions { rotations: *rotations, align, ..PackOptions::default() };
            let (_, placed) = check(&triangles, &island, &options(true));
            assert!(slant(&placed) < 1e-12, "{rotations:?} {}", slant(&placed));
            let (given, placed) = check(&triangles, &island, &options(false));
            assert!(slant(&placed) > 0.01);
            let angle = |place: &IslandPlace| {
                place.angle().rem_euclid(if *rotations == Rotations::None { 4.0 } else { PI / 2.0 })
            };
            assert!(given.places.iter().all(|place| angle(place) == 0.0));
        }
    }
}

#[test]
fn an_island_without_straight_sides_has_the_smallest_square_there_is() {
    let round: Vec<f64> = (0..60).map(|k| if k % 30 < 15 { 1.0 } else { 2.0 }).collect();
    let (triangles, island) = islands(&[star([0.0, 0.0], &round)]);
    let fill = |rotations| {
        check(&triangles, &island, &PackOptions { rotations, align: true, ..PackOptions::default() }).0.fill
    };
    let [none, quarter, any] = ROTATIONS.map(fill);
    assert!((none - any).abs() < 1e-9 && quarter == none, "{none} {quarter} {any}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn who_may_turn_islands_further_fills_no_less(stars in random_stars(), options in random_options(), align: bool) {
        let (triangles, island) = islands(&stars);
        let fill = |rotations| check(&triangles, &island, &PackOptions { rotations, align, ..options }).0.fill;
        let fills = ROTATIONS.map(fill);
        prop_assert!(fills.is_sorted(), "{fills:?}");
    }

    #[test]
    fn packing_again_fills_no_less_and_keeps_nothing_that_is_too_near(
        stars in random_stars(), options in random_options(), [dx, dy] in [-0.3..0.3f64, -0.3..0.3]
    ) {
        let (triangles, island) = islands(&stars);
        let (first, placed) = check(&triangles, &island, &PackOptions { rotations: Rotations::Any, ..options });
        let (again, _) = check(&placed, &island, &options);
        prop_assert!(again.fill >= first.fill * (1.0 - 1e-9), "{} {}", again.fill, first.fill);
        let moved = |(t, &i): (&Triangle, &u32)| if i == 0 { t.map(|[x, y]| [x + dx, y + dy]) } else { *t };
        let moved: Vec<Triangle> = placed.iter().zip(&island).map(moved).collect();
        check(&moved, &island, &options);
    }
}

#[test]
fn an_island_within_another_that_is_larger_is_not_left_there() {
    let [large, small] = [1.0, 0.3].map(|size| star([0.0, 0.0], &[size; 12]));
    let (triangles, island) = islands(&[large, small]);
    check(&triangles, &island, &PackOptions::default());
}

#[test]
fn small_islands_lie_in_the_hole_of_a_large_one() {
    let ring = |r: f64| (0..40).map(move |k| Complex64::from_polar(r, std::f64::consts::TAU * f64::from(k) / 40.0));
    let (inner, outer): (Vec<_>, Vec<_>) = (ring(0.8).collect(), ring(1.0).collect());
    let at = |z: Complex64| [z.re, z.im];
    let mut triangles: Vec<Triangle> = Vec::new();
    for k in 0..40 {
        let next = (k + 1) % 40;
        triangles.push([at(inner[k]), at(outer[k]), at(outer[next])]);
        triangles.push([at(inner[k]), at(outer[next]), at(inner[next])]);
    }
    let mut island = vec![0; triangles.len()];
    for i in 1..4 {
        triangles.extend(star([9.0, 0.0], &[0.3; 12]));
        island.resize(triangles.len(), i);
    }
    let (packing, placed) = check(&triangles, &island, &PackOptions::default());
    let ring: f64 = packing.scale * 2.0;
    assert!(ring > 0.97, "the ring's diameter is {ring} of the square's side");
    let centre = packing.place(0, [0.0, 0.0]);
    for (t, _) in placed.iter().zip(&island).filter(|(_, i)| **i > 0) {
        assert!(t.iter().all(|p| (p[0] - centre[0]).hypot(p[1] - centre[1]) < 0.4 * ring));
    }
}

#[test]
fn islands_without_area_have_a_place_too() {
    let point = [[3.0, 3.0]; 3];
    let line = [[0.0, 0.0], [1.0, 0.0], [0.25, 0.0]];
    let needle = [[0.0, 0.0], [1e6, 0.0], [1e6, 1.0]];
    check(&[point], &[0], &PackOptions::default());
    check(&[point, point, point], &[0, 1, 2], &PackOptions::default());
    check(&[line, point, line], &[0, 1, 2], &PackOptions::default());
    check(&[needle, line, point, needle], &[0, 1, 2, 3], &PackOptions::default());
}

#[test]
fn nothing_packs_into_nothing() {
    let packing = pack(&[], &[], &PackOptions::default(), Watch::NONE).unwrap();
    assert_eq!((packing.places.len(), packing.fill, packing.tiles), (0, 0.0, 0));
    // Numbers that no triangle has are islands without anything.
    let (packing, _) = check(&[[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]; 3], &[2; 3], &PackOptions::default());
    assert_eq!(packing.places.len(), 3);
}

#[test]
fn thousands_of_islands_keep_their_margin() {
    let size = |k: u32| 0.2 + f64::from(k * 7919 % 1000) / 1000.0;
    let stars: Vec<_> = (0..5000).map(|k| star([0.0, 0.0], &[size(k), 0.3, size(k / 2)])).collect();
    let (triangles, island) = islands(&stars);
    let packing = pack(&triangles, &island, &PackOptions::default(), Watch::NONE).unwrap();
    let place = |(t, &i): (&Triangle, &u32)| t.map(|p| packing.place(i as usize, p));
    let placed: Vec<Triangle> = triangles.iter().zip(&island).map(place).collect();
    let mut low: Vec<(f64, usize)> =
        placed.iter().enumerate().map(|(k, t)| (t.iter().map(|p| p[0]).fold(2.0, f64::min), k)).collect();
    low.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(placed.iter().flatten().flatten().all(|x| (0.0..=1.0).contains(x)));
    let gap = packing.margin / 1024.0;
    for (at, &(_, k)) in low.iter().enumerate() {
        let high = placed[k].iter().map(|p| p[0]).fold(0.0, f64::max) + gap;
        for &(_, j) in low[at + 1..].iter().take_while(|(x, _)| *x < high).filter(|(_, j)| island[*j] != island[k]) {
            assert!(distance(placed[k], placed[j]) > gap - 1e-9);
        }
    }
    assert!(packing.fill > 0.15, "{}", packing.fill);
}

#[test]
fn what_cannot_be_packed_is_said_by_name() {
    let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let refused = |options: PackOptions| pack(&[triangle], &[0], &options, Watch::NONE).unwrap_err();
    let density = |texel_density| PackOptions { tiles: Tiles::Udim { texel_density }, ..PackOptions::default() };
    assert!(matches!(refused(density(2000.0)), PackError::TooLarge { island: 0, times, .. } if times > 1.0));
    assert_eq!(refused(density(-1.0)), PackError::Density(-1.0));
    let margin = PackOptions { margin: 256.0, ..PackOptions::default() };
    assert_eq!(refused(margin), PackError::Margin { margin: 256.0, texture_size: 1024 });
    assert!(matches!(refused(PackOptions { margin: f64::NAN, ..margin }), PackError::Margin { .. }));
    let told = |margin| refused(PackOptions { margin, ..PackOptions::default() }).to_string();
    for (margin, shown) in [(256.5, "256.5"), (-1.0, "-1"), (1e155, "1e155"), (f64::INFINITY, "inf")] {
        assert!(told(margin).starts_with(&format!("a margin of {shown} texels")), "{}", told(margin));
    }
    let counts = pack(&[triangle], &[0, 1], &PackOptions::default(), Watch::NONE);
    assert_eq!(counts.unwrap_err(), PackError::Count { triangles: 1, islands: 2 });
    let sparse = |island| pack(&[triangle; 2], &[1, island], &PackOptions::default(), Watch::NONE).unwrap_err();
    for island in [2, 50_000_000, u32::MAX] {
        assert_eq!(sparse(island), PackError::Island { triangle: 1, island, triangles: 2 });
    }
    assert_eq!(
        sparse(7).to_string(),
        "triangle 1 (counted from 0) is on island 7, but of 2 triangles islands can have the numbers from 0 to 1 only"
    );
    let stop = |_| std::ops::ControlFlow::Break(());
    let stopped = pack(&[triangle], &[0], &PackOptions::default(), Watch::new(&stop));
    assert_eq!(stopped.unwrap_err(), PackError::Interrupted(geom::Interrupted));
}

#[test]
fn of_islands_that_are_too_large_the_largest_is_named_and_by_how_much_is_enough_for_all() {
    let stars: Vec<_> = (0..9).map(|k| star([0.0, 0.0], &[1.0, 0.7, 1.0 + f64::from(k * 5 % 9)])).collect();
    let (triangles, island) = islands(&stars);
    let at = |texel_density| PackOptions { tiles: Tiles::Udim { texel_density }, ..PackOptions::default() };
    let error = pack(&triangles, &island, &at(1000.0), Watch::NONE).unwrap_err();
    let PackError::TooLarge { island: largest, times, fits } = error else { panic!("{error}") };
    assert_eq!(largest, 7, "7 · 5 modulo 9 is 8");
    let (packing, _) = check(&triangles, &island, &at(1000.0 / (1.01 * times)));
    assert!(packing.tiles > 1);
    assert!((packing.scale * 1024.0 - 1000.0 / (1.01 * times)).abs() < 1e-6);
    check(&triangles, &island, &at(fits));
    let told = |fits| PackError::TooLarge { island: 0, times, fits }.to_string();
    for (fits, shown) in [(0.099999, "0.0999"), (1.0, "1.00"), (28.61, "28.6"), (286.9, "286"), (28699.0, "28600")] {
        assert!(told(fits).ends_with(&format!("lower the texel density to {shown} or cut it")), "{}", told(fits));
    }
}

#[test]
fn threads_change_nothing() {
    let stars: Vec<_> = (1..20).map(|k| star([0.0, 0.0], &[f64::from(k), 3.0, 1.0, 4.0, 2.0])).collect();
    let (triangles, island) = islands(&stars);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| pack(&triangles, &island, &PackOptions::default(), Watch::NONE)).unwrap()
    };
    assert_eq!(on(1), on(3));
}
