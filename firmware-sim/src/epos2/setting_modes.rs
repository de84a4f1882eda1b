//! Position mode (-1) and velocity mode (-2): the demand is a setting value, without a profile
//! (Firmware Specification, "Position Mode", "Velocity Mode").
//!
//! The setting value applies as long as operation is enabled. The facts at hand do not say whether
//! a real drive waits for a first write; an old value that moves the axis is the greater hazard.
//! Neither mode has bits of its own in the statusword, nor a halt.

use protocol::epos2::DeviceError;
use protocol::epos2::objects::{self, TypedObject};

use super::fixed::{Speed, fine};
use super::node::SimulatedDrive;
use super::profile::MotionLimits;
use super::ramp::RampShape;

/// Setting value of position mode, qc.
const POSITION_SETTING: TypedObject<i32> =
    TypedObject::new(0x2062, 0, "Position Mode Setting Value");
/// Setting value of velocity mode, rpm.
const VELOCITY_SETTING: TypedObject<i32> =
    TypedObject::new(0x206B, 0, "Velocity Mode Setting Value");

impl SimulatedDrive {
    /// Advances position mode by one millisecond. A step above 6065 is a following error at once:
    /// no motor covers it in a control cycle. A value beyond 607D is a software limit.
    pub(super) fn advance_position_setting(&mut self) {
        let setting = self.dictionary.get(POSITION_SETTING).into();
        if !self.is_allowed(setting) {
            self.fail(DeviceError::SOFTWARE_LIMIT);
            return;
        }
        self.generator
            .rest_at(fine(setting.saturating_add(self.origin)));
        self.watch_following();
    }

    /// Advances velocity mode by one millisecond: 206B within 607F and 6410:4, reached at the
    /// maximal acceleration (60C5).
    pub(super) fn advance_velocity_setting(&mut self) {
        let setting = self.signed_speed_within_limits(self.dictionary.get(VELOCITY_SETTING));
        if self.velocity_mode.target == Some(setting) {
            return;
        }
        let most = self.dictionary.get(objects::MAX_ACCELERATION);
        if most == 0 {
            self.fail(DeviceError::SOFTWARE_PARAMETER);
            return;
        }
        self.velocity_mode.target = Some(setting);
        self.generator.run_at(MotionLimits {
            speed: setting,
            acceleration: most,
            deceleration: most,
            shape: RampShape::Linear,
        });
    }

    /// A speed of either direction within 607F and 6410:4.
    pub(super) fn signed_speed_within_limits(&self, rpm: i32) -> Speed {
        let Speed(limited) = self.speed_within_limits(rpm.unsigned_abs());
        Speed(limited * i64::from(rpm.signum()))
    }
}
