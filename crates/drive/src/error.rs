//! Errors of the client: what failed, where, expected and found values, and what to do.
//!
//! Faults of the drive are errors like any other.

use std::fmt;

use protocol::canopen::nmt::NmtState;
use protocol::canopen::sdo::TransferError;
use protocol::epos2::cia402::DeviceState;
use protocol::epos2::objects::Address;
use protocol::epos2::{AbortCode, DeviceError};
use units::{DegPerS, DegPerS2, Degrees, Rpm, ShortNumber, Span};

use crate::command::CommandKind;

/// Reason why a command was refused or failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DriveError {
    /// The configuration is invalid.
    #[error("axis configuration: {field} must be {expected}, is {got}")]
    Config {
        /// Name of the field.
        field: &'static str,
        /// Valid values.
        expected: String,
        /// The value found.
        got: String,
    },
    /// The target is outside the configured limits or not a number; nothing was sent.
    #[error("{} deg is outside the axis' limits of {} to {} deg", ShortNumber(target.0), min.0, max.0)]
    Limits {
        /// Requested angle.
        target: Degrees,
        /// Lowest angle allowed.
        min: Degrees,
        /// Highest angle allowed.
        max: Degrees,
    },
    /// The speed is not within the axis' range; nothing was sent.
    #[error("speed {} deg/s is not between {} deg/s (1 rpm of the motor) and {} deg/s ({} rpm)",
        ShortNumber(requested.0), slowest.0, fastest.0, max_rpm.0)]
    Speed {
        /// Requested speed.
        requested: DegPerS,
        /// Lowest speed: one rpm of the motor.
        slowest: DegPerS,
        /// Highest speed of the configuration.
        fastest: DegPerS,
        /// Highest speed of the motor.
        max_rpm: Rpm,
    },
    /// The acceleration is not within the axis' range; nothing was sent.
    #[error("acceleration {} deg/s2 is not between {} and {} deg/s2", ShortNumber(requested.0), slowest.0, fastest.0)]
    Acceleration {
        /// Requested acceleration.
        requested: DegPerS2,
        /// Lowest acceleration: one rpm/s of the motor.
        slowest: DegPerS2,
        /// Highest acceleration of the configuration.
        fastest: DegPerS2,
    },
    /// Another command is running; only a stop may interrupt it.
    #[error("{requested} refused: {running} is still running")]
    Busy {
        /// The command that was refused.
        requested: CommandKind,
        /// The command that is running.
        running: CommandKind,
    },
    /// The command requires a connected drive.
    #[error("{requested} refused: the drive has not been connected and configured")]
    NotConnected {
        /// The command that was refused.
        requested: CommandKind,
    },
    /// The link works, but every reply to this request was lost.
    #[error("{operation} on the drive link: expected an answer, {} {attempts} time(s)",
        if *damaged { "got a damaged frame" } else { "got none in time" })]
    NoAnswer {
        /// The operation.
        operation: Operation,
        /// Number of attempts.
        attempts: u8,
        /// Whether the last reply was damaged rather than missing.
        damaged: bool,
    },
    /// The drive's replies come too late to guard a move.
    #[error("the drive link: expected replies within {:.0} ms, the quickest of several took {:.0} ms",
        limit.as_secs_f64() * 1e3, took.as_secs_f64() * 1e3)]
    SlowReplies {
        /// The quickest reply.
        took: Span,
        /// The limit: 80 % of the time limit of a reply while the axis moves.
        limit: Span,
    },
    /// The drive does not reply at all.
    #[error("{operation} on the drive link: expected an answer, got silence for {:.0} ms", silent.as_secs_f64() * 1e3)]
    LinkLost {
        /// The operation.
        operation: Operation,
        /// Duration of the silence.
        silent: Span,
    },
    /// No drive has the configured node id: the gateway's or the bus's other end does not reply.
    #[error("no answer from node {node} to the first request (object 1000:00)")]
    NodeAbsent {
        /// The node id.
        node: u8,
    },
    /// The drive would not notice the host's death, and on a bus nothing else would stop the axis.
    #[error("no move: the drive refuses to monitor this program's heartbeat (object 1016:01)")]
    HostNotMonitored,
    /// The drive refused the request in the handshake (RS232: `F` instead of `O`).
    #[error("{operation} on the drive link: expected the handshake O, got F {attempts} time(s)")]
    Handshake {
        /// The operation.
        operation: Operation,
        /// Number of attempts.
        attempts: u8,
    },
    /// A segmented transfer failed.
    #[error("{operation} in segments: {error}")]
    Transfer {
        /// The operation.
        operation: Operation,
        /// The violated rule.
        error: TransferError,
    },
    /// The object is written by the motion commands only; nothing was sent.
    #[error("object {address} cannot be written directly")]
    Reserved {
        /// The object.
        address: Address,
    },
    /// The drive's heartbeat is missing (CAN).
    #[error("node {node} on the CAN bus: expected a heartbeat, got none for {:.0} ms", silence.as_secs_f64() * 1e3)]
    NodeSilent {
        /// Its node id.
        node: u8,
        /// Time since the last heartbeat.
        silence: Span,
    },
    /// This program sent no heartbeat for longer than the drive tolerates, so the drive has stopped
    /// the axis and holds it (CAN).
    #[error("this program sent no heartbeat for {:.1} s while the axis could move: the drive has stopped it", silence.as_secs_f64())]
    HostSilent {
        /// Time between two heartbeats.
        silence: Span,
    },
    /// The drive left the NMT state operational, by another master's command (CAN).
    #[error("node {node} on the CAN bus: expected the state operational, got {state}")]
    NodeLeft {
        /// Its node id.
        node: u8,
        /// Its state.
        state: NmtState,
    },
    /// The drive restarted and lost its settings and position.
    #[error("the drive has restarted{}: its settings and position are lost", cause_text(*error))]
    Restarted {
        /// The newest entry of its error history (1003:1), if any.
        error: Option<DeviceError>,
    },
    /// The drive refused a request.
    #[error("{operation} refused by the drive: {error}")]
    Refused {
        /// The operation.
        operation: Operation,
        /// The drive's error code.
        error: AbortCode,
    },
    /// The drive confirmed a value but holds another.
    #[error("object {address} read back: expected {expected:#X}, got {got:#X}")]
    NotTaken {
        /// The object.
        address: Address,
        /// The value written.
        expected: u32,
        /// The value held.
        got: u32,
    },
    /// The drive's own configuration contradicts that of the axis, so that angles or motions would
    /// be wrong.
    #[error("object {address} ({name}): expected {expected}, got {got}")]
    Contradiction {
        /// The object.
        address: Address,
        /// Its name.
        name: &'static str,
        /// The values that fit the configuration.
        expected: String,
        /// The drive's value.
        got: i64,
        /// The key of the configuration to change instead, if there is one.
        key: Option<&'static str>,
    },
    /// The device is not a servo drive of maxon (CiA 402).
    #[error("object {address} ({what}): expected {expected:#X}, got {got:#X}")]
    WrongDevice {
        /// The object.
        address: Address,
        /// Its name.
        what: &'static str,
        /// The value of a maxon servo drive.
        expected: u32,
        /// The value of this device.
        got: u32,
    },
    /// The drive is in fault.
    #[error("the drive reports {}", fault_text(*error))]
    Fault {
        /// The newest entry of its error history (1003:1); `None` if the history is empty.
        error: Option<DeviceError>,
    },
    /// The fault cannot be cleared.
    #[error("the drive's fault does not clear: {}", fault_text(*error))]
    FaultStays {
        /// The newest entry of its error history (1003:1); `None` if the history is empty.
        error: Option<DeviceError>,
    },
    /// The drive is not in the state that the procedure requires.
    #[error("statusword 6041: expected {expected}, got {got:#06X} ({})", state_text(*got))]
    State {
        /// The required state.
        expected: &'static str,
        /// The statusword.
        got: u16,
    },
    /// The axis is not referenced.
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
    /// Homing exceeded its time limit.
    #[error("homing by method {method}: expected to be done within {:.1} s, statusword is {got:#06X}", limit.as_secs_f64())]
    HomingTime {
        /// Homing method.
        method: i8,
        /// The time limit.
        limit: Span,
        /// The last statusword.
        got: u16,
    },
    /// The axis is outside its limits.
    #[error("the axis is at {} deg, outside its limits of {} to {} deg", at.0, min.0, max.0)]
    Outside {
        /// Angle of the axis.
        at: Degrees,
        /// Lowest angle allowed.
        min: Degrees,
        /// Highest angle allowed.
        max: Degrees,
    },
    /// The axis did not settle at its target.
    #[error("expected the axis at {:.3} deg after {:.2} s, got {:.3} deg{}", target.0, waited.as_secs_f64(), position.0,
        if *reached { " (although the drive reports target reached)" } else { "" })]
    NotArrived {
        /// Target.
        target: Degrees,
        /// Last position.
        position: Degrees,
        /// Time since the start of the move.
        waited: Span,
        /// Whether the drive reported target reached (bit 10).
        reached: bool,
    },
    /// The samples show another motion than the plan.
    #[error("the axis {deviation}: expected {:.2} deg, got {:.2} deg", expected.0, got.0)]
    OffPlan {
        /// Deviation from the plan.
        deviation: Deviation,
        /// The nearest angle that the plan has at that time, or the limit.
        expected: Degrees,
        /// The angle of the sample.
        got: Degrees,
    },
    /// Homing moved further than the range of the axis without finding its reference.
    #[error("homing by method {method} moved the axis by {:.1} deg: expected its reference within {:.1} deg", travelled.0, bound.0)]
    HomingTravel {
        /// Homing method.
        method: i8,
        /// Distance from the start.
        travelled: Degrees,
        /// The range between the limits, the home offset and the margin.
        bound: Degrees,
    },
    /// Homing is on, and neither the demand nor the position moves.
    #[error("homing by method {method} has not moved the axis for {:.1} s, {:.2} deg from where it began", waited.as_secs_f64(), moved.0)]
    HomingRest {
        /// Homing method.
        method: i8,
        /// Distance from the start.
        moved: Degrees,
        /// Time without motion.
        waited: Span,
    },
    /// Homing ended at another position than the configured one.
    #[error("homing by method {method} ended at {:.2} deg: expected the home position, {:.2} deg", got.0, expected.0)]
    HomePosition {
        /// Homing method.
        method: i8,
        /// The home position (2081).
        expected: Degrees,
        /// Position after homing.
        got: Degrees,
    },
    /// A limit switch is pressed that a move must not reach, and the drive does not react.
    #[error("the {} limit switch is pressed (2071:1 is {inputs:#06X}), which the move must not reach", if *positive { "positive" } else { "negative" })]
    LimitSwitch {
        /// The positive switch, else the negative one.
        positive: bool,
        /// The inputs (2071:1).
        inputs: u16,
    },
    /// The axis does not stop.
    #[error("the axis still moves {:.2} s after the stop: at {:.2} deg{}", waited.as_secs_f64(), position.0,
        if *power_off { ", though its power was switched off" } else { "" })]
    StillMoving {
        /// Last position; from an arbitrary zero if the axis is not homed.
        position: Degrees,
        /// Time since the quick stop was sent.
        waited: Span,
        /// Whether the power stage was switched off, too.
        power_off: bool,
    },
    /// A move failed, and no stop of the axis could be confirmed.
    #[error("{cause}; and stopping the axis failed: {stop}")]
    NotStopped {
        /// Cause of the failed move.
        cause: Box<DriveError>,
        /// Cause of the failed stop.
        stop: Box<DriveError>,
    },
}

