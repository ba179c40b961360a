//! One analysis, asked many things: the same answers whoever asks, when, and what was stopped before.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Barrier};
use std::time::{Duration, Instant};

use cones::report::{MeasuredAtlas, UvSize};
use cones::uv::{PackOptions, Tiles};
use cones::{
    Analysis, Atlas, Baseline, ConeChoice, Cones, CurvatureRule, Error, FreeSeams, Handles, Islands, Note, Options,
    Placement, Preparation, Progress, Refining, SeamOptions, Symmetry, unwrap_model,
};
use geom::shapes::{self, Shape};
use geom::{Attributes, Model, Weld, distortion, vector};
use tests::oracle::check_map;
use tests::solids;

/// A closed surface, one with handles, one with a boundary, and one that is flat.
fn several() -> Model {
    let shapes = [shapes::hare(900), shapes::torus(2, 600), shapes::terrain(400, 3), shapes::square(100)];
    model(&solids::side_by_side(&shapes))
}

fn model(shape: &Shape) -> Model {
    solids::model(shape).expect("an ordinary shape")
}

fn count(count: usize) -> Options {
    Options { cones: ConeChoice::Count(count), ..Options::default() }
}

fn placed(cones: &Cones) -> String {
    format!("{:?} {:?} {:?} {:?}", cones.as_slice(), cones.prediction(), cones.number(), cones.notes())
}

fn laid_out(atlas: &Atlas) -> String {
    let Atlas { uv, cones, seams, number, notes, detached, .. } = atlas;
    format!("{uv:?} {cones:?} {seams:?} {number:?} {notes:?} {detached:?}")
}

/// The answer to the bit: what is printed of a number is read back as that number.
type Question = fn(&Analysis) -> Result<String, Error>;

/// Something of everything that an analysis is asked.
const QUESTIONS: [Question; 10] = [
    |analysis| Ok(format!("{:?}", analysis.preview(17)?)),
    |analysis| Ok(placed(&analysis.place(Placement::Refined, 14)?)),
    |analysis| Ok(placed(&analysis.place(Placement::Pursuit, 11)?)),
    |analysis| Ok(placed(&analysis.place(Placement::Iterative, 16)?)),
    |analysis| Ok(placed(&analysis.place(Placement::Persistence, 30)?)),
    |analysis| Ok(format!("{:?}", analysis.order(Placement::Refined, CurvatureRule::Optimal, 20)?)),
    |analysis| {
        Ok(format!(
            "{:?}",
            analysis.predict(&[3, 50, 333, 700, 1000, 1080, 1160, 1240, 1320, 1400, 1700], CurvatureRule::Harmonic)?
        ))
    },
    |analysis| Ok(laid_out(&analysis.flatten(&analysis.place(Placement::Alternating, 12)?)?)),
    |analysis| Ok(laid_out(&analysis.atlas(&Options::default())?)),
    |analysis| {
        let cones = analysis.place(Placement::Persistence, 10)?;
        Ok(format!("{:?}", analysis.flatten_by(Baseline::LinearScaling, &cones)?.uv))
    },
];

fn answer(question: Question, analysis: &Analysis) -> String {
    question(analysis).expect("nobody says stop")
}

#[test]
fn answers_depend_neither_on_what_was_asked_before_nor_on_what_is_asked_at_the_same_time() {
    let model = several();
    let analysis = || Analysis::new(&model).expect("a sound model");
    let alone = QUESTIONS.map(|question| answer(question, &analysis()));
    let shared = analysis();
    for (k, question) in QUESTIONS.iter().enumerate().rev() {
        assert!(answer(*question, &shared) == alone[k], "question {k} asked after all later ones");
    }
    let shared = analysis();
    let begin = Barrier::new(2);
    let ask = |order: Vec<usize>| {
        begin.wait();
        order.into_iter().filter(|&k| answer(QUESTIONS[k], &shared) != alone[k]).collect::<Vec<usize>>()
    };
    let wrong = std::thread::scope(|scope| {
        let forwards = scope.spawn(|| ask((0..QUESTIONS.len()).collect()));
        let backwards = scope.spawn(|| ask((0..QUESTIONS.len()).rev().collect()));
        [forwards, backwards].map(|asked| asked.join().expect("no panic"))
    });
    assert_eq!(
        wrong,
        [const { Vec::<usize>::new() }; 2],
        "questions that are answered otherwise where two threads ask"
    );
}

