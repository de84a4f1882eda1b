//! The axis of the Velomotion-16.

use units::{Degrees, Gearing, Rpm, RpmPerS, Span};

use super::{
    AxisConfig, AxisLimits, AxisTiming, BrakeConfig, CanHeartbeats, HomingConfig,
    LimitSwitchConfig, MotionGuardConfig,
};

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

impl AxisConfig {
    /// Tolerance of arrival and standstill that suits an encoder and gear: 0.03 deg, or the spread
    /// of a hunting servo where a count is more than 0.0015 deg.
    #[must_use]
    pub fn rest_tolerance(gearing: Gearing) -> Degrees {
        let spread = DITHER_QC * gearing.degrees_per_qc();
        Degrees(SMALLEST_TOLERANCE.0.max(spread))
    }
}
