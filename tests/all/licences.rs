//! What may be depended on: crates under licences that let anybody use the result.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

const ALLOWED: [&str; 12] = [
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MPL-2.0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// Whether a licence expression (SPDX, or with slashes as it used to be) can be met by what is allowed.
fn is_allowed(expression: &str) -> bool {
    let expression = expression.replace('/', " OR ").replace(['(', ')'], " ");
    let every = |all: &str| all.split(" AND ").all(|one| ALLOWED.contains(&one.trim()));
    // Without parentheses AND binds more tightly; with them this is stricter than need be.
    expression.split(" OR ").any(every)
}

#[test]
fn every_dependency_may_be_used_by_anybody() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.toml");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    // What other systems need besides is not at hand here.
    let version = Command::new("rustc").arg("-vV").output().expect("rustc is there, since it built this");
    let version = String::from_utf8_lossy(&version.stdout).into_owned();
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).expect("it names its host");
    let done = Command::new(cargo)
        .args(["metadata", "--format-version", "1", "--all-features", "--offline", "--filter-platform", host])
        .arg("--manifest-path")
        .arg(manifest)
        .output()
        .expect("cargo is there, since it runs this");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let metadata: Value = serde_json::from_slice(&done.stdout).expect("cargo writes JSON");
    let packages = metadata["packages"].as_array().expect("there are packages");
    assert!(packages.len() > 50, "{} packages", packages.len());
    let refused = packages.iter().filter(|package| !package["license"].as_str().is_some_and(is_allowed));
    let refused: Vec<String> = refused.map(|package| format!("{}: {}", package["name"], package["license"])).collect();
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}

#[test]
fn a_choice_needs_one_licence_that_is_allowed_and_a_sum_all() {
    assert!(
        is_allowed("GPL-3.0 OR MIT") && is_allowed("MIT/Apache-2.0") && is_allowed("(MIT OR Zlib) AND Unicode-3.0")
    );
    assert!(!is_allowed("GPL-3.0") && !is_allowed("MIT AND LGPL-2.1"));
}
