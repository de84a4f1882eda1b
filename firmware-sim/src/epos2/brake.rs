//! The holding brake on a digital output: purpose 2 in 2079, looked at only with bit 2 of the output mask (2078:2).
//!
//! Opens before the motion and closes after it with the reaction times of 2100, while the motor holds. No output is the brake from
//! the factory, and then nothing here happens. The standstill window (2101) is not simulated: the shaft stands when its demand does.

use protocol::epos2::objects::{self, Address};

use super::node::Node;

/// The holding brake as the axis feels it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Brake {
    /// No output feeds a brake.
    Absent,
    /// The shaft is held.
    Closed,
    /// The shaft is free.
    Open,
}

/// Digital outputs of the unit.
const OUTPUTS: u8 = 5;
/// Bit of the brake in 2078.
const BRAKE_BIT: u16 = 1 << objects::OUTPUT_BRAKE;

impl Node {
    /// What the brake does.
    #[must_use]
    pub fn brake(&self) -> Brake {
        match (self.has_brake(), self.brake_released) {
            (false, _) => Brake::Absent,
            (true, true) => Brake::Open,
            (true, false) => Brake::Closed,
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

    /// 2078:1: what was written, but the brake's bit belongs to the unit. Set is closed: the specification calls the output
    /// active then, and does not say more.
    pub(super) fn output_state(&self) -> u16 {
        let written = self.dictionary.get(objects::OUTPUT_STATE) & !BRAKE_BIT;
        if self.brake() == Brake::Closed {
            written | BRAKE_BIT
        } else {
            written
        }
    }
}
