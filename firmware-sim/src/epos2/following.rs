//! Deviation of the shaft from its demand: following error (6065, 20F4, error 8611), speed and
//! current of the motor.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{DeviceState, mode};
use protocol::epos2::objects;

use super::node::SimulatedDrive;

impl SimulatedDrive {
    /// A deviation above 6065 is an error in all modes with position control.
    pub(super) fn watch_following(&mut self) {
        let controlled = matches!(
            self.state,
            DeviceState::OperationEnabled | DeviceState::QuickStopActive
        ) && !self.controls_velocity();
        let most = self.dictionary.get(objects::MAX_FOLLOWING_ERROR);
        if controlled && self.following_error().unsigned_abs() > u64::from(most) {
            self.lost_demand = true;
            self.fail(DeviceError::FOLLOWING);
        }
    }

    /// A velocity controller has no target position: a blocked shaft keeps its demand with it.
    pub(super) fn follow_shaft(&mut self) {
        if self.controls_velocity() && self.shaft.held {
            let behind = self.shaft.give_way(self.generator.position);
            self.velocity_mode.held = self.generator.speed.0.signum() as i16;
            self.generator.shift(behind);
        } else {
            self.velocity_mode.held = 0;
        }
    }

    /// Whether the mode has a velocity controller alone.
    const fn controls_velocity(&self) -> bool {
        matches!(self.mode, mode::PROFILE_VELOCITY | mode::VELOCITY)
    }

    /// Demand minus shaft, qc.
    fn following_error(&self) -> i64 {
        self.shaft.following_error(self.generator.position)
    }

    /// 20F4.
    pub(super) fn following_error_actual(&self) -> i16 {
        let most = i64::from(i16::MAX);
        self.following_error().clamp(-most - 1, most) as i16
    }

    /// 606C: the speed of the demand at the end of the control cycle while the shaft follows
    /// exactly.
    pub(super) fn velocity_actual_rpm(&self) -> i32 {
        if self.shaft.behind || self.velocity_mode.held != 0 {
            self.shaft.speed(self.generator.qc_per_turn).to_rpm()
        } else {
            self.generator.speed.to_rpm()
        }
    }

    /// 6078. A velocity controller with a blocked shaft reaches its limit (6410:2).
    pub(super) fn current_actual_ma(&self) -> i16 {
        let most = self.dictionary.get(objects::OUTPUT_CURRENT);
        match (self.is_powered(), self.velocity_mode.held) {
            (false, _) => 0,
            (true, 0) => self.shaft.current_ma(self.generator.position, most),
            (true, direction) => direction * i16::try_from(most).unwrap_or(i16::MAX),
        }
    }
}
