//! The guardian: a small process that stops the axis when this one cannot.
//!
//! It shares the open port. While the axis may move or is powered, the drive loop sends it
//! heartbeats over a socket. If they stop, or the socket closes as this process dies, the guardian
//! stops the axis with the drive client. The parent then gives the port up: it never uses it at the
//! same time, and never resumes the move.
//!
//! On CAN the drive itself monitors the heartbeats of the host (1016): there is no guardian.

use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::os::unix::process::parent_id;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use ::io::port::{Port, PortChild, SerialPort, shared_port};
use drive::DriveClient;
use protocol::record::DriveLink;
use serde::{Deserialize, Serialize};
use thiserror::Error;
use units::Span;

use super::drive_session::{Session, SessionError};
use super::process_threads::{self, ProcessThreads};
use super::profile;
use crate::config::AxisSettings;

/// Argument of the hidden subcommand that runs [`run`].
pub const ARGUMENT: &str = "guard-axis";
/// Between two heartbeats.
const HEARTBEAT: Duration = Duration::from_millis(50);
/// Silence while armed after which the guardian stops the axis. A quick stop from the highest speed
/// takes 200 ms more, standstill and brake 100 ms: together less than a second.
pub const SILENCE_LIMIT: Duration = Duration::from_millis(500);
/// The same with the time in which the machine did not let the drive loop run: it is neither
/// stopped nor stuck. With two busy loops per processor poll(2) of a terminal waits for the
/// kernel's own threads for up to 2.2 s, as measured.
const OVERLOAD_LIMIT: Duration = Duration::from_secs(3);
/// Between two checks of a silent program.
const CHECK_INTERVAL: Duration = Duration::from_millis(20);
/// Time that counts at most between two checks: the machine may not have run the guardian either.
const MAX_COUNTED: Duration = Duration::from_millis(40);
/// Gap in the drive loop after which the parent asks before it uses the port.
const ASK_AFTER: Duration = Duration::from_millis(200);
/// Longest wait for an answer of the guardian; its start takes some tens of milliseconds, and a
/// loaded machine did not run it for 2 s.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(5);
/// Longest wait until a guardian at work has stopped the axis.
const STOP_TIMEOUT: Duration = Duration::from_secs(10);
/// Time in which a guardian reads what is left on the line before it stops the axis: longer than a
/// telegram takes to arrive, and short even if the line never falls silent.
const DRAIN_LIMIT: Duration = Duration::from_millis(20);
/// Longest wait for a guardian that reads nothing.
const SEND_TIMEOUT: Duration = Duration::from_millis(20);

/// Messages of the parent.
mod request {
    /// The id of the thread that drives the axis follows, in decimal, and [`ARM_END`].
    pub const ARM: u8 = b'A';
    pub const ARM_END: u8 = b';';
    pub const DISARM: u8 = b'D';
    pub const HEARTBEAT: u8 = b'H';
    pub const ASK: u8 = b'?';
}

/// Answers of the guardian.
mod answer {
    /// To [`super::request::ASK`]: it has not acted and will not before [`super::SILENCE_LIMIT`].
    pub const IDLE: u8 = b'.';
    /// It uses the port from now on. Its [`super::GuardianReport`] follows.
    pub const ACTS: u8 = b'!';
}

/// What a guardian needs to know: the first line on its socket.
#[derive(Debug, Serialize, Deserialize)]
struct GuardianSetup {
    rs232: bool,
    axis: AxisSettings,
}

/// What a guardian did.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[non_exhaustive]
pub struct GuardianReport {
    /// Whether the parent had died, rather than been silent.
    pub parent_died: bool,
    /// Why the axis could not be stopped.
    pub failure: Option<String>,
}

/// End of a motion caused by its guardian.
#[derive(Debug, Error)]
pub enum GuardianError {
    /// This process was suspended or stuck.
    #[error("this program did not run for {:.1} s while the axis could move; {}", gap.as_secs_f64(), outcome(report.as_ref()))]
    Acted {
        /// Gap in the drive loop.
        gap: Duration,
        /// Actions of the guardian, if it has reported.
        report: Option<GuardianReport>,
    },
    /// The guardian failed after such a gap; this process has stopped the axis since.
    #[error("this program did not run for {:.1} s while the axis could move; {}; this program has stopped the axis since", gap.as_secs_f64(), outcome(report.as_ref()))]
    Replaced {
        /// Gap in the drive loop.
        gap: Duration,
        /// Actions of the guardian, if it has reported.
        report: Option<GuardianReport>,
    },
    /// The guardian has ended or does not answer.
    #[error(
        "the guardian process, which stops the axis if this program dies, has ended or does not answer; the axis is stopped"
    )]
    Lost,
}

fn outcome(report: Option<&GuardianReport>) -> String {
    match report {
        Some(GuardianReport { failure: None, .. }) => {
            "its guardian process has stopped the axis".to_owned()
        }
        Some(GuardianReport {
            failure: Some(failure),
            ..
        }) => format!("its guardian process could not stop the axis: {failure}"),
        None => "its guardian process has not reported that it stopped the axis".to_owned(),
    }
}

