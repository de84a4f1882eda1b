//! `[sensor]`, `[motion]`, `[mount]`, `[drive]` and `[link]`.

use serde::Deserialize;
use units::Gearing;

use crate::effect_models::settings_of::{
    Backlash, Batching, DuplicateSettings, Eccentricity, EncoderQuantisationSettings,
    GearRippleSettings, LidarClockSettings, LinkJitterSettings, LossSettings, OwnShadowSettings,
    RangeNoiseSettings, ReorderSettings, ServoLagSettings, TiltLimits,
};
use crate::motion::{AxisMotion, MotionError, Sweeps};
use crate::packet_maker::HeadRotation;
use crate::patterns::SensorName;
use crate::scenery::InvalidValue;
use crate::sensor::{DetectionRange, LidarMount, LidarSensor, ReturnMode};
use crate::simulate::Polls;

pub(super) fn invalid(path: impl Into<String>, what: impl Into<String>) -> InvalidValue {
    InvalidValue {
        path: path.into(),
        what: what.into(),
    }
}

/// `[sensor]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct SensorSection {
    model: SensorName,
    /// Number of the only active laser in firing order; absent: all.
    only_laser: Option<usize>,
    /// Whether all lasers of a firing start from one point at one instant.
    ideal: bool,
    /// Range of detection, metres; absent: the model's.
    range_m: Option<[f64; 2]>,
    returns: ReturnsName,
    /// Revolutions per minute; absent: 600 of a head that may rotate so, else the usual rate.
    rpm: Option<u32>,
    /// Azimuth of the first firing, degrees.
    start_deg: f64,
    /// Noise of its ranges.
    pub noise: Option<RangeNoiseSettings>,
    /// Its clock.
    pub clock: Option<LidarClockSettings>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum ReturnsName {
    #[default]
    Strongest,
    Last,
    Dual,
}

/// Revolutions per minute of scenes that state none.
const USUAL_RPM: u32 = 600;

impl Default for SensorSection {
    fn default() -> Self {
        Self {
            model: SensorName::default(),
            only_laser: None,
            ideal: false,
            range_m: None,
            returns: ReturnsName::default(),
            rpm: None,
            start_deg: 0.0,
            noise: None,
            clock: None,
        }
    }
}

impl SensorSection {
    /// Whether the sensor has no errors of its own.
    pub const fn is_ideal(&self) -> bool {
        self.ideal
    }

    /// The lidar's model.
    pub const fn model(&self) -> SensorName {
        self.model
    }

    pub fn build(&self) -> Result<(LidarSensor, ReturnMode, HeadRotation), InvalidValue> {
        let mut sensor = self.model.sensor();
        if let Some(laser) = self.only_laser {
            sensor = sensor.only(laser);
            if sensor.used == 0 {
                let what = format!("expected a laser of this sensor, got {laser}");
                return Err(invalid("sensor.only_laser", what));
            }
        }
        if self.ideal {
            sensor = sensor.ideal();
        }
        if let Some([min_m, max_m]) = self.range_m {
            if !(0.0 <= min_m && min_m < max_m && max_m.is_finite()) {
                let what = format!("expected 0 <= from < to in metres, got {min_m} and {max_m}");
                return Err(invalid("sensor.range_m", what));
            }
            sensor = sensor.with_range(DetectionRange { min_m, max_m });
        }
        let returns = match self.returns {
            ReturnsName::Strongest => ReturnMode::Strongest,
            ReturnsName::Last => ReturnMode::Last,
            ReturnsName::Dual => ReturnMode::Dual,
        };
        let start_deg = self.start_deg;
        let is_usual = self.model.check_rpm(f64::from(USUAL_RPM)).is_ok();
        let usual_rpm = match is_usual {
            true => USUAL_RPM,
            false => self.model.usual_rpm() as u32,
        };
        let rpm = self.rpm.unwrap_or(usual_rpm);
        if let Err(expected) = self.model.check_rpm(f64::from(rpm)) {
            return Err(invalid(
                "sensor.rpm",
                format!("expected {expected}, got {rpm}"),
            ));
        }
        finite("sensor.start_deg", "an azimuth in degrees", start_deg)?;
        Ok((sensor, returns, HeadRotation { rpm, start_deg }))
    }
}

