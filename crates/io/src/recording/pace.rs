//! Playback at the recorded rhythm: each record is due at its own time stamp.
//!
//! Long silences and clocks that were set back are reported and skipped. A consumer that is behind
//! gets the next records at once until it has caught up; beyond the same limit, the rhythm restarts
//! at the current record.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use units::{Host, Span, Stamp};

/// Longest time until a stop is noticed.
const STOP_INTERVAL: Span = Span::from_millis(20);
/// Sensible factors: 0.001 plays a millisecond in a second, 1000 a day in 86 s.
const FACTORS: std::ops::RangeInclusive<f64> = 1e-3..=1e3;

/// A clock to wait by; virtual in tests.
pub trait Timer {
    /// The time now, from any origin; never decreases.
    fn now(&mut self) -> Stamp<Host>;
    /// Sleeps for `span` or slightly longer.
    fn sleep(&mut self, span: Span);
}

/// The machine's monotonic clock.
#[derive(Clone, Copy, Debug)]
pub struct SteadyTimer {
    begin: Instant,
}

impl Default for SteadyTimer {
    fn default() -> Self {
        Self {
            begin: Instant::now(),
        }
    }
}

impl Timer for SteadyTimer {
    fn now(&mut self) -> Stamp<Host> {
        Stamp::from_nanos(i64::try_from(self.begin.elapsed().as_nanos()).unwrap_or(i64::MAX))
    }

    fn sleep(&mut self, span: Span) {
        let ns = u64::try_from(span.as_nanos()).unwrap_or(0);
        std::thread::sleep(Duration::from_nanos(ns));
    }
}

/// A factor outside 0.001 to 1000.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("pace: expected a factor of 0.001 to 1000, got {got}")]
#[non_exhaustive]
pub struct PaceError {
    /// The given factor.
    pub got: f64,
}

/// Reason for which the rhythm restarts at a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gap {
    /// Silence before the record, which is skipped.
    Silence(Span),
    /// Step back in time: the clock was set, or recordings were joined.
    Backwards(Span),
    /// Delay of the consumer: it was stopped, or is too slow.
    Behind(Span),
}

/// Result of waiting for a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wait {
    /// The record is due.
    Due,
    /// The record is due, and the rhythm restarts with it.
    Restarted(Gap),
    /// The stop flag was set.
    Stopped,
}

/// Keeps the pace of one recording.
#[derive(Clone, Debug)]
pub struct Pacer<T = SteadyTimer> {
    timer: T,
    factor: f64,
    limit: Span,
    /// A recorded time, and the time at which it was due.
    anchor: Option<(Stamp<Host>, Stamp<Host>)>,
    last: Stamp<Host>,
}

impl Pacer {
    /// Plays `factor` times as fast as recorded. Silences that would take longer than `limit` are
    /// skipped.
    ///
    /// # Errors
    /// [`PaceError`] outside 0.001 to 1000.
    pub fn new(factor: f64, limit: Span) -> Result<Self, PaceError> {
        Self::with_timer(factor, limit, SteadyTimer::default())
    }
}

impl<T: Timer> Pacer<T> {
    fn with_timer(factor: f64, limit: Span, timer: T) -> Result<Self, PaceError> {
        if !FACTORS.contains(&factor) {
            return Err(PaceError { got: factor });
        }
        Ok(Self {
            timer,
            factor,
            limit,
            anchor: None,
            last: Stamp::from_nanos(0),
        })
    }

    /// Waits until the record of time `host` is due. Reads `stop` every 20 ms.
    pub fn wait(&mut self, host: Stamp<Host>, stop: &AtomicBool) -> Wait {
        let mut now = self.timer.now();
        let last = std::mem::replace(&mut self.last, host);
        let mut result = Wait::Due;
        match self.anchor {
            None => self.anchor = Some((host, now)),
            Some((recorded, real)) => {
                let due = real.saturating_add(self.played(host.saturating_since(recorded)));
                if let Some(gap) = self.gap(host.saturating_since(last), due, now) {
                    self.anchor = Some((host, now));
                    result = Wait::Restarted(gap);
                } else {
                    while now < due && !stop.load(Ordering::Acquire) {
                        let left = due.saturating_since(now);
                        self.timer.sleep(left.min(STOP_INTERVAL));
                        now = self.timer.now();
                    }
                }
            }
        }
        match stop.load(Ordering::Acquire) {
            true => Wait::Stopped,
            false => result,
        }
    }

    /// Playing time of a recorded span: exact to the nanosecond for up to three months.
    fn played(&self, span: Span) -> Span {
        Span::from_nanos((span.as_nanos() as f64 / self.factor) as i64)
    }

