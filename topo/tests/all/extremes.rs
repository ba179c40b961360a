//! Inputs at the edge of what is allowed, and beyond: nothing panics, nothing overflows, errors name what is wrong.

use topo::{
    Adjacency, Connectivity, Domain, FieldError, Grid, NanPolicy, Options, Path, Persistence, Scalar, Triangulation,
};

fn persistence<G: Domain<Vertex = usize>, S: Scalar>(domain: G, field: &[S]) -> Persistence<usize, S> {
    topo::persistence(domain, field).expect("the field fits")
}

#[test]
fn an_empty_domain_has_no_pairs() {
    let empty: [f64; 0] = [];
    assert!(persistence(&Path::new(0), &empty).minima.is_empty());
    assert!(persistence(&Adjacency::from_edges(0, &[]).expect("no edges"), &empty).maxima.is_empty());
    assert!(persistence(&Triangulation::new(0, &[]).expect("no corners"), &empty).maxima.is_empty());
    assert_eq!(persistence(&Path::new(0), &empty).hierarchy().alternating(3).count(), 0);
}

#[test]
fn a_single_vertex_lives_for_ever_and_has_no_range() {
    let persistence = persistence(&Path::new(1), &[7.0]);
    assert_eq!((persistence.minima[0].saddle, persistence.minima[0].persistence()), (None, 0.0));
}

#[test]
fn a_constant_field_has_one_extremum_of_each_kind() {
    let constant = persistence(&Grid::new([9, 9], Connectivity::Full), &[0u8; 81]);
    assert_eq!((constant.minima.len(), constant.minima.zero_count()), (1, 0));
    assert_eq!((constant.minima[0].extremum, constant.maxima[0].extremum), (0, 80));
}

#[test]
fn infinities_are_values() {
    let field: Vec<f64> = (0..101).map(|i| if i % 2 == 0 { f64::INFINITY } else { f64::NEG_INFINITY }).collect();
    let alternating = persistence(&Path::new(101), &field);
    assert_eq!(alternating.minima.len(), 50);
    assert!(alternating.minima.iter().all(|pair| pair.persistence() == f64::INFINITY));
}

#[test]
fn nan_is_refused_with_its_vertex_or_masked() {
    let path = Path::new(3);
    assert_eq!(topo::sublevel(&path, &[0.0, f64::NAN, 0.0]), Err(FieldError::NotANumber { vertex: 1 }));
    let all_masked = Options::new().nan(NanPolicy::Mask).persistence(&path, &[f64::NAN; 3]).expect("masked");
    assert!(all_masked.minima.is_empty() && all_masked.maxima.is_empty());
}

#[test]
fn a_field_of_the_wrong_length_is_refused() {
    let error = topo::sublevel(&Path::new(3), &[0.0; 2]).expect_err("too short");
    assert_eq!(error.to_string(), "the field has 2 values for 3 vertices; it needs one for each");
}

#[test]
fn zeros_of_both_signs_are_equal() {
    let pairs = Options::new().keep_zeros().sublevel(&Path::new(3), &[0.0, 1.0, -0.0]).expect("fits");
    assert_eq!((pairs[0].extremum, pairs[0].is_essential()), (0, true));
}

#[test]
fn integers_may_use_their_whole_range() {
    let bytes = persistence(&Path::new(3), &[i8::MIN, i8::MAX, i8::MIN]);
    assert!(bytes.minima.iter().all(|pair| pair.persistence() == 255));
    let large = [u64::MAX, u64::MAX - 1, u64::MAX];
    assert_eq!(persistence(&Path::new(3), &large).maxima[1].persistence(), 1);
}

#[test]
fn a_million_isolated_vertices_are_as_many_components() {
    let field: Vec<u32> = (0..1_000_000).collect();
    let isolated = Adjacency::from_edges(field.len(), &[]).expect("no edges");
    assert_eq!(persistence(&isolated, &field).minima.essential().count(), field.len());
}

#[test]
fn a_star_pairs_all_its_leaves_at_the_centre() {
    const LEAVES: usize = 1_000_000;
    let edges: Vec<_> = (1..=LEAVES).map(|leaf| [0, leaf]).collect();
    let star = Adjacency::from_edges(LEAVES + 1, &edges).expect("ends exist");
    let mut field: Vec<i64> = (0..=LEAVES as i64).map(|i| i * 7919 % 1_000_003).collect();
    field[0] = 2_000_000;
    let minima = persistence(&star, &field).minima;
    assert_eq!(minima.finite().filter(|pair| pair.saddle == Some(0)).count(), LEAVES - 1);
}

#[test]
fn long_ways_down_are_no_trouble() {
    const LENGTH: usize = 10_000_000;
    let tent: Vec<f32> = (0..LENGTH).map(|i| i.min(LENGTH - i) as f32).collect();
    let by_stack = persistence(&Path::new(LENGTH), &tent);
    assert_eq!(by_stack.minima.len(), 2);
    assert_eq!(by_stack, persistence(&Grid::new([LENGTH], Connectivity::Axis), &tent));
}

#[test]
fn a_thin_grid_is_scanned_along_its_length() {
    let field: Vec<i32> = (0..90_000).map(|i| i * 7919 % 1013).collect();
    let column = persistence(&Grid::new([90_000, 1], Connectivity::Full), &field);
    assert_eq!(column, persistence(&Path::new(90_000), &field));
}
