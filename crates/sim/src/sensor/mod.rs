//! The sensors: where each laser looks and from where, when it fires, and how far it sees.
//!
//! Stated in the simulator's own way, laser by laser, so that a receiver's tables agreeing with these says something. A single-beam 2D
//! scanner is a sensor of which one laser is used ([`Sensor::only`]). Left out: what is in a packet (`firmware_sim::vlp16`), calibration of a single unit.

mod tables;

use glam::{DMat3, DVec3};

pub use firmware_sim::vlp16::{PacketModel, ReturnMode};

/// The most lasers that a sensor has.
pub const MOST_LASERS: usize = 32;

/// One laser, in the order of firing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Above the sensor's own horizontal, degrees.
    pub elevation_deg: f64,
    /// Height at which its rays start above the sensor's origin, metres.
    pub origin_m: f64,
    /// Ahead of the azimuth of its firing, degrees.
    pub azimuth_deg: f64,
    /// After the firing's beginning, nanoseconds.
    pub delay_ns: i64,
}

/// From where to where a sensor sees, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// A nearer surface blocks the beam and does not return.
    pub min_m: f64,
    /// A farther one does not return.
    pub max_m: f64,
}

/// A sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    model: PacketModel,
    beams: Vec<Beam>,
    /// Lasers that are there, a bit each.
    used: u32,
    reach: Reach,
}

impl Sensor {
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

    /// HDL-32E (its manual; drawing 86-0106 revision B): 32 lasers from -30.67 to 10.67 degrees, 1 to 70 m as in the paper's Table 3.
    #[must_use]
    pub fn hdl32e() -> Self {
        Self::new(PacketModel::Hdl32e, tables::hdl32e(), 70.0)
    }

    /// VLP-32C (manual 63-9325): 32 lasers from -25 to 15 degrees, 1 to 200 m.
    #[must_use]
    pub fn vlp32c() -> Self {
        Self::new(PacketModel::Vlp32c, tables::vlp32c(), 200.0)
    }

    /// A 2D scanner: a VLP-16 with its laser 14 alone, the one next to level (1 degree below). Its packets are a VLP-16's in which the other lasers
    /// never return, so every reader of those places its points rightly.
    #[must_use]
    pub fn single_beam() -> Self {
        Self::vlp16().only(14)
    }

    /// The same sensor with one laser, by its number in the order of firing, and the others covered up. Laser 15 of the HDL-32E is exactly level.
    #[must_use]
    pub fn only(mut self, laser: usize) -> Self {
        let bit = u32::try_from(laser)
            .ok()
            .and_then(|laser| 1_u32.checked_shl(laser));
        self.used &= bit.unwrap_or(0);
        self
    }

    /// The same sensor as scan patterns on paper have it: all lasers of a firing start from one point, in one direction of the head, at one instant.
    #[must_use]
    pub fn ideal(mut self) -> Self {
        for beam in &mut self.beams {
            beam.origin_m = 0.0;
            beam.azimuth_deg = 0.0;
            beam.delay_ns = 0;
        }
        self
    }

    fn new(model: PacketModel, beams: Vec<Beam>, max_m: f64) -> Self {
        let used = u32::MAX >> (MOST_LASERS - beams.len().clamp(1, MOST_LASERS));
        let reach = Reach { min_m: 1.0, max_m };
        Self {
            model,
            beams,
            used,
            reach,
        }
    }

    /// The same sensor seeing from `reach.min_m` to `reach.max_m`, as far as its packets can tell.
    #[must_use]
    pub fn seeing(self, reach: Reach) -> Self {
        Self { reach, ..self }
    }

    /// What its packets look like.
    #[must_use]
    pub const fn model(&self) -> PacketModel {
        self.model
    }

    /// Its lasers in the order of firing.
    #[must_use]
    pub fn beams(&self) -> &[Beam] {
        &self.beams
    }

    /// The lasers that are there, a bit each, bit 0 for the first.
    #[must_use]
    pub const fn used(&self) -> u32 {
        self.used
    }

    /// How far it sees; no farther than the largest distance of its packets.
    #[must_use]
    pub fn reach(&self) -> Reach {
        let wire_m = f64::from(u16::MAX) * f64::from(self.model.distance_unit_mm()) * 1e-3;
        Reach {
            min_m: self.reach.min_m,
            max_m: self.reach.max_m.min(wire_m),
        }
    }
}

/// The lasers of a turning head relative to the first laser's azimuth: what does not change from firing to firing.
#[derive(Clone, Debug)]
pub(crate) struct Rays {
    /// Which way each looks when the first fires at azimuth 0, the turning of the head until its own turn included.
    pub aims: [DVec3; MOST_LASERS],
    /// How high each starts, metres.
    pub heights_m: [f64; MOST_LASERS],
    /// When each fires after the first, seconds.
    pub delays_s: [f64; MOST_LASERS],
    pub count: usize,
}

impl Rays {
    /// The rays of a head that turns at `deg_per_s`.
    pub fn new(sensor: &Sensor, deg_per_s: f64) -> Self {
        let mut rays = Self {
            aims: [DVec3::Y; MOST_LASERS],
            heights_m: [0.0; MOST_LASERS],
            delays_s: [0.0; MOST_LASERS],
            count: sensor.beams.len().min(MOST_LASERS),
        };
        let places = rays
            .aims
            .iter_mut()
            .zip(&mut rays.heights_m)
            .zip(&mut rays.delays_s);
        for (((aim, height_m), delay_s), beam) in places.zip(&sensor.beams) {
            *delay_s = beam.delay_ns as f64 * 1e-9;
            *height_m = beam.origin_m;
            let ahead_deg = beam.azimuth_deg + deg_per_s * *delay_s;
            // Raised about x, turned clockwise about the vertical.
            *aim = DMat3::from_rotation_z(-ahead_deg.to_radians())
                * DMat3::from_rotation_x(beam.elevation_deg.to_radians())
                * DVec3::Y;
        }
        rays
    }
}

#[cfg(test)]
mod tests;
