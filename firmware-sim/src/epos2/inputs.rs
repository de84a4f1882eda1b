//! Digital inputs: switches to inputs, inputs to purposes (2070), mask, polarity and execution mask
//! (2071).

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::DeviceState;
use protocol::epos2::objects::{self, Address, input};

use super::fixed::floor_qc;
use super::node::SimulatedDrive;

/// Digital inputs of the drive.
const INPUTS: u8 = 9;

impl SimulatedDrive {
    /// 2071:1 at the present position. A purpose without an input stays inactive, at either
    /// polarity.
    pub(super) fn sense(&self) -> u16 {
        let position = floor_qc(self.shaft.position);
        let (mut high, mut assigned) = (0, 0);
        for number in 1..=INPUTS {
            // Only 0..=15 can be written.
            let purpose = self.dictionary.raw(Address::new(0x2070, number)) & 15;
            assigned |= 1u16 << purpose;
            if self.input_is_high(number, position) {
                high |= 1u16 << purpose;
            }
        }
        let mask = self.dictionary.get(objects::INPUT_MASK);
        let polarity = self.dictionary.get(objects::INPUT_POLARITY);
        (high ^ polarity) & assigned & mask
    }

    fn input_is_high(&self, number: u8, position: i64) -> bool {
        self.config
            .switches
            .iter()
            .flatten()
            .filter(|switch| switch.input == number)
            .any(|switch| switch.pressed.contains(position) != switch.normally_closed)
    }

    /// Updates the inputs and runs the error routines that are enabled (2071:4).
    ///
    /// A limit switch is an error when it becomes active, and when the axis moves further into it,
    /// so that a drive can leave it after a fault reset; during the ramp of a fault only once.
    /// While homing, limit switches are no errors.
    pub(super) fn watch_inputs(&mut self) {
        let before = self.inputs;
        self.inputs = self.sense();
        let watched = self.inputs & self.dictionary.get(objects::INPUT_EXECUTION_MASK);
        if self.homing.is_active() || !self.is_powered() {
            return;
        }
        let quick_stop = watched & !before & input::QUICK_STOP != 0;
        if quick_stop && self.state == DeviceState::OperationEnabled {
            self.quick_stop();
        }
        let direction = self.generator.speed.0.signum();
        let reacting = self.state == DeviceState::FaultReactionEnabled;
        for (bit, into, error) in [
            (input::NEGATIVE_LIMIT, -1, DeviceError::NEGATIVE_LIMIT),
            (input::POSITIVE_LIMIT, 1, DeviceError::POSITIVE_LIMIT),
        ] {
            let became = before & bit == 0;
            if watched & bit != 0 && (became || direction == into && !reacting) {
                self.fail(error);
            }
        }
    }
}
