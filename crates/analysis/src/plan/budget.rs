//! The error of a point at a distance, term by term, before a scan.
//!
//! All terms are standard deviations across the tilt axis, where the arm of the tilt is longest, at
//! the highest speed of the sweeps. Where only a bound is known the error counts as uniform within
//! it, bound / sqrt 3 (GUM, JCGM 100:2008, 4.3.7).

use std::f64::consts::PI;

use serde::Serialize;
use utoipa::ToSchema;

use super::{PlanLidar, TiltSweep};

/// Times of the positions that a link to the drive gives.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LinkTiming {
    /// Time from one position to the next, seconds.
    pub poll_s: f64,
    /// Standard deviation of the time of a position, seconds.
    pub sd_s: f64,
    /// Greatest delay that all positions may share, which no scan reveals, seconds.
    pub shared_s: f64,
}

impl LinkTiming {
    /// USB, or an adapter on USB: 0.3 to 1 ms each way.
    pub const USB: Self = Self {
        poll_s: 1.54e-3,
        sd_s: 1.5e-4,
        shared_s: 4.2e-4,
    };
    /// RS232 at 115,200 baud.
    pub const RS232: Self = Self {
        poll_s: 2.76e-3,
        sd_s: 2e-5,
        shared_s: 1.2e-4,
    };
    /// CAN on an interface of the kernel at 1 kHz. The age of a position may be a control cycle of
    /// 1 ms.
    pub const CAN: Self = Self {
        poll_s: 1e-3,
        sd_s: 1e-5,
        shared_s: 1.11e-3,
    };
}

/// Quantities besides the motion that determine the error of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorModel {
    /// Distance of the point, metres.
    pub range_m: f64,
    /// Standard deviation of a range, including its quantisation, metres.
    pub range_sd_m: f64,
    /// Tilt per count of the encoder, degrees.
    pub count_deg: f64,
    /// The link to the drive.
    pub link: LinkTiming,
    /// Standard deviation of the lidar's seat on the axis and of the zero of the tilt, degrees;
    /// `None` where it has not been measured.
    pub mount_sd_deg: Option<f64>,
}

/// Mean square of the weights of two neighbouring azimuths, between which a firing's is
/// interpolated: that of p and 1 - p for p from 0 to 1.
const INTERPOLATED: f64 = 2.0 / 3.0;
/// Parameters of a motion that a fit estimates: start, way, begin, speed and two ramps.
const MOTION_PARAMETERS: f64 = 6.0;
/// Error of the lidar's clock on a quiet network, seconds (the book, Accuracy: the largest error
/// over 45 s), with the quantisation of its stamps to a microsecond.
const CLOCK_SD_S: f64 = 1.8e-6;
/// Greatest least delay of a network, which no scan reveals, seconds: a switch, and the coalescing
/// of interrupts by the host.
const NETWORK_S: f64 = 1e-4;
/// Standard deviations of a normal error that hold 95 % of points. For errors in several directions
/// the share is larger (Szekely and Bakirov, 2003: of all weighted sums of squares, the single one
/// has the smallest share here).
const SDS_OF_95_PERCENT: f64 = 1.96;

/// Error of a point, millimetres, one standard deviation unless named otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct ErrorBudget {
    /// Noise of the range.
    pub range: f64,
    /// Quantisation of the range.
    pub range_step: f64,
    /// Quantisation of the azimuth.
    pub azimuth: f64,
    /// Fit of the tilt angle to the drive's positions.
    pub tilt: f64,
    /// The lidar's clock.
    pub clock: f64,
    /// Delay that all positions of the drive or all packets share.
    pub delay: f64,
    /// Mount and zero of the tilt; null where they are not calibrated: they count as exact.
    pub mount: Option<f64>,
    /// Root sum of squares of the terms from range to clock: what the column `sd` of a cloud has.
    pub column_sd: f64,
    /// 95 % of points are within it: 1.96 times the root sum of squares of all terms.
    pub total: f64,
}

