//! Parts of one shape get the same cones and the same map, each under its own vertices.

use cones::{
    Analysis, Atlas, ConeChoice, Cones, CurvatureRule, Handles, Note, Options, Preparation, Refining, SeamOptions,
};
use geom::Model;
use geom::shapes::{self, Shape};
use tests::oracle::check_map;
use tests::solids;

/// A shape, another one, and the first again: turned, and with its vertices in another order.
fn instances(shape: &Shape, other: &Shape) -> (Model, impl Fn(u32) -> u32 + use<>) {
    let (count, between) = (shape.points.len() as u32, other.points.len() as u32);
    let again = move |v: u32| 2 * count + between - 1 - v;
    let turned = |p: &[f64; 3]| [20.0 - 0.6 * p[1] - 0.8 * p[2], p[0], 0.8 * p[1] - 0.6 * p[2]];
    let mut all = solids::side_by_side(&[shape.clone(), other.clone()]);
    all.points.extend(shape.points.iter().rev().map(turned));
    all.triangles.extend(shape.triangles.iter().map(|corners| corners.map(again)));
    (solids::model(&all).expect("an ordinary shape"), again)
}

/// The vertices and curvatures of the cones on a component.
fn on(cones: &Cones, component: usize) -> Vec<(u32, f64)> {
    cones.iter().filter(|cone| cone.component == component).map(|cone| (cone.vertex, cone.curvature)).collect()
}

/// The lengths in a map of the sides of some triangles.
fn sides(atlas: &Atlas, first: usize, count: usize) -> Vec<[f64; 3]> {
    let triangle = |t: usize| {
        let corners = &atlas.uv[3 * t..3 * t + 3];
        [0, 1, 2].map(|k| (0..2).map(|c| (corners[k][c] - corners[(k + 1) % 3][c]).powi(2)).sum::<f64>().sqrt())
    };
    (first..first + count).map(triangle).collect()
}

#[test]
fn parts_of_one_shape_get_the_same_cones_and_the_same_map() {
    let (shape, other) = (shapes::hare(900), shapes::torus(1, 300));
    let (model, again) = instances(&shape, &other);
    for refine in [Refining::Never, Refining::Always] {
        let preparation = Preparation { refine, ..Preparation::default() };
        let analysis = Analysis::with(&model, preparation).expect("a sound model");
        let options = Options { preparation, ..Options::default() };
        let cones = analysis.choose(&options).expect("it is placed");
        let [one, same] = [0, 2].map(|component| on(&cones, component));
        assert!(one.len() >= 3 && one.len() == same.len());
        if refine == Refining::Never {
            assert_eq!(one.iter().map(|&(v, k)| (again(v), k)).collect::<Vec<_>>(), same);
        }
        let atlas = analysis.atlas(&options).expect("it unwraps");
        let written = analysis.refined().map_or(&model, |refined| &refined.model);
        let found = check_map(written, &atlas);
        assert_eq!((found.flipped, found.degenerate, found.torn), (0, 0, 0), "{:?}", atlas.notes);
        assert!(found.euler.iter().all(|&chi| chi == 1), "islands are disks: {:?}", found.euler);
        if refine == Refining::Never {
            let count = shape.triangles.len();
            let [one, same] = [0, count + other.triangles.len()].map(|first| sides(&atlas, first, count));
            for (one, same) in one.as_flattened().iter().zip(same.as_flattened()) {
                assert!((one - same).abs() <= 1e-9 * one, "{one} {same}");
            }
        }
    }
}

#[test]
fn handles_of_parts_of_one_shape_are_opened_alike() {
    let shape = shapes::torus(2, 900);
    let (model, again) = instances(&shape, &shapes::hare(300));
    let preparation = Preparation { handles: Handles::Always, ..Preparation::default() };
    let analysis = Analysis::with(&model, preparation).expect("a sound model");
    let options = Options { preparation, ..Options::default() };
    let cones = analysis.choose(&options).expect("it is placed");
    assert_eq!(on(&cones, 0).into_iter().map(|(v, k)| (again(v), k)).collect::<Vec<_>>(), on(&cones, 2));
    let atlas = analysis.atlas(&options).expect("it unwraps");
    assert_eq!(atlas.opened_handles, 4);
    let found = check_map(&model, &atlas);
    assert_eq!((found.flipped, found.degenerate, found.torn), (0, 0, 0), "{:?}", atlas.notes);
}

