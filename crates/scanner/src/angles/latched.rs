//! Positions latched at SYNC, with the drive's own time, to angle samples.
//!
//! The drive latches position (6064) and time (1013) together, after the SYNC was sent and before
//! the frame that carries them arrived. Every pair thus bounds the drive's clock on both sides. The
//! upper envelope of the SYNC times and the lower one of the arrivals enclose the clock, each free
//! of the delays of single frames. The clock is taken in the middle, as a bus is equally fast both
//! ways, and half of the distance is the bound. The drive's time wraps after 71 minutes and
//! restarts with the drive; each run between two starts has its own clock.

use drive::ShaftSample;
use units::{Drive, Gearing, Host, Span, Stamp};

use super::AngleSample;
use crate::clock::{Arrival, DeviceClock};

/// With fewer pairs no clock is fitted; the samples are at the middle of SYNC and arrival, like
/// polls.
const FEWEST: usize = 8;
/// Greatest difference of the clocks over a pause, and its growth per pause, before the drive
/// counts as restarted.
const RESTART: Span = Span::from_secs(1);
const RESTART_SHARE: i64 = 1_000;
/// One in so many samples is quicker than what is taken for the quickest: those with a wrong SYNC.
const QUICK_SHARE: usize = 20;
/// Quantisation of the drive's time.
const QUANTUM: Span = Span::from_micros(1);

/// A sample with the drive's time, nanoseconds since the beginning of its run.
#[derive(Clone, Copy, Debug)]
struct LatchedSample {
    sample: ShaftSample,
    device_ns: i64,
}

/// Angle samples of samples latched at SYNC, in order, and the standard deviation of their clock,
/// nanoseconds: an error that they share and no fit reduces. Samples without the drive's time are
/// ignored.
pub(crate) fn angle_samples(stream: &[ShaftSample], gearing: Gearing) -> (Vec<AngleSample>, f64) {
    let mut samples = Vec::with_capacity(stream.len());
    let mut square_ns2 = 0.0;
    for run in runs(stream) {
        let clock = (run.len() >= FEWEST)
            .then(|| TwoSidedClock::fit(&run))
            .flatten();
        samples.extend(run.iter().map(|latched| {
            if let Some(clock) = &clock {
                square_ns2 += clock.sd_ns(latched.device_ns).powi(2);
            }
            let (early, late) = match &clock {
                Some(clock) => clock.bounds(latched.device_ns),
                None => (latched.sample.request, latched.sample.answer),
            };
            let half = late.saturating_since(early).half();
            AngleSample {
                host: early.saturating_add(half),
                bound: half.max(-half) + QUANTUM,
                angle: gearing.angle(latched.sample.position),
            }
        }));
    }
    let sd_ns = f64::sqrt(square_ns2 / samples.len().max(1) as f64);
    (samples, sd_ns)
}

/// The samples of each run of the drive's clock, with unwrapped times.
fn runs(stream: &[ShaftSample]) -> Vec<Vec<LatchedSample>> {
    let mut runs: Vec<Vec<LatchedSample>> = Vec::new();
    let mut last: Option<(u32, LatchedSample)> = None;
    for sample in stream {
        let Some(drive_us) = sample.drive_us else {
            continue;
        };
        let went_on = last.and_then(|(before_us, before)| {
            let host = sample.answer.saturating_since(before.sample.answer);
            Some(before.device_ns + went(before_us, drive_us, host)?.as_nanos())
        });
        let latched = LatchedSample {
            sample: *sample,
            device_ns: went_on.unwrap_or(0),
        };
        match runs.last_mut() {
            Some(run) if went_on.is_some() => run.push(latched),
            _ => runs.push(vec![latched]),
        }
        last = Some((drive_us, latched));
    }
    runs
}

/// Advance of the drive's clock while the host's advances by `host`; `None` if the drive restarted.
fn went(before_us: u32, after_us: u32, host: Span) -> Option<Span> {
    const WRAP_US: i64 = 1 << 32;
    let least = i64::from(after_us) - i64::from(before_us);
    let host_us = host.as_nanos() / 1_000;
    let wraps = (host_us - least + WRAP_US / 2).div_euclid(WRAP_US);
    let device = Span::from_micros(least.checked_add(wraps.checked_mul(WRAP_US)?)?);
    let apart = (device - host).as_nanos().abs();
    let allowed = RESTART.as_nanos() + (host.as_nanos() / RESTART_SHARE).abs();
    (apart <= allowed).then_some(device)
}

