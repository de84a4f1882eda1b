//! Figures about the source text: lines, names, cycles. They have ceilings, and one command prints
//! them.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

use crate::manifests::root;
use crate::modules::Sources;

/// Comments are wrapped here, as code is.
const MAX_COMMENT_COLUMNS: usize = 100;

/// Type names that every crate may use for its own type.
const COMMON_TYPE_NAMES: [&str; 3] = ["Config", "Error", "Options"];

/// The command whose way to the first point is followed.
const CAPTURE_COMMAND: &str = "crates/velomotion/src/commands/capture.rs";

/// The figures of the whole workspace.
#[derive(Debug)]
pub struct Counts {
    pub crates: BTreeMap<String, CrateCounts>,
    /// Lines of tests, benchmarks and fuzz targets: neither blank nor comment.
    pub test_lines: usize,
    /// Names of more than one type, with the files that define them.
    pub repeated_types: BTreeMap<String, Vec<PathBuf>>,
    /// Comment lines that are too long, as `path:line`.
    pub long_comments: Vec<String>,
    /// Cycles of files in more than one folder.
    pub cycles: Vec<Vec<PathBuf>>,
    /// The files that the capture command needs, by crate.
    pub capture_files: BTreeMap<String, usize>,
}

/// The figures of one crate.
#[derive(Debug, Default)]
pub struct CrateCounts {
    pub files: usize,
    pub lines: usize,
    /// Files in import cycles of any kind.
    pub cyclic_files: usize,
    /// Files in import cycles that span folders.
    pub cyclic_files_across_folders: usize,
}

impl Counts {
    pub fn of(sources: &Sources) -> Self {
        let mut crates: BTreeMap<String, CrateCounts> = BTreeMap::new();
        let mut types: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
        for file in &sources.files {
            let entry = crates.entry(file.krate.clone()).or_default();
            entry.files += 1;
            entry.lines += file.code_lines;
            for name in &file.types {
                types
                    .entry(name.clone())
                    .or_default()
                    .push(file.path.clone());
            }
        }
        for file in sources.cycles().iter().flatten() {
            crates.entry(file.krate.clone()).or_default().cyclic_files += 1;
        }
        let cycles = sources.cycles_across_folders();
        for file in cycles.iter().flatten() {
            let entry = crates.entry(file.krate.clone()).or_default();
            entry.cyclic_files_across_folders += 1;
        }
        types.retain(|name, files| files.len() > 1 && !COMMON_TYPE_NAMES.contains(&name.as_str()));
        let mut capture_files: BTreeMap<String, usize> = BTreeMap::new();
        if let Some(capture) = sources.find(CAPTURE_COMMAND) {
            for file in sources.reached_from(capture) {
                *capture_files
                    .entry(sources.files[file].krate.clone())
                    .or_default() += 1;
            }
        }
        let mut long_comments = Vec::new();
        let mut all_lines = 0;
        let mut all_files = Vec::new();
        rust_files(&root(), &mut all_files);
        for path in &all_files {
            let text = std::fs::read_to_string(path).expect("a source file");
            let path = path.strip_prefix(root()).expect("inside");
            for (index, line) in text.lines().enumerate() {
                let trimmed = line.trim();
                if trimmed.is_empty() {
                    continue;
                }
                if !trimmed.starts_with("//") {
                    all_lines += 1;
                } else if line.chars().count() > MAX_COMMENT_COLUMNS {
                    long_comments.push(format!("{}:{}", path.display(), index + 1));
                }
            }
        }
        let lines: usize = crates.values().map(|entry| entry.lines).sum();
        Self {
            crates,
            test_lines: all_lines - lines,
            repeated_types: types,
            long_comments,
            cycles: cycles
                .into_iter()
                .map(|cycle| cycle.into_iter().map(|file| file.path.clone()).collect())
                .collect(),
            capture_files,
        }
    }

    /// Lines of production code.
    pub fn lines(&self) -> usize {
        self.crates.values().map(|entry| entry.lines).sum()
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:14}{:>8}{:>10}{:>12}{:>18}",
            "crate", "files", "lines", "in cycles", "across folders"
        )?;
        for (name, counts) in &self.crates {
            writeln!(
                f,
                "{name:14}{:>8}{:>10}{:>12}{:>18}",
                counts.files, counts.lines, counts.cyclic_files, counts.cyclic_files_across_folders
            )?;
        }
        for (name, files) in &self.repeated_types {
            let files: Vec<String> = files.iter().map(|f| f.display().to_string()).collect();
            writeln!(f, "type {name}: {}", files.join(", "))?;
        }
        for cycle in &self.cycles {
            let files: Vec<String> = cycle.iter().map(|f| f.display().to_string()).collect();
            writeln!(f, "cycle: {}", files.join(", "))?;
        }
        writeln!(f, "lines of production code: {}", self.lines())?;
        writeln!(f, "lines of tests: {}", self.test_lines)?;
        writeln!(
            f,
            "type names used more than once: {}",
            self.repeated_types.len()
        )?;
        writeln!(
            f,
            "comment lines over 100 columns: {}",
            self.long_comments.len()
        )?;
        writeln!(f, "import cycles across folders: {}", self.cycles.len())?;
        let files: Vec<String> = self
            .capture_files
            .iter()
            .map(|(krate, files)| format!("{krate} {files}"))
            .collect();
        writeln!(
            f,
            "files that commands/capture.rs needs: {}",
            files.join(", ")
        )
    }
}

/// Adds all Rust files under a folder, without those of builds and hidden folders.
fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("entry").path();
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        if path.is_dir() {
            if !name.starts_with('.') && name != "target" && name != "node_modules" {
                rust_files(&path, files);
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}
