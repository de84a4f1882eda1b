//! A CAN interface of the kernel, through the `socketcan` crate: classic frames with the kernel's receive time.
//!
//! Blocking with timeouts, like the serial port: a drive's client waits for one answer at a time, on its own thread. The
//! kernel's error reports and CAN FD are left switched off. Waiting is `ppoll`'s, since the socket's own timeouts have
//! the kernel's tick.

use std::io::{self, ErrorKind};
use std::os::fd::AsFd;
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, ppoll};
use nix::sys::time::TimeSpec;
use protocol::canopen::{CanFrame, CanId, CobId, ExtendedId};
use socketcan::{CanSocket, EmbeddedFrame as _, Frame as _, Id, Socket as _, SocketOptions as _};
use units::{Host, Span, Stamp};

use super::interfaces::{interfaces, up_command};
use super::{CanError, CanPort};
use crate::clock;

/// How long a frame may wait for room in the interface's queue.
const WRITE_TIMEOUT: Duration = Duration::from_millis(500);
/// Between two tries at a full queue: some frames of the bus.
const RETRY: Duration = Duration::from_millis(1);

/// An open CAN interface.
#[derive(Debug)]
pub struct SocketCan {
    socket: CanSocket,
    interface: String,
}

impl SocketCan {
    /// Opens an interface that is up, such as `can0`. Others may have it open too. No rights are needed.
    ///
    /// # Errors
    /// [`CanError`]: no CAN in the kernel, no such interface, not a CAN interface, down.
    pub fn open(interface: &str) -> Result<Self, CanError> {
        let socket = CanSocket::open(interface).map_err(|e| open_error(interface, e))?;
        let port = Self {
            socket,
            interface: interface.to_owned(),
        };
        // Binding to an interface that is down works; the kernel leaves the error at the socket.
        let pending = port.socket.as_raw_socket().take_error();
        if let Some(down) = pending.map_err(|e| port.io_error("open", e))? {
            return Err(port.io_error("open", down));
        }
        port.socket
            .set_recv_timestamp(true)
            .and_then(|()| port.socket.set_nonblocking(true))
            .map_err(|e| port.io_error("open", e))?;
        Ok(port)
    }

    /// The interface's name.
    #[must_use]
    pub fn interface(&self) -> &str {
        &self.interface
    }

    fn io_error(&self, action: &'static str, source: io::Error) -> CanError {
        let interface = self.interface.clone();
        match source.raw_os_error().map(Errno::from_raw) {
            Some(Errno::ENETDOWN) => CanError::Down {
                command: up_command(&interface),
                interface,
            },
            Some(Errno::ENODEV | Errno::ENXIO) => CanError::Disconnected { interface },
            _ => CanError::Io {
                interface,
                action,
                source,
            },
        }
    }

    /// A frame, if one is there.
    fn receive(&self) -> Result<Option<(CanFrame, Stamp<Host>)>, CanError> {
        loop {
            match self.socket.read_frame_with_timestamps() {
                Ok((frame, times)) => {
                    let host = times.socket.map_or_else(clock::now, stamp);
                    // An error report, which was not asked for, is no frame.
                    if let Some(frame) = from_kernel(&frame) {
                        return Ok(Some((frame, host)));
                    }
                }
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) if e.kind() == ErrorKind::WouldBlock => return Ok(None),
                Err(e) => return Err(self.io_error("read", e)),
            }
        }
    }
}

