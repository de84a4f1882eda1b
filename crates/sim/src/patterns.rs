//! Theoretical scan patterns by name: directions of an ideal sensor during a scan, without a scene,
//! packets or clocks.
//!
//! All lasers fire together from one point at fixed steps of azimuth, while the axis tilts at a
//! constant speed. Each revolution of the head is a frame that begins at the same azimuth, so frame
//! k is frame 0 rotated about the tilt axis by k steps ([`PatternRotation`]). The rays are those of
//! [`crate::simulate`]; a test compares them. Where the sensor is off the axis, rays meet a hollow
//! sphere of [`SPHERE_M`].

mod request;
mod sensor;
mod settings;
mod view;

use glam::{DMat3, DVec3};
use thiserror::Error;
use units::ShortNumber;

use crate::motion::{AxisMotion, Sweeps};
use crate::sensor::DetectionRange;

pub use request::{NAMES, PatternRequest};
pub use sensor::SensorName;
pub use settings::{PatternSettings, PatternTilt, PlanarFront, RevolutionEnds, TiltSteps};
pub use view::FieldOfView;

/// Radius of the hollow sphere, metres, as in the 2018 paper.
pub const SPHERE_M: f64 = 10.0;
/// The most points of a pattern.
pub const MOST_POINTS: u64 = 2_000_000_000;
/// The tilt axis in the frame of the base.
pub const AXIS: DVec3 = DVec3::Y;

/// A scan pattern.
#[derive(Clone, Debug)]
pub struct Pattern {
    name: String,
    settings: PatternSettings,
    elevations_deg: Vec<f64>,
    /// Directions of the lasers at azimuth 0.
    aims: Vec<DVec3>,
    /// Azimuth of the first firing of a frame, degrees.
    start_deg: f64,
    frames: u32,
    firings: u32,
    /// Signed tilt from frame to frame, degrees.
    step_deg: f64,
    /// The motion with its ramps.
    ramped: Option<AxisMotion>,
}

/// The rotation from each frame of a pattern to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatternRotation {
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
    #[error("pattern {name}: {key}: expected {expected}, got {}", ShortNumber(*got))]
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

