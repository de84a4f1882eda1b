//! The commands of the client.

use std::fmt;

use protocol::epos2::BoundedVec;
use protocol::epos2::objects::Address;
use units::{Degrees, Host, Rpm, RpmPerS, Stamp};

/// A procedure to run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveCommand {
    /// Identifies the drive, clears its power-on fault, configures it and verifies its safety
    /// functions.
    Connect,
    /// Runs the drive's homing.
    Home,
    /// Moves to an angle.
    Goto(MoveCommand),
    /// Moves to an angle, with samples at standstill before and after.
    Sweep(MoveCommand),
    /// Samples the position without motion.
    Hold {
        /// End of the hold.
        until: Stamp<Host>,
    },
    /// Stops, disables the power stage and lets the brake hold, or holds an axis without a brake if
    /// it is configured so. The only command that may interrupt another.
    Stop,
    /// Disables the power stage of an axis at rest, so that the brake holds, or holds it like
    /// [`DriveCommand::Stop`].
    Brake,
    /// Clears a fault; the axis stays disabled.
    ClearFaults,
    /// Reports state, position and errors without changing anything.
    Status,
    /// Reads any object of up to 256 bytes.
    Read(Address),
    /// Writes any object except the controlword (6040) while the power stage is off. The value is
    /// not checked; it lasts until the drive restarts or is connected again.
    Write {
        /// The object.
        address: Address,
        /// Its bytes in little-endian order, exactly as many as the object has.
        bytes: ObjectBytes,
    },
}

/// Bytes of an object. Writable objects of an EPOS2 have at most eight, except for the memory of
/// its data recorder.
pub type ObjectBytes = BoundedVec<u8, 64>;

/// An absolute move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveCommand {
    /// Target angle.
    pub to: Degrees,
    /// Cruise speed of the motor.
    pub speed: Rpm,
    /// Acceleration and deceleration of the motor.
    pub acceleration: RpmPerS,
}

/// The kind of a command, without its arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "each variant is that of DriveCommand")]
pub enum CommandKind {
    Connect,
    Home,
    Goto,
    Sweep,
    Hold,
    Stop,
    Brake,
    ClearFaults,
    Status,
    Read,
    Write,
}

impl DriveCommand {
    /// The kind of the command.
    #[must_use]
    pub fn kind(&self) -> CommandKind {
        match self {
            Self::Connect => CommandKind::Connect,
            Self::Home => CommandKind::Home,
            Self::Goto(_) => CommandKind::Goto,
            Self::Sweep(_) => CommandKind::Sweep,
            Self::Hold { .. } => CommandKind::Hold,
            Self::Stop => CommandKind::Stop,
            Self::Brake => CommandKind::Brake,
            Self::ClearFaults => CommandKind::ClearFaults,
            Self::Status => CommandKind::Status,
            Self::Read(_) => CommandKind::Read,
            Self::Write { .. } => CommandKind::Write,
        }
    }
}

impl fmt::Display for CommandKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ClearFaults => f.write_str("clear faults"),
            one_word => f.write_str(&format!("{one_word:?}").to_lowercase()),
        }
    }
}
