//! Helpers for tests of effects.

use crate::effects::{AxisAngles, LinkEffect, LinkMessage, MessageKind};
use crate::firing::{Echo, Echoes, SimulatedFiring, Surroundings};
use crate::sensor::{LidarMount, LidarSensor, RayTable};
use std::sync::Arc;

use glam::DVec3;

use crate::motion::AxisState;
use crate::scene::Scene;

/// A firing of a VLP-16 on the tilt axis, aimed.
pub fn firing(azimuth_deg: f64, tilt_deg: f64) -> SimulatedFiring {
    let sensor = LidarSensor::vlp16();
    let rays = RayTable::new(&sensor, 3_600.0);
    let mut firing = SimulatedFiring::new(rays.count);
    firing.azimuth_deg = azimuth_deg;
    firing.tilt = AxisState {
        angle_deg: tilt_deg,
        rate_deg_s: 0.0,
    };
    firing.alive = sensor.used as u32;
    firing.aim(&rays, &LidarMount::above(0.0));
    firing
}

/// A scene in the range of a VLP-16.
pub fn around(scene: Scene) -> Surroundings {
    Surroundings::new(Arc::new(scene), LidarSensor::vlp16().range(), false)
}

/// Returns along the axes of the beams, both sets.
pub fn cast(firing: &SimulatedFiring, surroundings: &Surroundings) -> Echoes {
    let mut echoes = Echoes::new(firing.lasers, true);
    let (firings, all) = (
        core::slice::from_ref(firing),
        core::slice::from_mut(&mut echoes),
    );
    surroundings.meet_all(firings, all);
    echoes
}

/// An echo of a surface met head-on.
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

/// An axis at its commanded angle.
pub fn at(deg: f64) -> AxisAngles {
    AxisAngles {
        commanded_deg: deg,
        shaft_deg: deg,
        platform_deg: deg,
    }
}

/// Arrivals of messages that are sent at these times.
pub fn arrivals(
    link: &mut impl LinkEffect,
    kind: MessageKind,
    time_ns: &[i64],
) -> Vec<LinkMessage> {
    let mut arrived = Vec::new();
    for (&time_ns, number) in time_ns.iter().zip(0..) {
        let message = LinkMessage {
            kind,
            number,
            time_ns,
        };
        link.deliver(message, &mut |message| arrived.push(message));
    }
    arrived
}
