//! The holding brake on a digital output: purpose 2 in 2079, enabled by bit 2 of the output mask
//! (2078:2).
//!
//! The brake opens before a motion and closes after it with the reaction times of 2100, while the
//! motor holds. It closes when the shaft has been slower than the standstill window for its time,
//! or after the standstill timeout (2101). The factory setting has no brake: nothing waits for a
//! standstill then. The brake timeout (2100:3) is plain storage, as its effect is not documented.

use protocol::epos2::objects::{self, Address, TypedObject};

use super::node::{SimulatedDrive, bit};

/// State of the holding brake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BrakeState {
    /// No output is configured as a brake.
    Absent,
    /// The shaft is held.
    Closed,
    /// The shaft is free.
    Open,
}

/// Duration of slow motion, and of the wait for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct StandstillTimer {
    still_ms: u16,
    waited_ms: u16,
}

impl StandstillTimer {
    pub const NONE: Self = Self {
        still_ms: 0,
        waited_ms: 0,
    };
}

/// Digital outputs of the drive.
const OUTPUTS: u8 = 5;
/// Bit of the brake in 2078.
const BRAKE_BIT: u16 = 1 << objects::OUTPUT_BRAKE;

impl SimulatedDrive {
    /// State of the brake.
    #[must_use]
    pub fn brake(&self) -> BrakeState {
        match (self.has_brake(), self.brake_released) {
            (false, _) => BrakeState::Absent,
            (true, true) => BrakeState::Open,
            (true, false) => BrakeState::Closed,
        }
    }

    /// Whether an output of the drive holds a brake open.
    pub(super) fn is_brake_energised(&self) -> bool {
        self.brake_released && self.has_brake()
    }

    fn has_brake(&self) -> bool {
        let brake = u32::from(objects::OUTPUT_BRAKE);
        let wired =
            (1..=OUTPUTS).any(|number| self.dictionary.raw(Address::new(0x2079, number)) == brake);
        wired && self.dictionary.get(objects::OUTPUT_MASK) & BRAKE_BIT != 0
    }

    /// Opening or closing time of the brake in milliseconds; 0 without a brake.
    pub(super) fn brake_ms(&self, time: TypedObject<u16>) -> u16 {
        match self.has_brake() {
            true => self.dictionary.get(time),
            false => 0,
        }
    }

    /// Advances the wait for standstill by one millisecond; returns whether the brake may close.
    pub(super) fn is_at_standstill(&self, standstill: &mut StandstillTimer) -> bool {
        if !self.has_brake() {
            return true;
        }
        let window = self.dictionary.get(objects::STANDSTILL_WINDOW);
        let slow = self.velocity_actual_rpm().unsigned_abs() <= u32::from(window);
        standstill.waited_ms = standstill.waited_ms.saturating_add(1);
        standstill.still_ms = if slow {
            standstill.still_ms.saturating_add(1)
        } else {
            0
        };
        standstill.still_ms > self.dictionary.get(objects::STANDSTILL_TIME)
            || standstill.waited_ms > self.dictionary.get(objects::STANDSTILL_TIMEOUT)
    }

    /// 2078:1: the value written, but with the bit of the brake controlled by the drive. A set bit
    /// is a closed brake: the specification only calls the output active then.
    pub(super) fn output_state(&self) -> u16 {
        let written = self.dictionary.get(objects::OUTPUT_STATE) & !BRAKE_BIT;
        written | bit(self.brake() == BrakeState::Closed, BRAKE_BIT)
    }
}
