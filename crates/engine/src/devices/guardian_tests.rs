//! The guardian on a bad line, and a parent whose guardian fails.

use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use ::io::port::{PortError, Pty};
use drive::{CommandProgress, DriveCommand, DriveError, DriveEvent, MoveCommand};
use protocol::epos2::cia402::DeviceState;
use protocol::epos2::message::ReadObject;
use protocol::epos2::{objects, usb};
use sim::Attachment;
use units::{Degrees, Host, Rpm, RpmPerS, Stamp};

use super::*;
use crate::capture::jog;
use crate::devices::simulated;
use crate::devices::simulated_drive::{SimulatedPort, run_observed};
use crate::failure::Kind;

/// Ends the thread of a simulated drive, also after a panic: a scope waits for its threads.
struct StopOnDrop<'a>(&'a AtomicBool);

impl Drop for StopOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// A line that a test writes on and reads from without a drive.
struct BadLine {
    /// Reads fail instead of returning noise.
    fails: bool,
    began: Instant,
    /// Bytes of the first write, and when it came.
    first: Arc<Mutex<Option<FirstWrite>>>,
}

type FirstWrite = (Duration, Vec<u8>);

impl Port for BadLine {
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        let mut first = self.first.lock().unwrap();
        first.get_or_insert_with(|| (self.began.elapsed(), frame.to_vec()));
        Ok(self.now())
    }

    fn read(
        &mut self,
        buffer: &mut [u8],
        _: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
        // A machine reads noise at the rate of its line.
        std::thread::sleep(Duration::from_micros(100));
        if self.fails {
            return Err(PortError::Disconnected {
                port: "bad".to_owned(),
                reason: "a loose contact".to_owned(),
            });
        }
        buffer[..16].fill(0x55);
        Ok(Some((16, self.now())))
    }
}

/// What the guardian writes first, and when.
fn first_write(fails: bool) -> FirstWrite {
    let first = Arc::default();
    let line = BadLine {
        fails,
        began: Instant::now(),
        first: Arc::clone(&first),
    };
    let stop = std::thread::spawn(move || stop(drive::AxisConfig::default(), DriveLink::Usb, line));
    let begin = Instant::now();
    let written = loop {
        if let Some(written) = first.lock().unwrap().clone() {
            break written;
        }
        assert!(begin.elapsed() < Duration::from_secs(5), "nothing written");
        std::thread::sleep(Duration::from_millis(1));
    };
    assert!(stop.join().unwrap().is_err(), "a stop without an answer");
    written
}

#[test]
fn the_guardian_sends_the_quick_stop_into_endless_noise() {
    let (after, bytes) = first_write(false);
    // 6040 = 0B to node 1.
    assert_eq!(bytes[..10], [0x90, 2, 0x11, 4, 0x40, 0x60, 0, 1, 0x0B, 0]);
    // The machine may be busy: the bound is 20 ms.
    assert!(after < Duration::from_millis(500), "{after:?}");
}

#[test]
fn the_guardian_sends_the_quick_stop_after_a_read_error() {
    let (_, bytes) = first_write(true);
    assert_eq!(bytes[..10], [0x90, 2, 0x11, 4, 0x40, 0x60, 0, 1, 0x0B, 0]);
}

/// A line on which the first answer arrives late.
struct LateLine {
    line: SerialPort,
    /// The first answer, and when a program may read it.
    late: Option<(Instant, Vec<u8>)>,
    has_answered: bool,
}

const LATE: Duration = Duration::from_millis(150);

impl Port for LateLine {
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        self.line.write_frame(frame)
    }

    fn read(
        &mut self,
        buffer: &mut [u8],
        wait: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
        let now = Instant::now();
        if let Some((_, bytes)) = self.late.take_if(|(due, _)| *due <= now) {
            buffer[..bytes.len()].copy_from_slice(&bytes);
            return Ok(Some((bytes.len(), self.now())));
        }
        let read = self.line.read(buffer, wait)?;
        match read {
            Some((count, _)) if !self.has_answered => {
                self.has_answered = true;
                self.late = Some((now + LATE, buffer[..count].to_vec()));
                Ok(None)
            }
            _ => Ok(read),
        }
    }
}