#[test]
fn what_is_asked_for_one_part_alone_is_not_done_to_others_of_its_shape() {
    let shape = shapes::hare(600);
    let (model, again) = instances(&shape, &shapes::torus(1, 300));
    let analysis = Analysis::new(&model).expect("a sound model");
    let each = Options { cones: ConeChoice::Each(vec![5, 4, 9]), ..Options::default() };
    let cones = analysis.choose(&each).expect("it is placed");
    assert_eq!([0, 1, 2].map(|component| on(&cones, component).len()), [5, 4, 9]);
    let atlas = analysis.flatten(&cones).expect("it unwraps");
    assert_eq!(atlas.cones.len(), 18);

    let few = Options { cones: ConeChoice::Each(vec![5, 4, 5]), ..Options::default() };
    let cones = analysis.choose(&few).expect("it is placed");
    let [a, b, _] = shape.triangles[70];
    let is_cut = |atlas: &Atlas, a: u32, b: u32| {
        atlas.seams.iter().any(|seam| seam.windows(2).any(|edge| edge == [a, b] || edge == [b, a]))
    };
    let as_it_is = analysis.flatten(&cones).expect("it unwraps");
    assert!(!is_cut(&as_it_is, again(a), again(b)) && !is_cut(&as_it_is, a, b), "another edge would be a better test");
    let seams = SeamOptions { given: vec![[again(a), again(b)]], ..SeamOptions::default() };
    let cut = analysis.flatten_with(&cones, &Options { seams, ..Options::default() }).expect("it unwraps");
    assert!(is_cut(&cut, again(a), again(b)) && !is_cut(&cut, a, b));

    let given: Vec<u32> = on(&cones, 0).iter().map(|&(v, _)| v).chain(on(&cones, 1).iter().map(|&(v, _)| v)).collect();
    let others = [3, 77, 150, 222].map(again);
    let given = analysis.given(&[&given[..], &others].concat(), CurvatureRule::Optimal).expect("they are vertices");
    assert_eq!(on(&given, 2).iter().map(|&(v, _)| v).collect::<Vec<_>>(), others);
}

#[test]
fn what_there_is_to_say_of_a_part_is_said_of_others_of_its_shape_with_their_own_vertices() {
    let shape = shapes::torus(2, 400);
    let (vertices, between) = (shape.points.len() as u32, solids::tetrahedron());
    let (model, again) = instances(&shape, &between);
    let analysis = Analysis::new(&model).expect("a sound model");
    let mut said = 0;
    for k in 0..60 {
        let cones = [7 * k % vertices, (8 * k + 1) % vertices];
        let of_between = [0, 1, 2].map(|v| vertices + v);
        let given = [&cones[..], &of_between, &cones.map(&again)].concat();
        let Ok(cones) = analysis.given(&given, CurvatureRule::Harmonic) else { continue };
        let firsts = |notes: &[Note]| {
            [0, 2].map(|part| {
                notes.iter().find_map(|note| match *note {
                    Note::HarmonicOutOfBounds { component, first, .. } if component == part => Some(first),
                    _ => None,
                })
            })
        };
        let [one, same] = firsts(cones.notes());
        assert_eq!(one.map(&again), same);
        if one.is_some()
            && let Ok(atlas) = analysis.flatten(&cones)
        {
            assert_eq!(firsts(&atlas.notes), [one, same]);
            said += 1;
        }
    }
    assert!(said >= 1, "harmonic curvatures were never out of bounds");

    for last in [9000, 8000] {
        let options = Options { cones: ConeChoice::Each(vec![9000, 4, last]), ..Options::default() };
        let cones = analysis.choose(&options).expect("it is placed");
        let atlas = analysis.atlas(&options).expect("it unwraps");
        let asked = |note: &Note| match *note {
            Note::FewVertices { component, asked, .. } => Some((component, asked)),
            _ => None,
        };
        for notes in [cones.notes(), &atlas.notes] {
            assert_eq!(notes.iter().filter_map(asked).collect::<Vec<_>>(), [(0, 9000), (2, last)]);
        }
    }
}
