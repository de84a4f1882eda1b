//! `velomotion tilt` with the simulated drive in its own process.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::UdpSocket;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// A simulated drive that runs until dropped, and a configuration that names it.
pub struct Bench {
    pub folder: tempfile::TempDir,
    drive: Child,
}

impl Bench {
    pub fn new(interface: &str) -> Self {
        Self::with(interface, &[], "")
    }

    /// A drive with more `options`, and an axis configured by the TOML text `axis`.
    pub fn with(interface: &str, options: &[&str], axis: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("epos");
        let config = format!(
            "{axis}\n[device]\ndefault = 'soft'\n[device.soft]\nkind = '{}'\nport = '{}'\n",
            interface.trim_start_matches('-'),
            link.display()
        );
        std::fs::write(folder.path().join("velomotion.toml"), config).unwrap();
        let mut drive = velomotion()
            .args(["firmware-sim", interface, "--link"])
            .arg(&link)
            .args(options)
            .current_dir(folder.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut port = String::new();
        let mut printed = BufReader::new(drive.stdout.take().unwrap());
        printed.read_line(&mut port).unwrap();
        assert_eq!(link.canonicalize().unwrap(), PathBuf::from(port.trim()));
        Self { folder, drive }
    }

    /// Path of the socket of a daemon with this configuration.
    fn daemon_socket(&self) -> PathBuf {
        let link = self.folder.path().join("epos");
        let name = link
            .to_string_lossy()
            .replace(|c: char| !c.is_ascii_alphanumeric(), "-");
        self.folder
            .path()
            .join(format!("velomotion{name}.daemon.sock"))
    }

    fn command(&self, line: &str) -> Command {
        let mut command = velomotion();
        command
            .args(line.split_whitespace())
            .current_dir(self.folder.path())
            .env("XDG_RUNTIME_DIR", self.folder.path());
        command
    }

    pub fn run(&self, line: &str) -> Output {
        self.command(line).output().unwrap()
    }

    pub fn json(&self, line: &str) -> serde_json::Value {
        let output = self.run(&format!("{line} --json"));
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{line}: {printed}");
        serde_json::from_slice(&output.stdout).unwrap()
    }
}

impl Bench {
    /// Starts a command that moves the axis and waits until the axis moves. A thread reads the rest
    /// of its messages.
    pub fn start_move(&self, line: &str) -> (Child, JoinHandle<usize>) {
        let mut moving = self.command(&format!("{line} -vv"));
        moving.stderr(Stdio::piped()).stdout(Stdio::null());
        let mut moving = moving.spawn().unwrap();
        let mut printed = BufReader::new(moving.stderr.take().unwrap());
        let mut line = String::new();
        while !line.contains("Moving(") {
            line.clear();
            assert!(printed.read_line(&mut line).unwrap() > 0, "no motion");
        }
        let rest = std::thread::spawn(move || printed.lines().count());
        (moving, rest)
    }

