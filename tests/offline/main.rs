//! The commands that need no device, also of a program without them: exit codes, messages, JSON,
//! and no overwriting without `--force`.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers outside #[test] functions

mod analyze;
mod commands;
mod frames;
mod packets;
mod place;
mod recordings;
mod simulated_logs;
mod tradeoff;

use std::path::{Path, PathBuf};
use std::process::Command;

use place::{Place, json, recording};

#[test]
fn the_version_names_the_commit() {
    let place = Place::new();
    let output = place.run("--version");
    let printed = String::from_utf8(output.stdout).unwrap();
    let version = format!("velomotion {}", env!("CARGO_PKG_VERSION"));
    let rest = printed.trim_end().strip_prefix(&version).unwrap();
    let commit = rest
        .strip_prefix(" (")
        .and_then(|rest| rest.strip_suffix(')'));
    match commit.and_then(|commit| commit.split_once(' ')) {
        Some((hash, day)) => assert!(
            hash.len() >= 12
                && hash.bytes().all(|digit| digit.is_ascii_hexdigit())
                && day.len() == 10,
            "{printed}"
        ),
        // Packages without a repository.
        None => assert_eq!(rest, ""),
    }
}

/// A whole recording; the repository holds a cut of it.
fn whole_recording(name: &str) -> PathBuf {
    let folder = std::env::var_os("VELOMOTION_RECORDINGS").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings"),
        PathBuf::from,
    );
    folder.join(name).canonicalize().unwrap()
}

#[test]
fn simulate_writes_a_log_that_replay_reads_and_locates_errors() {
    let place = Place::new();
    place.fails("simulate castle", 3, &["scene castle", "hall"]);
    let scene =
        "scene = \"hall\"\n[motion]\nkind = \"fixed\"\nduration_s = 0.05\n[effects]\nall = false\n";
    std::fs::write(place.path("wrong.toml"), format!("{scene}range_nois = 1\n")).unwrap();
    place.fails(
        "simulate wrong.toml",
        3,
        &["wrong.toml, line 7", "range_nois"],
    );
    let wrong = format!("{scene}[materials]\na = {{ reflectivity = 300 }}\n");
    std::fs::write(place.path("wrong.toml"), wrong).unwrap();
    place.fails(
        "simulate wrong.toml",
        3,
        &[
            "wrong.toml, line 8",
            "`300`, expected a whole number from 0 to 255",
        ],
    );
    std::fs::write(place.path("stand.toml"), scene).unwrap();
    place.fails("simulate stand.toml --truth t.obj", 2, &["t.obj", ".ply"]);
    place.fails("simulate stand.toml --truth - --json", 2, &["stdout"]);
    place.fails("simulate stand.toml -o -", 2, &["file", ".pcapng"]);
    let output = place.run("simulate stand.toml --truth t.csv --json --threads 2");
    assert!(output.status.success(), "{output:?}");
    let printed = json(&output);
    assert_eq!(printed["packets"]["data"], 37);
    assert_eq!(printed["share_returned"], 1.0);
    assert_eq!(printed["effects"].as_array().unwrap().len(), 0);
    assert_eq!(printed["log"], "stand.pcapng");
    let truth = std::fs::read_to_string(place.path("t.csv")).unwrap();
    assert!(truth.contains("SIMULATED"), "{:?}", truth.lines().next());
    let rows = truth.lines().filter(|line| !line.starts_with('#')).count() - 1;
    assert_eq!(printed["returned"].as_u64(), Some(rows as u64));
    place.fails("simulate stand.toml", 2, &["exists"]);
    let over = "simulate stand.toml -o stand.toml --force";
    place.fails(over, 2, &["stand.toml", "overwrite its input"]);
    // The lidar alone, for programs that read one link type per file.
    let output = place.run("simulate rig -o rig.pcap --json");
    let (made, reported) = (json(&output), json(&place.run("info rig.pcap --json")));
    assert_eq!(reported["packets"]["data"], made["packets"]["data"]);
    assert_eq!(
        (&reported["packets"]["other"], &reported["returns"]),
        (&0.into(), &made["returns"])
    );
    let asks = format!("{scene}[effects.tilt_limits]\nfrom_deg = -45.0\nto_deg = 45.0\n");
    std::fs::write(place.path("asks.toml"), asks).unwrap();
    let output = place.run("simulate asks.toml --explain --json");
    let reported = &json(&output)["explanation"]["on"][0];
    assert_eq!(reported["effect"], "tilt_limits");
    assert_eq!(
        (&reported["line"], &reported["acted"]),
        (&7.into(), &0.into())
    );
    assert!(reported["not_needed"].as_str().unwrap().contains("stops"));
    let output = place.run("simulate asks.toml --without all --force --json");
    assert_eq!(json(&output)["effects"].as_array().unwrap().len(), 0);
    let output = place.run("simulate asks.toml --without weather,loss --force --json");
    assert_eq!(json(&output)["effects"].as_array().unwrap().len(), 1);
    let unknown = place.run("simulate asks.toml --without fog");
    assert_eq!(unknown.status.code(), Some(2));
    let printed = String::from_utf8_lossy(&unknown.stderr).into_owned();
    for name in sim::effect_models::EffectsConfig::NAMES {
        assert!(printed.contains(name), "{name}: {printed}");
    }
    let info = json(&place.run("info asks.pcapng --json"));
    let simulation = &info["configuration"]["simulation"];
    assert_eq!(
        (&simulation["scene"], &simulation["seed"]),
        (&"asks.toml".into(), &"0".into())
    );
    assert_eq!(simulation["effects"][0], "tilt_limits");
    let info = place.run("info asks.pcapng");
    let printed = String::from_utf8_lossy(&info.stdout).into_owned();
    assert!(printed.contains("asks.toml, seed 0"), "{printed}");
    let output = place.run("replay stand.pcapng --tilt none -o s.ply --json");
    assert_eq!(json(&output)["points"].as_u64(), Some(rows as u64));
    assert_eq!(json(&output)["simulated"], true);
}

