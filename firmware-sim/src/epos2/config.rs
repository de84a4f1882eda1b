//! What is fixed about a simulated unit: who it is, and the mechanics it is built into.
//!
//! Positions here are world positions: quadcounts of the motor shaft from a zero that never moves, whatever the drive
//! believes after power-on or homing.

use protocol::epos2::DeviceError;

pub use super::servo::Servo;

/// The most switches an axis has.
pub const MAX_SWITCHES: usize = 4;

/// A unit and its axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeConfig {
    /// CANopen node id, 1..=127.
    pub node_id: u8,
    /// What the unit says about itself.
    pub identity: UnitIdentity,
    /// Quadcounts in a turn of the motor (four per encoder line), up to 10,000,000; also what 2210:1 has at first.
    pub qc_per_turn: u32,
    /// Where the shaft is at power-on, world qc. The unit calls that place 0.
    pub initial_position: i32,
    /// World position of one of the encoder's index pulses, qc; the others are whole turns away.
    pub index_position: i32,
    /// Where the mechanics end, world qc: below, above. The shaft goes no farther, whatever its demand does.
    pub hard_stops: [Option<i32>; 2],
    /// How the shaft follows its demand; `None`: exactly.
    pub servo: Option<Servo>,
    /// The switches on the digital inputs.
    pub switches: [Option<Switch>; MAX_SWITCHES],
    /// The error that the unit has at power-on, such as [`DeviceError::CAN_PASSIVE`] where no CAN bus is connected.
    pub fault_at_power_on: DeviceError,
}

/// What the unit says about itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitIdentity {
    /// 1018:2; its high word is the hardware version (2003:2).
    pub product_code: u32,
    /// 1018:3; its high word is the software version (2003:1).
    pub revision: u32,
    /// 2004, its low half also 1018:4.
    pub serial_number: u64,
}

/// A switch on the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Switch {
    /// The digital input it is wired to, 1..=9.
    pub input: u8,
    /// Where the axis presses it.
    pub pressed: Region,
    /// Whether the input is low while the switch is pressed, rather than high.
    pub normally_closed: bool,
}

/// A range of world positions, qc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// This position and all below.
    AtMost(i32),
    /// This position and all above.
    AtLeast(i32),
    /// From the first to the second, both included.
    Within(i32, i32),
}

impl Region {
    /// Whether a position, world qc, lies in it.
    #[must_use]
    pub fn contains(self, position: i64) -> bool {
        match self {
            Self::AtMost(end) => position <= i64::from(end),
            Self::AtLeast(begin) => position >= i64::from(begin),
            Self::Within(begin, end) => (i64::from(begin)..=i64::from(end)).contains(&position),
        }
    }
}

impl Default for UnitIdentity {
    /// An EPOS2 70/10, hardware 6420, software 2126; the serial number is the simulator's own.
    fn default() -> Self {
        Self {
            product_code: 0x6420_0000,
            revision: 0x2126_0000,
            serial_number: 0x5349_4D55_0000_0001,
        }
    }
}

impl Default for NodeConfig {
    /// A tilt axis of 500 lines behind 120:1 (0.0015 deg/qc) whose world zero is level: limit switches 65 degrees either side on the
    /// inputs that are the factory's choice (6 negative, 5 positive), no hard stops, no lag, 4.5 degrees down at power-on, and the fault of
    /// a unit that is used over USB alone.
    fn default() -> Self {
        let limit = |input, pressed| {
            Some(Switch {
                input,
                pressed,
                normally_closed: false,
            })
        };
        Self {
            node_id: 1,
            identity: UnitIdentity::default(),
            qc_per_turn: 2000,
            initial_position: -3_000,
            index_position: 700,
            hard_stops: [None; 2],
            servo: None,
            switches: [
                limit(6, Region::AtMost(-43_334)),
                limit(5, Region::AtLeast(43_334)),
                None,
                None,
            ],
            fault_at_power_on: DeviceError::CAN_PASSIVE,
        }
    }
}
