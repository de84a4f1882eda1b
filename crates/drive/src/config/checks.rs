//! Validation of the configuration.

use std::fmt::Display;

use units::Span;

use super::{AxisConfig, AxisTiming, CanHeartbeats, LimitSwitchConfig, whole_ms};
use crate::error::DriveError;

/// Upper limit of max profile velocity (607F), EPOS2 Firmware Specification.
const MAX_SPEED_RPM: u32 = 25_000;
const HOMING_METHODS: [i8; 15] = [1, 2, 7, 11, 17, 18, 23, 27, 33, 34, 35, -1, -2, -3, -4];
/// One hour. No wait is meant to be longer, and sums of such spans cannot overflow.
const MAX_SPAN_MS: i64 = 3_600_000;

impl AxisConfig {
    /// Validates every field.
    ///
    /// # Errors
    /// [`DriveError::Config`] with the first invalid field.
    pub fn check(&self) -> Result<(), DriveError> {
        within("node", self.node, 1, 127)?;
        within("max_speed", self.max_speed.0, 1, MAX_SPEED_RPM)?;
        for (field, acceleration) in [
            ("max_acceleration", self.max_acceleration),
            ("quick_stop", self.quick_stop),
        ] {
            within(field, acceleration.0, 1, u32::MAX)?;
        }
        let guard = &self.guard;
        for (field, angle, min) in [
            ("guard.following_error_deg", self.max_following_error, 0.01),
            ("guard.arrival_deg", self.arrival_tolerance, 0.0),
            ("guard.standstill_deg", self.standstill_spread, 0.001),
            ("guard.behind_deg", guard.behind, 0.01),
            ("guard.ahead_deg", guard.ahead, 0.01),
            ("guard.beyond_limits_deg", guard.beyond_limits, 0.0),
            ("guard.homing_margin_deg", guard.homing_margin, 0.0),
        ] {
            within(field, angle.0, min, 360.0)?;
        }
        within_ms("guard.servo_lag_ms", guard.servo_lag, 0, 10_000)?;
        self.limits_qc()?;
        self.limit_switches.check()?;
        if let Some(brake) = self.brake {
            within("brake.output", brake.output, 1, 5)?;
            within_ms("brake.rise", brake.rise, 0, u16::MAX.into())?;
            within_ms("brake.fall", brake.fall, 0, u16::MAX.into())?;
        }
        self.check_homing()?;
        self.timing.check()?;
        self.can.check(self.node)
    }

    fn check_homing(&self) -> Result<(), DriveError> {
        let homing = &self.homing;
        if !HOMING_METHODS.contains(&homing.method) {
            let expected = format!("one of {HOMING_METHODS:?}");
            return Err(invalid("homing.method", expected, homing.method));
        }
        for (field, speed) in [
            ("homing.switch_speed", homing.switch_speed),
            ("homing.zero_speed", homing.zero_speed),
        ] {
            within(field, speed.0, 1, self.max_speed.0)?;
        }
        let max_acceleration = self.max_acceleration.0;
        let acceleration = homing.acceleration.0;
        within("homing.acceleration", acceleration, 1, max_acceleration)?;
        self.quadcounts("homing.offset", homing.offset)?;
        self.quadcounts("homing.home_position", homing.home_position)?;
        within_ms("homing.time_limit (ms)", homing.time_limit, 1, i64::MAX)
    }
}

impl LimitSwitchConfig {
    fn check(self) -> Result<(), DriveError> {
        for (field, input) in [
            ("limit_switches.negative", self.negative),
            ("limit_switches.positive", self.positive),
        ] {
            if let Some(input) = input {
                within(field, input, 1, 9)?;
            }
        }
        if self.negative.is_some() && self.negative == self.positive {
            let got = format!("{:?} for both", self.negative);
            return Err(invalid(
                "limit_switches",
                "two different inputs".into(),
                got,
            ));
        }
        Ok(())
    }
}