    /// Ends the drive, whose port disappears.
    pub fn unplug(&mut self) {
        drop(self.drive.stdin.take());
        assert!(self.drive.wait().unwrap().success());
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        drop(self.drive.stdin.take());
        let _ = self.drive.wait();
    }
}

fn velomotion() -> Command {
    Command::new(env!("CARGO_BIN_EXE_velomotion"))
}

#[test]
fn tilt_commands_show_home_and_move_the_axis_and_explain_faults() {
    let bench = Bench::new("--usb");
    let new = bench.json("tilt status");
    assert_eq!(
        (&new["state"], &new["referenced"]),
        (&"fault".into(), &false.into()),
        "{new}"
    );
    assert_eq!(new["angle_deg"], serde_json::Value::Null);
    assert_eq!(new["faults"][0]["code"], "8120");
    // Reading the status changes nothing.
    assert_eq!(bench.json("tilt status"), new);

    // Clearing takes the drive out of its fault; the history keeps the error.
    let cleared = bench.json("tilt faults --clear");
    assert_eq!(cleared["state"], "switch-on disabled", "{cleared}");
    assert_eq!(cleared["faults"][0]["code"], "8120");
    let printed = bench.run("tilt faults");
    let printed = String::from_utf8_lossy(&printed.stdout).into_owned();
    assert!(
        printed.contains("CAN Passive Mode Error") && printed.contains("wiring"),
        "{printed}"
    );

    // Before homing no angle is known.
    for lost in ["tilt goto -20", "tilt jog -20"] {
        assert_eq!(bench.run(lost).status.code(), Some(5), "{lost}");
    }
    let homed = bench.json("tilt home");
    assert_eq!(homed["referenced"], true);
    assert_eq!(homed["angle_deg"], 0.0);
    let moved = bench.json("tilt goto -20 --speed 40");
    assert!(
        (moved["angle_deg"].as_f64().unwrap() + 20.0).abs() < 0.001,
        "{moved}"
    );
    assert_eq!(
        moved["state"], "switch-on disabled",
        "the power stage is left on"
    );

    let jogged = bench.json("tilt jog 5 --speed 40");
    assert!(
        (jogged["angle_deg"].as_f64().unwrap() + 15.0).abs() < 0.002,
        "{jogged}"
    );
    for outside in ["tilt goto -46", "tilt jog -31"] {
        assert_eq!(bench.run(outside).status.code(), Some(2), "{outside}");
    }
}

#[test]
fn every_link_homes_and_moves_the_same_axis() {
    for interface in ["--usb", "--rs232", "--slcan"] {
        let bench = Bench::new(interface);
        let homed = bench.json("tilt home");
        assert_eq!(
            (&homed["referenced"], &homed["angle_deg"]),
            (&true.into(), &0.0.into()),
            "{interface}: {homed}"
        );
        let moved = bench.json("tilt goto -20 --speed 40");
        let angle = moved["angle_deg"].as_f64().unwrap();
        assert!((angle + 20.0).abs() < 0.001, "{interface}: {moved}");
        assert_eq!(moved["state"], "switch-on disabled", "{interface}: {moved}");
    }
}

/// 0.02 deg per count, and a servo that hunts by 8 counts either way.
#[test]
fn an_axis_with_a_coarse_encoder_comes_to_rest() {
    let axis = "[axis]\nencoder_lines = 50\ngear = [90, 1]\n";
    let bench = Bench::with("--usb", &["--dither", "8"], axis);
    bench.json("tilt home");
    let moved = bench.json("tilt goto -20 --speed 40");
    assert!(
        (moved["angle_deg"].as_f64().unwrap() + 20.0).abs() <= 0.2,
        "{moved}"
    );
    assert_eq!(moved["state"], "switch-on disabled", "{moved}");
}

#[test]
fn tilt_stop_stops_a_move_of_another_process() {
    let bench = Bench::new("--usb");
    bench.json("tilt home");
    let (mut moving, rest) = bench.start_move("tilt goto -40 --speed 1");
    let live = bench.json("tilt status");
    assert_eq!(
        (&live["state"], &live["power"], &live["activity"]),
        (&"operation enabled".into(), &true.into(), &"moving".into()),
        "{live}"
    );
    assert!(live["age_s"].as_f64().unwrap() < 1.0, "{live}");
    assert!(live["angle_deg"].as_f64().unwrap() <= 0.0, "{live}");
    let faults = String::from_utf8(bench.run("tilt faults").stdout).unwrap();
    assert!(faults.contains("has not been read"), "{faults}");
    let stopped = bench.json("tilt stop");
    assert_eq!(
        (&stopped["stopped"], &stopped["power"]),
        (&true.into(), &false.into()),
        "{stopped}"
    );
    assert_eq!(moving.wait().unwrap().code(), Some(130));
    rest.join().unwrap();
    let status = bench.json("tilt status");
    assert!(status["angle_deg"].as_f64().unwrap() > -39.0, "{status}");
    assert_eq!(status["state"], "switch-on disabled");
    // No process holds the drive: the stop goes to the drive itself.
    assert_eq!(bench.json("tilt stop")["state"], "switch-on disabled");
}

/// A person's shell and a service have different environments.
#[test]
fn tilt_stop_finds_a_process_with_another_runtime_folder() {
    let bench = Bench::new("--usb");
    let other = tempfile::tempdir().unwrap();
    for variable in [None, Some("XDG_RUNTIME_DIR"), Some("TMPDIR")] {
        bench.json("tilt home");
        let mut moving = bench.command("tilt goto -40 --speed 1");
        moving.env_remove("XDG_RUNTIME_DIR");
        moving.envs(variable.map(|variable| (variable, other.path())));
        let mut moving = moving.spawn().unwrap();
        let begin = std::time::Instant::now();
        let moves = |status: &Output| {
            serde_json::from_slice::<serde_json::Value>(&status.stdout)
                .is_ok_and(|status| status["activity"] == "moving")
        };
        while !moves(&bench.run("tilt status --json")) {
            assert!(begin.elapsed().as_secs() < 20, "no motion: {variable:?}");
        }
        assert_eq!(bench.json("tilt stop")["stopped"], true, "{variable:?}");
        assert_eq!(moving.wait().unwrap().code(), Some(130), "{variable:?}");
    }
}

#[test]
fn a_wrong_node_id_is_reported_with_its_key_in_the_configuration() {
    for interface in ["--usb", "--rs232", "--slcan"] {
        let bench = Bench::new(interface);
        let path = bench.folder.path().join("velomotion.toml");
        let config = std::fs::read_to_string(&path).unwrap();
        std::fs::write(path, format!("{config}[axis]\nnode = 5\n")).unwrap();
        let output = bench.run("tilt home");
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(5), "{interface}: {printed}");
        for part in ["node 5", "[axis] node"] {
            assert!(printed.contains(part), "{interface}: {part}: {printed}");
        }
    }
}

