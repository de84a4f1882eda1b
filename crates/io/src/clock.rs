//! The host's clock, read in one place. No steering, no monotonic clock: a step of the system time shows in the log.

use std::time::SystemTime;

use units::{Host, Stamp};

/// Nanoseconds of `CLOCK_REALTIME` now; held at the ends of the range of `i64` nanoseconds (years 1677 and 2262).
#[must_use]
pub fn now() -> Stamp<Host> {
    let ns = match SystemTime::now().duration_since(SystemTime::UNIX_EPOCH) {
        Ok(since) => i64::try_from(since.as_nanos()).unwrap_or(i64::MAX),
        Err(before) => i64::try_from(before.duration().as_nanos()).map_or(i64::MIN, |ns| -ns),
    };
    Stamp::from_nanos(ns)
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
}
