//! Parameters of a pattern and their ranges.

use super::{PatternError, SensorName};

/// Motion of the tilt axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TiltSteps {
    /// Continuous.
    Continuous,
    /// In steps from frame to frame.
    Stepped,
}

/// Firings at the azimuth where a revolution begins, if a revolution is a whole number of steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RevolutionEnds {
    /// At the begin and at the end, as in the 2018 paper: 901 firings of 0.4 degrees.
    Twice,
    /// At the begin only: 900 firings.
    Once,
}

/// Front of a planar scanner on the tilt axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanarFront {
    /// Along the axis: it rolls.
    Roll,
    /// Across the axis, towards -x: it pitches.
    Pitch,
}

impl PlanarFront {
    /// Azimuth of the front, degrees.
    #[must_use]
    pub const fn azimuth_deg(self) -> f64 {
        match self {
            Self::Roll => 0.0,
            Self::Pitch => -90.0,
        }
    }
}

/// Tilt of a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PatternTilt {
    /// First angle, degrees; the only one without motion.
    pub from_deg: f64,
    /// Last angle, degrees.
    pub to_deg: f64,
    /// Speed, degrees per second; 0 without motion.
    pub speed_deg_s: f64,
    /// Motion of the axis.
    pub steps: TiltSteps,
    /// Acceleration of the ramps at both ends, degrees per second squared; `None` without ramps.
    pub accel_deg_s2: Option<f64>,
}

/// Parameters of a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PatternSettings {
    /// The sensor.
    pub head: SensorName,
    /// Revolutions per minute.
    pub rpm: f64,
    /// Step of azimuth, degrees.
    pub step_deg: f64,
    /// Azimuth of the first firing of a frame of a rotating head, degrees.
    pub start_deg: f64,
    /// Front of a planar scanner.
    pub front: PlanarFront,
    /// Whether the last firing of a frame repeats the first azimuth.
    pub seam: RevolutionEnds,
    /// The tilt.
    pub tilt: PatternTilt,
    /// Number of whole frames; `None` for as long as the tilt moves, with the last frame cut off.
    pub frames: Option<u32>,
    /// Height of the sensor's origin above the tilt axis, metres (d of Eq. 4-6).
    pub d_m: f64,
}

/// Checks the ranges of all numbers.
pub(super) fn check(name: &str, settings: &PatternSettings) -> Result<(), PatternError> {
    let wrong_rpm = |expected| PatternError::Number {
        name: name.to_owned(),
        key: "rpm",
        expected,
        got: settings.rpm,
    };
    settings.head.check_rpm(settings.rpm).map_err(wrong_rpm)?;
    let tilt = settings.tilt;
    let rules = [
        ("step", settings.step_deg, 1e-3, 90.0, "0.001 to 90 deg"),
        (
            "start",
            settings.start_deg,
            -360.0,
            360.0,
            "-360 to 360 deg",
        ),
        ("from", tilt.from_deg, -360.0, 360.0, "-360 to 360 deg"),
        ("to", tilt.to_deg, -36e3, 36e3, "-36000 to 36000 deg"),
        ("speed", tilt.speed_deg_s, 0.0, 1e6, "0 to 1000000 deg/s"),
        ("d", settings.d_m, -5.0, 5.0, "-5 to 5 m"),
        (
            "accel",
            tilt.accel_deg_s2.unwrap_or(1.0),
            1e-3,
            1e9,
            "0.001 to 1000000000 deg/s2",
        ),
        (
            "frames",
            f64::from(settings.frames.unwrap_or(1)),
            1.0,
            1e6,
            "1 to 1000000 frames",
        ),
    ];
    for (key, got, least, most, expected) in rules {
        if !(least..=most).contains(&got) {
            return Err(PatternError::Number {
                name: name.to_owned(),
                key,
                expected,
                got,
            });
        }
    }
    Ok(())
}
