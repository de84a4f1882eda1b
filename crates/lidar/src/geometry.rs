//! A model's angles as the sines and cosines that its points need, computed once.
//!
//! Left out: calibration of a single sensor, which would replace the table here and nothing else.

use protocol::vlp16::Model;

/// One laser, ready for use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub sin_elevation: f64,
    pub cos_elevation: f64,
    pub vertical_offset_m: f64,
    pub azimuth_offset_deg: f64,
    pub delay_s: f64,
    pub delay_ns: i64,
    pub ring: u8,
}

/// A model's lasers in firing order.
#[derive(Clone, Debug)]
pub(crate) struct Geometry {
    pub model: &'static Model,
    pub rays: Vec<Ray>,
}

impl Geometry {
    pub(crate) fn new(model: &'static Model, vertical_offsets: bool) -> Self {
        let rays = model.lasers.iter().map(|laser| {
            let (sin_elevation, cos_elevation) = laser.elevation_deg.to_radians().sin_cos();
            Ray {
                sin_elevation,
                cos_elevation,
                vertical_offset_m: if vertical_offsets {
                    laser.vertical_offset_m
                } else {
                    0.0
                },
                azimuth_offset_deg: laser.azimuth_offset_deg,
                delay_s: f64::from(laser.delay_ns) * 1e-9,
                delay_ns: i64::from(laser.delay_ns),
                ring: laser.ring,
            }
        });
        Self {
            model,
            rays: rays.collect(),
        }
    }
}
