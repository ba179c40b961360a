//! [`Textures`]: which picture each face of a model shows.
//!
//! | format | the picture of a face |
//! |---|---|
//! | OBJ | `map_Kd` of its material in the libraries that the file names, as far as they can be read; each material is taken for a texture of its own where not |
//! | PLY | the one of `comment TextureFile` that its `texnumber` counts, or the first |
//! | glTF | that of its material's base colour |
//!
//! Two materials with the same picture show the same texture. A model of which no face shows any has none, whatever its materials are. The colours of materials are kept for
//! what has no picture: `Kd` of an OBJ, taken for sRGB; in a glTF the factor of the base colour is also what the picture is multiplied by. `Kd` beside `map_Kd` is passed over, as
//! programs that write OBJ leave anything there.
//!
//! Source: Wavefront Technologies, *Advanced Visualizer*, *Material Library File (.mtl)*. Of other maps than `map_Kd` only the names are read.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::colour::to_linear;
use super::gltf::beside as named_by_gltf;
use super::load_named;
use super::text::{Lines, Words, number};
use crate::surface::{Attribute, AttributeDomain, Attributes, Meaning, Model};

/// So many bytes of a material library are read: a thousand materials have a hundredth of it.
const MOST_OF_LIBRARY: u64 = 1 << 26;
/// What a comment of a PLY begins with that names a picture.
const TEXTURE_FILE: &str = "TextureFile";

/// Beginnings of the words before other maps than that of the colour.
const OTHER_MAPS: [&[u8]; 6] = [b"map_", b"bump", b"disp", b"decal", b"refl", b"norm"];

/// Where the picture of a texture is.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Picture {
    /// In a file of its own.
    File(PathBuf),
    /// In the model's file, a glTF: its number, for [`read_picture`](super::read_picture).
    Image(usize),
    /// It is not known: a material, or a number, whose picture nothing tells.
    Unknown(String),
}

/// A texture.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Texture {
    /// What it is called: as its picture, or as the material whose picture is not known.
    pub name: String,
    /// Where its picture is.
    pub picture: Picture,
    /// Whether it is placed otherwise than by the model's texture coordinates: by options of `map_Kd`, a transformation of a glTF or its second coordinates.
    pub is_moved: bool,
}

/// The textures of a model; see the module's head.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Textures {
    textures: Vec<Texture>,
    of_face: Vec<Option<u32>>,
    /// The colour of each material that has one.
    colours: Vec<Option<[f64; 4]>>,
    face_material: Vec<u32>,
    files: Vec<PathBuf>,
    other_maps: Vec<String>,
}

impl Textures {
    /// Those of a model that was read from a file, in the order in which faces first show them. The material libraries of an OBJ are read.
    pub fn of(model: &Model, path: &Path) -> Self {
        let attributes = model.attributes();
        let folder = path.parent().unwrap_or(Path::new(""));
        if !attributes.libraries.is_empty() {
            let libraries = Libraries::read(&attributes.libraries, folder);
            let textures: Vec<_> = attributes.materials.iter().map(|material| libraries.texture(material)).collect();
            let colours = attributes.materials.iter().map(|material| libraries.colours.get(material).copied());
            let Libraries { files, other_maps, .. } = &libraries;
            let (files, other_maps) = (files.clone(), other_maps.iter().cloned().collect());
            return Self { colours: colours.collect(), files, other_maps, ..Self::of_materials(model, &textures) };
        }
        let files = attributes.images.iter().filter_map(|uri| Some(folder.join(named_by_gltf(uri)?))).collect();
        if !attributes.pictures.is_empty() {
            let texture = |picture: &crate::BaseColourPicture| Texture {
                name: picture.name.clone(),
                picture: Picture::Image(picture.image),
                is_moved: picture.is_moved,
            };
            let textures: Vec<_> = attributes.pictures.iter().map(|picture| picture.as_ref().map(texture)).collect();
            let other_maps = attributes.other_maps.clone();
            return Self { colours: factors(attributes), files, other_maps, ..Self::of_materials(model, &textures) };
        }
        Self { files, ..Self::of_numbers(model, folder) }
    }

    /// The textures.
    pub fn list(&self) -> &[Texture] {
        &self.textures
    }

    /// The number of the texture that a face shows.
    pub fn of_face(&self, face: usize) -> Option<usize> {
        self.of_face.get(face).copied().flatten().map(|texture| texture as usize)
    }

