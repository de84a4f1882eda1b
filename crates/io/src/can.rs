//! The drive's CAN bus: frames out and in, each with the host time at which it passed.
//!
//! Two ways to a bus: an interface of the kernel ([`SocketCan`]), and an adapter on a serial port
//! that speaks SLCAN ([`Slcan`]). Nothing here knows CANopen. Recording is a wrapper
//! ([`Recorder`]), never a flag inside. Interfaces are found and used, not set up: that takes the
//! administrator's rights, and errors say the command.

mod interfaces;
mod recorder;
mod slcan;
mod socket;

use std::io;

use protocol::canopen::CanFrame;
use units::{Host, Span, Stamp};

pub use interfaces::{Interface, interfaces};
pub use recorder::Recorder;
pub use slcan::Slcan;
pub use socket::SocketCan;

use crate::port::PortError;

/// A way to a CAN bus.
pub trait CanPort {
    /// Sends a frame; the time just before it was handed to the system. Whether it reached the bus
    /// shows only in what comes back.
    ///
    /// # Errors
    /// [`CanError`].
    fn write_frame(&mut self, frame: &CanFrame) -> Result<Stamp<Host>, CanError>;

    /// The next frame from the bus, and when it came; `None` if none comes within `timeout` (a span
    /// of zero or less: if none is there). Frames sent here do not come back.
    ///
    /// # Errors
    /// [`CanError`]. After [`CanError::NotSent`] the port goes on.
    fn read(&mut self, timeout: Span) -> Result<Option<(CanFrame, Stamp<Host>)>, CanError>;

    /// Frames of the bus that are known to have been lost between it and this program, at least so
    /// many. A loss shows with what is read after it, if at all.
    fn dropped(&self) -> u64;

    /// What the bus is called: the interface's name, or `SLCAN`.
    fn name(&self) -> &str;

    /// The time by which whoever uses this port keeps deadlines: it never steps
    /// ([`crate::clock::steady`]). Ports of a virtual world have their own.
    fn now(&self) -> Stamp<Host> {
        crate::clock::steady()
    }
}

impl<P: CanPort + ?Sized> CanPort for Box<P> {
    fn write_frame(&mut self, frame: &CanFrame) -> Result<Stamp<Host>, CanError> {
        (**self).write_frame(frame)
    }

    fn read(&mut self, timeout: Span) -> Result<Option<(CanFrame, Stamp<Host>)>, CanError> {
        (**self).read(timeout)
    }

    fn dropped(&self) -> u64 {
        (**self).dropped()
    }

    fn name(&self) -> &str {
        (**self).name()
    }

    fn now(&self) -> Stamp<Host> {
        (**self).now()
    }
}

/// Why a bus could not be reached or used.
#[derive(Debug, thiserror::Error)]
pub enum CanError {
    /// The kernel was built without CAN, or its module is not loaded.
    #[error(
        "CAN interface {interface}: this kernel has no CAN; load it with `sudo modprobe can_raw`, or use an SLCAN adapter on a serial port, which needs none"
    )]
    NoCan {
        /// The interface asked for.
        interface: String,
    },
    /// There is no such interface.
    #[error(
        "CAN interface {interface}: no such interface, expected one of: {}",
        list(known)
    )]
    NoInterface {
        /// The interface asked for.
        interface: String,
        /// The CAN interfaces there are.
        known: Vec<String>,
    },
    /// It is an interface, but of another kind of network.
    #[error(
        "CAN interface {interface}: not a CAN interface, expected one of: {}",
        list(known)
    )]
    NotCan {
        /// The interface asked for.
        interface: String,
        /// The CAN interfaces there are.
        known: Vec<String>,
    },
    /// The interface is down: never set up, or taken down while in use.
    #[error("CAN interface {interface}: it is down; bring it up with `{command}`")]
    Down {
        /// The interface.
        interface: String,
        /// What brings it up.
        command: String,
    },
    /// The interface went away while in use.
    #[error("CAN interface {interface}: disconnected")]
    Disconnected {
        /// The interface.
        interface: String,
    },
    /// The interface's queue stays full: no other node acknowledges what is sent.
    #[error(
        "CAN interface {interface}: expected to send a frame, got rid of none in 0.5 s: is the drive on, the bus terminated, the bit rate right?"
    )]
    WriteTimeout {
        /// The interface.
        interface: String,
    },
    /// An SLCAN adapter refused a command when it was opened.
    #[error("SLCAN adapter: refused {command}, expected CR")]
    Refused {
        /// The command.
        command: String,
    },
    /// An SLCAN adapter did not take a frame: its buffer is full or its channel was closed.
    #[error("SLCAN adapter: a frame was refused and is lost")]
    NotSent,
    /// The adapter's serial port.
    #[error(transparent)]
    Port(#[from] PortError),
    /// The system refused for another reason.
    #[error("CAN interface {interface}: cannot {action}: {source}")]
    Io {
        /// The interface.
        interface: String,
        /// `open`, `read` or `write`.
        action: &'static str,
        /// The system's reason.
        source: io::Error,
    },
}

impl From<CanError> for PortError {
    /// For whoever treats a bus as a port: the port is the interface.
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
                "got rid of no frame in 0.5 s: is the drive on, the bus terminated, the bit rate right?"
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
            error @ (CanError::NoCan { .. } | CanError::NotCan { .. }) => {
                let what = error.to_string();
                io("CAN", "open", io::ErrorKind::Unsupported, what)
            }
            error @ (CanError::Refused { .. } | CanError::NotSent) => {
                io("SLCAN", "write", io::ErrorKind::Other, error.to_string())
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
    fn a_bus_as_a_port_keeps_its_name_and_what_to_do() {
        let interface = || "can0".to_owned();
        let command = "sudo ip link set can0 up".to_owned();
        let denied = io::Error::from(io::ErrorKind::PermissionDenied);
        for (error, said) in [
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
                "port can0: cannot write: got rid of no frame in 0.5 s: is the drive on, the bus terminated, the bit rate right?",
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
                }),
                "port /dev/ttyACM0: in use by another program",
            ),
        ] {
            assert_eq!(PortError::from(error).to_string(), said);
        }
    }
}
