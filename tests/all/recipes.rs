//! A recipe makes the map again that it is of.

use cones::uv::PackOptions;
use cones::{
    Analysis, Atlas, ConeChoice, Error, FreeSeams, GivenCone, Islands, Note, Options, Preparation, Progress, Recipe,
    Refining, SeamOptions, unwrap_model,
};
use geom::shapes::{self, Shape};
use geom::{Model, RepairKind, Weld};
use std::ops::ControlFlow;
use std::path::Path;
use tests::solids;

fn model(shape: &Shape) -> Model {
    solids::model(shape).expect("an ordinary shape")
}

/// The options with a recipe for their cones.
fn with(recipe: &Recipe, options: &Options) -> Options {
    Options { cones: ConeChoice::Recipe(Box::new(recipe.clone())), ..options.clone() }
}

/// Unwraps a model and makes its map again: both.
fn twice(model: &Model, options: &Options) -> [Atlas; 2] {
    let first = unwrap_model(model, options).expect("it unwraps");
    let again = unwrap_model(model, &with(first.recipe(), options)).expect("it is made again");
    [first, again]
}

/// Asserts that two maps are one but for rounding.
fn check_same([first, again]: &[Atlas; 2]) {
    let figures = |atlas: &Atlas| {
        (atlas.cones.len(), atlas.opened_handles, atlas.necks, atlas.freed, atlas.island_count(), atlas.seams.len())
    };
    assert_eq!(figures(first), figures(again));
    let near = |x: f64, y: f64| (x - y).abs() <= 1e-7 * x.abs();
    assert!(near(first.seam_figures.length, again.seam_figures.length));
    assert!(near(first.fill, again.fill), "{} {}", first.fill, again.fill);
    assert_eq!(first.recipe().opened.len(), again.recipe().opened.len());
    assert_eq!(first.recipe().freed, again.recipe().freed);
}

#[test]
fn handles_are_opened_again_on_the_parts_where_they_were() {
    let parts = [shapes::hare(300), shapes::torus(4, 2500), shapes::torus(1, 300)];
    let alone = twice(&model(&parts[1]), &Options { cones: ConeChoice::Count(4), ..Options::default() });
    assert_eq!((alone[0].opened_handles, alone[0].recipe().opened.len()), (4, 1), "{:?}", alone[0].recipe());
    check_same(&alone);
    assert_eq!(alone[0].uv, alone[1].uv);
    // Of two parts with handles one, by its last face, without a cone.
    let cones = [10, 100, 200].map(|vertex| GivenCone { vertex, ..GivenCone::default() }).to_vec();
    let face = (parts[0].triangles.len() + parts[1].triangles.len() - 1) as u32;
    let recipe = Recipe { cones, opened: vec![face], ..Recipe::default() };
    let maps = twice(&model(&solids::side_by_side(&parts)), &with(&recipe, &Options::default()));
    assert_eq!((maps[0].opened_handles, maps[0].recipe().opened.len()), (4, 1));
    check_same(&maps);
}

#[test]
fn what_is_flat_only_once_it_is_welded_is_welded_again() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/mirrored.obj");
    let model = geom::io::read(path).expect("it can be read");
    let maps = twice(&model, &Options::default());
    assert!(maps.iter().all(|map| map.recipe().welded), "{:?}", maps[0].notes);
    assert!(maps[0].cones.len() < 12 && maps[0].uv == maps[1].uv);
    check_same(&maps);
    let preparation = Preparation { weld: Weld::Never, ..Preparation::default() };
    let apart = unwrap_model(&model, &Options { preparation, ..Options::default() }).expect("it unwraps");
    assert!(!apart.recipe().welded);
}

#[test]
fn limbs_are_cut_off_again_at_their_necks() {
    let urchin = solids::spiky(&shapes::sphere(900), 9);
    let shape = solids::side_by_side(&[shapes::hare(300), urchin]);
    for refine in [Refining::Never, Refining::Always] {
        let preparation = Preparation { refine, ..Preparation::default() };
        let analysis = Analysis::with(&model(&shape), preparation).expect("a sound model");
        let options = Options { preparation, ..Options::default() };
        let first = analysis.atlas(&options).expect("it unwraps");
        let again = analysis.atlas(&with(first.recipe(), &options)).expect("it is made again");
        assert!(first.necks > 2, "{}", first.necks);
        check_same(&[first, again]);
    }
    let none = Recipe { necks: vec![vec![0, 1]], vertices: None, ..Recipe::default() };
    let refused = unwrap_model(&model(&shape), &with(&none, &Options::default()));
    assert!(matches!(refused, Err(Error::NoNecks)), "{refused:?}");
}

