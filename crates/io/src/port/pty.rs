//! The device side of a pseudo-terminal, for the software drive. The other side is a serial port by
//! path. Bytes pass without the delay of a baud rate.

use std::io;
use std::os::fd::{AsFd, OwnedFd};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use nix::errno::Errno;
use nix::fcntl::{FcntlArg, FdFlag, OFlag, fcntl};
use nix::poll::PollFlags;
use nix::pty::openpty;
use nix::sys::termios::{SetArg, cfmakeraw, tcgetattr, tcsetattr};
use nix::unistd;
use units::{Host, Span, Stamp};

use super::wait::{duration, wait};
use super::{Port, PortError};
use crate::clock;

/// The timeout of a real port for a frame.
const WRITE_TIMEOUT: Duration = Duration::from_millis(500);

/// A pseudo-terminal in raw mode, seen from the device. Dropping it unplugs the device.
#[derive(Debug)]
pub struct Pty {
    device: OwnedFd,
    /// Kept open, so that the device sees no hang-up while no client has the port open.
    _client: OwnedFd,
    path: PathBuf,
    name: String,
}

impl Pty {
    /// Opens a pseudo-terminal.
    ///
    /// # Errors
    /// [`PortError::Io`] if the system has none left.
    pub fn open() -> Result<Self, PortError> {
        Self::try_open().map_err(|e| PortError::Io {
            port: "pseudo-terminal".to_owned(),
            action: "open",
            source: e.into(),
        })
    }

    fn try_open() -> nix::Result<Self> {
        let pair = openpty(None, None)?;
        let mut settings = tcgetattr(&pair.slave)?;
        cfmakeraw(&mut settings);
        tcsetattr(&pair.slave, SetArg::TCSANOW, &settings)?;
        for fd in [&pair.master, &pair.slave] {
            fcntl(fd, FcntlArg::F_SETFD(FdFlag::FD_CLOEXEC))?;
        }
        let flags = OFlag::from_bits_truncate(fcntl(&pair.master, FcntlArg::F_GETFL)?);
        fcntl(&pair.master, FcntlArg::F_SETFL(flags | OFlag::O_NONBLOCK))?;
        let path = unistd::ttyname(&pair.slave)?;
        Ok(Self {
            device: pair.master,
            _client: pair.slave,
            name: path.display().to_string(),
            path,
        })
    }

    /// The path of the serial port, such as `/dev/pts/3`.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
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

impl Port for Pty {
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        let host = clock::now();
        let deadline = Instant::now() + WRITE_TIMEOUT;
        let mut written = 0;
        while let Some(rest) = frame.get(written..).filter(|rest| !rest.is_empty()) {
            match unistd::write(&self.device, rest) {
                Ok(n) => written += n,
                Err(Errno::EINTR) => {}
                // The client's input queue is full.
                Err(Errno::EAGAIN) => {
                    let left = deadline.saturating_duration_since(Instant::now());
                    if left.is_zero() {
                        return Err(PortError::WriteTimeout {
                            port: self.name.clone(),
                            expected: frame.len(),
                            got: written,
                        });
                    }
                    wait(self.device.as_fd(), PollFlags::POLLOUT, left)
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
        let seen = wait(self.device.as_fd(), PollFlags::POLLIN, duration(timeout))
            .map_err(|e| self.io_error("read", e))?;
        if seen.is_empty() {
            return Ok(None);
        }
        match unistd::read(&self.device, buffer) {
            Ok(0) => Ok(None),
            Ok(n) => Ok(Some((n, clock::now()))),
            Err(Errno::EINTR | Errno::EAGAIN) => Ok(None),
            Err(e) => Err(self.io_error("read", e)),
        }
    }
}
