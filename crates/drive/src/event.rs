//! The events of the client: samples, progress and results of commands.

use std::fmt;

use protocol::epos2::cia402::DeviceState;
use protocol::epos2::objects::Address;
use protocol::epos2::{BoundedVec, DeviceError};
use units::{Degrees, Host, Quadcounts, Span, Stamp};

use crate::command::CommandKind;
use crate::error::DriveError;
use crate::plan::MovePlan;

/// A position of the shaft with bounds of the time at which the drive sampled it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShaftSample {
    /// Time at which the request was sent: on RS232 its body, for the stream of a CAN bus the SYNC.
    pub request: Stamp<Host>,
    /// Time at which the reply was read; for a listener on RS232, at which it was announced.
    pub answer: Stamp<Host>,
    /// Position actual value (6064).
    pub position: Quadcounts,
    /// Trigger of the sample.
    pub trigger: SampleTrigger,
    /// The drive's clock at the sample (1013) in us, with an arbitrary zero, wrapping every 71
    /// minutes; `None` if the reply does not contain it.
    pub drive_us: Option<u32>,
}

/// The trigger of a sample, which determines where between its two stamps it lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleTrigger {
    /// A read of object 6064: anywhere between request and reply.
    Request,
    /// A SYNC (CAN): within one control cycle of its arrival. `request` is when the SYNC was sent,
    /// `answer` when the process data arrived. If the match is uncertain, `request` is that of an
    /// earlier SYNC, never of a later one.
    Sync,
}

/// An event of the client.
#[derive(Clone, Debug, PartialEq)]
pub enum DriveEvent {
    /// A sample of the shaft's position.
    Sample(ShaftSample),
    /// A step of the running command.
    Progress(CommandProgress),
    /// The command succeeded.
    Done(CommandOutcome),
    /// The command failed. After a failed move or homing the axis is at rest, unless the error is
    /// [`DriveError::NotStopped`].
    Failed(DriveError),
}

/// A step of a command.
#[derive(Clone, Debug, PartialEq)]
pub enum CommandProgress {
    /// The command started.
    Started(CommandKind),
    /// The drive was identified.
    Identified(DriveIdentity),
    /// A fault was cleared.
    FaultCleared {
        /// The newest entry of the error history before.
        error: Option<DeviceError>,
    },
    /// Every setting was written and read back.
    Configured,
    /// The power stage is on and the brake open.
    Enabled,
    /// The drive accepted the target; the plan starts now.
    Moving(MovePlan),
    /// Homing started.
    Homing,
    /// Homing continues. This is not a sample, as the axis may lose its zero at any time.
    Searching {
        /// Time at which the drive reported the position.
        at: Stamp<Host>,
        /// Position demand value (6062), relative to the zero before homing.
        demand: Quadcounts,
    },
    /// The statusword (6041) was read.
    Statusword(u16),
    /// A quick stop did not bring the axis to rest; switching its power off did.
    PowerCut,
    /// An axis at rest moved by this after its power was switched off: its head fell, or the brake
    /// slipped.
    MovedAfterPowerOff(Degrees),
    /// The drive was silent for so long at the end of a move that the axis was stopped; it rests at
    /// its target.
    StoppedAtTarget(Span),
    /// A command failed and the axis was stopped; the failure follows.
    StoppedAfterFailure(StopReport),
}

/// Result of a successful command.
#[derive(Clone, Debug, PartialEq)]
pub enum CommandOutcome {
    /// Outcome of [`crate::DriveCommand::Connect`].
    Connected(ConnectionReport),
    /// Outcome of [`crate::DriveCommand::Home`].
    Homed {
        /// Position of the axis.
        position: Quadcounts,
        /// The position as an angle.
        angle: Degrees,
    },
    /// Outcome of [`crate::DriveCommand::Goto`] and [`crate::DriveCommand::Sweep`].
    Arrived(MoveReport),
    /// Outcome of [`crate::DriveCommand::Hold`].
    Held,
    /// Outcome of [`crate::DriveCommand::Stop`] and [`crate::DriveCommand::Brake`].
    Stopped(StopReport),
    /// Outcome of [`crate::DriveCommand::ClearFaults`]: the error history before, newest first.
    FaultsCleared(Vec<DeviceError>),
    /// Outcome of [`crate::DriveCommand::Status`].
    Status(DriveStatus),
    /// Outcome of [`crate::DriveCommand::Read`].
    Read {
        /// The object.
        address: Address,
        /// Its bytes in little-endian order.
        bytes: Vec<u8>,
    },
    /// Outcome of [`crate::DriveCommand::Write`].
    Written(Address),
}