    /// The number of the texture of each face; empty where nothing is known of textures.
    pub fn of_faces(&self) -> &[Option<u32>] {
        &self.of_face
    }

    /// The colour of a face's material, red, green, blue and alpha in linear light, if it has one; see the module's head.
    pub fn colour(&self, face: usize) -> Option<[f64; 4]> {
        *self.colours.get(*self.face_material.get(face)? as usize)?
    }

    /// The files that the model names beside itself, as far as they are known: material libraries, and the pictures of any use that these or the model name.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// What else than the colour materials have pictures for, in the file's words, such as `map_Bump` or `normalTexture`. Nothing more is known of these here.
    pub fn other_maps(&self) -> &[String] {
        &self.other_maps
    }

    fn of_materials(model: &Model, textures: &[Option<Texture>]) -> Self {
        let face_material = &model.attributes().face_material;
        let material = |face| face_material.get(face).map(|&material| material as usize);
        let shown = Self::shown((0..model.face_count()).map(|face| textures.get(material(face)?)?.as_ref()));
        Self { face_material: face_material.clone(), ..shown }
    }

    /// Those of a PLY.
    fn of_numbers(model: &Model, folder: &Path) -> Self {
        let attributes = model.attributes();
        let file = |comment: &String| {
            let (_, rest) = comment.split_once(TEXTURE_FILE)?;
            Some(file_texture(folder, rest.trim(), false)).filter(|texture| !texture.name.is_empty())
        };
        let files: Vec<Texture> = attributes.comments.iter().filter_map(file).collect();
        let is_number = |table: &&Attribute| {
            let is_named = matches!(table.meaning(), Meaning::Other(name) if name == "texnumber");
            is_named && table.domain() == AttributeDomain::Faces
        };
        let numbers = attributes.tables.iter().find(is_number);
        let number = |face| numbers.map_or(Some(0.0), |numbers| numbers.row(face).next());
        if files.is_empty() {
            let named = |number: f64| unknown(&format!("texture {number}"));
            let numbered: Vec<_> = match numbers {
                Some(_) => (0..model.face_count()).map(|face| number(face).map(named)).collect(),
                None => Vec::new(),
            };
            return Self::shown(numbered.iter().map(Option::as_ref));
        }
        let file = |number: f64| if number >= 0.0 { files.get(number as usize) } else { None };
        let shown = Self::shown((0..model.face_count()).map(|face| number(face).and_then(file)));
        let path = |texture: &Texture| match &texture.picture {
            Picture::File(path) => Some(path.clone()),
            Picture::Image(_) | Picture::Unknown(_) => None,
        };
        Self { files: files.iter().filter_map(path).collect(), ..shown }
    }

    fn shown<'a>(of_face: impl Iterator<Item = Option<&'a Texture>>) -> Self {
        let mut number: HashMap<(&Picture, bool), u32> = HashMap::new();
        let mut textures = Vec::new();
        let of_face = of_face.map(|texture| {
            texture.map(|texture| {
                *number.entry((&texture.picture, texture.is_moved)).or_insert_with(|| {
                    textures.push(texture.clone());
                    textures.len() as u32 - 1
                })
            })
        });
        Self { of_face: of_face.collect(), textures, ..Self::default() }
    }
}

/// The factors of the base colours of a glTF's materials: white where it says nothing.
fn factors(attributes: &Attributes) -> Vec<Option<[f64; 4]>> {
    let factor = |look: &String| {
        let look: Value = serde_json::from_str(look).unwrap_or_default();
        let factor = &look["pbrMetallicRoughness"]["baseColorFactor"];
        [0, 1, 2, 3].map(|k| factor[k].as_f64().unwrap_or(1.0).clamp(0.0, 1.0))
    };
    attributes.looks.iter().map(|look| Some(factor(look))).collect()
}

/// A texture in a file that is named in another one, which is in `folder`.
fn file_texture(folder: &Path, named: &str, is_moved: bool) -> Texture {
    let picture = Picture::File(beside(folder, named));
    let name = named.rsplit(['/', '\\']).next().unwrap_or(named).to_owned();
    Texture { name, picture, is_moved }
}

/// One of which nothing is known but a name.
fn unknown(name: &str) -> Texture {
    Texture { name: name.to_owned(), picture: Picture::Unknown(name.to_owned()), is_moved: false }
}

