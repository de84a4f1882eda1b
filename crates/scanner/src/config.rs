//! Configuration of a scan, carried in the log as TOML.

use cloud::mount::Mount;
use serde::{Deserialize, Serialize};
use units::{Degrees, Gearing, GearingError, Span};
use utoipa::ToSchema;

pub use crate::calibration::{
    AxisCorrection, DeviceCalibration, LaserCalibration, ParameterCovariance,
};

/// The configuration of a scan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ScanConfig {
    /// Version of the program that wrote it.
    pub velomotion: String,
    /// Name of the device profile.
    pub device: String,
    /// Whether the devices were simulated.
    pub simulated: bool,
    /// Mount of the lidar on the tilt axis.
    pub mount: MountConfig,
    /// Accuracy of the lidar.
    pub lidar: RangeAccuracy,
    /// The tilt axis.
    pub axis: TiltAxisConfig,
    /// Speed of the drive's RS232 line, baud; absent on every other link.
    pub rs232_baud: Option<u32>,
    /// The planned sweeps; absent if none were planned.
    pub sweep: Option<SweepPlan>,
    /// Calibration of axis and lasers; absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<DeviceCalibration>,
    /// Simulated scene, in a log of `velomotion simulate`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation: Option<SimulatedScene>,
}

/// A simulated scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SimulatedScene {
    /// Its file, or its name.
    pub scene: String,
    /// Random seed, decimal: TOML has no numbers of 64 bits without sign.
    pub seed: String,
    /// Effects that were on.
    pub effects: Vec<String>,
    /// [`SimulatedScene::fingerprint_of`] the scene's text; absent in older logs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fingerprint: Option<String>,
}

impl SimulatedScene {
    /// Tells texts of scenes apart: their FNV-1a hash of 64 bits, hexadecimal.
    #[must_use]
    pub fn fingerprint_of(text: &str) -> String {
        let hash = text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
        format!("{hash:016x}")
    }
}

/// Bits of the body of a read request on RS232 (Communication Guide: length, two words, checksum),
/// with start, stop and eight data bits per byte.
const READ_BODY_BITS: i64 = 7 * 10;

impl ScanConfig {
    /// Transmission time of a position request on an RS232 line; zero on other links.
    pub(crate) fn request_transmission_time(&self) -> Span {
        let baud = i64::from(self.rs232_baud.unwrap_or(0));
        Span::from_nanos(
            (READ_BODY_BITS * 1_000_000_000)
                .checked_div(baud)
                .unwrap_or(0),
        )
    }
}

/// Mount of the lidar on the tilt axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MountConfig {
    /// Height of the lidar's origin above the tilt axis, metres (d of Eq. 4-6).
    pub d_m: f64,
    /// Offset from there on the level platform, metres: x right, y along the axis, z up.
    #[serde(skip_serializing_if = "is_zero")]
    pub position_m: [f64; 3],
    /// Rotation of the lidar about the platform's x, then y, then z, degrees.
    #[serde(skip_serializing_if = "is_zero")]
    pub rotation_deg: [f64; 3],
}

/// Upright mounts are written as before rotations were known, so that their logs stay the same.
fn is_zero(numbers: &[f64; 3]) -> bool {
    *numbers == [0.0; 3]
}

/// Accuracy of the lidar.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RangeAccuracy {
    /// Standard deviation of a range, including quantisation, metres.
    pub range_sd_m: f64,
}

/// Encoder, gear and node id.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TiltAxisConfig {
    /// Node id of the drive.
    pub node: u8,
    /// Lines of the encoder on the motor shaft.
    pub encoder_lines: u32,
    /// Motor turns and axis turns of the gear: `[120, 1]` is 120:1.
    pub gear: [u32; 2],
}

