//! The host's clocks. [`now`] is the system time, like the kernel's receive times; it may step.
//! [`steady`] never steps and is for deadlines. [`suspended`] is the time that the machine slept.

use std::sync::OnceLock;
use std::time::{Instant, SystemTime};

use units::{Host, Span, Stamp};

/// The system time (`CLOCK_REALTIME`), limited to the range of `i64` nanoseconds (years 1677 to
/// 2262).
#[must_use]
pub fn now() -> Stamp<Host> {
    let ns = match SystemTime::now().duration_since(SystemTime::UNIX_EPOCH) {
        Ok(since) => i64::try_from(since.as_nanos()).unwrap_or(i64::MAX),
        Err(before) => i64::try_from(before.duration().as_nanos()).map_or(i64::MIN, |ns| -ns),
    };
    Stamp::from_nanos(ns)
}

/// The system time at the first call, continued by the monotonic clock.
///
/// Steps of the system time do not move it, so it may differ from the times of the log's records.
#[must_use]
pub fn steady() -> Stamp<Host> {
    static BEGIN: OnceLock<(Instant, Stamp<Host>)> = OnceLock::new();
    let (instant, stamp) = *BEGIN.get_or_init(|| (Instant::now(), now()));
    let since = i64::try_from(instant.elapsed().as_nanos()).unwrap_or(i64::MAX);
    stamp.saturating_add(Span::from_nanos(since))
}

/// Time that the machine was suspended since boot: `CLOCK_BOOTTIME` less `CLOCK_MONOTONIC`. Zero if
/// the system has no such clocks.
#[cfg(devices)]
#[must_use]
pub fn suspended() -> Span {
    use nix::time::{ClockId, clock_gettime};
    let read = |clock| {
        let time = clock_gettime(clock).ok()?;
        time.tv_sec()
            .checked_mul(1_000_000_000)?
            .checked_add(time.tv_nsec())
    };
    // In this order, time between the two readings makes the result smaller, never larger.
    let both = read(ClockId::CLOCK_BOOTTIME).zip(read(ClockId::CLOCK_MONOTONIC));
    Span::from_nanos(both.map_or(0, |(boot, monotonic)| boot.saturating_sub(monotonic).max(0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn system_time_agrees_with_clock_gettime() {
        use nix::time::{ClockId, clock_gettime};
        let before = now();
        let time = clock_gettime(ClockId::CLOCK_REALTIME).unwrap();
        let after = now();
        let between = time.tv_sec() * 1_000_000_000 + time.tv_nsec();
        assert!(before.as_nanos() <= between && between <= after.as_nanos());
    }

    #[cfg(devices)]
    #[test]
    fn a_running_machine_is_not_suspended() {
        let (first, second) = (suspended(), suspended());
        let between = (second - first).as_nanos().abs();
        assert!(between < 1_000_000_000, "{between} ns");
    }

    #[test]
    fn the_steady_clock_follows_the_monotonic_clock() {
        let (begin, first) = (Instant::now(), steady());
        let second = steady();
        let elapsed = i64::try_from(begin.elapsed().as_nanos()).unwrap();
        let advanced = (second - first).as_nanos();
        assert!(
            (0..=elapsed).contains(&advanced),
            "{advanced} of {elapsed} ns"
        );
    }
}
