//! One firing of all lasers: where each ray starts and goes, and what comes back.
//!
//! [`LidarSensor::ray`](crate::sensor::LidarSensor::ray) is the plain definition of a ray.
//! `SimulatedFiring::aim` computes all rays of a firing from one head rotation, one tilt and, per
//! laser, the small tilt since the first laser. A test holds the two against each other.
//! [`Surroundings`] casts the rays.

mod batch;
mod body;
mod echo;
mod surroundings;

use glam::{DMat3, DVec3};

use crate::motion::AxisState;
use crate::sensor::{LidarMount, MAX_LASERS, RayTable};

pub use body::Body;
pub use echo::{Echo, Echoes};
pub use surroundings::{SurfaceHit, Surroundings};

/// A firing.
#[derive(Clone, Debug)]
pub struct SimulatedFiring {
    /// Its number, from 0: the key of its random draws.
    pub number: u64,
    /// Host time of its first laser, seconds since the start.
    pub time_s: f64,
    /// Azimuth of its first laser, degrees, 0..360.
    pub azimuth_deg: f64,
    /// Tilt at that time.
    pub tilt: AxisState,
    /// Number of lasers; further columns are unused.
    pub lasers: usize,
    /// Number of the first laser in the sensor: 0 unless the sensor has more lasers than a firing.
    pub first_laser: usize,
    /// The head's axis of rotation in the frame of the base, length 1.
    pub head_axis: DVec3,
    /// Lasers that fire, one bit each, bit 0 for the first.
    pub alive: u32,
    /// Origin of each ray, metres in the frame of the base.
    pub origins_m: [DVec3; MAX_LASERS],
    /// Direction of each ray there, length 1.
    pub directions: [DVec3; MAX_LASERS],
}

/// Below this many radians the series of sine and cosine are exact to the last bit.
const SMALL: f64 = 1e-3;

impl SimulatedFiring {
    pub(crate) const fn new(lasers: usize) -> Self {
        Self {
            number: 0,
            time_s: 0.0,
            azimuth_deg: 0.0,
            tilt: AxisState {
                angle_deg: 0.0,
                rate_deg_s: 0.0,
            },
            lasers,
            first_laser: 0,
            head_axis: DVec3::Z,
            alive: 0,
            origins_m: [DVec3::ZERO; MAX_LASERS],
            directions: [DVec3::Y; MAX_LASERS],
        }
    }

    /// Whether a laser fires.
    #[inline]
    #[must_use]
    pub const fn is_alive(&self, laser: usize) -> bool {
        laser < self.lasers && self.alive >> laser & 1 == 1
    }

    /// Origin (metres in the frame of the base) and direction (length 1) of a laser's ray.
    #[inline]
    #[must_use]
    pub fn ray(&self, laser: usize) -> Option<(DVec3, DVec3)> {
        Some((*self.origins_m.get(laser)?, *self.directions.get(laser)?))
    }

    /// Numbers of the lasers that fire.
    pub fn alive(&self) -> impl Iterator<Item = usize> + use<> {
        let (lasers, alive) = (self.lasers, self.alive);
        (0..lasers).filter(move |laser| alive >> laser & 1 == 1)
    }

    /// Computes all rays: the head at its azimuth on the mount, the platform tilted about y,
    /// positive from z to x. During the firing the platform moves at its initial rate.
    #[inline]
    pub(crate) fn aim(&mut self, rays: &RayTable, mount: &LidarMount) {
        let head = DMat3::from_rotation_z(-self.azimuth_deg.to_radians());
        let platform = DMat3::from_rotation_y(self.tilt.angle_deg.to_radians());
        let sensor = platform * mount.rotation;
        let turned = sensor * head;
        self.head_axis = sensor.z_axis;
        let origin = platform * mount.position_m;
        let rate = self.tilt.rate_deg_s.to_radians();
        let places = self.origins_m.iter_mut().zip(&mut self.directions);
        let lasers = rays
            .directions
            .iter()
            .zip(&rays.heights_m)
            .zip(&rays.delays_s);
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

/// Rotated about y, z towards x.
#[inline(always)]
fn about_y(v: DVec3, sin: f64, cos: f64) -> DVec3 {
    DVec3::new(cos * v.x + sin * v.z, v.y, cos * v.z - sin * v.x)
}

/// Sine and cosine, by their series where it is exact.
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

#[cfg(test)]
mod tests;
