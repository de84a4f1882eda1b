//! Profile position mode: setpoints by the handshake of controlword bit 4 and statusword bit 12
//! (Firmware Specification, "Profile Position Mode").

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{DeviceState, control, mode, status};
use protocol::epos2::objects;

use super::fixed::{Speed, fine, floor_qc};
use super::node::{SimulatedDrive, bit};
use super::profile::MotionLimits;

/// State of the mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct PositionMode {
    /// Bit 12: the generator has taken the setpoint and bit 4 of the controlword is still set.
    acknowledged: bool,
    /// Bit 10; not set before the first setpoint.
    reached: bool,
    /// Starts after the present move.
    queued: Option<Setpoint>,
    /// The target in qc of the drive.
    target: Option<i64>,
    in_window_ms: u16,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Setpoint {
    /// Value of 607A at the rising edge of bit 4.
    value: i32,
    relative: bool,
}

impl PositionMode {
    pub fn status_bits(&self) -> u16 {
        bit(self.reached, status::TARGET_REACHED)
            | bit(self.acknowledged, status::SETPOINT_ACKNOWLEDGE)
    }

    /// Drops all targets.
    pub fn abandon(&mut self) {
        *self = Self::default();
    }
}

impl SimulatedDrive {
    /// Handles a change of the controlword while operation is enabled.
    ///
    /// A halt cancels the move: the specification does not say whether it resumes, and an
    /// unexpected start is the greater hazard. The halt bit blocks setpoints.
    pub(super) fn position_command(&mut self, old: u16, word: u16) {
        let rising = word & !old;
        if rising & control::HALT != 0 {
            self.position_mode.abandon();
            self.ramp_down(objects::PROFILE_DECELERATION);
        }
        if rising & control::NEW_SETPOINT != 0 && word & control::HALT == 0 {
            let setpoint = Setpoint {
                value: self.dictionary.get(objects::TARGET_POSITION),
                relative: word & control::RELATIVE != 0,
            };
            if word & control::AT_ONCE != 0 || !self.generator.is_moving() {
                self.start(setpoint);
            } else {
                self.position_mode.queued = Some(setpoint);
            }
        }
        if word & control::NEW_SETPOINT == 0 {
            self.position_mode.acknowledged = false;
        }
    }

    fn start(&mut self, setpoint: Setpoint) {
        let base = if setpoint.relative {
            i64::from(self.position_demand())
        } else {
            0
        };
        let target = base + i64::from(setpoint.value);
        self.position_mode = PositionMode {
            acknowledged: self.controlword & control::NEW_SETPOINT != 0,
            target: Some(target),
            ..PositionMode::default()
        };
        if !self.is_allowed(target) {
            self.fail(DeviceError::SOFTWARE_LIMIT);
            return;
        }
        let limits = self.move_limits();
        let world = fine(target.saturating_add(self.origin));
        if self.generator.go_to(world, limits).is_err() {
            self.fail(DeviceError::SOFTWARE_PARAMETER);
        }
    }

    /// Profile velocity and accelerations within their limits (607F, 6410:4, 60C5).
    fn move_limits(&self) -> MotionLimits {
        let speed = self.dictionary.get(objects::PROFILE_VELOCITY);
        MotionLimits {
            speed: self.speed_within_limits(speed),
            acceleration: self.acceleration(objects::PROFILE_ACCELERATION),
            deceleration: self.acceleration(objects::PROFILE_DECELERATION),
            shape: self.profile_shape(),
        }
    }

    /// A speed of `rpm` within 607F and 6410:4.
    pub(super) fn speed_within_limits(&self, rpm: u32) -> Speed {
        // 607F is at most 25000.
        let rpm = rpm
            .min(self.dictionary.get(objects::MAX_PROFILE_VELOCITY))
            .min(self.dictionary.get(objects::MAX_MOTOR_SPEED));
        Speed::from_rpm(rpm as i32)
    }

    /// Whether a position of the drive lies within the software limits (607D).
    pub(super) fn is_allowed(&self, position: i64) -> bool {
        let lowest = self.dictionary.get(objects::MIN_POSITION).into();
        let highest = self.dictionary.get(objects::MAX_POSITION).into();
        (lowest..=highest).contains(&position)
    }

    /// Error for motion outwards beyond a software limit, as after a new target close behind it.
    /// Inactive while homing; motion inwards is always allowed.
    pub(super) fn watch_software_limits(&mut self) {
        if self.mode == mode::HOMING || self.state != DeviceState::OperationEnabled {
            return;
        }
        let position = floor_qc(self.generator.position) - self.origin;
        let lowest = self.dictionary.get(objects::MIN_POSITION).into();
        let highest: i64 = self.dictionary.get(objects::MAX_POSITION).into();
        let speed = self.generator.speed;
        if position < lowest && speed < Speed::ZERO || position > highest && speed > Speed::ZERO {
            self.fail(DeviceError::SOFTWARE_LIMIT);
        }
    }

    /// Advances the mode by one millisecond.
    pub(super) fn advance_position_mode(&mut self) {
        let moving = self.generator.is_moving();
        if self.controlword & control::HALT != 0 {
            self.position_mode.reached = !moving;
            return;
        }
        if moving {
            return;
        }
        if let Some(setpoint) = self.position_mode.queued.take() {
            self.start(setpoint);
            return;
        }
        self.position_mode.reached = match self.position_mode.target {
            Some(target) => self.is_in_window(target),
            None => false,
        };
    }

    /// Whether the target is reached: at the end of the profile if the window (6067) is FFFFFFFF,
    /// else after 6068 ms within it.
    fn is_in_window(&mut self, target: i64) -> bool {
        let window = self.dictionary.get(objects::POSITION_WINDOW);
        if window == u32::MAX {
            return true;
        }
        let position = floor_qc(self.shaft.position) - self.origin;
        let off = (position - target).unsigned_abs();
        let waited = &mut self.position_mode.in_window_ms;
        *waited = if off <= u64::from(window) {
            waited.saturating_add(1)
        } else {
            0
        };
        *waited > self.dictionary.get(objects::POSITION_WINDOW_TIME)
    }
}