#[test]
fn a_map_without_cones_and_one_with_a_cone_everywhere_are_made_again() {
    let flat = twice(&model(&shapes::square(200)), &Options::default());
    assert!(flat[0].cones.is_empty());
    check_same(&flat);
    let all: Vec<u32> = (0..300).collect();
    let sphere = model(&shapes::sphere(300));
    let analysis = Analysis::new(&sphere).expect("a sound model");
    let own = analysis.given(&all, cones::CurvatureRule::Optimal).expect("they can take it");
    let first = analysis.flatten(&own).expect("it is flat");
    let again = unwrap_model(&sphere, &with(first.recipe(), &Options::default())).expect("it is made again");
    check_same(&[first, again]);
}

#[test]
fn seams_are_set_free_again_where_areas_were_missed() {
    let ball = model(&shapes::sphere(1000));
    let rigid =
        unwrap_model(&ball, &Options { cones: ConeChoice::Count(6), ..Options::default() }).expect("it unwraps");
    assert_eq!((rigid.freed, rigid.recipe().freed.len()), (0, 0));
    let missed = Recipe { freed: vec![0], ..rigid.recipe().clone() };
    let maps = [missed.clone(), Recipe { target: Some(1.0001), ..missed }].map(|recipe| {
        let maps = twice(&ball, &with(&recipe, &Options::default()));
        assert_eq!((maps[0].freed, &maps[0].recipe().freed), (1, &vec![0]));
        check_same(&maps);
        assert_eq!(maps[0].uv, maps[1].uv);
        maps
    });
    assert_ne!(maps[0][0].uv, maps[1][0].uv, "more is done for a target that is missed");
    let options = Options { free_seams: FreeSeams::Always, ..Options::default() };
    check_same(&twice(&model(&shapes::hare(400)), &options));
}

/// Two balls that have a vertex in common, and it.
fn touching() -> (Model, u32) {
    let ball = solids::bumpy_sphere(2);
    let mut both = solids::side_by_side(&[ball.clone(), ball.clone()]);
    let (one, other) = (0, ball.points.len() as u32);
    both.triangles.iter_mut().flatten().filter(|v| **v == other).for_each(|v| *v = one);
    (model(&both), one)
}

#[test]
fn a_cone_at_a_vertex_that_was_split_is_told_by_a_face() {
    let (model, shared) = touching();
    let at_vertex = |f: &usize| model.face(*f).contains(&shared);
    let faces: Vec<u32> = (0..model.face_count()).filter(at_vertex).map(|f| f as u32).collect();
    let last = *faces.last().expect("there are faces");
    let cone = |vertex, face| GivenCone { vertex, face, curvature: None };
    let of = |cones: &[GivenCone]| {
        let others = [20, 30, 40, 80, 90, 100].map(|vertex| cone(vertex, None));
        let cones = [&others[..], cones].concat();
        unwrap_model(&model, &with(&Recipe { cones, ..Recipe::default() }, &Options::default()))
    };
    let told = |face| of(&[cone(shared, Some(face))]).expect("one cone more");
    for (face, part) in [(faces[0], 0), (last, 1)] {
        let atlas = told(face);
        let found: Vec<usize> = atlas.cones.iter().filter(|c| c.vertex == shared).map(|c| c.component).collect();
        assert_eq!(found, [part]);
        assert!(atlas.recipe().cones.iter().any(|cone| cone.vertex == shared && cone.face.is_some()));
        let again = unwrap_model(&model, &with(atlas.recipe(), &Options::default())).expect("it is made again");
        check_same(&[atlas, again]);
    }
    let both = of(&[cone(shared, Some(faces[0])), cone(shared, Some(last))]).expect("they are two");
    assert_eq!(both.cones.len(), 8);
    let repeated = of(&[cone(shared, Some(faces[0])), cone(shared, Some(faces[0]))]);
    assert!(matches!(repeated, Err(Error::RepeatedCone(v)) if v == shared));
    let elsewhere = of(&[cone(85, Some(faces[0]))]);
    assert!(matches!(elsewhere, Err(Error::NotAtFace { vertex: 85, face }) if face == faces[0]), "{elsewhere:?}");
}