/// It would refuse the same command the next time.
#[test]
fn a_capture_without_an_answer_of_the_drive_leaves_no_log() {
    let bench = Bench::new("--usb");
    let free = [(); 2].map(|()| UdpSocket::bind("127.0.0.1:0").unwrap());
    let [port, position] = free.map(|socket| socket.local_addr().unwrap().port());
    let path = bench.folder.path().join("velomotion.toml");
    let config = std::fs::read_to_string(&path).unwrap();
    let lidar = format!("lidar = '127.0.0.1'\ndata_port = {port}\nposition_port = {position}\n");
    std::fs::write(path, format!("{config}{lidar}[axis]\nnode = 5\n")).unwrap();
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let lidar = UdpSocket::bind("127.0.0.1:0").unwrap();
            while !stop.load(Ordering::Relaxed) {
                // The program may not listen yet.
                let _ = lidar.send_to(&[0xFF; 1206], ("127.0.0.1", port));
                std::thread::sleep(Duration::from_millis(5));
            }
        });
        let outputs = [(); 2].map(|()| bench.run("capture --speed 56.25 -o scan.ply"));
        stop.store(true, Ordering::Relaxed);
        for output in outputs {
            let printed = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(5), "{printed}");
            assert!(printed.contains("node 5"), "{printed}");
        }
    });
    assert!(!bench.folder.path().join("scan.pcapng").exists());
}