/// The drive's clock, from both sides; the upper envelope is the lower one of negated times.
struct TwoSidedClock {
    early: DeviceClock<Drive>,
    late: DeviceClock<Drive>,
}

impl TwoSidedClock {
    fn fit(run: &[LatchedSample]) -> Option<Self> {
        let arrivals: Vec<Arrival<Drive>> = run
            .iter()
            .map(|latched| Arrival {
                device: Stamp::from_nanos(latched.device_ns),
                host: latched.sample.answer,
            })
            .collect();
        let late = DeviceClock::fit(&arrivals)?;
        // After lost frames, samples may long be paired with the SYNC before their own, a whole
        // period early, which would tilt the envelope; after a step of the host's clock a few are
        // paired with a later one. Both are left out, and so are those whose SYNC was as late.
        let ahead = |latched: &LatchedSample| {
            let taken = late.host(Stamp::from_nanos(latched.device_ns));
            taken.saturating_since(latched.sample.request)
        };
        let mut all: Vec<Span> = run.iter().map(ahead).collect();
        // No sample is before its SYNC.
        all.retain(|ahead| *ahead >= Span::ZERO);
        all.sort_unstable();
        let quick = *all.get(all.len() / QUICK_SHARE)?;
        let half = median_interval(run).half();
        let arrivals: Vec<Arrival<Drive>> = run
            .iter()
            .filter(|latched| {
                let ahead = ahead(latched);
                let beyond = ahead.saturating_sub(quick);
                ahead >= Span::ZERO && -half <= beyond && beyond <= half
            })
            .map(|latched| Arrival {
                device: backwards(latched.device_ns),
                host: backwards(latched.sample.request.as_nanos()),
            })
            .collect();
        let early = DeviceClock::fit(&arrivals)?;
        Some(Self { early, late })
    }

    /// Standard deviation of the middle between both sides, nanoseconds, without the asymmetry of
    /// the smallest delays.
    fn sd_ns(&self, device_ns: i64) -> f64 {
        let early = self.early.sd_near_ns(backwards(device_ns), None);
        let late = self.late.sd_near_ns(Stamp::from_nanos(device_ns), None);
        0.5 * early.hypot(late)
    }

    /// Host times that enclose the drive's time `device_ns`.
    fn bounds(&self, device_ns: i64) -> (Stamp<Host>, Stamp<Host>) {
        let early = self.early.host(backwards(device_ns));
        let late = self.late.host(Stamp::from_nanos(device_ns));
        (backwards(early.as_nanos()), late)
    }
}

/// Median interval of the samples.
fn median_interval(run: &[LatchedSample]) -> Span {
    let pairs = run.windows(2).filter_map(|pair| match pair {
        [a, b] => Some(b.device_ns.saturating_sub(a.device_ns)),
        _ => None,
    });
    let mut steps: Vec<i64> = pairs.collect();
    steps.sort_unstable();
    Span::from_nanos(steps.get(steps.len() / 2).copied().unwrap_or(0))
}

fn backwards<C>(ns: i64) -> Stamp<C> {
    Stamp::from_nanos(ns.saturating_neg())
}

#[cfg(test)]
mod tests {
    use units::Quadcounts;

    use super::*;

    /// 2100-01-01, when nanoseconds no longer fit the 53 bits of a double.
    const EPOCH: i64 = 4_102_444_800_000_000_000;

    fn gearing() -> Gearing {
        Gearing::new(500, 120, 1).unwrap()
    }

    /// A stream at 1 kHz on a drive whose clock is 60 ppm slow and reads `first_us` at the start;
    /// the SYNC takes `there` and the answer `back` microseconds in sample i. Position i.
    fn stream(
        count: i64,
        first_us: i64,
        there: impl Fn(i64) -> i64,
        back: impl Fn(i64) -> i64,
    ) -> (Vec<ShaftSample>, Vec<i64>) {
        let mut truth = Vec::new();
        let samples = (0..count).map(|i| {
            let request = EPOCH + i * 1_000_000;
            let taken = request + there(i) * 1_000;
            truth.push(taken);
            let drive_us = first_us + (taken - EPOCH) / 1_000 * 999_940 / 1_000_000;
            ShaftSample {
                request: Stamp::from_nanos(request),
                answer: Stamp::from_nanos(taken + back(i) * 1_000),
                position: Quadcounts(i as i32),
                trigger: drive::SampleTrigger::Sync,
                drive_us: Some(drive_us as u32),
            }
        });
        (samples.collect(), truth)
    }

