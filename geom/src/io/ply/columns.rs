//! Properties that are kept as they are, and what some of them together mean.

use super::Role;
use super::header::{Element, Property, Shape};
use crate::surface::{Attribute, AttributeDomain, Listing, Meaning, ScalarType};

/// The columns of an element, one a property that has no other role.
pub(super) struct Columns {
    of_property: Vec<Option<Attribute>>,
}

impl Columns {
    pub(super) fn new(element: &Element, roles: &[Role]) -> Self {
        let column = |(k, (property, &role)): (usize, (&Property, &Role))| {
            // A name twice would make a file that nobody can read.
            let is_first = element.properties[..k].iter().all(|other| other.name != property.name);
            (role == Role::Column && is_first && element.name != "tristrips").then(|| empty(property))
        };
        Self { of_property: element.properties.iter().zip(roles).enumerate().map(column).collect() }
    }

    /// Takes the numbers of a row of a property, if it is kept.
    pub(super) fn push(&mut self, property: usize, numbers: &[f64]) {
        if let Some(column) = &mut self.of_property[property] {
            numbers.iter().for_each(|&x| column.push(x));
            column.end_row();
        }
    }

    /// The columns as they are.
    pub(super) fn listing(self, name: &str, count: usize) -> Listing {
        Listing { name: name.to_owned(), count, columns: self.of_property.into_iter().flatten().collect() }
    }
}

fn empty(property: &Property) -> Attribute {
    let meaning = Meaning::Other(property.name.clone());
    match property.shape {
        Shape::One(scalar) => Attribute::new(meaning, AttributeDomain::Vertices, scalar, 1),
        Shape::List { item, .. } => Attribute::lists(meaning, AttributeDomain::Vertices, item),
    }
}

/// The columns of vertices or faces, normals and colours put together.
pub(super) fn tables(columns: Columns, domain: AttributeDomain) -> Vec<Attribute> {
    let mut columns: Vec<Attribute> = columns.of_property.into_iter().flatten().collect();
    let mut tables = Vec::new();
    for (names, meaning) in [
        (&["nx", "ny", "nz"][..], Meaning::Normal),
        (&["red", "green", "blue", "alpha"], Meaning::Colour),
        (&["red", "green", "blue"], Meaning::Colour),
    ] {
        let found: Vec<usize> = names.iter().filter_map(|name| position(&columns, name)).collect();
        let parts: Vec<&Attribute> = found.iter().map(|&k| &columns[k]).collect();
        if parts.len() == names.len()
            && parts.iter().all(|part| fits(part, &meaning))
            && let Some(table) = Attribute::side_by_side(&parts, meaning)
        {
            tables.push(table);
            let mut k = 0..;
            columns.retain(|_| k.next().is_some_and(|k| !found.contains(&k)));
        }
    }
    tables.extend(columns);
    tables.into_iter().map(|table| table.of_domain(domain)).collect()
}

fn position(columns: &[Attribute], name: &str) -> Option<usize> {
    columns.iter().position(|column| matches!(column.meaning(), Meaning::Other(other) if other == name))
}

/// Directions are floats; colours of whatever type, without a sign.
fn fits(column: &Attribute, meaning: &Meaning) -> bool {
    match meaning {
        Meaning::Normal => column.scalar().is_float(),
        _ => !matches!(column.scalar(), ScalarType::I8 | ScalarType::I16 | ScalarType::I32),
    }
}
