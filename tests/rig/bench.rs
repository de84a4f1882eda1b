//! A simulated scanner in real time that a daemon takes for hardware: a drive on a pseudo-terminal,
//! a lidar on loopback, and faults on demand.
//!
//! It lives in the test's process. Killing a daemon does not end it, its cable can be unplugged
//! while its motor moves, and the drive's state can be read without using its line.

use std::net::{Ipv4Addr, UdpSocket};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use engine::config::{AxisSettings, Config, Device, DeviceKind, Devices};
use engine::devices::lidar_sockets::DATA_PORT;
use engine::devices::profile as devices;
use engine::devices::simulated;
use io::port::{Port, Pty};
use sim::{Rig, RigConfig};
use tempfile::TempDir;
use units::Span;

use crate::drive::{is_powered, moves};

/// Age at which truth is dropped: a bench may run for hours.
const MEMORY: Span = Span::from_secs(1);

/// Longest device time between two reads of the drive's line. On a busy machine device time runs
/// slower, and the devices still answer.
const SLICE: Span = Span::from_millis(20);

/// Faults that the test sets, and the state of the axis.
#[derive(Default)]
struct Controls {
    stop: AtomicBool,
    held: AtomicBool,
    unplugged: AtomicBool,
    silent: AtomicBool,
    lose: AtomicU64,
    moves: AtomicBool,
    moved: AtomicBool,
    powered: AtomicBool,
}

/// Devices that run until dropped.
pub struct Bench {
    folder: TempDir,
    ports: (u16, u16),
    controls: Arc<Controls>,
    thread: Option<JoinHandle<()>>,
}

impl Bench {
    /// Starts the devices.
    ///
    /// # Panics
    /// Panics if this machine provides no pseudo-terminal, socket or folder.
    #[must_use]
    pub fn start() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let ports = (free_port(), free_port());
        let rig = RigConfig {
            drive: simulated::node(&devices::axis(&axis()).unwrap()),
            ..RigConfig::new(io::clock::now())
        };
        let controls = Arc::new(Controls::default());
        let (theirs, link) = (Arc::clone(&controls), folder.path().join("epos"));
        // The port exists on return.
        let cable = plug(&link);
        let thread = std::thread::spawn(move || run(Rig::new(rig), (cable, &link), ports, &theirs));
        Self {
            folder,
            ports,
            controls,
            thread: Some(thread),
        }
    }

    /// The drive's port while it is plugged in.
    #[must_use]
    pub fn link(&self) -> PathBuf {
        self.folder.path().join("epos")
    }

    /// UDP ports of data and position packets.
    #[must_use]
    pub fn ports(&self) -> (u16, u16) {
        self.ports
    }

    /// A configuration that names the devices.
    #[must_use]
    pub fn config(&self) -> Config {
        let device = Device {
            kind: DeviceKind::Usb,
            port: Some(self.link()),
            data_port: Some(self.ports.0),
            position_port: Some(self.ports.1),
            accel_deg_s2: 5_000.0,
            ..Device::simulator()
        };
        Config {
            device: Devices {
                default: Some("bench".to_owned()),
                profiles: [("bench".to_owned(), device)].into(),
            },
            axis: axis(),
            ..Config::default()
        }
    }

    /// Blocks the axis, or releases it.
    pub fn hold(&self, held: bool) {
        self.controls.held.store(held, Ordering::Release);
    }

    /// Unplugs the drive's cable, or plugs it in.
    pub fn unplug(&self, gone: bool) {
        self.controls.unplugged.store(gone, Ordering::Release);
    }

    /// Silences the lidar, or ends its silence.
    pub fn silence(&self, silent: bool) {
        self.controls.silent.store(silent, Ordering::Release);
    }

    /// Drops every n-th packet; 0 drops none.
    pub fn lose(&self, every: u64) {
        self.controls.lose.store(every, Ordering::Release);
    }

    /// Whether the axis is at rest with its power stage off.
    #[must_use]
    pub fn is_safe(&self) -> bool {
        let on = |flag: &AtomicBool| flag.load(Ordering::Acquire);
        !on(&self.controls.moves) && !on(&self.controls.powered)
    }

    /// Whether the axis has ever moved.
    #[must_use]
    pub fn has_moved(&self) -> bool {
        self.controls.moved.load(Ordering::Acquire)
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.controls.stop.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Axis settings with the brake of the repository's configuration.
fn axis() -> AxisSettings {
    AxisSettings {
        brake_output: Some(1),
        ..AxisSettings::default()
    }
}

/// A free UDP port.
///
/// # Panics
/// Panics if this machine provides no socket.
#[must_use]
pub fn free_port() -> u16 {
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    socket.local_addr().unwrap().port()
}

/// Opens a pseudo-terminal behind the link.
fn plug(link: &Path) -> Pty {
    let pty = Pty::open().unwrap();
    let _ = std::fs::remove_file(link);
    std::os::unix::fs::symlink(pty.path(), link).unwrap();
    pty
}

fn run(mut rig: Rig, (cable, link): (Pty, &Path), ports: (u16, u16), controls: &Controls) {
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let (mut cable, mut holding) = (Some(cable), false);
    let (mut buffer, mut sent) = ([0; 512], 0);
    while !controls.stop.load(Ordering::Acquire) {
        match (controls.unplugged.load(Ordering::Acquire), cable.is_some()) {
            (true, true) => {
                cable = None;
                let _ = std::fs::remove_file(link);
            }
            (false, false) => cable = Some(plug(link)),
            _ => {}
        }
        let nap = rig.next_event().saturating_since(io::clock::now());
        let nap = nap.clamp(Span::ZERO, Span::from_millis(1));
        let read = match &mut cable {
            Some(pty) => pty.read(&mut buffer, nap).unwrap(),
            None => {
                std::thread::sleep(Duration::from_millis(1));
                None
            }
        };
        rig.advance(io::clock::now().min(rig.now() + SLICE));
        if controls.held.load(Ordering::Acquire) != holding {
            holding = !holding;
            match holding {
                true => rig.drive_mut().block(),
                false => rig.drive_mut().unblock(),
            }
        }
        rig.drive_input(&buffer[..read.map_or(0, |(count, _)| count)]);
        while let Some(answer) = rig.drive_output() {
            if let Some(pty) = &mut cable {
                // A disconnected client reads nothing.
                let _ = pty.write_frame(&answer.bytes);
            }
        }
        store_state(&mut rig, controls);
        while let Some(datagram) = rig.poll_datagram() {
            sent += 1;
            if !is_lost(sent, controls) {
                let port = match datagram.port {
                    DATA_PORT => ports.0,
                    _ => ports.1,
                };
                // The daemon may not listen yet.
                let _ = socket.send_to(&datagram.payload, (Ipv4Addr::LOCALHOST, port));
            }
        }
        rig.forget_before(rig.now() - MEMORY);
    }
}

fn store_state(rig: &mut Rig, controls: &Controls) {
    let node = rig.drive_mut();
    let now = moves(node);
    controls.moves.store(now, Ordering::Release);
    controls.moved.fetch_or(now, Ordering::AcqRel);
    controls.powered.store(is_powered(node), Ordering::Release);
}

fn is_lost(number: u64, controls: &Controls) -> bool {
    let every = controls.lose.load(Ordering::Acquire);
    controls.silent.load(Ordering::Acquire) || (every > 0 && number.is_multiple_of(every))
}