/// The daemon's log goes to a full pipe, such as that of a viewer that was suspended.
#[test]
fn a_daemon_stops_its_axis_though_no_program_reads_its_log() {
    let bench = Bench::new("--usb");
    // A pipe of Linux holds 64 KiB (pipe(7)).
    let script = "head -c 65536 /dev/zero >&2; exec \"$0\" daemon -vv --listen 127.0.0.1:0";
    let mut daemon = Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_velomotion")])
        .current_dir(bench.folder.path())
        .env("XDG_RUNTIME_DIR", bench.folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begin = std::time::Instant::now();
    // Until the daemon listens, a command uses the drive itself.
    while UnixStream::connect(bench.daemon_socket()).is_err() {
        assert!(begin.elapsed().as_secs() < 20, "no daemon");
        std::thread::sleep(Duration::from_millis(10));
    }
    while !bench.run("tilt home").status.success() {
        assert!(begin.elapsed().as_secs() < 40, "no drive");
    }
    let mut moving = bench.command("tilt goto -40 --speed 1");
    let mut moving = moving.stderr(Stdio::null()).spawn().unwrap();
    while bench.json("tilt status")["activity"] != "moving" {
        assert!(begin.elapsed().as_secs() < 60, "no motion");
    }
    let pid = daemon.id().to_string();
    let kill = Command::new("kill").args(["-TERM", &pid]).status();
    assert!(kill.unwrap().success());
    assert!(daemon.wait().unwrap().success());
    assert_ne!(moving.wait().unwrap().code(), Some(0));
    let status = bench.json("tilt status");
    assert_eq!(status["state"], "switch-on disabled", "{status}");
    assert!(status["angle_deg"].as_f64().unwrap() > -39.0, "{status}");
}

/// This test listens at the socket of the drive's port, does not have the port, and answers that
/// the axis is stopped.
#[test]
fn a_program_without_the_port_cannot_confirm_a_stop() {
    let bench = Bench::new("--usb");
    let listener = UnixListener::bind(bench.daemon_socket()).unwrap();
    confirm_stops(listener, &Arc::default());
    let stopped = bench.json("tilt stop");
    assert_eq!(stopped["state"], "fault", "{stopped}");
    assert_eq!(stopped["stopped"], serde_json::Value::Null, "{stopped}");
}

/// Any number of programs may use a CAN bus, so the command looks at the drive itself. This bus
/// does not exist.
#[test]
fn a_program_on_a_can_bus_cannot_confirm_a_stop_alone() {
    let bench = Bench::new("--usb");
    let config = "[device]\ndefault = 'bus'\n[device.bus]\nkind = 'can'\ninterface = 'nobus0'\n";
    std::fs::write(bench.folder.path().join("velomotion.toml"), config).unwrap();
    let socket = bench.folder.path().join("velomotionnobus0.daemon.sock");
    let listener = UnixListener::bind(socket).unwrap();
    let asked = Arc::new(AtomicBool::new(false));
    confirm_stops(listener, &asked);
    let stopped = bench.run("tilt stop");
    let printed = String::from_utf8_lossy(&stopped.stderr).into_owned();
    assert!(asked.load(Ordering::Relaxed), "{printed}");
    assert_eq!(stopped.status.code(), Some(4), "{printed}");
    assert!(printed.contains("nobus0"), "{printed}");
}

/// A program that moves nothing answers that it has stopped the axis.
fn confirm_stops(listener: UnixListener, asked: &Arc<AtomicBool>) {
    let asked = Arc::clone(asked);
    std::thread::spawn(move || {
        for mut stream in listener.incoming().flatten() {
            let mut request = [0; 256];
            let length = stream.read(&mut request).unwrap_or(0);
            if String::from_utf8_lossy(&request[..length]).starts_with("POST") {
                asked.store(true, Ordering::Relaxed);
            }
            let body = r#"{"device":"soft","stopped":true,"state":"","power":false}"#;
            let length = body.len();
            let answer = format!("HTTP/1.1 200 OK\r\ncontent-length: {length}\r\n\r\n{body}");
            let _ = stream.write_all(answer.as_bytes());
        }
    });
}

/// The warning is in the report of the command and in its text.
#[test]
fn a_head_that_falls_after_a_move_is_a_warning() {
    let bench = Bench::with("--usb", &["--gravity=60"], "");
    let homed = bench.json("tilt home");
    let warnings = homed["warnings"].to_string();
    assert!(
        warnings.contains("deg after its power was switched off"),
        "{homed}"
    );
    assert!(warnings.contains("without_brake"), "{homed}");
    let moved = bench.run("tilt goto -20");
    let text = [moved.stdout, moved.stderr].concat();
    let text = String::from_utf8_lossy(&text).into_owned();
    assert!(
        text.contains("deg after its power was switched off"),
        "{text}"
    );
}

#[test]
fn the_status_of_a_held_axis_says_that_the_drive_holds_it() {
    let bench = Bench::with("--usb", &[], "[axis]\nwithout_brake = 'hold'\n");
    bench.json("tilt home");
    let status = bench.run("tilt status");
    let text = String::from_utf8_lossy(&status.stdout).into_owned();
    assert!(text.contains("on: the drive holds the axis"), "{text}");
}

/// The message says what to do, and which process hangs.
#[test]
fn a_stop_by_a_suspended_program_is_reported_as_not_confirmed() {
    let bench = Bench::new("--usb");
    bench.json("tilt home");
    let mut moving = bench.command("tilt goto -40 --speed 1").spawn().unwrap();
    let begin = std::time::Instant::now();
    // Until the program with the axis answers, the port is busy.
    let moves = |status: &Output| {
        serde_json::from_slice::<serde_json::Value>(&status.stdout)
            .is_ok_and(|status| status["activity"] == "moving")
    };
    while !moves(&bench.run("tilt status --json")) {
        assert!(begin.elapsed().as_secs() < 20, "no motion");
    }
    let id = moving.id().to_string();
    let signal = |name: &str| {
        let sent = Command::new("kill").args([name, &id]).status().unwrap();
        assert!(sent.success());
    };
    signal("-STOP");
    let stop = bench.run("tilt stop");
    signal("-KILL");
    moving.wait().unwrap();
    let printed = String::from_utf8_lossy(&stop.stderr).into_owned();
    assert_eq!(stop.status.code(), Some(5), "{printed}");
    for part in [
        "the stop is not confirmed yet: switch the motor's supply off",
        &format!("process {id} at"),
        "has not answered for 10 s",
    ] {
        assert!(printed.contains(part), "{part}: {printed}");
    }
}

/// Each command opens the port, and waits for one that reads the state. None makes a move for
/// another, which would end with it.
#[test]
fn moves_begin_while_other_commands_read_the_state() {
    let bench = Bench::new("--usb");
    bench.json("tilt home");
    let done = AtomicBool::new(false);
    std::thread::scope(|threads| {
        let reads = threads.spawn(|| {
            let mut refused = Vec::new();
            while !done.load(Ordering::Relaxed) {
                let status = bench.run("tilt status");
                if !status.status.success() {
                    refused.push(String::from_utf8_lossy(&status.stderr).into_owned());
                }
            }
            refused
        });
        let moved: Vec<Output> = [-1, -2, -3, -4, -5, -6]
            .map(|to| bench.run(&format!("tilt goto {to} --speed 50")))
            .into();
        done.store(true, Ordering::Relaxed);
        assert_eq!(reads.join().unwrap(), Vec::<String>::new());
        for goto in moved {
            let printed = String::from_utf8_lossy(&goto.stderr);
            assert!(goto.status.success(), "{printed}");
        }
    });
}

#[test]
fn firmware_sim_exits_and_removes_its_link_when_stdin_closes() {
    let bench = Bench::new("--rs232");
    let link = bench.folder.path().join("epos");
    assert!(link.is_symlink());
    let mut bench = bench;
    bench.unplug();
    assert!(!link.is_symlink());
}

/// A service or a script in the background has /dev/null for stdin.
#[test]
fn firmware_sim_runs_on_without_a_stdin() {
    let folder = tempfile::tempdir().unwrap();
    let mut drive = velomotion()
        .args(["firmware-sim", "--usb"])
        .current_dir(folder.path())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut port = String::new();
    let mut printed = BufReader::new(drive.stdout.take().unwrap());
    printed.read_line(&mut port).unwrap();
    let config = format!(
        "[device]\ndefault = 'soft'\n[device.soft]\nkind = 'usb'\nport = '{}'\n",
        port.trim()
    );
    std::fs::write(folder.path().join("velomotion.toml"), config).unwrap();
    let status = velomotion()
        .args(["tilt", "status"])
        .current_dir(folder.path())
        .env("XDG_RUNTIME_DIR", folder.path())
        .output()
        .unwrap();
    drive.kill().unwrap();
    drive.wait().unwrap();
    assert!(
        status.status.success(),
        "{}",
        String::from_utf8_lossy(&status.stderr)
    );
}

/// Of systemd there is only a stand-in here, which writes what it is asked for, and its end, into a
/// pipe with a name.
#[test]
fn the_machine_does_not_sleep_while_the_axis_can_move() {
    // On USB a guardian process is armed at the same time; on CAN there is none.
    for interface in ["--usb", "--slcan"] {
        let bench = Bench::new(interface);
        let folder = bench.folder.path();
        let pipe = folder.join("asked");
        let made = Command::new("mkfifo").arg(&pipe).status().unwrap();
        assert!(made.success());
        let program = folder.join("systemd-inhibit");
        // Another process writes it: one that a test beside this one starts at the same time would
        // hold the file open for writing, and no such file can be executed (ETXTBSY).
        let script = "#!/bin/sh\nexec >\"${0%/*}/asked\"\necho \"$@\"\ncat\necho end\n";
        let write = r#"printf %s "$1" >"$0" && chmod 755 "$0""#;
        let mut shell = Command::new("sh");
        let written = shell.args(["-c", write]).arg(&program).arg(script).status();
        assert!(written.unwrap().success());
        let (send, asked) = std::sync::mpsc::channel();
        std::thread::spawn(move || send.send(std::fs::read_to_string(pipe)));
        let path = std::env::var("PATH").unwrap();
        let mut home = bench.command("tilt home");
        let output = home
            .env("PATH", format!("{}:{path}", folder.display()))
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        let asked = asked.recv_timeout(Duration::from_secs(60)).unwrap();
        let asked = asked.unwrap();
        assert!(
            asked.starts_with("--what=sleep:handle-lid-switch --who=velomotion"),
            "{asked}"
        );
        assert!(asked.ends_with("--mode=block cat\nend\n"), "{asked}");
    }
}
