//! Opens the drive's port by the device's profile, with help if that fails.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use io::can::{CanError, CanPort, Slcan, SocketCan};
use io::discover::ConnectedDevices;
use io::port::{LatencyTimer, Port, PortError, SerialPort};
use protocol::canopen::CanFrame;
use protocol::canopen::slcan::Bitrate;
use protocol::record::DriveLink;
use units::{Host, Span, Stamp};

use super::guardian::Guardian;
use crate::config::{AxisSettings, Device, DeviceKind};
use crate::failure::{Failure, Kind};

/// EPOS2 on USB: 1 Mbaud by the Communication Guide.
const USB_BAUD: u32 = 1_000_000;
/// EPOS2 on RS232 from the factory; older firmware has 38,400.
const RS232_BAUD: u32 = 115_200;
/// SLCAN adapters on USB ignore the rate; those on a real line mostly have this one.
const SLCAN_BAUD: u32 = 115_200;
/// Longest wait for a port in use.
const BUSY_WAIT: Duration = Duration::from_secs(2);
/// Short, so that a waiting move gets the port between two commands of a loop that reads the state.
const BUSY_POLL: Duration = Duration::from_millis(2);

/// An open port of the drive.
pub struct OpenPort {
    /// Stops the axis if this process dies. Dropped before the port, which it shares.
    pub guardian: Option<Guardian>,
    /// Bytes of a serial line, or 16 bytes per frame of a bus.
    pub port: Box<dyn Port>,
    /// Attachment of the drive.
    pub link: DriveLink,
    /// Speed of an RS232 line.
    pub rs232_baud: Option<u32>,
    /// Warning about the port.
    pub warning: Option<String>,
}

/// Options for the start of a guardian.
#[derive(Clone, Copy, Debug)]
pub struct GuardianOptions<'a> {
    /// The program, which runs [`guardian::run`](super::guardian::run) if it is started with
    /// [`guardian::ARGUMENT`](super::guardian::ARGUMENT).
    pub program: &'a Path,
    /// The axis.
    pub axis: &'a AxisSettings,
}

/// Duration of the search for a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// The caller searches once.
    Once,
    /// The caller keeps searching.
    UntilFound,
}

/// The address of a profile's drive: the path of a serial port or the name of a CAN interface. A
/// drive that is searched for is among the `plugged` devices.
///
/// # Errors
/// Returns [`Kind::BadInput`] if the profile names no port, [`Kind::NoDevice`] if none is found.
pub fn port_path(
    name: &str,
    device: &Device,
    search: Search,
    plugged: &dyn Fn() -> ConnectedDevices,
) -> Result<PathBuf, Failure> {
    if device.is_looked_for() {
        return found(&plugged(), search);
    }
    let (named, key, example) = match device.kind {
        DeviceKind::Can => (
            device.interface.as_ref().map(PathBuf::from),
            "interface",
            "can0",
        ),
        _ => (device.port.clone(), "port", "/dev/ttyUSB0"),
    };
    named.ok_or_else(|| {
        Failure::new(
            Kind::BadInput,
            format!(
                "device {name} is of kind {} but names no {key}",
                format!("{:?}", device.kind).to_lowercase()
            ),
        )
        .help(format!(
            "add {key} = \"{example}\" (or its actual value) to [device.{name}] of the configuration"
        ))
    })
}

