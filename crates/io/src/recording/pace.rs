//! Records at their true times: each is given when it is due by its own time stamp, so that what
//! listens sees the devices' rhythm, whatever packet rate the sensor had.
//!
//! A long silence in a recording is announced and not slept through; so is a clock that was set
//! back in it. A listener that falls behind gets the next records at once until it has caught up,
//! unless it was behind by more than the same limit: then the rhythm starts anew from there.
//! Deliberately absent: changing records, or their order.

use std::io::Read;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use protocol::record::Record;
use units::{Host, Span, Stamp};

use super::{Recording, RecordingError};

/// How soon a stop is noticed.
const STOP_INTERVAL: Span = Span::from_millis(20);
/// Factors beyond these make no sense of a recording of microseconds and hours.
const FACTORS: std::ops::RangeInclusive<f64> = 1e-3..=1e3;

/// What time is told and spent by; virtual in tests.
pub trait Timer {
    /// The time now, from any origin; never runs back.
    fn now(&mut self) -> Stamp<Host>;
    /// Lets `span` pass, or a little more; never negative.
    fn sleep(&mut self, span: Span);
}

/// The machine's monotonic clock.
#[derive(Clone, Copy, Debug)]
pub struct SteadyTimer {
    begin: Instant,
}

impl Default for SteadyTimer {
    /// Counts from now.
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
        std::thread::sleep(Duration::from_nanos(
            u64::try_from(span.as_nanos()).unwrap_or(0),
        ));
    }
}

/// A pace that cannot be kept.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PaceError {
    /// Not a factor.
    #[error("pace: expected a factor of 0.001 to 1000, got {got}")]
    Factor {
        /// What was given.
        got: f64,
    },
}

/// Why the rhythm started anew with a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gap {
    /// The recording is silent for this long before it. Not waited for.
    Silence(Span),
    /// Its time is before that of the record in front by this much: the clock was set back, or
    /// recordings were put together.
    Backwards(Span),
    /// The listener was behind by this much: it was stopped, or cannot follow.
    Behind(Span),
}

impl std::fmt::Display for Gap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Silence(span) => write!(
                f,
                "nothing was recorded for {:.1} s; going on at once",
                span.as_secs_f64()
            ),
            Self::Backwards(span) => write!(
                f,
                "the recording's time goes back by {:.1} s",
                span.as_secs_f64()
            ),
            Self::Behind(span) => write!(
                f,
                "{:.1} s behind the recording's pace; going on from here",
                span.as_secs_f64()
            ),
        }
    }
}

/// How the wait for a record ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// It is due.
    Due,
    /// It is due, and with it the rhythm starts anew.
    Anew(Gap),
    /// The flag said stop.
    Stopped,
}

/// Keeps the pace of one recording.
#[derive(Clone, Debug)]
pub struct Pacer<T = SteadyTimer> {
    timer: T,
    factor: f64,
    limit: Span,
    /// A recorded time, and when that was due.
    anchor: Option<(Stamp<Host>, Stamp<Host>)>,
    last: Stamp<Host>,
    worst_late: Span,
    skipped: Span,
}

impl Pacer {
    /// `factor` times as fast as recorded; silences that would take longer than `limit` are
    /// skipped.
    ///
    /// # Errors
    /// [`PaceError::Factor`] outside 0.001 to 1000.
    pub fn new(factor: f64, limit: Span) -> Result<Self, PaceError> {
        Self::with_timer(factor, limit, SteadyTimer::default())
    }
}

impl<T: Timer> Pacer<T> {
    /// As [`Pacer::new`], by another clock.
    ///
    /// # Errors
    /// As [`Pacer::new`].
    pub fn with_timer(factor: f64, limit: Span, timer: T) -> Result<Self, PaceError> {
        if !FACTORS.contains(&factor) {
            return Err(PaceError::Factor { got: factor });
        }
        Ok(Self {
            timer,
            factor,
            limit,
            anchor: None,
            last: Stamp::from_nanos(0),
            worst_late: Span::from_nanos(0),
            skipped: Span::from_nanos(0),
        })
    }