    fn gap(&self, step: Span, due: Stamp<Host>, now: Stamp<Host>) -> Option<Gap> {
        let behind = now.saturating_since(due);
        let played = self.played(step);
        if played > self.limit {
            Some(Gap::Silence(step))
        } else if played < Span::from_nanos(-self.limit.as_nanos()) {
            let back_ns = step.as_nanos().saturating_neg();
            Some(Gap::Backwards(Span::from_nanos(back_ns)))
        } else {
            (behind > self.limit).then_some(Gap::Behind(behind))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oversleeps by a third of a millisecond, as a busy machine does.
    #[derive(Default)]
    struct Virtual {
        now_ns: i64,
        sleeps: Vec<i64>,
    }

    const OVER_NS: i64 = 333_333;

    impl Timer for Virtual {
        fn now(&mut self) -> Stamp<Host> {
            Stamp::from_nanos(self.now_ns)
        }
        fn sleep(&mut self, span: Span) {
            assert!((0..=STOP_INTERVAL.as_nanos()).contains(&span.as_nanos()));
            self.sleeps.push(span.as_nanos());
            self.now_ns += span.as_nanos() + OVER_NS;
        }
    }

    static GO: AtomicBool = AtomicBool::new(false);
    const START_NS: i64 = 1_700_000_000_000_000_000;

    fn pacer(factor: f64) -> Pacer<Virtual> {
        Pacer::with_timer(factor, Span::from_secs(5), Virtual::default()).unwrap()
    }

    fn at(ns: i64) -> Stamp<Host> {
        Stamp::from_nanos(START_NS + ns)
    }

    #[test]
    fn records_come_at_their_times_without_accumulated_delay() {
        for factor in [1.0, 0.25, 40.0] {
            let mut pacer = pacer(factor);
            for n in 0..100_000_i64 {
                let ns = n * 1_327_104; // a VLP-16's packets, single return
                assert_eq!(pacer.wait(at(ns), &GO), Wait::Due);
                let due = (ns as f64 / factor) as i64;
                let late = pacer.timer.now_ns - due;
                assert!((0..=OVER_NS).contains(&late), "packet {n}: {late} ns late");
            }
        }
    }

    #[test]
    fn long_silences_are_reported_and_skipped() {
        let mut pacer = pacer(1.0);
        pacer.wait(at(0), &GO);
        assert_eq!(pacer.wait(at(4_900_000_000), &GO), Wait::Due);
        let before = pacer.timer.now_ns;
        assert!(before >= 4_900_000_000, "short silences are played");
        let wait = pacer.wait(at(604_900_000_000), &GO);
        assert_eq!(wait, Wait::Restarted(Gap::Silence(Span::from_secs(600))));
        assert_eq!(pacer.timer.now_ns, before);
        // The rhythm continues from there.
        assert_eq!(pacer.wait(at(604_901_000_000), &GO), Wait::Due);
        assert!((1_000_000..=1_000_000 + OVER_NS).contains(&(pacer.timer.now_ns - before)));
    }

    #[test]
    fn silences_are_measured_in_playing_time() {
        let mut pacer = pacer(100.0);
        pacer.wait(at(0), &GO);
        assert_eq!(pacer.wait(at(400_000_000_000), &GO), Wait::Due);
        assert!(pacer.timer.now_ns >= 4_000_000_000);
    }

    #[test]
    fn recorded_time_may_step_back() {
        let mut pacer = pacer(1.0);
        pacer.wait(at(0), &GO);
        pacer.wait(at(2_000_000), &GO);
        let before = pacer.timer.now_ns;
        assert_eq!(pacer.wait(at(1_000_000), &GO), Wait::Due, "out of order");
        assert_eq!(pacer.timer.now_ns, before);
        let wait = pacer.wait(at(-3_599_000_000_000), &GO);
        let back = Span::from_nanos(3_599_001_000_000);
        assert_eq!(wait, Wait::Restarted(Gap::Backwards(back)));
        assert_eq!(pacer.wait(at(-3_598_999_000_000), &GO), Wait::Due);
        assert!(pacer.timer.now_ns >= before + 1_000_000);
        // The ends of the range do not overflow.
        pacer.wait(Stamp::from_nanos(i64::MIN), &GO);
        pacer.wait(Stamp::from_nanos(i64::MAX), &GO);
    }

    #[test]
    fn a_consumer_that_is_behind_catches_up_or_restarts() {
        let mut pacer = pacer(1.0);
        pacer.wait(at(0), &GO);
        pacer.timer.now_ns += 3_000_000_000;
        for ms in [1, 2, 2_900] {
            assert_eq!(pacer.wait(at(ms * 1_000_000), &GO), Wait::Due);
        }
        assert_eq!(pacer.timer.sleeps, [], "it catches up");
        pacer.timer.now_ns += 10_000_000_000;
        let wait = pacer.wait(at(3_000_000_000), &GO);
        assert_eq!(wait, Wait::Restarted(Gap::Behind(Span::from_secs(10))));
        pacer.wait(at(3_010_000_000), &GO);
        assert_eq!(pacer.timer.sleeps, [10_000_000]);
    }

    #[test]
    fn a_stop_ends_the_wait() {
        struct StopIn(i64, AtomicBool);
        impl Timer for &StopIn {
            fn now(&mut self) -> Stamp<Host> {
                Stamp::from_nanos(0)
            }
            fn sleep(&mut self, span: Span) {
                assert!(span.as_nanos() <= self.0);
                self.1.store(true, Ordering::Release);
            }
        }
        let timer = StopIn(STOP_INTERVAL.as_nanos(), AtomicBool::new(false));
        let mut pacer = Pacer::with_timer(1.0, Span::from_secs(5), &timer).unwrap();
        assert_eq!(pacer.wait(at(0), &timer.1), Wait::Due);
        assert_eq!(pacer.wait(at(4_000_000_000), &timer.1), Wait::Stopped);
        assert_eq!(pacer.wait(at(4_000_000_000), &timer.1), Wait::Stopped);
    }

    #[test]
    fn factors_out_of_range_are_refused() {
        for got in [0.0, -1.0, f64::INFINITY, 1e-9, 1e9] {
            let error = Pacer::new(got, Span::from_secs(1)).unwrap_err();
            assert_eq!(error, PaceError { got });
        }
        assert!(Pacer::new(f64::NAN, Span::from_secs(1)).is_err());
    }

    #[test]
    fn records_are_never_early_by_the_monotonic_clock() {
        let begin = Instant::now();
        let mut pacer = Pacer::new(1.0, Span::from_secs(5)).unwrap();
        for ms in [0, 1, 2, 30] {
            assert_eq!(pacer.wait(at(ms * 1_000_000), &GO), Wait::Due);
            assert!(begin.elapsed() >= Duration::from_millis(ms as u64));
        }
    }
}
