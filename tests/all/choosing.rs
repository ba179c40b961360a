//! The laws of choosing cones, on built-in shapes and random terrains.

use cones::internals::{EnergyModel, Operators, Quadratic, minimise};
use cones::{Analysis, ConeChoice, ConeOrder, Cones, CurvatureRule, Options, Placement};
use geom::shapes::{self, Shape};
use geom::{Mesh, Metric, Poisson, VertexData, VertexId};
use proptest::prelude::*;
use std::f64::consts::TAU;
use tests::solids;

use crate::cases;

const METHODS: [Placement; 6] = [
    Placement::Alternating,
    Placement::Persistence,
    Placement::Iterative,
    Placement::Greedy,
    Placement::Refined,
    Placement::Pursuit,
];

/// Those whose cones for any number are the first ones of one order.
const NESTED: [Placement; 5] =
    [Placement::Alternating, Placement::Persistence, Placement::Iterative, Placement::Greedy, Placement::Pursuit];

/// A surface of a few hundred vertices: closed, of higher genus, with one boundary loop or two, or random terrain.
fn surface() -> impl Strategy<Value = Shape> {
    let built_in = prop_oneof![
        Just("hare"),
        Just("part"),
        Just("capsule"),
        Just("torus-1"),
        Just("torus-2"),
        Just("cylinder"),
        Just("disk")
    ];
    let named = |(name, count)| shapes::by_name(name, count).expect("a name of a shape");
    prop_oneof![
        (built_in, 150usize..500).prop_map(named),
        (150usize..500, any::<u64>()).prop_map(|(count, seed)| shapes::terrain(count, seed)),
    ]
}

/// A surface whose shape has no symmetry, so that rounding breaks no tie.
fn asymmetric() -> impl Strategy<Value = Shape> {
    let bent = |shape: &Shape| {
        solids::mapped(shape, |[x, y, z]| {
            [x + 0.2 * y * y + 0.1 * z, y * (1.3 + 0.3 * x) + 0.17 * x * z, z * (1.0 - 0.2 * y + 0.13 * x) + 0.1 * x]
        })
    };
    prop_oneof![
        (150usize..400, any::<u64>()).prop_map(|(count, seed)| shapes::terrain(count, seed)),
        (12u32..20, 7u32..10).prop_map(move |(around, across)| bent(&solids::torus(around, across))),
        Just(solids::bumpy_sphere(3)),
    ]
}

fn operators(shape: &Shape) -> (Mesh, Operators) {
    let mesh = shape.mesh();
    let operators = Operators::new(&mesh, &Metric::from_points(&mesh, &shape.points)).expect("a sound shape");
    (mesh, operators)
}

/// Up to `count` different inner vertices.
fn scattered(mesh: &Mesh, count: usize, seed: usize) -> Vec<VertexId> {
    let inner: Vec<VertexId> = mesh.vertices().filter(|&v| !mesh.is_boundary_vertex(v)).collect();
    let count = count.min(inner.len());
    (0..count).map(|k| inner[(k * inner.len() / count + seed) % inner.len()]).collect()
}

fn analysis(shape: &Shape) -> Analysis {
    Analysis::new(&solids::model(shape).expect("an ordinary shape")).expect("a sound shape")
}

fn order(shape: &Shape, placement: Placement, rule: CurvatureRule) -> ConeOrder {
    analysis(shape).order(placement, rule, 4).expect("nobody says stop")
}

fn chosen(analysis: &Analysis, placement: Placement, rule: CurvatureRule, count: usize) -> Cones {
    let options = Options { cones: ConeChoice::Count(count), placement, rule, ..Options::default() };
    analysis.choose(&options).expect("a sound shape")
}

fn vertices(order: &ConeOrder) -> Vec<u32> {
    order.cones.iter().map(|cone| cone.vertex).collect()
}

/// Makes `y` orthogonal to `x` in the product weighted by area.
fn take_away(operators: &Operators, x: &VertexData<f64>, y: &mut VertexData<f64>) {
    let part = operators.inner(x, y) / operators.inner(x, x);
    y.iter_mut().zip(x.iter()).for_each(|(y, x)| *y -= part * x);
}

