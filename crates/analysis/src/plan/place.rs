//! A direction in the tilted frame of the lidar: when lasers pass it, and where.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// A laser seen from the tilt axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisRay {
    /// Elevation of its points at the given distance, seen from the origin of the base, with sine
    /// and cosine.
    pub elevation_rad: f64,
    pub sin: f64,
    pub cos: f64,
    /// Revolutions added to the azimuth.
    pub offset: f64,
    pub delay_s: f64,
}

/// A direction and the tilts at which the lasers pass it. They depend on no speed, so that one
/// place serves many scans.
#[derive(Clone, Debug)]
pub struct PlannedPlace {
    direction: DVec3,
    across: f64,
    passes: Vec<LaserPass>,
    ends: Vec<SweepEnd>,
}

/// The tilt at which a laser has the elevation of a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct LaserPass {
    /// Number of the laser by elevation.
    pub number: usize,
    pub tilt_deg: f64,
    /// Azimuth of the lidar when the laser points there, revolutions.
    pub azimuth: f64,
    /// Its change with the tilt.
    pub azimuth_per_deg: f64,
    /// Change of the direction's height above the tilted plane with the tilt.
    pub up_per_rad: f64,
}

/// A tilt between which and the next one the elevation of a direction is monotonic.
#[derive(Clone, Copy, Debug)]
pub(super) struct SweepEnd {
    pub tilt_deg: f64,
    /// Azimuth of the direction, revolutions.
    pub azimuth: f64,
    /// Height of the direction above that of the nearest laser, or below.
    pub apart: f64,
}

impl PlannedPlace {
    /// A direction for sweeps between two tilts, with the lasers by elevation.
    pub(super) fn new(lasers: &[AxisRay], direction: DVec3, [a_deg, b_deg]: [f64; 2]) -> Self {
        let path = ElevationPath::new(direction, [a_deg.min(b_deg), a_deg.max(b_deg)]);
        let passes = lasers.iter().enumerate().flat_map(|(number, laser)| {
            path.at_deg(laser.sin).map(move |tilt_deg| {
                let seen = local(direction, tilt_deg);
                let level2 = seen.x * seen.x + seen.y * seen.y;
                LaserPass {
                    number,
                    tilt_deg,
                    azimuth: azimuth(seen, 0.0) - laser.offset,
                    azimuth_per_deg: -seen.y * seen.z / level2 / 360.0,
                    up_per_rad: seen.x,
                }
            })
        });
        let ends = path.turning_deg().chain([a_deg, b_deg]).map(|tilt_deg| {
            let seen = local(direction, tilt_deg);
            let apart = lasers.iter().map(|laser| (laser.sin - seen.z).abs());
            SweepEnd {
                tilt_deg,
                azimuth: azimuth(seen, 0.0),
                apart: apart.fold(f64::INFINITY, f64::min),
            }
        });
        Self {
            passes: passes.collect(),
            ends: ends.collect(),
            direction,
            across: path.across,
        }
    }

    /// The direction.
    #[must_use]
    pub const fn direction(&self) -> DVec3 {
        self.direction
    }

    /// Its distance from the tilt axis.
    pub(super) const fn across(&self) -> f64 {
        self.across
    }

    /// Chord to which no ray comes nearer, however slow the scan between exactly these tilts: 0
    /// where a laser passes.
    pub(super) fn least_chord(&self) -> f64 {
        let apart = self.ends.iter().map(|end| end.apart);
        match self.passes.is_empty() {
            true => apart.fold(f64::INFINITY, f64::min),
            false => 0.0,
        }
    }

    pub(super) fn passes(&self) -> &[LaserPass] {
        &self.passes
    }

    pub(super) fn ends(&self) -> &[SweepEnd] {
        &self.ends
    }
}

/// A direction of the base in the tilted frame of the lidar (Eq. 4-6 backwards).
pub(super) fn local(place: DVec3, tilt_deg: f64) -> DVec3 {
    let (sin, cos) = tilt_deg.to_radians().sin_cos();
    DVec3::new(
        place.x * cos - place.z * sin,
        place.y,
        place.x * sin + place.z * cos,
    )
}

/// Azimuth of a direction in the lidar's frame, revolutions within half a one of another azimuth,
/// so that it does not jump where it changes with the tilt.
pub(super) fn azimuth(seen: DVec3, near: f64) -> f64 {
    let turned = seen.x.atan2(seen.y) / TAU;
    turned - (turned - near).round()
}

/// The height of a direction above the tilted plane, against the tilt: across x cos(tilt - ahead).
pub(super) struct ElevationPath {
    across: f64,
    ahead_rad: f64,
    /// Least and greatest tilt.
    tilts_deg: [f64; 2],
}

impl ElevationPath {
    pub(super) fn new(place: DVec3, tilts_deg: [f64; 2]) -> Self {
        Self {
            across: place.x.hypot(place.z),
            ahead_rad: place.x.atan2(place.z),
            tilts_deg,
        }
    }

    /// Tilts at which the height is `up`.
    pub(super) fn at_deg(&self, up: f64) -> impl Iterator<Item = f64> {
        let cos = up / self.across;
        let off = (cos.abs() <= 1.0).then(|| cos.acos());
        let tilts = off.map(|off| [self.ahead_rad - off, self.ahead_rad + off]);
        self.inside(tilts.into_iter().flatten())
    }

    /// Tilts at which the height is least or greatest.
    pub(super) fn turning_deg(&self) -> impl Iterator<Item = f64> {
        self.inside([self.ahead_rad, self.ahead_rad + PI].into_iter())
    }

    /// Angles modulo 360 degrees within the tilts.
    fn inside(&self, angles_rad: impl Iterator<Item = f64>) -> impl Iterator<Item = f64> {
        let [low, high] = self.tilts_deg;
        angles_rad
            .map(move |angle| low + (angle.to_degrees() - low).rem_euclid(360.0))
            .filter(move |tilt| *tilt <= high)
    }
}
