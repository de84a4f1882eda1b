//! `velomotion doctor` with a simulated drive in its own process.

use std::net::UdpSocket;

use serde_json::Value;

use crate::tilt::Bench;

/// Exit code and findings of `doctor`.
fn doctor(bench: &Bench) -> (Option<i32>, Vec<Value>) {
    let output = bench.run("doctor --json");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let findings = report["findings"].as_array().unwrap().clone();
    (output.status.code(), findings)
}

/// The finding about this, and its verdict.
fn finding(findings: &[Value], what: &str) -> (String, String) {
    let found = findings.iter().find(|finding| finding["what"] == what);
    let found = found.unwrap_or_else(|| panic!("no finding about {what} in {findings:?}"));
    let text = |key: &str| found[key].as_str().unwrap().to_owned();
    (text("verdict"), text("found"))
}

#[test]
fn doctor_asks_the_drive_and_listens_to_the_lidar() {
    let mut bench = Bench::new("--usb");
    let lidar = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = lidar.local_addr().unwrap().port();
    let path = bench.folder.path().join("velomotion.toml");
    let mut config = std::fs::read_to_string(&path).unwrap();
    config.push_str(&format!(
        "lidar = '127.0.0.1'\ndata_port = {port}\nposition_port = {port}\n"
    ));
    std::fs::write(&path, config).unwrap();

    // This process has the lidar's port.
    let (code, findings) = doctor(&bench);
    assert_eq!(code, Some(4), "{findings:?}");
    let (verdict, found) = finding(&findings, "configuration");
    assert_eq!((&*verdict, &*found), ("ok", "velomotion.toml"));
    let (verdict, found) = finding(&findings, "drive of soft");
    assert_eq!(verdict, "warning", "a new drive is in fault: {found}");
    assert!(found.starts_with("EPOS2, firmware"), "{found}");
    let (verdict, found) = finding(&findings, "lidar of soft");
    let own = format!("(pid {})", std::process::id());
    assert!(verdict == "problem" && found.contains(&own), "{found}");

    // The port is free, and nothing sends.
    drop(lidar);
    let (code, findings) = doctor(&bench);
    assert_eq!(code, Some(4), "{findings:?}");
    let (verdict, found) = finding(&findings, "lidar of soft");
    assert!(
        verdict == "problem" && found.contains("no packet"),
        "{found}"
    );

    // The drive is gone.
    bench.unplug();
    let (_, findings) = doctor(&bench);
    let (verdict, found) = finding(&findings, "drive of soft");
    assert!(
        verdict == "problem" && found.contains("no such device"),
        "{found}"
    );
}

#[test]
fn doctor_names_the_program_that_has_the_port() {
    let bench = Bench::new("--usb");
    let port = io::port::SerialPort::open(bench.folder.path().join("epos"), 115_200).unwrap();
    let (code, findings) = doctor(&bench);
    drop(port);
    let (verdict, found) = finding(&findings, "drive of soft");
    let own = format!("(pid {})", std::process::id());
    assert!(verdict == "problem" && found.contains(&own), "{found}");
    assert_eq!(code, Some(4));
}

/// Every step of the bring-up against the simulated drive. Other links
/// and defects are tested in virtual time.
#[test]
fn the_bring_up_finds_nothing_wrong_with_a_healthy_drive() {
    let bench = Bench::new("--usb");
    let output = bench.run("doctor --bring-up --yes --report first.md --json");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let steps = report["steps"].as_array().unwrap();
    assert_eq!(steps.len(), 11);
    for step in steps {
        let measurements = step["measurements"].as_array().unwrap();
        assert!(!measurements.is_empty(), "{step}");
    }
    let value = |name: &str| {
        let all = steps
            .iter()
            .flat_map(|step| step["measurements"].as_array().unwrap());
        let found = all.clone().find(|measurement| measurement["name"] == name);
        found.unwrap_or_else(|| panic!("no {name}"))["value"]
            .as_str()
            .unwrap()
            .to_owned()
    };
    assert!(value("unit").starts_with("EPOS2"));
    assert!(value("onto the other switch").starts_with("method 17"));
    assert!(value("in a move").starts_with("at rest after 0."));
    let text = std::fs::read_to_string(bench.folder.path().join("first.md")).unwrap();
    assert_eq!(text.matches("\n## ").count(), 12);
    // No person presses the switches or turns the axis. The machine may be too busy to poll.
    assert_eq!(report["unchecked"], 2);
    let code = output.status.code();
    assert!(code == Some(6) || code == Some(5), "{code:?}");
    let judged = steps
        .iter()
        .flat_map(|step| step["measurements"].as_array().unwrap());
    let problems: Vec<&Value> = judged
        .filter(|found| found["judgement"] == "problem")
        .map(|found| &found["name"])
        .collect();
    assert!(
        problems
            .iter()
            .all(|name| name.as_str().unwrap().starts_with("time between positions")),
        "{problems:?}"
    );
    assert_eq!(report["problems"], problems.len());
    assert!(text.contains("2 open checks"), "{text}");
    // A second report goes behind the first.
    let refused = bench.run("doctor --bring-up --report first.md");
    assert_eq!(refused.status.code(), Some(2), "stdin is not a terminal");
    let again = std::fs::read_to_string(bench.folder.path().join("first.md")).unwrap();
    assert_eq!(again, text);
}
