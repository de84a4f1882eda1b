//! A CAN interface of the kernel, through the `socketcan` crate: classic frames with the kernel's
//! receive time.
//!
//! Blocking with timeouts, like the serial port: a drive's client waits for one answer at a time,
//! on its own thread. The kernel's error reports and CAN FD are left switched off. Waiting is
//! `ppoll`'s, since the socket's own timeouts have the kernel's tick. Frames are received here and
//! not by the crate, as it passes over the kernel's count of those it dropped: a socket holds some
//! hundred frames, and what does not fit is gone without a word.

use std::io::{self, ErrorKind, IoSliceMut};
use std::os::fd::{AsFd, AsRawFd};
use std::thread;
use std::time::{Duration, Instant};

use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, ppoll};
use nix::sys::socket::{ControlMessageOwned, MsgFlags, recvmsg, setsockopt, sockopt};
use nix::sys::time::TimeSpec;
use protocol::canopen::{CanFrame, CanId, SOCKETCAN_LEN};
use socketcan::{CanSocket, EmbeddedFrame as _, Id, Socket as _};
use units::{Host, Span, Stamp};

use super::interfaces::{interfaces, up_command};
use super::{CanError, CanPort};
use crate::clock;

/// How long a frame may wait for room in the interface's queue.
const WRITE_TIMEOUT: Duration = Duration::from_millis(500);
/// Bytes asked for; a frame takes some 770 of them.
const RECEIVE_BUFFER: usize = 4 << 20;
/// Between two tries at a full queue: some frames of the bus.
const RETRY: Duration = Duration::from_millis(1);

/// An open CAN interface.
#[derive(Debug)]
pub struct SocketCan {
    socket: CanSocket,
    interface: String,
    control: Vec<u8>,
    /// The kernel's counter of dropped frames, as it was last told, and all of them.
    overflow_counter: u32,
    dropped: u64,
}

impl SocketCan {
    /// Opens an interface that is up, such as `can0`. Others may have it open too. No rights are
    /// needed.
    ///
    /// # Errors
    /// [`CanError`]: no CAN in the kernel, no such interface, not a CAN interface, down.
    pub fn open(interface: &str) -> Result<Self, CanError> {
        let socket = CanSocket::open(interface).map_err(|e| open_error(interface, e))?;
        let port = Self {
            socket,
            interface: interface.to_owned(),
            control: nix::cmsg_space!(TimeSpec, u32),
            overflow_counter: 0,
            dropped: 0,
        };
        // Binding to an interface that is down works; the kernel leaves the error at the socket.
        let pending = port.socket.as_raw_socket().take_error();
        if let Some(down) = pending.map_err(|e| port.io_error("open", e))? {
            return Err(port.io_error("open", down));
        }
        setsockopt(&port.socket, sockopt::ReceiveTimestampns, &true)
            .and_then(|()| setsockopt(&port.socket, sockopt::RxqOvfl, &1))
            .map_err(|e| port.io_error("open", e.into()))?;
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

    /// A frame, if one is there.
    fn receive(&mut self) -> Result<Option<(CanFrame, Stamp<Host>)>, CanError> {
        loop {
            match self.receive_message() {
                // An error report, which was not asked for, is no frame.
                Ok((None, _)) => {}
                Ok((Some(frame), host)) => return Ok(Some((frame, host))),
                Err(Errno::EINTR) => {}
                Err(Errno::EAGAIN) => return Ok(None),
                Err(e) => return Err(self.io_error("read", e.into())),
            }
        }
    }

    /// One `recvmsg`: the frame and the kernel's time of it; its count of dropped frames is noted.
    fn receive_message(&mut self) -> Result<(Option<CanFrame>, Stamp<Host>), Errno> {
        let mut bytes = [0; SOCKETCAN_LEN];
        let mut parts = [IoSliceMut::new(&mut bytes)];
        self.control.resize(self.control.capacity(), 0);
        let fd = self.socket.as_raw_fd();
        let flags = MsgFlags::empty();
        let message = recvmsg::<()>(fd, &mut parts, Some(&mut self.control), flags)?;
        let (mut host, mut overflow) = (None, None);
        for part in message.cmsgs()? {
            match part {
                ControlMessageOwned::ScmTimestampns(time) => host = Some(stamp(time)),
                ControlMessageOwned::RxqOvfl(counter) => overflow = Some(counter),
                _ => {}
            }
        }
        if let Some(counter) = overflow {
            self.dropped += u64::from(counter.wrapping_sub(self.overflow_counter));
            self.overflow_counter = counter;
        }
        Ok((from_kernel(bytes), host.unwrap_or_else(clock::now)))
    }
}

/// Room for as many frames as the kernel lets this program have: its limit for users makes that
/// half a second of a stream at 1 kHz, which is enough, so that a refusal is none of an opening.
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
                    // The socket counts as writable while the interface's queue is full: there is
                    // nothing to wait for.
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

    /// Frames that the kernel dropped because this program did not read fast enough, as far as
    /// those read tell.
    fn dropped(&self) -> u64 {
        self.dropped
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
    // An interface is looked up before a socket is made; without CAN there can be none, and that
    // says more.
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
fn stamp(time: TimeSpec) -> Stamp<Host> {
    Stamp::from_nanos(
        time.tv_sec()
            .saturating_mul(1_000_000_000)
            .saturating_add(time.tv_nsec()),
    )
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

/// A `struct can_frame` as the kernel lays it out, with the identifier in this machine's order;
/// `None` for an error report.
fn from_kernel(mut bytes: [u8; SOCKETCAN_LEN]) -> Option<CanFrame> {
    let (id, _) = bytes.split_first_chunk_mut::<4>()?;
    *id = u32::from_ne_bytes(*id).to_be_bytes();
    CanFrame::from_socketcan(&bytes).ok()
}

#[cfg(test)]
mod tests;
