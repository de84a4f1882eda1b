//! Valid and invalid requests that PyPI's schemathesis derives from the daemon's OpenAPI
//! description.

use std::path::Path;

use daemon::{Daemon, Options};
use velomotion_tests::bench::Bench;

/// Requests that are always valid and move or stop the axis.
const COMMANDS: &str = "home$|stop$|clear$";

/// A daemon on a simulated scanner with its own folders.
fn daemon(bench: &Bench, folder: &Path) -> Daemon {
    let mut config = bench.config();
    config.daemon.scans = Some(folder.join("scans"));
    config.daemon.reserve_bytes = 1_000;
    let daemon = Daemon::start(Options {
        config,
        listen: Some(([127, 0, 0, 1], 0).into()),
        runtime: Some(folder.to_owned()),
        ..Options::default()
    });
    let daemon = daemon.unwrap();
    let connected = || {
        let status = daemon.state().service.status();
        let well = engine::service::status::DeviceHealth::Connected;
        status.drive.state == well && status.lidar.state == well
    };
    while !connected() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    daemon
}

/// Runs every check of schemathesis on the answers to seeded requests.
fn fuzz(daemon: &Daemon, folder: &Path, more: &[&str]) {
    let configuration = concat!(env!("CARGO_MANIFEST_DIR"), "/foreign/schemathesis.toml");
    let description = format!("http://{}/api/v1/openapi.json", daemon.address());
    let output = crate::python()
        .args([
            "-m",
            "schemathesis.cli",
            "--config-file",
            configuration,
            "run",
        ])
        .arg(description)
        .args([
            "--checks",
            "all",
            "--phases",
            "coverage,fuzzing",
            "--seed",
            "1",
        ])
        // The axis's limits depend on its configuration and its readiness on its activity: a valid
        // request may be refused.
        .args(["--exclude-checks", "positive_data_acceptance"])
        .args([
            "--request-timeout",
            "60",
            "--continue-on-failure",
            "--warnings",
            "off",
        ])
        .args(more)
        // schemathesis keeps a database of its examples.
        .current_dir(folder)
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{printed}");
    assert!(printed.contains("cases"), "no request was sent: {printed}");
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn invalid_requests_are_refused_as_described_and_nothing_moves() {
    let (bench, folder) = (Bench::start(), tempfile::tempdir().unwrap());
    let daemon = daemon(&bench, folder.path());
    let bad = [
        "--mode",
        "negative",
        "-n",
        "15",
        "--exclude-path-regex",
        COMMANDS,
    ];
    fuzz(&daemon, folder.path(), &bad);
    assert!(!bench.has_moved(), "an invalid request moved the axis");
    assert!(daemon.state().scans.list().is_empty());
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn arbitrary_requests_are_answered_as_described_and_the_axis_ends_at_rest() {
    let (bench, folder) = (Bench::start(), tempfile::tempdir().unwrap());
    let daemon = daemon(&bench, folder.path());
    fuzz(&daemon, folder.path(), &["-n", "4"]);
    daemon.stop(|| true).unwrap();
    assert!(
        bench.is_safe(),
        "the axis is not at rest after the daemon's end"
    );
}
