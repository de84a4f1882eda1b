//! A serial port through the `serialport` crate: exclusive, raw, 8N1.
//!
//! The crate sets and locks the port. Bytes go through a descriptor of this program's own, as the
//! crate waits before each write and makes an error with a text of each timeout. The EPOS2 uses no
//! modem lines, parity or flow control.

use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind};
use std::os::fd::AsRawFd;
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

use nix::fcntl::OFlag;
use serialport::{ClearBuffer, SerialPort as _, TTYPort};
use units::{Host, Span, Stamp};

use super::descriptor::DescriptorPort;
use super::{Port, PortError};
use crate::processes;

/// Latency timer of a USB serial adapter: the time for which it buffers received bytes (FTDI,
/// factory setting 16 ms).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LatencyTimer {
    /// The port has none (no FTDI adapter) or does not report it.
    Unknown,
    /// It is at most 1 ms.
    Low,
    /// It cannot be set to 1 ms (the sysfs file belongs to root): each answer of the drive is
    /// delayed by up to this time.
    High {
        /// Milliseconds.
        ms: u32,
    },
}

/// An open serial port.
#[derive(Debug)]
pub struct SerialPort {
    /// Holds the lock.
    tty: TTYPort,
    bytes: DescriptorPort,
    /// Latency timer of the USB adapter.
    pub latency: LatencyTimer,
}

impl SerialPort {
    /// Opens a port exclusively, discards waiting input, and sets the adapter's latency timer to 1
    /// ms if it has one and the user may.
    ///
    /// # Errors
    /// [`PortError`]: not found, permission, busy, unsuitable.
    pub fn open(path: impl AsRef<Path>, baud: u32) -> Result<Self, PortError> {
        let path = path.as_ref();
        let name = path.display().to_string();
        // Before the lock, which refuses any other.
        let own = OpenOptions::new()
            .read(true)
            .write(true)
            .custom_flags((OFlag::O_NOCTTY | OFlag::O_NONBLOCK).bits())
            .open(path);
        let locked = serialport::new(name.as_str(), baud)
            .exclusive(true)
            .open_native();
        // Input that an earlier client left unread.
        let tty = locked.and_then(|tty| tty.clear(ClearBuffer::All).map(|()| tty));
        let tty = match tty {
            Ok(tty) => tty,
            Err(error) => {
                // The error names the processes that have the port open.
                drop(own);
                return Err(open_error(path, baud, &error));
            }
        };
        let bytes = own.and_then(|own| Ok(DescriptorPort::new(own.into(), name.clone())?));
        Ok(Self {
            tty,
            bytes: bytes.map_err(|source| PortError::Io {
                port: name,
                action: "open",
                source,
            })?,
            latency: set_low_latency(path),
        })
    }

    pub(super) fn raw_fd(&self) -> std::os::fd::RawFd {
        self.tty.as_raw_fd()
    }
}

impl Port for SerialPort {
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        self.bytes.write_frame(frame)
    }

    fn read(
        &mut self,
        buffer: &mut [u8],
        timeout: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
        self.bytes.read(buffer, timeout)
    }
}

fn open_error(path: &Path, baud: u32, error: &serialport::Error) -> PortError {
    let port = path.display().to_string();
    match error.kind {
        serialport::ErrorKind::Io(ErrorKind::NotFound) => PortError::NotFound { port },
        serialport::ErrorKind::Io(ErrorKind::PermissionDenied) => PortError::Permission { port },
        // serialport reports "no device" for EBUSY and for a lock of another program.
        serialport::ErrorKind::NoDevice => PortError::Busy {
            port,
            by: processes::descriptions(path),
        },
        serialport::ErrorKind::Io(kind) => PortError::Io {
            port,
            action: "open",
            source: io::Error::new(kind, error.description.clone()),
        },
        serialport::ErrorKind::InvalidInput | serialport::ErrorKind::Unknown => {
            PortError::Unsuitable {
                port,
                baud,
                reason: error.description.clone(),
            }
        }
    }
}

/// Sets the latency timer of a port's adapter to 1 ms.
fn set_low_latency(path: &Path) -> LatencyTimer {
    let Some(file) = latency_file(Path::new("/sys"), path) else {
        return LatencyTimer::Unknown;
    };
    set_latency(&file)
}

/// The sysfs file of a port's latency timer; `/dev/serial/by-id/...` is a link to the port.
fn latency_file(sysfs: &Path, port: &Path) -> Option<PathBuf> {
    let real = port.canonicalize().ok()?;
    let file = sysfs
        .join("class/tty")
        .join(real.file_name()?)
        .join("device/latency_timer");
    file.exists().then_some(file)
}

fn set_latency(file: &Path) -> LatencyTimer {
    let current = || -> Option<u32> { fs::read_to_string(file).ok()?.trim().parse().ok() };
    match current() {
        None => return LatencyTimer::Unknown,
        Some(0 | 1) => return LatencyTimer::Low,
        // Without permission the value stays, which is read back below.
        Some(_) => drop(fs::write(file, "1")),
    }
    match current() {
        Some(ms @ 2..) => LatencyTimer::High { ms },
        Some(_) => LatencyTimer::Low,
        None => LatencyTimer::Unknown,
    }
}

#[cfg(test)]
mod tests;
