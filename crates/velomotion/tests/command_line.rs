//! The program as other programs meet it: exit codes, messages, JSON, and that nothing is ever overwritten unasked.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers outside #[test] functions

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

struct Place(tempfile::TempDir);

impl Place {
    /// An empty directory with a configuration that names the simulator.
    fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        std::fs::write(place.path("velomotion.toml"), "device = \"sim\"\n").unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, line: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_velomotion"))
            .args(line.split_whitespace())
            .current_dir(self.0.path())
            .env("XDG_CONFIG_HOME", self.0.path())
            .env_remove("RUST_LOG")
            .output()
            .unwrap()
    }

    /// Runs and expects failure with `code` and, on stderr, each of `words`.
    fn fails(&self, line: &str, code: i32, words: &[&str]) {
        let before = self.files();
        let output = self.run(line);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{line}:\n{said}");
        let flat = said.split_whitespace().collect::<Vec<_>>().join(" ");
        for word in words {
            assert!(flat.contains(word), "{line}: no {word:?} in:\n{said}");
        }
        assert!(said.contains("help:"), "{line}: no next step in:\n{said}");
        assert_eq!(self.files(), before, "{line} left files behind");
    }

    fn files(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let mut files: Vec<_> = std::fs::read_dir(self.0.path())
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .map(|path| (path.clone(), std::fs::read(path).unwrap_or_default()))
            .collect();
        files.sort();
        files
    }
}

fn json(output: &Output) -> serde_json::Value {
    let text = String::from_utf8_lossy(&output.stdout);
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error} in stdout:\n{text}"))
}

#[test]
fn a_simulated_capture_gives_a_cloud_a_log_and_the_same_cloud_again() {
    let place = Place::new();
    let mut output = place.run("capture --speed 56.25 -o scan.ply --json");
    // Software devices are silent while the machine keeps them waiting, and the capture stops as it must.
    for _ in 0..3 {
        let said = String::from_utf8_lossy(&output.stderr);
        if output.status.code() != Some(5) || !said.contains("silence") {
            break;
        }
        output = place.run("capture --speed 56.25 -o scan.ply --json --force");
    }
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let scan = json(&output);
    assert_eq!(scan["simulated"], true);
    assert!(scan["points"].as_u64().unwrap() > 180_000, "{scan}");
    assert_eq!(scan["sweeps"].as_array().unwrap().len(), 1);
    let cruise = scan["sweeps"][0]["cruise_deg_s"].as_f64().unwrap();
    assert!((cruise.abs() - 56.25).abs() < 0.5, "{scan}");
    // In real time on a busy machine the polls may stall: then the report says so, else the cloud is true.
    let doubted = scan["warnings"].to_string().contains("angles may be off");
    let of = |name: &str| scan["truth"][name].as_f64().unwrap();
    assert!(
        doubted || (of("rms_m") < 10e-3 && of("worst_m") < 0.1),
        "{scan}"
    );
    assert_eq!(scan["lost_records"], 0);
    assert_eq!(scan["tilt"]["transport"], "usb");
    assert_eq!(scan["packets"]["malformed"], 0);

    let ply = std::fs::read(place.path("scan.ply")).unwrap();
    let header = String::from_utf8_lossy(&ply[..2_000]).into_owned();
    assert!(header.to_lowercase().contains("simulated"), "{header}");
    for property in ["x", "y", "z", "intensity", "ring", "time", "tilt"] {
        assert!(header.contains(&format!(" {property}\n")), "{header}");
    }

    let again = place.run("replay scan.pcapng -o again.ply --json");
    assert!(
        again.status.success(),
        "{}",
        String::from_utf8_lossy(&again.stderr)
    );
    assert_eq!(json(&again)["points"], scan["points"]);
    assert_eq!(std::fs::read(place.path("again.ply")).unwrap(), ply);

    // The column is the last one of a line; without other errors a point is off by its range's steps at the least.
    let with_sd = place.run("replay scan.pcapng -o sd.csv --uncertainty");
    assert!(with_sd.status.success());
    let text = std::fs::read_to_string(place.path("sd.csv")).unwrap();
    let mut lines = text.lines().skip_while(|line| line.starts_with('#'));
    assert!(lines.next().unwrap().ends_with(",tilt_deg,sd_m"));
    let sds = lines.map(|line| line.rsplit(',').next().unwrap().parse::<f64>().unwrap());
    let least = sds.fold(f64::INFINITY, f64::min);
    assert!((0.000_57..0.000_8).contains(&least), "{least}");
    std::fs::remove_file(place.path("sd.csv")).unwrap();

    // The log is a plain lidar recording too, and says what it is.
    let info = place.run("info scan.pcapng --json");
    assert!(json(&info)["tilt"]["samples"].as_u64().unwrap() > 100);
    place.fails(
        "replay scan.pcapng -o scan.ply",
        2,
        &["scan.ply", "--force"],
    );
    place.fails(
        "capture --speed 56.25 -o scan.ply",
        2,
        &["scan.ply", "--force"],
    );

    cut_off(&place);
}

