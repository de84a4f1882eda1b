//! `capture` and `tilt` through a daemon behave as they do without one.

use std::io::{BufRead, BufReader};
use std::process::{Output, Stdio};

use serde_json::Value;

use super::rig::{Process, place, printed, ready, request, run, velomotion};

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", printed(output)))
}

#[test]
fn a_capture_through_the_daemon_equals_a_direct_one() {
    let folder = place();
    let own = run(folder.path(), "capture --speed 56.25 -o own.ply --json");
    assert!(own.status.success(), "{}", printed(&own));
    let daemon = Process::start(folder.path());
    ready(daemon.address);
    let through = run(folder.path(), "capture --speed 56.25 -o through.ply --json");
    assert!(through.status.success(), "{}", printed(&through));
    let scans = request(daemon.address, "GET", "/api/v1/scans", "", "").json();
    assert!(
        !scans["scans"].as_array().unwrap().is_empty(),
        "it did not go through the daemon"
    );

    // Same keys, messages and files.
    let keys =
        |value: &Value| -> Vec<String> { value.as_object().unwrap().keys().cloned().collect() };
    let (own_json, through_json) = (json(&own), json(&through));
    assert_eq!(keys(&own_json), keys(&through_json));
    for part in ["reception", "truth", "sync", "packets"] {
        assert_eq!(keys(&own_json[part]), keys(&through_json[part]), "{part}");
    }
    assert_eq!(through_json["output"], "through.ply");
    assert_eq!(through_json["log"], "through.pcapng");
    let lines = |output: &Output| {
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        text.lines()
            .filter(|line| !line.starts_with("warning"))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert_eq!(lines(&own), lines(&through));
    let again = run(folder.path(), "replay through.pcapng -o again.ply");
    assert!(again.status.success());
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert!(read("again.ply") == read("through.ply"));
    // The daemon's own cloud is identical, too.
    let id = scans["scans"][0]["id"].as_str().unwrap();
    let kept = folder
        .path()
        .join("velomotion/scans")
        .join(id)
        .join("cloud.ply");
    assert!(std::fs::read(kept).unwrap() == read("through.ply"));

    // It makes no clouds of other formats, and has the truth of its simulator.
    let line = "capture --speed 56.25 -o table.csv --json -vv";
    let table = run(folder.path(), line);
    assert!(table.status.success(), "{}", printed(&table));
    assert!(!printed(&table).contains("copy of the daemon's"));
    assert!(json(&table)["truth"]["rms_m"].as_f64().unwrap() < 0.05);
    let text = String::from_utf8(read("table.csv")).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#')).count() - 1;
    assert_eq!(json(&table)["points"], rows);

    // Errors have the same text.
    for (line, code, word) in [
        ("capture --speed 100", 2, "98"),
        ("capture --speed 10 -o through.ply", 2, "--force"),
        ("tilt goto 10", 2, "10"),
    ] {
        let output = run(folder.path(), line);
        assert_eq!(
            output.status.code(),
            Some(code),
            "{line}: {}",
            printed(&output)
        );
        assert!(
            printed(&output).contains(word),
            "{line}: {}",
            printed(&output)
        );
    }

    // The axis keeps its position: the daemon owns it.
    let home = run(folder.path(), "tilt home --json");
    assert!(home.status.success(), "{}", printed(&home));
    let there = run(folder.path(), "tilt goto -7 --speed 50 --json");
    assert!(there.status.success(), "{}", printed(&there));
    let status = json(&run(folder.path(), "tilt status --json"));
    assert!(
        (status["angle_deg"].as_f64().unwrap() + 7.0).abs() < 0.01,
        "{status}"
    );
    let text = run(folder.path(), "tilt status");
    assert!(String::from_utf8_lossy(&text.stdout).contains("SIMULATED"));
    assert!(run(folder.path(), "tilt stop").status.success());
    assert!(run(folder.path(), "tilt faults").status.success());
}

#[test]
fn ctrl_c_stops_the_daemons_axis_and_keeps_the_log() {
    let folder = place();
    let daemon = Process::start(folder.path());
    ready(daemon.address);
    let mut capture = velomotion(folder.path(), "capture --speed 5 -o scan.ply -vv")
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The capture may take a moment to reach the daemon.
    super::rig::wait("the capture", || {
        let status = request(daemon.address, "GET", "/api/v1/status", "", "").json();
        (status["activity"]["doing"] == "capturing").then_some(())
    });
    assert!(super::rig::sweeps(daemon.address));
    let id = capture.id().to_string();
    let sent = std::process::Command::new("kill")
        .args(["-INT", &id])
        .status();
    assert!(sent.unwrap().success());
    let mut text = String::new();
    for line in BufReader::new(capture.stderr.take().unwrap()).lines() {
        text.push_str(&line.unwrap());
    }
    assert_eq!(capture.wait().unwrap().code(), Some(130), "{text}");
    assert!(text.contains("stopped by the user"), "{text}");
    assert!(text.contains("the log scan.pcapng"), "{text}");
    // The daemon has made the cloud.
    assert!(text.contains("copy of the daemon's"), "{text}");
    for name in ["scan.ply", "scan.pcapng"] {
        assert!(folder.path().join(name).is_file(), "{name}: {text}");
    }
    let status = request(daemon.address, "GET", "/api/v1/status", "", "").json();
    assert_eq!(status["activity"]["doing"], "idle");
}

#[cfg(not(feature = "ros2"))]
#[test]
fn a_configuration_with_ros_2_needs_a_build_with_it() {
    let folder = place();
    let file = folder.path().join("velomotion.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, format!("{text}[daemon.ros2]\ndomain = 3\n")).unwrap();
    let output = run(folder.path(), "daemon --listen 127.0.0.1:0");
    assert_eq!(output.status.code(), Some(2), "{}", printed(&output));
    assert!(
        printed(&output).contains("--features ros2"),
        "{}",
        printed(&output)
    );
    // The rest of the configuration applies.
    let status = run(folder.path(), "tilt status --json");
    assert!(!printed(&status).contains("ros2"), "{}", printed(&status));
}