/// Deviation of a motion from its plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Deviation {
    /// It goes in the opposite direction.
    WrongWay,
    /// It is ahead of the plan, or beyond its target.
    Ahead,
    /// It is behind the plan, or does not move.
    Behind,
    /// It is beyond the limits of the axis.
    BeyondLimits,
}

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::WrongWay => "moves in the wrong direction",
            Self::Ahead => "is ahead of its plan",
            Self::Behind => "is behind its plan",
            Self::BeyondLimits => "is beyond its limits",
        })
    }
}

/// Read or write of an object, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Operation {
    /// The object.
    pub address: Address,
    /// The data of a write; `None` for a read.
    pub written: Option<WrittenData>,
}

/// Data of a write, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WrittenData {
    /// A number of up to four bytes.
    Value(u32),
    /// A number of bytes, in segments.
    Bytes(usize),
}

impl Operation {
    pub(crate) fn read(address: Address) -> Self {
        Self {
            address,
            written: None,
        }
    }
}

impl fmt::Display for Operation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.written {
            None => write!(f, "reading object {}", self.address),
            Some(WrittenData::Value(value)) => {
                write!(f, "writing {value:#X} to object {}", self.address)
            }
            Some(WrittenData::Bytes(len)) => {
                write!(f, "writing {len} bytes to object {}", self.address)
            }
        }
    }
}

