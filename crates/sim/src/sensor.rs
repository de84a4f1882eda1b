//! Lidar models: direction, origin and time of each laser, and the range of detection.
//!
//! The tables are the simulator's own, laser by laser, so that a receiver's tables that agree are
//! evidence. A single-beam 2D scanner is a sensor with one active laser ([`LidarSensor::only`]).
//! Lidars whose packets are not those of Velodyne's 16 and 32 lasers send none: only their points
//! are simulated.

mod tables;

pub use firmware_sim::vlp16::{PacketModel, ReturnMode};
use glam::{DMat3, DVec3, EulerRot};

use crate::scenery::rotation;

/// The most lasers of a firing. Those of a lidar with more are simulated as several firings at one
/// instant: wider firings made all lidars 6 % slower.
pub const MAX_LASERS: usize = 32;
/// The most lasers of any sensor.
pub const MAX_SENSOR_LASERS: usize = 64;

/// One laser, in firing order.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LaserBeam {
    /// Angle above the sensor's horizontal, degrees.
    pub elevation_deg: f64,
    /// Height of the rays' origin above the sensor's origin, metres.
    pub origin_m: f64,
    /// Offset from the azimuth of the firing, degrees.
    pub azimuth_deg: f64,
    /// Delay after the beginning of the firing, nanoseconds.
    pub delay_ns: i64,
}

/// Distances at which a sensor detects surfaces, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DetectionRange {
    /// A nearer surface blocks the beam without a return.
    pub min_m: f64,
    /// A farther surface does not return.
    pub max_m: f64,
}

/// A lidar model.
#[derive(Clone, Debug, PartialEq)]
pub struct LidarSensor {
    /// The packet format; `None` for a lidar whose packets are not simulated.
    pub packets: Option<PacketModel>,
    /// The lasers in firing order.
    pub beams: Vec<LaserBeam>,
    /// The active lasers, one bit each, bit 0 for the first.
    pub used: u64,
    /// Nanoseconds from the firing of a laser to its next.
    pub firing_period_ns: i64,
    /// Step of its distances, millimetres.
    pub distance_unit_mm: u32,
    /// Angle that a planar scanner sees, degrees, half of it to either side of azimuth 0; `None`
    /// for a head that rotates.
    pub aperture_deg: Option<f64>,
    range: DetectionRange,
}

/// Mounting of the lidar on the tilt axis: from its own frame (x right, y forward, z up) to the
/// platform's, whose y is the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LidarMount {
    /// Rotation.
    pub rotation: DMat3,
    /// Position of the lidar's origin, metres.
    pub position_m: DVec3,
}

impl LidarMount {
    /// Upright, its origin `d_m` metres above the axis (d of Eq. 4-6).
    #[must_use]
    pub const fn above(d_m: f64) -> Self {
        Self {
            rotation: DMat3::IDENTITY,
            position_m: DVec3::new(0.0, 0.0, d_m),
        }
    }

    /// Its origin at `position_m` metres, rotated about the platform's x, then y, then z.
    #[must_use]
    pub fn at(position_m: [f64; 3], rotation_deg: [f64; 3]) -> Self {
        Self {
            rotation: rotation(rotation_deg),
            position_m: DVec3::from_array(position_m),
        }
    }

    /// The rotation about the platform's x, then y, then z, degrees.
    #[must_use]
    pub fn rotation_deg(&self) -> [f64; 3] {
        let (z, y, x) = self.rotation.to_euler(EulerRot::ZYX);
        // No negative zeros of an upright mount.
        [x, y, z].map(|angle| angle.to_degrees() + 0.0)
    }
}

impl LidarSensor {
    /// VLP-16 and Puck LITE (manual 63-9243): 16 lasers from -15 to 15 degrees, 1 to 100 m.
    #[must_use]
    pub fn vlp16() -> Self {
        Self::new(PacketModel::Vlp16, tables::vlp16(), 100.0)
    }

    /// Puck Hi-Res (manual 63-9243): 16 lasers from -10 to 10 degrees, 1 to 100 m.
    #[must_use]
    pub fn hi_res() -> Self {
        Self::new(PacketModel::PuckHiRes, tables::hi_res(), 100.0)
    }

    /// HDL-32E (its manual; drawing 86-0106 revision B): 32 lasers from -30.67 to 10.67 degrees, 1
    /// to 70 m as in the paper's Table 3.
    #[must_use]
    pub fn hdl32e() -> Self {
        Self::new(PacketModel::Hdl32e, tables::hdl32e(), 70.0)
    }

    /// VLP-32C (manual 63-9325): 32 lasers from -25 to 15 degrees, 1 to 200 m.
    #[must_use]
    pub fn vlp32c() -> Self {
        Self::new(PacketModel::Vlp32c, tables::vlp32c(), 200.0)
    }

