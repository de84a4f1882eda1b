//! One run: the fake devices, the client in a process of its own, and what came of it.

use std::fs::File;
use std::net::{Ipv4Addr, UdpSocket};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use io::port::{Port, Pty};
use units::Span;

use crate::drive::Drive;
use crate::faults::{By, Expect, Misbehaviour, When};
use crate::lidar;
use crate::rs232::Rs232;
use crate::slcan::Slcan;
use crate::usb::Usb;
use crate::wire::Link;

/// A client that has not ended by then never does.
const LIMIT: Duration = Duration::from_secs(60);
/// The drive runs on for this time after the client's end.
const AFTERWARDS: Duration = Duration::from_millis(400);
/// The same where the guardian tries once more to stop it: longer than such a try.
const TRIED: Duration = Duration::from_secs(3);
/// A drive whose thread did not run for so many seconds misbehaves in a way of its own.
pub const MAX_GAP: f64 = 0.012;
/// Longest time between two requests on a quiet machine, of the slowest link.
const BETWEEN_REQUESTS: f64 = 0.003;

/// How the client reaches the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    Usb,
    Rs232,
    Slcan,
}

impl Transport {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Usb, Self::Rs232, Self::Slcan];

    /// Kind in the configuration.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Usb => "usb",
            Self::Rs232 => "rs232",
            Self::Slcan => "slcan",
        }
    }

    fn link(self) -> Box<dyn Link> {
        match self {
            Self::Usb => Box::<Usb>::default(),
            Self::Rs232 => Box::<Rs232>::default(),
            Self::Slcan => Box::<Slcan>::default(),
        }
    }
}

/// What is left of the scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    Nothing,
    Log,
    Cloud,
}

/// What came of a run.
pub struct Outcome {
    /// The drive in the end.
    pub drive: Drive,
    /// Exit code.
    pub exit: Option<i32>,
    /// When the client had ended.
    pub ended: f64,
    /// What the client printed.
    pub printed: String,
    /// What it kept.
    pub kept: Kept,
    /// Longest pause of the drive's thread, a fifth of it at standstill.
    pub gap: f64,
    /// Longest time without a request between the beginning and the first stop, and from then on
    /// while the axis moves under power.
    pub silence: f64,
    /// Sum of what such times exceed [`BETWEEN_REQUESTS`] by, where they do so twice: pauses of the
    /// machine, but not a client that is slow throughout.
    pub held_up: f64,
}

/// What the threads of a run share.
struct Shared {
    begin: Instant,
    end: AtomicBool,
    half: AtomicBool,
    /// Nanoseconds from the beginning to the signal.
    signalled: AtomicU64,
}

/// Lets the client capture with a misbehaving drive.
pub fn run(row: &'static Misbehaviour, transport: Transport) -> Result<Outcome, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let pty = Pty::open().map_err(|error| error.to_string())?;
    let port = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))
        .and_then(|socket| socket.local_addr())
        .map_err(|error| error.to_string())?
        .port();
    let config = format!(
        "[device]\ndefault = 'fake'\n[device.fake]\nkind = '{}'\nport = '{}'\nlidar = '127.0.0.1'\n\
         data_port = {port}\nposition_port = {port}\n[axis]\nbrake_output = 1\n\
         [axis.homing]\nmethod = 18\nat_deg = 1.0\nto_deg = 0.0\nspeed_deg_s = 15.0\nedge_speed_deg_s = 5.0\n",
        transport.kind(),
        pty.path().display()
    );
    std::fs::write(folder.path().join("velomotion.toml"), config).map_err(|e| e.to_string())?;
    let shared = Shared {
        begin: Instant::now(),
        end: AtomicBool::new(false),
        half: AtomicBool::new(false),
        signalled: AtomicU64::new(0),
    };
    std::thread::scope(|scope| {
        let device = scope.spawn(|| be_drive(pty, row, transport, &shared));
        scope.spawn(|| lidar::run(port, &shared.end));
        let exit = move_axis(folder.path(), row, &shared);
        let ended = shared.begin.elapsed().as_secs_f64();
        std::thread::sleep(match row.expect {
            Expect::Unstoppable => TRIED,
            _ => AFTERWARDS,
        });
        shared.end.store(true, Ordering::Release);
        let (drive, [gap, silence, held_up]) =
            device.join().map_err(|_| "the fake drive panicked")?;
        let read = |name| {
            let bytes = std::fs::read(folder.path().join(name)).unwrap_or_default();
            String::from_utf8_lossy(&bytes).into_owned()
        };
        Ok(Outcome {
            drive,
            exit: exit?,
            ended,
            printed: read("printed"),
            kept: kept(folder.path()),
            gap,
            silence,
            held_up,
        })
    })
}