fn state_text(statusword: u16) -> String {
    DeviceState::from_statusword(statusword)
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
    /// Advice for the user: a phrase without a full stop.
    #[must_use]
    pub fn help(&self) -> String {
        let help = match self {
            Self::Config { field, .. } => {
                return format!("correct {field} in the axis configuration");
            }
            Self::Limits { .. } => {
                "choose an angle within the limits, or widen them if the mechanics allow it"
            }
            Self::Speed { .. } | Self::Acceleration { .. } => {
                "choose a value within the range; its upper end is the configured maximum"
            }
            Self::Busy { .. } => "wait for it, or stop it first",
            Self::NotConnected { .. } => "connect first",
            Self::NoAnswer { damaged: true, .. } => {
                "check the cable and its shield; on RS232 check the baud rate"
            }
            Self::NoAnswer { .. } => {
                "the link works but loses replies: check the cable, and that no other program uses \
                 the port; a write may have been executed nevertheless"
            }
            Self::LinkLost { .. } => {
                "check the drive's supply, the cable, the port and the node id; if the axis was \
                 moving, assume that it still is"
            }
            Self::NodeAbsent { .. } => {
                "check that [axis] node of the configuration is the drive's node id (its DIP switch, \
                 object 2000), and its supply and cable"
            }
            Self::HostNotMonitored => {
                "connect the drive by USB or RS232, where a guardian process stops the axis if this \
                 program dies"
            }
            Self::Handshake { .. } => {
                "check the baud rate, and the cable and its shield; no other program may use the port"
            }
            Self::Transfer {
                error: TransferError::TooLong { .. },
                ..
            } => "read the object with the drive's own tool; no object of a tilt axis is that long",
            Self::Transfer { .. } => {
                "a reply was lost or duplicated: try again; if it fails again, check that no other \
                 master uses this drive"
            }
            Self::SlowReplies { .. } => {
                "the axis was not moved; find what delays the link: the latency timer of a USB adapter, \
                 a hub, a network between; connect the drive directly"
            }
            Self::Reserved { .. } => "use home, goto, sweep, stop or brake",
            Self::NodeSilent { .. } => {
                "check the drive's supply, the CAN wiring and termination; if the axis was moving, \
                 assume that it still is until a stop is confirmed"
            }
            Self::HostSilent { .. } => {
                "the program or the machine was suspended or stuck; move the axis again"
            }
            Self::NodeLeft { .. } => {
                "another master on the CAN bus changed the drive's state: stop it, then connect again"
            }
            Self::Restarted { .. } => {
                "check the drive's supply (a weak one resets the drive under load), then connect and \
                 home again"
            }
            Self::Refused { .. } | Self::NotTaken { .. } => {
                "check the firmware version, and close any other master (EPOS Studio) of the drive; \
                 the axis is left disabled"
            }
            Self::Contradiction { key, .. } => {
                let ours = key.map_or(String::new(), |key| {
                    format!("correct {key} in the configuration if the drive is right; else ")
                });
                return format!(
                    "{ours}set the object with the drive's own tool (EPOS Studio) and save it there"
                );
            }
            Self::WrongDevice { .. } => "another device is on this port or node id: check both",
            Self::Fault { error } | Self::FaultStays { error } => {
                error.and_then(DeviceError::meaning).map_or(
                    "clear the fault and try again; if it returns, restart the drive",
                    |known| known.remedy,
                )
            }
            Self::State { .. } => {
                "check the enable input and the supply of the power stage, then try again"
            }
            Self::NotReferenced { .. } => "home the axis first",
            Self::OffPlan { .. } => {
                "check encoder, coupling and gear, their settings (2210), and that nothing blocks or \
                 drives the axis; then home again; the tolerances are in [axis.guard] of the configuration"
            }
            Self::LimitSwitch { .. } => {
                "check the switch, its input and the drive's limit settings (2071:4), then home again"
            }
            Self::HomePosition { .. } => {
                "compare the drive's home position and offset (2081, 607C) with [axis.homing] of the configuration"
            }
            Self::Homing { .. }
            | Self::HomingTime { .. }
            | Self::HomingTravel { .. }
            | Self::HomingRest { .. } => {
                "check the switch the method searches for and its input, the homing direction and \
                 speeds, and that nothing blocks the axis"
            }
            Self::Outside { .. } => {
                "home again; if it persists, check the home position and limits of the configuration"
            }
            Self::NotArrived { .. } => {
                "check that nothing blocks the axis or holds the brake, then home again"
            }
            Self::StillMoving { .. } | Self::NotStopped { .. } => {
                "cut the drive's supply if the axis moves; do not trust its position before it is \
                 homed again"
            }
        };
        help.into()
    }
}
