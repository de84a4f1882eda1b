//! A planned scan with azimuths of the lidar at the starts of its sweeps.

use super::{PlannedPlace, PlannedRays, PlannedScan, ScanPredictor, StartedSweep, TiltSweep};

/// Counts of the encoder that the axis moves at the start before a cloud has points, and at the end
/// without them: with slow ramps for some milliseconds, a part of a revolution of the lidar.
const UNSEEN_COUNTS: f64 = 2.0;

/// Sweeps whose gaps are computed; of more, gaps are at most as wide.
const MOST_SWEEPS: usize = 8;

/// The rays of a scan with one of the azimuths of the lidar at the start.
pub(super) struct StartedScan {
    pub(super) rays: PlannedRays,
    sweeps: Vec<StartedSweep>,
}

impl StartedScan {
    pub(super) fn gap_deg(&self, place: &PlannedPlace) -> f64 {
        self.rays.gap_deg(&self.sweeps, place)
    }

    pub(super) fn gap_beyond_deg(&self, place: &PlannedPlace, least_deg: f64) -> f64 {
        self.rays.gap_beyond_deg(&self.sweeps, place, least_deg)
    }

    pub(super) fn is_within(&self, place: &PlannedPlace, gap_deg: f64) -> bool {
        self.rays.is_within(&self.sweeps, place, gap_deg)
    }
}

impl ScanPredictor {
    /// Sweeps of a scan with one of so many azimuths at the start.
    pub(super) fn started(&self, scan: &PlannedScan, start: u32, starts: u32) -> StartedScan {
        self.started_at(scan, &azimuths_at_starts(scan, start, starts))
    }

    /// Sweeps of a scan with azimuths of the lidar at their starts, revolutions.
    pub(super) fn started_at(&self, scan: &PlannedScan, starts: &[f64]) -> StartedScan {
        let unseen_deg = UNSEEN_COUNTS * self.errors.count_deg;
        let begin = |(sweep, start): (&TiltSweep, &f64)| {
            StartedSweep::new(sweep, start.rem_euclid(1.0), unseen_deg)
        };
        StartedScan {
            rays: self.rays_at(scan.setting.rpm),
            sweeps: scan.sweeps.iter().zip(starts).map(begin).collect(),
        }
    }
}

/// One of so many choices of the azimuths at the starts of sweeps, revolutions: evenly spaced for
/// the first sweep, and by the golden ratio for later ones, since the time between sweeps is not
/// controlled.
pub(super) fn azimuths_at_starts(scan: &PlannedScan, start: u32, starts: u32) -> Vec<f64> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let first = f64::from(start) / f64::from(starts);
    let sweeps = 0..scan.sweeps.len().min(MOST_SWEEPS);
    sweeps
        .map(|number| first + number as f64 * GOLDEN * (1.0 + f64::from(start)))
        .collect()
}
