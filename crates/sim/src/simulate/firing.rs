//! One firing of all lasers, in columns: where each ray starts and goes, and what comes back.
//!
//! Rays of a firing are made together: one turn of the head and one tilt, and for each laser what little the platform has turned since the
//! first. Left out: what the rays meet.

use glam::{DMat3, DVec3};

use crate::motion::Stand;
use crate::sensor::{MOST_LASERS, Rays};

use super::Mount;
use super::surroundings::Met;

/// A firing.
#[derive(Clone, Debug)]
pub struct Firing {
    /// Which, from 0: the key of its random draws.
    pub number: u64,
    /// When its first laser fires: host's seconds since the start.
    pub at_s: f64,
    /// Azimuth of its first laser, degrees, 0..360.
    pub azimuth_deg: f64,
    /// How the platform stands then.
    pub tilt: Stand,
    /// How many lasers there are: columns beyond are not used.
    pub lasers: usize,
    /// Which fire, a bit each, bit 0 for the first.
    pub alive: u32,
    /// Where each ray starts, metres in the frame of the base.
    pub origins_m: [DVec3; MOST_LASERS],
    /// Which way each goes there, length 1.
    pub directions: [DVec3; MOST_LASERS],
}

/// What comes back to one laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Echo {
    /// Distance that the sensor measures, metres; infinite where nothing comes back.
    pub range_m: f64,
    /// Distance of the surface along the middle of the beam, metres: for the truth alone, not changed by effects that disturb the measurement.
    pub true_range_m: f64,
    /// Calibrated reflectivity that it reports: 0..=100 diffuse, above that retroreflecting, 255 at most.
    pub reflectivity: f64,
    /// Share of the pulse's light that the surface got, 0..=1: less for one of several returns.
    pub share: f64,
    /// The surface's normal, length 1, whichever way it points; 0 where no effect needs it.
    pub normal: DVec3,
    /// Share of its light that goes off as from a mirror, 0..=1; 0 where no effect needs the normal.
    pub specular: f64,
}

/// What comes back to all lasers: the strongest return of each, and another.
#[derive(Clone, Debug)]
pub struct Echoes {
    /// The strongest.
    pub strongest: [Echo; MOST_LASERS],
    /// The last where that is not the strongest, else the second strongest; none where only one comes back.
    pub other: [Echo; MOST_LASERS],
    /// Whether anybody looks at `other`.
    pub two: bool,
    /// How far away what stands is, metres, whether anything comes back of it or not; the sensor's reach where nothing is. Kept only where things move.
    pub(super) standing_m: [f64; MOST_LASERS],
    lasers: usize,
}

impl Echo {
    /// Nothing came back.
    pub const NONE: Self = Self {
        range_m: f64::INFINITY,
        true_range_m: f64::INFINITY,
        reflectivity: 0.0,
        share: 0.0,
        normal: DVec3::ZERO,
        specular: 0.0,
    };

    /// All of a pulse from one surface.
    #[inline]
    #[must_use]
    pub const fn of(met: &Met) -> Self {
        Self {
            range_m: met.range_m,
            true_range_m: met.range_m,
            reflectivity: met.reflectivity,
            share: 1.0,
            normal: met.normal,
            specular: met.specular,
        }
    }

    /// The same, or nothing.
    #[inline]
    pub(super) fn of_any(met: Option<Met>) -> Self {
        met.map_or(Self::NONE, |met| Self::of(&met))
    }

    /// Whether anything came back.
    #[inline]
    #[must_use]
    pub const fn is_there(&self) -> bool {
        self.range_m < f64::INFINITY
    }
}

impl Echoes {
    pub(crate) const fn new(lasers: usize, two: bool) -> Self {
        Self {
            strongest: [Echo::NONE; MOST_LASERS],
            other: [Echo::NONE; MOST_LASERS],
            two,
            standing_m: [0.0; MOST_LASERS],
            lasers,
        }
    }

