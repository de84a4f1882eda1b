//! `[axis]`: encoder, gear, limits, homing.

use scanner::config::TiltAxisConfig;
use serde::Deserialize;

use super::{between, positive};

/// The tilt axis: encoder, gear, limits.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
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
    /// Limit switches; the factory's inputs without the table.
    pub limit_switches: LimitSwitchSettings,
    /// Homing.
    pub homing: HomingSettings,
}

/// Digital inputs of the limit switches (1..=9). A switch omitted from the table does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
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

/// Homing of the axis.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
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
            limit_switches: LimitSwitchSettings::default(),
            homing: HomingSettings::default(),
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