/// Where a file is that another one in `folder` names: as it says, with the separators of Windows turned, or, as of a path of another machine, in the
/// folder itself.
fn beside(folder: &Path, named: &str) -> PathBuf {
    let last = named.rsplit(['/', '\\']).next().unwrap_or(named);
    let places = [named, &named.replace('\\', "/"), last].map(|name| folder.join(name));
    let found = places.iter().find(|place| place.is_file());
    found.unwrap_or(&places[0]).clone()
}

/// What material libraries say of pictures.
#[derive(Default)]
struct Libraries {
    /// The picture of each material, if it has one.
    materials: HashMap<String, Option<Texture>>,
    /// The colour of each material that has one and no picture.
    colours: HashMap<String, [f64; 4]>,
    /// They themselves and what they name.
    files: Vec<PathBuf>,
    /// The words before other maps.
    other_maps: BTreeSet<String>,
    /// Whether all of them could be read.
    is_complete: bool,
}

impl Libraries {
    fn read(names: &[String], folder: &Path) -> Self {
        let mut libraries = Self { is_complete: true, ..Self::default() };
        for name in names {
            let path = beside(folder, name);
            let text = load_named(&path, MOST_OF_LIBRARY);
            libraries.is_complete &= text.is_ok();
            libraries.take(&text.unwrap_or_default(), path.parent().unwrap_or(Path::new("")));
            libraries.files.push(path);
        }
        let has_picture = |material: &String| libraries.materials.get(material).is_some_and(Option::is_some);
        libraries.colours.retain(|material, _| !has_picture(material));
        libraries
    }

    fn take(&mut self, text: &[u8], folder: &Path) {
        let mut material = String::new();
        for line in Lines::new(text) {
            let mut words = line.words();
            let word = words.next().unwrap_or_default();
            match &*word.to_ascii_lowercase() {
                b"newmtl" => {
                    material = words.map(String::from_utf8_lossy).collect::<Vec<_>>().join(" ");
                    self.materials.entry(material.clone()).or_default();
                }
                b"map_kd" => {
                    let (name, is_moved) = map(words);
                    let texture = (!name.is_empty()).then(|| file_texture(folder, &name, is_moved));
                    self.files.push(beside(folder, &name));
                    self.materials.insert(material.clone(), texture);
                }
                b"kd" => {
                    let shares: Vec<f64> = words.map_while(number).collect();
                    if let [red, green, blue] = shares[..] {
                        let [red, green, blue] = [red, green, blue].map(|x| to_linear(x.clamp(0.0, 1.0)));
                        self.colours.insert(material.clone(), [red, green, blue, 1.0]);
                    }
                }
                lower if OTHER_MAPS.iter().any(|map| lower.starts_with(map)) => {
                    self.files.push(beside(folder, &map(words).0));
                    self.other_maps.insert(String::from_utf8_lossy(word).into_owned());
                }
                _ => {}
            }
        }
    }

    /// The texture of a material; one of its own where it is in a library that could not be read.
    fn texture(&self, material: &str) -> Option<Texture> {
        match self.materials.get(material) {
            Some(texture) => texture.clone(),
            None if self.is_complete => None,
            None => Some(unknown(material)),
        }
    }
}

