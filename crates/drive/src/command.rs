//! What the client can be asked to do.

use std::fmt;

use protocol::epos2::Bounded;
use protocol::epos2::objects::Address;
use units::{Degrees, Host, Rpm, RpmPerS, Stamp};

/// A procedure to run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Identify the drive, clear its power-on fault, configure it and verify that its safety functions took.
    Connect,
    /// Find the home position.
    Home,
    /// Move to an angle.
    Goto(Move),
    /// Move to an angle, sampled also at standstill before and after.
    Sweep(Move),
    /// Sample where the axis stands until this time.
    Hold {
        /// End of the hold.
        until: Stamp<Host>,
    },
    /// Stop at once, disable the power stage and let the brake hold. The only command that may interrupt another.
    Stop,
    /// Disable the power stage of an axis at rest, so that the brake holds.
    Brake,
    /// Clear a fault; the axis stays disabled.
    ClearFaults,
    /// Report state, position and errors; changes nothing.
    Status,
    /// Read any object, of whatever length up to 256 bytes.
    Read(Address),
    /// Write any object but the controlword (6040) while the power stage is off. What is written is not looked at, and stays until the
    /// drive restarts or is connected to.
    Write {
        /// The object.
        address: Address,
        /// Its bytes, low byte first, as many as the object has: up to four go in one exchange, more in segments.
        bytes: ObjectBytes,
    },
}

/// Bytes of an object. The longest that an EPOS2 lets anybody write have eight, but for the memory of its data recorder.
pub type ObjectBytes = Bounded<u8, 64>;

/// An absolute move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Target angle.
    pub to: Degrees,
    /// Cruise speed of the motor.
    pub speed: Rpm,
    /// Acceleration and deceleration of the motor.
    pub acceleration: RpmPerS,
}

/// The name of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandKind {
    /// [`Command::Connect`]
    Connect,
    /// [`Command::Home`]
    Home,
    /// [`Command::Goto`]
    Goto,
    /// [`Command::Sweep`]
    Sweep,
    /// [`Command::Hold`]
    Hold,
    /// [`Command::Stop`]
    Stop,
    /// [`Command::Brake`]
    Brake,
    /// [`Command::ClearFaults`]
    ClearFaults,
    /// [`Command::Status`]
    Status,
    /// [`Command::Read`]
    Read,
    /// [`Command::Write`]
    Write,
}

impl Command {
    /// Its name.
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
        f.write_str(match self {
            Self::Connect => "connect",
            Self::Home => "home",
            Self::Goto => "goto",
            Self::Sweep => "sweep",
            Self::Hold => "hold",
            Self::Stop => "stop",
            Self::Brake => "brake",
            Self::ClearFaults => "clear faults",
            Self::Status => "status",
            Self::Read => "read",
            Self::Write => "write",
        })
    }
}
