//! Configuration of the axis, with validation.
//!
//! Plain data: files, device names and baud rates are the caller's concern.

use std::fmt::Display;

use units::{Degrees, Gearing, Quadcounts, Rpm, RpmPerS, Span};

use crate::error::DriveError;

/// The tilt axis: gearing, limits, switches, brake, homing and timing.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisConfig {
    /// CANopen node id of the drive, 1 to 127.
    pub node: u8,
    /// Encoder and gear.
    pub gearing: Gearing,
    /// Direction of the encoder (2210:4).
    pub sensor_polarity: u16,
    /// Range of targets, also written to the drive as software position limits (607D).
    pub limits: AxisLimits,
    /// Maximal motor speed (607F).
    pub max_speed: Rpm,
    /// Maximal acceleration of a move or homing. Max acceleration (60C5) is the larger of this and
    /// `quick_stop`.
    pub max_acceleration: RpmPerS,
    /// Quick stop deceleration (6085).
    pub quick_stop: RpmPerS,
    /// Max following error (6065).
    pub max_following_error: Degrees,
    /// Largest distance from the target at which a move has arrived.
    pub arrival_tolerance: Degrees,
    /// Spread of the positions of an axis at rest: the dither of encoder and servo.
    pub standstill_spread: Degrees,
    /// Largest deviations of a moving axis from its plan.
    pub guard: MotionGuardConfig,
    /// Inputs of the limit switches.
    pub limit_switches: LimitSwitchConfig,
    /// The holding brake; `None` leaves the outputs unchanged.
    pub brake: Option<BrakeConfig>,
    /// Whether an axis without a brake stays powered at rest after a move or stop, as its head
    /// would fall.
    pub hold_without_brake: bool,
    /// Homing procedure.
    pub homing: HomingConfig,
    /// Periods and time limits.
    pub timing: AxisTiming,
    /// Heartbeats on a CAN bus; unused on other links.
    pub can: CanHeartbeats,
}

/// Largest deviations of a moving axis from its plan before it is stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionGuardConfig {
    /// How far the axis may lag behind its plan at low speed.
    pub behind: Degrees,
    /// Lag of the servo, added to `behind` in proportion to the speed.
    pub servo_lag: Span,
    /// How far the axis may be ahead of its plan, beyond its target, or away from a position that
    /// it holds: the overshoot of the servo.
    pub ahead: Degrees,
    /// How far the axis may be beyond its limits.
    pub beyond_limits: Degrees,
    /// How far homing may move beyond the range between the limits and the home offset.
    pub homing_margin: Degrees,
}

/// Heartbeats on a CAN bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CanHeartbeats {
    /// Node id of the host's heartbeat while the axis may move, 1 to 127, other than the drive's.
    pub host_node: u8,
    /// Period of the host's heartbeat.
    pub host_heartbeat: Span,
    /// Time without the host's heartbeat after which the drive stops (1016:1, whole milliseconds).
    pub host_limit: Span,
    /// Period of the drive's heartbeat (1017, whole milliseconds).
    pub node_heartbeat: Span,
    /// Time without the drive's heartbeat after which it counts as lost.
    pub node_limit: Span,
}

/// A closed range of tilt angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Lowest angle.
    pub min: Degrees,
    /// Highest angle.
    pub max: Degrees,
}

/// Digital inputs (1 to 9) of the limit switches; `None` for a missing switch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LimitSwitchConfig {
    /// Input of the negative limit switch.
    pub negative: Option<u8>,
    /// Input of the positive limit switch.
    pub positive: Option<u8>,
    /// Whether a switch is active when its input is low (a normally closed contact: a broken wire
    /// stops the axis).
    pub active_low: bool,
}

/// The holding brake on a digital output of the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BrakeConfig {
    /// Digital output of the brake (2079), 1 to 5.
    pub output: u8,
    /// Whether the output is inverted (2078:3).
    pub inverted: bool,
    /// Time the brake takes to open (2100:1), whole milliseconds up to 65535.
    pub rise: Span,
    /// Time the brake takes to close (2100:2), whole milliseconds up to 65535.
    pub fall: Span,
}

/// The homing procedure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomingConfig {
    /// Homing method (6098): 1, 2, 7, 11, 17, 18, 23, 27, 33, 34, 35 or -1 to -4.
    pub method: i8,
    /// Speed for the switch search (6099:1), which also applies to a mechanical stop.
    pub switch_speed: Rpm,
    /// Speed for the zero search (6099:2).
    pub zero_speed: Rpm,
    /// Homing acceleration (609A).
    pub acceleration: RpmPerS,
    /// Home offset (607C): how far the axis moves on after detection; the sign is the direction.
    pub offset: Degrees,
    /// Home position (2081): tilt angle of the axis after that.
    pub home_position: Degrees,
    /// Current threshold (2080) for methods -1 to -4, mA.
    pub current_threshold_ma: u16,
    /// Time limit of the procedure.
    pub time_limit: Span,
}

