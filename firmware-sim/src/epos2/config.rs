//! Configuration of a simulated drive: its identity and the mechanics of its axis.
//!
//! Positions are world positions: quadcounts of the motor shaft from a fixed zero, independent of
//! power-on and homing.

use protocol::epos2::DeviceError;

pub use super::servo::Servo;

/// Largest number of switches.
pub const MAX_SWITCHES: usize = 4;

/// A drive and its axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SimulatedDriveConfig {
    /// CANopen node id, 1..=127.
    pub node_id: u8,
    /// Identity data in the dictionary.
    pub identity: UnitIdentity,
    /// Quadcounts in one revolution of the motor (four per encoder line), up to 10,000,000; the
    /// initial value of 2210:1 follows from it.
    pub qc_per_turn: u32,
    /// Position of the shaft at power-on, world qc. The drive counts from there.
    pub initial_position: i32,
    /// World position of one index pulse of the encoder, qc; the others are whole revolutions away.
    pub index_position: i32,
    /// Hard stops, world qc: below, above. They stop the shaft, not its demand.
    pub hard_stops: [Option<i32>; 2],
    /// Model of the servo; `None`: the shaft follows exactly.
    pub servo: Option<Servo>,
    /// Gravity and friction on the shaft without power; `None`: an unpowered shaft stays in place.
    pub load: Option<AxisLoad>,
    /// Whether 6064 is renewed once per control cycle of 1 ms; else it is the count at the request.
    pub latches_position: bool,
    /// Largest deviation of the encoder's count from the shaft at rest under power, qc.
    pub dither_qc: u8,
    /// The switches on the digital inputs.
    pub switches: [Option<Switch>; MAX_SWITCHES],
    /// Error at power-on, such as [`DeviceError::CAN_PASSIVE`] without a CAN bus.
    pub fault_at_power_on: DeviceError,
}

/// Gravity and friction on the shaft while the power stage is off, as accelerations of the motor in
/// rpm/s. The power stage overcomes gravity and friction without deviation, but not a closed brake.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AxisLoad {
    /// Acceleration of the free axis by gravity, positive towards higher positions; the same at
    /// every angle.
    pub gravity_rpm_s: i32,
    /// Deceleration by friction. An axis at rest stays so while friction is not below gravity.
    pub friction_rpm_s: u32,
    /// The holding brake; `None`: not fitted, whatever the outputs of the drive say.
    pub brake: Option<HoldingBrake>,
}

/// A brake that a spring closes. It opens while a digital output of the drive is configured for it
/// and released, and holds the axis otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HoldingBrake {
    /// Time from the output's change until the axis is free, ms.
    pub opening_ms: u16,
    /// Time from the output's change until the axis is held, ms.
    pub closing_ms: u16,
    /// Deceleration by the closed brake in addition to friction. Less than gravity: a worn brake
    /// that slips.
    pub holding_rpm_s: u32,
}

/// Identity data in the dictionary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitIdentity {
    /// 1018:2; its high word is the hardware version (2003:2).
    pub product_code: u32,
    /// 1018:3; its high word is the software version (2003:1).
    pub revision: u32,
    /// 2004; the low half is also 1018:4.
    pub serial_number: u64,
}

/// A switch on the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Switch {
    /// Number of its digital input, 1..=9.
    pub input: u8,
    /// Positions at which the axis actuates it.
    pub pressed: Region,
    /// Whether the input is low while the switch is actuated.
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
    /// Whether a position, world qc, is in the region.
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
    /// An EPOS2 70/10, hardware 6420, software 2126; the serial number marks a simulator.
    fn default() -> Self {
        Self {
            product_code: 0x6420_0000,
            revision: 0x2126_0000,
            serial_number: 0x5349_4D55_0000_0001,
        }
    }
}

impl Default for SimulatedDriveConfig {
    /// A tilt axis with 500 encoder lines and a gear of 120:1 (0.0015 deg/qc), level at world zero:
    /// limit switches at 65 degrees on either side on their factory inputs (6 negative, 5
    /// positive), no hard stops, no lag, 4.5 degrees down at power-on, and the fault of a drive
    /// used over USB alone.
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
            load: None,
            latches_position: false,
            dither_qc: 0,
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
