//! Theoretical scan patterns by name: directions of an ideal sensor during a scan, without a scene,
//! packets or clocks.
//!
//! All lasers fire together from one point at fixed steps of azimuth, while the axis tilts at a
//! constant speed. Each revolution of the head is a frame that begins at the same azimuth, so frame
//! k is frame 0 rotated about the tilt axis by k steps ([`FrameRotation`]). The rays are those of
//! [`crate::simulate`]; a test compares them. Where the sensor is off the axis, rays meet a hollow
//! sphere of [`SPHERE_M`].

mod request;
mod view;

use crate::firing::Firing;
use crate::sensor::{DetectionRange, LidarMount, LidarSensor, RayTable};
use glam::DVec3;
use thiserror::Error;

use crate::motion::{AxisMotion, AxisState, Sweeps};

pub use request::{NAMES, PatternRequest};
pub use view::FieldOfView;

/// Radius of the hollow sphere, metres, as in the 2018 paper.
pub const SPHERE_M: f64 = 10.0;
/// The most points of a pattern.
pub const MOST_POINTS: u64 = 100_000_000;
/// The tilt axis in the frame of the base.
pub const AXIS: DVec3 = DVec3::Y;

/// Sensors of patterns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatternSensor {
    /// VLP-16, 16 lasers.
    Vlp16,
    /// HDL-32E, 32 lasers.
    Hdl32e,
    /// VLP-32C, 32 lasers.
    Vlp32c,
    /// One exactly level laser (laser 15 of the HDL-32E).
    Single,
}

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

/// Tilt of a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
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
pub struct PatternSettings {
    /// The sensor.
    pub head: PatternSensor,
    /// Revolutions per minute.
    pub rpm: f64,
    /// Step of azimuth, degrees.
    pub step_deg: f64,
    /// Azimuth of the first firing of a frame, degrees.
    pub start_deg: f64,
    /// Whether the last firing of a frame repeats the first azimuth.
    pub seam: RevolutionEnds,
    /// The tilt.
    pub tilt: PatternTilt,
    /// Number of whole frames; `None` for as long as the tilt moves, with the last frame cut off.
    pub frames: Option<u32>,
    /// Height of the sensor's origin above the tilt axis, metres (d of Eq. 4-6).
    pub d_m: f64,
}

/// A scan pattern.
#[derive(Clone, Debug)]
pub struct Pattern {
    name: String,
    settings: PatternSettings,
    sensor: LidarSensor,
    frames: u32,
    firings: u32,
    /// Signed tilt from frame to frame, degrees.
    step_deg: f64,
    /// The motion with its ramps.
    ramped: Option<AxisMotion>,
}

/// The rotation from each frame of a pattern to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameRotation {
    /// The axis, right-handed.
    pub axis: DVec3,
    /// The angle, radians.
    pub step_rad: f64,
    /// Number of frames.
    pub frames: u32,
}

/// An invalid pattern.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PatternError {
    /// An unknown name.
    #[error("pattern: expected one of {}, got {got:?}", NAMES.join(", "))]
    Name {
        /// The name.
        got: String,
    },
    /// An unknown option, or one that this pattern does not have.
    #[error("pattern {name}: expected {expected}, got {got:?}")]
    Option {
        /// The pattern.
        name: String,
        /// The valid options.
        expected: String,
        /// The option.
        got: String,
    },
    /// A number out of range.
    #[error("pattern {name}: {key}: expected {expected}, got {got}")]
    Number {
        /// The pattern.
        name: String,
        /// Its option.
        key: &'static str,
        /// Its range.
        expected: &'static str,
        /// The number.
        got: f64,
    },
    /// Too many points.
    #[error("pattern {name}: expected at most {MOST_POINTS} points, got {got:.0}")]
    TooMany {
        /// The pattern.
        name: String,
        /// Their number.
        got: f64,
    },
}

impl PatternSensor {
    fn sensor(self) -> LidarSensor {
        match self {
            Self::Vlp16 => LidarSensor::vlp16(),
            Self::Hdl32e => LidarSensor::hdl32e(),
            Self::Vlp32c => LidarSensor::vlp32c(),
            Self::Single => LidarSensor::hdl32e().only(15),
        }
        .ideal()
    }
}

