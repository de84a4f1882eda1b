//! The simulated scanner in real time: a thread that advances a [`sim::Rig`] with the host's clock,
//! answers on a pseudo-terminal and sends lidar packets over loopback.

use std::net::{Ipv4Addr, UdpSocket};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

use io::port::{Port, PortError, Pty};
use scanner::ScanConfig;
use scanner::config::MountConfig;
use sim::sensor::LidarMount;
use sim::{Rig, RigConfig, Truth};
use thiserror::Error;
use units::{Host, Span, Stamp};

use crate::devices::lidar_sockets::DATA_PORT;
pub use crate::devices::simulated_axis::node;
use crate::failure::{Failure, Kind};

/// Local ports of the simulated lidar's packets.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct LidarPorts {
    /// Local port that receives data packets.
    pub data: u16,
    /// Local port that receives position packets.
    pub position: u16,
}

/// A running simulated scanner.
pub struct SimulatedDevices {
    /// Serial port of the simulated drive.
    pub port: PathBuf,
    stop: Arc<AtomicBool>,
    requests: Sender<SimulatorRequest>,
    thread: JoinHandle<Result<Truth, SimulatorError>>,
}

/// Requests to the thread.
enum SimulatorRequest {
    /// Requests the truth so far.
    Truth(Sender<Truth>),
    /// Drops the truth before this time.
    Forget(Stamp<Host>),
}

/// Reason for which the devices stopped.
#[derive(Debug, Error)]
enum SimulatorError {
    #[error("pseudo-terminal: {0}")]
    Port(#[from] PortError),
    #[error("loopback socket: {0}")]
    Socket(#[from] std::io::Error),
}

/// Longest sleep: the drive's control cycle.
const CYCLE: Span = Span::from_millis(1);
/// On a busy machine device time runs slower. Otherwise the devices would catch up in ever longer
/// steps and meanwhile answer nothing, not even a stop.
const LONGEST_STEP: Span = Span::from_millis(500);

impl SimulatedDevices {
    /// Starts the devices. They run until [`SimulatedDevices::stop`].
    ///
    /// # Errors
    /// Returns a failure if the machine provides no pseudo-terminal or socket.
    pub fn start(config: RigConfig, to: LidarPorts) -> Result<Self, Failure> {
        let cannot = |what: &str, error: &dyn std::fmt::Display| {
            Failure::new(Kind::NoDevice, format!("the simulator cannot open {what}: {error}"))
                .help("see whether this machine gives out pseudo-terminals (/dev/ptmx) and loopback sockets")
        };
        let pty = Pty::open().map_err(|error| cannot("a pseudo-terminal", &error))?;
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))
            .map_err(|error| cannot("a loopback socket", &error))?;
        let port = pty.path().to_owned();
        let stop = Arc::new(AtomicBool::new(false));
        let stopping = Arc::clone(&stop);
        let (requests, inbox) = channel();
        let thread = std::thread::Builder::new()
            .name("simulated scanner".to_owned())
            .spawn(move || run(Rig::new(config), pty, (&socket, to), &stopping, &inbox))
            .map_err(|error| cannot("a thread", &error))?;
        Ok(Self {
            port,
            stop,
            requests,
            thread,
        })
    }

    /// The truth so far; `None` if the devices have failed.
    #[must_use]
    pub fn truth(&self) -> Option<Truth> {
        let (answer, truth) = channel();
        self.requests.send(SimulatorRequest::Truth(answer)).ok()?;
        truth.recv().ok()
    }

    /// Drops the truth before `host`: the devices may run for days.
    pub fn forget_before(&self, host: Stamp<Host>) {
        // Devices that have failed hold no truth.
        let _ = self.requests.send(SimulatorRequest::Forget(host));
    }

    /// Whether the devices have failed.
    #[must_use]
    pub fn failed(&self) -> bool {
        self.thread.is_finished()
    }

    /// Stops the devices and returns the truth.
    ///
    /// # Errors
    /// Returns the failure of the devices.
    pub fn stop(self) -> Result<Truth, Failure> {
        self.stop.store(true, Ordering::Relaxed);
        let failed = |why: String| {
            Failure::new(Kind::DeviceFault, format!("the simulator failed: {why}"))
                .help("run with -vv and report the messages; the log of what came before is kept")
        };
        match self.thread.join() {
            Ok(Ok(truth)) => Ok(truth),
            Ok(Err(error)) => Err(failed(error.to_string())),
            Err(_) => Err(failed("its thread panicked".to_owned())),
        }
    }
}

fn run(
    mut rig: Rig,
    mut pty: Pty,
    (socket, to): (&UdpSocket, LidarPorts),
    stop: &AtomicBool,
    requests: &Receiver<SimulatorRequest>,
) -> Result<Truth, SimulatorError> {
    let mut buffer = [0; 512];
    while !stop.load(Ordering::Relaxed) {
        while let Ok(request) = requests.try_recv() {
            match request {
                // A client that has ended needs no answer.
                SimulatorRequest::Truth(answer) => drop(answer.send(rig.truth())),
                SimulatorRequest::Forget(host) => rig.forget_before(host),
            }
        }
        let now = io::clock::now();
        let nap = rig
            .next_event()
            .saturating_since(now)
            .clamp(Span::ZERO, CYCLE);
        let read = pty.read(&mut buffer, nap)?.map_or(0, |(count, _)| count);
        rig.advance(io::clock::now().min(rig.now() + LONGEST_STEP));
        rig.drive_input(buffer.get(..read).unwrap_or_default());
        while let Some(sent) = rig.drive_output() {
            pty.write_frame(&sent.bytes)?;
        }
        while let Some(datagram) = rig.poll_datagram() {
            let port = if datagram.port == DATA_PORT {
                to.data
            } else {
                to.position
            };
            socket.send_to(&datagram.payload, (Ipv4Addr::LOCALHOST, port))?;
        }
    }
    Ok(rig.truth())
}

/// The simulated scanner of an axis: its drive, and the lidar at 10 Hz in the hall, started at
/// `start`.
#[must_use]
pub fn rig(axis: &drive::AxisConfig, scan: &ScanConfig, start: Stamp<Host>) -> RigConfig {
    RigConfig {
        mount: lidar_mount(scan.mount),
        gearing: axis.gearing,
        drive: node(axis),
        ..RigConfig::new(start)
    }
}

fn lidar_mount(mount: MountConfig) -> LidarMount {
    let mount = mount.mount();
    LidarMount::at(mount.position_m(), mount.rotation_deg())
}