/// The answer to the parent's last request arrives while the guardian waits for others.
#[test]
fn the_guardian_stops_an_axis_though_an_answer_to_its_parent_is_late() {
    let axis = drive::AxisConfig::default();
    let pty = Pty::open().unwrap();
    let mut line = SerialPort::open(pty.path(), 1_000_000).unwrap();
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let port = SimulatedPort::Serial(pty);
            let node = simulated::node(&axis);
            run_observed(node, Attachment::Usb, port, &is_over, &mut |_, _| {}).unwrap();
        });
        let over = StopOnDrop(&is_over);
        let read = ReadObject {
            node: 1,
            address: objects::POSITION_ACTUAL.address,
        };
        let request = usb::to_bytes(&read.to_frame());
        line.write_frame(&request).unwrap();
        let late = LateLine {
            line,
            late: None,
            has_answered: false,
        };
        let stopped = stop(axis.clone(), DriveLink::Usb, late);
        drop(over);
        stopped.unwrap();
    });
}

/// Silence until the alarm, with checks at this interval, and a machine that delays the program at
/// some of them.
fn silence_until_alarm(interval_ms: u64, is_delayed: impl Fn(Duration) -> bool) -> Duration {
    let mut silence = Silence::default();
    while !silence.is_alarm() {
        let elapsed = Duration::from_millis(interval_ms);
        silence.add(elapsed, is_delayed(silence.total));
    }
    silence.total
}

#[test]
fn a_silent_program_is_found_after_half_a_second() {
    let found = silence_until_alarm(20, |_| false);
    assert_eq!(found, SILENCE_LIMIT);
}

/// 2.2 s, the longest measured; the program is stuck after that.
#[test]
fn time_in_which_the_machine_delays_the_program_does_not_count() {
    let stall = Duration::from_millis(2_200);
    let found = silence_until_alarm(20, |at| at < stall);
    assert_eq!(found, stall + SILENCE_LIMIT);
    let endless = silence_until_alarm(20, |_| true);
    assert_eq!(endless, OVERLOAD_LIMIT);
}

/// The whole machine stands still, and with it the guardian: one interval of 2 s is no silence of
/// 2 s.
#[test]
fn a_delay_of_the_guardian_itself_counts_little() {
    let found = silence_until_alarm(1_000, |_| false);
    assert_eq!(found, OVERLOAD_LIMIT);
    let mut silence = Silence::default();
    silence.add(Duration::from_secs(2), false);
    assert!(!silence.is_alarm());
}

/// A guardian that is asked a third time, in the move, answers with these words of a shell.
fn script(answer: &str) -> String {
    format!(
        "#!/bin/sh\nread setup\nasked=0\nwhile :; do\n  byte=$(dd bs=1 count=1 2>/dev/null)\n  \
         case \"$byte\" in\n  '') exit ;;\n  '?') asked=$((asked + 1))\n    \
         [ $asked -lt 3 ] && printf . >&0 && continue\n    {answer}\n    exit ;;\n  esac\ndone\n"
    )
}

/// Writes a program. Another process does: a process that another thread of this one starts at the
/// same time would hold the file open for writing, and no such file can be executed (ETXTBSY).
fn write_program(path: &Path, text: &str) {
    let write = r#"cat >"$0" && chmod 755 "$0""#;
    let mut shell = Command::new("sh");
    shell.args(["-c", write]).arg(path).stdin(Stdio::piped());
    let mut shell = shell.spawn().unwrap();
    let written = shell.stdin.take().unwrap().write_all(text.as_bytes());
    written.unwrap();
    assert!(shell.wait().unwrap().success());
}

