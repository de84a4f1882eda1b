//! A folder in which commands run.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub struct Place(pub tempfile::TempDir);

impl Place {
    /// An empty directory with a configuration that names the simulator.
    pub fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        std::fs::write(place.path("velomotion.toml"), "device = \"sim\"\n").unwrap();
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn run(&self, line: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_velomotion"))
            .args(line.split_whitespace())
            .current_dir(self.0.path())
            .env("XDG_CONFIG_HOME", self.0.path())
            .env_remove("RUST_LOG")
            .output()
            .unwrap()
    }

    /// Runs a command that must fail with `code` and print each of `words` on stderr.
    pub fn fails(&self, line: &str, code: i32, words: &[&str]) {
        let before = self.files();
        let output = self.run(line);
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{line}:\n{printed}");
        let flat = printed.split_whitespace().collect::<Vec<_>>().join(" ");
        for word in words {
            assert!(flat.contains(word), "{line}: no {word:?} in:\n{printed}");
        }
        assert!(
            printed.contains("help:"),
            "{line}: no next step in:\n{printed}"
        );
        assert_eq!(self.files(), before, "{line} left files behind");
    }

    pub fn files(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let mut files: Vec<_> = std::fs::read_dir(self.0.path())
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .map(|path| (path.clone(), std::fs::read(path).unwrap_or_default()))
            .collect();
        files.sort();
        files
    }
}

/// The object that a command printed.
pub fn json(output: &Output) -> serde_json::Value {
    let text = String::from_utf8_lossy(&output.stdout);
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error} in stdout:\n{text}"))
}

/// A cut of a real recording.
pub fn recording(name: &str) -> PathBuf {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/recordings");
    Path::new(folder).join(name).canonicalize().unwrap()
}
