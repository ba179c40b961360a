use std::f64::consts::{E, LN_2};

use proptest::prelude::*;

use super::*;
use crate::shapes::{self, Shape};

type Uv = Vec<[[f64; 2]; 3]>;

fn images(shape: &Shape, map: impl Fn([f64; 3]) -> [f64; 2]) -> Uv {
    shape.triangles.iter().map(|t| t.map(|v| map(shape.points[v as usize]))).collect()
}

fn measured(shape: &Shape, uv: &[[[f64; 2]; 3]]) -> Distortion {
    measure(&shape.points, &shape.triangles, uv).unwrap()
}

fn projected(shape: &Shape) -> Uv {
    images(shape, |[x, y, _]| [x, y])
}

/// Asserts that the values agree to rounding.
#[track_caller]
fn assert_near(value: f64, expected: f64) {
    assert!((value - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{value}, not {expected}");
}

/// The sides of the pyramid beside each other in the plane, cut open along one of its slanted edges.
fn developed_cone(sides: u8) -> (Shape, Uv) {
    let shape = shapes::cone(sides, 500);
    let turn = std::f64::consts::TAU / f64::from(sides);
    let uv = shape.triangles.iter().map(|t| {
        let corners = t.map(|v| shape.points[v as usize]);
        let middle = [0, 1].map(|k| corners[0][k] + corners[1][k] + corners[2][k]);
        let side = (middle[1].atan2(middle[0]).rem_euclid(std::f64::consts::TAU) / turn).floor();
        let ray = |k: f64, angle: f64| [(k * angle).cos(), (k * angle).sin()];
        let radius = 0.5 / (0.5 * turn).sin();
        corners.map(|[x, y, _]| {
            // The point is a combination of the rays beside it, in space as in the plane.
            let [[ax, ay], [bx, by]] = [ray(side, turn), ray(side + 1.0, turn)].map(|r| r.map(|x| x * radius));
            let [s, t] = [(x * by - y * bx) / (ax * by - ay * bx), (ax * y - ay * x) / (ax * by - ay * bx)];
            let [a, b] = [ray(side, PI / 3.0), ray(side + 1.0, PI / 3.0)];
            [s * a[0] + t * b[0], s * a[1] + t * b[1]]
        })
    });
    let uv = uv.collect();
    (shape, uv)
}

#[test]
fn a_similarity_distorts_nothing_at_any_scale() {
    for scale in [1.0, 1e-12, 1e12, 1e-150, 1e150] {
        for mirror in [1.0, -1.0] {
            let (sin, cos) = 0.7f64.sin_cos();
            let mut shape = shapes::disk(300);
            let uv = images(&shape, |[x, y, _]| [mirror * (x * cos - y * sin), x * sin + y * cos].map(|x| x / scale));
            shape.points.iter_mut().for_each(|p| *p = [scale * p[0], scale * 0.6 * p[1], scale * 0.8 * p[1]]);
            let distortion = measured(&shape, &uv);
            assert_near(distortion.quasi_conformal.mean, 1.0);
            assert_near(distortion.quasi_conformal.max, 1.0);
            assert_near(distortion.area.mean, 1.0);
            assert_near(distortion.area_inverse_mean, 1.0);
            assert_near(distortion.u_l2, 0.0);
            assert_near(distortion.u_linf, 0.0);
            assert_eq!((distortion.flipped, distortion.degenerate, distortion.degenerate_on_surface), (0, 0, 0));
            assert_eq!(distortion.islands.len(), 1);
            assert!(distortion.islands[0].is_disk());
            assert_eq!(distortion.islands[0].is_mirrored, mirror < 0.0);
            assert_eq!(distortion.cones(1e-9), []);
        }
    }
}

#[test]
fn a_stretch_has_its_factor_as_quasi_conformal_distortion() {
    let shape = shapes::square(100);
    for factor in [1.5, 7.0, 1000.0] {
        let distortion = measured(&shape, &images(&shape, |[x, y, _]| [factor * x, y]));
        let found = distortion.quasi_conformal;
        for value in [found.mean, found.median, found.p95, found.p99, found.max] {
            assert_near(value, factor);
        }
        assert_near(distortion.area.max, 1.0);
    }
}

#[test]
fn the_measures_of_two_scales_are_those_calculated_by_hand() {
    // Part of the area keeps its size, the rest is doubled in length: r is 1 : 4.
    let shape = shapes::square(100);
    let mut uv = projected(&shape);
    for triangle in &mut uv {
        let is_right = triangle.iter().map(|q| q[0]).sum::<f64>() > 0.0;
        let factor = if is_right { 2.0 } else { 1.0 };
        triangle.iter_mut().for_each(|q| *q = q.map(|x| (x + 3.0) * factor));
    }
    let distortion = measured(&shape, &uv);
    let large = distortion.triangle_log_scale.iter().filter(|&&u| u > 0.0).count() as f64 / uv.len() as f64;
    let scale = 1.0 / (1.0 - large + 4.0 * large);
    let (r, s) = (scale, 4.0 * scale);
    assert_near(distortion.area.mean, (1.0 - large) / r + large * s);
    assert_near(distortion.area_inverse_mean, (1.0 - large) / r + large / s);
    assert_near(distortion.u_l2, LN_2 * (large * (1.0 - large)).sqrt());
    assert_near(distortion.u_linf, LN_2 * large.max(1.0 - large));
    assert_near(distortion.quasi_conformal.max, 1.0);
    assert_eq!(distortion.islands.len(), 2);
    // One side of the seam is twice as long as the other: 1 over 1.5.
    assert_near(distortion.seam_mismatch, 2.0 / 3.0);
}

#[test]
fn the_exponential_function_is_conformal_with_the_real_part_as_log_scale() {
    let shape = shapes::square(40_000);
    let distortion = measured(&shape, &images(&shape, |[x, y, _]| [x.exp() * y.cos(), x.exp() * y.sin()]));
    assert!(distortion.quasi_conformal.max < 1.02);
    // x on [-1, 1] has the mean square 1/3.
    assert!((distortion.u_l2 - (1f64 / 3.0).sqrt()).abs() < 1e-3);
    assert!((distortion.u_linf - 1.0).abs() < 1e-2);
    // r = e^2x / m with the mean m = (e² - e⁻²) / 4; the integral of max(r, 1/r) by hand.
    let m = (E * E - 1.0 / (E * E)) / 4.0;
    let [low, high] = [(-2f64).exp(), 2f64.exp()];
    let expected = 0.5 * (m * 0.5 * (1.0 / low - 1.0 / m) + (high - m) * 0.5 / m);
    assert!((distortion.area.mean - expected).abs() < 1e-2);
}

#[test]
fn a_developed_cone_is_isometric_and_shows_its_cone() {
    for sides in [3, 4, 5] {
        let (shape, uv) = developed_cone(sides);
        let distortion = measured(&shape, &uv);
        assert!((distortion.quasi_conformal.max - 1.0).abs() < 1e-9);
        assert!(distortion.u_linf < 1e-9);
        let expected = 2.0 * PI - f64::from(sides) * PI / 3.0;
        let cones = distortion.cones(1e-9);
        assert_eq!(cones.len(), 1);
        assert_eq!(cones[0].0, VertexId(0));
        assert_near(cones[0].1, expected);
        assert!(distortion.curvature_error(&[VertexId(0)]) < 1e-9);
        assert_near(distortion.curvature_error(&[]), expected);
        assert!(distortion.islands.len() == 1 && distortion.islands[0].is_disk());
        assert!((distortion.seam_length * shape.area().sqrt() - 1.0).abs() < 1e-9, "a slanted edge has length 1");
        assert!(distortion.seam_mismatch < 1e-9);
        assert_eq!(overlap(&uv, 1024), 0.0);
    }
}

#[test]
fn islands_have_the_topology_of_what_is_glued() {
    let topology = |name| {
        let shape = shapes::by_name(name, 300).unwrap();
        let distortion = measured(&shape, &images(&shape, |[x, y, z]| [x + 0.3 * z, y - 0.2 * z]));
        assert_eq!(distortion.islands.len(), 1);
        assert_eq!(distortion.islands[0].faces, shape.triangles.len());
        (distortion.islands[0].euler_characteristic, distortion.islands[0].boundary_loops)
    };
    assert_eq!(topology("sphere"), (2, 0));
    assert_eq!(topology("torus"), (0, 0));
    assert_eq!(topology("cylinder"), (0, 2));
    assert_eq!(topology("terrain"), (1, 1));
}

#[test]
fn triangles_apart_are_islands_each() {
    let shape = shapes::sphere(50);
    let uv: Uv = (0..shape.triangles.len())
        .map(|f| [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]].map(|[u, v]| [u + 2.0 * f as f64, v]))
        .collect();
    let distortion = measured(&shape, &uv);
    assert_eq!(distortion.islands.len(), uv.len());
    assert!(distortion.islands.iter().all(|island| island.is_disk() && island.faces == 1));
    assert_eq!(distortion.seam_edges, uv.len() / 2 * 3);
    assert_near(distortion.islands.iter().map(|island| island.area).sum(), 1.0);
    assert_eq!(distortion.triangle_island[FaceId(7)], 7);
}

#[test]
fn images_rounded_to_six_digits_are_still_glued() {
    let shape = shapes::disk(300);
    let exact = images(&shape, |[x, y, _]| [x, y]);
    let mut side = 0.0;
    let rounded: Uv = exact
        .iter()
        .map(|corners| {
            corners.map(|q| {
                side = 5e-8 - side;
                q.map(|x| x + side)
            })
        })
        .collect();
    assert_eq!(measured(&shape, &rounded).seam_edges, 0);
}

#[test]
fn a_triangle_turned_over_is_flipped_but_a_mirrored_island_is_not() {
    let shape = shapes::square(100);
    for mirror in [1.0, -1.0] {
        let mut uv = images(&shape, |[x, y, _]| [mirror * x, y]);
        // The vertex in the middle is moved beyond its neighbours.
        let flips = |uv: &Uv| uv.iter().filter(|&&[a, b, c]| mirror * area(a, b, c) < 0.0).count();
        let middle = shape.points[shape.triangles[uv.len() / 2][0] as usize];
        for q in uv.as_flattened_mut() {
            if *q == [mirror * middle[0], middle[1]] {
                *q = [q[0] + 0.5, q[1] + 0.05];
            }
        }
        assert!(flips(&uv) > 0);
        let distortion = measured(&shape, &uv);
        assert_eq!(distortion.flipped, flips(&uv));
        let first = uv.iter().position(|&[a, b, c]| mirror * area(a, b, c) < 0.0);
        assert_eq!(distortion.first_flaw.map(|f| f.index()), first);
        assert_eq!(distortion.islands[0].is_mirrored, mirror < 0.0);
        assert!(overlap(&uv, 512) > 0.0);
    }
}

fn area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[test]
fn triangles_turned_against_each_other_are_not_flipped_by_the_map() {
    let mut shape = shapes::disk(300);
    shape.triangles.iter_mut().step_by(3).for_each(|t| t.swap(0, 2));
    let distortion = measured(&shape, &projected(&shape));
    assert_eq!((distortion.flipped, distortion.islands.len(), distortion.seam_edges), (0, 1, 0));
    assert!(distortion.islands[0].is_disk());
    assert_eq!(distortion.cones(1e-9), []);
}

#[test]
fn triangles_without_area_are_counted_apart_and_take_no_part() {
    let mut shape = shapes::square(100);
    let mut uv = projected(&shape);
    let count = uv.len();
    shape.triangles.extend([[0, 1, 1], [2, 2, 2]]);
    uv.extend([[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [[0.5; 2]; 3]]);
    uv[3] = [[0.25, 0.25]; 3];
    uv[4] = [[0.0, 0.0], [0.1, 0.1], [0.2, 0.2]];
    let distortion = measured(&shape, &uv);
    assert_eq!((distortion.degenerate, distortion.degenerate_on_surface), (2, 2));
    assert_near(distortion.quasi_conformal.max, 1.0);
    // The others are as large as each other: those without area have no say in how large that is.
    assert_near(distortion.area.max, 1.0);
    assert_near(distortion.area_inverse_mean, 1.0);
    assert_eq!(distortion.triangle_quasi_conformal.iter().filter(|x| x.is_infinite()).count(), 4);
    assert_eq!(distortion.triangle_quasi_conformal.len(), count + 2);
    assert_eq!(distortion.triangle_log_scale[FaceId(3)], 0.0);
}

#[test]
fn a_vertex_in_no_triangle_does_not_matter() {
    let mut shape = shapes::disk(100);
    let uv = projected(&shape);
    shape.points.push([1e150, 0.0, -1e150]);
    let distortion = measured(&shape, &uv);
    assert_near(distortion.area.mean, 1.0);
    assert_eq!(distortion.curvature.last(), Some(&0.0));
}

#[test]
fn what_cannot_be_measured_is_refused_by_name() {
    use DistortionError::*;
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let uv = [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]];
    let error = |points: &[[f64; 3]], triangles: &[[u32; 3]], uv: &[_]| measure(points, triangles, uv).unwrap_err();
    assert_eq!(error(&points, &[], &uv), Count { triangles: 0, uv: 1 });
    assert_eq!(error(&[], &[], &[]), NoArea);
    assert_eq!(error(&points, &[[0, 1, 3]], &uv), VertexOutOfRange { face: FaceId(0), vertex: 3, count: 3 });
    assert_eq!(error(&[[0.0; 3], [f64::NAN; 3], points[2]], &[[0, 1, 2]], &uv), PointNotFinite(VertexId(1)));
    assert_eq!(error(&points, &[[0, 1, 2]], &[[[f64::INFINITY; 2]; 3]]), UvNotFinite(FaceId(0)));
    assert_eq!(error(&points, &[[0, 1, 2]], &[[[1.0; 2]; 3]]), NoArea);
    assert_eq!(error(&points, &[[0, 1, 1]], &uv), NoArea);
}

#[test]
fn overlap_is_the_share_covered_twice_whatever_the_scale() {
    // Two squares that share a fifth of their union's area.
    let square = |x: f64| [[[x, 0.0], [3.0 + x, 0.0], [3.0 + x, 3.0]], [[x, 0.0], [3.0 + x, 3.0], [x, 3.0]]];
    for scale in [1.0, 1e-300, 1e300] {
        let uv = [square(0.0), square(2.0)].concat();
        let uv: Uv = uv.into_iter().map(|t| t.map(|q| q.map(|x| scale * x))).collect();
        assert!((overlap(&uv, 1000) - 0.2).abs() < 2e-3);
    }
    assert_eq!(overlap(&[], 1000), 0.0);
    assert_eq!(overlap(&[[[1.0; 2]; 3]], 1000), 0.0);
    assert_eq!(overlap(&[[[f64::NAN; 2]; 3]], 1000), 0.0);
    assert_eq!(overlap(&square(0.0), 0), 0.0);
    assert_eq!(overlap(&square(0.0), usize::MAX), 0.0);
}

/// Coordinates as files have them, and some that hurt.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![4 => -1.0..1.0, 1 => Just(0.0), 1 => Just(1e-300), 1 => Just(f64::MAX), 1 => Just(-f64::MAX), 1 => prop::num::f64::ANY]
}

