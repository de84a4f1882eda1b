//! `[axis]`: encoder, gear, limits, homing.

use scanner::config::TiltAxisConfig;
use serde::{Deserialize, Serialize};

use super::{between, positive};

/// The tilt axis: encoder, gear, limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AxisSettings {
    /// Node id of the drive.
    pub node: u8,
    /// Lines of the encoder on the motor shaft.
    pub encoder_lines: u32,
    /// Motor revolutions and axis revolutions.
    pub gear: [u32; 2],
    /// Smallest tilt angle allowed, degrees.
    pub min_deg: f64,
    /// Largest tilt angle allowed, degrees.
    pub max_deg: f64,
    /// Largest tilt speed allowed, degrees per second.
    pub max_speed_deg_s: f64,
    /// Largest tilt acceleration allowed, degrees per second squared.
    pub max_accel_deg_s2: f64,
    /// Deceleration of a quick stop (Ctrl-C, limit switch, fault), degrees per second squared.
    pub quick_stop_deg_s2: f64,
    /// Digital output of the drive (1..=5) that opens the brake; absent without a brake. The
    /// factory setting assigns no output.
    pub brake_output: Option<u8>,
    /// Whether the brake's output is inverted in the drive (2078:3, bit 2).
    pub brake_inverted: bool,
    /// Direction of the encoder in the drive (2210:4).
    pub sensor_polarity: u16,
    /// What happens to an axis without a brake when it comes to rest.
    pub without_brake: WithoutBrake,
    /// Limit switches; the factory's inputs without the table.
    pub limit_switches: LimitSwitchSettings,
    /// Homing.
    pub homing: HomingSettings,
    /// When the moving axis is stopped, and when it counts as arrived and at rest.
    pub guard: GuardSettings,
}

/// What happens to an axis without a brake when it comes to rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum WithoutBrake {
    /// The power is switched off, as with a brake.
    #[default]
    Release,
    /// The drive stays powered and holds the axis, as its head would fall.
    Hold,
}

/// Digital inputs of the limit switches (1..=9). A switch omitted from the table does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct LimitSwitchSettings {
    /// Input of the lower limit switch.
    #[serde(default)]
    pub negative: Option<u8>,
    /// Input of the upper limit switch.
    #[serde(default)]
    pub positive: Option<u8>,
    /// Whether a pressed switch pulls its input low, so that a broken wire stops the axis too.
    #[serde(default)]
    pub normally_closed: bool,
}

/// Tolerances of the drive client's motion guard, degrees of tilt unless named otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct GuardSettings {
    /// How far the axis may lag behind its plan at low speed.
    pub behind_deg: f64,
    /// Lag of the servo, added to `behind_deg` in proportion to the speed, milliseconds.
    pub servo_lag_ms: u16,
    /// How far the axis may be ahead of its plan or beyond its target.
    pub ahead_deg: f64,
    /// How far the axis may be beyond its limits.
    pub beyond_limits_deg: f64,
    /// How far homing may move beyond the range of the axis.
    pub homing_margin_deg: f64,
    /// Largest difference between the drive's own demand and position (object 6065).
    pub following_error_deg: f64,
    /// Largest distance from the target at which a move has arrived. Without it the larger of
    /// 0.03 deg and 20 quadcounts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arrival_deg: Option<f64>,
    /// Spread of the positions of an axis at rest. Without it the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub standstill_deg: Option<f64>,
}

/// Homing of the axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct HomingSettings {
    /// Homing method (object 6098).
    pub method: i8,
    /// Tilt angle of the position that homing finds, degrees.
    pub at_deg: f64,
    /// Tilt angle to move to afterwards, degrees.
    pub to_deg: f64,
    /// Speed towards the switch, degrees per second.
    pub speed_deg_s: f64,
    /// Speed when leaving the switch, degrees per second.
    pub edge_speed_deg_s: f64,
}

impl Default for AxisSettings {
    fn default() -> Self {
        let scan = TiltAxisConfig::default();
        Self {
            node: scan.node,
            encoder_lines: scan.encoder_lines,
            gear: scan.gear,
            min_deg: -45.0,
            max_deg: 0.0,
            max_speed_deg_s: 98.0,
            max_accel_deg_s2: 10_000.0,
            quick_stop_deg_s2: 500.0,
            brake_output: None,
            brake_inverted: false,
            sensor_polarity: 0,
            without_brake: WithoutBrake::Release,
            limit_switches: LimitSwitchSettings::default(),
            homing: HomingSettings::default(),
            guard: GuardSettings::default(),
        }
    }
}

impl Default for LimitSwitchSettings {
    /// Factory setting: inputs 6 and 5, high when pressed (objects 2070, 2071).
    fn default() -> Self {
        Self {
            negative: Some(6),
            positive: Some(5),
            normally_closed: false,
        }
    }
}

impl Default for GuardSettings {
    fn default() -> Self {
        let axis = drive::AxisConfig::default();
        Self {
            behind_deg: axis.guard.behind.0,
            servo_lag_ms: 50,
            ahead_deg: axis.guard.ahead.0,
            beyond_limits_deg: axis.guard.beyond_limits.0,
            homing_margin_deg: axis.guard.homing_margin.0,
            following_error_deg: axis.max_following_error.0,
            arrival_deg: None,
            standstill_deg: None,
        }
    }
}

impl Default for HomingSettings {
    fn default() -> Self {
        Self {
            method: 18,
            at_deg: 1.0,
            to_deg: 0.0,
            speed_deg_s: 10.0,
            edge_speed_deg_s: 1.0,
        }
    }
}

impl AxisSettings {
    /// The part stored in a log.
    #[must_use]
    pub fn scan(&self) -> TiltAxisConfig {
        TiltAxisConfig {
            node: self.node,
            encoder_lines: self.encoder_lines,
            gear: self.gear,
        }
    }

    /// Refuses impossible numbers.
    pub(super) fn check(&self) -> Result<(), String> {
        let Self { homing, .. } = self;
        for (name, value) in [
            ("axis.min_deg", self.min_deg),
            ("axis.max_deg", self.max_deg),
            ("axis.homing.at_deg", homing.at_deg),
            ("axis.homing.to_deg", homing.to_deg),
        ] {
            between(name, value, -3_600.0, 3_600.0)?;
        }
        if let (WithoutBrake::Hold, Some(output)) = (self.without_brake, self.brake_output) {
            return Err(format!(
                "axis.without_brake: expected hold on an axis without a brake only, got it with brake_output = {output}"
            ));
        }
        let fastest = self.max_speed_deg_s;
        positive("axis.max_speed_deg_s", fastest, 1e6)?;
        positive("axis.max_accel_deg_s2", self.max_accel_deg_s2, 1e9)?;
        positive("axis.quick_stop_deg_s2", self.quick_stop_deg_s2, 1e9)?;
        positive("axis.homing.speed_deg_s", homing.speed_deg_s, fastest)?;
        positive(
            "axis.homing.edge_speed_deg_s",
            homing.edge_speed_deg_s,
            fastest,
        )
    }
}
