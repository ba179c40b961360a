//! What costs a factorization and what does not. One test by itself, since the whole process is counted.

use cones::{Analysis, Baseline, ConeChoice, CurvatureRule, Options, Placement};
use geom::internals::factorizations;
use geom::shapes;
use tests::solids;

/// What some work returns, and how many matrices it factors.
fn counted<T>(work: impl FnOnce() -> T) -> (T, usize) {
    let before = factorizations();
    let done = work();
    (done, factorizations() - before)
}

#[test]
fn an_analysis_costs_one_factorization_a_part_and_what_is_asked_before_flattening_none() {
    let parts = [shapes::hare(900), shapes::torus(2, 600), shapes::terrain(400, 3), shapes::cylinder(300)];
    let model = solids::model(&solids::side_by_side(&parts)).expect("ordinary shapes");
    let (analysis, count) = counted(|| Analysis::new(&model).expect("sound shapes"));
    assert_eq!(count, parts.len(), "one a part");

    for placement in Placement::ALL.into_iter().filter(|placement| *placement != Placement::Refactoring) {
        for rule in [CurvatureRule::Optimal, CurvatureRule::Harmonic] {
            for cones in [ConeChoice::Count(16), ConeChoice::Count(80), ConeChoice::Automatic] {
                let options = Options { cones, placement, rule, ..Options::default() };
                let (chosen, count) = counted(|| analysis.choose(&options).expect("sound shapes"));
                assert_eq!(count, 0, "{options:?}");
                let vertices: Vec<u32> = chosen.iter().map(|cone| cone.vertex).collect();
                let (predicted, count) = counted(|| analysis.predict(&vertices, rule).expect("sound shapes"));
                assert_eq!((predicted.count, count), (vertices.len(), 0), "{options:?}");
            }
            let (order, count) = counted(|| analysis.order(placement, rule, 20).expect("nobody says stop"));
            assert_eq!(count, 0, "the order by {placement:?}");
            assert!(order.curve.len() > 50);
        }
    }
    let by_refactoring = counted(|| analysis.place(Placement::Refactoring, 16).expect("sound shapes")).1;
    assert!(by_refactoring >= parts.len(), "the method that is published so is counted: {by_refactoring}");

    let cones = analysis.place(Placement::Refined, 16).expect("sound shapes");
    let (_, flattening) = counted(|| analysis.flatten(&cones).expect("they unwrap"));
    assert!(flattening >= parts.len(), "Newton's method factors, and is counted: {flattening}");
    let (_, again) = counted(|| analysis.flatten(&cones).expect("they unwrap"));
    assert_eq!(again, flattening, "whoever asks again pays again, no more");
    let (_, least_squares) = counted(|| analysis.flatten_by(Baseline::LeastSquares, &cones).expect("they unwrap"));
    assert_eq!(least_squares, parts.len());
}
