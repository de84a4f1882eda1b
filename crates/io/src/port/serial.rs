//! A serial port through the `serialport` crate: exclusive, raw, 8N1.
//!
//! On Linux the crate waits with `ppoll`, so timeouts below a millisecond hold. The EPOS2 uses no
//! modem lines, parity or flow control.

use std::fs;
use std::io::{self, ErrorKind, Read, Write};
use std::os::fd::AsRawFd;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serialport::{ClearBuffer, SerialPort as _, TTYPort};
use units::{Host, Span, Stamp};

use super::wait::duration;
use super::{Port, PortError};
use crate::{clock, processes};

const WRITE_TIMEOUT: Duration = Duration::from_millis(500);

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
    tty: TTYPort,
    name: String,
    /// Latency timer of the USB adapter.
    pub latency: LatencyTimer,
    timeout: Duration,
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
        let tty = serialport::new(name.as_str(), baud)
            .exclusive(true)
            .open_native()
            .map_err(|e| open_error(path, baud, &e))?;
        // Input that an earlier client left unread.
        tty.clear(ClearBuffer::All)
            .map_err(|e| open_error(path, baud, &e))?;
        Ok(Self {
            tty,
            latency: set_low_latency(path),
            name,
            timeout: Duration::ZERO,
        })
    }

    pub(super) fn raw_fd(&self) -> std::os::fd::RawFd {
        self.tty.as_raw_fd()
    }

    fn set_timeout(&mut self, timeout: Duration) {
        if timeout != self.timeout && self.tty.set_timeout(timeout).is_ok() {
            self.timeout = timeout;
        }
    }

    fn io_error(&self, action: &'static str, source: io::Error) -> PortError {
        match source.kind() {
            // serialport gives BrokenPipe for a hang-up, NotFound for "no device", Other for EIO,
            // ENXIO and ENODEV.
            ErrorKind::BrokenPipe
            | ErrorKind::NotFound
            | ErrorKind::Other
            | ErrorKind::UnexpectedEof => PortError::Disconnected {
                port: self.name.clone(),
                reason: source.to_string(),
            },
            _ => PortError::Io {
                port: self.name.clone(),
                action,
                source,
            },
        }
    }
}

impl Port for SerialPort {
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        let deadline = Instant::now() + WRITE_TIMEOUT;
        self.set_timeout(WRITE_TIMEOUT);
        let host = clock::now();
        let mut written = 0;
        while let Some(rest) = frame.get(written..).filter(|rest| !rest.is_empty()) {
            match self.tty.write(rest) {
                Ok(n) => written += n,
                Err(e)
                    if matches!(
                        e.kind(),
                        ErrorKind::Interrupted | ErrorKind::WouldBlock | ErrorKind::TimedOut
                    ) =>
                {
                    if Instant::now() >= deadline {
                        return Err(PortError::WriteTimeout {
                            port: self.name.clone(),
                            expected: frame.len(),
                            got: written,
                        });
                    }
                }
                Err(e) => return Err(self.io_error("write", e)),
            }
        }
        Ok(host)
    }

    fn read(
        &mut self,
        buffer: &mut [u8],
        timeout: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
        if buffer.is_empty() {
            return Ok(None);
        }
        let timeout = duration(timeout);
        let deadline = Instant::now().checked_add(timeout);
        self.set_timeout(timeout);
        loop {
            match self.tty.read(buffer) {
                Ok(0) => {
                    return Err(self.io_error("read", ErrorKind::UnexpectedEof.into()));
                }
                Ok(n) => return Ok(Some((n, clock::now()))),
                Err(e) if matches!(e.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock) => {
                    return Ok(None);
                }
                // A signal interrupted the read: continue for the rest of the time.
                Err(e) if e.kind() == ErrorKind::Interrupted => {
                    if let Some(deadline) = deadline {
                        self.set_timeout(deadline.saturating_duration_since(Instant::now()));
                    }
                }
                Err(e) => return Err(self.io_error("read", e)),
            }
        }
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
