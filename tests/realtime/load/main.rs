//! Captures on a loaded machine: busy loops take the processors from the program and its lidar.
//! Every capture must be complete. The simulated drive is a process of its own, with a raised
//! priority where that is allowed: a real one has its own processor.
//!
//! `cargo test -p velomotion --test load -- [--captures N] [--loops N] [--link LINK] [--page]`:
//! captures by the command, and as many by a daemon. Without arguments 2 of each, 8 loops, and usb.
//! `--page` shows the daemon's page meanwhile in Chromium, which draws without a graphics card.
#![allow(clippy::unwrap_used, clippy::panic, clippy::expect_used)] // a test

use std::fmt::Debug;
use std::io::{BufRead, BufReader};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, UdpSocket};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Between two packets of a VLP-16: 24 sequences of 55.296 us (manual 63-9243).
const PACKET: Duration = Duration::from_nanos(1_327_104);
/// Between the azimuths of two blocks at 600 rpm, hundredths of a degree.
const BLOCK_AZIMUTH: f64 = 110.592e-6 * 10.0 * 36_000.0;
/// Time for a daemon to connect to its devices.
const START: Duration = Duration::from_secs(30);

fn main() {
    let (captures, loops) = (value_of("--captures", 2), value_of("--loops", 8));
    let folder = tempfile::tempdir().unwrap();
    let free = |_| UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let [data, position] = [0, 1].map(free).map(|s| s.local_addr().unwrap().port());
    let link: String = value_of("--link", "usb".to_owned());
    // For an ordinary user the priority stays as it is.
    let mut drive = Command::new("nice")
        .args(["-n", "-15", env!("CARGO_BIN_EXE_velomotion")])
        .args(["firmware-sim", &format!("--{link}")])
        .current_dir(folder.path())
        .env("XDG_RUNTIME_DIR", folder.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let port = first_line(&mut drive);
    let config = format!(
        "[device]\ndefault = 'separate'\n[device.separate]\nkind = '{link}'\nport = '{port}'\nlidar = '127.0.0.1'\n\
         data_port = {data}\nposition_port = {position}\n[daemon]\nscans = 'scans'\nreserve_bytes = 1000\n"
    );
    std::fs::write(folder.path().join("velomotion.toml"), config).unwrap();
    let stop = AtomicBool::new(false);
    let mut lost = 0;
    std::thread::scope(|scope| {
        scope.spawn(|| send_packets(data, &stop));
        for _ in 0..loops {
            scope.spawn(|| {
                while !stop.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        lost += (0..captures)
            .filter(|number| !is_complete(folder.path(), "command", *number))
            .count();
        let address = free_address();
        let daemon = spawn(folder.path(), &format!("daemon --listen {address}"), &[]);
        wait_for_devices(folder.path());
        let browser = has("--page").then(|| open_page(folder.path(), address));
        lost += (0..captures)
            .filter(|number| !is_complete(folder.path(), "daemon", *number))
            .count();
        for mut process in browser.into_iter().chain([daemon]) {
            let _ = process.kill();
            let _ = process.wait();
        }
        stop.store(true, Ordering::Relaxed);
    });
    drop(drive.stdin.take());
    let _ = drive.wait();
    let page = if has("--page") { " and the page" } else { "" };
    println!(
        "{lost} of {} captures over {link} incomplete with {loops} busy loops{page}",
        2 * captures
    );
    assert_eq!(lost, 0);
}

/// Value of an option of this test.
fn value_of<T: FromStr<Err: Debug>>(option: &str, default: T) -> T {
    let mut words = std::env::args().skip_while(|word| word != option).skip(1);
    words.next().map_or(default, |word| word.parse().unwrap())
}

fn has(option: &str) -> bool {
    std::env::args().any(|word| word == option)
}

fn free_address() -> SocketAddr {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    listener.local_addr().unwrap()
}

/// Shows the page as on a laptop whose graphics card the browser does not use.
fn open_page(folder: &Path, address: SocketAddr) -> Child {
    let profile = folder.join("browser");
    Command::new("chromium")
        .args(["--headless=new", "--no-sandbox", "--disable-dev-shm-usage"])
        .args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
        .arg("--window-size=1440,900")
        .arg(format!("--user-data-dir={}", profile.display()))
        .args(["--remote-debugging-port=0", &format!("http://{address}/")])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

fn command(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_velomotion"));
    command
        .args(line.split_whitespace())
        .current_dir(folder)
        .env("XDG_RUNTIME_DIR", folder)
        .env_remove("RUNTIME_DIRECTORY");
    command
}

fn spawn(folder: &Path, line: &str, more: &[&str]) -> Child {
    let mut command = command(folder, line);
    command.args(more).stdin(Stdio::piped());
    command.stdout(Stdio::piped()).stderr(Stdio::null());
    command.spawn().unwrap()
}

/// First line of the process's output, which nothing else reads.
fn first_line(process: &mut Child) -> String {
    let mut line = String::new();
    let mut printed = BufReader::new(process.stdout.take().unwrap());
    printed.read_line(&mut line).unwrap();
    line.trim_end().to_owned()
}

/// Sends packets of surfaces 5 m away, on time or as soon as this thread runs.
fn send_packets(port: u16, stop: &AtomicBool) {
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let begin = Instant::now();
    for number in 0_u32.. {
        if stop.load(Ordering::Relaxed) {
            return;
        }
        let due = PACKET * (number + 1);
        std::thread::sleep(due.saturating_sub(begin.elapsed()));
        // The program may not listen yet.
        let _ = socket.send_to(&packet(number), (Ipv4Addr::LOCALHOST, port));
    }
}

fn packet(number: u32) -> Vec<u8> {
    let mut packet = Vec::with_capacity(1206);
    for block in 0..12 {
        let azimuth = f64::from(12 * number + block) * BLOCK_AZIMUTH % 36_000.0;
        packet.extend([0xFF, 0xEE]);
        packet.extend((azimuth as u16).to_le_bytes());
        for _ in 0..32 {
            packet.extend(2_500_u16.to_le_bytes());
            packet.push(50);
        }
    }
    let us = (PACKET * number).as_micros() % 3_600_000_000;
    packet.extend((us as u32).to_le_bytes());
    packet.extend([0x37, 0x22]);
    packet
}

/// Waits until the daemon listens, since a command would use the drive itself before, and until it
/// has the drive.
fn wait_for_devices(folder: &Path) {
    let begin = Instant::now();
    let is_socket = |name: &Path| UnixStream::connect(name).is_ok();
    while !std::fs::read_dir(folder)
        .unwrap()
        .any(|entry| is_socket(&entry.unwrap().path()))
        || !command(folder, "tilt home")
            .output()
            .unwrap()
            .status
            .success()
    {
        assert!(begin.elapsed() < START, "the daemon has no devices");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Captures a sweep of 45 degrees, and prints its exit code, points and gaps.
fn is_complete(folder: &Path, by: &str, number: usize) -> bool {
    let line = format!("capture --speed 56.25 --json -o {by}-{number}.ply");
    let output = command(folder, &line).output().unwrap();
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    println!(
        "{by} {number}: {}, {} points, {} gaps, the longest {} s, angle within {} deg {}",
        output.status,
        report["points"],
        report["sync"]["angle_gaps"],
        report["sync"]["longest_angle_gap_s"],
        report["sync"]["angle_bound_deg"],
        report["error"]["message"],
    );
    output.status.success()
}
