//! A network with values on its nodes: which towns are the local centres of their region?
//!
//! Towns of southern Germany with their inhabitants (thousands, rounded) and the roads between them. The peaks of the
//! superlevel filtration are regional centres; persistence says how much one must descend to reach a larger one.
//!
//! `cargo run --example network`

use petgraph::graphmap::UnGraphMap;

const TOWNS: [(&str, u32); 14] = [
    ("Munich", 1510),
    ("Augsburg", 300),
    ("Ulm", 128),
    ("Stuttgart", 630),
    ("Heilbronn", 130),
    ("Karlsruhe", 308),
    ("Nuremberg", 520),
    ("Ingolstadt", 140),
    ("Regensburg", 155),
    ("Landshut", 75),
    ("Ansbach", 42),
    ("Crailsheim", 35),
    ("Donauwörth", 20),
    ("Pforzheim", 126),
];

const ROADS: [(&str, &str); 17] = [
    ("Munich", "Augsburg"),
    ("Munich", "Ingolstadt"),
    ("Munich", "Landshut"),
    ("Landshut", "Regensburg"),
    ("Augsburg", "Ulm"),
    ("Augsburg", "Donauwörth"),
    ("Ulm", "Stuttgart"),
    ("Stuttgart", "Heilbronn"),
    ("Stuttgart", "Pforzheim"),
    ("Pforzheim", "Karlsruhe"),
    ("Heilbronn", "Crailsheim"),
    ("Crailsheim", "Ansbach"),
    ("Ansbach", "Nuremberg"),
    ("Nuremberg", "Ingolstadt"),
    ("Nuremberg", "Regensburg"),
    ("Ingolstadt", "Donauwörth"),
    ("Nuremberg", "Donauwörth"),
];

fn main() -> Result<(), topo::Error> {
    let mut roads = UnGraphMap::<&str, ()>::new();
    // Nodes are numbered as they are added.
    for (town, _) in TOWNS {
        roads.add_node(town);
    }
    roads.extend(ROADS);
    let inhabitants: Vec<u32> = TOWNS.iter().map(|&(_, inhabitants)| inhabitants).collect();

    println!("centres of their region, by prominence (thousands):");
    for peak in topo::superlevel(&roads, &inhabitants)?.ranked() {
        let way = match peak.saddle {
            Some(saddle) => format!("to reach a larger town pass {saddle}"),
            None => "the largest of all".to_owned(),
        };
        println!("{:>12} {:5}  prominence {:5}  {way}", peak.extremum, peak.birth, peak.persistence());
    }

    let regions = topo::segmentation(&roads, &inhabitants, topo::Kind::Maximum, 50)?;
    println!("\nregions of the centres more prominent than 50:");
    for (region, centre) in regions.extrema().iter().enumerate() {
        let towns = TOWNS.iter().enumerate().filter(|&(index, _)| regions.label(index) == Some(region));
        let names: Vec<&str> = towns.map(|(_, &(town, _))| town).collect();
        println!("{centre:>12}: {}", names.join(", "));
    }
    Ok(())
}
