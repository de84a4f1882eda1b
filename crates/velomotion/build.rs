//! Tells the program which commit it was built from.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-env-changed=VELOMOTION_COMMIT");
    // The reflog grows with every commit and checkout. Where there is no repository there is nothing to watch.
    let log = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../.git/logs/HEAD");
    if log.exists() {
        println!("cargo:rerun-if-changed={}", log.display());
    }
    println!("cargo:rerun-if-changed=build.rs");
    let commit = std::env::var("VELOMOTION_COMMIT").ok().or_else(head);
    let version = env!("CARGO_PKG_VERSION");
    match commit {
        Some(commit) => println!("cargo:rustc-env=VELOMOTION_VERSION={version} ({commit})"),
        None => println!("cargo:rustc-env=VELOMOTION_VERSION={version}"),
    }
}

/// The commit that is checked out, and its day; none where sources came without a repository.
fn head() -> Option<String> {
    let output = Command::new("git")
        .args(["log", "-1", "--abbrev=12", "--format=%h %cs"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    let said = String::from_utf8(output.stdout).ok()?;
    let said = said.trim();
    (!said.is_empty()).then(|| said.to_owned())
}
