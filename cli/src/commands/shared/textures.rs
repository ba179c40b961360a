//! The textures that a model shows, and what becomes of them with another map.

use crate::input;
use cones::uv::textures_apart;
use geom::Model;
use geom::io::{Picture, Textures};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// So many textures are called by their names.
const MOST_NAMED: usize = 3;

/// The textures of the map of a file.
#[derive(Debug)]
pub(crate) struct MapTextures {
    pub(crate) textures: Textures,
    /// The file, for what is advised.
    input: PathBuf,
}

impl MapTextures {
    pub(crate) fn of(model: &Model, input: &Path) -> Self {
        Self { textures: Textures::of(model, input), input: input.to_owned() }
    }

    /// The texture of each face, where not all faces show the same.
    pub(crate) fn of_faces(&self) -> Option<&[Option<u32>]> {
        let of_faces = self.textures.of_faces();
        of_faces.windows(2).any(|pair| pair[0] != pair[1]).then_some(of_faces)
    }

    /// A map whose textures lie beside each other.
    pub(crate) fn apart<'a>(&self, model: &Model, uv: &'a [[f64; 2]]) -> Cow<'a, [[f64; 2]]> {
        self.of_faces().map_or(Cow::Borrowed(uv), |of_faces| textures_apart(model, uv, of_faces).into())
    }

    /// What is to be said where another map is written, if anything: `bake` is whether it is one that `cones bake` can make a texture for.
    pub(crate) fn do_not_fit(&self, output: &Path, bake: Bake) -> Option<String> {
        let textures = self.textures.list();
        let pictures = textures.iter().filter(|texture| !matches!(texture.picture, Picture::Unknown(_)));
        let named = listed(pictures.map(|texture| &*texture.name));
        if named.is_empty() {
            return None;
        }
        let were =
            if textures.len() == 1 { "was made for the old map and does" } else { "were made for the old map and do" };
        Some(format!("{named} {were} not fit the new one{}", self.advice(output, bake)))
    }

    /// What is to be said where all textures come together, if there are several.
    pub(crate) fn become_one(&self, output: &Path, bake: Bake) -> Option<String> {
        let count = self.textures.list().len();
        let one = if bake == Bake::Tiles { "one set of tiles" } else { "one square" };
        let advice = || self.advice(output, bake);
        (count > 1).then(|| format!("{count} textures become {one}, which none of them fits{}", advice()))
    }

    fn advice(&self, output: &Path, bake: Bake) -> String {
        match bake {
            Bake::Square if input::is_standard(&self.input) || input::is_standard(output) => {
                ": cones bake makes one that does".to_owned()
            }
            Bake::Square => {
                let is_glb = output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("glb"));
                let baked = output.with_extension(if is_glb { "baked.glb" } else { "baked.obj" });
                let [old, new, baked] = [&*self.input, output, &*baked].map(word);
                format!(": cones bake {old} {new} -o {baked} makes one that does")
            }
            Bake::Tiles => ": without --udim, cones bake makes one that does".to_owned(),
        }
    }
}

/// Whether `cones bake` can make a texture for a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bake {
    /// It is in the unit square.
    Square,
    /// It is on tiles.
    Tiles,
}

impl Bake {
    /// By whether a map is on tiles.
    pub(crate) fn of_tiles(is_udim: bool) -> Self {
        if is_udim { Self::Tiles } else { Self::Square }
    }
}

/// A path as a word of a command line.
fn word(path: &Path) -> String {
    let path = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "/\\._-+:,@%=".contains(c);
    if path.chars().all(is_plain) { path } else { format!("'{path}'") }
}

/// The first of some names, and how many more there are; nothing of none.
pub(crate) fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    match names.as_slice() {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [all @ .., last] if names.len() <= MOST_NAMED => format!("{} and {last}", all.join(", ")),
        [first, others @ ..] => format!("{first} and {} more", others.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_names_are_listed_and_many_counted() {
        let named = |count: usize| listed(["a", "b", "c", "d", "e"].into_iter().take(count));
        assert_eq!([0, 1, 2, 3, 5].map(named), ["", "a", "a and b", "a, b and c", "a and 4 more"]);
    }
}