impl AxisTiming {
    fn check(&self) -> Result<(), DriveError> {
        for (field, span, min_ms) in [
            ("timing.timeout", self.timeout, 1),
            ("timing.timeout_moving", self.timeout_moving, 1),
            ("timing.poll_period", self.poll_period, 0),
            ("timing.status_period", self.status_period, 0),
            ("timing.hold", self.hold, 0),
            ("timing.arrival_margin", self.arrival_margin, 1),
            ("timing.state_limit", self.state_limit, 1),
            ("timing.standstill", self.standstill, 1),
        ] {
            within_ms(field, span, min_ms, MAX_SPAN_MS)?;
        }
        Ok(())
    }
}

impl CanHeartbeats {
    fn check(&self, node: u8) -> Result<(), DriveError> {
        within("can.host_node", self.host_node, 1, 127)?;
        if self.host_node == node {
            let expected = "a node id other than the drive's".into();
            return Err(invalid("can.host_node", expected, node));
        }
        for (field, span, above) in [
            ("can.host_heartbeat", self.host_heartbeat, Span::ZERO),
            ("can.host_limit", self.host_limit, self.host_heartbeat),
            ("can.node_heartbeat", self.node_heartbeat, Span::ZERO),
            ("can.node_limit", self.node_limit, self.node_heartbeat),
        ] {
            let min_ms = whole_ms(above).saturating_add(1);
            within_ms(field, span, min_ms, u16::MAX.into())?;
        }
        Ok(())
    }
}

fn within_ms(field: &'static str, span: Span, min: i64, max: i64) -> Result<(), DriveError> {
    within(field, whole_ms(span), min, max)
}

fn within<T: PartialOrd + Display>(
    field: &'static str,
    value: T,
    min: T,
    max: T,
) -> Result<(), DriveError> {
    // Written so that NaN is refused.
    if !(value >= min && value <= max) {
        return Err(invalid(field, format!("{min} to {max}"), value));
    }
    Ok(())
}

pub(super) fn invalid(field: &'static str, expected: String, got: impl Display) -> DriveError {
    DriveError::Config {
        field,
        expected,
        got: got.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use units::{Degrees, Rpm};

    use super::*;

    fn invalid_field(change: impl FnOnce(&mut AxisConfig)) -> &'static str {
        let mut config = AxisConfig::default();
        change(&mut config);
        match config.check() {
            Err(DriveError::Config { field, .. }) => field,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_default_is_valid() {
        assert_eq!(AxisConfig::default().check(), Ok(()));
        let limits = AxisConfig::default().limits_qc().unwrap();
        assert_eq!((limits.min.0, limits.max.0), (-40_000, 40_000));
    }

    #[test]
    fn the_error_names_the_invalid_field() {
        type Change = fn(&mut AxisConfig);
        let cases: [(&str, Change); 13] = [
            ("node", |c| c.node = 0),
            ("node", |c| c.node = 128),
            ("max_speed", |c| c.max_speed = Rpm(25_001)),
            ("limits", |c| c.limits.min = Degrees(60.0)),
            ("limits.max", |c| c.limits.max = Degrees(f64::NAN)),
            ("homing.method", |c| c.homing.method = 3),
            ("homing.zero_speed", |c| c.homing.zero_speed = Rpm(0)),
            ("limit_switches", |c| c.limit_switches.positive = Some(6)),
            ("brake.output", |c| {
                c.brake.as_mut().unwrap().output = 6;
            }),
            ("timing.timeout", |c| c.timing.timeout = Span::ZERO),
            ("can.host_node", |c| c.can.host_node = 1),
            ("can.node_limit", |c| {
                c.can.node_limit = Span::from_millis(50);
            }),
            ("timing.hold", |c| c.timing.hold = Span::from_nanos(-1)),
        ];
        for (field, change) in cases {
            assert_eq!(invalid_field(change), field);
        }
    }
}
