//! The layers of ARCHITECTURE.md, held to what the `use` lines say.
//!
//! Each row of its tables, `| crate | folder | may import |`, names a folder of a crate (or a file beside `lib.rs`) and the
//! folders that its code may import from. Unit tests at the foot of a file may import anything.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// For each crate its folders with what they may import.
type Layers = BTreeMap<String, BTreeMap<String, BTreeSet<String>>>;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn stated() -> Layers {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("it is in the repository");
    let mut layers = Layers::new();
    let mut is_table = false;
    for line in text.lines() {
        let cells: Vec<&str> = line.trim().trim_matches('|').split('|').map(str::trim).collect();
        match (is_table, &cells[..]) {
            (_, ["crate", "folder", "may import"]) => is_table = true,
            (true, [name, folders, imports]) if !name.starts_with('-') => {
                let names = |cell: &str| -> Vec<String> {
                    cell.split(',').map(|name| name.trim().trim_matches('`').to_owned()).filter(|n| n != "–").collect()
                };
                for folder in names(folders) {
                    let of_crate = layers.entry(name.trim_matches('`').to_owned()).or_default();
                    of_crate.insert(folder, names(imports).into_iter().collect());
                }
            }
            (true, [_]) => is_table = false,
            _ => {}
        }
    }
    layers
}

/// Whether a file holds unit tests alone.
fn is_test(file: &Path) -> bool {
    let is_named = |part: Option<std::path::Component>| part.is_some_and(|part| part.as_os_str() == "tests");
    file.ends_with("tests.rs") || is_named(file.components().rev().nth(1))
}

/// All source files below a folder but unit tests, with their paths from it.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("it can be read").path()) {
        if entry.is_dir() {
            found.extend(sources(&entry));
        } else if entry.extension().is_some_and(|ending| ending == "rs") && !is_test(&entry) {
            found.push(entry);
        }
    }
    found.sort();
    found
}

/// The module that a file is, as the names from the crate's root to it.
fn module(file: &Path, source: &Path) -> Vec<String> {
    let inside = file.strip_prefix(source).expect("it is below").with_extension("");
    let mut names: Vec<String> = inside.iter().map(|name| name.to_string_lossy().into_owned()).collect();
    if names.last().is_some_and(|name| name == "mod") {
        names.pop();
    }
    names
}

/// The paths that the `use` lines of a file name, braces spelled out, from the crate's root on.
fn imports(text: &str, module: &[String]) -> Vec<Vec<String>> {
    let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let mut found = Vec::new();
    let mut rest = code;
    while let Some(at) = rest.find("use ") {
        let is_line =
            rest[..at].rsplit('\n').next().is_some_and(|before| before.trim().is_empty() || before.contains("pub"));
        rest = &rest[at + 4..];
        let Some(end) = rest.find(';').filter(|_| is_line) else { continue };
        for path in spelled_out(&rest[..end]) {
            let mut names: Vec<String> = path.split("::").map(|name| name.trim().to_owned()).collect();
            let from = match names[0].as_str() {
                "crate" => Vec::new(),
                "self" => module.to_vec(),
                "super" => module[..module.len().saturating_sub(1)].to_vec(),
                _ => continue,
            };
            names.remove(0);
            let ups = names.iter().take_while(|name| *name == "super").count();
            let kept = from.len().saturating_sub(ups);
            found.push([&from[..kept], &names[ups..]].concat());
        }
    }
    found
}

/// `a::{b, c::{d, e}}` as `a::b`, `a::c::d`, `a::c::e`.
fn spelled_out(path: &str) -> Vec<String> {
    let Some(open) = path.find('{') else { return vec![path.trim().to_owned()] };
    let (before, inside) = (&path[..open], &path[open + 1..path.rfind('}').unwrap_or(path.len())]);
    let mut depth = 0;
    let parts = inside.split(|c: char| {
        depth += i32::from(c == '{') - i32::from(c == '}');
        c == ',' && depth == 0
    });
    parts
        .filter(|part| !part.trim().is_empty())
        .flat_map(|part| spelled_out(&format!("{before}{}", part.trim())))
        .collect()
}

/// What each folder of a crate imports from which other, with the file that does.
fn found(source: &Path) -> BTreeMap<String, BTreeMap<String, PathBuf>> {
    let mut found: BTreeMap<String, BTreeMap<String, PathBuf>> = BTreeMap::new();
    for file in sources(source) {
        let module = module(&file, source);
        if matches!(module.first().map(String::as_str), None | Some("lib" | "main")) {
            continue;
        }
        let text = fs::read_to_string(&file).expect("it is UTF-8");
        let of_folder = found.entry(module[0].clone()).or_default();
        for path in imports(&text, &module).into_iter().filter(|path| path.first() != module.first()) {
            of_folder.entry(path.first().cloned().unwrap_or_default()).or_insert_with(|| file.clone());
        }
    }
    found
}

