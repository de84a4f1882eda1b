//! The field of view of a tilted lidar: directions between its lowest and highest laser at some
//! tilt.
//!
//! Directions are from the origin of the base, on the tilt axis. A sensor off the axis sees a point
//! under another elevation, the more the nearer the point, so a view is for a range of distances.
//! A planar scanner on the axis sees a range of azimuths. Occlusion is not included.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

/// The field of view of a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldOfView {
    /// Lowest and highest elevation above the tilted horizontal, seen from the origin, radians. The
    /// lowest is above the highest where nothing is visible at all distances.
    elevations_rad: [f64; 2],
    /// Least and greatest tilt, radians.
    tilt_rad: [f64; 2],
    /// First and last azimuth of a planar scanner, degrees; `None` for a rotating head.
    pub(super) azimuths_deg: Option<[f64; 2]>,
}

impl FieldOfView {
    /// The view of a sensor with these extreme elevations in its own frame (degrees, the lowest
    /// first), a range of tilts (degrees, in any order) and ray origins `d_m` above the axis: what
    /// is visible at all distances from the first of `range_m` to the last, metres from the origin
    /// of the base. On the axis, distances do not matter.
    #[must_use]
    pub fn new(
        elevations_deg: [f64; 2],
        tilt_deg: [f64; 2],
        d_m: [f64; 2],
        range_m: [f64; 2],
    ) -> Self {
        let [low, high] = elevations_deg.map(f64::to_radians);
        let [a, b] = tilt_deg.map(f64::to_radians);
        let [near, far] = range_m;
        // The effect of the sensor's height is monotonic in the distance: the nearest and farthest
        // decide.
        let at = |elevation: f64, d_m: f64| {
            [near, far].map(|range| from_axis_rad(elevation, d_m / range))
        };
        let [low_d_m, high_d_m] = d_m;
        let ([low_near, low_far], [high_near, high_far]) = (at(low, low_d_m), at(high, high_d_m));
        Self {
            elevations_rad: [low_near.max(low_far), high_near.min(high_far)],
            tilt_rad: [a.min(b), a.max(b)],
            azimuths_deg: None,
        }
    }

    /// Depth of a direction (length 1) in the view, from the lowest to the highest laser over all
    /// tilts: radians, negative outside. It changes by no more than the direction.
    #[must_use]
    pub fn depth_rad(&self, direction: DVec3) -> f64 {
        if let Some(azimuths_deg) = self.azimuths_deg {
            return self.planar_depth_rad(direction, azimuths_deg);
        }
        let [from, to] = self.tilt_rad;
        // In the sensor's frame the height of a direction is across x cos(tilt - ahead).
        let across = direction.x.hypot(direction.z);
        let ahead = direction.x.atan2(direction.z);
        let passes = |angle: f64| {
            let turns = ((from - angle) / TAU).ceil();
            angle + turns * TAU <= to
        };
        let ends = [from, to].map(|tilt| across * (tilt - ahead).cos());
        let most = if passes(ahead) {
            across
        } else {
            ends[0].max(ends[1])
        };
        let least = if passes(ahead + PI) {
            -across
        } else {
            ends[0].min(ends[1])
        };
        let elevation = |height: f64| height.clamp(-1.0, 1.0).asin();
        let [low, high] = self.elevations_rad;
        (elevation(most) - low).min(high - elevation(least))
    }

    /// Depth in what a level laser on the axis passes over: a wedge about the axis on either side
    /// of it, in each of which the azimuth is the angle from the axis, or its negative.
    fn planar_depth_rad(&self, direction: DVec3, [first_deg, last_deg]: [f64; 2]) -> f64 {
        let across = direction.x.hypot(direction.z);
        let polar = across.atan2(direction.y);
        let [middle, half] = [first_deg + last_deg, last_deg - first_deg].map(|a| 0.5 * a);
        let (middle, half) = (middle.to_radians(), half.to_radians());
        let around = (-direction.z).atan2(direction.x);
        let side = |azimuth: f64, around: f64| {
            let off = (azimuth - middle + PI).rem_euclid(TAU) - PI;
            (half - off.abs()).min(self.wedge_depth_rad(across, around))
        };
        side(polar, around).max(side(-polar, around + PI))
    }