/// A log whose end is missing gives what it holds, and says where it ends.
fn cut_off(place: &Place) {
    let log = std::fs::read(place.path("scan.pcapng")).unwrap();
    std::fs::write(place.path("cut.pcapng"), &log[..log.len() * 2 / 3 + 5]).unwrap();
    let output = place.run("replay cut.pcapng --tilt none -o cut.ply --json");
    assert_eq!(output.status.code(), Some(6));
    assert!(json(&output)["truncated"].is_string());
    assert!(json(&output)["points"].as_u64().unwrap() > 100_000);
}

#[test]
fn ctrl_c_in_mid_sweep_saves_what_there_is_and_exits_130() {
    let place = Place::new();
    let mut capture = Command::new(env!("CARGO_BIN_EXE_velomotion"))
        .args("capture --speed 5 -o scan.ply -vv".split(' '))
        .current_dir(place.0.path())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // Homing is no profile move: the first of those is the sweep.
    let mut said = std::io::BufReader::new(capture.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("Moving(") {
        line.clear();
        assert!(
            std::io::BufRead::read_line(&mut said, &mut line).unwrap() > 0,
            "no motion"
        );
    }
    let rest = std::thread::spawn(move || {
        let mut text = String::new();
        std::io::Read::read_to_string(&mut said, &mut text).map(|_| text)
    });
    let kill = Command::new("kill")
        .args(["-INT", &capture.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
    assert_eq!(capture.wait().unwrap().code(), Some(130));
    let said = rest.join().unwrap().unwrap();
    assert!(said.contains("stopped by the user"), "{said}");
    assert!(place.path("scan.pcapng").is_file(), "the log is gone");
}

#[test]
fn speeds_and_angles_that_cannot_be_are_refused_before_anything_moves() {
    let place = Place::new();
    place.fails("capture --speed 0", 2, &["speed 0 deg/s", "1 rpm"]);
    place.fails("capture --speed -5", 2, &["speed"]);
    place.fails("capture --speed nan", 2, &["speed"]);
    place.fails("capture --speed 0.001", 2, &["rpm"]);
    place.fails("capture --speed 100", 2, &["100", "98"]);
    place.fails("capture --speed 10 --to -60", 2, &["-60", "-45"]);
    place.fails("capture --speed 10 --from 5", 2, &["5 deg", "-45"]);
    place.fails("capture --speed 10 --from -10 --to -10", 2, &["-10"]);
    place.fails("capture --speed 10 --accel 0", 2, &["accel"]);
    place.fails(
        "capture --speed 10 -o a.ply --log a.ply",
        2,
        &["both a.ply"],
    );
    place.fails("capture --speed 10 -o - --json", 2, &["stdout"]);
    place.fails("capture --speed 10 -o cloud.xyzzy", 2, &[".xyzzy", ".laz"]);
}

#[test]
fn devices_that_are_not_there_are_named() {
    let place = Place::new();
    place.fails(
        "capture --speed 10 --device nowhere",
        2,
        &["nowhere", "sim"],
    );
    let bench =
        "[device]\ndefault = 'bench'\n[device.bench]\nkind = 'usb'\nport = '/dev/nothing-here'\n";
    std::fs::write(place.path("bench.toml"), bench).unwrap();
    place.fails(
        "capture --speed 10 --config bench.toml",
        4,
        &["/dev/nothing-here"],
    );
    place.fails("capture --speed 10 --config none.toml", 3, &["none.toml"]);
    std::fs::write(place.path("typo.toml"), "[axis]\nmin_degg = 1\n").unwrap();
    place.fails(
        "capture --speed 10 --config typo.toml",
        3,
        &["min_degg", "line 2"],
    );
}

#[test]
fn files_that_are_no_recordings_are_refused() {
    let place = Place::new();
    std::fs::write(place.path("empty.pcap"), b"").unwrap();
    std::fs::write(
        place.path("text.pcap"),
        b"this is no recording at all, but it is long enough",
    )
    .unwrap();
    std::fs::write(place.path("other.pcap"), ping()).unwrap();
    for verb in ["info", "replay --tilt none"] {
        place.fails(&format!("{verb} missing.pcap"), 3, &["missing.pcap"]);
        place.fails(&format!("{verb} empty.pcap"), 3, &["empty"]);
        place.fails(&format!("{verb} text.pcap"), 3, &["pcap"]);
    }
    place.fails("replay --tilt none other.pcap", 3, &["no lidar"]);
    place.fails("info .", 3, &["name one recording in it"]);
    place.fails("replay --tilt missing.csv other.pcap", 3, &["missing.csv"]);
}

/// A classic pcap with one Ethernet frame of something else (ARP).
fn ping() -> Vec<u8> {
    let mut file = vec![0xD4, 0xC3, 0xB2, 0xA1, 2, 0, 4, 0];
    file.extend([0; 8]);
    file.extend(65_535u32.to_le_bytes());
    file.extend(1u32.to_le_bytes());
    let mut frame = vec![0xFF; 12];
    frame.extend([0x08, 0x06]);
    frame.extend([0; 46]);
    file.extend(1_600_000_000u32.to_le_bytes());
    file.extend([0; 4]);
    file.extend((frame.len() as u32).to_le_bytes());
    file.extend((frame.len() as u32).to_le_bytes());
    file.extend(frame);
    file
}

/// Real recordings lie beside the checkout; `None`, said aloud, where they do not.
fn recording(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("VELOMOTION_RECORDINGS").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings"),
        PathBuf::from,
    );
    let path = folder.join(name);
    if path.is_file() {
        return Some(path.canonicalize().unwrap());
    }
    eprintln!("skipped: {} is not there", path.display());
    None
}

#[test]
fn names_are_not_broken_at_the_end_of_a_line() {
    let place = Place::new();
    let name = format!("{}.pcap", "a-b".repeat(30));
    let said = place.run(&format!("info {name}")).stderr;
    assert!(String::from_utf8_lossy(&said).contains(&name));
}

#[test]
fn frames_go_to_files_only() {
    let Some(path) = recording("vlp16-strongest-gps.pcap") else {
        return;
    };
    let line = format!("replay {} --tilt none --frames 180 -o -", path.display());
    Place::new().fails(&line, 2, &["stdout takes one", "turn.ply"]);
}

#[test]
fn frames_are_cut_at_an_azimuth() {
    for wrong in ["400", "-361", "nan", "north"] {
        let output = Place::new().run(&format!("replay scan.pcap --frames {wrong}"));
        assert_eq!(output.status.code(), Some(2), "{wrong}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("--frames"));
    }
}

#[test]
fn frames_in_utc_are_the_cloud_in_utc() {
    let Some(path) = recording("vlp16-strongest-gps.pcap") else {
        return;
    };
    let rows = |bytes: Vec<u8>| {
        let mark = b"end_header\n";
        let at = bytes.windows(mark.len()).position(|w| w == mark).unwrap();
        bytes[at + mark.len()..].to_vec()
    };
    let place = Place::new();
    let input = path.display();
    for options in ["-o whole.ply", "--frames 180 -o turn.ply"] {
        let line = format!("replay {input} --tilt none --time utc {options}");
        assert!(place.run(&line).status.success());
    }
    let whole = rows(std::fs::read(place.path("whole.ply")).unwrap());
    let turns = (0..).map_while(|i| std::fs::read(place.path(&format!("turn-{i:05}.ply"))).ok());
    let turns: Vec<Vec<u8>> = turns.map(rows).collect();
    assert!(turns.len() > 3, "{}", turns.len());
    assert_eq!(turns.concat(), whole);
    let organised =
        format!("replay {input} --tilt none --time utc --frames 180 --organised -o o.pcd");
    assert!(place.run(&organised).status.success());
}

#[test]
fn a_recording_for_ros_is_a_bag_and_leaves_the_metadata_of_another_alone() {
    let Some(path) = recording("vlp16-strongest-gps.pcap") else {
        return;
    };
    let place = Place::new();
    let line = |options: &str| format!("replay {} --tilt none {options}", path.display());
    let metadata = || std::fs::read_to_string(place.path("metadata.yaml")).unwrap();
    assert!(place.run(&line("-o scan.mcap")).status.success());
    let first = metadata();
    assert!(first.contains("- \"scan.mcap\"\n"), "{first}");
    let words = &["scan.mcap", "--force"];
    place.fails(&line("-o scan.mcap"), 2, words);
    std::fs::write(place.path("metadata.yaml"), "files:\n  - scan.mcap\n").unwrap();
    assert!(place.run(&line("-o scan.mcap --force")).status.success());
    assert_eq!(metadata(), first);
    let output = place.run(&line("-o an.mcap"));
    assert!(output.status.success() && place.path("an.mcap").is_file());
    assert_eq!(metadata(), first);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("of another recording"), "{said}");
}

#[test]
fn turns_go_into_one_recording() {
    let Some(path) = recording("vlp16-strongest-gps.pcap") else {
        return;
    };
    let place = Place::new();
    let input = path.display();
    let line = format!("replay {input} --tilt none --frames 180 -o turns.mcap --json");
    let report = json(&place.run(&line));
    let bytes = std::fs::read(place.path("turns.mcap")).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let stats = summary.stats.unwrap();
    let count = |topic: &str| {
        let channel = summary.channels.values().find(|c| c.topic == topic);
        stats.channel_message_counts[&channel.unwrap().id]
    };
    assert_eq!(report["clouds"], count("/velomotion/points"));
    assert!(report["clouds"].as_u64() > Some(3), "{report}");
    assert_eq!(count("/diagnostics"), 1);
}

/// The file header of a classic pcap and its records.
fn records(pcap: &[u8]) -> (Vec<u8>, Vec<Vec<u8>>) {
    let (head, mut rest) = pcap.split_at(24);
    let mut records = Vec::new();
    while rest.len() >= 16 {
        let len = u32::from_le_bytes(rest[8..12].try_into().unwrap()) as usize;
        let (record, after) = rest.split_at(16 + len);
        records.push(record.to_vec());
        rest = after;
    }
    (head.to_vec(), records)
}

/// Writes `recording` with its records changed.
fn changed(place: &Place, recording: &Path, change: impl FnOnce(&mut Vec<Vec<u8>>)) -> PathBuf {
    let (head, mut records) = records(&std::fs::read(recording).unwrap());
    change(&mut records);
    let path = place.path("changed.pcap");
    std::fs::write(&path, [head, records.concat()].concat()).unwrap();
    path
}

/// Where the UDP payload of an Ethernet record begins.
const PAYLOAD: usize = 16 + 42;

#[test]
fn a_stray_datagram_in_front_is_not_taken_for_the_lidar() {
    let Some(path) = recording("vlp16-strongest-gps.pcap") else {
        return;
    };
    let place = Place::new();
    let input = changed(&place, &path, |records| {
        let data = records.iter().find(|r| r.len() == PAYLOAD + 1206).unwrap();
        let mut stray = data[..PAYLOAD + 40].to_vec();
        stray[8] = 82;
        stray[9] = 0;
        stray[12] = 82;
        stray[13] = 0;
        // IP total length, UDP length, the last byte of the sender's address.
        stray[16 + 16..16 + 18].copy_from_slice(&68_u16.to_be_bytes());
        stray[16 + 38..16 + 40].copy_from_slice(&48_u16.to_be_bytes());
        stray[16 + 29] ^= 1;
        records.insert(0, stray);
    });
    let line = format!("replay {} --tilt none -o cloud.ply --json", input.display());
    assert_eq!(json(&place.run(&line))["points"], 73_486);
    let found = json(&place.run(&format!("info {} --json", input.display())));
    assert_eq!(found["returns"], 73_486);
    assert_eq!(found["packets"]["malformed"], 1);
}

#[test]
fn position_packets_in_front_of_the_data_count() {
    let Some(path) = recording("vlp16-strongest-gps.pcap") else {
        return;
    };
    let place = Place::new();
    let is_position = |record: &Vec<u8>| record.len() == PAYLOAD + 512;
    let input = changed(&place, &path, |records| {
        let at = records.iter().position(is_position).unwrap();
        let position = records.remove(at);
        records.insert(0, position);
    });
    let found = json(&place.run(&format!("info {} --json", input.display())));
    assert_eq!(found["packets"]["position"], 57);
    assert_eq!(found["returns"], 73_486);
    let input = changed(&place, &path, |records| records.retain(is_position));
    let found = json(&place.run(&format!("info {} --json", input.display())));
    assert_eq!(found["packets"]["position"], 57);
}

#[test]
fn packets_out_of_order_cost_no_utc() {
    let Some(path) = recording("vlp16-strongest-gps.pcap") else {
        return;
    };
    let place = Place::new();
    let points = |input: &Path| {
        let options = "--tilt none --time utc -o cloud.ply --force --json";
        let line = format!("replay {} {options}", input.display());
        json(&place.run(&line))["points"].as_u64().unwrap()
    };
    let all = points(&path);
    let input = changed(&place, &path, |records| {
        for at in [100, 150, 200, 250] {
            records.swap(at, at + 1);
        }
    });
    assert_eq!(points(&input), all);
}

#[test]
fn dual_returns_say_which_they_are() {
    let Some(path) = recording("vlp16-dual.pcap") else {
        return;
    };
    let place = Place::new();
    for (more, counts) in [
        ("", [0, 0, 1_236, 57_413, 765]),
        ("--equal-returns twice", [0, 0, 1_236, 114_826, 765]),
    ] {
        let options = format!("--tilt none --echo --force -o cloud.csv {more}");
        assert!(
            place
                .run(&format!("replay {} {options}", path.display()))
                .status
                .success()
        );
        let text = std::fs::read_to_string(place.path("cloud.csv")).unwrap();
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        assert!(lines.next().unwrap().ends_with(",echo"));
        let mut seen = [0; 5];
        for line in lines {
            let code: usize = line.rsplit(',').next().unwrap().parse().unwrap();
            seen[code] += 1;
        }
        assert_eq!(seen, counts, "{more}");
    }
}

#[test]
fn rays_may_start_in_one_point() {
    let Some(path) = recording("vlp16-strongest-gps.pcap") else {
        return;
    };
    let place = Place::new();
    let line = format!(
        "replay {} --tilt none --one-origin -o cloud.csv",
        path.display()
    );
    assert!(place.run(&line).status.success());
    let text = std::fs::read_to_string(place.path("cloud.csv")).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    let z: f64 = rows
        .map(|row| row.split(',').nth(2).unwrap().parse::<f64>().unwrap())
        .sum();
    // The sum that independent decoders give.
    assert!((z / 3_310.884 - 1.0).abs() < 1e-4, "{z}");
}

#[test]
fn a_real_recording_becomes_a_cloud() {
    let Some(path) = recording("vlp16-strongest-gps.pcap") else {
        return;
    };
    let place = Place::new();
    let line = format!("replay {} --tilt none -o cloud.csv --json", path.display());
    let output = place.run(&line);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let scan = json(&output);
    assert_eq!(scan["points"], 73_486);
    assert_eq!(scan["packets"]["data"], 293);
    assert_eq!(scan["packets"]["position"], 57);
    assert_eq!(scan["lost_packets"], 0);
    assert_eq!(scan["simulated"], false);
    // A plain recording has no tilt of its own: that is said, not guessed.
    place.fails(
        &format!("replay {}", path.display()),
        3,
        &["no tilt", "--tilt none"],
    );
}

#[test]
fn another_rigs_angles_can_be_attached() {
    let Some(path) = recording("vlp16-strongest-gps.pcap") else {
        return;
    };
    let place = Place::new();
    std::fs::write(
        place.path("angles.csv"),
        "time_s,angle_deg\n0.0,-10\n0.2,-20\n",
    )
    .unwrap();
    let line = format!(
        "replay {} --tilt angles.csv -o cloud.ply --json",
        path.display()
    );
    let output = place.run(&line);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let scan = json(&output);
    let points = scan["points"].as_u64().unwrap();
    let left_out = scan["left_out"].as_u64().unwrap();
    // 0.2 s of 0.389 s: never beyond the angles that are known.
    assert_eq!(points + left_out, 73_486);
    assert!((30_000..45_000).contains(&points), "{points}");
    std::fs::write(
        place.path("late.csv"),
        "time_s,angle_deg\n2e9,-10\n2.1e9,-20\n",
    )
    .unwrap();
    place.fails(
        &format!("replay {} --tilt late.csv", path.display()),
        3,
        &["do not overlap"],
    );
    std::fs::write(place.path("bad.csv"), "time_s,angle_deg\n0.0,x\n").unwrap();
    place.fails(
        &format!("replay {} --tilt bad.csv", path.display()),
        3,
        &["bad.csv", "line 2"],
    );
}

/// Every study in a quick look: one JSON object, the same beside the page and its figures, and nothing overwritten unasked.
#[test]
fn what_accuracy_costs_is_measured_and_shown() {
    let place = Place::new();
    let output = place.run("tradeoff --quick --json --report out --markdown book");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let report = json(&output);
    assert_eq!(
        (&report["schema"], &report["effort"]),
        (&1.into(), &"quick".into())
    );
    for key in ["cpu", "cores", "os", "build"] {
        assert!(!report["machine"][key].is_null(), "{key}");
    }
    let studies = report["studies"].as_array().unwrap();
    let names: Vec<&str> = studies
        .iter()
        .map(|s| s["name"].as_str().unwrap())
        .collect();
    for name in [
        "granularity",
        "trigonometry",
        "clocks",
        "formats",
        "beam-sampling",
        "precision",
        "bvh-quality",
        "k-function",
        "scan-speed",
    ] {
        assert!(names.contains(&name), "{names:?}");
    }
    for study in studies {
        study_is_whole(study);
        assert!(said.contains(study["title"].as_str().unwrap()), "{said}");
    }
    let file = |name: &str| std::fs::read_to_string(place.path(name)).unwrap();
    assert_eq!(
        serde_json::from_str::<serde_json::Value>(&file("out/tradeoff.json")).unwrap(),
        report
    );
    let (html, page) = (file("out/index.html"), file("book/tradeoff.md"));
    for name in names {
        let figure = file(&format!("out/{name}.svg"));
        assert!(
            figure.starts_with("<svg") && html.contains(&figure),
            "{name}"
        );
        assert_eq!(file(&format!("book/tradeoff/{name}.svg")), figure);
        assert!(page.contains(&format!("(tradeoff/{name}.svg)")), "{name}");
    }
    place.fails(
        "tradeoff --quick --report out",
        2,
        &["index.html", "--force"],
    );
    place.fails("tradeoff --only nonsense", 2, &["nonsense", "scan-speed"]);

    // What is computed comes out the same again, and as text it fits a terminal.
    let again = place.run("tradeoff --quick --only scan-speed,formats --json");
    let again = json(&again);
    assert_eq!(Some(&again["studies"][1]), studies.last());
    assert_eq!(again["studies"].as_array().unwrap().len(), 2);
    let text = place.run("tradeoff --quick --only scan-speed");
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(
        text.contains("56.25 deg/s") && text.contains("A quick look"),
        "{text}"
    );
    assert!(
        text.lines().all(|line| line.chars().count() <= 80),
        "{text}"
    );
}

/// Every row has every column, spreads are in order, and fronts are of its rows.
fn study_is_whole(study: &serde_json::Value) {
    let rows = study["rows"].as_array().unwrap();
    let columns = study["columns"].as_array().unwrap();
    assert!(rows.len() > 3 && columns.len() > 1, "{study}");
    for row in rows {
        let values = row["values"].as_object().unwrap();
        assert_eq!(values.len(), columns.len(), "{row}");
        for column in columns {
            let value = &values[column["key"].as_str().unwrap()];
            let of = |name: &str| value[name].as_f64().unwrap();
            if value.is_object() {
                assert!(
                    0.0 < of("min") && of("min") <= of("median") && of("median") <= of("max"),
                    "{row}"
                );
                assert!(value["runs"].as_u64().unwrap() > 1, "{row}");
            } else {
                assert!(value.as_f64().unwrap() >= 0.0, "{row}");
            }
        }
    }
    for trade in study["trades"].as_array().unwrap() {
        let front = trade["front"].as_array().unwrap();
        assert!(!front.is_empty(), "{trade}");
        assert!(
            front
                .iter()
                .all(|name| rows.iter().any(|row| row["name"] == *name)),
            "{trade}"
        );
    }
}

#[test]
fn simulate_makes_a_log_that_replay_reads_and_says_what_is_wrong_where() {
    let place = Place::new();
    place.fails("simulate castle", 3, &["scene castle", "hall"]);
    let scene = "scene = \"hall\"\n[motion]\nkind = \"fixed\"\nduration_s = 0.05\n";
    std::fs::write(
        place.path("wrong.toml"),
        format!("{scene}[effects]\nrange_nois = 1\n"),
    )
    .unwrap();
    place.fails(
        "simulate wrong.toml",
        3,
        &["wrong.toml, line 6", "range_nois"],
    );
    std::fs::write(place.path("stand.toml"), scene).unwrap();
    place.fails("simulate stand.toml --truth t.xyz", 2, &["t.xyz", ".ply"]);
    place.fails("simulate stand.toml --truth - --json", 2, &["stdout"]);
    let output = place.run("simulate stand.toml --truth t.csv --json --threads 2");
    assert!(output.status.success(), "{output:?}");
    let said = json(&output);
    assert_eq!(said["packets"], 37);
    assert_eq!(said["share_returned"], 1.0);
    assert_eq!(said["effects"].as_array().unwrap().len(), 0);
    assert_eq!(said["log"], "stand.pcapng");
    let truth = std::fs::read_to_string(place.path("t.csv")).unwrap();
    assert!(truth.contains("SIMULATED"), "{:?}", truth.lines().next());
    let rows = truth.lines().filter(|line| !line.starts_with('#')).count() - 1;
    assert_eq!(said["returned"].as_u64(), Some(rows as u64));
    place.fails("simulate stand.toml", 2, &["exists"]);
    let over = "simulate stand.toml -o stand.toml --force";
    place.fails(over, 2, &["stand.toml", "made of"]);
    // The lidar alone, for programs that read one type of link a file.
    let output = place.run("simulate rig -o rig.pcap --json");
    let (made, told) = (json(&output), json(&place.run("info rig.pcap --json")));
    assert_eq!(told["packets"]["data"], made["packets"]);
    assert_eq!(
        (&told["packets"]["other"], &told["returns"]),
        (&0.into(), &made["returns"])
    );
    let asks = format!("{scene}[effects.tilt_limits]\nfrom_deg = -45.0\nto_deg = 45.0\n");
    std::fs::write(place.path("asks.toml"), asks).unwrap();
    let output = place.run("simulate asks.toml --explain --json");
    let told = &json(&output)["explanation"]["on"][0];
    assert_eq!(told["effect"], "tilt_limits");
    assert_eq!((&told["line"], &told["acted"]), (&5.into(), &0.into()));
    assert!(told["not_needed"].as_str().unwrap().contains("stops"));
    let output = place.run("simulate asks.toml --without all --force --json");
    assert_eq!(json(&output)["effects"].as_array().unwrap().len(), 0);
    let output = place.run("simulate asks.toml --without weather,loss --force --json");
    assert_eq!(json(&output)["effects"].as_array().unwrap().len(), 1);
    let unknown = place.run("simulate asks.toml --without fog");
    assert_eq!(unknown.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&unknown.stderr).contains("weather"));
    let output = place.run("replay stand.pcapng --tilt none -o s.ply --json");
    assert_eq!(json(&output)["points"].as_u64(), Some(rows as u64));
    assert_eq!(json(&output)["simulated"], true);
}

/// The `density` that `analyze --json` gives of one input.
fn density(place: &Place, line: &str) -> serde_json::Value {
    let output = place.run(line);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let report = json(&output);
    assert_eq!(report["patterns"].as_array().unwrap().len(), 1, "{report}");
    report["patterns"][0]["density"].clone()
}

#[test]
fn analyze_says_what_the_contract_says() {
    let place = Place::new();
    let output = place.run("analyze vlp16 rmbl:1200,step=2 --json");
    let report = json(&output);
    let patterns = report["patterns"].as_array().unwrap();
    assert_eq!(patterns.len(), 2);
    let (vlp16, rmbl) = (&patterns[0], &patterns[1]);
    assert_eq!(
        (
            vlp16["name"].as_str(),
            vlp16["points"].as_u64(),
            vlp16["frames"].as_u64()
        ),
        (Some("vlp16"), Some(14_416), Some(1))
    );
    assert_eq!(
        (rmbl["points"].as_u64(), rmbl["frames"].as_u64()),
        (Some(3 * 16 * 181), Some(3))
    );
    let density = &vlp16["density"];
    assert_eq!(density["bins"], 5_120);
    assert_eq!(density["mean"].as_f64(), Some(14_416.0 / 5_120.0));
    for key in [
        "sd",
        "min",
        "max",
        "mean_per_deg2",
        "sd_per_deg2",
        "histogram",
    ] {
        assert!(!density[key].is_null(), "{key}: {density}");
    }
    assert!(
        (vlp16["hole"]["radius_deg"].as_f64().unwrap() - 75.0).abs() < 1e-4,
        "{vlp16}"
    );
    assert!(
        vlp16["device"].is_null() && rmbl["device"]["range_m"].is_array(),
        "{report}"
    );
    let text = place.run("analyze vlp16 rmbl:1200,step=2,d=0.06");
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(
        text.contains("14416") && text.contains("largest hole: 75.00 deg"),
        "{text}"
    );
    assert!(
        text.lines().all(|line| line.chars().count() <= 80),
        "{text}"
    );
}

#[test]
fn a_pattern_its_clouds_and_its_log_are_analysed_alike() {
    let place = Place::new();
    let pattern = sim::patterns::Wish::parse("velomotion16:500,step=0.8")
        .unwrap()
        .build()
        .unwrap();
    let rows = pattern
        .directions()
        .into_iter()
        .map(|d| format!("{},{},{}\n", 7.0 * d.x, 7.0 * d.y, 7.0 * d.z));
    let text: String = std::iter::once("x_m,y_m,z_m\n".to_owned())
        .chain(rows)
        .collect();
    std::fs::write(place.path("cloud.csv"), text).unwrap();
    let [named, cloud] = ["velomotion16:500,step=0.8", "cloud.csv"]
        .map(|input| density(&place, &format!("analyze {input} --json")));
    assert_eq!(named["mean"], cloud["mean"]);
    // Rounding may move what lies between two bins.
    assert!(
        (named["sd"].as_f64().unwrap() - cloud["sd"].as_f64().unwrap()).abs() < 0.01,
        "{named} {cloud}"
    );
    // The sphere of the simulator: two turns of a level VLP-16, as a log.
    let scene = "[sensor]\nideal = true\nrpm = 1200\n[motion]\nkind = \"fixed\"\nduration_s = 0.1\n[[objects]]\nsphere = { radius_m = 10 }\n";
    std::fs::write(place.path("level.toml"), scene).unwrap();
    assert!(
        place
            .run("simulate level.toml -o level.pcapng")
            .status
            .success()
    );
    let log = place.run("analyze level.pcapng --json");
    let log = json(&log)["patterns"][0].clone();
    let level = density(&place, "analyze vlp16,frames=2 --json");
    assert_eq!(log["frames"], 2, "{log}");
    let [found, expected] = [&log["density"], &level].map(|d| d["mean"].as_f64().unwrap());
    assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
    assert!(
        (log["hole"]["radius_deg"].as_f64().unwrap() - 75.0).abs() < 0.1,
        "{log}"
    );
}

/// A page, figures, tables and JSON of two scans side by side; nothing overwritten unasked.
#[test]
fn analyze_writes_a_report_that_stands_alone() {
    let place = Place::new();
    let line =
        "analyze vlp16,step=2 rmbl:1200,step=2 --level 2 --bins 30 --report out/report --json";
    let output = place.run(line);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    let report = json(&output);
    let file = |name: &str| {
        assert!(said.contains(name), "{name} in:\n{said}");
        std::fs::read_to_string(place.path("out/report").join(name)).unwrap()
    };
    let written: serde_json::Value = serde_json::from_str(&file("analyze.json")).unwrap();
    assert_eq!(written, report);
    let page = file("index.html");
    for name in ["density.svg", "histogram.svg", "planes.svg", "k.svg"] {
        let figure = file(name);
        assert!(
            figure.starts_with("<svg") && page.contains(&figure),
            "{name}"
        );
    }
    // What is in the tables is what the JSON says.
    let (k, density) = (file("k.csv"), file("density.csv"));
    let d = k.lines().skip(1).map(|line| {
        let fields = line.rsplit(',');
        fields.skip(2).take(1).collect::<String>()
    });
    let d: Vec<f64> = d.map(|d| d.parse().unwrap()).collect();
    let curves = report["patterns"].as_array().unwrap().iter();
    let curves: Vec<f64> = curves
        .flat_map(|pattern| pattern["k"]["k_minus_csr"].as_array().unwrap())
        .map(|d| d.as_f64().unwrap())
        .collect();
    assert_eq!((d.len(), curves.len()), (60, 60));
    // JSON is read back within the last digit.
    for (table, json) in d.iter().zip(&curves) {
        assert!((table - json).abs() < 1e-15, "{table} {json}");
    }
    let points = |name: &str| -> u64 {
        let lines = density.lines().filter(|line| line.starts_with(name));
        lines
            .map(|line| line.rsplit(',').next().unwrap().parse::<u64>().unwrap())
            .sum()
    };
    for (pattern, name) in report["patterns"]
        .as_array()
        .unwrap()
        .iter()
        .zip(["\"vlp16", "\"rmbl"])
    {
        assert_eq!(pattern["points"], points(name), "{name}");
    }
    assert_eq!(
        file("histogram.csv").lines().next(),
        Some("pattern,from,to,bins")
    );

    place.fails(
        line,
        2,
        &["out/report exists already and is not empty", "--force"],
    );
    let again = place.run(&format!("{line} --force"));
    assert!(again.status.success());
    assert_eq!(file("index.html"), page);
    place.fails(
        "analyze vlp16 --report velomotion.toml",
        2,
        &["velomotion.toml exists already"],
    );
    let both = place.run("analyze rmbl:50 --sweep rpm=300..600 --report page");
    assert_eq!(both.status.code(), Some(2));
    let said = String::from_utf8_lossy(&both.stderr);
    assert!(said.contains("cannot be used with"), "{said}");
    let alone = place.run("analyze vlp16 --force");
    assert_eq!(alone.status.code(), Some(2));
}

#[test]
fn what_cannot_be_analysed_is_said() {
    let place = Place::new();
    std::fs::write(place.path("none.csv"), "x,y,z\n").unwrap();
    std::fs::write(place.path("nan.csv"), "x,y,z\n1,2,3\n4,nan,6\n").unwrap();
    std::fs::write(place.path("spoilt.ply"), "ply\nwhat\n").unwrap();
    for (line, code, words) in [
        ("analyze", 2, "PATTERN|CLOUD|LOG"),
        ("analyze rmbl", 2, "a speed above 0 deg/s"),
        ("analyze vlp16:50", 2, "a sensor that stands still"),
        ("analyze nosuch", 3, "there is no pattern and no file"),
        ("analyze none.csv", 3, "no point that has a direction"),
        ("analyze nan.csv", 3, "point 1 is at (4, NaN, 6)"),
        (
            "analyze spoilt.ply",
            3,
            "ply: byte 4: expected a line of a PLY header",
        ),
        ("analyze velomotion.toml", 3, "velomotion.toml"),
        ("analyze vlp16 --tolerance 1", 2, "expected a share from 0"),
        ("analyze vlp16 --bins 0", 2, "0 is not in 1..="),
        ("analyze vlp16 --level 9", 2, "9 is not in 0..=8"),
        (
            "analyze vlp16 rmbl:50 --sweep rpm=300..600",
            2,
            "settings of one pattern, not of 2",
        ),
        (
            "analyze velomotion16 --sweep speed",
            2,
            "expected KEY=FROM..TO",
        ),
        (
            "analyze velomotion16 --sweep colour=1..2",
            2,
            "expected rpm, step, start",
        ),
        (
            "analyze velomotion16 --sweep rpm=300..600",
            2,
            "a speed above 0 deg/s",
        ),
    ] {
        let output = place.run(line);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{line}:\n{said}");
        let flat = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(flat.contains(words), "{line}: no {words:?} in:\n{said}");
    }
}

#[test]
fn a_sweep_says_which_settings_nothing_beats() {
    let place = Place::new();
    let output = place.run("analyze velomotion16,step=2 --sweep speed=100..400/3,tilt=1..2 --json");
    assert_eq!(output.status.code(), Some(2), "tilt is no number");
    let output =
        place.run("analyze velomotion16,step=2 --sweep speed=100..400/3,rpm=600..1200/2 --json");
    let report = json(&output);
    assert_eq!(report["keys"], serde_json::json!(["speed", "rpm"]));
    let settings = report["settings"].as_array().unwrap();
    assert_eq!(settings.len(), 6);
    let number = |setting: &serde_json::Value, key: &str| setting[key].as_f64().unwrap();
    for (best, of) in [
        ("best_hole", "hole_deg"),
        ("best_gap", "gap_deg"),
        ("best_evenness", "unevenness"),
    ] {
        for setting in settings {
            let beaten = settings.iter().any(|other| {
                number(other, "scan_s") <= number(setting, "scan_s")
                    && number(other, of) < number(setting, of) - 0.01
            });
            assert!(!(beaten && setting[best] == true), "{best}: {setting}");
        }
        assert!(
            settings.iter().any(|setting| setting[best] == true),
            "{best}"
        );
    }
    let text = place.run("analyze velomotion16,step=2 --sweep speed=100..400/3,rpm=600..1200/2");
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(
        text.contains("* no other setting") && text.lines().all(|line| line.chars().count() <= 80),
        "{text}"
    );
}
