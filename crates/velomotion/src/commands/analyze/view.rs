//! Field of view of patterns (from their settings) and logs (from lidar, sweeps and mount), and the
//! position of a cloud's origin.
//!
//! `sim` has the geometry ([`FieldOfView`]). Clouds have no view: they do not tell how they were
//! scanned.

use cloud::TiltTrack;
use glam::DVec3;
use serde::Serialize;
use sim::patterns::{FieldOfView, Pattern, SPHERE_M};
use utoipa::ToSchema;

use engine::reconstruct::log_view::LogView;
use engine::reconstruct::report::ScanReport;

/// A field of view and its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct ViewReport {
    /// The directions.
    #[serde(skip)]
    pub view: FieldOfView,
    /// Lowest and highest laser above the sensor's horizontal plane, degrees.
    pub elevations_deg: [f64; 2],
    /// First and last azimuth of a planar scanner, degrees; null for a head that rotates.
    pub azimuths_deg: Option<[f64; 2]>,
    /// Smallest and largest tilt, degrees.
    pub tilt_deg: [f64; 2],
    /// Height of the sensor above the tilt axis, metres.
    pub d_m: f64,
    /// Range of distances from the origin of the base at all of which the scan sees the view,
    /// metres: the radius of a pattern's sphere, or the interval that holds 98 % of a log's points.
    pub distance_m: [f64; 2],
}

/// Share of the nearest and farthest points that is ignored for distances and for the position of a
/// cloud.
const FEW: f64 = 0.01;

impl ViewReport {
    /// View of a pattern, at its hollow sphere.
    #[must_use]
    pub fn of_pattern(pattern: &Pattern) -> Self {
        let tilts = pattern.tilts_deg();
        Self {
            view: pattern.view(),
            elevations_deg: pattern.elevations_deg(),
            azimuths_deg: pattern.azimuths_deg(),
            tilt_deg: tilts,
            d_m: pattern.settings().d_m,
            distance_m: [SPHERE_M; 2],
        }
    }

    /// View of a log; `None` for an unknown model or several lidars.
    #[must_use]
    pub fn of_log(scan: &ScanReport, track: &TiltTrack, places: &[DVec3]) -> Option<Self> {
        let mut distances: Vec<f64> = places.iter().map(|place| place.length()).collect();
        let distance_m = middle(&mut distances)?;
        let seen = LogView::new(scan, track, distance_m)?;
        Some(Self {
            view: seen.view,
            elevations_deg: seen.elevations_deg,
            azimuths_deg: None,
            tilt_deg: seen.tilt_deg,
            d_m: seen.d_m,
            distance_m,
        })
    }
}

/// An origin outside the box that holds 98 % of a cloud's points along each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistantOrigin {
    origin_m: DVec3,
    /// Distance from the origin to the box, metres.
    off_m: f64,
    /// Centre of the box in cloud coordinates.
    middle_m: DVec3,
    /// Diagonal of the box.
    size_m: f64,
}

impl DistantOrigin {
    /// Position of `origin_m` relative to the points; `None` if it lies among them.
    pub fn new(places: &[DVec3], origin_m: DVec3) -> Option<Self> {
        let axis = |of: fn(&DVec3) -> f64| middle(&mut places.iter().map(of).collect::<Vec<_>>());
        let (x, y, z) = (axis(|p| p.x)?, axis(|p| p.y)?, axis(|p| p.z)?);
        let low = DVec3::new(x[0], y[0], z[0]);
        let high = DVec3::new(x[1], y[1], z[1]);
        let off_m = low.max(-high).max(DVec3::ZERO).length();
        (off_m > 0.0).then(|| Self {
            origin_m,
            off_m,
            middle_m: origin_m + low.midpoint(high),
            size_m: low.distance(high),
        })
    }

    /// Warning, if a hole of this radius shows that all points lie on one side.
    pub fn warning(&self, hole_deg: f64) -> Option<String> {
        if hole_deg <= 90.0 {
            return None;
        }
        let say = |at: DVec3| format!("{:.0},{:.0},{:.0}", at.x, at.y, at.z);
        Some(format!(
            "the origin {} lies {:.1} m outside the cloud, which is {:.1} m across about {}: directions from there say nothing of how it was scanned. \
             --origin X,Y,Z says where the scanner was, in the cloud's coordinates",
            say(self.origin_m),
            self.off_m,
            self.size_m,
            say(self.middle_m)
        ))
    }
}

/// Minimum and maximum without a hundredth at each end; reorders `numbers`.
fn middle(numbers: &mut [f64]) -> Option<[f64; 2]> {
    let last = numbers.len().checked_sub(1)?;
    let few = (FEW * last as f64) as usize;
    let mut at = |place: usize| *numbers.select_nth_unstable_by(place, f64::total_cmp).1;
    Some([at(few), at(last - few)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outermost_hundredths_are_ignored() {
        let mut numbers: Vec<f64> = (0..=200).rev().map(f64::from).collect();
        numbers[7] = 1e9;
        assert_eq!(middle(&mut numbers), Some([2.0, 199.0]));
        assert_eq!(middle(&mut [3.0]), Some([3.0; 2]));
        assert_eq!(middle(&mut []), None);
    }

    #[test]
    fn the_distance_of_the_origin_from_the_cloud_is_reported() {
        let corners = |middle: DVec3| -> Vec<DVec3> {
            (0..8)
                .map(|k| {
                    let side = |bit: i32| f64::from(2 * (k >> bit & 1) - 1);
                    middle + 10.0 * DVec3::new(side(0), side(1), side(2))
                })
                .collect()
        };
        assert_eq!(DistantOrigin::new(&corners(DVec3::ZERO), DVec3::ZERO), None);
        assert_eq!(
            DistantOrigin::new(&corners(DVec3::splat(9.9)), DVec3::ZERO),
            None
        );
        let far = DistantOrigin::new(
            &corners(DVec3::new(450_000.0, 5_400_000.0, 0.0)),
            DVec3::ZERO,
        );
        let far = far.unwrap();
        assert!((far.off_m - 449_990.0_f64.hypot(5_399_990.0)).abs() < 1e-6);
        let message = far.warning(179.9).unwrap();
        assert!(
            message.contains("--origin") && message.contains("about 450000,5400000,0"),
            "{message}"
        );
        // A scan of a single wall is valid.
        let close = DistantOrigin::new(&corners(DVec3::new(11.0, 0.0, 0.0)), DVec3::ZERO).unwrap();
        assert_eq!(close.warning(80.0), None);
    }
}
