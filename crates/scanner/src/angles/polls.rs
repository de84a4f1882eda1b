//! Shaft samples to angle samples. Samples latched at SYNC use the drive's own time (`latched`);
//! polled ones are at the middle of request and answer, and slow polls are dropped where they are
//! not needed.
//!
//! A slow poll was delayed on one side or the other, and its middle may be off by half of the
//! excess. In steady motion its neighbours determine the angle better. On a ramp they may not: a
//! slow poll stays if the line across the gap would be worse than the poll.

use std::collections::VecDeque;

use drive::ShaftSample;
use units::{Gearing, Span};

use super::{AngleSample, latched};

/// Polls with a round trip above this quantile are slow.
const QUICK_QUANTILE: f64 = 0.9;

/// Angle samples of `samples`, in order of time, and the standard deviation of the error of time
/// that all of them share, nanoseconds; 0 for polls, whose errors are independent.
pub(crate) fn with_shared_sd(samples: &[ShaftSample], gearing: Gearing) -> (Vec<AngleSample>, f64) {
    let (at_sync, polls): (Vec<_>, Vec<_>) =
        samples.iter().partition(|sample| sample.drive_us.is_some());
    let mut angles: Vec<AngleSample> = polls.iter().map(|poll| sample(poll, gearing)).collect();
    let mut shared_ns = 0.0;
    if !at_sync.is_empty() {
        let (streamed, sd_ns) = latched::angle_samples(&at_sync, gearing);
        angles.extend(streamed);
        angles.sort_by_key(|sample| sample.host);
        shared_ns = sd_ns;
    }
    (without_slow(&angles), shared_ns)
}

/// Drops slow polls where they are not needed.
fn without_slow(samples: &[AngleSample]) -> Vec<AngleSample> {
    let (least, limit) = round_trips(samples);
    let quick = |s: &AngleSample| s.bound + s.bound <= limit;
    let mut kept = Vec::with_capacity(samples.len());
    let all: Vec<&AngleSample> = samples.iter().filter(|s| quick(s)).collect();
    let mut passed = 0;
    for this in samples {
        if quick(this) {
            kept.push(*this);
            passed += 1;
            continue;
        }
        let (before, after) = all.split_at(passed);
        let hole = PollGap::between(before.iter().rev().copied(), after.iter().copied());
        // At the ends of a recording there is nothing to replace a poll.
        if hole.is_none_or(|hole| hole.line_error() > hole.poll_error(this, least)) {
            kept.push(*this);
        }
    }
    kept
}

/// A sample in the middle of its poll.
pub(crate) fn sample(poll: &ShaftSample, gearing: Gearing) -> AngleSample {
    let half = poll.answer.saturating_since(poll.request).half();
    AngleSample {
        host: poll.request.saturating_add(half),
        bound: half,
        angle: gearing.angle(poll.position),
    }
}

/// Detects slow polls while they come in, by the round trips of the last ones.
#[derive(Clone, Debug, Default)]
pub(crate) struct SlowPollFilter {
    trips: VecDeque<Span>,
}

/// Round trips that define what is slow.
const REMEMBERED: usize = 64;
/// After such a gap a slow poll is better than none.
const MAX_POLL_GAP: Span = Span::from_millis(20);

impl SlowPollFilter {
    /// Whether to use a sample that comes after `newest`.
    pub(crate) fn accepts(&mut self, sample: &AngleSample, newest: Option<&AngleSample>) -> bool {
        let trip = sample.bound + sample.bound;
        if self.trips.len() >= REMEMBERED {
            self.trips.pop_front();
        }
        self.trips.push_back(trip);
        let mut sorted: Vec<Span> = self.trips.iter().copied().collect();
        sorted.sort_unstable();
        let rank = (sorted.len() as f64 * QUICK_QUANTILE) as usize;
        sorted.get(rank).is_none_or(|limit| trip <= *limit)
            || newest.is_none_or(|newest| sample.host.saturating_since(newest.host) > MAX_POLL_GAP)
    }
}

/// The motion around an interval without quick polls.
struct PollGap {
    length: Span,
    speed_before: f64,
    speed_after: f64,
}