proptest! {
    #[test]
    fn whatever_is_measured_gives_numbers_or_an_error(
        points in prop::collection::vec(prop::array::uniform3(coordinate()), 0..8),
        faces in prop::collection::vec((prop::array::uniform3(0u32..8), prop::array::uniform3(prop::array::uniform2(coordinate()))), 0..12),
        resolution in 0usize..100,
    ) {
        let (triangles, uv): (Vec<_>, Vec<_>) = faces.into_iter().unzip();
        prop_assert!((0.0..=1.0).contains(&overlap(&uv, resolution)));
        if let Ok(distortion) = measure(&points, &triangles, &uv) {
            let Distortion { quasi_conformal: q, area, u_l2, u_linf, seam_length, seam_mismatch, .. } = distortion;
            for value in [q.mean, q.median, q.max, area.mean, area.max, u_l2, u_linf, seam_length, seam_mismatch] {
                prop_assert!(value.is_finite(), "{distortion:?}");
            }
            prop_assert!(q.median >= 1.0 && area.median >= 1.0);
            prop_assert_eq!(distortion.first_flaw.is_some(), distortion.flipped + distortion.degenerate > 0);
            prop_assert!(distortion.curvature.iter().all(|k| k.is_finite()));
        }
    }
}

#[test]
fn a_vertex_that_left_its_fan_has_lost_the_whole_turn() {
    // The middle of a square is moved out of it: the angles of the flipped triangle undo those of the others.
    let square = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0; 3]];
    let triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    for (x, curvature) in [(0.0, 0.0), (0.5, 0.0), (1.5, 2.0 * PI)] {
        let uv = triangles
            .map(|t| t.map(|v| if v == 4 { [x, 0.0] } else { [square[v as usize][0], square[v as usize][1]] }));
        let distortion = measure(&square, &triangles, &uv).unwrap();
        assert!((distortion.curvature[VertexId(4)] - curvature).abs() < 1e-14, "{}", distortion.curvature[VertexId(4)]);
        assert_eq!(distortion.flipped, usize::from(x > 1.0));
    }
}

