//! A simulated drive in this process, with a record of its true motion, and a lidar that sends the
//! same packet again and again. Both survive any death of the program under test.

use std::fs;
use std::net::{Ipv4Addr, UdpSocket};
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use engine::config::AxisSettings;
use engine::devices::profile;
use engine::devices::simulated;
use engine::devices::simulated_drive::{SimulatedPort, run_observed};
use firmware_sim::epos2::{BrakeState, SimulatedDrive};
use io::can::SocketCan;
use io::port::Pty;
use protocol::epos2::cia402::DeviceState;
use sim::Attachment;
use tempfile::TempDir;
use units::{Host, Span, Stamp};

/// The CAN interface, of tests/foreign/vcan/in-vm.
const BUS: &str = "vcan0";
/// Every awaited condition comes sooner, or never.
const LIMIT: Duration = Duration::from_secs(60);
/// A longer time without a control cycle is a stall of the machine.
const STALL: Duration = Duration::from_millis(20);
/// Between two packets of the lidar.
const PACKET: Duration = Duration::from_millis(5);

/// State of the axis, recorded when it changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisState {
    pub at: Stamp<Host>,
    /// Position of the shaft, quadcounts with 32 fractional bits.
    position: i128,
    pub powered: bool,
    pub brake: BrakeState,
}

/// The record, and the time that it reaches to.
#[derive(Default)]
struct AxisRecord {
    states: Vec<AxisState>,
    now: Option<Stamp<Host>>,
    /// When the last state was recorded, and times that the machine did not run this thread.
    last: Option<Instant>,
    longest_delay: Duration,
    stalls: Vec<(Stamp<Host>, Span)>,
}

/// What the axis did after a signal.
#[derive(Clone, Copy, Debug)]
pub struct Aftermath {
    pub moving_at_signal: bool,
    pub powered_at_signal: bool,
    /// From the signal to the last motion and to power off, within the second.
    pub standstill: Duration,
    pub power_off: Duration,
    pub moves: bool,
    pub powered: bool,
    pub brake: BrakeState,
}

