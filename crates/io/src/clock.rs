//! The host's clock, read in one place. Two ways and what tells a sleep: [`now`] is the system's
//! time, which the kernel's stamps are of too and whose steps show in the log; [`steady`] never
//! steps, and is what deadlines are kept by. No steering.

use std::sync::OnceLock;
use std::time::{Instant, SystemTime};

use units::{Host, Span, Stamp};

/// Nanoseconds of `CLOCK_REALTIME` now; held at the ends of the range of `i64` nanoseconds (years
/// 1677 and 2262).
#[must_use]
pub fn now() -> Stamp<Host> {
    let ns = match SystemTime::now().duration_since(SystemTime::UNIX_EPOCH) {
        Ok(since) => i64::try_from(since.as_nanos()).unwrap_or(i64::MAX),
        Err(before) => i64::try_from(before.duration().as_nanos()).map_or(i64::MIN, |ns| -ns),
    };
    Stamp::from_nanos(ns)
}

/// The system's time when this was first called, carried on by the monotonic clock: a step of the
/// system time does not move it.
///
/// For deadlines and spans. Once the system time has stepped it is not the time of the log's
/// records.
#[must_use]
pub fn steady() -> Stamp<Host> {
    static BEGIN: OnceLock<(Instant, Stamp<Host>)> = OnceLock::new();
    let (instant, stamp) = *BEGIN.get_or_init(|| (Instant::now(), now()));
    let since = i64::try_from(instant.elapsed().as_nanos()).unwrap_or(i64::MAX);
    stamp.saturating_add(Span::from_nanos(since))
}

/// How long this machine has slept since it was started: what `CLOCK_BOOTTIME` is ahead of
/// `CLOCK_MONOTONIC`. Zero where the system does not tell.
#[must_use]
pub fn suspended() -> Span {
    use nix::time::{ClockId, clock_gettime};
    let read = |clock| {
        let time = clock_gettime(clock).ok()?;
        time.tv_sec()
            .checked_mul(1_000_000_000)?
            .checked_add(time.tv_nsec())
    };
    // In this order, so that what passes between the two readings counts for less than nothing.
    let both = read(ClockId::CLOCK_BOOTTIME).zip(read(ClockId::CLOCK_MONOTONIC));
    Span::from_nanos(both.map_or(0, |(boot, monotonic)| boot.saturating_sub(monotonic).max(0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_agrees_with_the_system_calls_of_another_library() {
        use nix::time::{ClockId, clock_gettime};
        let before = now();
        let time = clock_gettime(ClockId::CLOCK_REALTIME).unwrap();
        let after = now();
        let between = time.tv_sec() * 1_000_000_000 + time.tv_nsec();
        assert!(before.as_nanos() <= between && between <= after.as_nanos());
    }

    #[test]
    fn a_machine_that_is_awake_has_not_slept_in_between() {
        let (first, second) = (suspended(), suspended());
        let between = (second - first).as_nanos().abs();
        assert!(between < 1_000_000_000, "{between} ns");
    }

    #[test]
    fn the_steady_clock_goes_with_the_monotonic_one() {
        let (begin, first) = (Instant::now(), steady());
        let second = steady();
        let elapsed = i64::try_from(begin.elapsed().as_nanos()).unwrap();
        let went = (second - first).as_nanos();
        assert!((0..=elapsed).contains(&went), "{went} of {elapsed} ns");
    }
}