#[test]
fn each_fan_round_a_vertex_has_a_turn_of_its_own() {
    // Two squares that share their middle; the second may be bent to a cone of three quarters, or both to cones of a half.
    let corner = |k: usize| [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]][k % 4];
    let points: Vec<[f64; 3]> = std::iter::once([0.0; 3])
        .chain((0..8).map(|k| [corner(k)[0], corner(k)[1], if k < 4 { 1.0 } else { -1.0 }]))
        .collect();
    let fan = |first: u32, sides: u32| (0..sides).map(move |k| [0, first + k, first + (k + 1) % sides]);
    for (sides, expected) in [([4, 4], 0.0), ([4, 3], 0.5 * PI), ([3, 3], PI), ([2, 2], 2.0 * PI)] {
        let triangles: Vec<[u32; 3]> = fan(1, sides[0]).chain(fan(5, sides[1])).collect();
        let turns = (0..sides[0]).chain(0..sides[1]).map(|k| k as usize);
        let uv: Vec<[[f64; 2]; 3]> = turns.map(|k| [[0.0; 2], corner(k), corner(k + 1)]).collect();
        let found = measure(&points, &triangles, &uv).unwrap().curvature[VertexId(0)];
        assert!((found - expected).abs() < 1e-14, "{sides:?}: {found}");
    }
}

