//! Profile velocity mode (Firmware Specification, "Profile Velocity Mode"): a speed reached by a
//! ramp and held.
//!
//! As in CiA 402 the target (60FF) applies while operation is enabled and the halt bit is clear.
//! Whether a real drive waits for a controlword after a new target is not documented; clients write
//! one.

use protocol::epos2::DeviceError;
use protocol::epos2::cia402::{control, status};
use protocol::epos2::objects::{self, TypedObject};

use super::fixed::Speed;
use super::node::{SimulatedDrive, bit};
use super::profile::MotionLimits;

/// Tolerance of the target speed, rpm; FFFFFFFF: reached at the end of the ramp.
const VELOCITY_WINDOW: TypedObject<u32> = TypedObject::new(0x606D, 0, "Velocity Window");
/// Time within the tolerance, ms.
const VELOCITY_WINDOW_TIME: TypedObject<u16> = TypedObject::new(0x606E, 0, "Velocity Window Time");
/// Bit 12 of the statusword in this mode: standstill.
const SPEED_IS_ZERO: u16 = 1 << 12;

/// State of the mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct VelocityMode {
    /// The speed at the end of the ramp; `None` before the first.
    pub target: Option<Speed>,
    /// Bit 10.
    reached: bool,
    in_window_ms: u16,
    /// The blocked direction in the last control cycle; 0 if the shaft could move.
    pub held: i16,
}

impl VelocityMode {
    pub const fn status_bits(&self, actual_rpm: i32) -> u16 {
        bit(self.reached, status::TARGET_REACHED) | bit(actual_rpm == 0, SPEED_IS_ZERO)
    }

    /// Drops the target.
    pub fn abandon(&mut self) {
        *self = Self::default();
    }
}

impl SimulatedDrive {
    /// Advances the mode by one millisecond.
    pub(super) fn advance_velocity_mode(&mut self) {
        let target = self.velocity_target();
        if self.velocity_mode.target != Some(target) {
            let acceleration = self.acceleration(objects::PROFILE_ACCELERATION);
            let deceleration = self.acceleration(objects::PROFILE_DECELERATION);
            if acceleration == 0 || deceleration == 0 {
                self.fail(DeviceError::SOFTWARE_PARAMETER);
                return;
            }
            self.velocity_mode = VelocityMode {
                target: Some(target),
                ..VelocityMode::default()
            };
            self.generator.run_at(MotionLimits {
                speed: target,
                acceleration,
                deceleration,
                shape: self.profile_shape(),
            });
        }
        self.velocity_mode.reached = self.is_at_speed(target);
    }

    /// 60FF within its limits (607F, 6410:4); zero at a halt.
    fn velocity_target(&self) -> Speed {
        if self.controlword & control::HALT != 0 {
            return Speed::ZERO;
        }
        self.signed_speed_within_limits(self.dictionary.get(objects::TARGET_VELOCITY))
    }

    fn is_at_speed(&mut self, target: Speed) -> bool {
        let actual = self.velocity_actual_rpm();
        let window = self.dictionary.get(VELOCITY_WINDOW);
        if window == u32::MAX {
            return self.generator.speed == target && !self.shaft.held;
        }
        let off = actual.abs_diff(target.to_rpm());
        let waited = &mut self.velocity_mode.in_window_ms;
        *waited = if off <= window {
            waited.saturating_add(1)
        } else {
            0
        };
        *waited > self.dictionary.get(VELOCITY_WINDOW_TIME)
    }
}