#[test]
fn a_recipe_of_another_model_is_refused_and_one_of_the_unrefined_model_taken_as_that_was() {
    let hare = model(&shapes::hare(400));
    let first = unwrap_model(&hare, &Options::default()).expect("it unwraps");
    let other = Recipe { vertices: Some(401), ..first.recipe().clone() };
    let refused = unwrap_model(&hare, &with(&other, &Options::default()));
    assert!(matches!(refused, Err(Error::OtherModel { vertices: 401, .. })), "{refused:?}");
    // A ball of large triangles, which is refined where that is left to the program.
    let preparation = Preparation { refine: Refining::Needles, ..Preparation::default() };
    let options =
        Options { preparation, cones: ConeChoice::Count(2), free_seams: FreeSeams::Never, ..Options::default() };
    let ball = model(&shapes::sphere(40));
    let never = Options { preparation: Preparation::default(), ..options.clone() };
    let as_it_is = unwrap_model(&ball, &never).expect("it unwraps");
    let go_on = |_: Progress| ControlFlow::Continue(());
    let refined =
        |options: &Options| Analysis::unwrapped(&ball, options, go_on).expect("it unwraps").0.refined().is_some();
    assert_eq!([refined(&options), refined(&with(as_it_is.recipe(), &options))], [true, false]);
}

#[test]
fn what_was_refined_by_what_its_map_was_like_is_refined_so_again() {
    let preparation = Preparation { refine: Refining::Always, ..Preparation::default() };
    let options =
        Options { preparation, cones: ConeChoice::Count(2), free_seams: FreeSeams::Never, ..Options::default() };
    let maps = twice(&model(&shapes::sphere(40)), &options);
    assert_eq!(maps[0].recipe().refined_for.as_deref(), Some(&ConeChoice::Count(2)));
    assert_eq!(maps[0].uv, maps[1].uv);
    check_same(&maps);
}

#[test]
fn cones_of_a_map_with_straight_seams_are_taken_with_other_options_too() {
    let preparation = Preparation { refine: Refining::Always, ..Preparation::default() };
    let cones = ConeChoice::Count(8);
    let options = Options { preparation, cones, free_seams: FreeSeams::Never, ..Options::default() };
    let hare = model(&shapes::hare(700));
    let first = unwrap_model(&hare, &options).expect("it unwraps");
    assert!(first.recipe().straight);
    let seams = SeamOptions { weight: 0.0, ..SeamOptions::default() };
    let packing = PackOptions { margin: 40.0, ..PackOptions::default() };
    let others = [
        Options { seams, ..options.clone() },
        Options { packing, ..options.clone() },
        Options { islands: Islands::Pack, ..options.clone() },
    ];
    let mut are_new = Vec::new();
    for other in others {
        let map = unwrap_model(&hare, &with(first.recipe(), &other)).expect("it unwraps");
        assert_eq!((map.cones.len(), map.detached.len()), (8, 0));
        are_new.push(map.notes.iter().any(|note| matches!(note, Note::RefinedOtherwise { cones: 8, taken: 8 })));
    }
    assert!(are_new.contains(&true), "seams are others");
    // Not so with another model.
    let refused = unwrap_model(&model(&shapes::sphere(500)), &with(first.recipe(), &options));
    assert!(matches!(refused, Err(Error::OtherModel { .. })), "{refused:?}");
}

#[test]
fn an_atlas_has_the_repairs_and_the_model_that_it_is_of() {
    let mut shape = shapes::hare(300);
    shape.triangles.push([0, 0, 1]);
    let model = model(&shape);
    let plain = unwrap_model(&model, &Options::default()).expect("it unwraps");
    assert!(plain.repairs.iter().any(|repair| repair.kind == RepairKind::RepeatedVertex), "{:?}", plain.repairs);
    assert!(plain.refined.is_none());
    let preparation = Preparation { refine: Refining::Always, ..Preparation::default() };
    let atlas = unwrap_model(&model, &Options { preparation, ..Options::default() }).expect("it unwraps");
    let refined = atlas.refined.expect("that was asked for");
    assert_eq!(refined.model.corner_count(), atlas.uv.len());
}

#[test]
fn edges_on_the_boundary_are_open_already_and_that_is_said() {
    let square = model(&shapes::square(100));
    let mesh = shapes::square(100).mesh();
    let ends = |is_rim: bool| {
        let mut edges = mesh.edges().filter(|&e| mesh.is_boundary_edge(e) == is_rim);
        mesh.ends(edges.next().expect("there are both")).map(|v| v.0)
    };
    let given = vec![ends(true), ends(false)];
    let seams = SeamOptions { given, ..SeamOptions::default() };
    let atlas = unwrap_model(&square, &Options { seams, ..Options::default() }).expect("they are edges");
    assert!(atlas.notes.contains(&Note::SeamsOpen { edges: 1, of: 2 }), "{:?}", atlas.notes);
}