/// `[motion]`. The keys of each kind are checked here, because serde would lose the line.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MotionSection {
    kind: MotionKind,
    /// Fixed: the angle, degrees.
    angle_deg: Option<f64>,
    /// Fixed: the duration, seconds.
    duration_s: Option<f64>,
    /// Sweeps: the first angle, degrees.
    from_deg: Option<f64>,
    /// Sweeps: the last angle, degrees.
    to_deg: Option<f64>,
    /// Sweeps: speed, degrees per second.
    speed_deg_s: Option<f64>,
    /// Sweeps: acceleration; absent: infinite, as in ideal scan patterns.
    accel_deg_s2: Option<f64>,
    /// Sweeps: their number.
    count: Option<u32>,
    /// Sweeps: whether the way back is a sweep too.
    both_ways: Option<bool>,
    /// Sweeps: rest before, between and after, seconds.
    rest_s: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum MotionKind {
    Fixed,
    Sweeps,
}

/// Time to poll the drive at rest and to command it, seconds.
const REST_S: f64 = 0.1;

impl MotionSection {
    pub fn build(&self) -> Result<AxisMotion, InvalidValue> {
        match self.kind {
            MotionKind::Fixed => self.fixed(),
            MotionKind::Sweeps => self.sweeps(),
        }
    }

    fn fixed(&self) -> Result<AxisMotion, InvalidValue> {
        reject(
            "not allowed for a fixed axis",
            &[
                ("from_deg", self.from_deg.is_some()),
                ("to_deg", self.to_deg.is_some()),
                ("speed_deg_s", self.speed_deg_s.is_some()),
                ("accel_deg_s2", self.accel_deg_s2.is_some()),
                ("count", self.count.is_some()),
                ("both_ways", self.both_ways.is_some()),
                ("rest_s", self.rest_s.is_some()),
            ],
        )?;
        let duration_s = required(self.duration_s, "duration_s")?;
        let angle_deg = self.angle_deg.unwrap_or(0.0);
        Ok(AxisMotion::fixed(angle_deg, duration_s)?)
    }

    fn sweeps(&self) -> Result<AxisMotion, InvalidValue> {
        reject(
            "sweeps have no such key: their duration follows from the speed",
            &[
                ("angle_deg", self.angle_deg.is_some()),
                ("duration_s", self.duration_s.is_some()),
            ],
        )?;
        let both_ways = self.both_ways.unwrap_or(false);
        let sweeps = Sweeps {
            from_deg: required(self.from_deg, "from_deg")?,
            to_deg: required(self.to_deg, "to_deg")?,
            speed_deg_s: required(self.speed_deg_s, "speed_deg_s")?,
            accel_deg_s2: self.accel_deg_s2,
            count: self.count.unwrap_or(if both_ways { 2 } else { 1 }),
            both_ways,
            rest_s: self.rest_s.unwrap_or(REST_S),
        };
        if sweeps.count == 0 {
            let what = "count: expected one sweep or more, got 0";
            return Err(invalid("motion.count", what));
        }
        Ok(AxisMotion::sweeps(&sweeps)?)
    }
}

impl From<MotionError> for InvalidValue {
    fn from(error: MotionError) -> Self {
        invalid(format!("motion.{}", error.key), error.to_string())
    }
}

/// Rejects the first of these keys of `[motion]` that is present.
fn reject(why: &str, keys: &[(&str, bool)]) -> Result<(), InvalidValue> {
    match keys.iter().find(|(_, present)| *present) {
        Some((key, _)) => Err(invalid(format!("motion.{key}"), why)),
        None => Ok(()),
    }
}

