//! Where each of many surfaces is written: under its own name, and where two have the same, under its folder's too.

use geom::io::MeshFormat;
use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};

/// A surface and where it goes.
#[derive(Debug, PartialEq)]
pub(super) struct Target {
    pub(super) input: PathBuf,
    pub(super) output: PathBuf,
    pub(super) format: MeshFormat,
    /// Whether an earlier one goes there, too: of names that differ in case only, or by folders that `..` leads out of.
    pub(super) is_taken: bool,
}

/// Where surfaces go. `name.ext` is written as `FOLDER/name.FORMAT`; where that is so for several, each goes below `FOLDER` as
/// far down as it lies below what all inputs have in common; where even this is the same, as for `a.obj` and `a.ply` beside each other,
/// their endings stay in their names.
pub(super) fn targets(inputs: &[PathBuf], folder: &Path, asked: Option<MeshFormat>) -> Vec<Target> {
    let formats: Vec<MeshFormat> = inputs.iter().map(|input| asked.unwrap_or_else(|| own_format(input))).collect();
    let common = common_folder(inputs);
    let ways: [&dyn Fn(usize) -> PathBuf; 3] = [
        &|i| folder.join(with_format(&stem(&inputs[i]), formats[i])),
        &|i| folder.join(below(&inputs[i], &common)).join(with_format(&stem(&inputs[i]), formats[i])),
        &|i| folder.join(below(&inputs[i], &common)).join(with_format(&file_name(&inputs[i]), formats[i])),
    ];
    let mut outputs: Vec<PathBuf> = (0..inputs.len()).map(ways[0]).collect();
    for way in &ways[1..] {
        let counts = counts(&outputs);
        for (i, output) in outputs.iter_mut().enumerate() {
            if counts[&key(output)] > 1 {
                *output = way(i);
            }
        }
    }
    let mut taken = HashMap::new();
    let target = |((input, output), &format): ((&PathBuf, PathBuf), &MeshFormat)| {
        let is_taken = taken.insert(key(&output), ()).is_some();
        Target { input: input.clone(), output, format, is_taken }
    };
    inputs.iter().zip(outputs).zip(&formats).map(target).collect()
}

/// How many outputs there are under each name.
fn counts(outputs: &[PathBuf]) -> HashMap<String, usize> {
    let mut counts = HashMap::new();
    outputs.iter().for_each(|output| *counts.entry(key(output)).or_insert(0) += 1);
    counts
}

/// Names that differ in case only are one on many systems.
fn key(path: &Path) -> String {
    path.to_string_lossy().to_lowercase()
}

/// The format of a file where it can be written, else OBJ.
fn own_format(input: &Path) -> MeshFormat {
    let name = file_name(input).to_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    match name.rsplit_once('.') {
        Some((_, "ply")) => MeshFormat::Ply,
        Some((_, "glb" | "gltf")) => MeshFormat::Glb,
        _ => MeshFormat::Obj,
    }
}

fn with_format(name: &str, format: MeshFormat) -> String {
    format!("{name}.{}", format.extension())
}

fn file_name(input: &Path) -> String {
    match input.file_name() {
        Some(name) if name != crate::output::STANDARD => name.to_string_lossy().into_owned(),
        _ => "standard-input".to_owned(),
    }
}

/// A file's name without its endings.
fn stem(input: &Path) -> String {
    let name = file_name(input);
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    match name.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem.to_owned(),
        _ => name.to_owned(),
    }
}

/// The names of the folders that a file is in, without `.`; `..` leads nowhere below and is left out.
fn folders(input: &Path) -> Vec<&std::ffi::OsStr> {
    let parts = input.parent().into_iter().flat_map(Path::components);
    parts.filter_map(|part| if let Component::Normal(name) = part { Some(name) } else { None }).collect()
}

/// How many folders all inputs begin with.
fn common_folder(inputs: &[PathBuf]) -> usize {
    let all: Vec<_> = inputs.iter().map(|input| folders(input)).collect();
    let Some(first) = all.first() else { return 0 };
    (0..first.len()).take_while(|&k| all.iter().all(|other| other.get(k) == first.get(k))).count()
}

/// The folders that a file is in below the common ones.
fn below(input: &Path, common: &usize) -> PathBuf {
    folders(input).into_iter().skip(*common).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outputs(inputs: &[&str]) -> Vec<String> {
        let inputs: Vec<PathBuf> = inputs.iter().map(PathBuf::from).collect();
        let all = targets(&inputs, Path::new("D"), None);
        all.iter().map(|target| target.output.to_string_lossy().replace('\\', "/")).collect()
    }

    #[test]
    fn surfaces_keep_their_names_and_formats() {
        let names = ["m/a.obj", "n/b.ply.gz", "c.stl", "x.y.glb", "d.gltf", ".off"];
        assert_eq!(outputs(&names), ["D/a.obj", "D/b.ply", "D/c.obj", "D/x.y.glb", "D/d.glb", "D/.off.obj"]);
    }

    #[test]
    fn the_same_name_in_two_folders_is_written_twice() {
        assert_eq!(outputs(&["/m/p/a.obj", "/m/q/a.obj", "/m/b.obj"]), ["D/p/a.obj", "D/q/a.obj", "D/b.obj"]);
        assert_eq!(outputs(&["a.obj", "A.OBJ.gz", "a.stl"]), ["D/a.obj.obj", "D/A.OBJ.gz.obj", "D/a.stl.obj"]);
        assert_eq!(outputs(&["p/a.obj", "p/a.stl", "q/a.obj"]), ["D/p/a.obj.obj", "D/p/a.stl.obj", "D/q/a.obj"]);
    }

    #[test]
    fn of_names_that_are_one_below_the_folder_the_second_finds_its_place_taken() {
        let inputs = ["p/a.obj", "b.obj", "../p/a.obj"].map(PathBuf::from);
        let taken: Vec<bool> = targets(&inputs, Path::new("D"), None).iter().map(|target| target.is_taken).collect();
        assert_eq!(taken, [false, false, true]);
    }
}
