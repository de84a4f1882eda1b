//! The lidar's free-running clock against the host's, which is true time in the simulator.
//!
//! The rate is constant: device time = device time at the start + (1 + drift) x host time since the
//! start.

use units::{Host, Span, Stamp};

use crate::effects::{ClockEffect, Effect};

/// Nanoseconds of an hour, the period of the device's stamps.
pub(crate) const HOUR_NS: i64 = 3_600_000_000_000;

/// Largest drift that is simulated, parts per million: a hundred times that of oscillators.
const MAX_DRIFT_PPM: f64 = 10_000.0;

/// The lidar's clock. `elapsed` is device nanoseconds since the start throughout.
#[derive(Clone, Debug)]
pub(crate) struct LidarClock {
    start: Stamp<Host>,
    /// Device time past the hour at the start.
    at_start_ns: i64,
    drift: f64,
}

impl LidarClock {
    /// A clock that shows `at_start_us` past the hour at `start`. A drift that is not a number is
    /// 0.
    pub fn new(start: Stamp<Host>, at_start_us: u32, drift_ppm: f64) -> Self {
        let drift_ppm = if drift_ppm.is_nan() { 0.0 } else { drift_ppm };
        Self {
            start,
            at_start_ns: i64::from(at_start_us) * 1_000 % HOUR_NS,
            drift: drift_ppm.clamp(-MAX_DRIFT_PPM, MAX_DRIFT_PPM) * 1e-6,
        }
    }

    /// Host time at a device time, to the nearest nanosecond.
    pub fn host(&self, elapsed_ns: i64) -> Stamp<Host> {
        let since = Span::from_nanos(self.host_ns(elapsed_ns));
        self.start.saturating_add(since)
    }

    /// Device time at a host time, to the nearest nanosecond.
    pub fn elapsed(&self, host: Stamp<Host>) -> i64 {
        let since = host.saturating_since(self.start).as_nanos();
        since.saturating_add((since as f64 * self.drift).round() as i64)
    }

    /// The device's stamp: whole microseconds past the hour, rounded down.
    pub fn stamp_us(&self, elapsed_ns: i64) -> u32 {
        let past_the_hour = self
            .at_start_ns
            .saturating_add(elapsed_ns)
            .rem_euclid(HOUR_NS);
        // At most 3.6e9, so it fits.
        u32::try_from(past_the_hour / 1_000).unwrap_or_default()
    }

    /// Device time of a stamp modulo an hour, up to `slack_ns` early, in a run of `run_ns`.
    ///
    /// Where the run passes the same minute of several hours, the hour is that of a stamp unwrapped
    /// to the nearest hour of the host's time, within the run.
    pub fn elapsed_of_stamp(&self, device_ns: i64, slack_ns: i64, run_ns: i64) -> i64 {
        let at_start = self.at_start_ns;
        let within = |ns: i64| (ns % HOUR_NS).rem_euclid(HOUR_NS);
        let first = within(within(device_ns) - at_start + slack_ns) - slack_ns;
        let half = HOUR_NS / 2;
        // The device's clock at the start, unwrapped to the nearest hour of the host's.
        let host = self.start.as_nanos();
        let unwrapped = host.saturating_add(within(at_start - within(host) + half) - half);
        let expected = device_ns.saturating_sub(unwrapped);
        let hour = expected
            .saturating_sub(first)
            .saturating_add(half)
            .div_euclid(HOUR_NS);
        let last = (run_ns - first).div_euclid(HOUR_NS).max(0);
        first + hour.clamp(0, last) * HOUR_NS
    }
}

impl Effect for LidarClock {
    fn name(&self) -> &'static str {
        "clock"
    }
}

impl ClockEffect for LidarClock {
    /// Only the small difference of the clocks is computed in floating point, so years stay exact.
    #[inline]
    fn host_ns(&self, elapsed_ns: i64) -> i64 {
        let ahead = (elapsed_ns as f64 * (self.drift / (1.0 + self.drift))).round() as i64;
        elapsed_ns.saturating_sub(ahead)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const START: i64 = 1_790_000_000_123_456_789;

    fn clock(at_start_us: u32, drift_ppm: f64) -> LidarClock {
        LidarClock::new(Stamp::from_nanos(START), at_start_us, drift_ppm)
    }

    #[test]
    fn a_fast_clock_wraps_early() {
        let clock = clock(0, 50.0);
        let early = clock.host(HOUR_NS) - Stamp::from_nanos(START + HOUR_NS);
        // 50 ppm of an hour is 180 ms, minus 50 ppm of that.
        assert_eq!(early.as_nanos(), -179_991_000);
        assert_eq!(clock.host(0).as_nanos(), START);
    }

    #[test]
    fn stamps_wrap_at_the_hour_and_truncate_nanoseconds() {
        let clock = clock(3_599_999_999, 0.0);
        assert_eq!(clock.stamp_us(0), 3_599_999_999);
        assert_eq!(clock.stamp_us(999), 3_599_999_999);
        assert_eq!(clock.stamp_us(1_000), 0);
        assert_eq!(clock.stamp_us(HOUR_NS + 1_999), 0);
        assert_eq!(clock.stamp_us(2_000), 1);
    }

    #[test]
    fn invalid_drifts_leave_a_running_clock() {
        for drift in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e6] {
            let clock = clock(0, drift);
            let second = clock.host(1_000_000_000).as_nanos() - START;
            assert!((985_000_000..=1_015_000_000).contains(&second), "{drift}");
        }
    }

    #[test]
    fn the_ends_of_the_range_do_not_overflow() {
        let clock = clock(1, 100.0);
        for ns in [i64::MIN, -1, 0, 1, i64::MAX] {
            let _ = clock.host(ns);
            let _ = clock.elapsed(Stamp::from_nanos(ns));
            let _ = clock.stamp_us(ns);
            let elapsed = clock.elapsed_of_stamp(ns, 1_000, 10 * HOUR_NS);
            assert!((-1_000..=10 * HOUR_NS).contains(&elapsed), "{ns} {elapsed}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        #[test]
        fn host_time_round_trips_within_a_nanosecond(elapsed in 0..100 * HOUR_NS, drift in -1000.0..1000.0) {
            let clock = clock(17, drift);
            prop_assert!((clock.elapsed(clock.host(elapsed)) - elapsed).abs() <= 1);
        }

        #[test]
        fn a_stamp_is_found_in_its_own_hour(
            at_start_us in 0..3_600_000_000_u32, elapsed in 0..5 * HOUR_NS, day in 0..3_i64, drift in -100.0..100.0,
        ) {
            let start = Stamp::<Host>::from_nanos(START + day * 24 * HOUR_NS);
            let clock = LidarClock::new(start, at_start_us, drift);
            // A receiver starts at the hour nearest to the host's time and counts from there.
            let half = HOUR_NS / 2;
            let at_start = i64::from(at_start_us) * 1_000;
            let hours = (start.as_nanos() - at_start + half).div_euclid(HOUR_NS);
            let device = at_start + elapsed + hours * HOUR_NS;
            let quantised = device - device.rem_euclid(1_000);
            let found = clock.elapsed_of_stamp(quantised, 27_648, 5 * HOUR_NS);
            prop_assert!((0..1_000).contains(&(elapsed - found)), "{found} for {elapsed}");
            // In a run shorter than an hour the stamp alone is unambiguous.
            let short = elapsed % (HOUR_NS - 30_000);
            let bare = (at_start + short).rem_euclid(HOUR_NS);
            prop_assert_eq!(clock.elapsed_of_stamp(bare, 27_648, HOUR_NS - 30_000), short);
        }
    }
}
