//! The drive's CAN bus: frames sent and received, each with its host time.
//!
//! A bus is reached through an interface of the kernel ([`SocketCan`]) or an SLCAN adapter on a
//! serial port ([`Slcan`]). Configuring an interface needs administrator rights, so errors name the
//! command instead.

mod interfaces;
mod slcan;
mod socket;

use std::io;

use protocol::canopen::CanFrame;
use units::{Host, Span, Stamp};

pub use interfaces::{CanInterface, interfaces, up_command};
pub use slcan::Slcan;
pub use socket::SocketCan;

use crate::port::PortError;

/// A CAN bus.
pub trait CanPort {
    /// Sends a frame and returns the time just before the system call. Success does not mean that
    /// the frame reached the bus.
    ///
    /// # Errors
    /// [`CanError`].
    fn write_frame(&mut self, frame: &CanFrame) -> Result<Stamp<Host>, CanError>;

    /// The next frame from the bus and its time; `None` if none arrives within `timeout` (zero or
    /// less: if none is waiting). Own frames are not returned.
    ///
    /// # Errors
    /// [`CanError`]. After [`CanError::NotSent`] the port remains usable.
    fn read(&mut self, timeout: Span) -> Result<Option<(CanFrame, Stamp<Host>)>, CanError>;

    /// Lower bound of the frames lost between the bus and this program. A loss is reported with a
    /// later frame, if at all.
    fn dropped(&self) -> u64;

    /// Name of the interface, or `SLCAN`.
    fn name(&self) -> &str;

    /// The clock for deadlines on this port, which never steps ([`crate::clock::steady`]).
    /// Simulated ports have their own.
    fn now(&self) -> Stamp<Host> {
        crate::clock::steady()
    }
}

/// Failure to open or use a bus.
#[derive(Debug, thiserror::Error)]
pub enum CanError {
    /// The kernel has no CAN support, or its module is not loaded.
    #[error(
        "CAN interface {interface}: this kernel has no CAN; load it with `sudo modprobe can_raw`, or use an SLCAN adapter on a serial port, which needs none"
    )]
    NoCan {
        /// The requested interface.
        interface: String,
    },
    /// No such interface exists.
    #[error(
        "CAN interface {interface}: no such interface, expected one of: {}",
        list(known)
    )]
    NoInterface {
        /// The requested interface.
        interface: String,
        /// The existing CAN interfaces.
        known: Vec<String>,
    },
    /// The interface is of another kind of network.
    #[error(
        "CAN interface {interface}: not a CAN interface, expected one of: {}",
        list(known)
    )]
    NotCan {
        /// The requested interface.
        interface: String,
        /// The existing CAN interfaces.
        known: Vec<String>,
    },
    /// The interface is down.
    #[error("CAN interface {interface}: it is down; bring it up with `{command}`")]
    Down {
        /// The interface.
        interface: String,
        /// Command that brings it up.
        command: String,
    },
    /// The interface disappeared while in use.
    #[error("CAN interface {interface}: disconnected")]
    Disconnected {
        /// The interface.
        interface: String,
    },
    /// The interface's queue stays full: no other node acknowledges frames.
    #[error(
        "CAN interface {interface}: sent no frame in 0.5 s: is the drive on, the bus terminated, the bit rate right?"
    )]
    WriteTimeout {
        /// The interface.
        interface: String,
    },
    /// An SLCAN adapter refused a command while opening.
    #[error("SLCAN adapter: refused {command}, expected CR")]
    Refused {
        /// The command.
        command: String,
    },
    /// An SLCAN adapter refused a frame: its buffer is full or its channel was closed.
    #[error("SLCAN adapter: refused a frame, which is lost")]
    NotSent,
    /// The adapter's serial port.
    #[error(transparent)]
    Port(#[from] PortError),
    /// Another system call failed.
    #[error("CAN interface {interface}: cannot {action}: {source}")]
    Io {
        /// The interface.
        interface: String,
        /// `open`, `read` or `write`.
        action: &'static str,
        /// The system's error.
        source: io::Error,
    },
}

impl From<CanError> for PortError {
    /// For a bus that is used as a port: the port is the interface.
    fn from(error: CanError) -> Self {
        let io = |port: &str, action, kind, what: String| Self::Io {
            port: port.to_owned(),
            action,
            source: io::Error::new(kind, what),
        };
        match error {
            CanError::Port(error) => error,
            CanError::NoInterface { interface, .. } => Self::NotFound { port: interface },
            CanError::Down { interface, command } => Self::Disconnected {
                port: interface,
                reason: format!("it is down; bring it up with `{command}`"),
            },
            CanError::Disconnected { interface } => Self::Disconnected {
                port: interface,
                reason: "the interface is gone".to_owned(),
            },
            CanError::WriteTimeout { interface } => io(
                &interface,
                "write",
                io::ErrorKind::TimedOut,
                "sent no frame in 0.5 s: is the drive on, the bus terminated, the bit rate right?"
                    .to_owned(),
            ),
            CanError::Io {
                interface,
                action,
                source,
            } => Self::Io {
                port: interface,
                action,
                source,
            },
            error => {
                let what = error.to_string();
                io("CAN", "open", io::ErrorKind::Unsupported, what)
            }
        }
    }
}

fn list(names: &[String]) -> String {
    if names.is_empty() {
        "(there is none)".to_owned()
    } else {
        names.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn port_errors_keep_the_interface_and_the_advice() {
        let interface = || "can0".to_owned();
        let command = "sudo ip link set can0 up".to_owned();
        let denied = io::Error::from(io::ErrorKind::PermissionDenied);
        for (error, expected) in [
            (
                CanError::Down {
                    interface: interface(),
                    command,
                },
                "port can0: disconnected (it is down; bring it up with `sudo ip link set can0 up`)",
            ),
            (
                CanError::Disconnected {
                    interface: interface(),
                },
                "port can0: disconnected (the interface is gone)",
            ),
            (
                CanError::WriteTimeout {
                    interface: interface(),
                },
                "port can0: cannot write: sent no frame in 0.5 s: is the drive on, the bus terminated, the bit rate right?",
            ),
            (
                CanError::Io {
                    interface: interface(),
                    action: "read",
                    source: denied,
                },
                "port can0: cannot read: permission denied",
            ),
            (
                CanError::NoInterface {
                    interface: interface(),
                    known: Vec::new(),
                },
                "port can0: no such device",
            ),
            (
                CanError::Port(PortError::Busy {
                    port: "/dev/ttyACM0".to_owned(),
                    by: "screen (pid 7)".to_owned(),
                }),
                "port /dev/ttyACM0: in use by screen (pid 7)",
            ),
        ] {
            assert_eq!(PortError::from(error).to_string(), expected);
        }
    }
}
