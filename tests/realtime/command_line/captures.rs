//! Captures: logs, clouds, signals, refusals.

use std::io::Write;
use std::os::unix::fs::OpenOptionsExt;
use std::process::{Child, Stdio};

use io::port::Pty;

use super::*;

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
    // The advice is to do what works: so early in the log there is no sweep.
    std::fs::write(place.path("begun.pcapng"), &log[..20_000]).unwrap();
    let advice = "replay --tilt none makes a cloud";
    place.fails("info begun.pcapng", 6, &["is incomplete", advice]);
    let cut = ["the file is incomplete", "copy it from its source"];
    place.fails("replay begun.pcapng", 3, &cut);
    let mut view = Command::new(env!("CARGO_BIN_EXE_velomotion"))
        .args(["view", "--no-open", "cut.pcapng"])
        .current_dir(place.0.path())
        .env("XDG_CONFIG_HOME", place.0.path())
        .env_remove("RUST_LOG")
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let printed = std::io::BufReader::new(view.stderr.take().unwrap());
    let (send, reported) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        let mut lines = std::io::BufRead::lines(printed).map_while(Result::ok);
        let _ = send.send(lines.find(|line| line.contains("cut.pcapng: the log is incomplete")));
    });
    let reported = reported.recv_timeout(std::time::Duration::from_secs(60));
    // It serves its page until Ctrl-C.
    assert!(view.try_wait().unwrap().is_none(), "view ended by itself");
    let kill = Command::new("kill")
        .args(["-INT", &view.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
    assert_eq!(view.wait().unwrap().code(), Some(0));
    assert!(
        matches!(reported, Ok(Some(_))),
        "view says nothing of the cut"
    );
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

/// What stdout and stderr are. Neither is read, and both are full.
#[derive(Clone, Copy)]
enum Unread {
    /// Pipes, such as those to a program that hangs.
    Pipes,
    /// A terminal, as after Ctrl-S or at the end of a dead connection. The progress is drawn on it.
    Terminal,
}

/// A command whose output no program reads, and the terminal that is its output.
fn with_unread_output(place: &Place, line: &str, output: Unread) -> (Child, Option<Pty>) {
    // A pipe of Linux holds 64 KiB (pipe(7)).
    let fill = match output {
        Unread::Pipes => "head -c 65536 /dev/zero; head -c 65536 /dev/zero >&2; ",
        Unread::Terminal => "",
    };
    let script = format!("{fill}exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command
        .args(["-c", &script, env!("CARGO_BIN_EXE_velomotion")])
        .args(line.split_whitespace())
        .current_dir(place.0.path())
        .env("XDG_CONFIG_HOME", place.0.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let terminal = matches!(output, Unread::Terminal).then(|| {
        let terminal = Pty::open().unwrap();
        let mut options = std::fs::OpenOptions::new();
        options.read(true).write(true);
        command
            .stdout(options.open(terminal.path()).unwrap())
            .stderr(options.open(terminal.path()).unwrap());
        // O_NONBLOCK of Linux.
        let mut filling = options.custom_flags(0o4000).open(terminal.path()).unwrap();
        let full = std::iter::repeat_with(|| filling.write(b" ")).find_map(Result::err);
        assert_eq!(full.unwrap().kind(), std::io::ErrorKind::WouldBlock);
        terminal
    });
    (command.spawn().unwrap(), terminal)
}

fn send(signal: &str, process: &Child) {
    let mut kill = Command::new("kill");
    kill.args([signal, &process.id().to_string()]);
    assert!(kill.status().unwrap().success());
}

#[test]
fn a_capture_ends_as_planned_though_no_program_reads_its_output() {
    for output in [Unread::Pipes, Unread::Terminal] {
        let place = Place::new();
        let line = "capture --speed 56.25 -o scan.ply -vv";
        let (mut capture, _terminal) = with_unread_output(&place, line, output);
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
}

/// Ctrl-Z stops the axis, too: a suspended process could not.
#[test]
fn signals_stop_a_sweep_though_no_program_reads_the_output() {
    stops_a_sweep("-TERM", Unread::Pipes);
    stops_a_sweep("-TSTP", Unread::Terminal);
}

fn stops_a_sweep(signal: &str, output: Unread) {
    let place = Place::new();
    let line = "capture --speed 2 -o scan.ply -vv";
    let (mut capture, _terminal) = with_unread_output(&place, line, output);
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
    // The log is well formed, but its sweep is cut short.
    for quiet in ["", " -q"] {
        let replayed = place.run(&format!("replay scan.pcapng -o part.ply --force{quiet}"));
        let printed = String::from_utf8_lossy(&replayed.stderr).into_owned();
        assert_eq!(replayed.status.code(), Some(6), "{printed}");
        assert!(printed.contains("sweep 1 was cut short at -"), "{printed}");
    }
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
        &["a.ply cannot be both the cloud and its recording"],
    );
    place.fails("capture --speed 10 -o - --json", 2, &["stdout"]);
    place.fails(
        "capture --speed 10 --log -",
        2,
        &["a log must be a file", "--log"],
    );
    place.fails("capture --speed 10 -o cloud.xyzzy", 2, &[".xyzzy", ".laz"]);
    place.fails(
        "capture --speed 1e300",
        2,
        &["error:", "'1e300'", "--speed"],
    );
    place.fails("capture --speed 10 --log x.pcap", 2, &["x.pcap", ".pcapng"]);
}

#[test]
fn info_of_a_capture_names_file_start_sweeps_and_configuration() {
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