impl CanPort for SocketCan {
    fn write_frame(&mut self, frame: &CanFrame) -> Result<Stamp<Host>, CanError> {
        let out = to_kernel(frame)
            .ok_or_else(|| self.io_error("write", io::Error::from(ErrorKind::InvalidInput)))?;
        let deadline = Instant::now() + WRITE_TIMEOUT;
        loop {
            let host = clock::now();
            match self.socket.write_frame(&out) {
                Ok(()) => return Ok(host),
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) if is_full(&e) => {
                    if Instant::now() >= deadline {
                        return Err(CanError::WriteTimeout {
                            interface: self.interface.clone(),
                        });
                    }
                    // The socket counts as writable while the interface's queue is full: there is nothing to wait for.
                    thread::sleep(RETRY);
                }
                Err(e) => return Err(self.io_error("write", e)),
            }
        }
    }

    fn read(&mut self, timeout: Span) -> Result<Option<(CanFrame, Stamp<Host>)>, CanError> {
        let timeout = Duration::from_nanos(u64::try_from(timeout.as_nanos()).unwrap_or(0));
        let deadline = Instant::now().checked_add(timeout);
        loop {
            if let Some(read) = self.receive()? {
                return Ok(Some(read));
            }
            let left = deadline.map(|at| at.saturating_duration_since(Instant::now()));
            if left.is_some_and(|left| left.is_zero()) {
                return Ok(None);
            }
            let mut fds = [PollFd::new(self.socket.as_fd(), PollFlags::POLLIN)];
            match ppoll(&mut fds, left.map(TimeSpec::from_duration), None) {
                Ok(_) | Err(Errno::EINTR) => {}
                Err(e) => return Err(self.io_error("read", e.into())),
            }
        }
    }
}

fn is_full(error: &io::Error) -> bool {
    error.kind() == ErrorKind::WouldBlock || error.raw_os_error() == Some(Errno::ENOBUFS as i32)
}

fn open_error(interface: &str, source: io::Error) -> CanError {
    let interface = interface.to_owned();
    // An interface is looked up before a socket is made; without CAN there can be none, and that says more.
    let errno = CanSocket::open_iface(0)
        .err()
        .and_then(|e| e.raw_os_error())
        .or(source.raw_os_error());
    let known = || interfaces().into_iter().map(|found| found.name).collect();
    match errno.map(Errno::from_raw) {
        Some(Errno::EAFNOSUPPORT | Errno::EPROTONOSUPPORT | Errno::ESOCKTNOSUPPORT) => {
            CanError::NoCan { interface }
        }
        Some(Errno::ENODEV) if nix::net::if_::if_nametoindex(interface.as_str()).is_ok() => {
            CanError::NotCan {
                known: known(),
                interface,
            }
        }
        Some(Errno::ENODEV | Errno::ENXIO) => CanError::NoInterface {
            known: known(),
            interface,
        },
        _ => CanError::Io {
            interface,
            action: "open",
            source,
        },
    }
}

/// The kernel's time of the system clock.
fn stamp(time: SystemTime) -> Stamp<Host> {
    let since = time
        .duration_since(SystemTime::UNIX_EPOCH)
        .unwrap_or_default();
    Stamp::from_nanos(i64::try_from(since.as_nanos()).unwrap_or(i64::MAX))
}

/// The frame as the kernel's; `None` only for an identifier that `CanFrame` cannot have.
fn to_kernel(frame: &CanFrame) -> Option<socketcan::CanFrame> {
    let id: Id = match frame.id() {
        CanId::Standard(id) => socketcan::StandardId::new(id.get())?.into(),
        CanId::Extended(id) => socketcan::ExtendedId::new(id.get())?.into(),
    };
    if frame.is_remote() {
        socketcan::CanFrame::new_remote(id, usize::from(frame.dlc()))
    } else {
        socketcan::CanFrame::new(id, frame.data())
    }
}

/// The kernel's frame; `None` for an error report.
fn from_kernel(frame: &socketcan::CanFrame) -> Option<CanFrame> {
    if frame.is_error_frame() {
        return None;
    }
    let id: CanId = match frame.hal_id() {
        Id::Standard(id) => CobId::new(id.as_raw())?.into(),
        Id::Extended(id) => ExtendedId::new(id.as_raw())?.into(),
    };
    if frame.is_remote_frame() {
        CanFrame::remote(id, u8::try_from(frame.dlc()).ok()?).ok()
    } else {
        CanFrame::new(id, frame.data()).ok()
    }
}

#[cfg(test)]
mod tests;