impl Pattern {
    /// A pattern from its parameters.
    ///
    /// # Errors
    /// [`PatternError`] for numbers out of range or too many points.
    pub fn new(name: &str, settings: PatternSettings) -> Result<Self, PatternError> {
        settings::check(name, &settings)?;
        let elevations_deg = settings.head.elevations_deg();
        let aperture_deg = settings.head.aperture_deg();
        let steps = aperture_deg.unwrap_or(360.0) / settings.step_deg;
        let whole = (steps - steps.round()).abs() < WHOLE * steps;
        let firings = match (whole, settings.seam) {
            (true, RevolutionEnds::Twice) => steps.round() + 1.0,
            (true, RevolutionEnds::Once) => steps.round(),
            (false, _) => steps.ceil(),
        };
        let tilt = settings.tilt;
        let way_deg = tilt.to_deg - tilt.from_deg;
        let by_deg = tilt.speed_deg_s * 60.0 / settings.rpm;
        let ramped = ramped(name, &settings)?;
        let at_least = |frames: f64| (frames * (1.0 - WHOLE)).ceil().max(1.0);
        let frames = match (settings.frames, &ramped) {
            (Some(frames), _) => f64::from(frames),
            (None, Some(motion)) => at_least(motion.end_s * settings.rpm / 60.0),
            (None, None) if by_deg > 0.0 => at_least(way_deg.abs() / by_deg),
            (None, None) => 1.0,
        };
        let got = frames * firings * elevations_deg.len() as f64;
        if got > MOST_POINTS as f64 {
            let name = name.to_owned();
            return Err(PatternError::TooMany { name, got });
        }
        Ok(Self {
            name: name.to_owned(),
            settings,
            aims: elevations_deg
                .iter()
                .map(|at| DMat3::from_rotation_x(at.to_radians()) * DVec3::Y)
                .collect(),
            elevations_deg,
            start_deg: aperture_deg.map_or(settings.start_deg, |aperture_deg| {
                settings.front.azimuth_deg() - 0.5 * aperture_deg
            }),
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
    pub fn frame_rotation(&self) -> Option<PatternRotation> {
        let last = f64::from(self.frames.saturating_sub(1));
        let all = self.firings.saturating_sub(1);
        let whole = !self.cut() || self.ramped.is_none() && self.tilt_deg(last, all).is_some();
        whole.then(|| PatternRotation {
            axis: AXIS,
            step_rad: self.step_deg.to_radians(),
            frames: self.frames,
        })
    }

    /// Number of lasers.
    #[must_use]
    pub fn lasers(&self) -> u32 {
        self.aims.len() as u32
    }

    /// The lowest and highest elevation of its lasers in the sensor's frame, degrees.
    #[must_use]
    pub fn elevations_deg(&self) -> [f64; 2] {
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let elevations = self.elevations_deg.iter();
        elevations.fold(none, |[low, high], at| [low.min(*at), high.max(*at)])
    }

    /// First and last azimuth of a planar scanner, degrees; `None` for a rotating head.
    #[must_use]
    pub fn azimuths_deg(&self) -> Option<[f64; 2]> {
        let aperture_deg = self.settings.head.aperture_deg()?;
        Some([self.start_deg, self.start_deg + aperture_deg])
    }

    /// Whether it sees an azimuth, degrees.
    #[must_use]
    pub fn sees_azimuth(&self, azimuth_deg: f64) -> bool {
        self.azimuths_deg()
            .is_none_or(|[first, last]| (azimuth_deg - first).rem_euclid(360.0) <= last - first)
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
        let mut view = FieldOfView::new(
            self.elevations_deg(),
            self.tilts_deg(),
            [self.settings.d_m; 2],
            [SPHERE_M; 2],
        );
        view.azimuths_deg = self.azimuths_deg();
        view
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
        self.settings.head.range()
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
        let mut directions = Vec::with_capacity(self.points() as usize);
        for frame in 0..self.frames {
            self.append(frame, &mut directions);
        }
        directions
    }

    /// Number of points.
    #[must_use]
    pub fn points(&self) -> u64 {
        let last = self.frames.saturating_sub(1);
        let is_over = |firing: u32| self.tilt_deg(f64::from(last), firing).is_none();
        // The tilt ends within the last frame.
        let (mut fired, mut over) = (0, self.firings);
        while fired < over {
            let middle = fired.midpoint(over);
            match is_over(middle) {
                true => over = middle,
                false => fired = middle + 1,
            }
        }
        let firings = u64::from(last) * u64::from(self.firings) + u64::from(fired);
        firings * self.aims.len() as u64
    }

    /// The direction of a point by its number in [`Pattern::directions`]; `None` beyond the last.
    #[must_use]
    pub fn direction(&self, point: u64) -> Option<DVec3> {
        let lasers = self.aims.len().max(1) as u64;
        let (firing, laser) = (point / lasers, point % lasers);
        let firings = u64::from(self.firings);
        let frame = u32::try_from(firing / firings)
            .ok()
            .filter(|frame| *frame < self.frames)?;
        let pose = self.pose(frame, (firing % firings) as u32)?;
        Some(pose.direction(*self.aims.get(laser as usize)?))
    }

    fn append(&self, frame: u32, directions: &mut Vec<DVec3>) {
        for number in 0..self.firings {
            let Some(pose) = self.pose(frame, number) else {
                break;
            };
            directions.extend(self.aims.iter().map(|aim| pose.direction(*aim)));
        }
    }

    /// The sensor at a firing of a frame; `None` where the scan is over.
    fn pose(&self, frame: u32, firing: u32) -> Option<SensorPose> {
        let tilt_deg = self.tilt_deg(f64::from(frame), firing)?;
        let azimuth_deg = self.start_deg + f64::from(firing) * self.settings.step_deg;
        let platform = DMat3::from_rotation_y(tilt_deg.to_radians());
        Some(SensorPose {
            head: platform * DMat3::from_rotation_z(-azimuth_deg.to_radians()),
            origin_m: self.settings.d_m * platform.z_axis,
        })
    }
}

/// A sensor at a firing. Lasers fire together, so the speed of the head does not matter.
struct SensorPose {
    head: DMat3,
    origin_m: DVec3,
}

impl SensorPose {
    fn direction(&self, aim: DVec3) -> DVec3 {
        let direction = self.head * aim;
        if self.origin_m == DVec3::ZERO {
            direction
        } else {
            on_sphere(self.origin_m, direction)
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

#[cfg(test)]
mod tests;
