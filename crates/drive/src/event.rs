//! What the client tells: samples, progress, and how a command ended.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::State;
use units::{Degrees, Host, Quadcounts, Stamp};

use crate::command::CommandKind;
use crate::error::DriveError;
use crate::plan::Plan;

/// A position of the shaft with the times between which the drive read it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShaftSample {
    /// When the request was handed out.
    pub request: Stamp<Host>,
    /// When the answer had been read.
    pub answer: Stamp<Host>,
    /// Position actual value (6064).
    pub position: Quadcounts,
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A sample of the shaft's position.
    Sample(ShaftSample),
    /// A step of the running command.
    Progress(Progress),
    /// The command is done.
    Done(Outcome),
    /// The command failed. A failed move or homing has been brought to rest unless the error is [`DriveError::NotStopped`]; a failed stop
    /// says what is known.
    Failed(DriveError),
}

/// A step of a command.
#[derive(Clone, Debug, PartialEq)]
pub enum Progress {
    /// The command's first step.
    Started(CommandKind),
    /// The drive said what it is.
    Identified(Identity),
    /// A fault was cleared.
    FaultCleared {
        /// What it had been, newest entry of the history.
        error: Option<DeviceError>,
    },
    /// Every setting was written and read back.
    Configured,
    /// The power stage is on and the brake open.
    Enabled,
    /// The drive took the target and moves; the plan starts now.
    Moving(Plan),
    /// The axis searches its home.
    Homing,
    /// A command failed and the axis was brought to rest; the failure follows.
    MadeSafe(Stopped),
}

/// How a command ended well.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// [`crate::Command::Connect`]
    Connected(Connected),
    /// [`crate::Command::Home`]
    Homed {
        /// Where the axis stands now.
        position: Quadcounts,
        /// The same as an angle.
        angle: Degrees,
    },
    /// [`crate::Command::Goto`] and [`crate::Command::Sweep`]
    Arrived(Arrived),
    /// [`crate::Command::Hold`]
    Held,
    /// [`crate::Command::Stop`] and [`crate::Command::Brake`]
    Stopped(Stopped),
    /// [`crate::Command::ClearFaults`]; the errors that were in the history, newest first.
    FaultsCleared(Vec<DeviceError>),
    /// [`crate::Command::Status`]
    Status(Status),
}

/// What the drive says it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Vendor (1018:1), 0xFB for maxon.
    pub vendor: u32,
    /// Product code (1018:2); its upper half is the hardware version.
    pub product: u32,
    /// Revision (1018:3); its upper half is the software version.
    pub revision: u32,
    /// Serial number (1018:4).
    pub serial: u32,
    /// Software version (2003:1), as hexadecimal digits.
    pub software: u16,
    /// Hardware version (2003:2), as hexadecimal digits.
    pub hardware: u16,
}

/// A drive that is ready to be used.
#[derive(Clone, Debug, PartialEq)]
pub struct Connected {
    /// What it is.
    pub identity: Identity,
    /// Its error history as found, newest first.
    pub history: Vec<DeviceError>,
    /// Whether it already knows its position.
    pub referenced: bool,
    /// Where it stands; an angle only if referenced.
    pub position: Quadcounts,
}

/// A completed move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrived {
    /// What was planned.
    pub plan: Plan,
    /// Where the axis came to rest.
    pub position: Quadcounts,
    /// The same as an angle.
    pub angle: Degrees,
    /// When the drive acknowledged the command to move.
    pub started: Stamp<Host>,
    /// When the axis was seen at its target.
    pub arrived: Stamp<Host>,
}

/// An axis at rest with the power stage off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stopped {
    /// Where it stands.
    pub position: Quadcounts,
    /// The same as an angle; `None` if the axis is not referenced.
    pub angle: Option<Degrees>,
    /// Whether the drive is in fault (power off and brake set all the same).
    pub fault: bool,
    /// Whether an output of the drive holds a brake.
    pub brake: bool,
}

/// State, position and errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Status {
    /// What the drive is.
    pub identity: Identity,
    /// Statusword (6041).
    pub statusword: u16,
    /// State; `None` for a statusword of no known state.
    pub state: Option<State>,
    /// Mode of operation shown (6061).
    pub mode: i8,
    /// Whether the axis knows where it is.
    pub referenced: bool,
    /// Where it stands.
    pub position: Quadcounts,
    /// The same as an angle; `None` if the axis is not referenced.
    pub angle: Option<Degrees>,
    /// Velocity (606C), rpm with sign.
    pub velocity_rpm: i32,
    /// Digital input functions (2071:1): bit 0 negative limit switch, bit 1 positive, bit 2 home switch.
    pub inputs: u16,
    /// Error history (1003), newest first.
    pub history: Vec<DeviceError>,
}
