//! Programs, packages and files that the commands of the pages name. Tests run the commands of
//! velomotion itself (`tests/realtime/command_line/book.rs`).

use std::collections::BTreeSet;

use crate::manifests::{Member, Workspace, root, table};
use crate::pages::{all_pages, code_of, read};

/// Folders at the top level whose paths begin a command, or a word of one.
const FOLDERS: [&str; 5] = ["packaging/", "tests/", "benches/", "fuzz/", "crates/"];

/// Fuzzing makes it.
const MADE: &str = "fuzz/corpus";

/// What the commands of the pages name and the repository lacks, as "page: command: word".
pub fn broken() -> Vec<String> {
    let workspace = Workspace::read();
    let packages: BTreeSet<&str> = workspace
        .members
        .iter()
        .map(|m| m.package.as_str())
        .collect();
    let targets: BTreeSet<String> = workspace.members.iter().flat_map(targets_of).collect();
    let recipes = read(&root().join("justfile"));
    let recipes: BTreeSet<&str> = recipes
        .lines()
        .filter(|line| !line.starts_with(['#', ' ']))
        .filter_map(|line| line.split([' ', ':']).next())
        .collect();
    let mut broken = Vec::new();
    for page in all_pages() {
        for command in code_of(&read(&page)) {
            let words: Vec<&str> = command.split_whitespace().collect();
            let mut lacks = |word: &str| {
                broken.push(format!("{}: {command}: {word}", page.display()));
            };
            for pair in words.windows(2) {
                let &[flag, name] = pair else { continue };
                let is_known = match flag {
                    "just" => recipes.contains(name),
                    "-p" if words.contains(&"cargo") => packages.contains(name),
                    "--test" | "--bench" | "--example" => targets.contains(name),
                    _ => true,
                };
                if !is_known {
                    lacks(name);
                }
            }
            for word in words {
                // Quotes, and the end of a sentence in a comment.
                let path = word.trim_matches(['"', '\'', '(', ')', ',', '.', ';', ':', '$']);
                let is_placeholder =
                    |part: &str| part.len() > 1 && part.chars().all(|c| c.is_ascii_uppercase());
                let is_pattern = path.contains(['*', '<', '$', '{', '[', '…'])
                    || path.split('/').any(is_placeholder)
                    || path == MADE;
                let is_ours = FOLDERS.iter().any(|folder| path.starts_with(folder));
                if is_ours && !is_pattern && !root().join(path).exists() {
                    lacks(word);
                }
            }
        }
    }
    broken
}

/// Names of the tests, benchmarks and examples of a crate.
fn targets_of(member: &Member) -> Vec<String> {
    let manifest = table(&member.folder.join("Cargo.toml"));
    let mut names = Vec::new();
    for kind in ["test", "bench", "example"] {
        let declared = manifest.get(kind).and_then(|value| value.as_array());
        let declared = declared.into_iter().flatten();
        names.extend(declared.filter_map(|one| Some(one.get("name")?.as_str()?.to_owned())));
    }
    for folder in ["tests", "benches", "examples"] {
        let Ok(entries) = std::fs::read_dir(member.folder.join(folder)) else {
            continue;
        };
        let found =
            entries.filter_map(|entry| entry.ok()?.path().file_stem()?.to_str().map(str::to_owned));
        names.extend(found);
    }
    names
}
