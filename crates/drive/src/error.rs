//! What can go wrong between a command and the axis: what, where, expected, got; and what to do about it.
//!
//! Faults of the drive are values here like any other. Printing and exit codes are the binary's business.

use std::fmt;

use protocol::canopen::nmt::NmtState;
use protocol::epos2::cia402::State;
use protocol::epos2::objects::Address;
use protocol::epos2::{CommError, DeviceError};
use units::{DegPerS, DegPerS2, Degrees, Quadcounts, Rpm, Span};

use crate::command::CommandKind;

/// Why a command was refused or failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DriveError {
    /// The configuration describes no possible axis.
    #[error("axis configuration: {field} must be {expected}, is {got}")]
    Config {
        /// Name of the field.
        field: &'static str,
        /// What it may be.
        expected: String,
        /// What it is.
        got: String,
    },
    /// The target is outside the configured limits (or not a number); nothing was sent.
    #[error("target {} deg is outside the axis' limits of {} to {} deg", target.0, min.0, max.0)]
    Limits {
        /// Requested angle.
        target: Degrees,
        /// Lowest angle allowed.
        min: Degrees,
        /// Highest angle allowed.
        max: Degrees,
    },
    /// The speed is zero, negative, not a number, or beyond the axis; nothing was sent.
    #[error("speed {} deg/s is not between {} deg/s (1 rpm of the motor) and {} deg/s ({} rpm)",
        requested.0, slowest.0, fastest.0, max_rpm.0)]
    Speed {
        /// Requested speed.
        requested: DegPerS,
        /// Slowest speed the drive's whole rpm allow.
        slowest: DegPerS,
        /// Fastest speed the configuration allows.
        fastest: DegPerS,
        /// The same in rpm.
        max_rpm: Rpm,
    },
    /// The acceleration is zero, negative, not a number, or beyond the axis; nothing was sent.
    #[error("acceleration {} deg/s2 is not between {} and {} deg/s2", requested.0, slowest.0, fastest.0)]
    Acceleration {
        /// Requested acceleration.
        requested: DegPerS2,
        /// Smallest acceleration the drive's whole rpm/s allow.
        slowest: DegPerS2,
        /// Largest acceleration the configuration allows.
        fastest: DegPerS2,
    },
    /// Another command is running; only a stop may interrupt it.
    #[error("{asked} refused: {running} is still running")]
    Busy {
        /// The command that was refused.
        asked: CommandKind,
        /// The command that is running.
        running: CommandKind,
    },
    /// The command needs a connection.
    #[error("{asked} refused: the drive has not been connected and configured")]
    NotConnected {
        /// The command that was refused.
        asked: CommandKind,
    },
    /// The drive answers, but not this request.
    #[error("{operation} on the drive link: expected an answer, {} {attempts} time(s)",
        if *damaged { "got a damaged frame" } else { "got none in time" })]
    NoAnswer {
        /// What was asked.
        operation: Operation,
        /// How often.
        attempts: u8,
        /// Whether the last answer came damaged rather than not at all.
        damaged: bool,
    },
    /// The drive does not answer at all.
    #[error("{operation} on the drive link: expected an answer, got silence for {:.0} ms", silent.as_secs_f64() * 1e3)]
    LinkLost {
        /// What was asked.
        operation: Operation,
        /// How long nothing came.
        silent: Span,
    },
    /// The unit refuses a request before it looks at it (RS232: `F` instead of `O`).
    #[error("{operation} on the drive link: expected the handshake O, got F {attempts} time(s)")]
    Handshake {
        /// What was asked.
        operation: Operation,
        /// How often.
        attempts: u8,
    },
    /// A segment of a long object came out of turn.
    #[error("{operation} in segments: expected toggle bit {}, got {}", u8::from(*expected), u8::from(*got))]
    Toggle {
        /// What was asked.
        operation: Operation,
        /// As in the request.
        expected: bool,
        /// As in the answer.
        got: bool,
    },
    /// An object is longer than this client takes.
    #[error("{operation}: expected up to {most} bytes, got more")]
    TooLong {
        /// What was asked.
        operation: Operation,
        /// Bytes that are taken.
        most: usize,
    },
    /// The object is written by commands that watch over what comes of it, and by nobody else; nothing was sent.
    #[error("object {address} is not written by hand: the commands do it")]
    Reserved {
        /// The object.
        address: Address,
    },
    /// The drive sends no heartbeat any more (CAN).
    #[error("node {node} on the CAN bus: expected a heartbeat, got none for {:.0} ms", silence.as_secs_f64() * 1e3)]
    NodeSilent {
        /// Its node id.
        node: u8,
        /// Since the last one.
        silence: Span,
    },
    /// The drive left the operational state of the network: somebody else commands it (CAN).
    #[error("node {node} on the CAN bus: expected the state operational, got {state}")]
    NodeLeft {
        /// Its node id.
        node: u8,
        /// The state it is in.
        state: NmtState,
    },
    /// The drive has restarted: settings and position are forgotten.
    #[error("the drive has restarted{}: it has forgotten its settings and its position", cause_text(*error))]
    Restarted {
        /// The newest entry of its error history (1003:1), if it has one.
        error: Option<DeviceError>,
    },
    /// The drive refused a request.
    #[error("{operation} refused by the drive: {error}")]
    Refused {
        /// What was asked.
        operation: Operation,
        /// The drive's reason.
        error: CommError,
    },
    /// The drive acknowledged a value but kept another.
    #[error("object {address} read back: expected {expected:#X}, got {got:#X}")]
    NotTaken {
        /// The object.
        address: Address,
        /// What was written.
        expected: u32,
        /// What it holds.
        got: u32,
    },
    /// What answers is no EPOS2 servo drive.
    #[error("object {address} ({what}): expected {expected:#X}, got {got:#X}")]
    WrongDevice {
        /// The object.
        address: Address,
        /// Its name.
        what: &'static str,
        /// What an EPOS2 holds there.
        expected: u32,
        /// What this device holds there.
        got: u32,
    },
    /// The drive is in fault.
    #[error("the drive reports {}", fault_text(*error))]
    Fault {
        /// The newest entry of its error history (1003:1); `None` where the history is empty.
        error: Option<DeviceError>,
    },
    /// The fault does not clear.
    #[error("the drive's fault does not clear: {}", fault_text(*error))]
    FaultStays {
        /// The newest entry of its error history (1003:1); `None` where the history is empty.
        error: Option<DeviceError>,
    },
    /// The drive is not in the state the procedure needs.
    #[error("statusword 6041: expected {expected}, got {got:#06X} ({})", state_text(*got))]
    State {
        /// What it should have said.
        expected: &'static str,
        /// What it said.
        got: u16,
    },
    /// The axis does not know where it is.
    #[error("the axis is not referenced (bit 15 of statusword {got:#06X})")]
    NotReferenced {
        /// The statusword.
        got: u16,
    },
    /// The drive reports a homing error (bit 13).
    #[error("homing by method {method} failed: statusword {got:#06X} has bit 13, homing error")]
    Homing {
        /// Homing method.
        method: i8,
        /// The statusword.
        got: u16,
    },
    /// Homing took too long.
    #[error("homing by method {method}: expected to be done within {:.1} s, statusword is {got:#06X}", limit.as_secs_f64())]
    HomingTime {
        /// Homing method.
        method: i8,
        /// The time limit.
        limit: Span,
        /// The last statusword.
        got: u16,
    },
    /// The axis stands outside its limits.
    #[error("the axis stands at {} deg, outside its limits of {} to {} deg", at.0, min.0, max.0)]
    Outside {
        /// Where it stands.
        at: Degrees,
        /// Lowest angle allowed.
        min: Degrees,
        /// Highest angle allowed.
        max: Degrees,
    },
    /// The axis did not come to rest at its target.
    #[error("expected the axis at {} qc after {:.2} s, got {} qc{}", target.0, waited.as_secs_f64(), position.0,
        if *reached { " (yet the drive says target reached)" } else { "" })]
    NotArrived {
        /// Target.
        target: Quadcounts,
        /// Last position.
        position: Quadcounts,
        /// Time since the start of the move.
        waited: Span,
        /// Whether the drive itself said target reached (bit 10).
        reached: bool,
    },
    /// The axis does not come to rest.
    #[error("the axis still moves {:.2} s after the stop: at {} qc", waited.as_secs_f64(), position.0)]
    StillMoving {
        /// Last position.
        position: Quadcounts,
        /// Time since the quick stop was sent.
        waited: Span,
    },
    /// A move failed and the axis could not be brought to a stop that was seen.
    #[error("{cause}; and stopping the axis failed: {stop}")]
    NotStopped {
        /// Why the move failed.
        cause: Box<DriveError>,
        /// Why the stop failed.
        stop: Box<DriveError>,
    },
}

