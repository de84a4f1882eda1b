//! The program's interface to other programs: exit codes, messages, JSON, and no overwriting
//! without `--force`.

mod analyze;
mod frames;
mod packets;
mod schemas;
mod tradeoff;

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

    /// Runs a command that must fail with `code` and print each of `words` on stderr.
    fn fails(&self, line: &str, code: i32, words: &[&str]) {
        let before = self.files();
        let output = self.run(line);
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{line}:\n{printed}");
        let flat = printed.split_whitespace().collect::<Vec<_>>().join(" ");
        for word in words {
            assert!(flat.contains(word), "{line}: no {word:?} in:\n{printed}");
        }
        assert!(
            printed.contains("help:"),
            "{line}: no next step in:\n{printed}"
        );
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

#[test]
fn a_simulated_capture_gives_a_log_that_reproduces_its_cloud() {
    let place = Place::new();
    let output = place.run("capture --speed 56.25 -o scan.ply --json");
    let printed = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{printed}");
    let scan = json(&output);
    assert_eq!(scan["simulated"], true);
    assert!(scan["points"].as_u64().unwrap() > 180_000, "{scan}");
    assert_eq!(scan["sweeps"].as_array().unwrap().len(), 1);
    let cruise = scan["sweeps"][0]["cruise_deg_s"].as_f64().unwrap();
    assert!((cruise.abs() - 56.25).abs() < 0.5, "{scan}");
    // On a busy machine polls may stall: the bound is wider then. The hall's far corners are 20 m
    // away.
    let of = |name: &str| scan["truth"][name].as_f64().unwrap();
    let bound_deg = scan["sync"]["angle_bound_deg"].as_f64().unwrap();
    let bound_m = 20.0 * bound_deg.to_radians();
    assert!(
        of("rms_m") < 10e-3 + bound_m && of("worst_m") < 0.1 + bound_m,
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

    // `sd` is the last column of a row. Its least value is the range's step.
    let with_sd = place.run("replay scan.pcapng -o sd.csv --uncertainty");
    assert!(with_sd.status.success());
    let text = std::fs::read_to_string(place.path("sd.csv")).unwrap();
    let mut lines = text.lines().skip_while(|line| line.starts_with('#'));
    assert!(lines.next().unwrap().ends_with(",tilt_deg,sd_m"));
    let sds = lines.map(|line| line.rsplit(',').next().unwrap().parse::<f64>().unwrap());
    let least = sds.fold(f64::INFINITY, f64::min);
    assert!((0.000_57..0.000_8).contains(&least), "{least}");
    std::fs::remove_file(place.path("sd.csv")).unwrap();

    // The log reads as a plain lidar recording, too, and names its device.
    let info = place.run("info scan.pcapng --json");
    assert!(json(&info)["tilt"]["samples"].as_u64().unwrap() > 100);
    // `-q` keeps the result.
    let quiet = place.run("info scan.pcapng -q").stdout;
    assert!(!quiet.is_empty() && quiet == place.run("info scan.pcapng").stdout);
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

/// A truncated log gives its points and reports where it ends.
fn cut_off(place: &Place) {
    let log = std::fs::read(place.path("scan.pcapng")).unwrap();
    std::fs::write(place.path("cut.pcapng"), &log[..log.len() * 2 / 3 + 5]).unwrap();
    let output = place.run("replay cut.pcapng --tilt none -o cut.ply --json");
    assert_eq!(output.status.code(), Some(6));
    assert!(json(&output)["truncated"].is_string());
    assert!(json(&output)["points"].as_u64().unwrap() > 100_000);
}

#[test]
fn ctrl_c_in_mid_sweep_saves_the_partial_cloud_and_exits_130() {
    let place = Place::new();
    let mut capture = Command::new(env!("CARGO_BIN_EXE_velomotion"))
        .args("capture --speed 5 -o scan.ply -vv".split(' '))
        .current_dir(place.0.path())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // Homing is not a profile move: the first profile move is the sweep.
    let mut printed = std::io::BufReader::new(capture.stderr.take().unwrap());
    let mut line = String::new();
    while !line.contains("Moving(") {
        line.clear();
        assert!(
            std::io::BufRead::read_line(&mut printed, &mut line).unwrap() > 0,
            "no motion"
        );
    }
    let rest = std::thread::spawn(move || {
        let mut text = String::new();
        std::io::Read::read_to_string(&mut printed, &mut text).map(|_| text)
    });
    let kill = Command::new("kill")
        .args(["-INT", &capture.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
    assert_eq!(capture.wait().unwrap().code(), Some(130));
    let printed = rest.join().unwrap().unwrap();
    assert!(printed.contains("stopped by the user"), "{printed}");
    assert!(place.path("scan.pcapng").is_file(), "the log is gone");
}

/// A command whose stdout and stderr are full pipes that no program reads, such as a terminal after
/// Ctrl-S or at the end of a dead connection.
fn with_unread_output(place: &Place, line: &str) -> std::process::Child {
    // A pipe of Linux holds 64 KiB (pipe(7)).
    let script = "head -c 65536 /dev/zero; head -c 65536 /dev/zero >&2; exec \"$0\" \"$@\"";
    Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_velomotion")])
        .args(line.split_whitespace())
        .current_dir(place.0.path())
        .env("XDG_CONFIG_HOME", place.0.path())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap()
}

fn send(signal: &str, process: &std::process::Child) {
    let mut kill = Command::new("kill");
    kill.args([signal, &process.id().to_string()]);
    assert!(kill.status().unwrap().success());
}

#[test]
fn a_capture_ends_as_planned_though_no_program_reads_its_output() {
    let place = Place::new();
    let mut capture = with_unread_output(&place, "capture --speed 56.25 -o scan.ply -vv");
    crate::daemon::rig::wait("the cloud", || {
        assert_eq!(
            capture.try_wait().unwrap(),
            None,
            "the result has no reader"
        );
        place.path("scan.ply").is_file().then_some(())
    });
    // The devices are closed: a signal ends the process.
    send("-TERM", &capture);
    assert!(capture.wait().unwrap().code().is_some());
    assert!(place.run("info scan.pcapng").status.success());
}

/// Ctrl-Z stops the axis, too: a suspended process could not.
#[test]
fn signals_stop_a_sweep_though_no_program_reads_the_output() {
    for signal in ["-TERM", "-TSTP"] {
        stops_a_sweep(signal);
    }
}

fn stops_a_sweep(signal: &str) {
    let place = Place::new();
    let mut capture = with_unread_output(&place, "capture --speed 2 -o scan.ply -vv");
    // The log grows by several records per millisecond once the axis is sampled.
    crate::daemon::rig::wait("the log of a sweep", || {
        let log = std::fs::metadata(place.path("scan.pcapng")).ok()?;
        (log.len() > 3_000_000).then_some(())
    });
    send(signal, &capture);
    assert_eq!(capture.wait().unwrap().code(), Some(130));
    assert!(
        place.path("scan.ply").is_file(),
        "the cloud of the part is gone"
    );
}

#[test]
fn invalid_speeds_and_angles_are_refused_before_anything_moves() {
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
        &["recording a.ply"],
    );
    place.fails("capture --speed 10 -o - --json", 2, &["stdout"]);
    place.fails(
        "capture --speed 10 --log -",
        2,
        &["a log must be a file", "--log"],
    );
    place.fails("capture --speed 10 -o cloud.xyzzy", 2, &[".xyzzy", ".laz"]);
}

#[test]
fn missing_devices_are_named() {
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
    for command in [
        "capture --speed 10",
        "replay log.pcapng",
        "info log.pcapng",
        "simulate hall",
        "plan",
        "analyze vlp16",
        "tradeoff",
        "tilt status",
        "tilt stop",
        "daemon",
        "doctor",
        "firmware-sim --usb",
        "help",
    ] {
        place.fails(&format!("{command} --config none.toml"), 3, &["none.toml"]);
    }
    std::fs::write(place.path("typo.toml"), "[axis]\nmin_degg = 1\n").unwrap();
    place.fails(
        "capture --speed 10 --config typo.toml",
        3,
        &["min_degg", "line 2"],
    );
}

#[test]
fn files_other_than_recordings_are_refused() {
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

/// A classic pcap with one Ethernet frame of another protocol (ARP).
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

/// A cut of a real recording.
fn recording(name: &str) -> PathBuf {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/recordings");
    Path::new(folder).join(name).canonicalize().unwrap()
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
fn ros_recordings_are_bags_and_keep_the_metadata_of_others() {
    let path = recording("vlp16-strongest-gps.pcap");
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
    let printed = String::from_utf8_lossy(&output.stderr);
    assert!(
        printed.contains("belongs to another recording"),
        "{printed}"
    );
}

#[test]
fn a_real_recording_becomes_a_cloud() {
    let path = recording("vlp16-strongest-gps.pcap");
    let place = Place::new();
    let line = format!("replay {} --tilt none -o cloud.csv --json", path.display());
    let output = place.run(&line);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let scan = json(&output);
    assert_eq!(scan["points"], 7_747);
    assert_eq!(scan["packets"]["data"], 26);
    assert_eq!(scan["packets"]["position"], 5);
    assert_eq!(scan["lost_packets"], 0);
    assert_eq!(scan["simulated"], false);
    // A plain recording has no tilt: an error, not a guess.
    place.fails(
        &format!("replay {}", path.display()),
        3,
        &["no tilt", "--tilt none"],
    );
}

/// A calling program learns of lost packets by its exit code, with `-q` too.
#[test]
fn a_recording_with_missing_packets_is_incomplete() {
    let whole = std::fs::read(recording("vlp16-strongest-gps.pcap")).unwrap();
    // Records of a pcap: 16 bytes of times and lengths, then the packet; 24 bytes of file header.
    let mut at = 24;
    let mut ends = Vec::new();
    while at < whole.len() {
        let length = u32::from_le_bytes(whole[at + 8..at + 12].try_into().unwrap()) as usize;
        at += 16 + length;
        ends.push(at);
    }
    let place = Place::new();
    let cut = [&whole[..ends[9]], &whole[ends[12]..]].concat();
    std::fs::write(place.path("cut.pcap"), cut).unwrap();
    for quiet in ["", " -q"] {
        let line = format!("replay cut.pcap --tilt none -o cloud.ply --force{quiet}");
        let output = place.run(&line);
        let printed = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(6), "{printed}");
        assert!(
            printed.contains("3 of 26 lidar packets are missing at 0.01"),
            "{printed}"
        );
        assert!(place.path("cloud.ply").is_file());
    }
}

#[test]
fn info_names_file_start_sensor_sweeps_configuration_and_position() {
    let place = Place::new();
    std::fs::write(
        place.path("rig.toml"),
        "device = \"sim\"\n[mount]\nd_m = 0.11\n",
    )
    .unwrap();
    let line = "capture --speed 90 --from 0 --to -5 --config rig.toml -o scan.ply --json";
    let scan = json(&place.run(line));
    let info = json(&place.run("info scan.pcapng --json"));
    assert_eq!(info["file"], "scan.pcapng");
    assert_eq!(info["configuration"]["mount"]["d_m"], 0.11);
    assert_eq!(info["sweeps"], scan["sweeps"]);
    assert_eq!(info["sweeps"].as_array().unwrap().len(), 1);
    let since_s = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .unwrap()
        .as_secs_f64()
        - info["start_s"].as_f64().unwrap();
    assert!((0.0..600.0).contains(&since_s), "{info}");

    let gps = recording("vlp16-strongest-gps.pcap");
    let info = json(&place.run(&format!("info {} --json", gps.display())));
    assert_eq!(info["configuration"], serde_json::Value::Null);
    assert_eq!(info["sweeps"], serde_json::json!([]));
    assert!(
        info["sensor"].as_str().unwrap().ends_with(":2368"),
        "{info}"
    );
    assert_eq!(info["gps"]["pps"], "locked");
    for (key, range) in [
        ("latitude_deg", -90.0..90.0),
        ("longitude_deg", -180.0..180.0),
    ] {
        let value = info["gps"]["position"][key].as_f64().unwrap();
        assert!(range.contains(&value) && value != 0.0, "{info}");
    }
}

#[test]
fn angles_of_another_device_can_be_attached() {
    let path = recording("vlp16-strongest-gps.pcap");
    let place = Place::new();
    std::fs::write(
        place.path("angles.csv"),
        "time_s,angle_deg\n0.0,-10\n0.02,-20\n",
    )
    .unwrap();
    // Where the lidar is above the axis is not known.
    let line = format!(
        "replay {} --tilt angles.csv -o cloud.ply --json",
        path.display()
    );
    let own = place.path("velomotion.toml");
    std::fs::rename(&own, place.path("other-name.toml")).unwrap();
    place.fails(&line, 2, &["--mount"]);
    std::fs::rename(place.path("other-name.toml"), &own).unwrap();
    // This configuration has no mount, and an empty one does not say where the lidar is either.
    place.fails(&line, 3, &["velomotion.toml: expected [mount] with d_m"]);
    std::fs::write(place.path("empty.toml"), "[mount]\n").unwrap();
    place.fails(&format!("{line} --mount empty.toml"), 3, &["d_m"]);
    std::fs::write(place.path("other.toml"), "[mount]\nd_m = 0.25\n").unwrap();
    let output = place.run(&format!("{line} --mount other.toml"));
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        printed.contains("mount of other.toml: the lidar is 0.25 m above"),
        "{printed}"
    );
    let scan = json(&output);
    assert_eq!(scan["sync"]["angle_bound_deg"], serde_json::Value::Null);
    assert!(!scan["warnings"].to_string().contains("drive"), "{scan}");
    place.fails(
        &format!("replay {} --tilt none --mount other.toml", path.display()),
        2,
        &["--mount", "--tilt none"],
    );
    // The configuration has a mount, too: the cloud is the same.
    let cloud = std::fs::read(place.path("cloud.ply")).unwrap();
    let again = place.run(&format!("{line} --config other.toml --force"));
    assert!(again.status.success());
    assert!(cloud == std::fs::read(place.path("cloud.ply")).unwrap());
    std::fs::write(place.path("low.toml"), "[mount]\nd_m = 0.05\n").unwrap();
    let lower = place.run(&format!(
        "{line} --mount low.toml --config other.toml --force"
    ));
    assert!(lower.status.success());
    assert!(cloud != std::fs::read(place.path("cloud.ply")).unwrap());
    let points = scan["points"].as_u64().unwrap();
    let left_out = scan["left_out"].as_u64().unwrap();
    // The table covers 0.02 s of 0.0345 s: only points within it are placed.
    assert_eq!(points + left_out, 7_747);
    assert!((3_500..5_500).contains(&points), "{points}");
    std::fs::write(
        place.path("late.csv"),
        "time_s,angle_deg\n2e9,-10\n2.1e9,-20\n",
    )
    .unwrap();
    place.fails(
        &format!("replay {} --tilt late.csv --mount low.toml", path.display()),
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

#[test]
fn simulate_writes_a_log_that_replay_reads_and_locates_errors() {
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
        (&5.into(), &0.into())
    );
    assert!(reported["not_needed"].as_str().unwrap().contains("stops"));
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
        "capture --speed 1e300",
        2,
        &["error:", "'1e300'", "--speed"],
    );
    place.fails("info log.pcapng --device sim", 2, &["error:", "--device"]);
    place.fails(
        "simulate hall -o hall.ply",
        2,
        &["hall.ply", ".pcapng or .pcap"],
    );
    place.fails("simulate hall --truth hall.xyzzy", 2, &[".xyzzy", ".laz"]);
    place.fails("capture --speed 10 --log x.pcap", 2, &["x.pcap", ".pcapng"]);
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