    /// The returns that somebody looks at, a slice of all lasers each: the strongest, and the others where there are two.
    #[inline]
    pub fn all_mut(&mut self) -> impl Iterator<Item = &mut [Echo]> {
        let lasers = self.lasers;
        let other = if self.two {
            &mut self.other[..]
        } else {
            &mut []
        };
        [&mut self.strongest[..], other]
            .into_iter()
            .filter(|echoes| !echoes.is_empty())
            .map(move |echoes| echoes.get_mut(..lasers).unwrap_or_default())
    }
}

/// Below this many radians the series of sine and cosine are good to the last bit.
const SMALL: f64 = 1e-3;

impl Firing {
    pub(crate) const fn new(lasers: usize) -> Self {
        Self {
            number: 0,
            at_s: 0.0,
            azimuth_deg: 0.0,
            tilt: Stand {
                angle_deg: 0.0,
                rate_deg_s: 0.0,
            },
            lasers,
            alive: 0,
            origins_m: [DVec3::ZERO; MOST_LASERS],
            directions: [DVec3::Y; MOST_LASERS],
        }
    }

    /// Whether a laser fires.
    #[inline]
    #[must_use]
    pub const fn is_alive(&self, laser: usize) -> bool {
        laser < self.lasers && self.alive >> laser & 1 == 1
    }

    /// A laser's ray: where from, metres in the frame of the base, and which way (length 1).
    #[inline]
    #[must_use]
    pub fn ray(&self, laser: usize) -> Option<(DVec3, DVec3)> {
        Some((*self.origins_m.get(laser)?, *self.directions.get(laser)?))
    }

    /// Lasers that fire, in order.
    pub fn alive(&self) -> impl Iterator<Item = usize> + use<> {
        let (lasers, alive) = (self.lasers, self.alive);
        (0..lasers).filter(move |laser| alive >> laser & 1 == 1)
    }

    /// Aims all rays: the head at its azimuth on the mount, the platform tilted about y, positive from z to x. While the firing lasts the
    /// platform turns at the rate it has at its beginning.
    #[inline]
    pub(crate) fn aim(&mut self, rays: &Rays, mount: &Mount) {
        let head = DMat3::from_rotation_z(-self.azimuth_deg.to_radians());
        let platform = DMat3::from_rotation_y(self.tilt.angle_deg.to_radians());
        let sensor = platform * mount.turn;
        let turned = sensor * head;
        let origin = platform * mount.at_m;
        let rate = self.tilt.rate_deg_s.to_radians();
        let places = self.origins_m.iter_mut().zip(&mut self.directions);
        let lasers = rays.aims.iter().zip(&rays.heights_m).zip(&rays.delays_s);
        for ((from, to), ((aim, height_m), delay_s)) in places.zip(lasers).take(rays.count) {
            let direction = turned * *aim;
            let start = origin + *height_m * sensor.z_axis;
            (*from, *to) = (start, direction);
            if rate != 0.0 {
                let (sin, cos) = small_sin_cos(rate * delay_s);
                *from = about_y(start, sin, cos);
                *to = about_y(direction, sin, cos);
            }
        }
    }
}

/// Turned about y, z towards x.
#[inline(always)]
fn about_y(v: DVec3, sin: f64, cos: f64) -> DVec3 {
    DVec3::new(cos * v.x + sin * v.z, v.y, cos * v.z - sin * v.x)
}

/// Sine and cosine, by their series where that is exact.
#[inline(always)]
fn small_sin_cos(angle: f64) -> (f64, f64) {
    if angle.abs() > SMALL {
        return angle.sin_cos();
    }
    let square = angle * angle;
    // The next terms are below 1e-3^4 / 120 and / 720 of these.
    let sin = angle - angle * square * (1.0 / 6.0);
    let cos = 1.0 - square * (0.5 - square * (1.0 / 24.0));
    (sin, cos)
}