    /// HDL-64E S2 (its manual, specifications): an upper block of 32 lasers from 2 degrees down in
    /// steps of 1/3, a lower one from -8.83 in steps of 1/2; 1.333 million points per second, 0.9
    /// to 120 m in steps of 2 mm. All lasers start from one point at one instant: where they are
    /// differs from head to head, and a file of each head says it.
    #[must_use]
    pub fn hdl64e() -> Self {
        let upper = (0..32).map(|laser| 2.0 - f64::from(laser) / 3.0);
        let lower = (0..32).map(|laser| -8.83 - f64::from(laser) / 2.0);
        Self {
            distance_unit_mm: 2,
            ..Self::without_packets(upper.chain(lower), 48_012, [0.9, 120.0])
        }
    }

    /// Hokuyo UTM-30LX (its data sheet): one level laser, 270 degrees, 1440 steps of a revolution
    /// at 40 Hz, 0.1 to 30 m in steps of 1 mm.
    #[must_use]
    pub fn utm30lx() -> Self {
        Self {
            aperture_deg: Some(270.0),
            ..Self::without_packets([0.0], 17_361, [0.1, 30.0])
        }
    }

    /// SICK LMS151 (its data sheet): one level laser, 270 degrees, 1440 steps of a revolution at 25
    /// Hz, 720 at 50 Hz, 0.5 to 50 m in steps of 1 mm.
    #[must_use]
    pub fn lms151() -> Self {
        Self {
            aperture_deg: Some(270.0),
            ..Self::without_packets([0.0], 27_778, [0.5, 50.0])
        }
    }

    /// A 2D scanner: a VLP-16 of which only laser 14 is active, 1 degree below level. Its packets
    /// are those of a VLP-16 whose other lasers never return, so any reader places its points
    /// correctly.
    #[must_use]
    pub fn single_beam() -> Self {
        Self::vlp16().only(14)
    }

    /// The same sensor with one active laser, by its number in firing order. Laser 15 of the
    /// HDL-32E is exactly level.
    #[must_use]
    pub fn only(mut self, laser: usize) -> Self {
        let bit = u32::try_from(laser)
            .ok()
            .and_then(|laser| 1_u64.checked_shl(laser));
        self.used &= bit.unwrap_or(0);
        self
    }

    /// The same sensor as theoretical scan patterns have it: all lasers of a firing start from one
    /// point at one instant. Those of a VLP-32C keep their azimuths, which every reader adds.
    #[must_use]
    pub fn ideal(mut self) -> Self {
        for beam in &mut self.beams {
            beam.origin_m = 0.0;
            beam.delay_ns = 0;
        }
        self
    }

    fn new(model: PacketModel, beams: Vec<LaserBeam>, max_m: f64) -> Self {
        Self {
            packets: Some(model),
            used: bits(beams.len()),
            beams,
            firing_period_ns: model.firing_period_ns(),
            distance_unit_mm: model.distance_unit_mm(),
            aperture_deg: None,
            range: DetectionRange { min_m: 1.0, max_m },
        }
    }

    /// A lidar all of whose lasers start from one point at one instant.
    fn without_packets(
        elevations_deg: impl IntoIterator<Item = f64>,
        firing_period_ns: i64,
        [min_m, max_m]: [f64; 2],
    ) -> Self {
        let beam = |elevation_deg| LaserBeam {
            elevation_deg,
            origin_m: 0.0,
            azimuth_deg: 0.0,
            delay_ns: 0,
        };
        let beams: Vec<LaserBeam> = elevations_deg.into_iter().map(beam).collect();
        Self {
            packets: None,
            used: bits(beams.len()),
            beams,
            firing_period_ns,
            distance_unit_mm: 1,
            aperture_deg: None,
            range: DetectionRange { min_m, max_m },
        }
    }

    /// Firings of all lasers in a block of a packet. Without packets two firings are computed
    /// together.
    #[must_use]
    pub fn firings_per_block(&self) -> usize {
        (self.packets).map_or(2, PacketModel::firings_per_block)
    }

    /// Firings at one instant that all lasers need.
    #[must_use]
    pub fn firings_at_once(&self) -> usize {
        self.beams.len().div_ceil(MAX_LASERS).max(1)
    }

    /// Beginning of a firing by its number from 0, nanoseconds.
    #[inline]
    #[must_use]
    pub fn firing_ns(&self, firing: u64) -> i64 {
        let instant = match self.firings_at_once() {
            1 => firing,
            several => firing / several as u64,
        };
        let instant = i64::try_from(instant).unwrap_or(i64::MAX);
        instant.saturating_mul(self.firing_period_ns)
    }

