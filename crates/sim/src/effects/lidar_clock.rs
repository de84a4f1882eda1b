//! Clock: the lidar's quartz runs fast or slow, and wanders.
//!
//! A rate that stays, and beside it a random way through independent normal values a period apart, joined by straight lines (so the time it
//! says is off by about `wander_us` for as long as one looks). Left out: temperature, PPS, and the hour's wrap, which the packet has anyway.

use std::sync::Arc;

use serde::Deserialize;

use super::settings::{Check, Settings, Stopwatch, Unfit};
use super::{Absorb, Asked, Clock, Effect, Listed};
use crate::random::Source;

/// `[effects.lidar_clock]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
pub struct LidarClockSettings {
    /// How much it runs fast, parts in a million; -1000 to 1000.
    pub drift_ppm: f64,
    /// One standard deviation of its wandering, microseconds.
    pub wander_us: f64,
    /// How long its wandering goes one way, seconds; 10 unless said.
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

/// A clock that is not true.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriftingClock {
    /// Host's nanoseconds to one of the lidar's, less 1.
    slower: f64,
    wander_ns: f64,
    period_ns: f64,
    random: Source,
}

impl DriftingClock {
    /// What the scene file calls it.
    pub const NAME: &'static str = "lidar_clock";

    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`Unfit`] for numbers out of their range, and for wandering so quick that time could run back.
    pub fn new(settings: &LidarClockSettings, seed: u64) -> Result<Self, Unfit> {
        let check = Check(Self::NAME);
        let ppm = check.within("drift_ppm", settings.drift_ppm, -1e3..=1e3)?;
        let period_s = check.within("wander_period_s", settings.wander_period_s, 1e-3..=1e6)?;
        // A draw is within 8.6 standard deviations.
        let most_us = period_s * 1e6 / 40.0;
        Ok(Self {
            slower: 1.0 / (1.0 + ppm * 1e-6) - 1.0,
            wander_ns: 1e3 * check.within("wander_us", settings.wander_us, 0.0..=most_us)?,
            period_ns: period_s * 1e9,
            random: Source::new(seed, Self::NAME),
        })
    }

    /// How far it has wandered, nanoseconds; nothing at the start.
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

impl Settings for LidarClockSettings {
    fn ask(&self, seed: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Arc::new(DriftingClock::new(self, seed)?);
        asked.firings.clock.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for DriftingClock {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn why_idle(&self) -> &'static str {
        "it neither drifts nor wanders"
    }
}

impl Absorb for DriftingClock {}

impl Clock for DriftingClock {
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
    fn a_fast_clock_shows_more_than_has_passed() {
        let settings = LidarClockSettings {
            drift_ppm: 12.0,
            ..LidarClockSettings::default()
        };
        let clock = DriftingClock::new(&settings, 1).unwrap();
        assert_eq!(clock.host_ns(0), 0);
        // 12 ppm of 100 s are 1.2 ms, less 12 ppm of that.
        assert_eq!(clock.host_ns(100_000_000_000), 99_998_800_014);
    }

    #[test]
    fn time_wanders_but_never_back() {
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
        // Between two draws the mean square of a line is 2/3 of theirs.
        assert!((square.sqrt() / 250.0 / (2.0_f64 / 3.0).sqrt() - 1.0).abs() < 0.1);
        let quick = LidarClockSettings {
            wander_us: 251.0,
            ..settings
        };
        assert!(DriftingClock::new(&quick, 3).is_err());
    }
}
