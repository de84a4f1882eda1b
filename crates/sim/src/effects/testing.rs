//! What tests of effects start from.

use std::sync::Arc;

use glam::DVec3;

use super::{Axis, Parcel, ParcelKind, Wire};
use crate::motion::Stand;
use crate::scene::Scene;
use crate::sensor::{Rays, Sensor};
use crate::simulate::{Echo, Echoes, Firing, Mount, Surroundings};

/// A firing of a VLP-16 that stands on the tilt axis, its rays aimed.
pub fn firing(azimuth_deg: f64, tilt_deg: f64) -> Firing {
    let sensor = Sensor::vlp16();
    let rays = Rays::new(&sensor, 3_600.0);
    let mut firing = Firing::new(rays.count);
    firing.azimuth_deg = azimuth_deg;
    firing.tilt = Stand {
        angle_deg: tilt_deg,
        rate_deg_s: 0.0,
    };
    firing.alive = sensor.used();
    firing.aim(&rays, &Mount::above(0.0));
    firing
}

/// A scene as a VLP-16 sees it.
pub fn around(scene: Scene) -> Surroundings {
    Surroundings::new(Arc::new(scene), Sensor::vlp16().reach(), false)
}

/// What comes back of the middles of beams, both sets looked at.
pub fn cast(firing: &Firing, surroundings: &Surroundings) -> Echoes {
    let mut echoes = Echoes::new(firing.lasers, true);
    let (firings, all) = (
        core::slice::from_ref(firing),
        core::slice::from_mut(&mut echoes),
    );
    surroundings.meet_all(firings, all);
    echoes
}

/// An echo of a surface that is met head-on.
pub fn echo(range_m: f64, reflectivity: f64) -> Echo {
    Echo {
        range_m,
        true_range_m: range_m,
        reflectivity,
        share: 1.0,
        normal: DVec3::ZERO,
        specular: 0.0,
    }
}

/// An axis that is where it is commanded.
pub fn at(deg: f64) -> Axis {
    Axis {
        commanded_deg: deg,
        shaft_deg: deg,
        platform_deg: deg,
    }
}

/// What arrives of parcels that leave then.
pub fn arrivals(wire: &mut impl Wire, kind: ParcelKind, leaves_ns: &[i64]) -> Vec<Parcel> {
    let mut arrived = Vec::new();
    for (&leaves_ns, number) in leaves_ns.iter().zip(0..) {
        let parcel = Parcel {
            kind,
            number,
            leaves_ns,
        };
        wire.deliver(parcel, &mut |parcel| arrived.push(parcel));
    }
    arrived
}

/// The line of a byte, from 1.
pub fn line(text: &str, offset: usize) -> usize {
    text[..offset].matches('\n').count() + 1
}
