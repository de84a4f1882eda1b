//! Configuration of the axis: `defaults` has the values of the Velomotion-16, `checks` validates.
//!
//! Plain data: files, device names and baud rates are the caller's concern.

mod checks;
mod defaults;

use units::{Degrees, Gearing, Quadcounts, Rpm, RpmPerS, Span};

use crate::error::DriveError;
use checks::invalid;

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
    /// Greatest lag of the axis behind its plan at low speed.
    pub behind: Degrees,
    /// Lag of the servo, added to `behind` in proportion to the speed.
    pub servo_lag: Span,
    /// Greatest distance ahead of the plan, beyond the target, or away from a position that the
    /// axis holds: the overshoot of the servo.
    pub ahead: Degrees,
    /// Greatest distance of the axis beyond its limits.
    pub beyond_limits: Degrees,
    /// Greatest travel of homing beyond the range between the limits and the home offset.
    pub homing_margin: Degrees,
}

/// Heartbeats on a CAN bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
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
#[non_exhaustive]
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

impl AxisConfig {
    /// Whether the drive holds the axis at rest, as nothing else does.
    #[must_use]
    pub const fn holds(&self) -> bool {
        self.hold_without_brake && self.brake.is_none()
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
}

impl HomingConfig {
    /// Whether the method detects a mechanical stop by the motor's current.
    pub(crate) fn detects_current(&self) -> bool {
        self.method < 0
    }
}

/// Whole milliseconds, rounded away from zero so that a negative span never becomes zero.
pub(crate) fn whole_ms(span: Span) -> i64 {
    let ns = span.as_nanos();
    ns / 1_000_000 + (ns % 1_000_000).signum()
}

#[cfg(test)]
mod tests {
    use super::*;

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
