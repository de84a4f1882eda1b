//! What commands print with `--json` follows the schemas in docs/src/schema.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use super::{Place, json, recording};
use crate::tilt::Bench;

/// Commands that print their object once they serve, and run on.
const SERVICES: [&str; 2] = [
    "daemon --listen 127.0.0.1:0 --json",
    "firmware-sim --usb --json",
];

/// The line that such a command prints.
fn announced(place: &Place, line: &str) -> String {
    let mut service = Command::new(env!("CARGO_BIN_EXE_velomotion"))
        .args(line.split_whitespace())
        .current_dir(place.0.path())
        .env("XDG_RUNTIME_DIR", place.0.path())
        .env("XDG_DATA_HOME", place.0.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut printed = String::new();
    let output = service.stdout.take().unwrap();
    BufReader::new(output).read_line(&mut printed).unwrap();
    service.kill().unwrap();
    service.wait().unwrap();
    printed
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn what_commands_print_follows_the_schemas() {
    let place = Place::new();
    let gps = recording("vlp16-strongest-gps.pcap");
    let gps = gps.display();
    let lines = [
        "capture --speed 90 --from 0 --to -2 -o scan.ply --json".to_owned(),
        "replay scan.pcapng --tolerance 200mm@20m --live -o again.ply --json".to_owned(),
        "replay scan.pcapng -o lidar.pcap --json".to_owned(),
        format!("replay {gps} --tilt none --frames 0 -o frames.ply --json"),
        "info scan.pcapng --json".to_owned(),
        format!("info {gps} --json"),
        "simulate hall --explain --truth truth.ply --json".to_owned(),
        "simulate hdl64e.toml --json".to_owned(),
        "analyze velomotion16:56.25 again.ply scan.pcapng --json".to_owned(),
        "analyze velomotion16 --sweep speed=50..90/3 --json".to_owned(),
        "plan --at 20m --gap 0.8deg --json".to_owned(),
        "tradeoff --quick --json".to_owned(),
        "tilt status --json".to_owned(),
        "doctor --json".to_owned(),
        "help formats --json".to_owned(),
        "replay cut.pcapng -o cut.ply --json".to_owned(),
        "info absent.pcap --json".to_owned(),
        "replay --json".to_owned(),
    ];
    let points = "scene = \"hall\"\nsensor = { model = \"hdl64e\" }\n[motion]\nkind = \"fixed\"\nduration_s = 0.1\n";
    std::fs::write(place.path("hdl64e.toml"), points).unwrap();
    let mut input = String::new();
    for line in &lines {
        if line.contains("cut.pcapng") {
            let log = std::fs::read(place.path("scan.pcapng")).unwrap();
            std::fs::write(place.path("cut.pcapng"), &log[..log.len() - 100]).unwrap();
        }
        let object = json(&place.run(line));
        let fails = line.contains("absent") || line == "replay --json";
        assert_eq!(object["schema"] == "error-1", fails, "{line}: {object}");
        input.push_str(&format!("{object}\n"));
    }
    for line in SERVICES {
        input.push_str(&announced(&place, line));
    }
    let bench = Bench::new("--usb");
    let bring_up = bench.run("doctor --bring-up --yes --report report.md --json");
    input.push_str(&format!("{}\n", json(&bring_up)));
    bench.json("tilt home");
    let (mut moving, rest) = bench.start_move("tilt goto -40 --speed 1");
    input.push_str(&format!("{}\n", bench.json("tilt stop")));
    assert_eq!(moving.wait().unwrap().code(), Some(130));
    rest.join().unwrap();
    let python = std::env::var_os("VELOMOTION_PYTHON").unwrap_or_else(|| "python3".into());
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut validator = Command::new(python)
        .arg(root.join("tests/foreign/json_schema.py"))
        .arg(root.join("docs/src/schema"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = validator.stdin.take().unwrap();
    stdin.write_all(input.as_bytes()).unwrap();
    drop(stdin);
    let output = validator.wait_with_output().unwrap();
    assert!(output.status.success());
    let printed = String::from_utf8(output.stdout).unwrap();
    assert_eq!(printed.lines().count(), lines.len() + SERVICES.len() + 2);
    let schemas: BTreeSet<&str> = printed.lines().collect();
    let expected = [
        "analyze-1",
        "analyze-sweep-1",
        "axis-1",
        "bring-up-1",
        "daemon-1",
        "doctor-1",
        "error-1",
        "firmware-sim-1",
        "help-1",
        "info-1",
        "pcap-1",
        "scan-1",
        "simulate-1",
        "plan-1",
        "stopped-1",
        "tradeoff-1",
    ];
    assert_eq!(schemas, expected.into());
}
