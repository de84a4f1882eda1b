//! The patch that a pulse lights: which way its parts lie, and whether it is all one plane.
//!
//! Left out: what comes back of it.

use glam::DVec3;

use crate::simulate::{Echo, Firing, Met, Surroundings};

/// The patch of one laser's pulse.
#[derive(Clone, Copy, Debug)]
pub(super) struct Footprint {
    pub origin_m: DVec3,
    pub direction: DVec3,
    /// From the middle to the side, along the scan, at 1 m.
    along: DVec3,
    /// From the middle to the upper side.
    across: DVec3,
}

/// Which way the beams move as the head turns: across the fan that the lasers make. With one laser only, level.
pub(super) fn scan_axis(firing: &Firing) -> Option<DVec3> {
    let lasers = firing.directions.get(..firing.lasers)?;
    let first = *lasers.first()?;
    let widest = lasers.iter().fold(first, |widest, next| {
        if next.dot(first) < widest.dot(first) {
            *next
        } else {
            widest
        }
    });
    let fan = first.cross(widest).try_normalize();
    fan.or_else(|| first.cross(DVec3::Z).try_normalize())
}

impl Footprint {
    /// The patch about a ray, `half` its sides (along the scan, across it) at 1 m.
    pub fn new(origin_m: DVec3, direction: DVec3, scan: DVec3, half: [f64; 2]) -> Self {
        let along = (scan - scan.dot(direction) * direction).normalize_or_zero();
        let [width, height] = half;
        Self {
            origin_m,
            direction,
            along: width * along,
            across: height * along.cross(direction),
        }
    }

    /// The way to a part of it, -1..=1 either way; length 1.
    pub fn towards(&self, x: f64, y: f64) -> DVec3 {
        (self.direction + x * self.along + y * self.across).normalize()
    }

    /// Whether its corners are on one plane with its middle. One over the distance changes evenly over a plane, if directions are
    /// measured on a plane as well; so in the middle it is the mean of any two opposite corners.
    pub fn is_flat(&self, middle: &Echo, flat_m: f64, surroundings: &Surroundings) -> bool {
        let longer = (self.direction + self.along + self.across).length();
        let corners = [(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)];
        let mut mets = [None; 4];
        let directions = corners.map(|(x, y)| self.towards(x, y));
        surroundings.meet_fan(self.origin_m, &directions, &mut mets);
        let flat = |a: Option<Met>, b: Option<Met>| match (a, b) {
            (None, None) => !middle.is_there(),
            (Some(a), Some(b)) if middle.is_there() => {
                let mean = 0.5 * longer * (1.0 / a.range_m + 1.0 / b.range_m);
                let off = (mean - 1.0 / middle.range_m).abs();
                let alike = |met: &Met| met.reflectivity == middle.reflectivity;
                off * middle.range_m * middle.range_m <= flat_m && alike(&a) && alike(&b)
            }
            _ => false,
        };
        let [a, opposite_a, b, opposite_b] = mets;
        flat(a, opposite_a) && flat(b, opposite_b)
    }
}
