//! What the client tells: samples, progress, and how a command ended.

use std::fmt;

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::State;
use protocol::epos2::objects::Address;
use units::{Degrees, Host, Quadcounts, Stamp};

use crate::command::CommandKind;
use crate::error::DriveError;
use crate::plan::Plan;

/// A position of the shaft with the times between which the drive read it, and how far the drive itself narrows that down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShaftSample {
    /// When the request was handed out: on RS232 its body, on a CAN bus's stream the SYNC.
    pub request: Stamp<Host>,
    /// When the answer had been read; seen by a listener on RS232, when it was announced.
    pub answer: Stamp<Host>,
    /// Position actual value (6064).
    pub position: Quadcounts,
    /// What made the drive read it.
    pub taken: Taken,
    /// The drive's own clock as it latched the position (1013), in us: of no zero in particular, wrapping every 71 minutes. `None`
    /// where the answer does not carry it.
    pub device_us: Option<u32>,
}

/// What made the drive read its position, and so where between the two stamps it did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// It was asked for object 6064: anywhere between request and answer.
    Asked,
    /// It got a SYNC (CAN): `request` is when that was sent, and the position was latched within a control cycle of its
    /// arrival; `answer` is when the process data had come. Should it not be certain which SYNC it answers, `request` is of an
    /// older one, never of a later.
    AtSync,
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
    /// It is on its way there: where the drive wants it to be (6062), counted from whatever zero it had before. No sample: none of a shaft
    /// that loses its zero would be of use.
    Searching {
        /// When the drive said so.
        at: Stamp<Host>,
        /// Where.
        demand: Quadcounts,
    },
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
    /// [`crate::Command::Read`]
    Read {
        /// The object.
        address: Address,
        /// All of it, low byte first.
        bytes: Vec<u8>,
    },
    /// [`crate::Command::Write`]; the object.
    Written(Address),
}

/// What the drive says it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Device name (1008), "EPOS2".
    pub name: DeviceName,
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

/// The name a device gives itself: up to 16 bytes of ASCII, empty where it tells none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DeviceName {
    bytes: [u8; 16],
    len: usize,
}

impl DeviceName {
    /// The name in the bytes of an object: up to the first that is no printable ASCII, 16 at most.
    pub(crate) fn new(bytes: &[u8]) -> Self {
        let mut name = Self::default();
        let printable = bytes
            .iter()
            .take_while(|byte| byte.is_ascii_graphic() || **byte == b' ');
        for (to, from) in name.bytes.iter_mut().zip(printable) {
            *to = *from;
            name.len += 1;
        }
        name
    }

    /// The name.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let bytes = self.bytes.get(..self.len).unwrap_or_default();
        std::str::from_utf8(bytes).unwrap_or_default()
    }
}

impl fmt::Display for DeviceName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// Where the angle comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleSource {
    /// The position is asked for, again and again.
    Polls,
    /// The drive sends it at each SYNC, with its own time (CAN).
    Stream,
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
    /// Where the angle will come from.
    pub angle: AngleSource,
    /// Whether the drive stops by itself when the host falls silent during a motion (CAN: heartbeat, object 1016). Where it does
    /// not, an axis whose host dies ends its move.
    pub watches_host: bool,
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
    /// What that position is worth.
    pub place: Place,
    /// The same as an angle; `None` unless the place is known.
    pub angle: Option<Degrees>,
    /// Whether the drive is in fault (power off and brake set all the same).
    pub fault: bool,
    /// Whether an output of the drive holds a brake.
    pub brake: bool,
}

/// Whether an axis at rest still knows where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// It does: the encoder was read all the time.
    Known,
    /// It has not been homed.
    NotHomed,
    /// It has been homed, and does not know any more: home again.
    Lost {
        /// The device error that says so; `None` where the drive restarted or gave its reference up.
        error: Option<DeviceError>,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Known => f.write_str("position known"),
            Self::NotHomed => f.write_str("not homed"),
            Self::Lost { error: None } => f.write_str("position lost: home again"),
            Self::Lost { error: Some(error) } => {
                write!(f, "position lost by error {:04X}: home again", error.0)
            }
        }
    }
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
