//! The device side of a pseudo-terminal, for the simulated drive. The other side is a serial port
//! by path. Bytes pass without the delay of a baud rate.

use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};

use nix::fcntl::{FcntlArg, FdFlag, fcntl};
use nix::pty::openpty;
use nix::sys::termios::{SetArg, cfmakeraw, tcgetattr, tcsetattr};
use nix::unistd;
use units::{Host, Span, Stamp};

use super::descriptor::DescriptorPort;
use super::{Port, PortError};

/// A pseudo-terminal in raw mode, seen from the device. Dropping it unplugs the device.
#[derive(Debug)]
pub struct Pty {
    device: DescriptorPort,
    /// Kept open, so that the device sees no hang-up while no client has the port open.
    _client: OwnedFd,
    path: PathBuf,
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
        let path = unistd::ttyname(&pair.slave)?;
        Ok(Self {
            device: DescriptorPort::new(pair.master, path.display().to_string())?,
            _client: pair.slave,
            path,
        })
    }

    /// The path of the serial port, such as `/dev/pts/3`.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Port for Pty {
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        self.device.write_frame(frame)
    }

    fn read(
        &mut self,
        buffer: &mut [u8],
        timeout: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
        self.device.read(buffer, timeout)
    }
}
