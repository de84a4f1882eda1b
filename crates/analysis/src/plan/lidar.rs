//! The lidar of a plan: where its lasers point, and when they fire.

use crate::tilted_sensor::vertical_resolution_deg;

use super::TiltSweep;

/// One laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanLaser {
    /// Angle above the horizontal plane of the sensor, degrees.
    pub elevation_deg: f64,
    /// Height of the origin of its ray above the sensor's origin, metres.
    pub height_m: f64,
    /// Angle added to the azimuth of its firing, degrees.
    pub azimuth_deg: f64,
    /// Time from the start of its firing, seconds.
    pub delay_s: f64,
}

/// A lidar on the platform: a head that rotates, or a planar scanner.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanLidar {
    /// Its model.
    pub name: String,
    /// Its lasers in any order; at least one.
    pub lasers: Vec<PlanLaser>,
    /// Time from one firing of all lasers to the next, seconds; above 0.
    pub firing_period_s: f64,
    /// Time from one packet to the next, seconds; above 0. `None` where logs cannot hold them.
    pub packet_period_s: Option<f64>,
    /// Steps of its azimuths, degrees; 0 where a reading is at its nominal azimuth.
    pub azimuth_step_deg: f64,
    /// First and last azimuth that it sees, degrees; `None` for all around.
    pub azimuths_deg: Option<[f64; 2]>,
    /// Steps of its ranges, metres.
    pub range_step_m: f64,
    /// Height of its origin above the tilt axis, metres (d of Eq. 4-6).
    pub d_m: f64,
}

impl PlanLidar {
    /// Lowest and highest laser, degrees.
    pub(super) fn ends_deg(&self) -> [f64; 2] {
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        let elevations = self.lasers.iter().map(|laser| laser.elevation_deg);
        elevations.fold(ends, |[low, high], w| [low.min(w), high.max(w)])
    }

    /// Mean vertical resolution of a sweep in degrees, as in the paper and
    /// [`vertical_resolution_deg`]: the field of view divided by lasers and by the revolutions that
    /// the way takes at cruise speed. Ramps, in which lines are closer, are ignored. For 45 degrees
    /// at 56.25 deg/s and 600 rpm it is 75 / (16 x 8) = 0.586.
    #[must_use]
    pub fn mean_resolution_deg(&self, sweep: &TiltSweep, rpm: f64) -> f64 {
        let revolutions = sweep.way_deg() / sweep.speed_deg_s * rpm / 60.0;
        let lasers = u32::try_from(self.lasers.len()).unwrap_or(u32::MAX);
        let [low, high] = self.ends_deg();
        vertical_resolution_deg(high - low + sweep.way_deg(), lasers, revolutions)
    }

    /// Rays of all lasers during sweeps: the most points that a scan may have.
    #[must_use]
    pub fn rays(&self, sweeps: &[TiltSweep]) -> f64 {
        let seen = self
            .azimuths_deg
            .map_or(1.0, |[first, last]| (last - first) / 360.0);
        let firings =
            |sweep: &TiltSweep| (seen * sweep.duration_s() / self.firing_period_s).floor();
        sweeps.iter().map(firings).sum::<f64>() * self.lasers.len() as f64
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The VLP-16: -15 to 15 degrees in steps of 2 (manual 63-9243, table 9-1).
    pub(in super::super) fn vlp_16() -> PlanLidar {
        let laser = |number: u32| {
            // Channels 0 and 1 are the lowest laser and the one above the horizontal.
            let rank = number / 2 + 8 * (number % 2);
            PlanLaser {
                elevation_deg: f64::from(2 * rank) - 15.0,
                height_m: 0.0,
                azimuth_deg: 0.0,
                delay_s: f64::from(number) * 2.304e-6,
            }
        };
        PlanLidar {
            name: "VLP-16".to_owned(),
            lasers: (0..16).map(laser).collect(),
            firing_period_s: 55.296e-6,
            packet_period_s: Some(24.0 * 55.296e-6),
            azimuth_step_deg: 0.01,
            azimuths_deg: None,
            range_step_m: 2e-3,
            d_m: 0.06,
        }
    }

    #[test]
    fn resolutions_match_the_paper() {
        let at = |speed_deg_s: f64, accel_deg_s2: f64| {
            let sweep = TiltSweep {
                from_deg: 0.0,
                to_deg: -45.0,
                speed_deg_s,
                accel_deg_s2,
            };
            vlp_16().mean_resolution_deg(&sweep, 600.0)
        };
        assert!((at(56.25, f64::INFINITY) - 0.5859).abs() < 5e-5);
        // Independent of the ramps.
        assert_eq!(at(56.25, f64::INFINITY), at(56.25, 500.0));
        // The paper's 5.2e-3 for its slowest scan is that of 0.5 deg/s; 0.05 deg/s gives a tenth of
        // it.
        assert!((at(0.5, 500.0) - 5.208e-3).abs() < 5e-7);
        assert!((at(0.05, 500.0) - 5.208e-4).abs() < 5e-8);
    }
}