impl PollGap {
    fn between<'a>(
        mut before: impl Iterator<Item = &'a AngleSample>,
        mut after: impl Iterator<Item = &'a AngleSample>,
    ) -> Option<Self> {
        let (last, last_but_one) = (before.next()?, before.next()?);
        let (first, second) = (after.next()?, after.next()?);
        Some(Self {
            length: first.host.saturating_since(last.host),
            speed_before: speed(last_but_one, last),
            speed_after: speed(first, second),
        })
    }

    /// Distance of a straight line across the gap from motion with an even change of speed: v't^2 /
    /// 8.
    fn line_error(&self) -> f64 {
        (self.speed_after - self.speed_before).abs() * self.length.as_secs_f64() / 8.0
    }

    /// Greatest error of the angle at the middle of the poll.
    fn poll_error(&self, poll: &AngleSample, least: Span) -> f64 {
        let excess = (poll.bound + poll.bound - least).as_secs_f64();
        self.speed_before.abs().max(self.speed_after.abs()) * excess / 2.0
    }
}

/// Degrees per second between two samples; zero at one instant.
fn speed(a: &AngleSample, b: &AngleSample) -> f64 {
    let time = b.host.saturating_since(a.host).as_secs_f64();
    if time > 0.0 {
        (b.angle.0 - a.angle.0) / time
    } else {
        0.0
    }
}

/// The smallest round trip, and the one above which polls are slow.
fn round_trips(samples: &[AngleSample]) -> (Span, Span) {
    let mut trips: Vec<Span> = samples.iter().map(|s| s.bound + s.bound).collect();
    trips.sort_unstable();
    let rank = (trips.len() as f64 * QUICK_QUANTILE) as usize;
    let least = trips.first().copied().unwrap_or(Span::ZERO);
    (least, trips.get(rank).copied().unwrap_or(least))
}

#[cfg(test)]
mod tests {
    use super::*;
    use drive::SampleTrigger;
    use units::{Quadcounts, Stamp};

    fn poll(request_us: i64, round_trip_us: i64) -> ShaftSample {
        ShaftSample {
            request: Stamp::from_nanos(request_us * 1_000),
            answer: Stamp::from_nanos((request_us + round_trip_us) * 1_000),
            position: Quadcounts(-2),
            trigger: SampleTrigger::Request,
            drive_us: None,
        }
    }

    fn gearing() -> Gearing {
        Gearing::new(500, 120, 1).unwrap()
    }

    #[test]
    fn samples_are_at_the_middle_of_their_poll() {
        let (samples, _) = with_shared_sd(&[poll(100, 50)], gearing());
        assert_eq!(samples[0].host.as_nanos(), 125_000);
        assert_eq!(samples[0].bound.as_nanos(), 25_000);
        assert_eq!(samples[0].angle.0, -0.003);
    }

    #[test]
    fn the_slowest_tenth_is_dropped() {
        let polls: Vec<_> = (0..100)
            .map(|i| poll(i * 1_000, if i % 20 == 10 { 5_000 } else { 500 + i }))
            .collect();
        let (samples, _) = with_shared_sd(&polls, gearing());
        assert!(samples.len() >= 90);
        assert!(samples.iter().all(|s| s.bound.as_nanos() < 1_000_000));
    }

    #[test]
    fn slow_polls_on_a_ramp_are_kept_if_better_than_interpolation() {
        let at = |position, poll| ShaftSample {
            position: Quadcounts(position),
            ..poll
        };
        let mut polls: Vec<_> = (0..20).map(|i| at(0, poll(i * 1_000, 500))).collect();
        // From rest to 50 deg/s in 12 ms that hold two slow polls.
        polls.push(at(40, poll(20_500, 3_000)));
        polls.push(at(100, poll(23_500, 8_000)));
        polls.extend((0..20).map(|i| at(200 + 33 * i as i32, poll(31_500 + i * 1_000, 500))));
        let (samples, _) = with_shared_sd(&polls, gearing());
        let kept = |angle: f64| samples.iter().any(|s| (s.angle.0 - angle).abs() < 1e-9);
        assert!(kept(0.06) && !kept(0.15), "{samples:?}");
    }

    /// Polls of 40 minutes at 400 Hz, a tenth of them slow. The time grows with their number; with
    /// its square this test would take minutes.
    #[test]
    fn a_million_polls_are_filtered() {
        let slow = |i: i64| i % 11 == 5;
        let polls: Vec<_> = (0..1_000_000)
            .map(|i| poll(i * 2_500, if slow(i) { 2_000 } else { 500 }))
            .collect();
        let (samples, _) = with_shared_sd(&polls, gearing());
        assert_eq!(samples.len(), (0..1_000_000).filter(|i| !slow(*i)).count());
    }

    #[test]
    fn polls_of_equal_round_trip_are_all_kept() {
        let polls: Vec<_> = (0..10).map(|i| poll(i * 1_000, 500)).collect();
        assert_eq!(with_shared_sd(&polls, gearing()).0.len(), 10);
        assert!(with_shared_sd(&[], gearing()).0.is_empty());
    }
}