impl Pattern {
    /// A pattern from its parameters.
    ///
    /// # Errors
    /// [`PatternError`] for numbers out of range or too many points.
    pub fn new(name: &str, settings: PatternSettings) -> Result<Self, PatternError> {
        check(name, &settings)?;
        let sensor = settings.head.sensor();
        let per_revolution = 360.0 / settings.step_deg;
        let whole = (per_revolution - per_revolution.round()).abs() < WHOLE * per_revolution;
        let firings = match (whole, settings.seam) {
            (true, RevolutionEnds::Twice) => per_revolution.round() + 1.0,
            (true, RevolutionEnds::Once) => per_revolution.round(),
            (false, _) => per_revolution.ceil(),
        };
        let tilt = settings.tilt;
        let way_deg = tilt.to_deg - tilt.from_deg;
        let by_deg = tilt.speed_deg_s * 60.0 / settings.rpm;
        let ramped = ramped(name, &settings)?;
        let frames = match settings.frames {
            Some(frames) => f64::from(frames),
            None if let Some(motion) = &ramped => (motion.end_s * settings.rpm / 60.0
                * (1.0 - WHOLE))
                .ceil()
                .max(1.0),
            None if by_deg > 0.0 => (way_deg.abs() / by_deg * (1.0 - WHOLE)).ceil().max(1.0),
            None => 1.0,
        };
        let got = frames * firings * f64::from(sensor.used.count_ones());
        if got > MOST_POINTS as f64 {
            let name = name.to_owned();
            return Err(PatternError::TooMany { name, got });
        }
        Ok(Self {
            name: name.to_owned(),
            settings,
            sensor,
            frames: frames as u32,
            firings: firings as u32,
            step_deg: by_deg.copysign(way_deg),
            ramped,
        })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its parameters.
    #[must_use]
    pub const fn settings(&self) -> &PatternSettings {
        &self.settings
    }

    /// Number of frames; the last may be cut off.
    #[must_use]
    pub const fn frames(&self) -> u32 {
        self.frames
    }

    /// Duration of the scan, seconds.
    #[must_use]
    pub fn scan_s(&self) -> f64 {
        let tilt = self.settings.tilt;
        let all = f64::from(self.frames) * 60.0 / self.settings.rpm;
        let way = match &self.ramped {
            Some(motion) => motion.end_s,
            None => (tilt.to_deg - tilt.from_deg).abs() / tilt.speed_deg_s,
        };
        if self.cut() { way.min(all) } else { all }
    }

    /// Whether the end of the tilt ends the scan.
    fn cut(&self) -> bool {
        self.settings.frames.is_none() && self.step_deg != 0.0
    }

    /// The rotation from frame to frame; `None` where the last is cut off, and with ramps.
    #[must_use]
    pub fn frame_rotation(&self) -> Option<FrameRotation> {
        let last = f64::from(self.frames.saturating_sub(1));
        let all = self.firings.saturating_sub(1);
        let whole = !self.cut() || self.ramped.is_none() && self.tilt_deg(last, all).is_some();
        whole.then(|| FrameRotation {
            axis: AXIS,
            step_rad: self.step_deg.to_radians(),
            frames: self.frames,
        })
    }

    /// Number of lasers.
    #[must_use]
    pub fn lasers(&self) -> u32 {
        self.sensor.used.count_ones()
    }

    /// The lowest and highest elevation of its lasers in the sensor's frame, degrees.
    #[must_use]
    pub fn elevations_deg(&self) -> [f64; 2] {
        let used = self.sensor.beams.iter().enumerate();
        let used = used.filter(|(laser, _)| self.sensor.used >> laser & 1 == 1);
        used.fold(
            [f64::INFINITY, f64::NEG_INFINITY],
            |[low, high], (_, beam)| [low.min(beam.elevation_deg), high.max(beam.elevation_deg)],
        )
    }

    /// The least and greatest tilt, degrees.
    #[must_use]
    pub fn tilts_deg(&self) -> [f64; 2] {
        let from_deg = self.settings.tilt.from_deg;
        let last_deg = from_deg + self.cut_deg(f64::from(self.frames) * self.step_deg);
        [from_deg.min(last_deg), from_deg.max(last_deg)]
    }

    /// The visible part of the hollow sphere, as directions from the origin of the base.
    #[must_use]
    pub fn view(&self) -> FieldOfView {
        FieldOfView::new(
            self.elevations_deg(),
            self.tilts_deg(),
            [self.settings.d_m; 2],
            [SPHERE_M; 2],
        )
    }

    /// Limits an angle to the range of the tilt, where that ends the scan.
    fn cut_deg(&self, turned_deg: f64) -> f64 {
        let tilt = self.settings.tilt;
        let way_deg = tilt.to_deg - tilt.from_deg;
        if self.cut() && turned_deg.abs() > way_deg.abs() {
            way_deg
        } else {
            turned_deg
        }
    }

    /// The sensor's range of detection.
    #[must_use]
    pub fn range(&self) -> DetectionRange {
        self.sensor.range()
    }

    /// The tilt at a firing of a frame, degrees; `None` where the scan is over.
    fn tilt_deg(&self, frame: f64, firing: u32) -> Option<f64> {
        let tilt = self.settings.tilt;
        let within = match tilt.steps {
            TiltSteps::Continuous => f64::from(firing) * self.settings.step_deg / 360.0,
            TiltSteps::Stepped => 0.0,
        };
        if let Some(motion) = &self.ramped {
            let time_s = (frame + within) * 60.0 / self.settings.rpm;
            let over = time_s > motion.end_s * (1.0 + WHOLE);
            return (!over).then(|| motion.at(time_s).angle_deg);
        }
        let turned_deg = self.step_deg * (frame + within);
        let way_deg = (tilt.to_deg - tilt.from_deg).abs();
        let over = self.cut() && turned_deg.abs() > way_deg * (1.0 + WHOLE);
        (!over).then_some(tilt.from_deg + turned_deg)
    }

    /// The directions of a frame in firing order, length 1, in the frame of the base: x right, y
    /// along the tilt axis, z up. Empty beyond the last frame.
    #[must_use]
    pub fn frame(&self, number: u32) -> Vec<DVec3> {
        let mut directions = Vec::new();
        if number < self.frames {
            self.append(number, &mut directions);
        }
        directions
    }

    /// All directions, frame by frame.
    #[must_use]
    pub fn directions(&self) -> Vec<DVec3> {
        let shots = u64::from(self.frames)
            * u64::from(self.firings)
            * u64::from(self.sensor.used.count_ones());
        let mut directions = Vec::with_capacity(shots.min(MOST_POINTS) as usize);
        for frame in 0..self.frames {
            self.append(frame, &mut directions);
        }
        directions
    }

    fn append(&self, frame: u32, directions: &mut Vec<DVec3>) {
        let PatternSettings {
            start_deg,
            step_deg,
            d_m,
            ..
        } = self.settings;
        // Lasers fire together, so the speed of the head does not matter.
        let rays = RayTable::new(&self.sensor, 0.0);
        let mount = LidarMount::above(d_m);
        let mut firing = Firing::new(rays.count);
        firing.alive = self.sensor.used;
        for number in 0..self.firings {
            let Some(angle_deg) = self.tilt_deg(f64::from(frame), number) else {
                break;
            };
            firing.azimuth_deg = start_deg + f64::from(number) * step_deg;
            firing.tilt = AxisState {
                angle_deg,
                rate_deg_s: 0.0,
            };
            firing.aim(&rays, &mount);
            let shots = firing.origins_m.iter().zip(&firing.directions).enumerate();
            for (_, (origin, direction)) in shots.filter(|(laser, _)| firing.is_alive(*laser)) {
                if d_m == 0.0 {
                    directions.push(*direction);
                } else {
                    directions.push(on_sphere(*origin, *direction));
                }
            }
        }
    }
}

/// The motion of a pattern with ramps.
fn ramped(name: &str, settings: &PatternSettings) -> Result<Option<AxisMotion>, PatternError> {
    let tilt = settings.tilt;
    let Some(accel_deg_s2) = tilt.accel_deg_s2 else {
        return Ok(None);
    };
    let motion = AxisMotion::sweeps(&Sweeps {
        from_deg: tilt.from_deg,
        to_deg: tilt.to_deg,
        speed_deg_s: tilt.speed_deg_s,
        accel_deg_s2: Some(accel_deg_s2),
        count: 1,
        both_ways: false,
        rest_s: 0.0,
    });
    motion.map(Some).map_err(|error| PatternError::Option {
        name: name.to_owned(),
        expected: "a tilt with ramps".to_owned(),
        got: error.what,
    })
}

/// The direction from the centre of the hollow sphere to the point where a ray from within meets
/// it.
fn on_sphere(origin_m: DVec3, direction: DVec3) -> DVec3 {
    let along = origin_m.dot(direction);
    let beside = origin_m.length_squared() - along * along;
    let range_m = (SPHERE_M * SPHERE_M - beside).max(0.0).sqrt() - along;
    (origin_m + range_m * direction).normalize()
}

/// Relative difference below which two numbers are equal but for rounding.
const WHOLE: f64 = 1e-9;

fn check(name: &str, settings: &PatternSettings) -> Result<(), PatternError> {
    let tilt = settings.tilt;
    let rules = [
        ("rpm", settings.rpm, 1.0, 100_000.0, "1 to 100000 rpm"),
        ("step", settings.step_deg, 1e-3, 90.0, "0.001 to 90 deg"),
        (
            "start",
            settings.start_deg,
            -360.0,
            360.0,
            "-360 to 360 deg",
        ),
        ("from", tilt.from_deg, -360.0, 360.0, "-360 to 360 deg"),
        ("to", tilt.to_deg, -360.0, 360.0, "-360 to 360 deg"),
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

#[cfg(test)]
mod tests;