proptest! {
    #![proptest_config(cases(32))]

    /// The quadratic function is set up here from the log scale factors themselves.
    #[test]
    fn bounds_on_curvatures_can_only_cost_energy(shape in surface(), count in 3usize..12, seed in 0usize..500) {
        let (mesh, operators) = operators(&shape);
        let cones = scattered(&mesh, count, seed);
        let mut model = EnergyModel::new(&operators, &mesh);
        model.add(&cones);
        let bounded = model.fit(&cones);
        let none = operators.log_scale(&[], &[]);
        let unit = |&v: &VertexId| -> Vec<f64> {
            operators.log_scale(&[v], &[1.0]).iter().zip(none.iter()).map(|(with, without)| with - without).collect()
        };
        let green: Vec<Vec<f64>> = cones.iter().map(unit).collect();
        let linear: Vec<f64> = green.iter().map(|g| operators.inner(g, &none)).collect();
        let matrix: Vec<f64> = green.iter().flat_map(|g| green.iter().map(|h| operators.inner(g, h))).collect();
        let constant = operators.inner(&none, &none);
        let total = (!operators.is_bordered()).then(|| operators.total_curvature());
        let wide = vec![[-1e3, 1e3]; cones.len()];
        let free = minimise(&Quadratic { constant, linear: &linear, matrix: &matrix }, &wide, total).expect("wide bounds");
        prop_assert!(bounded.energy >= free.energy - 1e-9 * constant, "{} {}", bounded.energy, free.energy);
        let q = &bounded.curvature;
        let along: f64 = q.iter().zip(&linear).map(|(q, b)| 2.0 * q * b).sum();
        let rows = q.iter().zip(matrix.chunks(q.len()));
        let squared: f64 = rows.map(|(q_i, row)| q_i * row.iter().zip(q).map(|(h, q_j)| h * q_j).sum::<f64>()).sum();
        prop_assert!((bounded.energy - (constant + along + squared)).abs() < 1e-8 * constant, "the energy of its curvatures");
    }

    /// With the Laplacian factored once more, by the plain way.
    #[test]
    fn the_norm_that_is_predicted_is_that_of_one_poisson_solve(shape in surface(), count in 3usize..12, seed in 0usize..500) {
        let (mesh, operators) = operators(&shape);
        let loops: Vec<Vec<VertexId>> =
            operators.mesh().boundary_loops().iter().map(|l| l.iter().map(|&h| operators.mesh().tail(h)).collect()).collect();
        let cones = scattered(&mesh, count, seed);
        let mut model = EnergyModel::new(&operators, &mesh);
        model.add(&cones);
        let set = model.fit(&cones);
        let mut source: VertexData<f64> = operators.curvature().iter().map(|k| -k).collect();
        cones.iter().zip(&set.curvature).for_each(|(&v, k)| source[v] += k);
        let poisson = Poisson::new(&operators.laplacian(), &loops.concat()).expect("it is connected");
        let mut u = poisson.solve(&source);
        // Each boundary loop but one has a constant of its own; then the mean.
        let mut free = vec![VertexData::constant(mesh.vertex_count(), 1.0)];
        for around in loops.iter().skip(1) {
            let mut one = VertexData::constant(mesh.vertex_count(), 0.0);
            around.iter().for_each(|&v| one[v] = 1.0);
            let source: Vec<f64> = operators.laplacian().multiply(&one).iter().map(|change| -change).collect();
            let inside = poisson.solve(&source);
            free.push(one.iter().zip(inside.iter()).map(|(one, inside)| one + inside).collect());
        }
        for k in 0..free.len() {
            let (before, rest) = free.split_at_mut(k);
            before.iter().for_each(|x| take_away(&operators, x, &mut rest[0]));
        }
        free.iter().for_each(|x| take_away(&operators, x, &mut u));
        let norm = operators.inner(&u, &u).sqrt();
        prop_assert!((norm - set.log_scale_norm()).abs() < 1e-9 * (1.0 + norm), "{norm} {}", set.log_scale_norm());
    }

    #[test]
    fn the_cones_for_any_number_are_the_first_of_those_for_more(shape in surface(), few in 0usize..20, more in 20usize..40) {
        let analysis = analysis(&shape);
        let few = few.max(analysis.least_cones());
        for placement in NESTED {
            let cones = |count| -> Vec<u32> {
                let cones = analysis.place(placement, count).expect("nobody says stop");
                cones.iter().map(|cone| cone.vertex).collect()
            };
            let (few, more) = (cones(few), cones(more));
            prop_assert_eq!(&few[..], &more[..few.len()], "{:?}", placement);
        }
    }
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn curvatures_sum_to_two_pi_times_the_euler_characteristic(shape in surface(), count in 3usize..16) {
        let (_, operators) = operators(&shape);
        let analysis = analysis(&shape);
        for (placement, rule) in METHODS.iter().flat_map(|&m| [(m, CurvatureRule::Optimal), (m, CurvatureRule::Harmonic)]) {
            let found = chosen(&analysis, placement, rule, count);
            let total: f64 = found.iter().map(|cone| cone.curvature).sum();
            let size: f64 = found.iter().map(|cone| cone.curvature.abs()).sum();
            let expected = TAU * analysis.topology().euler as f64;
            prop_assert!(operators.is_bordered() || (total - expected).abs() < 1e-12 * (10.0 + size), "{placement:?}: {total}");
        }
    }

    /// Bounds that tighten with more cones could let it rise: they do as long as a surface of genus 2 and more needs more
    /// than 2π from each.
    #[test]
    fn with_more_cones_of_an_order_the_norm_does_not_grow(shape in surface()) {
        let (_, operators) = operators(&shape);
        let steady = (2.5 * -(operators.mesh().euler_characteristic().min(0) as f64)).ceil() as usize;
        for placement in NESTED {
            let curve = order(&shape, placement, CurvatureRule::Optimal).curve;
            prop_assert!(!curve.is_empty());
            for two in curve.windows(2).filter(|two| two[0].count >= steady) {
                prop_assert_eq!(two[1].count, two[0].count + 1);
                prop_assert!(two[1].log_scale_norm <= two[0].log_scale_norm * (1.0 + 1e-9) + 1e-12, "{:?} {:?}", placement, two);
            }
        }
    }

    #[test]
    fn neither_size_nor_turning_nor_the_order_of_vertices_changes_cones_or_what_is_predicted(
        shape in asymmetric(),
        size in prop_oneof![Just(1e-6), Just(0.3), Just(1e6)],
        angle in 0.1..3.0f64,
        step in 0usize..50,
    ) {
        let count = shape.points.len();
        let step = (count / 3 + step..).find(|&step| gcd(step, count) == 1).expect("a prime");
        let to = |v: usize| (v * step + 7) % count;
        let (sin, cos) = angle.sin_cos();
        let turned = solids::mapped(&shape, |[x, y, z]| {
            let [x, y] = [cos * x - sin * y, sin * x + cos * y];
            let [y, z] = [cos * y - sin * z, sin * y + cos * z];
            [size * x, size * y, size * z]
        });
        let mut points = vec![[0.0; 3]; count];
        turned.points.iter().enumerate().for_each(|(v, p)| points[to(v)] = *p);
        let renumbered = |t: &[u32; 3]| t.map(|v| to(v as usize) as u32);
        let other = Shape { points, triangles: turned.triangles.iter().map(renumbered).collect() };
        for (placement, rule) in NESTED.iter().flat_map(|&m| [(m, CurvatureRule::Optimal), (m, CurvatureRule::Harmonic)]) {
            let (before, after) = (order(&shape, placement, rule), order(&other, placement, rule));
            // Far down the order cones are as good as each other, and so are those on a torus that stand first.
            let (first, second) = (vertices(&before), vertices(&after));
            for count in [2, 4, 8] {
                let mapped = first[..count].iter().map(|&v| to(v as usize) as u32);
                let (before, after) = (sorted(mapped), sorted(second[..count].iter().copied()));
                prop_assert_eq!(before, after, "{} cones by {:?}", count, placement);
            }
            for (a, b) in before.curve.iter().zip(&after.curve).take_while(|(a, _)| a.count <= 8) {
                prop_assert!((a.log_scale_norm - b.log_scale_norm).abs() < 1e-7 * (1.0 + a.log_scale_norm));
                prop_assert!((a.area_distortion - b.area_distortion).abs() < 1e-7 * a.area_distortion);
            }
        }
        let [before, after] =
            [&shape, &other].map(|shape| chosen(&analysis(shape), Placement::Refined, CurvatureRule::Optimal, 8));
        let mapped = sorted(before.iter().map(|cone| to(cone.vertex as usize) as u32));
        prop_assert_eq!(mapped, sorted(after.iter().map(|cone| cone.vertex)), "refined");
        for (a, b) in before.iter().zip(&after) {
            prop_assert!((a.curvature - b.curvature).abs() < 1e-6);
        }
    }
}

fn sorted(vertices: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut vertices: Vec<u32> = vertices.collect();
    vertices.sort_unstable();
    vertices
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}