/// A move in which this process is silent for 0.3 s, and whose guardian answers so. Returns the
/// error and whether the axis has power in the end.
fn move_with_guardian(answer: &str) -> (SessionError, bool) {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("guardian");
    write_program(&program, &script(answer));
    let settings = AxisSettings::default();
    let axis = profile::axis(&settings).unwrap();
    let pty = Pty::open().unwrap();
    let port = SerialPort::open(pty.path(), 1_000_000).unwrap();
    let (stop, powered) = (AtomicBool::new(false), AtomicBool::new(false));
    let error = std::thread::scope(|scope| {
        scope.spawn(|| {
            let node = simulated::node(&axis);
            let port = SimulatedPort::Serial(pty);
            let mut observe = |_, node: &firmware_sim::epos2::SimulatedDrive| {
                let is_on = node.state() == DeviceState::OperationEnabled;
                powered.store(is_on, Ordering::Relaxed);
            };
            run_observed(node, Attachment::Usb, port, &stop, &mut observe).unwrap();
        });
        let over = StopOnDrop(&stop);
        let mut guardian = Guardian::start(&program, &port, DriveLink::Usb, &settings).unwrap();
        let client = DriveClient::new(axis.clone(), DriveLink::Usb);
        let mut session =
            Session::new(client, port, Arc::default()).guarded_by(Some(&mut guardian));
        session.run(DriveCommand::Connect, &mut |_| {}).unwrap();
        let homed = session.run(DriveCommand::Home, &mut |_| {});
        let error = homed.and_then(|_| {
            let across = MoveCommand {
                to: Degrees(-40.0),
                speed: Rpm(100),
                acceleration: RpmPerS(2_000),
            };
            session.run(DriveCommand::Goto(across), &mut |event| {
                if let DriveEvent::Progress(CommandProgress::Moving(_)) = event {
                    std::thread::sleep(Duration::from_millis(300));
                }
            })
        });
        drop(session);
        // The guardian's word counts in the next control cycles.
        std::thread::sleep(Duration::from_millis(50));
        drop(over);
        error.unwrap_err()
    });
    (error, powered.load(Ordering::Relaxed))
}

#[test]
fn a_process_stops_the_axis_that_its_guardian_could_not_stop() {
    let report = r#"{"parent_died":false,"failure":"the line is noisy"}"#;
    let (error, powered) = move_with_guardian(&format!("printf '!%s\\n' '{report}' >&0"));
    assert!(!error.may_move(), "{error}");
    let text = error.to_string();
    for part in ["the line is noisy", "this program has stopped the axis"] {
        assert!(text.contains(part), "{text}");
    }
    assert!(!powered, "{text}");
}

#[test]
fn a_process_stops_the_axis_whose_guardian_ends_without_a_report() {
    let (error, powered) = move_with_guardian("printf '!' >&0");
    assert!(!error.may_move(), "{error}");
    assert!(error.to_string().contains("has not reported"), "{error}");
    assert!(!powered, "{error}");
}

#[test]
fn a_motion_is_interrupted_only_where_the_axis_is_known_to_be_at_rest() {
    let report = |failure: Option<&str>| GuardianReport {
        parent_died: false,
        failure: failure.map(str::to_owned),
    };
    for (report, kind) in [
        (Some(report(None)), Kind::Interrupted),
        (Some(report(Some("the line is noisy"))), Kind::DeviceFault),
        (None, Kind::DeviceFault),
    ] {
        let gap = Duration::from_secs(1);
        let error = SessionError::Guardian(GuardianError::Acted { gap, report });
        assert_eq!(error.kind(), kind, "{error}");
        assert_eq!(jog::failure(&error).kind, kind);
    }
    let fault = || DriveError::HostNotMonitored;
    let moving = DriveError::NotStopped {
        cause: Box::new(fault()),
        stop: Box::new(fault()),
    };
    for error in [
        SessionError::NotStopped(fault()),
        SessionError::Drive(moving),
    ] {
        assert_eq!(error.kind(), Kind::DeviceFault);
    }
    assert_eq!(SessionError::Interrupted.kind(), Kind::Interrupted);
}
