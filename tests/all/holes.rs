//! Surfaces unwrapped as if their small holes were filled.

use cones::{
    Analysis, Atlas, ConeChoice, Handles, Note, Options, Preparation, Refining, SMALL_HOLE, SeamOptions, Symmetry,
    unwrap_model,
};
use geom::shapes::{self, Shape};
use geom::{Model, Weld};
use std::collections::{HashMap, HashSet};
use tests::oracle::check_map;
use tests::solids;

/// A shape without the triangles at some vertices.
fn pierced(shape: &Shape, at: &[u32]) -> Model {
    let is_left = |t: &&[u32; 3]| !t.iter().any(|v| at.contains(v));
    let triangles: Vec<[u32; 3]> = shape.triangles.iter().filter(is_left).copied().collect();
    Model::from_triangles(shape.points.clone(), &triangles).expect("an ordinary shape")
}

/// A hare with holes, one of them of two that touch.
fn hare() -> Model {
    let shape = shapes::hare(1500);
    let neighbours = |v: u32| -> HashSet<u32> {
        shape.triangles.iter().filter(|t| t.contains(&v)).flatten().copied().filter(|&w| w != v).collect()
    };
    let around = neighbours(700);
    let beyond: HashSet<u32> = around.iter().flat_map(|&v| neighbours(v)).collect();
    // Two rings away, with one neighbour in common.
    let touching = beyond.into_iter().filter(|v| *v != 700 && !around.contains(v));
    let touching = touching.filter(|&v| neighbours(v).intersection(&around).count() == 1).min().expect("there is one");
    pierced(&shape, &[100, 300, 700, touching, 1100])
}

fn filling(preparation: Preparation) -> Options {
    let preparation = Preparation { fill_holes: Some(SMALL_HOLE), ..preparation };
    Options { preparation, ..Options::default() }
}

/// Checks what is true of every map of a surface whose holes are filled: all of the surface is there, and nothing else.
fn check(model: &Model, atlas: &Atlas) {
    assert_eq!(atlas.uv.len(), model.corner_count());
    let found = check_map(model, atlas);
    assert_eq!((found.flipped, found.degenerate, found.torn), (0, 0, 0), "{:?}", atlas.notes);
    assert!(!atlas.notes.iter().any(|note| matches!(note, Note::Overlap { .. } | Note::SmallHoles { .. })));
    let mut faces_at: HashMap<[u32; 2], usize> = HashMap::new();
    let ascending = |a: u32, b: u32| [a.min(b), a.max(b)];
    for face in model.faces() {
        (0..3).for_each(|k| *faces_at.entry(ascending(face[k], face[(k + 1) % 3])).or_default() += 1);
    }
    for edge in atlas.seams.iter().flat_map(|seam| seam.windows(2)) {
        assert_eq!(faces_at.get(&ascending(edge[0], edge[1])), Some(&2), "seams are edges between two faces");
    }
    assert!(atlas.islands.iter().all(Option::is_some) && atlas.islands.len() == model.face_count());
}

/// Unwraps a model, checks the map, and makes it again.
fn unwrapped(model: &Model, options: &Options) -> Atlas {
    let atlas = unwrap_model(model, options).expect("it unwraps");
    let written = atlas.refined.as_ref().map_or(model, |refined| &refined.model);
    check(written, &atlas);
    assert_eq!(atlas.recipe().filled, Some(SMALL_HOLE));
    let recipe = ConeChoice::Recipe(Box::new(atlas.recipe().clone()));
    // The recipe says itself that holes are filled.
    let preparation = Preparation { fill_holes: None, ..options.preparation };
    let again =
        unwrap_model(model, &Options { cones: recipe, preparation, ..options.clone() }).expect("it is made again");
    assert_eq!((atlas.filled_holes, atlas.seams.len()), (again.filled_holes, again.seams.len()));
    assert_eq!(atlas.uv, again.uv, "to the bit");
    atlas
}