#[test]
fn invalid_options_and_files_are_one_line_that_names_them() {
    let place = Place::new();
    place.fails(
        "simulate hall --threads 0",
        2,
        &["error:", "'0'", "--threads"],
    );
    place.fails("simulate hall --seed -1", 2, &["error:", "'-1'", "--seed"]);
    place.fails(
        "analyze vlp16 --level -1",
        2,
        &["error:", "'-1'", "--level"],
    );
    place.fails(
        "plan --at 500m --error 5mm",
        2,
        &["500", "--at", "name a distance within it"],
    );
    place.fails("analyze vlp16:1e300", 2, &["1e300"]);
    place.fails("info log.pcapng --device sim", 2, &["error:", "--device"]);
    place.fails(
        "simulate hall -o hall.ply",
        2,
        &["hall.ply", ".pcapng or .pcap"],
    );
    place.fails("simulate hall --truth hall.xyzzy", 2, &[".xyzzy", ".laz"]);
    let refused = place.run("simulate hall --truth hall.xyzzy");
    let printed = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(!printed.contains(" -o"), "{printed}");
    let input = recording("vlp16-strongest-gps.pcap");
    std::fs::write(place.path("long.yaml"), "x".repeat(100_000)).unwrap();
    std::fs::write(
        place.path("long.toml"),
        format!("{} = 1", "x".repeat(100_000)),
    )
    .unwrap();
    std::fs::write(place.path("huge.yaml"), "x: 1\n".repeat(300_000)).unwrap();
    for name in ["long.yaml", "long.toml", "huge.yaml"] {
        let line = format!(
            "replay {} --tilt none --calibration {name}",
            input.display()
        );
        place.fails(&line, 3, &["error:", name]);
        let printed = String::from_utf8(place.run(&line).stderr).unwrap();
        assert_eq!(printed.lines().count(), 2, "{printed}");
        assert!(printed.len() < 600, "{name}: {} bytes", printed.len());
    }
    let refused = place.run("simulate hall --threads 0 --json");
    assert_eq!(json(&refused)["error"]["exit_code"], 2);
    for (page, title) in [("formats", "# Formats"), ("json", "# JSON")] {
        let page = place.run(&format!("help {page}"));
        assert!(page.status.success() && page.stdout.starts_with(title.as_bytes()));
    }
    for value in ["9".repeat(100_000), "9 ".repeat(50_000)] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_velomotion"));
        let output = command
            .args(["simulate", "hall", "--seed", &value])
            .output();
        let printed = String::from_utf8(output.unwrap().stderr).unwrap();
        assert!(printed.len() < 600, "{} bytes", printed.len());
    }
    for option in [
        "--tilt none",
        "--mount mount.toml",
        "--time utc",
        "--tolerance 2mm@20m",
        "--live",
        "--uncertainty",
        "--frames 0",
        "--realtime",
    ] {
        let line = format!("replay {} -o lidar.pcap {option}", input.display());
        let name = option.split(' ').next().unwrap();
        place.fails(&line, 2, &["error:", ".pcap", name]);
    }
}
