//! The drive's port: bytes out and in, each with the host time at which it passed.
//!
//! A port knows no frames of the drive and no commands. Recording is a wrapper ([`Recorder`]),
//! never a flag inside.

mod delimit;
mod pty;
mod recorder;
mod serial;
pub(crate) mod wait;

use std::io;

use units::{Host, Span, Stamp};

pub use pty::Pty;
pub use recorder::Recorder;
pub use serial::{LatencyTimer, SerialPort};

/// A byte pipe to a device.
pub trait Port {
    /// Writes all of `frame`; the time just before the first byte was handed to the system.
    ///
    /// # Errors
    /// [`PortError::Disconnected`], [`PortError::WriteTimeout`], [`PortError::Io`].
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError>;

    /// Reads what has come, waiting for the first byte up to `timeout` (a span of zero or less: not
    /// at all): the number of bytes and the time just after they were read, or `None` if nothing
    /// came.
    ///
    /// # Errors
    /// [`PortError::Disconnected`], [`PortError::Io`].
    fn read(
        &mut self,
        buffer: &mut [u8],
        timeout: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError>;

    /// The time by which whoever uses this port keeps deadlines: it never steps
    /// ([`crate::clock::steady`]). Ports of a virtual world have their own.
    fn now(&self) -> Stamp<Host> {
        crate::clock::steady()
    }
}

macro_rules! forward {
    ($pointer:ty) => {
        impl<P: Port + ?Sized> Port for $pointer {
            fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
                (**self).write_frame(frame)
            }

            fn read(
                &mut self,
                buffer: &mut [u8],
                timeout: Span,
            ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
                (**self).read(buffer, timeout)
            }

            fn now(&self) -> Stamp<Host> {
                (**self).now()
            }
        }
    };
}

forward!(Box<P>);
forward!(&mut P);

/// Why a port could not be opened or used.
#[derive(Debug, thiserror::Error)]
pub enum PortError {
    /// There is no such device.
    #[error("port {port}: no such device")]
    NotFound {
        /// The port's path.
        port: String,
    },
    /// This user may not open it.
    #[error("port {port}: permission denied")]
    Permission {
        /// The port's path.
        port: String,
    },
    /// Another program has it.
    #[error("port {port}: in use by another program")]
    Busy {
        /// The port's path.
        port: String,
    },
    /// It is there, but is no serial port or does not take the settings.
    #[error("port {port}: expected a serial port at {baud} baud, got: {reason}")]
    Unsuitable {
        /// The port's path.
        port: String,
        /// The speed asked for.
        baud: u32,
        /// The system's words.
        reason: String,
    },
    /// The device went away: unplugged, switched off, or the other side of a pseudo-terminal
    /// closed.
    #[error("port {port}: disconnected ({reason})")]
    Disconnected {
        /// The port's path.
        port: String,
        /// The system's words.
        reason: String,
    },
    /// The device takes no bytes.
    #[error("port {port}: expected to write {expected} bytes, got rid of {got} in 0.5 s")]
    WriteTimeout {
        /// The port's path.
        port: String,
        /// Bytes of the frame.
        expected: usize,
        /// Bytes that went out.
        got: usize,
    },
    /// The system refused for another reason.
    #[error("port {port}: cannot {action}: {source}")]
    Io {
        /// The port's path.
        port: String,
        /// `open`, `read` or `write`.
        action: &'static str,
        /// The system's reason.
        source: io::Error,
    },
}