/// Moves the axis; returns the exit code of the command that fails, or of the last.
fn move_axis(folder: &Path, row: &Misbehaviour, shared: &Shared) -> Result<Option<i32>, String> {
    const CAPTURE: &str = "capture --speed 56.25 --accel 500 -o scan.ply --log scan.pcapng";
    match row.by {
        By::Capture => client(folder, CAPTURE, row, shared),
        By::Goto => match client(folder, "tilt home", row, shared)? {
            Some(0) => client(
                folder,
                "tilt goto -45 --speed 56.25 --accel 500",
                row,
                shared,
            ),
            exit => Ok(exit),
        },
        By::Daemon => {
            let mut daemon = velomotion(folder, "daemon --listen 127.0.0.1:0");
            let file =
                File::create(folder.join("daemon.log")).map_err(|error| error.to_string())?;
            let daemon = daemon.stdout(Stdio::null()).stderr(file).spawn();
            let mut daemon = daemon.map_err(|error| error.to_string())?;
            let exit = when_ready(folder).and_then(|()| client(folder, CAPTURE, row, shared));
            let ended = terminate(&daemon).and_then(|()| {
                let status = daemon.wait().map_err(|error| error.to_string())?;
                status
                    .success()
                    .then_some(())
                    .ok_or(format!("the daemon: {status}"))
            });
            exit.and_then(|exit| ended.map(|()| exit))
        }
    }
}

