//! A scene without effects executes as many instructions as in a build without the effects' code.
//!
//! valgrind's callgrind counts the instructions, which is exact; times are not.

#![allow(clippy::panic, clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::Command;

const EXAMPLE: &str = "hall_without_effects";

fn output(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|error| {
        panic!("{command:?} does not run: {error}");
    });
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {errors}");
    format!("{}{errors}", String::from_utf8_lossy(&output.stdout))
}

/// The release build of the example with exactly these features.
fn built(features: &[&str], into: &Path) -> PathBuf {
    output(
        Command::new(env!("CARGO"))
            .args(["build", "--release", "--locked", "-p", "velomotion-sim"])
            .args(["--example", EXAMPLE, "--no-default-features"])
            .args(features)
            .arg("--target-dir")
            .arg(into)
            .current_dir(env!("CARGO_MANIFEST_DIR")),
    );
    let example = into.join("release/examples").join(EXAMPLE);
    let kept = into.join(format!("{EXAMPLE}-{}", features.len()));
    std::fs::copy(&example, &kept).unwrap();
    kept
}

/// Instructions of a run, and its output.
fn counted(program: &Path, into: &Path) -> (u64, String) {
    let text = output(
        Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(program)
            .current_dir(into),
    );
    let line = |start: &str| text.lines().find_map(|line| line.split_once(start));
    let (_, refs) = line("Collected :").unwrap_or_else(|| panic!("no count in {text}"));
    let (shots, checksum) = line(" shots ").unwrap_or_else(|| panic!("no checksum in {text}"));
    (refs.trim().parse().unwrap(), format!("{shots} {checksum}"))
}

#[test]
#[ignore = "needs valgrind"]
fn absent_effects_cost_no_instructions() {
    let into = Path::new(env!("CARGO_TARGET_TMPDIR")).join("absent-effects");
    std::fs::create_dir_all(&into).unwrap();
    let without = built(&[], &into);
    let with = built(&["--features", "effects"], &into);
    let (absent, first) = counted(&without, &into);
    let (disabled, second) = counted(&with, &into);
    assert_eq!(first, second, "the same bytes");
    let more = disabled as f64 / absent as f64 - 1.0;
    println!(
        "{absent} instructions without effects, {disabled} with none enabled: {:+.4} %",
        100.0 * more
    );
    assert!(more.abs() < 0.005, "{absent} against {disabled}");
    // More than a thousand instructions per packet, so that there is something to count.
    assert!(absent > 1_000_000);
}