/// Says stop when it is told for the `last`-th time, counted from 1, and ever after; says how often it was told.
fn stopping_at(last: usize) -> (impl Fn(Progress) -> ControlFlow<()> + Send + Sync, Arc<AtomicUsize>) {
    let told = Arc::new(AtomicUsize::new(0));
    let count = Arc::clone(&told);
    let hear = move |_| {
        if count.fetch_add(1, Relaxed) + 1 >= last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    (hear, told)
}

/// Whether an answer is the right one, or none because the observer has said stop.
fn is_stopped(answer: Result<String, Error>, expected: &str, (last, told): (usize, &AtomicUsize)) -> bool {
    match answer {
        Ok(answer) => {
            assert!(told.load(Relaxed) < last, "stopped, and yet it has an answer");
            assert!(answer == expected, "an observer changes nothing");
            false
        }
        Err(Error::Interrupted) => {
            assert!(told.load(Relaxed) >= last, "nothing else interrupts");
            true
        }
        Err(error) => panic!("another error than the one of a stop: {error}"),
    }
}

#[test]
fn what_was_stopped_anywhere_can_be_asked_again() {
    let model = several();
    let quiet = Analysis::new(&model).expect("a sound model");
    for (k, &question) in QUESTIONS.iter().enumerate() {
        let expected = answer(question, &quiet);
        let mut stopped = 0;
        for last in [1, 2, 5, 20] {
            // What it keeps of an answer it need not find again.
            let fresh = Analysis::new(&model).expect("a sound model");
            let (observer, told) = stopping_at(last);
            let asked = question(&fresh.with_observer(observer));
            stopped += usize::from(is_stopped(asked, &expected, (last, &told)));
            assert!(answer(question, &fresh) == expected, "question {k} after a stop at call {last}");
        }
        assert!(stopped >= 2, "question {k} tells an observer at least once a part");
    }
}

#[test]
fn an_analysis_can_be_stopped_while_it_is_made() {
    let model = several();
    let expected = answer(QUESTIONS[3], &Analysis::new(&model).expect("a sound model"));
    let mut stopped = 0;
    for last in [1, 2, 3, 5, 8, 9, 10, 20] {
        let (observer, told) = stopping_at(last);
        let asked = Analysis::observed(&model, Preparation::default(), observer).and_then(|made| QUESTIONS[3](&made));
        stopped += usize::from(is_stopped(asked, &expected, (last, &told)));
    }
    assert!(stopped >= 5, "it tells an observer at least twice a part");
    assert!(answer(QUESTIONS[3], &Analysis::new(&model).expect("a sound model")) == expected);
}

#[test]
fn an_observer_hears_every_stage_of_every_part() {
    let heard = Arc::new(std::sync::Mutex::new(Vec::new()));
    let listener = Arc::clone(&heard);
    let observer = move |progress: Progress| {
        listener.lock().expect("no panic").push(progress);
        ControlFlow::Continue(())
    };
    let analysis = Analysis::observed(&several(), Preparation::default(), observer).expect("a sound model");
    analysis.atlas(&count(20)).expect("it unwraps");
    let heard = heard.lock().expect("no panic");
    let of = |stage, component| heard.iter().filter(move |told| told.stage == stage && told.component == component);
    for stage in cones::Stage::ALL {
        for component in 0..4 {
            let is_one_for_all = matches!(stage, cones::Stage::Prepare | cones::Stage::Pack);
            assert_eq!(of(stage, component).count() > 0, component == 0 || !is_one_for_all, "{stage:?} {component}");
        }
    }
    assert!(heard.iter().all(|told| told.components == if told.stage == cones::Stage::Prepare { 0 } else { 4 }));
    assert!(heard.iter().flat_map(|told| told.fraction).all(|fraction| (0.0..=1.0).contains(&fraction)));
}

#[test]
fn fractions_told_of_a_stage_rise_until_it_begins_again() {
    let heard = Arc::new(std::sync::Mutex::new(Vec::new()));
    let listener = Arc::clone(&heard);
    let observer = move |progress: Progress| {
        listener.lock().expect("no panic").push(progress);
        ControlFlow::Continue(())
    };
    // Its layout overlaps, so that other trees of seams are tried at the same time.
    let analysis = Analysis::new(&model(&shapes::hare(4000))).expect("a sound model").with_observer(observer);
    let as_laid_out = analysis.atlas(&Options { islands: Islands::Single, ..count(32) }).expect("it unwraps");
    assert!(as_laid_out.notes.iter().any(|note| matches!(note, Note::Overlap { .. })), "{:?}", as_laid_out.notes);
    heard.lock().expect("no panic").clear();
    analysis.atlas(&Options { islands: Islands::Pack, ..count(32) }).expect("it unwraps");
    let heard = heard.lock().expect("no panic");
    for stage in cones::Stage::ALL {
        let told: Vec<f64> = heard.iter().filter(|told| told.stage == stage).filter_map(|told| told.fraction).collect();
        assert!(told.windows(2).all(|pair| pair[0] <= pair[1] || pair[1] == 0.0), "{stage:?}: {told:?}");
    }
    assert!(heard.len() > 50, "heard only {} times", heard.len());
}

#[test]
fn the_hare_of_twelve_thousand_vertices_with_sixteen_cones_comes_out_without_a_flaw() {
    let model = model(&shapes::hare(12_000));
    let analysis = Analysis::new(&model).expect("a sound model");
    let atlas = analysis.flatten(&analysis.place(Placement::Refined, 16).expect("a sound model")).expect("it unwraps");
    let found = check_map(&model, &atlas);
    assert_eq!((found.flipped, found.degenerate, found.torn), (0, 0, 0), "{:?}", atlas.notes);
    assert!(found.euler.iter().all(|&chi| chi == 1), "islands are disks: {:?}", found.euler);
    assert_eq!((atlas.detached.len(), atlas.cones.len()), (0, 16));
    assert_eq!(atlas.notes, []);
    assert!(found.seam_mismatch < 1e-6 && found.curvature < 1e-6);
}

#[test]
fn cones_of_another_analysis_are_refused() {
    let model = model(&shapes::hare(500));
    let [own, other] = [0, 1].map(|_| Analysis::new(&model).expect("a sound model"));
    let cones = own.place(Placement::Persistence, 5).expect("a sound model");
    assert!(matches!(other.flatten(&cones), Err(Error::ForeignCones)));
    assert!(matches!(other.flatten_by(Baseline::LeastSquares, &cones), Err(Error::ForeignCones)));
    let (observer, _) = stopping_at(usize::MAX);
    for same in [own.clone(), own.with_observer(observer)] {
        assert!(same.flatten(&cones).is_ok(), "clones share what was found");
    }
    let vertices: Vec<u32> = cones.iter().map(|cone| cone.vertex).collect();
    let given = other.given(&vertices, CurvatureRule::Optimal).expect("they are vertices there too");
    assert_eq!(
        laid_out(&other.flatten(&given).expect("it unwraps")),
        laid_out(&own.flatten(&cones).expect("it unwraps"))
    );
}

/// What the operating system does in between belongs to no stage: the best of some runs counts.
#[test]
fn the_times_of_stages_add_up_to_the_time_on_the_clock() {
    let model = several();
    let share = |_| {
        let began = Instant::now();
        let analysis = Analysis::new(&model).expect("a sound model");
        let cones = analysis.place(Placement::Refined, 24).expect("a sound model");
        let atlas = analysis.flatten(&cones).expect("it unwraps");
        let clock = began.elapsed();
        let told: Duration = [analysis.times(), cones.times(), atlas.times].iter().map(cones::Times::total).sum();
        told.as_secs_f64() / clock.as_secs_f64()
    };
    let mut shares = Vec::new();
    while shares.len() < 20 && shares.iter().all(|share| *share < 0.9) {
        shares.push(share(shares.len()));
        assert!(shares.iter().all(|share| *share <= 1.0), "{shares:?}");
    }
    assert!(shares.iter().any(|share| *share >= 0.9), "{shares:?}");
    let whole = unwrap_model(&model, &count(24)).expect("it unwraps").times;
    let of = |stage| whole.of(stage);
    assert_eq!(cones::Stage::ALL.map(of).iter().sum::<Duration>(), whole.total());
    assert!(cones::Stage::ALL.map(of).iter().all(|time| *time > Duration::ZERO), "{whole:?}");
}

fn notes(shape: &Shape, options: &Options) -> (Vec<Note>, Atlas) {
    let atlas = unwrap_model(&model(shape), options).expect("it unwraps");
    (atlas.notes.clone(), atlas)
}

#[test]
fn where_parts_need_more_cones_than_were_asked_for_it_is_said_for_all_of_them() {
    let two = solids::side_by_side(&[solids::bumpy_sphere(3), solids::bumpy_sphere(2)]);
    let (told, atlas) = notes(&two, &count(5));
    assert_eq!(told, [Note::FewerThanNeeded { asked: 5, needed: 6, components: 2 }]);
    assert_eq!((atlas.cones.len(), told[0].component()), (6, None));
    let analysis = Analysis::new(&model(&two)).expect("sound shapes");
    let cones = analysis.place(Placement::Refined, 5).expect("sound shapes");
    assert_eq!((cones.notes(), analysis.flatten(&cones).expect("they unwrap").notes), (&told[..], told.clone()));
    let each = |counts: &[usize]| Options { cones: ConeChoice::Each(counts.to_vec()), ..Options::default() };
    let (told, atlas) = notes(&two, &each(&[8, 2]));
    assert_eq!(told, [Note::MoreForCurvature { component: 1, asked: 2, taken: 3 }]);
    assert_eq!(atlas.cones.len(), 11);
    assert!(notes(&two, &each(&[8, 3])).0.is_empty());
    let refused = unwrap_model(&model(&two), &each(&[8, 3, 3])).expect_err("there is no third part");
    assert!(refused.to_string().starts_with("3 numbers of cones are given, but there are 2 parts"), "{refused}");
    let threshold = Options { cones: ConeChoice::MinPersistence(1e9), ..Options::default() };
    let (told, atlas) = notes(&two, &threshold);
    // The highest and the lowest point of a part have a saddle at no height at all.
    assert_eq!(told, [Note::FewExtrema { threshold: 1e9, above: 0, taken: 6, components: 2 }]);
    assert_eq!(atlas.cones.len(), 6);
    assert_eq!(notes(&two, &count(6)).0, []);
    let threshold = Options { cones: ConeChoice::MinPersistence(0.05), ..Options::default() };
    let (told, atlas) = notes(&shapes::hare(600), &threshold);
    assert!(told.is_empty() && atlas.cones.len() > 3, "{told:?}");
}

#[test]
fn where_vertices_are_too_few_for_cones_it_is_said() {
    let octahedron = solids::side_by_side(&[solids::bumpy_sphere(2), solids::octahedron()]);
    let options = Options { cones: ConeChoice::Each(vec![4, 20]), ..Options::default() };
    let (told, atlas) = notes(&octahedron, &options);
    assert_eq!(told, [Note::FewVertices { component: 1, asked: 20, there: 6 }]);
    assert_eq!(atlas.cones.len(), 10);
}

#[test]
fn where_cones_cannot_take_the_curvature_more_are_taken_and_it_is_said() {
    let torus = shapes::torus(6, 1500);
    let closed = Preparation { handles: Handles::Never, ..Preparation::default() };
    let count = |number| Options { preparation: closed, ..count(number) };
    let (told, atlas) = notes(&torus, &count(2));
    let [Note::MoreForCurvature { component: 0, asked: 2, taken }] = told[..] else { panic!("{told:?}") };
    assert!(taken > 2 && atlas.cones.len() == taken, "{told:?}");
    let (told, _) = notes(&torus, &count(taken));
    assert_eq!(told, [], "so many are enough");
    let (told, _) = notes(&torus, &count(taken - 1));
    assert_eq!(told.len(), 1, "one less is not, and the rule that adds goes one by one here: {told:?}");
}

#[test]
fn more_cones_than_are_optimised_are_placed_by_persistence_and_it_is_said() {
    let shape = shapes::terrain(900, 5);
    let (told, atlas) = notes(&shape, &count(cones::MOST_OPTIMISED + 1));
    let cones = cones::MOST_OPTIMISED + 1;
    assert_eq!(told, [Note::PlacedByPersistence { component: 0, cones }]);
    let by_persistence = Options { placement: Placement::Persistence, ..count(cones) };
    let (told, expected) = notes(&shape, &by_persistence);
    assert_eq!((told, expected.cones), (vec![], atlas.cones));
    let (told, _) = notes(&shapes::sphere(20), &count(100_000));
    assert!(matches!(told[..], [Note::FewVertices { asked: 100_000, .. }]), "they are few: {told:?}");
    assert_eq!(notes(&shape, &count(cones::MOST_OPTIMISED)).0, []);
}

/// Two cones of a double torus have -4π between them; pinned to 0, one may be asked for more than its triangles allow.
#[test]
fn harmonic_curvatures_out_of_bounds_are_replaced_and_it_is_said() {
    let shape = shapes::torus(2, 400);
    let vertices = shape.points.len() as u32;
    let analysis = Analysis::new(&model(&shape)).expect("a sound shape");
    let (mut kept, mut replaced) = (0, 0);
    for k in 0..60 {
        let cones = [7 * k % vertices, (8 * k + 1) % vertices];
        let Ok(harmonic) = analysis.given(&cones, CurvatureRule::Harmonic) else { continue };
        match harmonic.notes() {
            [] => kept += 1,
            &[Note::HarmonicOutOfBounds { component: 0, count: 1, cones: 2, first }] => {
                assert!(cones.contains(&first));
                let optimal = analysis.given(&cones, CurvatureRule::Optimal).expect("they can take it");
                assert_eq!(harmonic.as_slice(), optimal.as_slice());
                replaced += 1;
            }
            other => panic!("{other:?}"),
        }
        let sum: f64 = harmonic.iter().map(|cone| cone.curvature).sum();
        assert!((sum + 2.0 * std::f64::consts::TAU).abs() < 1e-9, "{harmonic:?}");
    }
    assert!(kept >= 5 && replaced >= 2, "{kept} pairs keep the rule, {replaced} do not");
}

#[test]
fn given_cones_are_taken_as_they_are_or_refused() {
    let closed = Analysis::new(&model(&shapes::hare(400))).expect("a sound shape");
    let open = Analysis::new(&model(&shapes::square(100))).expect("a sound shape");
    let choose = |analysis: &Analysis, given: &[(u32, Option<f64>)]| {
        analysis.choose(&Options { cones: ConeChoice::Given(given.to_vec()), ..Options::default() })
    };
    let optimal = closed.place(Placement::Refined, 6).expect("a sound shape");
    let given: Vec<(u32, Option<f64>)> = optimal.iter().map(|cone| (cone.vertex, Some(cone.curvature))).collect();
    let again = choose(&closed, &given).expect("they are possible");
    assert_eq!((again.placement(), again.len()), (None, 6));
    let [before, after] = [&optimal, &again].map(|cones| cones.prediction().log_scale_norm);
    assert!((before - after).abs() < 1e-9 * before, "what is predicted is for the curvatures: {before} {after}");
    let options = Options { cones: ConeChoice::Given(given.clone()), ..Options::default() };
    let times = closed.atlas(&options).expect("it unwraps").times;
    assert!(times.of(cones::Stage::Curvature) > Duration::ZERO, "placing them counts too: {times:?}");

    let with = |change: f64| [&[(given[0].0, given[0].1.map(|k| k + change))], &given[1..]].concat();
    assert!(choose(&closed, &with(1e-9)).is_ok());
    assert!(matches!(choose(&closed, &with(1e-3)), Err(Error::CurvatureSum { .. })));
    assert!(matches!(choose(&closed, &[(1, None), (2, None), (1, None)]), Err(Error::RepeatedCone(1))));
    assert!(matches!(choose(&closed, &[(1, None), (2, Some(1.0))]), Err(Error::SomeCurvatures { known: 1, given: 2 })));
    assert!(matches!(choose(&closed, &[(1, None), (99_999, None)]), Err(Error::NoSuchCone { vertex: 99_999, .. })));
    let mesh = shapes::square(100).mesh();
    let [inner, outer] = [false, true]
        .map(|is_outer| mesh.vertices().find(|&v| mesh.is_boundary_vertex(v) == is_outer).expect("there are both").0);
    assert!(matches!(choose(&open, &[(outer, None)]), Err(Error::ConeOnBoundary(v)) if v == outer));
    assert!(choose(&open, &[(inner, Some(6.2))]).is_ok());
    assert!(matches!(choose(&open, &[(inner, Some(6.3))]), Err(Error::CurvatureTooLarge(k)) if k == 6.3));
}

#[test]
fn each_part_gets_what_it_was_given_or_what_it_needs() {
    let two = solids::side_by_side(&[solids::bumpy_sphere(3), solids::bumpy_sphere(2), shapes::square(100)]);
    let analysis = Analysis::new(&model(&two)).expect("sound shapes");
    let options = Options { cones: ConeChoice::Each(vec![5, 0]), ..Options::default() };
    let cones = analysis.choose(&options).expect("sound shapes");
    let of = |part: usize| cones.iter().filter(|cone| cone.component == part).count();
    let told = [Note::MoreForCurvature { component: 1, asked: 0, taken: 3 }];
    assert_eq!(([0, 1, 2].map(of), cones.notes()), ([5, 3, 0], &told[..]));
    let by_sign = |cone: &&cones::Cone| (cone.kind == cones::Kind::Minimum) == (cone.curvature >= 0.0);
    assert!(cones.iter().filter(|cone| cone.persistence.is_none()).all(|cone| by_sign(&cone)), "{cones:?}");
}

/// The mean of max(r, 1/r) over a map.
fn measured(model: &Model, atlas: &Atlas) -> f64 {
    let corners = |t: &[u32; 3]| t.map(|c| atlas.uv[c as usize]);
    let uv: Vec<_> = atlas.triangles.corners.iter().map(corners).collect();
    let vertices: Vec<_> = atlas.triangles.corners.iter().map(|t| t.map(|c| model.corners()[c as usize])).collect();
    distortion::measure(model.points(), &vertices, &uv).expect("it has area").area.mean
}

#[test]
fn a_target_that_cannot_be_reached_is_missed_by_what_is_said() {
    let model = model(&shapes::hare(1500));
    let options = Options { cones: ConeChoice::WithinDistortion(1.0001), ..Options::default() };
    let atlas = unwrap_model(&model, &options).expect("it unwraps");
    assert!(atlas.cones.len() >= 300, "{} cones are not the nearest", atlas.cones.len());
    let number = atlas.number.clone().expect("it was chosen");
    assert!(!number.is_met);
    let missed = |note: &Note| matches!(note, Note::TargetMissed { .. });
    let Some(&Note::TargetMissed { component: 0, target: 1.0001, reached, cones }) =
        atlas.notes.iter().find(|n| missed(n))
    else {
        panic!("{:?}", atlas.notes)
    };
    assert_eq!(cones, atlas.cones.len());
    let measured = measured(&model, &atlas);
    assert!((reached - measured).abs() < 1e-9 * measured, "{reached} {measured}");
}

#[test]
fn a_prism_of_many_sides_becomes_its_net() {
    let sides = 32;
    let ring = |z: f64| (0..sides).map(move |k| (f64::from(k) * std::f64::consts::TAU / f64::from(sides), z));
    let points: Vec<[f64; 3]> = ring(0.0).chain(ring(6.0)).map(|(a, z)| [a.cos(), a.sin(), z]).collect();
    let wall = |k: u32| [[k, (k + 1) % sides, sides + k], [(k + 1) % sides, sides + (k + 1) % sides, sides + k]];
    let caps = (1..sides - 1).flat_map(|k| [[0, k + 1, k], [sides, sides + k, sides + k + 1]]);
    let triangles = (0..sides).flat_map(wall).chain(caps).collect();
    let model = model(&Shape { points, triangles });
    let atlas = unwrap_model(&model, &Options::default()).expect("it unwraps");
    assert_eq!(atlas.cones.len(), 64);
    assert!(measured(&model, &atlas) < 1.0 + 1e-9);
}

#[test]
fn an_open_pyramid_is_cut_though_it_is_a_disk() {
    // The second's seam is longer than a net's may be, the third is a ruin without.
    for height in [1.0, 1.9, 3.0] {
        let base = [[0.5, 0.5, 0.0], [-0.5, 0.5, 0.0], [-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.0, 0.0, height]];
        let shape = Shape { points: base.to_vec(), triangles: (0..4).map(|k| [k, (k + 1) % 4, 4]).collect() };
        let model = model(&shape);
        let atlas = unwrap_model(&model, &Options::default()).expect("it unwraps");
        assert_eq!(atlas.cones.len(), 1);
        assert!(measured(&model, &atlas) < 1.0 + 1e-9);
    }
}

#[test]
fn a_cup_becomes_its_net_though_it_needs_no_seam() {
    let sides = 6;
    let ring = |z: f64| (0..sides).map(move |k| (f64::from(k) * std::f64::consts::TAU / f64::from(sides), z));
    let points = ring(0.0).chain(ring(0.2)).map(|(a, z)| [a.cos(), a.sin(), z]).collect();
    let wall = |k: u32| [[k, (k + 1) % sides, sides + k], [(k + 1) % sides, sides + (k + 1) % sides, sides + k]];
    let bottom = (1..sides - 1).map(|k| [0, k + 1, k]);
    let model = model(&Shape { points, triangles: (0..sides).flat_map(wall).chain(bottom).collect() });
    let atlas = unwrap_model(&model, &Options::default()).expect("it unwraps");
    assert_eq!(atlas.cones.len(), 6);
    assert!(measured(&model, &atlas) < 1.0 + 1e-9);
}

#[test]
fn given_cones_are_doubted_only_where_the_map_is_bad() {
    let shape = shapes::hare(900);
    let analysis = Analysis::new(&model(&shape)).expect("a sound model");
    let doubts = |cones: &Cones| -> Vec<f64> {
        let atlas = analysis.flatten(cones).expect("it unwraps");
        let map = MeasuredAtlas::new(&model(&shape), atlas, UvSize::Unit, analysis.weld()).expect("it is finite");
        let area = |note: &Note| match note {
            Note::Distorted { area, log, .. } => {
                // Of this map: what its triangles have.
                assert!((log - map.quality.distortion.u_linf).abs() < 1e-6, "{log}");
                Some(*area)
            }
            _ => None,
        };
        map.atlas.notes.iter().filter_map(area).collect()
    };
    let good = analysis.choose(&Options::default()).expect("a sound model");
    let vertices: Vec<u32> = good.iter().map(|cone| cone.vertex).collect();
    assert!(doubts(&analysis.given(&vertices, CurvatureRule::Optimal).expect("as before")).is_empty());
    let bad = analysis.given(&[0, 1, 2, 3], CurvatureRule::Optimal).expect("they take the curvature");
    let area = doubts(&bad);
    assert!(area.len() == 1 && area[0] > 4.0, "{area:?}");
}

#[test]
fn a_refined_model_is_the_same_surface_with_a_map_without_a_flaw() {
    let needles = solids::mapped(&shapes::torus(2, 400), |[x, y, z]| [x, y, 0.02 * z]);
    let both = solids::side_by_side(&[needles, shapes::terrain(200, 3)]);
    let given = model(&both);
    let analysis = Analysis::with(&given, Preparation { refine: Refining::Always, ..Preparation::default() });
    let analysis = analysis.expect("a sound model");
    let refined = analysis.refined().expect("it was asked for");
    assert!(refined.is_complete && refined.model.face_count() > given.face_count());
    assert_eq!(&refined.model.points()[..given.vertex_count()], given.points());
    assert!(refined.face.is_sorted() && refined.face.len() == refined.model.face_count());
    for (parts, point) in refined.added.iter().zip(&refined.model.points()[given.vertex_count()..]) {
        for (c, x) in point.iter().enumerate() {
            let mixed: f64 = parts.iter().map(|&(v, weight)| weight * given.points()[v as usize][c]).sum();
            assert!((mixed - x).abs() < 1e-12);
        }
    }
    let atlas = analysis.atlas(&Options::default()).expect("it unwraps");
    let found = check_map(&refined.model, &atlas);
    assert_eq!((found.flipped, found.degenerate, found.torn), (0, 0, 0), "{:?}", atlas.notes);
    assert!(found.seam_mismatch < 1e-6 && atlas.detached.is_empty());
}

/// A surface with cones in plenty, a face of it again every here and there, and faces that have a vertex twice.
fn with_spare_faces() -> (Model, usize) {
    let Shape { points, triangles } = shapes::hare(500);
    let count = triangles.len();
    let copies = triangles.iter().step_by(7).map(|&[a, b, c]| [b, a, c]);
    let twice = triangles.iter().step_by(9).map(|&[a, b, _]| [a, b, b]);
    let faces: Vec<[u32; 3]> = triangles.iter().copied().chain(copies).chain(twice).collect();
    (Model::from_triangles(points, &faces).expect("an ordinary model"), count)
}

#[test]
fn spare_faces_lie_where_their_originals_do_or_over_nothing() {
    let (model, count) = with_spare_faces();
    let analysis = Analysis::new(&model).unwrap();
    let Atlas { uv, triangles, left_out, seams, .. } = analysis.atlas(&self::count(16)).unwrap();
    assert!(left_out.len() == triangles.len() - count && seams.len() > 10);
    let vertex = |corner: &u32| model.corners()[*corner as usize];
    let placed = |t: u32| {
        let mut corners = triangles.corners[t as usize];
        corners.sort_unstable_by_key(vertex);
        corners.map(|c| (vertex(&c), uv[c as usize]))
    };
    let on_surface: Vec<[(u32, [f64; 2]); 3]> = (0..count as u32).map(placed).collect();
    for &t in &left_out {
        let corners = placed(t);
        let is_point = corners.iter().all(|corner| corner.1 == corners[0].1);
        assert!(is_point || on_surface.contains(&corners), "{corners:?}");
        assert_eq!(is_point, corners[0].0 == corners[1].0 || corners[1].0 == corners[2].0);
    }
}

#[test]
fn copies_of_polygons_have_the_positions_of_their_originals_whatever_their_diagonals() {
    let side = 5_u32;
    let at = |v: u32| [f64::from(v % side), f64::from(v / side), 0.2 * f64::from(v % 3)];
    let points: Vec<[f64; 3]> = (0..side * side).map(at).collect();
    let corner = |k: u32| side * (k / (side - 1)) + k % (side - 1);
    let squares: Vec<[u32; 4]> =
        (0..(side - 1).pow(2)).map(|k| [0, 1, side + 1, side].map(|v| corner(k) + v)).collect();
    let turned = squares.iter().map(|&[a, b, c, d]| [c, b, a, d]);
    let faces: Vec<[u32; 4]> = squares.iter().copied().chain(turned).collect();
    let model = Model::from_polygons(points, &faces).unwrap();
    let atlas = unwrap_model(&model, &Options::default()).unwrap();
    for (original, copy) in (0..squares.len()).zip(squares.len()..) {
        let place = |face: usize, v: u32| {
            let corner =
                model.face_corners(face).find(|&c| model.corners()[c] == v).expect("it is one of its vertices");
            atlas.uv[corner]
        };
        faces[copy].iter().for_each(|&v| assert_eq!(place(copy, v), place(original, v), "face {copy}"));
    }
}

#[test]
fn copies_of_faces_are_refined_as_their_originals_are() {
    let (model, count) = with_spare_faces();
    let refine = Preparation { refine: Refining::Always, ..Preparation::default() };
    let analysis = Analysis::with(&model, refine).unwrap();
    let Atlas { uv, triangles, left_out, .. } = analysis.atlas(&self::count(16)).unwrap();
    let refined = analysis.refined().expect("it was asked for");
    // Each face's pieces with their positions, from the least vertex on; the copies were turned over.
    let mut pieces = vec![Vec::new(); model.face_count()];
    for (corners, &face) in triangles.corners.iter().zip(&refined.face) {
        let mut piece = corners.map(|c| (refined.model.corners()[c as usize], uv[c as usize].map(f64::to_bits)));
        let first = (0..3).min_by_key(|&k| piece[k].0).expect("there are three");
        piece.rotate_left(first);
        if face as usize >= count {
            piece.swap(1, 2);
        }
        pieces[face as usize].push(piece);
    }
    pieces.iter_mut().for_each(|pieces| pieces.sort_unstable());
    let copies = (0..count).step_by(7).zip(count..);
    assert!(copies.clone().any(|(original, _)| pieces[original].len() > 1));
    copies.clone().for_each(|(original, copy)| assert_eq!(pieces[copy], pieces[original], "face {original}"));
    let copied: usize = copies.clone().map(|(original, _)| pieces[original].len()).sum();
    assert_eq!(left_out.len(), copied + model.face_count() - count - copies.count());
}

#[test]
fn copies_of_faces_whose_planes_are_refined_lie_over_nothing() {
    let Shape { points, mut triangles } = solids::tube(24, 2);
    let copies: Vec<[u32; 3]> = triangles.iter().step_by(5).copied().collect();
    triangles.extend(copies);
    let model = Model::from_triangles(points, &triangles).expect("an ordinary model");
    let refine = Preparation { refine: Refining::Always, ..Preparation::default() };
    let analysis = Analysis::with(&model, refine).unwrap();
    let Atlas { uv, triangles, left_out, .. } = analysis.atlas(&Options::default()).unwrap();
    assert!(!left_out.is_empty());
    for &t in &left_out {
        let own = triangles.corners[t as usize].map(|c| uv[c as usize]);
        assert!(own.iter().all(|p| *p == own[0]), "{own:?}");
    }
}

#[test]
fn only_needles_are_refined_where_needles_are_to_be() {
    let refine = |shape: &Shape| {
        let preparation = Preparation { refine: Refining::Needles, ..Preparation::default() };
        let analysis = Analysis::with(&model(shape), preparation).expect("a sound model");
        (analysis.refined().is_some(), analysis.needle_share())
    };
    assert_eq!(refine(&shapes::hare(600)), (false, 0.0));
    let barrel = solids::mapped(&solids::tube(24, 2), |[x, y, z]| {
        let width = 1.0 + 0.4 * z * (1.0 - z);
        [width * x, width * y, 40.0 * z]
    });
    let (is_refined, left) = refine(&barrel);
    assert!(is_refined && left < 1e-9, "{left}");
}

#[test]
fn what_no_cones_flatten_in_even_triangles_is_taken_in_its_own() {
    // Four meridians of a sphere and three of its circles.
    let mut points = vec![[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]];
    let mut triangles = Vec::new();
    for k in 0..4_u32 {
        let at = |circle: u32, k: u32| 2 + 3 * (k % 4) + circle;
        triangles.extend([[0, at(0, k + 1), at(0, k)], [1, at(2, k), at(2, k + 1)]]);
        for circle in 0..3_u32 {
            let (turn, rise) = (FRAC_PI_2 * f64::from(k), FRAC_PI_4 * f64::from(circle + 1));
            points.push([1e-9 * rise.sin() * turn.cos(), 1e-9 * rise.sin() * turn.sin(), -rise.cos()]);
            if circle < 2 {
                let [a, b, c, d] = [at(circle, k), at(circle, k + 1), at(circle + 1, k + 1), at(circle + 1, k)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    let spindle = Shape { points, triangles };
    let unwrapped = |refine: Refining| {
        let preparation = Preparation { refine, ..Preparation::default() };
        let options = Options { preparation, ..Options::default() };
        let goes_on = |_: Progress| ControlFlow::Continue(());
        let (analysis, atlas) = Analysis::unwrapped(&model(&spindle), &options, goes_on).expect("it unwraps");
        let is_said = atlas.notes.iter().any(|note| matches!(note, Note::NotRefined { .. }));
        (analysis.refined().is_some(), is_said)
    };
    assert_eq!(unwrapped(Refining::Needles), (false, true));
    assert_eq!(unwrapped(Refining::Never), (false, false));
}

#[test]
fn planes_are_cut_along_edges_of_the_file_only_where_faces_differ() {
    let slab = solids::mapped(&solids::slab(2, 3), |[x, y, z]| [30.0 * x, y, z]);
    let bare = model(&slab);
    let mut materials = Attributes::default();
    materials.face_material = (0..slab.triangles.len() as u32).collect();
    materials.materials = (0..slab.triangles.len()).map(|face| face.to_string()).collect();
    let [fewer, all] = [bare.clone(), bare.with_attributes(materials)].map(|given| {
        let preparation = Preparation { refine: Refining::Always, ..Preparation::default() };
        let analysis = Analysis::with(&given, preparation).expect("a sound model");
        let refined = analysis.refined().expect("it was asked for").clone();
        assert_eq!(&refined.model.points()[..given.vertex_count()], given.points());
        let atlas = analysis.atlas(&Options::default()).expect("it unwraps");
        let found = check_map(&refined.model, &atlas);
        assert_eq!((found.flipped, found.degenerate, found.torn), (0, 0, 0), "{:?}", atlas.notes);
        let triangles: Vec<[u32; 3]> = refined.model.faces().map(|face| [face[0], face[1], face[2]]).collect();
        let area: f64 = triangles
            .iter()
            .map(|t| vector::length(vector::normal(t.map(|v| refined.model.points()[v as usize]))))
            .sum();
        (triangles.len(), area)
    });
    assert!(3 * fewer.0 < 2 * all.0, "{} {}", fewer.0, all.0);
    assert!((fewer.1 / all.1 - 1.0).abs() < 1e-12);
}

#[test]
fn a_flat_roof_far_from_the_origin_is_no_plane() {
    // Of a size of 10, with a ridge of 0.01 at one end.
    let far = |[x, y, z]: [f64; 3]| [1e6 + 10.0 * x, 1e6 + 10.0 * y, 1e6 + z];
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.01], [0.0, 1.0, 0.0]];
    let sheet = solids::mapped(&Shape { points, triangles: vec![[0, 1, 3], [1, 2, 3]] }, far);
    let preparation = Preparation { refine: Refining::Always, ..Preparation::default() };
    let analysis = Analysis::with(&model(&sheet), preparation).expect("a sound model");
    let refined = &analysis.refined().expect("it was asked for").model;
    let beyond = |v: u32| {
        let [x, y, _] = refined.points()[v as usize].map(|x| x - 1e6);
        let across = x + y - 10.0;
        if across.abs() > 1e-6 { across.signum() } else { 0.0 }
    };
    let crosses = |face: &[u32]| {
        let sides: Vec<f64> = face.iter().map(|&v| beyond(v)).collect();
        sides.contains(&1.0) && sides.contains(&-1.0)
    };
    assert!(refined.faces().all(|face| !crosses(face)), "nothing lies across the ridge");
}

#[test]
fn scraps_are_refined_less_than_what_is_large_and_flat_ones_not_at_all() {
    let needles = solids::mapped(&shapes::torus(1, 100), |[x, y, z]| [x, y, 0.05 * z]);
    let beside = |shape: &Shape, size: f64| solids::mapped(shape, |p| [size * p[0] + 5.0, size * p[1], size * p[2]]);
    let sliver =
        beside(&Shape { points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, 0.01, 0.0]], triangles: vec![[0, 1, 2]] }, 0.3);
    let preparation = Preparation { refine: Refining::Always, ..Preparation::default() };
    let pieces = |shape: &Shape, others: &[Shape]| {
        let all = solids::side_by_side(&[std::slice::from_ref(shape), others].concat());
        let analysis = Analysis::with(&model(&all), preparation).expect("a sound model");
        let refined = analysis.refined().expect("it was asked for");
        assert!(refined.is_complete);
        let first = shape.triangles.len() as u32;
        refined.face.iter().filter(|face| **face >= first).count()
    };
    let [large, scrap] = [1.0, 1e-2].map(|size| pieces(&needles, &[beside(&needles, size)]));
    assert!(needles.triangles.len() < scrap && 2 * scrap < large, "{scrap} {large}");
    assert_eq!(pieces(&needles, std::slice::from_ref(&sliver)), 1);
    let alone = Analysis::with(&model(&sliver), preparation).expect("a sound model");
    assert!(alone.refined().is_some_and(|refined| refined.face.len() > 1), "it is all that there is");
}

#[test]
fn needles_of_a_large_surface_stay_where_they_are_small() {
    let shape = solids::mapped(&shapes::hare(103_000), |[x, y, z]| [x, y, 3.0 * z]);
    let preparation = Preparation { refine: Refining::Always, ..Preparation::default() };
    let analysis = Analysis::with(&model(&shape), preparation).expect("a sound model");
    let refined = analysis.refined().expect("it was asked for");
    assert!(refined.is_complete && shape.points.len() > 100_000);
    let count = refined.model.vertex_count();
    assert!(count < 2 * shape.points.len(), "{count} for {}", shape.points.len());
}

#[test]
fn flat_parts_are_left_as_they_are_where_needles_are_to_be_refined() {
    let strip = solids::mapped(&shapes::disk(3), |[x, y, _]| [x, 1e-2 * y, 2.0 + 0.3 * x]);
    let prism = solids::mapped(&solids::tube(24, 1), |[x, y, z]| [x, y, 40.0 * z]);
    let spindle = solids::mapped(&solids::octahedron(), |[x, y, z]| [x, y, 12.0 * z]);
    let preparation = Preparation { refine: Refining::Needles, ..Preparation::default() };
    let with = |shape: &Shape| (model(shape), Analysis::with(&model(shape), preparation).expect("a sound model"));
    for flat in [&strip, &prism] {
        let (_, analysis) = with(flat);
        assert!(analysis.refined().is_none() && analysis.needle_share() > 0.5, "nothing would be gained");
    }
    let (given, analysis) = with(&solids::side_by_side(&[strip.clone(), spindle]));
    let refined = analysis.refined().expect("the other part is bent");
    let count = strip.triangles.len() as u32;
    assert!(refined.face.iter().filter(|face| **face < count).copied().eq(0..count));
    assert!(refined.model.face_count() > given.face_count() + 100);
    let atlas = analysis.atlas(&Options::default()).expect("it unwraps");
    let found = check_map(&refined.model, &atlas);
    assert_eq!((found.flipped, found.degenerate, found.torn), (0, 0, 0), "{:?}", atlas.notes);
}

#[test]
fn whether_a_target_is_met_is_read_off_the_map() {
    let (mut seen, mut otherwise) = ([0, 0], 0);
    let rigid = Options { free_seams: FreeSeams::Never, ..Options::default() };
    let small = solids::mapped(&shapes::terrain(300, 3), |p| p.map(|x| 0.3 * x));
    for shape in [shapes::hare(600), solids::side_by_side(&[shapes::hare(300), small])] {
        let model = model(&shape);
        let analysis = Analysis::new(&model).expect("a sound model");
        for target in [1.05, 1.25, 1.6] {
            let cones = ConeChoice::WithinDistortion(target);
            let atlas = analysis.atlas(&Options { cones, ..rigid.clone() }).expect("it unwraps");
            let number = atlas.number.clone().expect("it was chosen");
            let is_met = measured(&model, &atlas) <= target + 0.005;
            assert_eq!(number.is_met, is_met, "{target} {number:?}");
            seen[usize::from(is_met)] += 1;
        }
        // Of cones it is what is predicted, until they are flattened.
        let cones = analysis.choose(&Options::default()).expect("a sound model");
        let predicted = cones.number().expect("it was chosen");
        assert_eq!(predicted.is_met, predicted.predicted <= cones::TARGET_DISTORTION);
        let atlas = analysis.flatten_with(&cones, &rigid).expect("it unwraps");
        let is_met = measured(&model, &atlas) <= cones::TARGET_DISTORTION + 0.005;
        assert_eq!(atlas.number.expect("it was chosen").is_met, is_met);
        otherwise += usize::from(is_met != predicted.is_met);
    }
    assert!(seen[1] >= 3 && otherwise > 0, "{seen:?}: among them are maps that miss what is predicted for them");
}

#[test]
fn more_cones_are_taken_where_the_most_by_themselves_leave_too_much_to_distort() {
    let wave = |x: f64| (3.5 * std::f64::consts::PI * x).sin();
    let hills = |height: f64| solids::mapped(&shapes::square(1600), |[x, y, _]| [x, y, height * wave(x) * wave(y)]);
    for (height, is_too_much) in [(0.05, false), (0.2, true)] {
        let model = model(&hills(height));
        let analysis = Analysis::new(&model).expect("a sound model");
        for placement in [Placement::Refined, Placement::Pursuit, Placement::Persistence] {
            let options = Options { placement, ..Options::default() };
            let cones = analysis.choose(&options).expect("a sound model");
            let number = cones.number().expect("it was chosen");
            assert_eq!((number.chosen, number.chosen > cones::MOST_AUTOMATIC), (cones.len(), is_too_much));
            assert!(number.predicted <= cones::TOLERABLE_DISTORTION, "{number:?}");
            assert_eq!(number.is_met, number.predicted <= cones::TARGET_DISTORTION);
            let atlas = analysis.atlas(&options).expect("it unwraps");
            let flattened = analysis.flatten(&cones).expect("it unwraps");
            assert!(atlas.cones == flattened.cones && atlas.uv == flattened.uv, "the same is chosen for a map");
            assert!(measured(&model, &atlas) <= cones::TOLERABLE_DISTORTION);
        }
    }
}

#[test]
fn options_come_back_as_they_were_serialized_and_what_is_left_out_is_the_default() {
    let choices = [
        ConeChoice::Automatic,
        ConeChoice::WithinDistortion(1.3),
        ConeChoice::Count(12),
        ConeChoice::Each(vec![3, 0, 9]),
        ConeChoice::MinPersistence(0.25),
        ConeChoice::Given(vec![(7, Some(1.5)), (9, None)]),
    ];
    let rules = [CurvatureRule::Harmonic, CurvatureRule::Optimal];
    for (k, cones) in choices.into_iter().enumerate() {
        for placement in Placement::ALL {
            let preparation = Preparation {
                weld: [geom::Weld::Auto, geom::Weld::Never, geom::Weld::Always][k % 3],
                smooth: k % 3 == 0,
                ..Preparation::default()
            };
            let edges = vec![[k as u32, 9]];
            let options = Options {
                preparation,
                cones: cones.clone(),
                placement,
                rule: rules[k % 2],
                seams: SeamOptions { weight: 0.25, given: edges.clone(), kept: edges.clone(), avoid: edges },
                quantize: [None, Some(Symmetry::Fourfold), Some(Symmetry::Sixfold)][k % 3],
                islands: [Islands::Single, Islands::OverlapFree, Islands::Pack][k % 3],
                ..Options::default()
            };
            let text = serde_json::to_string(&options).expect("plain values");
            assert_eq!(serde_json::from_str::<Options>(&text).expect("what was written"), options);
            assert!(text.contains(&format!(r#""placement":"{}""#, placement.name())), "{text}");
        }
    }
    assert_eq!(serde_json::from_str::<Options>("{}").expect("all are left out"), Options::default());
    let text = r#"{"cones":{"count":8},"rule":"harmonic","preparation":{"weld":"always"}}"#;
    let preparation = Preparation { weld: geom::Weld::Always, ..Preparation::default() };
    let expected = Options { preparation, rule: CurvatureRule::Harmonic, ..count(8) };
    assert_eq!(serde_json::from_str::<Options>(text).expect("a few are given"), expected);
    assert!(serde_json::from_str::<Options>(r#"{"placement":"anyhow"}"#).is_err());
}

#[test]
fn islands_have_the_area_of_the_surface_and_the_density_that_was_asked_for() {
    let shape = solids::side_by_side(&[shapes::hare(700), shapes::torus(1, 400)]);
    let model = model(&shape);
    let surface: f64 = shape
        .triangles
        .iter()
        .map(|t| t.map(|v| shape.points[v as usize]))
        .map(|[a, b, c]| 0.5 * vector::length(vector::cross(vector::sub(b, a), vector::sub(c, a))))
        .sum();
    let analysis = Analysis::new(&model).unwrap();
    let with = |tiles: Tiles, size: UvSize| {
        let packing = PackOptions { tiles, ..PackOptions::default() };
        let atlas = analysis.atlas(&Options { packing, ..count(8) }).unwrap();
        let triangles = atlas.triangles.corners.clone();
        let uv = MeasuredAtlas::new(&model, atlas, size, analysis.weld()).unwrap().uv;
        let twice = |[p, q, r]: [[f64; 2]; 3]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        triangles.iter().map(|t| 0.5 * twice(t.map(|c| uv[c as usize])).abs()).sum::<f64>()
    };
    let raw = with(Tiles::One, UvSize::Raw);
    assert!(raw > 1.001 * surface, "what is scaled is not the surface's already: {raw} {surface}");
    let area = with(Tiles::One, UvSize::Area);
    assert!((area / surface - 1.0).abs() < 1e-9, "{area} {surface}");
    let on_tiles = with(Tiles::Udim { texel_density: 100.0 }, UvSize::Unit);
    let texels = f64::from(PackOptions::default().texture_size).powi(2) * on_tiles;
    assert!((texels / (100.0 * 100.0 * surface) - 1.0).abs() < 1e-9, "{texels}");
}

#[test]
fn what_polygons_lie_over_is_told_as_it_is_measured() {
    // A prism over a star: its ends are polygons of twenty corners, and what lies over them is not cut.
    let at = |k: u32| {
        let (radius, turn) = (if k.is_multiple_of(2) { 0.7 } else { 2.0 }, PI * f64::from(k % 20) / 10.0);
        [radius * turn.cos(), radius * turn.sin(), f64::from(k / 20)]
    };
    let sides = (0..20).map(|k| vec![k, (k + 1) % 20, (k + 1) % 20 + 20, k + 20]);
    let ends = [(0..20).rev().collect(), (20..40).collect()];
    let model = Model::from_polygons((0..40).map(at).collect(), ends.into_iter().chain(sides)).unwrap();
    let options = Options { quantize: Some(Symmetry::Sixfold), ..Options::default() };
    let is_told = |note: &Note| matches!(note, Note::Overlap { .. });
    let free = Analysis::new(&model).unwrap().atlas(&options).unwrap();
    assert!(!free.notes.iter().any(is_told), "polygons that lie over themselves are islands");
    let options = Options { islands: Islands::Single, ..options };
    let atlas = Analysis::new(&model).unwrap().atlas(&options).unwrap();
    let told = atlas.notes.iter().find_map(|note| match note {
        Note::Overlap { share, pairs, .. } => Some((*share, *pairs)),
        _ => None,
    });
    let (share, pairs) = told.expect("it lies over itself");
    let measured = MeasuredAtlas::new(&model, atlas, UvSize::Unit, Weld::Never).unwrap().quality.distortion.overlap;
    assert_eq!(pairs, measured.pairs);
    assert!((0.5..2.0).contains(&(share / measured.share)), "{share} {}", measured.share);
}

#[test]
fn triangles_know_their_component_and_islands_are_counted() {
    let model = several();
    let analysis = Analysis::new(&model).unwrap();
    let atlas = analysis.atlas(&Options::default()).unwrap();
    let components = analysis.triangle_components();
    assert_eq!(components.iter().flatten().max(), Some(&3));
    assert!(components.is_sorted(), "shapes are side by side, one after the other");
    assert!((4..20).contains(&atlas.island_count()) && atlas.islands.contains(&Some(atlas.island_count() as u32 - 1)));
    for cone in &atlas.cones {
        let at = |t: usize| analysis.triangles().vertices(&model)[t].contains(&cone.vertex);
        let triangle = (0..components.len()).find(|&t| at(t)).expect("a cone is a vertex of a triangle");
        assert_eq!(components[triangle], Some(cone.component));
    }
    let other = model_of_one_triangle();
    let foreign = MeasuredAtlas::new(&other, atlas, UvSize::Unit, Weld::Never);
    let expected = distortion::DistortionError::TextureCount { found: model.corner_count(), corners: 3 };
    assert_eq!(foreign.unwrap_err(), expected);
}

fn model_of_one_triangle() -> Model {
    Model::from_triangles(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]).unwrap()
}

#[test]
fn numbers_that_mean_nothing_are_refused_before_anything_is_flattened() {
    let analysis = Analysis::new(&model(&shapes::hare(500))).unwrap();
    let refused = |options: &Options| analysis.atlas(options).expect_err("it is refused");
    for target in [f64::NAN, 0.5, -3.0] {
        let options = Options { cones: ConeChoice::WithinDistortion(target), ..Options::default() };
        assert!(matches!(refused(&options), Error::TargetDistortion(_)), "{target}");
    }
    let options = Options { cones: ConeChoice::MinPersistence(f64::NAN), ..Options::default() };
    assert!(matches!(refused(&options), Error::Threshold));
    let packing = PackOptions { margin: -1.0, ..PackOptions::default() };
    assert!(matches!(refused(&Options { packing, ..count(4) }), Error::Pack(_)));
}