/// Waits until the daemon answers and has the drive.
fn when_ready(folder: &Path) -> Result<(), String> {
    let begin = Instant::now();
    let is_socket = |entry: std::io::Result<std::fs::DirEntry>| {
        entry.is_ok_and(|entry| UnixStream::connect(entry.path()).is_ok())
    };
    while begin.elapsed() < LIMIT {
        let mut entries = std::fs::read_dir(folder).map_err(|error| error.to_string())?;
        let status = || velomotion(folder, "tilt status").output();
        if entries.any(is_socket) && status().is_ok_and(|status| status.status.success()) {
            return Ok(());
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    Err("the daemon has no drive".to_owned())
}

fn velomotion(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_velomotion"));
    command
        .args(line.split(' '))
        .current_dir(folder)
        .env("XDG_RUNTIME_DIR", folder)
        .env("XDG_STATE_HOME", folder)
        .stdin(Stdio::null());
    command
}

/// Runs a command; returns its exit code.
fn client(
    folder: &Path,
    line: &str,
    row: &Misbehaviour,
    shared: &Shared,
) -> Result<Option<i32>, String> {
    let mut client = velomotion(folder, line);
    // An unread pipe is full after a moment of -vv.
    let is_unread = row.name.contains("output unread");
    if is_unread {
        client
            .arg("-vv")
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
    } else {
        let file = File::create(folder.join("printed")).map_err(|error| error.to_string())?;
        let stdout = file.try_clone().map_err(|error| error.to_string())?;
        client.stdout(stdout).stderr(file);
    }
    let mut child = client.spawn().map_err(|error| error.to_string())?;
    let begin = Instant::now();
    loop {
        if let Some(status) = child.try_wait().map_err(|error| error.to_string())? {
            return Ok(status.code());
        }
        if begin.elapsed() > LIMIT {
            let _ = child.kill();
            let _ = child.wait();
            return Err(format!("the client still runs after {} s", LIMIT.as_secs()));
        }
        let is_due = row.when == When::Stopping && shared.half.load(Ordering::Acquire);
        if is_due && shared.signalled.load(Ordering::Acquire) == 0 {
            let now = shared.begin.elapsed().as_nanos() as u64;
            shared.signalled.store(now, Ordering::Release);
            terminate(&child)?;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn terminate(child: &Child) -> Result<(), String> {
    let id = child.id().to_string();
    let sent = Command::new("kill").args(["-TERM", &id]).status();
    sent.map(drop).map_err(|error| error.to_string())
}

/// Runs the drive until the end; returns it with the outcome's `gap`, `silence` and `held_up`.
fn be_drive(
    pty: Pty,
    row: &'static Misbehaviour,
    transport: Transport,
    shared: &Shared,
) -> (Drive, [f64; 3]) {
    let mut pty = Some(pty);
    let mut link = transport.link();
    let mut drive = Drive::new(-8.0);
    drive.record.can = transport == Transport::Slcan;
    drive.arm(row);
    let (mut buffer, mut last, mut received) = ([0; 512], 0.0, 0.0);
    let (mut longest, mut silence, mut held_up) = (0.0_f64, 0.0_f64, 0.0_f64);
    while !shared.end.load(Ordering::Acquire) {
        let read = match &mut pty {
            Some(port) => port
                .read(&mut buffer, Span::from_nanos(300_000))
                .ok()
                .flatten(),
            None => {
                std::thread::sleep(Duration::from_micros(300));
                None
            }
        };
        let now = shared.begin.elapsed().as_secs_f64();
        // While the axis stands, a client waits for longer.
        let allowance = if drive.axis.speed.abs() > 0.1 {
            1.0
        } else {
            0.2
        };
        longest = longest.max((now - last) * allowance);
        last = now;
        drive.advance(now);
        let bytes = buffer
            .get(..read.map_or(0, |(count, _)| count))
            .unwrap_or_default();
        let is_driven = drive.axis.powered && drive.axis.speed.abs() > 0.1;
        let is_judged = |began| drive.record.first_stop(began).is_none() || is_driven;
        let is_judged = drive.record.began.is_some_and(is_judged);
        if !bytes.is_empty() {
            if is_judged {
                let between = now - received;
                if between > 2.0 * BETWEEN_REQUESTS {
                    held_up += between - BETWEEN_REQUESTS;
                }
            }
            received = now;
        }
        if is_judged {
            silence = silence.max(now - received);
        }
        let is_dead = drive.boots_at.is_some() || drive.faults.is_deaf;
        if is_dead && transport != Transport::Slcan {
            if !bytes.is_empty() {
                drive.show();
            }
        } else {
            link.receive(&mut drive, bytes);
        }
        link.idle(&mut drive);
        let due = link.outbox().due(now);
        if let Some(port) = &mut pty
            && !due.is_empty()
        {
            // A client that has ended reads nothing.
            let _ = port.write_frame(&due);
        }
        if drive.faults.is_unplugged && pty.take().is_some() {
            drive.show();
        }
        let signalled = shared.signalled.load(Ordering::Acquire);
        if signalled > 0 {
            drive.record.signalled = Some(signalled as f64 / 1e9);
        }
        if drive.record.half.is_some() {
            shared.half.store(true, Ordering::Release);
        }
    }
    (drive, [longest, silence, held_up])
}

fn kept(folder: &Path) -> Kept {
    let log = folder.join("scan.pcapng");
    if !log.exists() {
        return Kept::Nothing;
    }
    let info = Command::new(env!("CARGO_BIN_EXE_velomotion"))
        .arg("info")
        .arg(&log)
        .output();
    if !info.is_ok_and(|info| matches!(info.status.code(), Some(0 | 6))) {
        return Kept::Nothing;
    }
    let cloud = std::fs::read(folder.join("scan.ply")).unwrap_or_default();
    let header = String::from_utf8_lossy(&cloud[..cloud.len().min(400)]).into_owned();
    let points = header.lines().find_map(|line| {
        line.strip_prefix("element vertex ")?
            .trim()
            .parse::<u64>()
            .ok()
    });
    if points.is_some_and(|points| points > 0) {
        Kept::Cloud
    } else {
        Kept::Log
    }
}

impl Outcome {
    /// When the client was shown the misbehaviour, or it began.
    pub fn shown(&self) -> Option<f64> {
        let record = &self.drive.record;
        record.signalled.or(record.shown).or(record.began)
    }

    /// Milliseconds from then to the first stop.
    pub fn stop_ms(&self) -> Option<f64> {
        let shown = self.shown()?;
        let stop = self.drive.record.first_stop(shown)?;
        Some((stop - shown) * 1e3)
    }

    /// Whether a stop still came after the client's end: from its guardian.
    pub fn is_guarded(&self) -> bool {
        self.drive.record.first_stop(self.ended).is_some()
    }

    /// Whether the row's misbehaviour was seen at all.
    pub fn has_begun(&self, row: &Misbehaviour) -> bool {
        row.expect == Expect::Completes || self.drive.record.has_begun()
    }
}
