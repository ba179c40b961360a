//! Thin limbs are cut off where no number of cones keeps lengths, and nowhere else.

use std::ops::ControlFlow;

use cones::{Analysis, Atlas, Limbs, Options, Preparation, Progress, Refining};
use geom::shapes::{self, Shape};
use geom::{Model, distortion};
use tests::oracle::check_map;
use tests::solids;

/// A sphere with some seventy thin tubes, each of them half as long again as round.
fn urchin() -> Shape {
    solids::spiky(&shapes::sphere(900), 9)
}

/// A ball with some twenty long tubes.
fn of_few_limbs() -> Shape {
    solids::spiky(&shapes::sphere(200), 20)
}

fn area_distortion(model: &Model, atlas: &Atlas) -> f64 {
    let vertices = |t: &[u32; 3]| t.map(|c| model.corners()[c as usize]);
    let triangles: Vec<[u32; 3]> = atlas.triangles.corners.iter().map(vertices).collect();
    let uv: Vec<_> = atlas.triangles.corners.iter().map(|t| t.map(|c| atlas.uv[c as usize])).collect();
    distortion::measure(model.points(), &triangles, &uv).expect("one position a corner").area.mean
}

/// Necks are closed, no cone is on one, and the map is what maps are.
fn check(model: &Model, atlas: &Atlas) {
    let end = atlas.seams.len() - atlas.opened_handles;
    let necks = &atlas.seams[end - atlas.necks..end];
    assert!(necks.iter().all(|neck| neck.len() > 3 && neck.first() == neck.last()), "a neck is not closed");
    assert!(!atlas.cones.iter().any(|cone| necks.iter().flatten().any(|&v| v == cone.vertex)), "a cone is on a neck");
    let found = check_map(model, atlas);
    assert_eq!((found.flipped, found.degenerate, found.torn), (0, 0, 0), "{:?}", atlas.notes);
    assert!(found.euler.iter().all(|&chi| chi == 1), "islands are disks: {:?}", found.euler);
    assert_eq!(atlas.unfolded, 0, "{:?}", atlas.notes);
}

#[test]
fn limbs_are_cut_off_where_no_number_of_cones_keeps_lengths() {
    let model = solids::model(&urchin()).expect("an ordinary shape");
    let of_those_there_are = |progress: Progress| {
        let is_known = progress.components > 0;
        assert!(!is_known || progress.component < progress.components, "{progress:?}");
        ControlFlow::Continue(())
    };
    let analysis = Analysis::observed(&model, Preparation::default(), of_those_there_are).expect("a sound model");
    let atlas = analysis.atlas(&Options::default()).expect("it unwraps");
    assert!(atlas.necks > 2, "{}", atlas.necks);
    check(&model, &atlas);
    assert!(area_distortion(&model, &atlas) < 1.3, "{}", area_distortion(&model, &atlas));
}

#[test]
fn limbs_of_every_part_and_of_refined_surfaces_are_cut_off_and_named_by_their_part() {
    let shapes = [shapes::hare(300), urchin(), urchin()];
    let model = solids::model(&solids::side_by_side(&shapes)).expect("an ordinary shape");
    for refine in [Refining::Never, Refining::Always] {
        let preparation = Preparation { refine, ..Preparation::default() };
        let analysis = Analysis::with(&model, preparation).expect("a sound model");
        let atlas = analysis.atlas(&Options { preparation, ..Options::default() }).expect("it unwraps");
        check(analysis.refined().map_or(&model, |refined| &refined.model), &atlas);
        assert!(atlas.necks > 4 && atlas.necks.is_multiple_of(2), "{}", atlas.necks);
        let on = |part: usize| atlas.cones.iter().filter(|cone| cone.component == part).count();
        assert!(on(0) > 0 && on(1) > 20 && on(1) == on(2), "{:?}", [0, 1, 2].map(on));
        assert!(atlas.cones.is_sorted_by_key(|cone| cone.component) && atlas.cones.iter().all(|c| c.component < 3));
        assert!(atlas.notes.iter().all(|note| note.component().is_none_or(|part| part < 3)), "{:?}", atlas.notes);
    }
}

#[test]
fn a_part_that_a_few_more_cones_flatten_gets_them_beside_one_whose_limbs_are_cut_off() {
    let few = of_few_limbs();
    let model = solids::model(&solids::side_by_side(&[few.clone(), urchin()])).expect("an ordinary shape");
    let atlas = Analysis::new(&model).expect("a sound model").atlas(&Options::default()).expect("it unwraps");
    check(&model, &atlas);
    let on_few = atlas.cones.iter().filter(|cone| cone.component == 0).count();
    assert!(on_few > 32, "{on_few}");
    let end = atlas.seams.len() - atlas.opened_handles;
    let of_few = |v: &u32| (*v as usize) < few.points.len();
    assert!(!atlas.seams[end - atlas.necks..end].iter().flatten().any(of_few), "its own limbs stay on");
    assert!(area_distortion(&model, &atlas) < 1.3, "{}", area_distortion(&model, &atlas));
}

#[test]
fn limbs_stay_on_where_that_is_asked_for_or_a_few_more_cones_are_enough() {
    let model = solids::model(&urchin()).expect("an ordinary shape");
    let analysis = Analysis::new(&model).expect("a sound model");
    let asked = Options { limbs: Limbs::Never, ..Options::default() };
    assert_eq!(analysis.atlas(&asked).expect("it unwraps").necks, 0);
    let few = solids::model(&of_few_limbs()).expect("an ordinary shape");
    let analysis = Analysis::new(&few).expect("a sound model");
    let atlas = analysis.atlas(&Options::default()).expect("it unwraps");
    assert!(atlas.necks == 0 && atlas.cones.len() > 32, "{} {}", atlas.necks, atlas.cones.len());
    assert!(area_distortion(&few, &atlas) < 1.3, "{:?}", atlas.notes);
}