/// The file of a `map_Kd`, and whether its options move or scale it.
fn map(words: Words) -> (String, bool) {
    let words: Vec<String> = words.map(|word| String::from_utf8_lossy(word).into_owned()).collect();
    let (mut at, mut is_moved) = (0, false);
    let numbers_from = |at: usize| {
        let numbers = words[at.min(words.len())..].iter().take(3).map_while(|word| number(word.as_bytes()));
        numbers.collect::<Vec<f64>>()
    };
    while let Some(option) = words.get(at).and_then(|word| word.strip_prefix('-')) {
        at += match option {
            "o" | "s" | "t" => {
                let numbers = numbers_from(at + 1);
                is_moved |= numbers.iter().any(|&x| x != f64::from(u8::from(option == "s")));
                1 + numbers.len()
            }
            "mm" => 3,
            "blendu" | "blendv" | "bm" | "boost" | "cc" | "clamp" | "imfchan" | "texres" | "type" => 2,
            _ => break,
        };
    }
    (words[at.min(words.len())..].join(" ").trim_matches('"').to_owned(), is_moved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{read_bytes, read_picture};

    const FACES: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl stone\nf 1 2 3\nusemtl my moss\nf 1 2 3\nusemtl red\nf 1 2 3\nusemtl wall\nf 1 2 3\n";

    fn names(textures: &Textures) -> Vec<&str> {
        textures.list().iter().map(|texture| &*texture.name).collect()
    }

    fn of_faces(textures: &Textures, count: usize) -> Vec<Option<usize>> {
        (0..count).map(|face| textures.of_face(face)).collect()
    }

    #[test]
    fn faces_of_an_obj_show_the_maps_of_their_materials() {
        let folder = std::env::temp_dir().join(format!("cones-textures-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let library = "newmtl stone\r\nKd 1 1 1\r\nmap_Kd -clamp on -s 1 1 1 a b.png\r\nnewmtl my moss\nmap_Kd C:\\x\\moss.png\n\
                       newmtl red\nKd 1 0 0\nmap_Bump -bm 2 bump.png\nnewmtl wall\nmap_Kd -o 0.5 a b.png\n";
        std::fs::write(folder.join("my lib.mtl"), library).unwrap();
        let textures = |libraries: &str| {
            let model = read_bytes(format!("{libraries}{FACES}").into(), "a.obj").unwrap();
            Textures::of(&model, &folder.join("a.obj"))
        };
        let read = textures("mtllib my lib.mtl\n");
        assert_eq!(names(&read), ["a b.png", "moss.png", "a b.png"]);
        assert_eq!(of_faces(&read, 4), [Some(0), Some(1), None, Some(2)]);
        assert_eq!(read.list()[0].picture, Picture::File(folder.join("a b.png")));
        assert!(read.list()[2].is_moved && !read.list()[0].is_moved);
        let files = ["a b.png", "C:\\x\\moss.png", "bump.png", "a b.png", "my lib.mtl"];
        assert_eq!(read.other_maps(), ["map_Bump"]);
        assert_eq!(read.files(), files.map(|name| folder.join(name)));
        assert_eq!([0, 2].map(|face| read.colour(face)), [None, Some([1.0, 0.0, 0.0, 1.0])]);
        let unread = textures("mtllib other.mtl\n");
        assert_eq!(names(&unread), ["stone", "my moss", "red", "wall"]);
        assert_eq!(textures(""), Textures::default());
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_that_nobody_writes_to_is_no_file() {
        let folder = std::env::temp_dir().join(format!("cones-pipes-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let pipe = folder.join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let model = read_bytes(format!("mtllib pipe\n{FACES}").into(), "a.obj").unwrap();
        assert_eq!(names(&Textures::of(&model, &folder.join("a.obj"))), ["stone", "my moss", "red", "wall"]);
        for file in [&*pipe, Path::new("/dev/zero")] {
            let told = read_picture("a.obj", &Picture::File(file.to_owned())).unwrap_err().to_string();
            assert!(told.ends_with("this is a pipe or a device, give a file"), "{told}");
        }
        std::fs::write(folder.join("a.gltf"), r#"{"asset": {"version": "2.0"}, "images": [{"uri": "pipe"}]}"#).unwrap();
        let told = read_picture(folder.join("a.gltf"), &Picture::Image(0)).unwrap_err().to_string();
        assert!(told.contains("a pipe or a device"), "{told}");
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn faces_of_a_ply_show_the_files_that_they_number() {
        let textures = |comments: &str, property: &str, last: [&str; 3]| {
            let text = format!(
                "ply\nformat ascii 1.0\n{comments}element vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                 element face 3\nproperty list uchar int vertex_indices\n{property}end_header\n0 0 0\n1 0 0\n0 1 0\n{}",
                last.map(|last| format!("3 0 1 2 {last}\n")).concat()
            );
            Textures::of(&read_bytes(text.into(), "a.ply").unwrap(), Path::new("in/a.ply"))
        };
        let files = "comment TextureFile a.png\ncomment TextureFile b.png\n";
        let numbered = textures(files, "property int texnumber\n", ["1", "0", "7"]);
        assert_eq!((names(&numbered), of_faces(&numbered, 3)), (vec!["b.png", "a.png"], vec![Some(0), Some(1), None]));
        assert_eq!(numbered.list()[1].picture, Picture::File("in/a.png".into()));
        assert_eq!(of_faces(&textures(files, "", [""; 3]), 3), [Some(0); 3]);
        assert_eq!(names(&textures("", "property int texnumber\n", ["1", "1", "2"])), ["texture 1", "texture 2"]);
        assert_eq!(names(&textures("", "", [""; 3])), [""; 0]);
    }
}