/// The sweeps of a capture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepPlan {
    /// Angle where sweeps start, degrees.
    pub from_deg: f64,
    /// Angle where sweeps end, degrees.
    pub to_deg: f64,
    /// Speed as commanded in whole rpm, degrees per second; a sweep too short for it does not reach
    /// it.
    pub cruise_deg_s: f64,
    /// Acceleration as commanded in whole rpm/s, degrees per second squared.
    pub accel_deg_s2: f64,
    /// Number of sweeps.
    pub sweeps: u32,
    /// Whether the return move is a sweep too.
    pub both_ways: bool,
}

impl Default for ScanConfig {
    fn default() -> Self {
        Self {
            velomotion: env!("CARGO_PKG_VERSION").to_owned(),
            device: "unknown".to_owned(),
            simulated: false,
            mount: MountConfig::default(),
            lidar: RangeAccuracy::default(),
            axis: TiltAxisConfig::default(),
            rs232_baud: None,
            sweep: None,
            calibration: None,
            simulation: None,
        }
    }
}

impl Default for MountConfig {
    /// 6 cm: the Velomotion-16.
    fn default() -> Self {
        Self::upright(0.06)
    }
}

impl Default for RangeAccuracy {
    /// A third of the typical accuracy of the VLP-16, 3 cm by its manual (63-9243, specifications).
    /// The manual does not define it. As three standard deviations it agrees with recordings of
    /// three VLP-16s, whose ranges spread by 7 to 13 mm within a laser.
    fn default() -> Self {
        Self { range_sd_m: 0.01 }
    }
}

impl Default for TiltAxisConfig {
    /// 500 lines behind 120:1: 0.0015 deg per quadcount, 0.05 deg/s per rpm.
    fn default() -> Self {
        Self {
            node: 1,
            encoder_lines: 500,
            gear: [120, 1],
        }
    }
}

impl MountConfig {
    /// An upright mount at a height of `d_m` metres.
    #[must_use]
    pub const fn upright(d_m: f64) -> Self {
        Self {
            d_m,
            position_m: [0.0; 3],
            rotation_deg: [0.0; 3],
        }
    }

    /// The mount's geometry.
    #[must_use]
    pub fn mount(self) -> Mount {
        let [x, y, z] = self.position_m;
        Mount::at([x, y, self.d_m + z], self.rotation_deg)
    }

    /// Whether every number is finite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        let numbers = self.position_m.into_iter().chain(self.rotation_deg);
        self.d_m.is_finite() && numbers.into_iter().all(f64::is_finite)
    }
}

impl TiltAxisConfig {
    /// The gearing.
    ///
    /// # Errors
    /// If one of its numbers is zero.
    pub fn gearing(self) -> Result<Gearing, GearingError> {
        let [motor_turns, axis_turns] = self.gear;
        Gearing::new(self.encoder_lines, motor_turns, axis_turns)
    }
}

impl SweepPlan {
    /// Whether a move from `from` towards `target` is the plan's next sweep after `done` sweeps.
    ///
    /// The first goes forward, with `both_ways` the next one back, and so on, up to the planned
    /// number. The way to the starting place is thereby excluded, even from end to end.
    #[must_use]
    pub fn is_next_sweep(
        &self,
        done: usize,
        from: Degrees,
        target: Degrees,
        tolerance_deg: f64,
    ) -> bool {
        let near = |a: Degrees, b: Degrees| (a.0 - b.0).abs() <= tolerance_deg;
        let (start, end) = self.ends(done);
        (done as u64) < u64::from(self.sweeps) && near(from, start) && near(target, end)
    }

    /// Beginning and end of the sweep after `done` sweeps.
    #[must_use]
    pub const fn ends(&self, done: usize) -> (Degrees, Degrees) {
        let (from, to) = (Degrees(self.from_deg), Degrees(self.to_deg));
        match self.both_ways && done % 2 == 1 {
            true => (to, from),
            false => (from, to),
        }
    }

    /// Whether an angle is between the ends.
    pub(crate) fn is_between(&self, angle: Degrees) -> bool {
        let low = self.from_deg.min(self.to_deg);
        (low..=self.from_deg.max(self.to_deg)).contains(&angle.0)
    }
}
