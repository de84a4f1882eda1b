//! A port over an open file descriptor of a terminal.

use std::io;
use std::os::fd::{AsFd, OwnedFd};
use std::time::{Duration, Instant};

use nix::errno::Errno;
use nix::fcntl::{FcntlArg, OFlag, fcntl};
use nix::poll::PollFlags;
use nix::unistd;
use units::{Host, Span, Stamp};

use super::wait::{duration, wait};
use super::{Port, PortError};
use crate::clock;

/// The timeout of a real port for a frame.
const WRITE_TIMEOUT: Duration = Duration::from_millis(500);

/// A terminal that is open already.
#[derive(Debug)]
pub struct DescriptorPort {
    terminal: OwnedFd,
    name: String,
}

impl DescriptorPort {
    /// Makes a port of a terminal, which never blocks from then on, in any process that shares it.
    pub(super) fn new(terminal: OwnedFd, name: String) -> nix::Result<Self> {
        let flags = OFlag::from_bits_truncate(fcntl(&terminal, FcntlArg::F_GETFL)?);
        fcntl(&terminal, FcntlArg::F_SETFL(flags | OFlag::O_NONBLOCK))?;
        Ok(Self { terminal, name })
    }

    fn io_error(&self, action: &'static str, errno: Errno) -> PortError {
        match errno {
            Errno::EIO | Errno::ENXIO | Errno::ENODEV => PortError::Disconnected {
                port: self.name.clone(),
                reason: errno.desc().to_owned(),
            },
            _ => PortError::Io {
                port: self.name.clone(),
                action,
                source: io::Error::from(errno),
            },
        }
    }
}

impl Port for DescriptorPort {
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        let host = clock::now();
        let deadline = Instant::now() + WRITE_TIMEOUT;
        let mut written = 0;
        while let Some(rest) = frame.get(written..).filter(|rest| !rest.is_empty()) {
            match unistd::write(&self.terminal, rest) {
                Ok(n) => written += n,
                Err(Errno::EINTR) => {}
                // The reader's input queue is full.
                Err(Errno::EAGAIN) => {
                    let left = deadline.saturating_duration_since(Instant::now());
                    if left.is_zero() {
                        return Err(PortError::WriteTimeout {
                            port: self.name.clone(),
                            expected: frame.len(),
                            got: written,
                        });
                    }
                    wait(self.terminal.as_fd(), PollFlags::POLLOUT, left)
                        .map_err(|e| self.io_error("write", e))?;
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
        let seen = wait(self.terminal.as_fd(), PollFlags::POLLIN, duration(timeout))
            .map_err(|e| self.io_error("read", e))?;
        if seen.is_empty() {
            return Ok(None);
        }
        match unistd::read(&self.terminal, buffer) {
            Ok(0) => Err(self.io_error("read", Errno::EIO)),
            Ok(n) => Ok(Some((n, clock::now()))),
            Err(Errno::EINTR | Errno::EAGAIN) => Ok(None),
            Err(e) => Err(self.io_error("read", e)),
        }
    }
}