/// The files that may declare a module.
fn parents(module: &[String], source: &Path) -> Vec<PathBuf> {
    match module.split_last() {
        None | Some((_, [])) => ["lib.rs", "main.rs"].map(|name| source.join(name)).to_vec(),
        Some((_, outer)) => {
            let folder = outer.iter().fold(source.to_owned(), |folder, name| folder.join(name));
            vec![folder.join("mod.rs"), folder.with_extension("rs")]
        }
    }
}

#[test]
fn every_file_is_a_module_of_its_crate() {
    for name in ["topo", "geom", "cones", "cli", "tests", "python"] {
        let source = root().join(name).join("src");
        let files = sources(&source);
        assert!(!files.is_empty(), "{name} has sources");
        for file in files {
            let module = module(&file, &source);
            let Some(own) = module.last().filter(|own| !["lib", "main"].contains(&own.as_str())) else { continue };
            let declared = format!("mod {own};");
            let is_declared = |parent: &PathBuf| {
                fs::read_to_string(parent).is_ok_and(|text| text.lines().any(|l| l.ends_with(&declared)))
            };
            assert!(parents(&module, &source).iter().any(is_declared), "nothing declares {}", file.display());
        }
    }
}

#[test]
fn no_folder_imports_what_the_architecture_does_not_let_it() {
    let stated = stated();
    assert!(["topo", "geom", "cones", "cli"].iter().all(|name| stated.contains_key(*name)), "{:?}", stated.keys());
    let mut wrong = Vec::new();
    for (name, layers) in &stated {
        let found = found(&root().join(name).join("src"));
        for (folder, imports) in &found {
            let Some(allowed) = layers.get(folder) else {
                wrong.push(format!("ARCHITECTURE.md does not say what {name}/{folder} may import"));
                continue;
            };
            for (import, file) in imports.iter().filter(|(import, _)| !allowed.contains(*import)) {
                wrong.push(format!("{} imports from {import}, which {name}/{folder} may not", file.display()));
            }
        }
        let unknown = layers.keys().filter(|folder| !found.contains_key(*folder));
        wrong.extend(unknown.map(|folder| format!("ARCHITECTURE.md names {name}/{folder}, which is not there")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_layers_are_in_no_circle() {
    for (name, layers) in stated() {
        let mut left = layers;
        while !left.is_empty() {
            let names: BTreeSet<String> = left.keys().cloned().collect();
            let lowest: Vec<String> = left
                .iter()
                .filter(|(_, imports)| imports.is_disjoint(&names))
                .map(|(folder, _)| folder.clone())
                .collect();
            assert!(!lowest.is_empty(), "{name}: {names:?} import each other in a circle");
            lowest.iter().for_each(|folder| drop(left.remove(folder)));
        }
    }
}

/// Files beside each other in a folder; what a folder's own `mod.rs` hands on is left aside.
#[test]
fn files_of_a_folder_are_in_no_circle() {
    for name in ["topo", "geom", "cones", "cli"] {
        let source = root().join(name).join("src");
        let mut edges: BTreeMap<Vec<String>, BTreeSet<Vec<String>>> = BTreeMap::new();
        let modules: BTreeSet<Vec<String>> = sources(&source).iter().map(|file| module(file, &source)).collect();
        let is_parent =
            |module: &Vec<String>| modules.iter().any(|other| other.len() > module.len() && other.starts_with(module));
        for file in sources(&source) {
            let from = module(&file, &source);
            let text = fs::read_to_string(&file).expect("it is UTF-8");
            let to = imports(&text, &from).into_iter().filter_map(|path| {
                let named = (1..=path.len()).rev().map(|k| path[..k].to_vec()).find(|path| modules.contains(path))?;
                (named != from && !is_parent(&named) && !is_parent(&from)).then_some(named)
            });
            edges.insert(from.clone(), to.collect());
        }
        while !edges.is_empty() {
            let names: BTreeSet<Vec<String>> = edges.keys().cloned().collect();
            edges.retain(|_, to| !to.is_disjoint(&names));
            assert!(
                edges.len() < names.len(),
                "{name}: a circle among {:?}",
                edges.keys().map(|k| k.join("::")).collect::<Vec<_>>()
            );
        }
    }
}

#[test]
fn braces_are_spelled_out_and_supers_followed() {
    let module = ["a", "b"].map(String::from);
    let text = "use super::c::{d, e::{f, g}};\nuse crate::x::Y;\nuse super::super::z::W;\nuse std::fmt;\n#[cfg(test)]\nmod tests { use crate::q; }";
    let paths: Vec<String> = imports(text, &module).iter().map(|path| path.join("/")).collect();
    assert_eq!(paths, ["a/c/d", "a/c/e/f", "a/c/e/g", "x/Y", "z/W"]);
}