/// A read or write of an object, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operation {
    /// The object.
    pub address: Address,
    /// What was written, if it was a write.
    pub wrote: Option<Wrote>,
}

/// What was written, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrote {
    /// A number of up to four bytes.
    Value(u32),
    /// So many bytes, in segments.
    Bytes(usize),
}

impl Operation {
    pub(crate) fn read(address: Address) -> Self {
        Self {
            address,
            wrote: None,
        }
    }
}

impl fmt::Display for Operation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.wrote {
            None => write!(f, "reading object {}", self.address),
            Some(Wrote::Value(value)) => write!(f, "writing {value:#X} to object {}", self.address),
            Some(Wrote::Bytes(len)) => write!(f, "writing {len} bytes to object {}", self.address),
        }
    }
}

fn state_text(statusword: u16) -> String {
    State::from_statusword(statusword)
        .map_or_else(|| "no known state".into(), |state| state.to_string())
}

fn cause_text(error: Option<DeviceError>) -> String {
    error.map_or_else(String::new, |error| format!(" (it reports {error})"))
}

fn fault_text(error: Option<DeviceError>) -> String {
    error.map_or_else(
        || "a fault, but its error history is empty".into(),
        |error| format!("device error {error}"),
    )
}

impl DriveError {
    /// What to do next, in one or two sentences.
    #[must_use]
    pub fn help(&self) -> String {
        match self {
            Self::Config { field, .. } => format!("Correct {field} in the axis configuration."),
            Self::Limits { .. } => {
                "Choose a target within the limits, or widen them if the mechanics allow it.".into()
            }
            Self::Speed { .. } => {
                "Choose a speed within the range; the upper end is the configured maximum motor speed.".into()
            }
            Self::Acceleration { .. } => {
                "Choose an acceleration within the range; the upper end is the configured maximum.".into()
            }
            Self::Busy { .. } => "Wait for it, or stop it first.".into(),
            Self::NotConnected { .. } => "Connect first.".into(),
            Self::NoAnswer { damaged: true, .. } => {
                "Check the cable and its shield; on RS232 check the baud rate.".into()
            }
            Self::NoAnswer { .. } => {
                "The link works but drops answers: check the cable, and that no other program uses the port. \
                 A write may have taken effect all the same."
                    .into()
            }
            Self::LinkLost { .. } => {
                "Check the drive's supply, the cable, the port and the node id. \
                 If the axis was moving, treat it as moving still."
                    .into()
            }
            Self::Handshake { .. } => {
                "Check the baud rate, and the cable and its shield; no other program may use the port.".into()
            }
            Self::Toggle { .. } => {
                "An answer was lost or came twice: try again; if it stays, check that no other master asks this drive.".into()
            }
            Self::TooLong { .. } => {
                "Read the object with the drive's own tool; no object of a tilt axis is that long.".into()
            }
            Self::Reserved { .. } => "Use home, goto, sweep, stop or brake.".into(),
            Self::NodeSilent { .. } => {
                "Check the drive's supply, the CAN wiring and termination. If the axis was moving, treat it as moving still \
                 until a stop has been confirmed."
                    .into()
            }
            Self::NodeLeft { .. } => {
                "Another master on the CAN bus changed the drive's state: stop it, then connect again.".into()
            }
            Self::Restarted { .. } => {
                "Check the drive's supply (a weak one resets the drive under load), then connect and home again.".into()
            }
            Self::Refused { .. } | Self::NotTaken { .. } => {
                "Check the firmware version; the axis is left disabled. \
                 Another master (EPOS Studio) on the drive must be closed."
                    .into()
            }
            Self::WrongDevice { .. } => {
                "Another device is on this port or node id: check both.".into()
            }
            Self::Fault { error } | Self::FaultStays { error } => error
                .and_then(DeviceError::meaning)
                .map_or("clear the fault and try again; if it returns, restart the drive", |known| {
                    known.remedy
                })
                .into(),
            Self::State { .. } => {
                "Check the enable input and the supply of the power stage, then try again.".into()
            }
            Self::NotReferenced { .. } => "Home the axis first.".into(),
            Self::Homing { .. } | Self::HomingTime { .. } => {
                "Check the switch the method searches for and its input, the homing direction and speeds, \
                 and that nothing blocks the axis."
                    .into()
            }
            Self::Outside { .. } => {
                "Home again; if it persists, check the home position and limits of the configuration.".into()
            }
            Self::NotArrived { .. } => {
                "Check that nothing blocks the axis or holds the brake, then home again.".into()
            }
            Self::StillMoving { .. } | Self::NotStopped { .. } => {
                "Cut the drive's supply if the axis moves. Do not trust its position before it is homed again."
                    .into()
            }
        }
    }
}
