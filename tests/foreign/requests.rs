//! Bad requests, and good ones in any order: PyPI schemathesis makes them from the daemon's own
//! description.

use std::path::Path;

use daemon::{Daemon, Options};
use velomotion_tests::bench::Bench;

/// What is always right to ask, and moves the axis or stops it.
const COMMANDS: &str = "home$|stop$|clear$";

/// A daemon on a software scanner, in folders of its own.
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
        // What an axis can do depends on its configuration, and whether it can now on what it does:
        // a good request may be refused.
        .args(["--exclude-checks", "positive_data_acceptance"])
        .args([
            "--request-timeout",
            "60",
            "--continue-on-failure",
            "--warnings",
            "off",
        ])
        .args(more)
        // It remembers what it tried.
        .current_dir(folder)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("cases"), "nothing was tried: {said}");
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn bad_requests_are_refused_as_described_and_nothing_moves() {
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
    assert!(!bench.has_moved(), "a bad request moved the axis");
    assert!(daemon.state().scans.list().is_empty());
    daemon.stop(|| true).unwrap();
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn any_requests_in_any_order_are_answered_as_described_and_the_axis_ends_at_rest() {
    let (bench, folder) = (Bench::start(), tempfile::tempdir().unwrap());
    let daemon = daemon(&bench, folder.path());
    fuzz(&daemon, folder.path(), &["-n", "4"]);
    daemon.stop(|| true).unwrap();
    assert!(
        bench.is_safe(),
        "the daemon has ended, and the axis is not at rest"
    );
}