    /// Waits until the record of time `host` is due; looks at `stop` every 20 ms at least.
    pub fn wait(&mut self, host: Stamp<Host>, stop: &AtomicBool) -> Turn {
        let now = self.timer.now();
        let last = std::mem::replace(&mut self.last, host);
        let Some((recorded, real)) = self.anchor else {
            self.anchor = Some((host, now));
            return stopped_or(stop, Turn::Due);
        };
        let due = real.saturating_add(self.played(host.saturating_since(recorded)));
        if let Some(gap) = self.gap(host.saturating_since(last), due, now) {
            self.anchor = Some((host, now));
            if let Gap::Silence(span) = gap {
                self.skipped =
                    Span::from_nanos(self.skipped.as_nanos().saturating_add(span.as_nanos()));
            }
            return stopped_or(stop, Turn::Anew(gap));
        }
        let late = self.sleep_until(due, now, stop);
        self.worst_late = self.worst_late.max(late);
        stopped_or(stop, Turn::Due)
    }

    /// The latest that a record was given after it was due. Records that come out of order in the
    /// file count too.
    #[must_use]
    pub fn worst_late(&self) -> Span {
        self.worst_late
    }

    /// Recorded time that was skipped in silences.
    #[must_use]
    pub fn skipped(&self) -> Span {
        self.skipped
    }

    /// How long a recorded span takes.
    fn played(&self, span: Span) -> Span {
        // Saturates, and is exact to the nanosecond for recordings of up to three months.
        Span::from_nanos((span.as_nanos() as f64 / self.factor) as i64)
    }

    fn gap(&self, step: Span, due: Stamp<Host>, now: Stamp<Host>) -> Option<Gap> {
        let behind = now.saturating_since(due);
        if self.played(step) > self.limit {
            Some(Gap::Silence(step))
        } else if self.played(step) < Span::from_nanos(-self.limit.as_nanos()) {
            Some(Gap::Backwards(Span::from_nanos(
                step.as_nanos().saturating_neg(),
            )))
        } else {
            (behind > self.limit).then_some(Gap::Behind(behind))
        }
    }

    /// How late it is then.
    fn sleep_until(&mut self, due: Stamp<Host>, mut now: Stamp<Host>, stop: &AtomicBool) -> Span {
        while now < due && !stop.load(Ordering::Acquire) {
            self.timer
                .sleep(due.saturating_since(now).min(STOP_INTERVAL));
            now = self.timer.now();
        }
        now.saturating_since(due)
    }
}

fn stopped_or(stop: &AtomicBool, turn: Turn) -> Turn {
    if stop.load(Ordering::Acquire) {
        Turn::Stopped
    } else {
        turn
    }
}

/// A recording whose records come when they are due.
#[derive(Debug)]
pub struct Paced<R, T = SteadyTimer> {
    recording: Recording<R>,
    pacer: Pacer<T>,
}

impl<R: Read, T: Timer> Paced<R, T> {
    /// The first record is due when it is asked for.
    pub fn new(recording: Recording<R>, pacer: Pacer<T>) -> Self {
        Self { recording, pacer }
    }

    /// The next record, when it is due, and why the rhythm started anew, if it did. `None` after
    /// the last, or once `stop` is set.
    ///
    /// # Errors
    /// As [`Recording::next_record`].
    pub fn next_record(
        &mut self,
        stop: &AtomicBool,
    ) -> Result<Option<(Record<'_>, Option<Gap>)>, RecordingError> {
        let Some(record) = self.recording.next_record()? else {
            return Ok(None);
        };
        Ok(match self.pacer.wait(record.host, stop) {
            Turn::Due => Some((record, None)),
            Turn::Anew(gap) => Some((record, Some(gap))),
            Turn::Stopped => None,
        })
    }

    /// The recording, for its counts and its end.
    #[must_use]
    pub fn recording(&self) -> &Recording<R> {
        &self.recording
    }

