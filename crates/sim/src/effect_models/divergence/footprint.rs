//! The footprint of a pulse: directions of its parts, and whether it is plane.

use crate::firing::{Echo, SimulatedFiring, SurfaceHit, Surroundings};
use glam::DVec3;

/// The footprint of one laser's pulse.
#[derive(Clone, Copy, Debug)]
pub(super) struct Footprint {
    pub origin_m: DVec3,
    pub direction: DVec3,
    /// From the centre to the side along the scan, at 1 m.
    along: DVec3,
    /// From the centre to the upper side, at 1 m.
    across: DVec3,
}

/// Direction of the scan: perpendicular to the fan of the lasers, or to the head's axis with a
/// single laser.
pub(super) fn scan_axis(firing: &SimulatedFiring) -> Option<DVec3> {
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
    fan.or_else(|| first.cross(firing.head_axis).try_normalize())
}

impl Footprint {
    /// The footprint about a ray with half sides `half` (along the scan, across it) at 1 m.
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

    /// Direction to a part of it, -1..=1 along either side; length 1.
    pub fn towards(&self, x: f64, y: f64) -> DVec3 {
        (self.direction + x * self.along + y * self.across).normalize()
    }

    /// Whether its corners are on one plane with its centre. The inverse distance is linear over a
    /// plane, so at the centre it is the mean of two opposite corners.
    pub fn is_flat(&self, middle: &Echo, flat_m: f64, surroundings: &Surroundings) -> bool {
        let longer = (self.direction + self.along + self.across).length();
        let corners = [(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)];
        let mut mets = [None; 4];
        let directions = corners.map(|(x, y)| self.towards(x, y));
        surroundings.cast_fan(self.origin_m, &directions, &mut mets);
        let flat = |a: Option<SurfaceHit>, b: Option<SurfaceHit>| match (a, b) {
            (None, None) => !middle.is_present(),
            (Some(a), Some(b)) if middle.is_present() => {
                let mean = 0.5 * longer * (1.0 / a.range_m + 1.0 / b.range_m);
                let off = (mean - 1.0 / middle.range_m).abs();
                let alike = |met: &SurfaceHit| met.reflectivity == middle.reflectivity;
                off * middle.range_m * middle.range_m <= flat_m && alike(&a) && alike(&b)
            }
            _ => false,
        };
        let [a, opposite_a, b, opposite_b] = mets;
        flat(a, opposite_a) && flat(b, opposite_b)
    }
}