/// The EPOS2's serial port on USB.
fn found(plugged: &ConnectedDevices, search: Search) -> Result<PathBuf, Failure> {
    if let Some(port) = plugged.epos2.iter().find_map(|unit| unit.port.clone()) {
        return Ok(port);
    }
    let ports: Vec<String> = plugged
        .serial_ports
        .iter()
        .map(|port| port.path.display().to_string())
        .collect();
    let ports = match ports.as_slice() {
        [] => "none".to_owned(),
        ports => ports.join(", "),
    };
    let what = "an EPOS2 (USB 0403:A8B0) with a serial port";
    let message = match search {
        Search::Once => {
            format!("no tilt drive: looked for {what} and found none (serial ports: {ports})")
        }
        Search::UntilFound => {
            format!("no drive found yet: looking for {what} (serial ports: {ports})")
        }
    };
    let help = match (plugged.epos2.is_empty(), search) {
        (true, Search::Once) => {
            "plug the EPOS2 in and switch it on, or name its port in a [device.NAME] of the configuration,\n\
             or use --device sim for simulated devices"
        }
        (true, Search::UntilFound) => {
            "plug the EPOS2 in and switch it on: it is connected as soon as it is there\n\
             velomotion doctor lists what is there; a drive that is not on USB needs a [device.NAME] of the configuration"
        }
        (false, _) => {
            "an EPOS2 is plugged in, but Linux's ftdi_sio does not know its USB id and makes no port of it. As root:\n\
             modprobe ftdi_sio && echo 0403 a8b0 > /sys/bus/usb-serial/drivers/ftdi_sio/new_id"
        }
    };
    Err(Failure::new(Kind::NoDevice, message).help(help))
}

/// Opens the port of a device at `place`. The simulated scanner's is a USB drive on a
/// pseudo-terminal.
///
/// # Errors
/// Returns [`Kind::Busy`] for a port in use, else [`Kind::NoDevice`].
pub fn open(
    device: &Device,
    place: &Path,
    guarding: Option<&GuardianOptions<'_>>,
) -> Result<OpenPort, Failure> {
    let serial = |baud: u32| {
        open_serial(place, device.baud.unwrap_or(baud)).map_err(|error| failure(&error))
    };
    let opened = |port: Box<dyn Port>, link| OpenPort {
        guardian: None,
        port,
        link,
        rs232_baud: None,
        warning: None,
    };
    Ok(match device.kind {
        // Simulated devices end with this process.
        DeviceKind::Sim => opened(Box::new(serial(USB_BAUD)?), DriveLink::Usb),
        DeviceKind::Usb => {
            let port = serial(USB_BAUD)?;
            let (guardian, unguarded) = start_guardian(&port, DriveLink::Usb, guarding);
            let warnings: Vec<String> = [slow_answers(port.latency), unguarded]
                .into_iter()
                .flatten()
                .collect();
            OpenPort {
                guardian,
                warning: (!warnings.is_empty()).then(|| warnings.join("; ")),
                ..opened(Box::new(port), DriveLink::Usb)
            }
        }
        DeviceKind::Rs232 => {
            let port = serial(RS232_BAUD)?;
            let (guardian, warning) = start_guardian(&port, DriveLink::Rs232, guarding);
            OpenPort {
                guardian,
                warning,
                rs232_baud: Some(device.baud.unwrap_or(RS232_BAUD)),
                ..opened(Box::new(port), DriveLink::Rs232)
            }
        }
        DeviceKind::Slcan => {
            let bus = Slcan::open(serial(SLCAN_BAUD)?, Bitrate::Kbit1000)
                .map_err(|error| can_failure(place, &error))?;
            opened(Box::new(BusLine(bus)), DriveLink::Can)
        }
        DeviceKind::Can => {
            let bus = SocketCan::open(&place.to_string_lossy())
                .map_err(|error| can_failure(place, &error))?;
            opened(Box::new(BusLine(bus)), DriveLink::Can)
        }
    })
}

/// Opens a serial port. One in use may be that of a guardian that stops the axis: it is free soon.
fn open_serial(place: &Path, baud: u32) -> Result<SerialPort, PortError> {
    let deadline = Instant::now() + BUSY_WAIT;
    loop {
        match SerialPort::open(place, baud) {
            Err(PortError::Busy { .. }) if Instant::now() < deadline => {
                std::thread::sleep(BUSY_POLL);
            }
            opened => return opened,
        }
    }
}

