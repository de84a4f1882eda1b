//! Clock: drift and wander of the lidar's oscillator.
//!
//! A constant rate plus a piecewise linear function through independent normal values one period
//! apart, so the deviation stays about `wander_us`. Temperature and PPS are not included.

use crate::effects::ClockEffect;
use std::sync::Arc;

use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};
use crate::random::RandomSource;

/// `[effects.lidar_clock]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct LidarClockSettings {
    /// Drift, parts per million, positive is fast; -1000 to 1000.
    pub drift_ppm: f64,
    /// Standard deviation of the wander, microseconds.
    pub wander_us: f64,
    /// Period of the wander, seconds; default 10.
    pub wander_period_s: f64,
}

impl Default for LidarClockSettings {
    fn default() -> Self {
        Self {
            drift_ppm: 0.0,
            wander_us: 0.0,
            wander_period_s: 10.0,
        }
    }
}

/// A clock with drift and wander.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriftingClock {
    /// Host nanoseconds per lidar nanosecond, minus 1.
    slower: f64,
    wander_ns: f64,
    period_ns: f64,
    random: RandomSource,
}

impl DriftingClock {
    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`InvalidSetting`] for numbers out of range, and for a wander so fast that time could run
    /// backwards.
    pub fn new(settings: &LidarClockSettings, seed: u64) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
        let ppm = check.within("drift_ppm", settings.drift_ppm, -1e3..=1e3)?;
        let period_s = check.within("wander_period_s", settings.wander_period_s, 1e-3..=1e6)?;
        // Draws are within 8.6 standard deviations.
        let most_us = period_s * 1e6 / 40.0;
        Ok(Self {
            slower: 1.0 / (1.0 + ppm * 1e-6) - 1.0,
            wander_ns: 1e3 * check.within("wander_us", settings.wander_us, 0.0..=most_us)?,
            period_ns: period_s * 1e9,
            random: RandomSource::new(seed, Self::NAME),
        })
    }

    /// The wander, nanoseconds; 0 at the start.
    fn wander(&self, device_ns: f64) -> f64 {
        if self.wander_ns == 0.0 {
            return 0.0;
        }
        let periods = (device_ns / self.period_ns).max(0.0);
        let period = periods.floor();
        let at = |index: u64| match index {
            0 => 0.0,
            index => self.random.at(index, 0).normal(),
        };
        // Below 2^63: at most a day of milliseconds.
        let (from, to) = (at(period as u64), at(period as u64 + 1));
        self.wander_ns * (from + (to - from) * (periods - period))
    }
}

/// Drift of the simulated VLP-16 without settings, parts per million: within the 20 ppm of ordinary
/// quartz oscillators.
const USUAL_DRIFT_PPM: f64 = 12.0;

effect! {
    DriftingClock, LidarClockSettings, firings.clock: Arc, "lidar_clock",
    idle: "it neither drifts nor wanders",
    usual: LidarClockSettings { drift_ppm: USUAL_DRIFT_PPM, ..LidarClockSettings::default() },
    new: DriftingClock::new
}

impl ClockEffect for DriftingClock {
    fn host_ns(&self, device_ns: i64) -> i64 {
        let since = device_ns as f64;
        let off_ns = (since * self.slower - self.wander(since)).round() as i64;
        device_ns.saturating_add(off_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fast_clock_runs_ahead() {
        let settings = LidarClockSettings {
            drift_ppm: 12.0,
            ..LidarClockSettings::default()
        };
        let clock = DriftingClock::new(&settings, 1).unwrap();
        assert_eq!(clock.host_ns(0), 0);
        // 12 ppm of 100 s are 1.2 ms, minus 12 ppm of that.
        assert_eq!(clock.host_ns(100_000_000_000), 99_998_800_014);
    }

    #[test]
    fn the_clock_wanders_but_never_goes_back() {
        let settings = LidarClockSettings {
            drift_ppm: -1_000.0,
            wander_us: 250.0,
            wander_period_s: 0.01,
        };
        let clock = DriftingClock::new(&settings, 3).unwrap();
        let times: Vec<i64> = (0..200_000)
            .map(|step| clock.host_ns(step * 55_296))
            .collect();
        assert!(times.is_sorted());
        let off_us: Vec<f64> = (0..200_000)
            .map(|step| clock.wander(55_296.0 * f64::from(step)) * 1e-3)
            .collect();
        let square = off_us.iter().map(|us| us * us).sum::<f64>() / off_us.len() as f64;
        // The mean square of a line between two draws is 2/3 of that of the draws.
        assert!((square.sqrt() / 250.0 / (2.0_f64 / 3.0).sqrt() - 1.0).abs() < 0.1);
        let quick = LidarClockSettings {
            wander_us: 251.0,
            ..settings
        };
        assert!(DriftingClock::new(&quick, 3).is_err());
    }
}