/// Devices that run until dropped.
pub struct Bench {
    pub folder: TempDir,
    record: Arc<Mutex<AxisRecord>>,
    stop: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Bench {
    /// Starts the devices, and writes the configuration of the axis described by `axis` (TOML).
    pub fn start(transport: &str, axis: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (port, name) = match transport {
            "can" => {
                let bus = SocketCan::open(BUS).unwrap();
                (SimulatedPort::Can(bus), format!("interface = '{BUS}'"))
            }
            _ => {
                let pty = Pty::open().unwrap();
                let port = format!("port = '{}'", pty.path().display());
                (SimulatedPort::Serial(pty), port)
            }
        };
        let lidar = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let free = |_| UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let ports = [0, 1].map(free).map(|s| s.local_addr().unwrap().port());
        let text = format!(
            "[device]\ndefault = 'soft'\n[device.soft]\nkind = '{transport}'\n{name}\nlidar = '127.0.0.1'\n\
             data_port = {}\nposition_port = {}\n[daemon]\nscans = '{}'\nreserve_bytes = 1000\n[axis]\n{axis}",
            ports[0],
            ports[1],
            folder.path().join("scans").display(),
        );
        fs::write(folder.path().join("velomotion.toml"), text).unwrap();
        let settings: AxisSettings = toml::from_str(axis).unwrap();
        let node = simulated::node(&profile::axis(&settings).unwrap());
        let attachment = match transport {
            "usb" => Attachment::Usb,
            "rs232" => Attachment::Rs232,
            "can" => Attachment::Can,
            _ => Attachment::Slcan,
        };
        let (record, stop) = (
            Arc::<Mutex<AxisRecord>>::default(),
            Arc::<AtomicBool>::default(),
        );
        let (shared, stopping) = (Arc::clone(&record), Arc::clone(&stop));
        let drive = std::thread::spawn(move || {
            let mut observe =
                |at, node: &SimulatedDrive| observe(&mut shared.lock().unwrap(), at, node);
            run_observed(node, attachment, port, &stopping, &mut observe).unwrap();
        });
        let stopping = Arc::clone(&stop);
        let lidar = std::thread::spawn(move || {
            while !stopping.load(Ordering::Relaxed) {
                // The program may not listen yet.
                let _ = lidar.send_to(&[0xFF; 1206], (Ipv4Addr::LOCALHOST, ports[0]));
                std::thread::sleep(PACKET);
            }
        });
        Self {
            folder,
            record,
            stop,
            threads: vec![drive, lidar],
        }
    }

    /// The program under test in the bench's folder.
    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_velomotion"));
        command
            .args(line.split_whitespace())
            .current_dir(self.path())
            .env("XDG_RUNTIME_DIR", self.path())
            .env_remove("RUNTIME_DIRECTORY");
        command
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Runs a command to its end, which must succeed.
    pub fn run(&self, line: &str) -> Result<(), String> {
        let output = self.command(line).output().map_err(|e| e.to_string())?;
        match output.status.success() {
            true => Ok(()),
            false => Err(format!(
                "{line}: {}",
                String::from_utf8_lossy(&output.stderr)
            )),
        }
    }

    /// Forgets the past motion.
    pub fn forget(&self) {
        let mut record = self.record.lock().unwrap();
        let last = record.states.pop();
        record.states.clear();
        record.stalls.clear();
        record.longest_delay = Duration::ZERO;
        record.states.extend(last);
    }

    /// Angle of the shaft from where the bench started, degrees.
    pub fn angle(&self) -> f64 {
        let record = self.record.lock().unwrap();
        record.states.last().map_or(0.0, degrees)
    }

    /// Whether the axis moves at more than this speed, degrees per second.
    pub fn moves_faster(&self, deg_s: f64) -> bool {
        let record = self.record.lock().unwrap();
        let mut last = record.states.iter().rev();
        let (Some(second), Some(first), Some(now)) = (last.next(), last.next(), record.now) else {
            return false;
        };
        let seconds = second.at.saturating_since(first.at).as_secs_f64();
        let current = now.saturating_since(second.at) < Span::from_millis(5);
        current && (degrees(second) - degrees(first)).abs() > deg_s * seconds
    }

    /// Whether power is off, or kept on where the axis is `held`, and nothing moves.
    pub fn is_safe(&self, held: bool) -> bool {
        let record = self.record.lock().unwrap();
        let Some((state, now)) = record.states.last().zip(record.now) else {
            return false;
        };
        (held || !state.powered) && now.saturating_since(state.at) > Span::from_millis(100)
    }

    /// Longest time since the record was forgotten that the machine did not run the drive.
    pub fn longest_stall(&self) -> Span {
        let record = self.record.lock().unwrap();
        let stalls = record.stalls.iter().map(|stall| stall.1);
        stalls.max().unwrap_or(Span::ZERO)
    }

    /// Longest time between two control cycles since the record was forgotten.
    pub fn longest_delay(&self) -> Duration {
        self.record.lock().unwrap().longest_delay
    }

    /// Waits until the record reaches a second beyond `signal`, and judges it. A busy machine that
    /// does not run the drive for a while does not run the program either: such times are added.
    pub fn aftermath(&self, signal: Stamp<Host>) -> Result<Aftermath, String> {
        let end = wait("the record of a second", || {
            let record = self.record.lock().unwrap();
            let after = |stall: &&(Stamp<Host>, Span)| stall.0 > signal;
            let stalls = record.stalls.iter().filter(after).map(|stall| stall.1);
            let end = stalls.fold(signal + Span::from_secs(1), |end, stall| {
                end + stall + stall
            });
            record.now.is_some_and(|now| now >= end).then_some(end)
        })?;
        let record = self.record.lock().unwrap();
        let before = record.states.iter().rev().find(|state| state.at <= signal);
        let before = *before.ok_or("no record before the signal")?;
        let within: Vec<&AxisState> = record
            .states
            .iter()
            .filter(|state| state.at > signal && state.at <= end)
            .collect();
        let since = |at: Stamp<Host>| {
            let ns = at.saturating_since(signal).as_nanos();
            Duration::from_nanos(u64::try_from(ns).unwrap_or(0))
        };
        let (mut last, mut standstill, mut power_off) = (before, Duration::ZERO, Duration::ZERO);
        for state in within {
            if state.position != last.position {
                standstill = since(state.at);
            }
            if last.powered && !state.powered {
                power_off = since(state.at);
            }
            last = *state;
        }
        let moving_at_signal = record.states.iter().any(|state| {
            let distance = state.at.saturating_since(signal).as_nanos().abs();
            distance <= Span::from_millis(2).as_nanos() && state.position != before.position
        });
        Ok(Aftermath {
            moving_at_signal,
            powered_at_signal: before.powered,
            standstill,
            power_off,
            // The last control cycles of the second.
            moves: standstill + Duration::from_millis(10) > since(end),
            powered: last.powered,
            brake: last.brake,
        })
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

fn observe(record: &mut AxisRecord, at: Stamp<Host>, node: &SimulatedDrive) {
    let state = AxisState {
        at,
        position: node.segment().end.into(),
        powered: matches!(
            node.state(),
            DeviceState::MeasureInit
                | DeviceState::OperationEnabled
                | DeviceState::QuickStopActive
                | DeviceState::FaultReactionEnabled
        ),
        brake: node.brake(),
    };
    record.now = Some(at);
    let now = Instant::now();
    if let Some(last) = record.last.replace(now) {
        let gap = now - last;
        record.longest_delay = record.longest_delay.max(gap);
        if gap > STALL {
            let ns = i64::try_from(gap.as_nanos()).unwrap_or(i64::MAX);
            record.stalls.push((at, Span::from_nanos(ns)));
        }
    }
    let changed = record
        .states
        .last()
        .is_none_or(|last| AxisState { at, ..*last } != state);
    if changed {
        record.states.push(state);
    }
}

/// Angle of the default axis: 500 lines, 120:1.
fn degrees(state: &AxisState) -> f64 {
    state.position as f64 / 2f64.powi(32) * 0.0015
}

/// Repeats `wanted` until it returns a value.
pub fn wait<T>(what: &str, mut wanted: impl FnMut() -> Option<T>) -> Result<T, String> {
    let begin = Instant::now();
    loop {
        if let Some(found) = wanted() {
            return Ok(found);
        }
        if begin.elapsed() > LIMIT {
            return Err(format!("timed out after {} s: {what}", LIMIT.as_secs()));
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}