fn required(value: Option<f64>, key: &str) -> Result<f64, InvalidValue> {
    value.ok_or_else(|| invalid("motion", format!("[motion] lacks {key}")))
}

/// `[mount]`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct MountSection {
    /// Height of the lidar's origin above the tilt axis, metres (d of Eq. 4-6).
    d_m: f64,
    /// Offset from that, metres in the frame of the platform: x right, y along the axis, z up.
    position_m: [f64; 3],
    /// Rotation about x, then y, then z of the platform, degrees.
    rotation_deg: [f64; 3],
    /// Shadow of the scanner's frame and tripod.
    pub shadow: Option<OwnShadowSettings>,
}

impl MountSection {
    pub fn build(&self) -> Result<LidarMount, InvalidValue> {
        finite("mount.d_m", "a height in metres", self.d_m)?;
        for (path, three) in [
            ("mount.position_m", self.position_m),
            ("mount.rotation_deg", self.rotation_deg),
        ] {
            if !three.iter().all(|number| number.is_finite()) {
                let what = format!("expected three numbers, got {three:?}");
                return Err(invalid(path, what));
            }
        }
        let [x, y, z] = self.position_m;
        Ok(LidarMount::at([x, y, self.d_m + z], self.rotation_deg))
    }
}

/// `[drive]`: the polling of the drive, and facts of drive and gear. The encoder is ideal unless an
/// effect replaces it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct DriveSection {
    /// Requests per second.
    poll_hz: f64,
    /// From a request to its answer, milliseconds.
    answer_ms: f64,
    pub encoder: Option<EncoderQuantisationSettings>,
    pub servo: Option<ServoLagSettings>,
    /// Mechanical stops.
    pub stops: Option<TiltLimits>,
    pub gear_ripple: Option<GearRippleSettings>,
    pub eccentricity: Option<Eccentricity>,
    pub backlash: Option<Backlash>,
}

impl Default for DriveSection {
    fn default() -> Self {
        Self {
            poll_hz: 400.0,
            answer_ms: 1.0,
            encoder: None,
            servo: None,
            stops: None,
            gear_ripple: None,
            eccentricity: None,
            backlash: None,
        }
    }
}

/// An ideal encoder: 30,000 lines behind 12,000:1 are 2.5e-7 degrees per count and 0.0005 deg/s per
/// rpm, and 32 bits of counts hold 536 degrees.
const IDEAL_ENCODER: Gearing = match Gearing::new(30_000, 12_000, 1) {
    Ok(gearing) => gearing,
    Err(_) => unreachable!(),
};

impl DriveSection {
    pub fn build(&self) -> Result<Polls, InvalidValue> {
        let (poll_hz, answer_ms) = (self.poll_hz, self.answer_ms);
        for (path, got, range, unit) in [
            ("drive.poll_hz", poll_hz, 0.1..=20_000.0, "polls per second"),
            ("drive.answer_ms", answer_ms, 0.0..=10_000.0, "milliseconds"),
        ] {
            if !range.contains(&got) {
                let (low, high) = (range.start(), range.end());
                let what = format!("expected {low} to {high} {unit}, got {got}");
                return Err(invalid(path, what));
            }
        }
        Ok(Polls {
            period_ns: (1e9 / poll_hz).round() as i64,
            answer_ns: (answer_ms * 1e6).round() as i64,
            gearing: IDEAL_ENCODER,
        })
    }
}

/// `[link]`: the lidar's network, the drive's link and the host.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct LinkSection {
    pub delay: Option<LinkJitterSettings>,
    pub loss: Option<LossSettings>,
    pub duplicate: Option<DuplicateSettings>,
    pub reorder: Option<ReorderSettings>,
    /// Periodic reading by the host.
    pub batching: Option<Batching>,
}

fn finite(path: &str, what: &str, got: f64) -> Result<(), InvalidValue> {
    match got.is_finite() {
        true => Ok(()),
        false => Err(invalid(path, format!("expected {what}, got {got}"))),
    }
}