#[test]
fn no_seam_need_run_to_a_hole_and_nothing_of_its_cap_is_left() {
    let model = hare();
    let filled = unwrapped(&model, &filling(Preparation::default()));
    let open = unwrap_model(&model, &Options::default()).expect("it unwraps");
    let holes = Analysis::new(&model).expect("a sound model").topology().boundary_loops;
    assert_eq!((filled.filled_holes, open.filled_holes, open.recipe().filled), (holes, 0, None));
    assert!(open.notes.contains(&Note::SmallHoles { holes }), "{:?}", open.notes);
    assert!(check_map(&model, &open).euler.iter().all(|&chi| chi == 1), "islands are disks");
    assert!(filled.cones.iter().map(|cone| cone.curvature).sum::<f64>() - 4.0 * std::f64::consts::PI < 1e-9);
}

#[test]
fn an_island_may_have_holes() {
    let sheet = shapes::square(900);
    let at = |x: f64, y: f64| {
        let far = |v: &u32| (sheet.points[*v as usize][0] - x).hypot(sheet.points[*v as usize][1] - y);
        (0..sheet.points.len() as u32).min_by(|v, w| far(v).total_cmp(&far(w))).expect("it has vertices")
    };
    let middle = [0, 1].map(|c| sheet.points.iter().map(|p| p[c]).sum::<f64>() / sheet.points.len() as f64);
    let size = sheet.area().sqrt();
    let model = pierced(&sheet, &[-0.2, 0.2].map(|d| at(middle[0] + d * size, middle[1])));
    let atlas = unwrapped(&model, &filling(Preparation::default()));
    assert_eq!((atlas.filled_holes, atlas.cones.len(), atlas.seams.len()), (2, 0, 0));
    let found = check_map(&model, &atlas);
    assert_eq!(found.euler, [-1], "a disk with two holes");
    assert!(found.stretch < 1e-9, "it is unrolled: {found:?}");
}

#[test]
fn whatever_else_is_asked_for_goes_with_it() {
    let model = hare();
    let count = |cones| Options { cones: ConeChoice::Count(cones), ..filling(Preparation::default()) };
    unwrapped(&model, &count(8));
    unwrapped(&model, &Options { quantize: Some(Symmetry::Fourfold), ..count(8) });
    let refined = unwrapped(&model, &filling(Preparation { refine: Refining::Always, ..Preparation::default() }));
    assert!(refined.refined.is_some());
    let [a, b, c] = [0, 1, 2].map(|k| model.face(900)[k]);
    for seams in [
        SeamOptions { given: vec![[a, b], [b, c]], ..SeamOptions::default() },
        SeamOptions { kept: vec![[a, b]], ..SeamOptions::default() },
        SeamOptions { avoid: vec![[a, b], [b, c], [c, a]], ..SeamOptions::default() },
    ] {
        unwrapped(&model, &Options { seams, ..count(8) });
    }
}

#[test]
fn handles_are_opened_beside_holes() {
    let torus = shapes::torus(2, 1500);
    let model = pierced(&torus, &[50, 400, 900]);
    for handles in [Handles::Never, Handles::Always] {
        let atlas = unwrapped(&model, &filling(Preparation { handles, ..Preparation::default() }));
        assert_eq!(atlas.opened_handles, if handles == Handles::Always { 2 } else { 0 });
    }
}

#[test]
fn rims_that_are_long_stay_open() {
    let ball = shapes::sphere(900);
    let below: Vec<u32> = (0..ball.points.len() as u32).filter(|&v| ball.points[v as usize][2] < 0.0).collect();
    let bowl = pierced(&ball, &below);
    let [filled, open] = [filling(Preparation::default()), Options::default()]
        .map(|options| unwrap_model(&bowl, &options).expect("it unwraps"));
    assert_eq!((filled.filled_holes, filled.recipe().filled), (0, None));
    assert_eq!(filled.uv, open.uv);
}

#[test]
fn parts_of_one_shape_are_filled_alike() {
    let shape = shapes::hare(500);
    let count = shape.points.len() as u32;
    let pair = solids::side_by_side(&[shape.clone(), shape]);
    let model = pierced(&pair, &[100, 300, count + 100, count + 300]);
    let atlas = unwrapped(&model, &filling(Preparation::default()));
    assert_eq!(atlas.filled_holes, 4);
    let of = |part: usize| -> Vec<u32> {
        atlas.cones.iter().filter(|cone| cone.component == part).map(|cone| cone.vertex).collect()
    };
    assert_eq!(of(0).iter().map(|v| v + count).collect::<Vec<_>>(), of(1));
}

