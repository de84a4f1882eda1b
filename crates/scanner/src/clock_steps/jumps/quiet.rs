//! Smallest jump of the delays that is no chance.
//!
//! On a quiet network, whose least delays hardly vary from window to window and whose packets are
//! usually hardly later than the least delayed ones, jumps from 0.1 ms on count.

use units::Span;

use super::{Jump, MAX_LOST, NEAR, Regular, SMALL_WINDOW, SMALLEST_OF_HOST_NS, steps};
use crate::clock::Arrival;

/// The smallest jump on a quiet network: steps by 0.1 ms, less the drift that is not known.
const SMALLEST_ON_QUIET_NS: i64 = 75_000;
/// Spreads of the least delays that a jump must exceed.
pub(super) const MIN_SPREADS: i64 = 3;
/// The same without anything that confirms it: the spread is a median, about two thirds of the
/// standard deviation of normal ones.
const CERTAIN_SPREADS: i64 = 6;
/// Windows that show the spread of the least delays, and the packets of one in a short recording.
const MIN_SPREAD_WINDOWS: usize = 8;
const SHORT_WINDOW: usize = 64;
/// Packets on either side within which a sudden jump happens.
const SUDDEN_WINDOW: usize = 48;

/// The delays without drift, and how small a jump of them may be.
pub(super) struct Level {
    /// The offsets without the mean drift of the clocks.
    pub offsets: Vec<i64>,
    /// The smallest jump to look for, if something else confirms it.
    pub smallest_ns: i64,
    /// The smallest jump that is no chance by itself.
    pub certain_ns: i64,
}

impl Level {
    /// Level of packets with these offsets.
    pub(super) fn new(arrivals: &[Arrival], offsets: &[i64], spacing_ns: i64) -> Self {
        let windows = [SMALL_WINDOW, SMALL_WINDOW / 2, SHORT_WINDOW];
        let found = windows
            .into_iter()
            .find_map(|window| Some((window, spread(offsets, window)?)));
        let Some((window, (drift, spread))) = found else {
            return Self {
                offsets: offsets.to_vec(),
                smallest_ns: SMALLEST_OF_HOST_NS,
                certain_ns: i64::MAX,
            };
        };
        let quiet = SMALLEST_ON_QUIET_NS.max(usual_excess(offsets));
        let spreads = |count: i64| count.saturating_mul(spread).max(quiet);
        // Drift goes on while packets are lost, but not while the lidar's clock is set.
        let spacing_ns = spacing_ns.max(1);
        let longest_ns = MAX_LOST.saturating_mul(spacing_ns);
        let slope = drift as f64 / (window as f64 * spacing_ns as f64);
        let mut elapsed_ns = 0_i64;
        let level = offsets.iter().enumerate().map(|(at, offset)| {
            let step_ns = steps(arrivals, at).map_or(0, |(device, _)| device.as_nanos());
            elapsed_ns = elapsed_ns.saturating_add(step_ns.clamp(0, longest_ns));
            offset.saturating_sub((elapsed_ns as f64 * slope) as i64)
        });
        Self {
            offsets: level.collect(),
            smallest_ns: spreads(MIN_SPREADS).min(SMALLEST_OF_HOST_NS),
            certain_ns: spreads(CERTAIN_SPREADS),
        }
    }
}

/// Place and size of the jump near `jump`, if it is no chance and happens at once, between levels
/// on both sides.
pub(super) fn certain(offsets: &[i64], jump: &Jump, certain_ns: i64) -> Option<Regular> {
    let rise = |at: usize, window: usize, level: fn(&[i64]) -> Option<i64>| {
        let before = offsets.get(at.checked_sub(window)?..at)?;
        let after = offsets.get(at..at + window)?;
        Some(level(after)?.saturating_sub(level(before)?))
    };
    let sign = jump.by.as_nanos().signum();
    let most = |place: usize, within: usize, window: usize, level| {
        let near = place.saturating_sub(within)..=place + within;
        let rises = near.filter_map(|at| Some((at, rise(at, window, level)?)));
        rises.max_by_key(|(_, by)| by.saturating_mul(sign))
    };
    // Medians jump most at the place itself, least delays around it.
    let (at, usual) = most(jump.at, SUDDEN_WINDOW, SUDDEN_WINDOW, median)?;
    let (_, by) = most(at, NEAR, SMALL_WINDOW, least)?;
    let (_, at_once) = most(at, NEAR, SUDDEN_WINDOW, least)?;
    // A backlog that is made up has a least delay that falls at once, too, but no level.
    let size = by.saturating_abs();
    let is_alike = |rise: i64| rise.saturating_sub(by).saturating_abs() < size / 10 * 3;
    let is_certain = size >= certain_ns && is_alike(usual) && is_alike(at_once);
    is_certain.then_some(Regular::Certain {
        at,
        by: Span::from_nanos(by),
    })
}

fn least(offsets: &[i64]) -> Option<i64> {
    offsets.iter().min().copied()
}

fn median(offsets: &[i64]) -> Option<i64> {
    let mut sorted = offsets.to_vec();
    sorted.sort_unstable();
    sorted.get(sorted.len() / 2).copied()
}

/// By how much a packet is later than the least delayed of its window: the median.
fn usual_excess(offsets: &[i64]) -> i64 {
    let mut excess: Vec<i64> = offsets
        .chunks(SHORT_WINDOW)
        .filter_map(|window| Some((window, *window.iter().min()?)))
        .flat_map(|(window, least)| window.iter().map(move |ns| ns.saturating_sub(least)))
        .collect();
    let middle = excess.len() / 2;
    match excess.is_empty() {
        true => 0,
        false => *excess.select_nth_unstable(middle).1,
    }
}

/// Drift of the least offsets from window to window of so many packets, and the median deviation
/// from it; `None` with few windows.
pub(super) fn spread(offsets: &[i64], window: usize) -> Option<(i64, i64)> {
    let least: Vec<i64> = offsets
        .chunks_exact(window)
        .filter_map(|window| window.iter().min().copied())
        .collect();
    let mut rises: Vec<i64> = least
        .windows(2)
        .filter_map(|pair| Some(pair.last()?.saturating_sub(*pair.first()?)))
        .collect();
    if rises.len() < MIN_SPREAD_WINDOWS {
        return None;
    }
    let middle = rises.len() / 2;
    let drift = *rises.select_nth_unstable(middle).1;
    for rise in &mut rises {
        *rise = rise.saturating_sub(drift).saturating_abs();
    }
    Some((drift, *rises.select_nth_unstable(middle).1))
}