    /// How the pace was kept.
    #[must_use]
    pub fn pacer(&self) -> &Pacer<T> {
        &self.pacer
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
    fn records_come_at_their_times_and_lateness_does_not_add_up() {
        for factor in [1.0, 0.25, 40.0] {
            let mut pacer = pacer(factor);
            for n in 0..100_000_i64 {
                let ns = n * 1_327_104; // a VLP-16's packets, single return
                assert_eq!(pacer.wait(at(ns), &GO), Turn::Due);
                let due = (ns as f64 / factor) as i64;
                let late = pacer.timer.now_ns - due;
                assert!((0..=OVER_NS).contains(&late), "packet {n}: {late} ns late");
            }
            assert!(pacer.worst_late().as_nanos() <= OVER_NS);
        }
    }

    #[test]
    fn a_long_silence_is_announced_and_not_slept_through() {
        let mut pacer = pacer(1.0);
        pacer.wait(at(0), &GO);
        assert_eq!(pacer.wait(at(4_900_000_000), &GO), Turn::Due);
        let before = pacer.timer.now_ns;
        assert!(before >= 4_900_000_000, "a short silence is waited for");
        let turn = pacer.wait(at(604_900_000_000), &GO);
        assert_eq!(turn, Turn::Anew(Gap::Silence(Span::from_secs(600))));
        assert_eq!(pacer.timer.now_ns, before);
        assert_eq!(pacer.skipped(), Span::from_secs(600));
        // And the rhythm goes on from there.
        assert_eq!(pacer.wait(at(604_901_000_000), &GO), Turn::Due);
        assert!((1_000_000..=1_000_000 + OVER_NS).contains(&(pacer.timer.now_ns - before)));
    }

    #[test]
    fn what_counts_as_long_is_how_long_it_would_take() {
        let mut pacer = pacer(100.0);
        pacer.wait(at(0), &GO);
        assert_eq!(pacer.wait(at(400_000_000_000), &GO), Turn::Due);
        assert!(pacer.timer.now_ns >= 4_000_000_000);
    }

    #[test]
    fn time_that_goes_back() {
        let mut pacer = pacer(1.0);
        pacer.wait(at(0), &GO);
        pacer.wait(at(2_000_000), &GO);
        let before = pacer.timer.now_ns;
        assert_eq!(pacer.wait(at(1_000_000), &GO), Turn::Due, "out of order");
        assert_eq!(pacer.timer.now_ns, before);
        let turn = pacer.wait(at(-3_599_000_000_000), &GO);
        let back = Span::from_nanos(3_599_001_000_000);
        assert_eq!(turn, Turn::Anew(Gap::Backwards(back)));
        assert_eq!(pacer.wait(at(-3_598_999_000_000), &GO), Turn::Due);
        assert!(pacer.timer.now_ns >= before + 1_000_000);
        // The ends of the range do not overflow.
        pacer.wait(Stamp::from_nanos(i64::MIN), &GO);
        pacer.wait(Stamp::from_nanos(i64::MAX), &GO);
    }

    #[test]
    fn a_listener_that_is_behind_catches_up_or_starts_anew() {
        let mut pacer = pacer(1.0);
        pacer.wait(at(0), &GO);
        pacer.timer.now_ns += 3_000_000_000;
        for ms in [1, 2, 2_900] {
            assert_eq!(pacer.wait(at(ms * 1_000_000), &GO), Turn::Due);
        }
        assert_eq!(pacer.timer.sleeps, [], "it catches up");
        assert_eq!(pacer.worst_late(), Span::from_nanos(2_999_000_000));
        pacer.timer.now_ns += 10_000_000_000;
        let turn = pacer.wait(at(3_000_000_000), &GO);
        assert_eq!(turn, Turn::Anew(Gap::Behind(Span::from_secs(10))));
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
        assert_eq!(pacer.wait(at(0), &timer.1), Turn::Due);
        assert_eq!(pacer.wait(at(4_000_000_000), &timer.1), Turn::Stopped);
        assert_eq!(pacer.wait(at(4_000_000_000), &timer.1), Turn::Stopped);
    }

    #[test]
    fn factors_that_are_none() {
        for got in [0.0, -1.0, f64::INFINITY, 1e-9, 1e9] {
            let error = Pacer::new(got, Span::from_secs(1)).unwrap_err();
            assert_eq!(error, PaceError::Factor { got });
        }
        assert!(Pacer::new(f64::NAN, Span::from_secs(1)).is_err());
    }

    #[test]
    fn the_machines_own_clock_never_lets_a_record_out_early() {
        let begin = Instant::now();
        let mut pacer = Pacer::new(1.0, Span::from_secs(5)).unwrap();
        for ms in [0, 1, 2, 30] {
            assert_eq!(pacer.wait(at(ms * 1_000_000), &GO), Turn::Due);
            assert!(begin.elapsed() >= Duration::from_millis(ms as u64));
        }
    }
}