    /// Depth between the half-planes through the axis at the first and the last tilt, of a
    /// direction `across` off the axis at the angle `around` it.
    fn wedge_depth_rad(&self, across: f64, around: f64) -> f64 {
        let [from, to] = self.tilt_rad;
        // Distances from great circles through the axis.
        let from_circle = |angle: f64| (across * angle.sin()).clamp(-1.0, 1.0).asin();
        let (after, before) = (from_circle(around - from), from_circle(to - around));
        match to - from {
            way if way >= TAU => PI,
            way if way > PI => after.max(before),
            // A narrow wedge does not go on beyond the axis.
            way => {
                let ahead = from_circle(around - from - 0.5 * way + FRAC_PI_2);
                after.min(before).min(ahead)
            }
        }
    }
}

/// The elevation, seen from the origin, of the point where a laser meets a sphere about the origin;
/// the sensor is `share` (-1..=1) of the radius above the origin.
fn from_axis_rad(elevation_rad: f64, share: f64) -> f64 {
    let e = if share.is_finite() {
        share.clamp(-1.0, 1.0)
    } else {
        0.0
    };
    let (sin, cos) = elevation_rad.sin_cos();
    // The range along the ray, in radii, and with it the height: Eq. 9 solved for R.
    let along = (1.0 - (e * cos).powi(2)).max(0.0).sqrt() - e * sin;
    (e + along * sin).clamp(-1.0, 1.0).asin()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patterns::PatternRequest;

    /// All rays of a pattern are in its view, and the view ends at the outermost rays, for any
    /// position of the sensor.
    #[test]
    fn the_view_follows_the_position_of_the_sensor() {
        for text in [
            "vlp16",
            "vlp16,d=0.5",
            "vlp16,d=5",
            "vlp16,d=-5",
            "hdl32e,from=20,d=2",
            "velomotion16:50,d=0.06",
            "velomotion16:50,d=-0.06",
            "velomotion16:50,d=3",
            "rmbl:120,to=90,d=-1",
            "hdl64e:90",
            "utm30lx:90",
            "utm30lx:90,roll",
            "lms151:180,spin",
            "lms151:180,spin,pitch",
            "lms151:180,spin,to=270",
        ] {
            let pattern = PatternRequest::parse(text).unwrap().build().unwrap();
            let view = pattern.view();
            let directions = pattern.directions();
            let depths = directions.iter().map(|d| view.depth_rad(*d));
            let least = depths.fold(f64::INFINITY, f64::min);
            // All rays are visible, and the edge is at the outermost ones.
            assert!((-1e-7..1e-3).contains(&least), "{text}: {least}");
        }
    }

    #[test]
    fn elevations_from_the_axis_match_points_on_the_sphere() {
        for share in [-0.95_f64, -0.5, 0.0, 0.006, 0.5, 0.9] {
            let mut before = f64::NEG_INFINITY;
            for degrees in -89..=89 {
                let w = f64::from(degrees).to_radians();
                let found = from_axis_rad(w, share);
                assert!(found > before, "{share} {degrees}");
                before = found;
                // From the sensor the point is at elevation w.
                let (up, out) = (found.sin() - share, found.cos());
                if out.abs() > 1e-6 || up.abs() > 1e-6 {
                    assert!((up.atan2(out) - w).abs() < 1e-7, "{share} {degrees}");
                }
            }
        }
    }

    #[test]
    fn the_view_of_a_range_is_the_intersection_of_its_distances() {
        let view = |range_m| FieldOfView::new([-15.0, 15.0], [0.0, 0.0], [0.5; 2], range_m);
        let (near, far, both) = (view([1.0; 2]), view([50.0; 2]), view([1.0, 50.0]));
        for k in -90..=90 {
            let (sin, cos) = f64::from(k).to_radians().sin_cos();
            let direction = DVec3::new(cos, 0.0, sin);
            let least = near.depth_rad(direction).min(far.depth_rad(direction));
            assert!((both.depth_rad(direction) - least).abs() < 1e-12);
        }
        // A distance of zero is undefined and does not panic.
        assert!(view([0.0; 2]).depth_rad(DVec3::X).is_finite());
    }
}