impl ErrorModel {
    /// The errors of a scan.
    #[must_use]
    pub fn budget(&self, lidar: &PlanLidar, sweeps: &[TiltSweep]) -> ErrorBudget {
        let speed = sweeps.iter().map(TiltSweep::peak_deg_s).fold(0.0, f64::max);
        let shortest_s = sweeps
            .iter()
            .map(TiltSweep::duration_s)
            .fold(f64::INFINITY, f64::min);
        let mm = |deg: f64| 1e3 * self.range_m * deg * PI / 180.0;
        let uniform_step = |step: f64| step / 12_f64.sqrt();
        let range_step = uniform_step(lidar.range_step_m);
        let range = (self.range_sd_m.powi(2) - range_step.powi(2))
            .max(0.0)
            .sqrt();
        let sample = uniform_step(self.count_deg).hypot(speed * self.link.sd_s);
        let samples = (shortest_s / self.link.poll_s).max(MOTION_PARAMETERS);
        let shared_s = self.link.shared_s.hypot(NETWORK_S);
        let mut budget = ErrorBudget {
            range: 1e3 * range,
            range_step: 1e3 * range_step,
            azimuth: mm(uniform_step(lidar.azimuth_step_deg) * INTERPOLATED.sqrt()),
            tilt: mm(sample * (MOTION_PARAMETERS / samples).sqrt()),
            clock: mm(speed * CLOCK_SD_S),
            delay: mm(speed * shared_s / 3_f64.sqrt()),
            mount: self.mount_sd_deg.map(mm),
            column_sd: 0.0,
            total: 0.0,
        };
        let known = [
            budget.range,
            budget.range_step,
            budget.azimuth,
            budget.tilt,
            budget.clock,
        ];
        budget.column_sd = known.into_iter().fold(0.0, f64::hypot);
        let constant = budget.delay.hypot(budget.mount.unwrap_or(0.0));
        budget.total = SDS_OF_95_PERCENT * budget.column_sd.hypot(constant);
        budget
    }
}

impl ErrorBudget {
    /// Error of 95 % of points by their ranges alone, millimetres.
    #[must_use]
    pub fn of_ranges(&self) -> f64 {
        SDS_OF_95_PERCENT * self.range.hypot(self.range_step)
    }

    /// Error of 95 % of points by everything but ranges and mount, millimetres.
    #[must_use]
    pub fn without_ranges(&self) -> f64 {
        let terms = [self.azimuth, self.tilt, self.clock, self.delay];
        SDS_OF_95_PERCENT * terms.into_iter().fold(0.0, f64::hypot)
    }
}

#[cfg(test)]
mod tests {
    use super::super::lidar::tests::vlp_16;
    use super::*;

    const MODEL: ErrorModel = ErrorModel {
        range_m: 20.0,
        range_sd_m: 0.03,
        count_deg: 0.0015,
        link: LinkTiming::USB,
        mount_sd_deg: None,
    };

    fn sweep(speed_deg_s: f64) -> TiltSweep {
        TiltSweep {
            from_deg: 0.0,
            to_deg: -45.0,
            speed_deg_s,
            accel_deg_s2: 500.0,
        }
    }

    /// Each term by hand, at 20 m and 56.25 deg/s over USB.
    #[test]
    fn every_term_is_in_the_sum() {
        let budget = MODEL.budget(&vlp_16(), &[sweep(56.25)]);
        let near = |found: f64, expected: f64| {
            assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
        };
        near(budget.range, 29.99);
        near(budget.range_step, 0.577);
        // 0.01 deg are 3.49 mm at 20 m.
        near(budget.azimuth, 3.49 / 12_f64.sqrt() * (2_f64 / 3.0).sqrt());
        // 592 polls in 0.9125 s, each 0.0084 deg off.
        near(budget.tilt, 349.0 * 0.00845 * (6.0 / 592.5_f64).sqrt());
        near(budget.clock, 349.0 * 56.25 * 1.8e-6);
        near(budget.delay, 349.0 * 56.25 * 4.317e-4 / 3_f64.sqrt());
        assert_eq!(budget.mount, None);
        near(
            budget.total,
            1.96 * 30.0_f64.hypot(0.82).hypot(0.3).hypot(4.89),
        );
        let mounted = ErrorModel {
            mount_sd_deg: Some(0.1),
            ..MODEL
        };
        near(
            mounted.budget(&vlp_16(), &[sweep(56.25)]).mount.unwrap(),
            34.9,
        );
    }

    #[test]
    fn slower_sweeps_err_less() {
        let mut last = f64::INFINITY;
        for speed in [98.0, 56.25, 20.0, 5.0, 0.5] {
            let budget = MODEL.budget(&vlp_16(), &[sweep(speed)]);
            assert!(budget.total < last, "{speed}: {budget:?}");
            last = budget.total;
        }
        // The range remains.
        assert!(last > 1.96 * 30.0);
    }
}