    /// Whether the sensor fires at an azimuth of its head, degrees.
    #[inline]
    #[must_use]
    pub fn sees(&self, azimuth_deg: f64) -> bool {
        self.aperture_deg.is_none_or(|aperture_deg| {
            let from_front_deg = (azimuth_deg + 180.0).rem_euclid(360.0) - 180.0;
            from_front_deg.abs() <= 0.5 * aperture_deg
        })
    }

    /// The same sensor with another range of detection, limited by the 16 bits of its distances.
    #[must_use]
    pub fn with_range(self, range: DetectionRange) -> Self {
        Self { range, ..self }
    }

    /// The range of detection, at most the largest distance of 16 bits.
    #[must_use]
    pub fn range(&self) -> DetectionRange {
        let wire_m = f64::from(u16::MAX) * f64::from(self.distance_unit_mm) * 1e-3;
        DetectionRange {
            min_m: self.range.min_m,
            max_m: self.range.max_m.min(wire_m),
        }
    }

    /// Origin (metres) and direction (length 1) of a laser's ray in the frame of the platform's
    /// base: origin on the tilt axis, x right, y forward, z up. `azimuth_deg` is the head's azimuth
    /// when the laser fires; `None` where there is no such laser.
    ///
    /// The plain definition of a ray, a composition of rigid motions: the direction is raised about
    /// x by the elevation and rotated about the vertical by the azimuth (clockwise seen from above,
    /// y to x), the head is moved onto its mount, and the platform tilts about y (z to x).
    #[must_use]
    pub fn ray(
        &self,
        laser: usize,
        azimuth_deg: f64,
        tilt_deg: f64,
        mount: &LidarMount,
    ) -> Option<(DVec3, DVec3)> {
        let beam = self.beams.get(laser)?;
        let head = DMat3::from_rotation_z(-(azimuth_deg + beam.azimuth_deg).to_radians());
        let platform = DMat3::from_rotation_y(tilt_deg.to_radians());
        let raised = DMat3::from_rotation_x(beam.elevation_deg.to_radians()) * DVec3::Y;
        let origin_m = mount.rotation * (beam.origin_m * DVec3::Z) + mount.position_m;
        Some((
            platform * origin_m,
            platform * (mount.rotation * (head * raised)),
        ))
    }
}

/// One bit for each laser.
fn bits(lasers: usize) -> u64 {
    u64::MAX >> (MAX_SENSOR_LASERS - lasers.clamp(1, MAX_SENSOR_LASERS))
}

/// The lasers of a firing of a rotating head relative to the azimuth of the first, constant over
/// all firings.
#[derive(Clone, Debug)]
pub(crate) struct RayTable {
    /// Directions when the first laser fires at azimuth 0, the rotation during the delay included.
    pub directions: [DVec3; MAX_LASERS],
    /// Heights of the origins, metres.
    pub heights_m: [f64; MAX_LASERS],
    /// Delays after the first laser, seconds.
    pub delays_s: [f64; MAX_LASERS],
    pub count: usize,
    /// Number of the first in the sensor.
    pub first: usize,
}

impl RayTable {
    /// The rays of a head that rotates at `deg_per_s`, of the first firing at an instant.
    pub fn new(sensor: &LidarSensor, deg_per_s: f64) -> Self {
        Self::of(sensor, 0, deg_per_s)
    }

    /// The rays of the other firings at an instant.
    pub fn others(sensor: &LidarSensor, deg_per_s: f64) -> Vec<Self> {
        let others = 1..sensor.firings_at_once();
        others
            .map(|number| Self::of(sensor, number, deg_per_s))
            .collect()
    }

    fn of(sensor: &LidarSensor, number: usize, deg_per_s: f64) -> Self {
        let beams = sensor.beams.chunks(MAX_LASERS).nth(number);
        let beams = beams.unwrap_or_default();
        let mut rays = Self {
            first: MAX_LASERS * number,
            directions: [DVec3::Y; MAX_LASERS],
            heights_m: [0.0; MAX_LASERS],
            delays_s: [0.0; MAX_LASERS],
            count: beams.len(),
        };
        let directions = rays.directions.iter_mut();
        let places = directions.zip(&mut rays.heights_m).zip(&mut rays.delays_s);
        for (((direction, height_m), delay_s), beam) in places.zip(beams) {
            *delay_s = beam.delay_ns as f64 * 1e-9;
            *height_m = beam.origin_m;
            let ahead_deg = beam.azimuth_deg + deg_per_s * *delay_s;
            // Raised about x, rotated clockwise about the vertical.
            *direction = DMat3::from_rotation_z(-ahead_deg.to_radians())
                * DMat3::from_rotation_x(beam.elevation_deg.to_radians())
                * DVec3::Y;
        }
        rays
    }
}

#[cfg(test)]
mod tests;
