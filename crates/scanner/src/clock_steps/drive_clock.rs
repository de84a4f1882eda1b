//! Steps of the host's clock that the drive's own clock shows.
//!
//! Samples latched at SYNC have the drive's time. Their answers are late, some by little: the least
//! (answer - drive's time) on either side of a step differs by the step, whether the axis moves or
//! not.

use core::ops::Range;

use drive::ShaftSample;
use units::Span;

/// Samples on either side, and those nearest to the step, which may belong to the other one.
const SIDE: usize = 96;
const MIN_SIDE: usize = 24;
const NEAR: usize = 48;
/// Greatest relative difference between the steps that packets and samples show.
const DIFFERENCE: f64 = 0.3;
/// Chance that all of so many delays exceed the step, below which a sample is certain.
const LEAST_CHANCE: f64 = 1e-4;
/// Samples whose SYNC was sent before the step and whose answer came after it, at most.
const UNDER_WAY: usize = 8;

/// Whether samples near the index `at` have the drive's time.
pub(super) fn is_known(samples: &[ShaftSample], at: usize) -> bool {
    let near = samples.get(at.saturating_sub(NEAR)..(at + NEAR).min(samples.len()));
    let near = near.unwrap_or_default();
    !near.is_empty() && near.iter().all(|sample| sample.drive_us.is_some())
}

/// The samples near the index `at` of which a stamp may precede or follow a step of the host's
/// clock by `by`, if the drive's clock shows it. Those before precede it, those after follow it.
pub(super) fn step(samples: &[ShaftSample], at: usize, by: Span) -> Option<Range<usize>> {
    let late = |i: usize| late_by(samples, at, i);
    let (from, to) = near(samples, at);
    let (sides, [before, after]) = least_delays(samples, at)?;
    let (rise, by) = (after.saturating_sub(before), by.as_nanos());
    let difference = rise.saturating_sub(by).saturating_abs() as f64;
    if difference >= DIFFERENCE * by.saturating_abs() as f64 {
        return None;
    }
    // Delays of less than the step show the side of a sample. The least delay of many samples is
    // not quite the smallest possible one.
    let apparent = rise.saturating_abs() / 4 * 3;
    let quick = sides.iter().zip([before, after]).map(|(side, least)| {
        let delays = side.clone().filter_map(late);
        let quick = delays.filter(|late| late.saturating_sub(least) < apparent);
        quick.count() as f64 / side.len() as f64
    });
    let quick = quick.fold(1.0, f64::min);
    let doubtful = (LEAST_CHANCE.ln() / (1.0 - quick).max(LEAST_CHANCE).ln()).ceil() as usize;
    let limit = before.min(after).saturating_add(apparent);
    let is_below = |i: &usize| late(*i).is_some_and(|late| late < limit);
    let mut near = from..to;
    let (first, last) = match rise < 0 {
        true => {
            let certain = near.find(is_below).unwrap_or(to);
            (certain.saturating_sub(doubtful), certain)
        }
        false => {
            let certain = near.rfind(is_below).map_or(from, |last| last + 1);
            (certain, certain + doubtful)
        }
    };
    Some(first.max(from)..(last + UNDER_WAY).min(to))
}

/// Whether the drive's clock shows that the host's was not set by `by`.
pub(super) fn excludes(samples: &[ShaftSample], at: usize, by: Span) -> bool {
    least_delays(samples, at).is_some_and(|(_, [before, after])| {
        let rise = after.saturating_sub(before).saturating_abs() as f64;
        rise < DIFFERENCE * by.as_nanos().saturating_abs() as f64
    })
}

/// Delay of a sample's answer by the drive's clock, relative to that at the index `at`,
/// nanoseconds.
fn late_by(samples: &[ShaftSample], at: usize, i: usize) -> Option<i64> {
    let (origin, sample) = (samples.get(at)?, samples.get(i)?);
    let answer = sample.answer.saturating_since(origin.answer);
    since(answer, sample, origin)
}

