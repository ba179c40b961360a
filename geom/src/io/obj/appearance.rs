//! Normals, colours and materials, for other formats than OBJ.

use std::collections::HashMap;

use super::super::text::{Words, number};
use super::blocks::Counts;
use super::{append_rows, resolve};
use crate::surface::{Attribute, AttributeDomain, Attributes, Meaning, ScalarType};

/// What a text says of how its surface looks. What is no number here is no reason to refuse the surface.
pub(super) struct Appearance {
    normals: Attribute,
    /// The normal of each corner, once any corner had one.
    normal_corners: Vec<u32>,
    /// The numbers behind each vertex, in rows of `width`.
    behind: Vec<f64>,
    /// How many there are behind each vertex; none where they are not as many everywhere.
    width: Option<usize>,
    vertices: usize,
    libraries: Vec<String>,
    materials: Vec<String>,
    number_of_material: HashMap<String, u32>,
    face_material: Vec<u32>,
    /// The material that faces get from here on.
    material: u32,
    has_groups: bool,
}

impl Default for Appearance {
    fn default() -> Self {
        Self {
            normals: Attribute::new(Meaning::Normal, AttributeDomain::Vertices, ScalarType::F32, 3),
            normal_corners: Vec::new(),
            behind: Vec::new(),
            width: None,
            vertices: 0,
            libraries: Vec::new(),
            materials: Vec::new(),
            number_of_material: HashMap::new(),
            face_material: Vec::new(),
            material: Attribute::NONE,
            has_groups: false,
        }
    }
}

impl Appearance {
    /// `vn x y z`.
    pub(super) fn normal(&mut self, mut words: Words) {
        for _ in 0..3 {
            self.normals.push(words.next().and_then(number).filter(|x| x.is_finite()).unwrap_or(0.0));
        }
    }

    /// What stands behind the next vertex.
    pub(super) fn colour(&mut self, words: Words) {
        let known = self.behind.len();
        self.behind.extend(words.map_while(number).take(4));
        let width = self.behind.len() - known;
        if self.vertices == 0 {
            self.width = Some(width);
        } else if self.width != Some(width) {
            self.width = None;
            self.behind.clear();
        }
        self.vertices += 1;
    }

    /// `mtllib a.mtl b.mtl`. Names may have spaces: one ends with its ending.
    pub(super) fn libraries(&mut self, words: Words) {
        let mut name: Vec<String> = Vec::new();
        for word in words.map(String::from_utf8_lossy) {
            name.push(word.into_owned());
            if name.last().is_some_and(|word| word.to_ascii_lowercase().ends_with(".mtl")) {
                self.libraries.push(std::mem::take(&mut name).join(" "));
            }
        }
        if !name.is_empty() {
            self.libraries.push(name.join(" "));
        }
    }

    /// `usemtl name`.
    pub(super) fn material(&mut self, words: Words) {
        self.material = self.number(words.map(String::from_utf8_lossy).collect::<Vec<_>>().join(" "));
    }

    /// The number of a material, which is listed if it is new.
    fn number(&mut self, name: String) -> u32 {
        let next = self.materials.len() as u32;
        let number = self.number_of_material.get(&name).copied().unwrap_or(next);
        if number == next {
            self.number_of_material.insert(name.clone(), number);
            self.materials.push(name);
        }
        number
    }

    /// `g` or `o`.
    pub(super) fn group(&mut self) {
        self.has_groups = true;
    }

    /// Notes the normal of the corner that is about to come.
    pub(super) fn corner(&mut self, corner: usize, normal: Option<i64>, before: &impl Fn() -> Counts) {
        if let Some(normal) = normal {
            let row = resolve(normal, || before().normals + self.normals.rows());
            self.normal_corners.resize(corner, Attribute::NONE);
            self.normal_corners.push(row.unwrap_or(Attribute::NONE - 1));
        }
    }

    /// Notes the material of the face that is about to end.
    pub(super) fn face(&mut self, face: usize) {
        if self.material != Attribute::NONE {
            self.face_material.resize(face, Attribute::NONE);
            self.face_material.push(self.material);
        }
    }

    /// Appends what the next block says. `faces` are how many this one has and the next, `corners` how many this one has.
    pub(super) fn append(&mut self, next: Self, faces: [usize; 2], corners: usize) {
        append_rows(&mut self.normal_corners, corners, &next.normal_corners);
        self.normals.append(&next.normals);
        if next.vertices > 0 {
            self.width = if self.vertices == 0 { next.width } else { self.width.filter(|_| self.width == next.width) };
            match self.width {
                Some(_) => self.behind.extend(next.behind),
                None => self.behind.clear(),
            }
            self.vertices += next.vertices;
        }
        self.has_groups |= next.has_groups;
        self.libraries.extend(next.libraries);
        let number: Vec<u32> = next.materials.into_iter().map(|name| self.number(name)).collect();
        // Faces before the first material of the next block have the last one of this.
        let earlier = self.material;
        let of = |material: u32| number.get(material as usize).copied().unwrap_or(earlier);
        let mut face_material = next.face_material;
        if earlier != Attribute::NONE {
            face_material.resize(faces[1], Attribute::NONE);
        }
        face_material.iter_mut().for_each(|material| *material = of(*material));
        append_rows(&mut self.face_material, faces[0], &face_material);
        self.material = of(next.material);
    }

    /// How many corners ask for a normal that there is not.
    pub(super) fn missing_normals(&self) -> usize {
        let is_missing = |&&row: &&u32| row != Attribute::NONE && row as usize >= self.normals.rows();
        self.normal_corners.iter().filter(is_missing).count()
    }

    /// All of it, of so many vertices, faces and corners.
    pub(super) fn attributes(mut self, vertices: usize, faces: usize, corners: usize) -> Attributes {
        let mut tables = Vec::new();
        if !self.normal_corners.is_empty() {
            self.normal_corners.resize(corners, Attribute::NONE);
            tables.push(self.normals.at_corners(self.normal_corners));
        }
        if let Some(width @ (3 | 4)) = self.width.filter(|_| self.vertices == vertices) {
            tables.push(colours(&self.behind, width));
        }
        if !self.face_material.is_empty() {
            self.face_material.resize(faces, Attribute::NONE);
        }
        let left = if self.has_groups { vec!["groups".to_owned()] } else { Vec::new() };
        let (libraries, materials, face_material) = (self.libraries, self.materials, self.face_material);
        Attributes { tables, libraries, materials, face_material, left, ..Attributes::default() }
    }
}

/// Shares of 1, or of 255 where any is larger than 1, in the 16 bits that colours have between formats.
fn colours(values: &[f64], width: usize) -> Attribute {
    let unit = if values.iter().any(|&x| x > 1.0) { 255.0 } else { 1.0 };
    let mut table = Attribute::new(Meaning::Colour, AttributeDomain::Vertices, ScalarType::U16, width);
    // What is no number becomes 0.
    values.iter().for_each(|&x| table.push(x / unit * ScalarType::U16.one()));
    table
}