/// Periods and time limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisTiming {
    /// Time limit of a reply (the drive's own frame timeout is 500 ms).
    pub timeout: Span,
    /// Time limit of a reply while the axis moves, when silence costs more than a repeated request.
    pub timeout_moving: Span,
    /// Time without any input from the drive for which a move or homing goes on, but not so long
    /// that an unseen axis could leave its limits: a busy machine delays this program and its
    /// adapters. The drive completes its own profile meanwhile.
    pub silence_limit: Span,
    /// Repeats of a read after its reply was lost. Writes are not repeated.
    pub read_retries: u8,
    /// Shortest period of position samples; zero polls at the rate of the replies. The position
    /// loop runs at 1 kHz.
    pub poll_period: Span,
    /// Period of statusword checks during motion.
    pub status_period: Span,
    /// Sampling at standstill before and after a sweep.
    pub hold: Span,
    /// Time beyond the plan after which a move has failed.
    pub arrival_margin: Span,
    /// Time limit of a state change (enable, fault reset, setpoint acknowledge).
    pub state_limit: Span,
    /// Time without motion that counts as standstill.
    pub standstill: Span,
}

impl Default for AxisConfig {
    /// The Velomotion-16's axis: 500 lines, 120:1, up to 75 deg/s and 1000 deg/s2, factory inputs
    /// for the switches, brake on output 1.
    fn default() -> Self {
        Self {
            node: 1,
            gearing: DEFAULT_GEARING,
            sensor_polarity: 0,
            limits: AxisLimits {
                min: Degrees(-60.0),
                max: Degrees(60.0),
            },
            max_speed: Rpm(1_500),
            max_acceleration: RpmPerS(20_000),
            quick_stop: RpmPerS(20_000),
            max_following_error: Degrees(3.0),
            arrival_tolerance: SMALLEST_TOLERANCE,
            standstill_spread: SMALLEST_TOLERANCE,
            guard: MotionGuardConfig::default(),
            limit_switches: LimitSwitchConfig::default(),
            brake: Some(BrakeConfig::default()),
            hold_without_brake: false,
            homing: HomingConfig::default(),
            timing: AxisTiming::default(),
            can: CanHeartbeats::default(),
        }
    }
}

/// Spread of the positions of a servo that hunts by 8 qc either way, with a margin, and the
/// smallest tolerance at rest.
const DITHER_QC: f64 = 20.0;
const SMALLEST_TOLERANCE: Degrees = Degrees(0.03);

/// 500 lines and 120:1.
const DEFAULT_GEARING: Gearing = match Gearing::new(500, 120, 1) {
    Ok(gearing) => gearing,
    Err(_) => unreachable!(),
};

impl Default for MotionGuardConfig {
    /// At 56.25 deg/s the lag allowed is 3.3 deg, just above the drive's own following error of
    /// 3 deg. A servo with a damping ratio of 0.5 and a bandwidth of 10 Hz overshoots a stop from
    /// 1000 deg/s2 by less than 0.2 deg.
    fn default() -> Self {
        Self {
            behind: Degrees(0.5),
            servo_lag: Span::from_millis(50),
            ahead: Degrees(0.5),
            beyond_limits: Degrees(0.1),
            homing_margin: Degrees(10.0),
        }
    }
}

impl Default for CanHeartbeats {
    /// Heartbeats every 50 ms. The host tolerates their absence for as long as silence in a move.
    /// The drive tolerates 500 ms, as the host's threads may be delayed: an axis at 98 deg/s is at
    /// rest 0.7 s after its host died.
    fn default() -> Self {
        Self {
            host_node: 127,
            host_heartbeat: Span::from_millis(50),
            host_limit: Span::from_millis(500),
            node_heartbeat: Span::from_millis(50),
            node_limit: Span::from_secs(1),
        }
    }
}

impl Default for LimitSwitchConfig {
    /// The factory setting (2070): input 6 negative, input 5 positive, active high.
    fn default() -> Self {
        Self {
            negative: Some(6),
            positive: Some(5),
            active_low: false,
        }
    }
}

impl Default for BrakeConfig {
    /// Output 1, and the factory setting of 10 ms each way.
    fn default() -> Self {
        Self {
            output: 1,
            inverted: false,
            rise: Span::from_millis(10),
            fall: Span::from_millis(10),
        }
    }
}

