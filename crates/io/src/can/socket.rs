//! A CAN interface of the kernel, through the `socketcan` crate: classic frames with the kernel's
//! receive time.
//!
//! Calls block with a timeout, like those of the serial port: a drive client waits for one answer
//! at a time, on its own thread. Error frames and CAN FD stay disabled. Waiting uses `ppoll`, since
//! socket timeouts have the resolution of the kernel's tick. Frames are received here rather than
//! by the crate, which ignores the kernel's drop counter: a socket buffers some hundred frames and
//! drops the rest silently.

use std::io::{self, ErrorKind, IoSliceMut};
use std::os::fd::{AsFd, AsRawFd};
use std::thread;
use std::time::{Duration, Instant};

use nix::errno::Errno;
use nix::poll::PollFlags;
use nix::sys::socket::{MsgFlags, recvmsg, setsockopt, sockopt};
use protocol::canopen::{CanFrame, CanId, SOCKETCAN_LEN};
use socketcan::{CanSocket, EmbeddedFrame as _, Id, Socket as _};
use units::{Host, Span, Stamp};

use super::interfaces::{interfaces, up_command};
use super::{CanError, CanPort};
use crate::ancillary::{self, Ancillary, DropCounter};
use crate::clock;
use crate::port::wait::{duration, wait};

/// Longest time that a frame waits for space in the interface's queue.
const WRITE_TIMEOUT: Duration = Duration::from_millis(500);
/// Bytes requested; a frame takes 770 of them.
const RECEIVE_BUFFER: usize = 4 << 20;
/// Time between two attempts at a full queue: some eight frames at 1 Mbit/s.
const RETRY: Duration = Duration::from_millis(1);

/// An open CAN interface.
#[derive(Debug)]
pub struct SocketCan {
    socket: CanSocket,
    interface: String,
    control: Vec<u8>,
    dropped: DropCounter,
}

impl SocketCan {
    /// Opens an interface that is up, such as `can0`. Other programs may use it too. Needs no
    /// privileges.
    ///
    /// # Errors
    /// [`CanError`]: no CAN in the kernel, no such interface, not a CAN interface, down.
    pub fn open(interface: &str) -> Result<Self, CanError> {
        let socket = CanSocket::open(interface).map_err(|e| open_error(interface, e))?;
        let port = Self {
            socket,
            interface: interface.to_owned(),
            control: ancillary::buffer(),
            dropped: DropCounter::default(),
        };
        // Binding to an interface that is down succeeds; the error is pending at the socket.
        let pending = port.socket.as_raw_socket().take_error();
        if let Some(down) = pending.map_err(|e| port.io_error("open", e))? {
            return Err(port.io_error("open", down));
        }
        ancillary::enable(&port.socket).map_err(|e| port.io_error("open", e.into()))?;
        enlarge_buffer(&port.socket);
        port.socket
            .set_nonblocking(true)
            .map_err(|e| port.io_error("open", e))?;
        Ok(port)
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

    /// The next waiting frame.
    fn receive(&mut self) -> Result<Option<(CanFrame, Stamp<Host>)>, CanError> {
        loop {
            match self.receive_message() {
                // An error frame.
                Ok((None, _)) => {}
                Ok((Some(frame), host)) => return Ok(Some((frame, host))),
                Err(Errno::EINTR) => {}
                Err(Errno::EAGAIN) => return Ok(None),
                Err(e) => return Err(self.io_error("read", e.into())),
            }
        }
    }

    /// Receives one frame with its kernel time and counts dropped frames.
    fn receive_message(&mut self) -> Result<(Option<CanFrame>, Stamp<Host>), Errno> {
        let mut bytes = [0; SOCKETCAN_LEN];
        let mut parts = [IoSliceMut::new(&mut bytes)];
        self.control.resize(self.control.capacity(), 0);
        let fd = self.socket.as_raw_fd();
        let flags = MsgFlags::empty();
        let message = recvmsg::<()>(fd, &mut parts, Some(&mut self.control), flags)?;
        let ancillary = Ancillary::of(&message)?;
        self.dropped.update(ancillary.overflow);
        let host = ancillary.received.unwrap_or_else(clock::now);
        Ok((from_kernel(bytes), host))
    }
}

/// Requests the largest buffer that the kernel grants. Its limit for users holds half a second of
/// frames at 1 kHz, which suffices, so a refusal is no error.
fn enlarge_buffer(socket: &CanSocket) {
    if setsockopt(socket, sockopt::RcvBufForce, &RECEIVE_BUFFER).is_err() {
        let _ = setsockopt(socket, sockopt::RcvBuf, &RECEIVE_BUFFER);
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
                    // The socket polls as writable while the interface's queue is full.
                    thread::sleep(RETRY);
                }
                Err(e) => return Err(self.io_error("write", e)),
            }
        }
    }

    fn read(&mut self, timeout: Span) -> Result<Option<(CanFrame, Stamp<Host>)>, CanError> {
        let timeout = duration(timeout);
        let deadline = Instant::now().checked_add(timeout);
        loop {
            if let Some(read) = self.receive()? {
                return Ok(Some(read));
            }
            let left = deadline.map_or(timeout, |deadline| {
                deadline.saturating_duration_since(Instant::now())
            });
            if left.is_zero() {
                return Ok(None);
            }
            wait(self.socket.as_fd(), PollFlags::POLLIN, left)
                .map_err(|e| self.io_error("read", e.into()))?;
        }
    }

    /// Frames that the kernel dropped because the receive buffer was full. The count arrives with
    /// the next frame.
    fn dropped(&self) -> u64 {
        self.dropped.total()
    }

    fn name(&self) -> &str {
        &self.interface
    }
}

fn is_full(error: &io::Error) -> bool {
    error.kind() == ErrorKind::WouldBlock || error.raw_os_error() == Some(Errno::ENOBUFS as i32)
}

fn open_error(interface: &str, source: io::Error) -> CanError {
    let interface = interface.to_owned();
    // The interface is looked up before the socket is made. A kernel without CAN has no interfaces,
    // so that error takes precedence.
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

/// Converts to the kernel's frame; `None` only for an identifier that `CanFrame` excludes.
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

/// Converts from `struct can_frame`, whose identifier is in native byte order; `None` for an error
/// frame.
fn from_kernel(mut bytes: [u8; SOCKETCAN_LEN]) -> Option<CanFrame> {
    let (id, _) = bytes.split_first_chunk_mut::<4>()?;
    *id = u32::from_ne_bytes(*id).to_be_bytes();
    CanFrame::from_socketcan(&bytes).ok()
}

#[cfg(test)]
mod tests;
