//! Replays of scans that an independent generator made (`tests/foreign/generator`).

use std::path::Path;
use std::process::Command;

/// The generator: a script of its folder, in Python.
fn generator(script: &str) -> Command {
    let python = std::env::var_os("VELOMOTION_PYTHON").unwrap_or_else(|| "python3".into());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/foreign/generator");
    let mut command = Command::new(python);
    command.arg(folder.join(script));
    command
}

/// Runs a command that must succeed. Returns its output.
fn output(mut command: Command) -> String {
    let output = command.output().unwrap();
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {printed}{errors}");
    printed
}

/// velodyne-decoder reads the generator's packets to the steps of range and azimuth.
#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn the_generator_is_right() {
    let printed = output(generator("self_check.py"));
    let found: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(found["points"], 289_152, "{found}");
    assert!(found["worst_m"].as_f64().unwrap() < 0.0025, "{found}");
}

/// No scan is silently wrong, beyond its bound, without points that it allows, or given a warning
/// though nothing is wrong.
#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn scans_of_the_generator_are_within_their_bounds() {
    let mut command = generator("run.py");
    command.args(["--program", env!("CARGO_BIN_EXE_velomotion")]);
    for group in ["plain", "link", "latch", "clock", "missing", "files"] {
        command.args(["--only", group]);
    }
    let printed = output(command);
    let wrong = printed.lines().filter(|line| line.ends_with(" wrong |"));
    assert_eq!(wrong.collect::<Vec<_>>(), Vec::<&str>::new());
    assert!(
        printed
            .lines()
            .filter(|line| line.ends_with(" ok |"))
            .count()
            > 70,
        "{printed}"
    );
}
