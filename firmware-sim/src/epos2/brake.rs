//! The holding brake on a digital output: purpose 2 in 2079, looked at only with bit 2 of the output mask (2078:2).
//!
//! Opens before the motion and closes after it with the reaction times of 2100, while the motor holds. It closes when the shaft has
//! been slower than the standstill window for its time, or after the standstill timeout (2101). No output is the brake from the
//! factory, and then nothing here happens, nor is a standstill waited for. The brake timeout (2100:3) is plain storage: what it
//! limits is not documented.

use protocol::epos2::objects::{self, Address};

use super::node::Node;

/// The holding brake as the axis feels it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BrakeState {
    /// No output feeds a brake.
    Absent,
    /// The shaft is held.
    Closed,
    /// The shaft is free.
    Open,
}

/// How long the shaft has been slow, and how long that has been waited for.
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

/// Digital outputs of the unit.
const OUTPUTS: u8 = 5;
/// Bit of the brake in 2078.
const BRAKE_BIT: u16 = 1 << objects::OUTPUT_BRAKE;

impl Node {
    /// What the brake does.
    #[must_use]
    pub fn brake(&self) -> BrakeState {
        match (self.has_brake(), self.brake_released) {
            (false, _) => BrakeState::Absent,
            (true, true) => BrakeState::Open,
            (true, false) => BrakeState::Closed,
        }
    }

    fn has_brake(&self) -> bool {
        let brake = u32::from(objects::OUTPUT_BRAKE);
        let wired =
            (1..=OUTPUTS).any(|number| self.dictionary.raw(Address::new(0x2079, number)) == brake);
        wired && self.dictionary.get(objects::OUTPUT_MASK) & BRAKE_BIT != 0
    }

    /// Milliseconds the brake takes to open.
    pub(super) fn brake_rise_ms(&self) -> u16 {
        if self.has_brake() {
            self.dictionary.get(objects::BRAKE_RISE)
        } else {
            0
        }
    }

    /// Milliseconds the brake takes to close.
    pub(super) fn brake_fall_ms(&self) -> u16 {
        if self.has_brake() {
            self.dictionary.get(objects::BRAKE_FALL)
        } else {
            0
        }
    }

    /// One millisecond of waiting for the shaft to stand; whether the brake may close.
    pub(super) fn stands(&self, standstill: &mut StandstillTimer) -> bool {
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

    /// 2078:1: what was written, but the brake's bit belongs to the unit. Set is closed: the specification calls the output
    /// active then, and does not say more.
    pub(super) fn output_state(&self) -> u16 {
        let written = self.dictionary.get(objects::OUTPUT_STATE) & !BRAKE_BIT;
        if self.brake() == BrakeState::Closed {
            written | BRAKE_BIT
        } else {
            written
        }
    }
}