#[test]
fn a_slit_is_unwrapped_as_the_surface_without_it() {
    // A sphere with some edges in a row opened: the vertices between them are there twice.
    let sphere = shapes::sphere(600);
    let mesh = sphere.mesh();
    let mut way = vec![mesh.halfedges().next().expect("it has edges")];
    while way.len() < 4 {
        // Straight on at vertices of six triangles, as good as that elsewhere.
        let last = way[way.len() - 1];
        let back = mesh.twin(last).expect("it is closed");
        let ring: Vec<_> = mesh.outgoing(mesh.head(last)).collect();
        let at = ring.iter().position(|&h| h == back).expect("it goes out of there");
        way.push(ring[(at + ring.len() / 2) % ring.len()]);
    }
    // The triangles on the left of the way at its inner vertices get copies.
    let (mut points, mut triangles) = (sphere.points.clone(), sphere.triangles.clone());
    for step in way.windows(2) {
        let v = mesh.head(step[0]);
        let ring: Vec<_> = mesh.outgoing(v).collect();
        let at = |h| ring.iter().position(|&other| other == h).expect("it goes out of there");
        let (from, to) = (at(step[1]), at(mesh.twin(step[0]).expect("it is closed")));
        let copy = points.len() as u32;
        points.push(points[v.0 as usize]);
        let left = (0..ring.len()).map(|k| (from + k) % ring.len()).take_while(|&k| k != to);
        for f in left.map(|k| mesh.face(ring[k])) {
            triangles[f.0 as usize].iter_mut().filter(|w| **w == v.0).for_each(|w| *w = copy);
        }
    }
    let slit = Model::from_triangles(points, &triangles).expect("an ordinary shape");
    let options = filling(Preparation { weld: Weld::Never, ..Preparation::default() });
    let options = Options { cones: ConeChoice::Count(4), ..options };
    let closed = unwrap_model(&solids::model(&sphere).expect("an ordinary shape"), &options).expect("it unwraps");
    let atlas = unwrapped(&slit, &options);
    assert_eq!(atlas.filled_holes, 1);
    assert!(atlas.seam_figures.length < 1.1 * closed.seam_figures.length);
    let predicted = |atlas: &Atlas| check_map(&slit, atlas).stretch;
    assert!(predicted(&atlas) < 20.0);
}

#[test]
fn angles_at_an_open_boundary_stay_whole_beside_a_filled_hole() {
    // A wavy sheet of squares with one hole, slit by an edge from its rim: at the inner end of the slit the surface has nearly a whole turn.
    let (wide, high) = (22_u32, 21_u32);
    let at = |x: u32, y: u32| (wide + 1) * y + x;
    let place = |v: u32| [f64::from(v % (wide + 1)) / f64::from(wide), f64::from(v / (wide + 1)) / f64::from(high)];
    let raised = |[x, y]: [f64; 2]| [x, y, 0.025 * (7.0 * x).sin() * (5.0 * y).cos()];
    let mut points: Vec<[f64; 3]> = (0..(wide + 1) * (high + 1)).map(place).map(raised).collect();
    let (hole, slit) = (at(5, 10), at(wide, 3));
    let copy = points.len() as u32;
    points.push(points[slit as usize]);
    let squares = (0..wide * high).map(|k| (k % wide, k / wide));
    let corners = |(x, y): (u32, u32)| {
        let own = |v: u32| if v == slit && y >= 3 { copy } else { v };
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)].map(own);
        [[a, b, c], [a, c, d]]
    };
    let triangles: Vec<[u32; 3]> = squares.flat_map(corners).filter(|t| !t.contains(&hole)).collect();
    let model = Model::from_triangles(points, &triangles).expect("a sound sheet");
    let atlas = unwrapped(&model, &filling(Preparation { weld: Weld::Never, ..Preparation::default() }));
    assert_eq!((atlas.filled_holes, atlas.cones.len()), (1, 0));
    assert!(atlas.detached.is_empty() && atlas.notes.is_empty(), "{:?}", atlas.notes);
}