impl Default for HomingConfig {
    /// Method 17 (edge of the negative limit switch, without index), then 5 deg off the switch.
    fn default() -> Self {
        Self {
            method: 17,
            switch_speed: Rpm(400),
            zero_speed: Rpm(40),
            acceleration: RpmPerS(5_000),
            offset: Degrees(5.0),
            home_position: Degrees(-60.0),
            current_threshold_ma: 500,
            time_limit: Span::from_secs(60),
        }
    }
}

impl Default for AxisTiming {
    fn default() -> Self {
        Self {
            timeout: Span::from_millis(500),
            timeout_moving: Span::from_millis(100),
            silence_limit: Span::from_secs(1),
            read_retries: 2,
            poll_period: Span::from_millis(1),
            status_period: Span::from_millis(20),
            hold: Span::from_millis(50),
            arrival_margin: Span::from_secs(1),
            state_limit: Span::from_secs(2),
            standstill: Span::from_millis(50),
        }
    }
}

/// The limits in quadcounts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LimitsQc {
    pub min: Quadcounts,
    pub max: Quadcounts,
}

impl LimitsQc {
    pub fn contains(self, position: Quadcounts, tolerance: Quadcounts) -> bool {
        let min = self.min.0.saturating_sub(tolerance.0);
        let max = self.max.0.saturating_add(tolerance.0);
        (min..=max).contains(&position.0)
    }
}

/// Upper limit of max profile velocity (607F), EPOS2 Firmware Specification.
const MAX_SPEED_RPM: u32 = 25_000;
const HOMING_METHODS: [i8; 15] = [1, 2, 7, 11, 17, 18, 23, 27, 33, 34, 35, -1, -2, -3, -4];
/// One hour. No wait is meant to be longer, and sums of such spans cannot overflow.
const MAX_SPAN_MS: i64 = 3_600_000;

impl AxisConfig {
    /// Whether the drive holds the axis at rest, as nothing else does.
    #[must_use]
    pub const fn holds(&self) -> bool {
        self.hold_without_brake && self.brake.is_none()
    }

    /// Tolerance of arrival and standstill that suits an encoder and gear: 0.03 deg, or the spread
    /// of a hunting servo where a count is more than 0.0015 deg.
    #[must_use]
    pub fn rest_tolerance(gearing: Gearing) -> Degrees {
        let spread = DITHER_QC * gearing.degrees_per_qc();
        Degrees(SMALLEST_TOLERANCE.0.max(spread))
    }

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

    /// The limits in quadcounts, rounded to the nearest.
    pub(crate) fn limits_qc(&self) -> Result<LimitsQc, DriveError> {
        let min = self.quadcounts("limits.min", self.limits.min)?;
        let max = self.quadcounts("limits.max", self.limits.max)?;
        if min >= max {
            let got = format!("{} to {} deg", self.limits.min.0, self.limits.max.0);
            return Err(invalid("limits", "min below max".into(), got));
        }
        Ok(LimitsQc { min, max })
    }

    /// A tolerance in quadcounts, at least one.
    pub(crate) fn tolerance_qc(&self, tolerance: Degrees) -> Quadcounts {
        let counts = self
            .gearing
            .position(tolerance)
            .unwrap_or(Quadcounts(i32::MAX));
        Quadcounts(counts.0.max(1))
    }

    /// A configured angle in quadcounts.
    pub(crate) fn quadcounts(
        &self,
        field: &'static str,
        angle: Degrees,
    ) -> Result<Quadcounts, DriveError> {
        self.gearing.position(angle).map_err(|_| {
            let expected = "an angle whose quadcounts fit 32 bits".into();
            invalid(field, expected, format!("{} deg", angle.0))
        })
    }
}

impl LimitSwitchConfig {
    /// The switches' bits in object 2071: bit 0 negative, bit 1 positive.
    pub(crate) fn mask(self) -> u16 {
        u16::from(self.negative.is_some()) | u16::from(self.positive.is_some()) << 1
    }

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

impl HomingConfig {
    /// Whether the method detects a mechanical stop by the motor's current.
    pub(crate) fn detects_current(&self) -> bool {
        self.method < 0
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

/// Whole milliseconds, rounded away from zero so that a negative span never becomes zero.
pub(crate) fn whole_ms(span: Span) -> i64 {
    let ns = span.as_nanos();
    ns / 1_000_000 + (ns % 1_000_000).signum()
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

fn invalid(field: &'static str, expected: String, got: impl Display) -> DriveError {
    DriveError::Config {
        field,
        expected,
        got: got.to_string(),
    }
}

#[cfg(test)]
mod tests {
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

    #[test]
    fn limit_switch_bits_are_those_of_2071() {
        assert_eq!(LimitSwitchConfig::default().mask(), 0b11);
        let one = LimitSwitchConfig {
            negative: None,
            ..LimitSwitchConfig::default()
        };
        assert_eq!(one.mask(), 0b10);
    }
}