impl GuardianError {
    /// Whether the axis may still move.
    #[must_use]
    pub const fn may_move(&self) -> bool {
        match self {
            Self::Acted { report, .. } => {
                !matches!(report, Some(GuardianReport { failure: None, .. }))
            }
            Self::Replaced { .. } | Self::Lost => false,
        }
    }

    /// The same once this process has stopped the axis itself.
    #[must_use]
    pub(super) fn after_own_stop(self) -> Self {
        match self {
            Self::Acted { gap, report } => Self::Replaced { gap, report },
            error => error,
        }
    }
}

/// The guardian of a port, by the process that drives the axis.
pub struct Guardian {
    child: PortChild,
    /// Time of the last heartbeat while armed.
    armed: Option<Instant>,
}

impl Guardian {
    /// Starts `program` as the guardian of `port` and waits until it is ready.
    ///
    /// # Errors
    /// The system's error; [`io::ErrorKind::TimedOut`] if the guardian does not answer.
    pub fn start(
        program: &Path,
        port: &SerialPort,
        link: DriveLink,
        axis: &AxisSettings,
    ) -> io::Result<Self> {
        let setup = GuardianSetup {
            rs232: link == DriveLink::Rs232,
            axis: *axis,
        };
        let child = port.spawn_child(program, ARGUMENT)?;
        child.socket.set_write_timeout(Some(SEND_TIMEOUT))?;
        let mut guardian = Self { child, armed: None };
        (&guardian.child.socket)
            .write_all(format!("{}\n", serde_json::to_string(&setup)?).as_bytes())?;
        match guardian.ask() {
            Ok(()) => Ok(guardian),
            Err(_) => Err(io::ErrorKind::TimedOut.into()),
        }
    }

    /// Arms the guardian before a command that can power or move the axis.
    ///
    /// # Errors
    /// [`GuardianError::Lost`].
    pub fn arm(&mut self) -> Result<(), GuardianError> {
        let mut arm = vec![request::ARM];
        arm.extend(process_threads::own_id().to_string().into_bytes());
        arm.push(request::ARM_END);
        self.send(&arm)?;
        self.armed = Some(Instant::now());
        self.ask()
    }

    /// Disarms the guardian of an axis at rest.
    pub fn disarm(&mut self) {
        if self.armed.take().is_some() {
            // A guardian that is gone is noticed when it is armed again.
            let _ = self.send(&[request::DISARM]);
        }
    }

    /// Sends a heartbeat if one is due. Called by the drive loop before it uses the port.
    ///
    /// # Errors
    /// [`GuardianError`]: the port belongs to the guardian, or there is none.
    pub fn heartbeat(&mut self) -> Result<(), GuardianError> {
        let Some(last) = self.armed else {
            return Ok(());
        };
        let gap = last.elapsed();
        if gap < HEARTBEAT {
            return Ok(());
        }
        if gap < ASK_AFTER {
            self.send(&[request::HEARTBEAT])?;
            self.armed = Some(Instant::now());
            return Ok(());
        }
        self.ask()
    }

    fn send(&self, request: &[u8]) -> Result<(), GuardianError> {
        (&self.child.socket)
            .write_all(request)
            .map_err(|_| GuardianError::Lost)
    }

    /// Makes sure that the guardian is there and has not acted.
    fn ask(&mut self) -> Result<(), GuardianError> {
        let gap = self.armed.map_or(Duration::ZERO, |last| last.elapsed());
        // A guardian that acts no longer reads.
        let sent = self.send(&[request::ASK]);
        match self.receive(ANSWER_TIMEOUT) {
            Some(answer::IDLE) if sent.is_ok() => {
                self.armed = self.armed.map(|_| Instant::now());
                Ok(())
            }
            Some(answer::ACTS) => {
                self.armed = None;
                let report = self.report();
                if report.is_none() {
                    // It must not use the port at the same time as this process.
                    self.child.kill();
                }
                Err(GuardianError::Acted { gap, report })
            }
            _ => Err(GuardianError::Lost),
        }
    }

    fn receive(&self, timeout: Duration) -> Option<u8> {
        let mut byte = [0];
        self.child.socket.set_read_timeout(Some(timeout)).ok()?;
        (&self.child.socket).read_exact(&mut byte).ok()?;
        let [byte] = byte;
        Some(byte)
    }

    /// Waits until the guardian has stopped the axis and ended.
    fn report(&self) -> Option<GuardianReport> {
        let socket = &self.child.socket;
        socket.set_read_timeout(Some(STOP_TIMEOUT)).ok()?;
        serde_json::from_str(&read_line(socket).ok()?).ok()
    }
}

