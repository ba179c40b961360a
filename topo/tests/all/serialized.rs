//! What the feature `serde` writes can be read again, and what could not have been written is refused.

use topo::{Connectivity, Hierarchy, Kind, NanPolicy, Path, Persistence, PersistenceOptions, merge_tree};

const LANDSCAPE: [f64; 7] = [3.0, 9.0, 0.0, 4.0, 1.0, 6.0, 2.0];

fn again<T: serde::Serialize + serde::de::DeserializeOwned>(value: &T) -> T {
    let text = serde_json::to_string(value).expect("it can be written");
    serde_json::from_str(&text).expect("it can be read")
}

#[test]
fn results_come_back_as_they_were() {
    let persistence: Persistence<usize, f64> = topo::persistence(&Path::new(7), &LANDSCAPE).expect("fits");
    assert_eq!(again(&persistence), persistence);
    assert_eq!(again(&persistence.hierarchy()), persistence.hierarchy());
    assert_eq!(again(&persistence.minima.diagram()), persistence.minima.diagram());
    let tree = merge_tree(&Path::new(7), &LANDSCAPE, Kind::Maximum).expect("fits");
    assert_eq!(again(&tree.nodes()), tree.nodes());
    assert_eq!(again(&tree.branches()), tree.branches());
    assert_eq!(again(&tree.at(3.0)), tree.at(3.0));
    let tree = topo::contour_tree(&Path::new(7), &LANDSCAPE).expect("fits");
    assert_eq!(again(&(tree.nodes().to_vec(), tree.arcs().to_vec())), (tree.nodes().to_vec(), tree.arcs().to_vec()));
}

#[test]
fn summaries_are_read_and_a_tree_without_a_parent_is_refused() {
    let tile = topo::Tile::cut(&topo::Grid::new([9], Connectivity::Axis), [&[5, 4]]).expect("they fit")[0];
    let values = [3.0, 1.0, 2.0, 1.5, 4.0, 0.0];
    let summary = topo::Summary::of_tile(&tile, &values, Kind::Minimum, PersistenceOptions::new()).expect("it fits");
    assert_eq!(again(&summary), summary);
    let text = serde_json::to_string(&summary).expect("it can be written");
    let orphaned = text.replace(r#""parents":["#, r#""parents":[77,"#);
    assert!(orphaned != text && serde_json::from_str::<topo::Summary<f64>>(&orphaned).is_err());
}

#[test]
fn kinds_and_options_are_written_in_words() {
    let options = PersistenceOptions::new().nan(NanPolicy::Mask).keep_zeros();
    assert_eq!(again(&options), options);
    let text = serde_json::to_string(&(options, Kind::Minimum, Connectivity::Freudenthal)).expect("it can be written");
    assert_eq!(text, r#"[{"nan":"mask","keep_zeros":true,"plain_sweep":false},"minimum","freudenthal"]"#);
    assert_eq!(serde_json::from_str::<PersistenceOptions>("{}").expect("all has a default"), PersistenceOptions::new());
}

#[test]
fn what_is_out_of_order_is_refused() {
    let extremum = r#"{"vertex":0,"kind":"maximum","value":1,"persistence":-1,"saddle":null}"#;
    assert!(serde_json::from_str::<Hierarchy<usize, f64>>(&format!(r#"{{"extrema":[{extremum}]}}"#)).is_err());
}