#[test]
fn the_first_flaw_is_a_triangle_that_has_lost_its_area() {
    let square = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0; 3]];
    let triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    for (x, flaw) in [(0.0, None), (1.0, Some(FaceId(1))), (-1.0, Some(FaceId(3)))] {
        let uv = triangles
            .map(|t| t.map(|v| if v == 4 { [x, 0.0] } else { [square[v as usize][0], square[v as usize][1]] }));
        assert_eq!(measure(&square, &triangles, &uv).unwrap().first_flaw, flaw);
    }
}

#[test]
fn the_median_is_what_half_of_the_surface_does_not_exceed() {
    let points =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [9.0, 0.0, 0.0], [10.0, 0.0, 0.0], [9.0, 1.0, 0.0]];
    let uv = [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [[5.0, 0.0], [7.0, 0.0], [5.0, 1.0]]];
    let quasi_conformal = measure(&points, &[[0, 1, 2], [3, 4, 5]], &uv).unwrap().quasi_conformal;
    assert_eq!((quasi_conformal.median, quasi_conformal.p95, quasi_conformal.max), (1.0, 2.0, 2.0));
}

#[test]
fn sides_with_one_image_are_glued_in_whatever_order_three_faces_meet() {
    // A wall of two triangles, and a fin on the edge between them.
    let points = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let [left, right, fin] = [[1, 0, 3], [0, 1, 2], [0, 1, 4]];
    let flat = |v: u32| [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [-1.0, 0.0], [1.0, 0.0]][v as usize];
    for order in [[left, fin, right], [left, right, fin], [fin, left, right]] {
        let away = |t: [u32; 3], [x, y]: [f64; 2]| if t == fin { [x + 3.0, y] } else { [x, y] };
        let uv: Vec<[[f64; 2]; 3]> = order.iter().map(|&t| t.map(|v| away(t, flat(v)))).collect();
        let measured = measure(&points, &order, &uv).unwrap();
        assert_eq!(measured.islands.len(), 2, "{order:?}");
        let area: f64 = 1.5;
        assert!((measured.seam_length - area.sqrt().recip()).abs() < 1e-12, "{}", measured.seam_length);
    }
}

#[test]
fn images_of_a_corner_may_be_rounded() {
    let points = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]];
    let shift = |by: f64| [[[0.0, 1.0], [0.0, 0.0], [-1.0, 0.0]], [[by, 0.0], [by, 1.0], [1.0, 0.0]]];
    let islands = |by| measure(&points, &[[1, 0, 3], [0, 1, 2]], &shift(by)).unwrap().islands.len();
    assert_eq!((islands(5e-7), islands(1e-4)), (1, 2));
}