/// Runs the guardian of the port that this process was started with. Returns what it did, or `None`
/// if the parent has ended with the axis at rest.
///
/// # Errors
/// The process was not started as a guardian.
pub fn run() -> io::Result<Option<GuardianReport>> {
    let (mut socket, port) = shared_port()?;
    let setup: GuardianSetup = serde_json::from_str(&read_line(&socket)?)?;
    let axis = profile::axis(&setup.axis).map_err(|failure| io::Error::other(failure.message))?;
    let Some(parent_died) = wait_for_alarm(&mut socket)? else {
        return Ok(None);
    };
    // The parent may have died: nothing is sent then.
    let _ = socket.write_all(&[answer::ACTS]);
    let link = match setup.rs232 {
        true => DriveLink::Rs232,
        false => DriveLink::Usb,
    };
    let failure = stop(axis, link, port).err();
    let report = GuardianReport {
        parent_died,
        failure: failure.map(|error| error.to_string()),
    };
    let _ = socket.write_all(format!("{}\n", serde_json::to_string(&report)?).as_bytes());
    Ok(Some(report))
}

/// Stops the axis, whatever the parent has left on the line. Late answers to the parent may spoil
/// the first attempt.
fn stop(axis: drive::AxisConfig, link: DriveLink, mut port: impl Port) -> Result<(), SessionError> {
    drain(&mut port);
    let client = DriveClient::new(axis, link);
    let mut session = Session::new(client, port, Arc::default());
    session.stop(&mut |_| {})
}

/// Reads what is on the line, but not for longer than [`DRAIN_LIMIT`]. The stop is tried whatever
/// comes of it.
fn drain(port: &mut impl Port) {
    let mut buffer = [0; 512];
    let deadline = Instant::now() + DRAIN_LIMIT;
    while let Ok(Some(_)) = port.read(&mut buffer, Span::ZERO)
        && Instant::now() < deadline
    {}
}

/// Reads a line, and nothing beyond it.
fn read_line(socket: &UnixStream) -> io::Result<String> {
    read_until(socket, b'\n')
}

/// Reads up to a byte, which is dropped, and nothing beyond it.
fn read_until(mut socket: &UnixStream, end: u8) -> io::Result<String> {
    let mut text = Vec::new();
    let mut byte = [0];
    loop {
        socket.read_exact(&mut byte)?;
        match byte {
            [byte] if byte == end => return String::from_utf8(text).map_err(io::Error::other),
            [byte] => text.push(byte),
        }
    }
}

/// Waits for the end of the heartbeats while armed: true if the parent has died. `None` if it ends
/// while not armed.
fn wait_for_alarm(socket: &mut UnixStream) -> io::Result<Option<bool>> {
    let mut threads = ProcessThreads::of(parent_id());
    let mut armed = false;
    let mut silence = Silence::default();
    loop {
        socket.set_read_timeout(armed.then_some(CHECK_INTERVAL))?;
        let mut byte = [0];
        match socket.read(&mut byte) {
            Ok(0) => return Ok(armed.then_some(true)),
            Ok(_) => {
                silence = Silence::default();
                match byte {
                    [request::ARM] => {
                        armed = true;
                        // Without the id only the limit in all is shorter.
                        let id = read_until(socket, request::ARM_END);
                        threads.drive_loop = id.ok().and_then(|id| id.parse().ok());
                    }
                    [request::DISARM] => armed = false,
                    [request::ASK] => socket.write_all(&[answer::IDLE])?,
                    // A heartbeat.
                    _ => {}
                }
            }
            Err(error) => match error.kind() {
                io::ErrorKind::Interrupted => {}
                io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => {
                    let elapsed = silence.checked.elapsed();
                    // Between heartbeats in time nothing is read of the parent.
                    let is_overdue = silence.total + elapsed > 2 * HEARTBEAT;
                    silence.add(elapsed, is_overdue && threads.is_delayed(elapsed));
                    if silence.is_alarm() {
                        return Ok(Some(false));
                    }
                }
                // The parent died with unread answers.
                _ => return Ok(armed.then_some(true)),
            },
        }
    }
}

/// Time without heartbeats.
#[derive(Clone, Copy, Debug)]
struct Silence {
    /// The latest check of the parent.
    checked: Instant,
    /// In all.
    total: Duration,
    /// Time in which the drive loop could run.
    counted: Duration,
}

impl Default for Silence {
    fn default() -> Self {
        Self {
            checked: Instant::now(),
            total: Duration::ZERO,
            counted: Duration::ZERO,
        }
    }
}

impl Silence {
    /// Adds the time since the latest check, in which the machine may have delayed the parent.
    fn add(&mut self, elapsed: Duration, is_delayed: bool) {
        self.checked += elapsed;
        self.total += elapsed;
        if !is_delayed {
            self.counted += elapsed.min(MAX_COUNTED);
        }
    }

    fn is_alarm(&self) -> bool {
        self.counted >= SILENCE_LIMIT || self.total >= OVERLOAD_LIMIT
    }
}

#[cfg(test)]
#[path = "guardian_tests.rs"]
mod tests;
