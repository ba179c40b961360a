//! A folder to run the command in, and what it said.

use assert_cmd::Command;
use assert_cmd::assert::Assert;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// The command, which cargo has built for these tests.
pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_cones");

/// A folder of its own for each test, in which the command is run.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder can be made"))
    }

    /// With `sphere.obj` and `hare.obj` in it.
    pub(crate) fn with_shapes() -> Self {
        let folder = Self::new();
        for shape in ["sphere", "hare"] {
            folder.run(&["shape", shape, "--vertices", "600", "-o", &format!("{shape}.obj")]).success();
        }
        folder
    }

    pub(crate) fn run(&self, args: &[&str]) -> Assert {
        Command::new(PROGRAM).args(args).current_dir(self.0.path()).assert()
    }

    /// What a run that fails says on stderr; it must be an error in one paragraph, and with exit code 1.
    pub(crate) fn complaint(&self, args: &[&str]) -> String {
        let complaint = stderr(&self.run(args).code(1));
        assert!(complaint.starts_with("error: ") && !complaint.contains("panicked"), "{args:?}: {complaint}");
        complaint
    }

    pub(crate) fn root(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).expect("the file is there and text")
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).expect("a temporary folder can be written to");
    }

    pub(crate) fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).expect("the file is JSON")
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).expect("the folder is there");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("it can be listed").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

pub(crate) fn stdout(done: &Assert) -> String {
    String::from_utf8(done.get_output().stdout.clone()).expect("the command writes UTF-8")
}

pub(crate) fn stderr(done: &Assert) -> String {
    String::from_utf8(done.get_output().stderr.clone()).expect("the command writes UTF-8")
}
