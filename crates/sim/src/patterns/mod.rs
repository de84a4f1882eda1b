//! Scan patterns by name: which ways an ideal sensor looks during a scan, without a scene, packets or clocks.
//!
//! A pattern is a sensor whose lasers fire together from one point, at fixed steps of azimuth, while its axis turns steadily. It is made of frames, one
//! a turn of the head, each beginning at the same azimuth: so frame k is frame 0 turned about the tilt axis by k steps ([`Turns`]). The rays are those of the
//! simulation ([`crate::simulate`]), which a test holds against these; where the sensor stands beside the axis they meet a hollow sphere of
//! [`SPHERE_M`] about it. Left out: what is between the names and the numbers ([`Wish`]), and what patterns are good for.

mod view;
mod wish;

use glam::DVec3;
use thiserror::Error;

use crate::motion::Stand;
use crate::sensor::{Rays, Reach, Sensor};
use crate::simulate::{Firing, Mount};

pub use view::View;
pub use wish::{NAMES, Wish};

/// The hollow sphere that rays meet, metres: the one of the 2018 paper.
pub const SPHERE_M: f64 = 10.0;
/// The most points of a pattern.
pub const MOST_POINTS: u64 = 100_000_000;
/// The tilt axis in the frame of the base.
pub const AXIS: DVec3 = DVec3::Y;

/// The sensors that patterns are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Head {
    /// VLP-16, 16 lasers.
    Vlp16,
    /// HDL-32E, 32 lasers.
    Hdl32e,
    /// VLP-32C, 32 lasers.
    Vlp32c,
    /// One exactly level laser.
    Single,
}

/// How the tilt axis goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steps {
    /// All the time.
    Continuous,
    /// At once from frame to frame, and stands in between.
    Stepped,
}

/// How often the azimuth where a turn begins is fired at, where a turn is a whole number of steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seam {
    /// At the begin and at the end, as in the 2018 paper: 901 firings of 0.4 degrees.
    Twice,
    /// At the begin only: 900.
    Once,
}

/// How the tilt axis turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilting {
    /// Where it begins, degrees; where it stands, if it does.
    pub from_deg: f64,
    /// Where it ends.
    pub to_deg: f64,
    /// How fast, degrees per second, above 0; 0 where it stands.
    pub speed_deg_s: f64,
    /// How it goes on.
    pub steps: Steps,
}

/// What a pattern is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The sensor.
    pub head: Head,
    /// Turns of the head a minute.
    pub rpm: f64,
    /// From one firing to the next, degrees of azimuth.
    pub step_deg: f64,
    /// Azimuth of the first firing of a frame, degrees.
    pub start_deg: f64,
    /// Whether the last firing of a frame repeats the first's azimuth.
    pub seam: Seam,
    /// How the tilt axis turns.
    pub tilting: Tilting,
    /// Whole frames whatever the tilt; `None`: as long as the tilt is on its way, the last frame cut off where that ends.
    pub frames: Option<u32>,
    /// Height of the sensor's origin above the tilt axis, metres (d of Eq. 4-6).
    pub d_m: f64,
}

/// A scan pattern.
#[derive(Clone, Debug)]
pub struct Pattern {
    name: String,
    settings: Settings,
    sensor: Sensor,
    frames: u32,
    firings: u32,
    /// Degrees from frame to frame, with the sign of the motion.
    step_deg: f64,
}

/// That each frame of a pattern is the one before, turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turns {
    /// About this, right-handed.
    pub axis: DVec3,
    /// By so much, radians.
    pub step_rad: f64,
    /// Frames there are.
    pub frames: u32,
}

/// What is no pattern.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PatternError {
    /// No pattern goes by this name.
    #[error("pattern: expected one of {}, got {got:?}", NAMES.join(", "))]
    Name {
        /// What was asked for.
        got: String,
    },
    /// An option that there is not, or not for this pattern.
    #[error("pattern {name}: expected {expected}, got {got:?}")]
    Option {
        /// The pattern.
        name: String,
        /// What could be there.
        expected: String,
        /// What is there.
        got: String,
    },
    /// A number that cannot be.
    #[error("pattern {name}: {key}: expected {expected}, got {got}")]
    Number {
        /// The pattern.
        name: String,
        /// Which.
        key: &'static str,
        /// What it may be.
        expected: &'static str,
        /// What it is.
        got: f64,
    },
    /// More points than anyone has memory for.
    #[error("pattern {name}: expected at most {MOST_POINTS} points, got {got:.0}")]
    TooMany {
        /// The pattern.
        name: String,
        /// How many it would be.
        got: f64,
    },
}

