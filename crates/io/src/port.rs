//! The drive's port: bytes sent and received, with their host times.
//!
//! A port does not interpret bytes. [`RecordingPort`] is a wrapper that records them.

mod child;
mod delimit;
mod descriptor;
mod pty;
mod recording_port;
mod serial;
pub(crate) mod wait;

use std::io;

use units::{Host, Span, Stamp};

pub use child::{PortChild, shared_port};
pub use descriptor::DescriptorPort;
pub use pty::Pty;
pub use recording_port::RecordingPort;
pub use serial::{LatencyTimer, SerialPort};

/// A byte stream to a device.
pub trait Port {
    /// Writes all of `frame` and returns the time just before the first system call.
    ///
    /// # Errors
    /// [`PortError::Disconnected`], [`PortError::WriteTimeout`], [`PortError::Io`].
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError>;

    /// Reads the bytes that arrived, waiting for the first one up to `timeout` (zero or less: not
    /// at all). Returns their number and the time just after the read, or `None`.
    ///
    /// # Errors
    /// [`PortError::Disconnected`], [`PortError::Io`].
    fn read(
        &mut self,
        buffer: &mut [u8],
        timeout: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError>;

    /// The clock for deadlines on this port, which never steps ([`crate::clock::steady`]).
    /// Simulated ports have their own.
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

/// Failure to open or use a port.
#[derive(Debug, thiserror::Error)]
pub enum PortError {
    /// No such device exists.
    #[error("port {port}: no such device")]
    NotFound {
        /// The port's path.
        port: String,
    },
    /// The user has no permission to open it.
    #[error("port {port}: permission denied")]
    Permission {
        /// The port's path.
        port: String,
    },
    /// Another program uses it.
    #[error("port {port}: in use by {by}")]
    Busy {
        /// The port's path.
        port: String,
        /// The programs that have it open.
        by: String,
    },
    /// The device is no serial port or refuses the settings.
    #[error("port {port}: expected a serial port at {baud} baud, got: {reason}")]
    Unsuitable {
        /// The port's path.
        port: String,
        /// The requested baud rate.
        baud: u32,
        /// The system's message.
        reason: String,
    },
    /// The device is gone: unplugged, switched off, or the other side of a pseudo-terminal closed.
    #[error("port {port}: disconnected ({reason})")]
    Disconnected {
        /// The port's path.
        port: String,
        /// The system's message.
        reason: String,
    },
    /// The device accepts no bytes.
    #[error("port {port}: expected to write {expected} bytes, wrote {got} in 0.5 s")]
    WriteTimeout {
        /// The port's path.
        port: String,
        /// Bytes of the frame.
        expected: usize,
        /// Bytes written.
        got: usize,
    },
    /// Another system call failed.
    #[error("port {port}: cannot {action}: {source}")]
    Io {
        /// The port's path.
        port: String,
        /// `open`, `read` or `write`.
        action: &'static str,
        /// The system's error.
        source: io::Error,
    },
}