    fn worst_us(stream: &[ShaftSample], truth: &[i64]) -> f64 {
        let (samples, _) = angle_samples(stream, gearing());
        assert_eq!(samples.len(), truth.len());
        let off = samples.iter().zip(truth).map(|(sample, truth)| {
            let off = sample.host.as_nanos() - truth;
            let bound = sample.bound.as_nanos();
            assert!(off.abs() <= bound + 1_500, "{off} ns off, {bound} ns bound");
            off.abs() as f64 / 1e3
        });
        off.fold(0.0, f64::max)
    }

    #[test]
    fn delays_of_single_frames_have_no_effect() {
        // One in seven SYNCs and one in five answers is held up by a millisecond or more.
        let there = |i| if i % 7 == 3 { 1_900 } else { 70 + i % 3 };
        let back = |i| if i % 5 == 2 { 4_000 } else { 72 + i % 2 };
        let (stream, truth) = stream(3_000, 17, there, back);
        let worst = worst_us(&stream, &truth);
        assert!(worst < 5.0, "{worst} us");
        // The middle of SYNC and arrival is off by two milliseconds.
        let middle = |s: &ShaftSample| (s.request.as_nanos() + s.answer.as_nanos()) / 2;
        assert!(
            stream
                .iter()
                .zip(&truth)
                .any(|(s, t)| (middle(s) - t).abs() > 1_900_000)
        );
    }

    /// Wrong pair, as after a step of the host's clock: one such pair would tilt the clock for all.
    #[test]
    fn a_sample_paired_with_a_later_sync_does_not_count() {
        // The second one on an adapter so slow that even a later SYNC precedes the arrival.
        for (there, back) in [(70, 2_500), (1_200, 3_000)] {
            let back = |i| if i == 700 { back } else { 70 };
            let (mut stream, truth) = stream(1_000, 17, |_| there, back);
            stream[700].request += Span::from_millis(2);
            assert!(stream[700].request < stream[700].answer);
            assert!(worst_us(&stream, &truth) < 600.0);
            let (samples, _) = angle_samples(&stream, gearing());
            let bound_ns = samples[100].bound.as_nanos();
            assert!(bound_ns < (there + 70) * 500 + 2_000, "{bound_ns}");
        }
    }

    #[test]
    fn the_drives_time_wraps_in_mid_stream() {
        let (stream, truth) = stream(3_000, (1 << 32) - 1_500_000, |_| 70, |_| 70);
        assert!(stream.iter().any(|s| s.drive_us.unwrap() < 1_000_000));
        assert!(worst_us(&stream, &truth) < 3.0);
    }

    #[test]
    fn a_restarted_drive_has_a_new_clock() {
        let (mut samples, mut truth) = stream(500, 3_000_000_000, |_| 70, |_| 70);
        let (mut after, after_truth) = stream(500, 17, |_| 70, |_| 70);
        for sample in &mut after {
            let later = Span::from_secs(3);
            sample.request += later;
            sample.answer += later;
        }
        samples.extend(after);
        truth.extend(after_truth.iter().map(|t| t + 3_000_000_000));
        assert_eq!(runs(&samples).len(), 2);
        assert!(worst_us(&samples, &truth) < 3.0);
    }

    #[test]
    fn an_asymmetric_bus_delay_is_within_the_bound() {
        let (stream, truth) = stream(1_000, 17, |_| 70, |_| 30_000);
        let (samples, _) = angle_samples(&stream, gearing());
        assert!(
            samples
                .iter()
                .all(|s| (s.bound.as_nanos() - 15_035_000).abs() < 10_000)
        );
        assert!(worst_us(&stream, &truth) > 14_000.0);
    }

    #[test]
    fn few_samples_are_placed_at_the_middle() {
        let (stream, _) = stream(3, 17, |_| 70, |_| 90);
        let (samples, _) = angle_samples(&stream, gearing());
        assert_eq!(samples[1].host.as_nanos(), EPOCH + 1_080_000);
        assert!(angle_samples(&[], gearing()).0.is_empty());
    }
}