impl Head {
    fn sensor(self) -> Sensor {
        match self {
            Self::Vlp16 => Sensor::vlp16(),
            Self::Hdl32e => Sensor::hdl32e(),
            Self::Vlp32c => Sensor::vlp32c(),
            // Its laser 15 is the level one.
            Self::Single => Sensor::hdl32e().only(15),
        }
        .ideal()
    }
}

impl Pattern {
    /// A pattern by its settings.
    ///
    /// # Errors
    /// [`PatternError`] for numbers that cannot be, or too many points.
    pub fn new(name: &str, settings: Settings) -> Result<Self, PatternError> {
        check(name, &settings)?;
        let sensor = settings.head.sensor();
        let in_turn = 360.0 / settings.step_deg;
        let whole = (in_turn - in_turn.round()).abs() < WHOLE * in_turn;
        let firings = match (whole, settings.seam) {
            (true, Seam::Twice) => in_turn.round() + 1.0,
            (true, Seam::Once) => in_turn.round(),
            (false, _) => in_turn.ceil(),
        };
        let tilting = settings.tilting;
        let way_deg = tilting.to_deg - tilting.from_deg;
        let by_deg = tilting.speed_deg_s * 60.0 / settings.rpm;
        let frames = match settings.frames {
            Some(frames) => f64::from(frames),
            None if by_deg > 0.0 => (way_deg.abs() / by_deg * (1.0 - WHOLE)).ceil().max(1.0),
            None => 1.0,
        };
        let got = frames * firings * f64::from(sensor.used().count_ones());
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
        })
    }

    /// What it is called.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it is made of.
    #[must_use]
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Frames: turns of the head, the last perhaps not whole.
    #[must_use]
    pub const fn frames(&self) -> u32 {
        self.frames
    }

    /// How long the scan takes, seconds.
    #[must_use]
    pub fn scan_s(&self) -> f64 {
        let tilting = self.settings.tilting;
        let all = f64::from(self.frames) * 60.0 / self.settings.rpm;
        let way = (tilting.to_deg - tilting.from_deg).abs() / tilting.speed_deg_s;
        if self.cut() { way.min(all) } else { all }
    }

    /// Whether it ends where its tilt does.
    fn cut(&self) -> bool {
        self.settings.frames.is_none() && self.step_deg != 0.0
    }

    /// How each frame is the one before, turned; `None` where the last is cut off.
    #[must_use]
    pub fn turns(&self) -> Option<Turns> {
        let last = f64::from(self.frames.saturating_sub(1));
        let all = self.firings.saturating_sub(1);
        let whole = !self.cut() || self.tilt_deg(last, all).is_some();
        whole.then(|| Turns {
            axis: AXIS,
            step_rad: self.step_deg.to_radians(),
            frames: self.frames,
        })
    }

    /// Lasers that fire.
    #[must_use]
    pub fn lasers(&self) -> u32 {
        self.sensor.used().count_ones()
    }

    /// The lowest and the highest elevation of its lasers in the sensor's own frame, degrees.
    #[must_use]
    pub fn elevations_deg(&self) -> [f64; 2] {
        let used = self.sensor.beams().iter().enumerate();
        let used = used.filter(|(laser, _)| self.sensor.used() >> laser & 1 == 1);
        used.fold(
            [f64::INFINITY, f64::NEG_INFINITY],
            |[low, high], (_, beam)| [low.min(beam.elevation_deg), high.max(beam.elevation_deg)],
        )
    }

    /// The tilts at which the scan begins and ends, degrees, the least first.
    #[must_use]
    pub fn tilts_deg(&self) -> [f64; 2] {
        let from_deg = self.settings.tilting.from_deg;
        let last_deg = from_deg + self.cut_deg(f64::from(self.frames) * self.step_deg);
        [from_deg.min(last_deg), from_deg.max(last_deg)]
    }

    /// What the scan can see, as directions from the origin of the base to the hollow sphere: where its points are.
    #[must_use]
    pub fn view(&self) -> View {
        View::new(
            self.elevations_deg(),
            self.tilts_deg(),
            [self.settings.d_m; 2],
            [SPHERE_M; 2],
        )
    }

    /// As far as the way goes, where it ends the scan.
    fn cut_deg(&self, turned_deg: f64) -> f64 {
        let tilting = self.settings.tilting;
        let way_deg = tilting.to_deg - tilting.from_deg;
        if self.cut() && turned_deg.abs() > way_deg.abs() {
            way_deg
        } else {
            turned_deg
        }
    }

    /// How far the sensor itself sees, metres.
    #[must_use]
    pub fn reach(&self) -> Reach {
        self.sensor.reach()
    }

    /// How the platform stands at a firing of a frame, degrees; `None` where the way is over by then.
    fn tilt_deg(&self, frame: f64, firing: u32) -> Option<f64> {
        let tilting = self.settings.tilting;
        let within = match tilting.steps {
            Steps::Continuous => f64::from(firing) * self.settings.step_deg / 360.0,
            Steps::Stepped => 0.0,
        };
        let turned_deg = self.step_deg * (frame + within);
        let way_deg = (tilting.to_deg - tilting.from_deg).abs();
        let over = self.cut() && turned_deg.abs() > way_deg * (1.0 + WHOLE);
        (!over).then_some(tilting.from_deg + turned_deg)
    }

    /// The directions of a frame in the order of firing, length 1, in the frame of the base: x right, y along the tilt axis, z up. Empty beyond the last.
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
            * u64::from(self.sensor.used().count_ones());
        let mut directions = Vec::with_capacity(shots.min(MOST_POINTS) as usize);
        for frame in 0..self.frames {
            self.append(frame, &mut directions);
        }
        directions
    }

    fn append(&self, frame: u32, directions: &mut Vec<DVec3>) {
        let Settings {
            start_deg,
            step_deg,
            d_m,
            ..
        } = self.settings;
        // Lasers fire together: how fast the head turns does not matter to a firing.
        let rays = Rays::new(&self.sensor, 0.0);
        let mount = Mount::above(d_m);
        let mut firing = Firing::new(rays.count);
        firing.alive = self.sensor.used();
        for number in 0..self.firings {
            let Some(angle_deg) = self.tilt_deg(f64::from(frame), number) else {
                break;
            };
            firing.azimuth_deg = start_deg + f64::from(number) * step_deg;
            firing.tilt = Stand {
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

/// The direction, from the middle of the hollow sphere, in which a ray from within meets it.
fn on_sphere(origin_m: DVec3, direction: DVec3) -> DVec3 {
    let along = origin_m.dot(direction);
    let beside = origin_m.length_squared() - along * along;
    let range_m = (SPHERE_M * SPHERE_M - beside).max(0.0).sqrt() - along;
    (origin_m + range_m * direction).normalize()
}

/// Below this share two numbers are one that was rounded.
const WHOLE: f64 = 1e-9;

fn check(name: &str, settings: &Settings) -> Result<(), PatternError> {
    let tilting = settings.tilting;
    let rules = [
        (
            "rpm",
            settings.rpm,
            1.0,
            100_000.0,
            "1 to 100000 turns a minute",
        ),
        ("step", settings.step_deg, 1e-3, 90.0, "0.001 to 90 deg"),
        (
            "start",
            settings.start_deg,
            -360.0,
            360.0,
            "-360 to 360 deg",
        ),
        ("from", tilting.from_deg, -360.0, 360.0, "-360 to 360 deg"),
        ("to", tilting.to_deg, -360.0, 360.0, "-360 to 360 deg"),
        ("speed", tilting.speed_deg_s, 0.0, 1e6, "0 to 1000000 deg/s"),
        ("d", settings.d_m, -5.0, 5.0, "-5 to 5 m"),
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