/// The samples near the index `at`, which may belong to either side.
fn near(samples: &[ShaftSample], at: usize) -> (usize, usize) {
    (at.saturating_sub(NEAR), (at + NEAR).min(samples.len()))
}

/// Samples on either side of the index `at`, and the least delay of the answers there.
fn least_delays(samples: &[ShaftSample], at: usize) -> Option<([Range<usize>; 2], [i64; 2])> {
    let (from, to) = near(samples, at);
    let sides = [
        from.saturating_sub(SIDE)..from,
        to..(to + SIDE).min(samples.len()),
    ];
    if sides.iter().any(|side| side.len() < MIN_SIDE) {
        return None;
    }
    let least = |side: &Range<usize>| side.clone().filter_map(|i| late_by(samples, at, i)).min();
    let least = [least(&sides[0])?, least(&sides[1])?];
    Some((sides, least))
}

/// Matches samples after a step with earlier SYNCs, if they were matched with later ones than
/// their own: while the stamps were on two clocks, a SYNC seemed to be earlier than it was. The
/// matching recovers where SYNCs pause or answers are lost, so each block of samples is compared
/// with the one before it. In the block where it recovers, SYNCs may be too early, never too late.
pub(super) fn rematch(samples: &mut [ShaftSample], step: &Range<usize>) {
    let Some(origin) = samples.get(step.start).copied() else {
        return;
    };
    let early = |sample: &ShaftSample| {
        let host = sample.request.saturating_since(origin.request);
        since(host, sample, &origin)
    };
    let greatest = |range: Range<usize>| {
        let some = samples.get(range).unwrap_or_default();
        some.iter().filter_map(early).max()
    };
    let before = greatest(step.start.saturating_sub(SIDE)..step.start);
    let (Some(mut reference), Some(period)) = (before, period(samples, step)) else {
        return;
    };
    let mut blocks = Vec::new();
    let mut from = step.start;
    while from < samples.len() {
        let certain = from.max(step.end);
        let to = match samples.len() {
            end if end < certain + 2 * SIDE => end,
            _ => certain + SIDE,
        };
        let latest = greatest(certain..to).unwrap_or(reference);
        let rise = latest.saturating_sub(reference).saturating_add(period / 2);
        let shift = rise.div_euclid(period);
        // Where all of a block have earlier SYNCs than their own, the one before it counts.
        if let Ok(late) = usize::try_from(shift) {
            reference = latest.saturating_sub(shift.saturating_mul(period));
            blocks.push((from..to, late));
        }
        from = to;
    }
    for (block, shift) in blocks.into_iter().rev().filter(|(_, shift)| *shift > 0) {
        for i in block.rev().take_while(|i| *i >= step.start + shift) {
            let request = samples.get(i - shift).map(|earlier| earlier.request);
            if let (Some(sample), Some(request)) = (samples.get_mut(i), request) {
                sample.request = request;
            }
        }
    }
}

/// Median interval of the samples after the step, nanoseconds of the drive's time.
fn period(samples: &[ShaftSample], step: &Range<usize>) -> Option<i64> {
    let side = samples.get(step.end..(step.end + SIDE).min(samples.len()))?;
    let mut intervals: Vec<i64> = side
        .windows(2)
        .filter_map(|pair| match pair {
            [a, b] => since(Span::ZERO, a, b),
            _ => None,
        })
        .collect();
    intervals.sort_unstable();
    let period = *intervals.get(intervals.len() / 2)?;
    (period > 0).then_some(period)
}

/// The host's time since `origin` less the drive's, nanoseconds.
fn since(host: Span, sample: &ShaftSample, origin: &ShaftSample) -> Option<i64> {
    let drive_us = sample.drive_us?.wrapping_sub(origin.drive_us?);
    let device = Span::from_micros(i64::from(drive_us.cast_signed()));
    Some(host.saturating_sub(device).as_nanos())
}