/// Identity of the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct DriveIdentity {
    /// Device name (1008), "EPOS2".
    pub name: DeviceName,
    /// Vendor id (1018:1), 0xFB for maxon.
    pub vendor: u32,
    /// Product code (1018:2); its upper half is the hardware version.
    pub product: u32,
    /// Revision number (1018:3); its upper half is the software version.
    pub revision: u32,
    /// Serial number (1018:4).
    pub serial: u32,
    /// Software version (2003:1) in hexadecimal digits.
    pub software: u16,
    /// Hardware version (2003:2) in hexadecimal digits.
    pub hardware: u16,
}

/// Name of a device: up to 16 ASCII characters, empty if unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DeviceName(BoundedVec<u8, 16>);

impl DeviceName {
    /// The name in an object's bytes, up to the first that is not printable ASCII.
    pub(crate) fn new(bytes: &[u8]) -> Self {
        let is_printable = |byte: &u8| byte.is_ascii_graphic() || *byte == b' ';
        Self(bytes.iter().copied().take_while(is_printable).collect())
    }

    /// The name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        std::str::from_utf8(&self.0).unwrap_or_default()
    }
}

impl fmt::Display for DeviceName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// Source of the shaft samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleSource {
    /// Reads of the position.
    Polls,
    /// Process data with the drive's time, at each SYNC (CAN).
    Stream,
}

/// A connected drive.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ConnectionReport {
    /// Identity of the drive.
    pub identity: DriveIdentity,
    /// Error history as found, newest first.
    pub history: Vec<DeviceError>,
    /// Whether the axis is referenced.
    pub referenced: bool,
    /// Position; an angle only if referenced.
    pub position: Quadcounts,
    /// Source of the shaft samples.
    pub angle: AngleSource,
    /// Whether the drive stops on its own if the host fails during a motion (CAN heartbeat, object
    /// 1016). Otherwise the drive completes its move.
    pub monitors_host: bool,
}

/// A completed move.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MoveReport {
    /// The move as planned.
    pub plan: MovePlan,
    /// Final position.
    pub position: Quadcounts,
    /// The position as an angle.
    pub angle: Degrees,
    /// Time at which the drive confirmed the command to move.
    pub started: Stamp<Host>,
    /// Time at which the axis was observed at its target.
    pub arrived: Stamp<Host>,
}

/// An axis at rest, with the power stage off or held as configured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct StopReport {
    /// Position of the axis.
    pub position: Quadcounts,
    /// Validity of the position.
    pub validity: PositionValidity,
    /// The position as an angle; `None` unless it is valid.
    pub angle: Option<Degrees>,
    /// Whether the drive is in fault (with power off and brake set all the same).
    pub fault: bool,
    /// Whether an output of the drive controls a brake.
    pub brake: bool,
    /// Whether the power stage is on and holds the axis.
    pub held: bool,
}

/// Validity of the position of an axis at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PositionValidity {
    /// The axis is referenced and has not missed encoder counts since.
    Valid,
    /// The axis has not been homed.
    NotHomed,
    /// The axis lost its reference: home it again.
    Lost {
        /// The device error that reports it; `None` if the drive restarted or cleared its
        /// reference.
        error: Option<DeviceError>,
    },
}

impl fmt::Display for PositionValidity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Valid => f.write_str("position known"),
            Self::NotHomed => f.write_str("not homed"),
            Self::Lost { error: None } => f.write_str("position lost: home again"),
            Self::Lost { error: Some(error) } => {
                write!(f, "position lost by error {:04X}: home again", error.0)
            }
        }
    }
}

/// State, position and errors of the drive.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct DriveStatus {
    /// Identity of the drive.
    pub identity: DriveIdentity,
    /// Statusword (6041).
    pub statusword: u16,
    /// State; `None` if the statusword matches none.
    pub state: Option<DeviceState>,
    /// Modes of operation display (6061).
    pub mode: i8,
    /// Whether the axis is referenced.
    pub referenced: bool,
    /// Position actual value (6064).
    pub position: Quadcounts,
    /// The position as an angle; `None` if the axis is not referenced.
    pub angle: Option<Degrees>,
    /// Velocity actual value (606C), rpm.
    pub velocity_rpm: i32,
    /// Digital input functionalities (2071:1): bit 0 negative limit switch, bit 1 positive, bit 2
    /// home.
    pub inputs: u16,
    /// Error history (1003), newest first.
    pub history: Vec<DeviceError>,
}
