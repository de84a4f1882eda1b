//! Stores version and commit of the build. `cfg(devices)`: the feature of this name, on Linux.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=VELOMOTION_COMMIT");
    let system = env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    if env::var_os("CARGO_FEATURE_DEVICES").is_some() && system == "linux" {
        println!("cargo:rustc-cfg=devices");
    }
    let package = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    let root = package.unwrap_or_default().join("../..");
    // The reflog changes with every commit and checkout. Development builds may name an older
    // commit, to avoid a rebuild after each.
    let log = root.join(".git/logs/HEAD");
    let released = env::var("PROFILE").is_ok_and(|profile| profile == "release");
    if released && log.exists() {
        println!("cargo:rerun-if-changed={}", log.display());
    }
    let given = env::var("VELOMOTION_COMMIT").ok();
    let commit = given
        .or_else(|| head(&root))
        .filter(|commit| !commit.is_empty());
    let version = env!("CARGO_PKG_VERSION");
    match commit {
        Some(commit) => println!("cargo:rustc-env=VELOMOTION_VERSION={version} ({commit})"),
        None => println!("cargo:rustc-env=VELOMOTION_VERSION={version}"),
    }
}

/// Short hash and date of the checked-out commit; `None` outside the project's own repository.
fn head(root: &Path) -> Option<String> {
    if !root.join(".git").exists() {
        return None;
    }
    let output = Command::new("git")
        .args(["log", "-1", "--abbrev=12", "--format=%h %cs"])
        .current_dir(root)
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?;
    Some(text.trim().to_owned())
}