/// Starts the guardian of a port, or returns a warning.
fn start_guardian(
    port: &SerialPort,
    link: DriveLink,
    options: Option<&GuardianOptions<'_>>,
) -> (Option<Guardian>, Option<String>) {
    let started = match options {
        Some(options) => Guardian::start(options.program, port, link, options.axis)
            .map_err(|error| format!("{}: {error}", options.program.display())),
        None => Err("no program is configured".to_owned()),
    };
    match started {
        Ok(guardian) => (Some(guardian), None),
        Err(why) => (
            None,
            Some(format!(
                "no guardian process ({why}): if this program dies, the axis completes its move and stays powered"
            )),
        ),
    }
}

fn slow_answers(timer: LatencyTimer) -> Option<String> {
    match timer {
        LatencyTimer::High { ms } => Some(format!(
            "the adapter's latency timer is {ms} ms and cannot be set: angles are less certain by that time (velomotion doctor)"
        )),
        LatencyTimer::Unknown | LatencyTimer::Low => None,
    }
}

/// Failure of a port, with help.
#[must_use]
pub fn failure(error: &PortError) -> Failure {
    let help = match error {
        PortError::Permission { .. } => {
            "add yourself to the group that owns the port (dialout on Debian), or install a udev rule for it"
        }
        PortError::Busy { .. } => {
            "close the other program that uses the drive; tilt stop stops a capture that runs"
        }
        _ => {
            "see whether the drive is plugged in and switched on, and what its port is called (velomotion doctor);\n\
             --device sim needs no hardware"
        }
    };
    let kind = match error {
        PortError::Busy { .. } => Kind::Busy,
        _ => Kind::NoDevice,
    };
    Failure::new(kind, error.to_string()).help(help)
}

fn can_failure(place: &Path, error: &CanError) -> Failure {
    match error {
        CanError::Port(error) => failure(error),
        CanError::Refused { .. } => {
            Failure::new(Kind::NoDevice, format!("port {}: {error}", place.display())).help(
                "see whether another program has the adapter's channel open, and whether it speaks SLCAN at 1 Mbit/s",
            )
        }
        error => Failure::new(Kind::NoDevice, error.to_string())
            .help("velomotion doctor lists the CAN interfaces and says how to bring them up"),
    }
}

/// A CAN bus as the drive client and the log use it: a `struct can_frame` of 16 bytes per frame.
/// Errors name the interface.
pub struct BusLine<C: CanPort>(pub C);

impl<C: CanPort> Port for BusLine<C> {
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        let frame = CanFrame::from_socketcan(frame)
            .map_err(|error| self.misused("write", &error.to_string()))?;
        match self.0.write_frame(&frame) {
            // Frames may be lost: the client repeats its request.
            Err(CanError::NotSent) => Ok(io::clock::now()),
            sent => Ok(sent?),
        }
    }

    fn read(
        &mut self,
        buffer: &mut [u8],
        timeout: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
        let (frame, at) = match self.0.read(timeout) {
            Ok(None) | Err(CanError::NotSent) => return Ok(None),
            Ok(Some(read)) => read,
            Err(error) => return Err(error.into()),
        };
        let bytes = frame.to_socketcan();
        let Some(room) = buffer.get_mut(..bytes.len()) else {
            return Err(self.misused("read", "a buffer shorter than a frame"));
        };
        room.copy_from_slice(&bytes);
        Ok(Some((bytes.len(), at)))
    }

    fn now(&self) -> Stamp<Host> {
        self.0.now()
    }
}

impl<C: CanPort> BusLine<C> {
    /// Error of a caller that passes no whole frame.
    fn misused(&self, action: &'static str, what: &str) -> PortError {
        PortError::Io {
            port: self.0.name().to_owned(),
            action,
            source: std::io::Error::other(what.to_owned()),
        }
    }
}

impl<C: CanPort> Drop for BusLine<C> {
    /// Logs the number of lost frames once.
    fn drop(&mut self) {
        let dropped = self.0.dropped();
        if dropped > 0 {
            tracing::warn!(
                "{}: at least {dropped} frames of the bus were lost on their way to this program",
                self.0.name()
            );
        }
    }
}
