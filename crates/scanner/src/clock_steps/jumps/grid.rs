//! Steps of the lidar's clock that the grid of its stamps shows.
//!
//! The lidar fires at an even rate, whatever its clock reads: its stamps lie on a grid of whole
//! packets. A step of the clock shifts the grid for good, which gives its size up to whole packets
//! to a microsecond, however late the network is. The delays of the nearest packets on either side
//! tell how many packets passed meanwhile.

use units::Span;

use super::quiet::{MIN_SPREADS, spread};
use super::{Evidence, Jump, MIN_IRREGULAR_NS, QUANTUM_NS, alike, is_frequent, offsets, steps};
use crate::clock::Arrival;

/// Packets on either side whose stamps have to be on the grid, and the share of them.
const SIDE: usize = 16;
const MIN_ON_GRID: usize = SIDE * 3 / 4;
/// The smallest step to look for.
const SMALLEST_NS: i64 = 50_000;
/// Packets that pass during a step, at most: after a longer pause the lidar may have restarted,
/// with another grid.
const MAX_PACKETS: i64 = 64;
/// Packets on either side whose delays are compared. Few, as the host's clock may step too, but
/// more where a few packets were held up together.
const WINDOWS: [usize; 5] = [4, 8, 16, 32, 64];

/// Packets on either side whose least delays show whether those of a frequent spacing change.
const LASTING_WINDOW: usize = 64;
/// Other places of such a spacing that are compared. On a busy network one may change by chance.
const MAX_ALIKE: usize = 16;

/// The shifts of the grid, in order.
pub(super) fn jumps(arrivals: &[Arrival], spacing_ns: i64) -> Vec<Jump> {
    let offsets = offsets(arrivals);
    // The least change of the least delays that is no chance; none is if there are few packets.
    let least_change = spread(&offsets, LASTING_WINDOW).map_or(i64::MAX, |(_, spread)| {
        SMALLEST_NS.max(MIN_SPREADS.saturating_mul(spread))
    });
    let inside = SIDE..arrivals.len().saturating_sub(SIDE);
    let found = inside.filter_map(|at| {
        let by = shift(arrivals, &offsets, at, spacing_ns.max(1), least_change)?;
        Some(Jump {
            at,
            by: Span::from_nanos(-by),
            evidence: Evidence::Grid,
        })
    });
    found.collect()
}

/// The packets by the lidar's clock before the jumps, which are in order.
pub(super) fn without(arrivals: &[Arrival], jumps: &[Jump]) -> Vec<Arrival> {
    let jumps = jumps.iter().map(|jump| (jump.at, jump.by));
    shifted(arrivals, jumps, |arrival, by| Arrival {
        device: arrival.device.saturating_add(by),
        ..arrival
    })
}

/// The packets, each shifted by the sum of the steps at it and before, in one pass. A step is its
/// first packet and its size; steps are in order.
pub(in crate::clock_steps) fn shifted(
    arrivals: &[Arrival],
    steps: impl IntoIterator<Item = (usize, Span)>,
    shift: impl Fn(Arrival, Span) -> Arrival,
) -> Vec<Arrival> {
    let mut next = steps.into_iter().peekable();
    let mut by = Span::ZERO;
    let all = arrivals.iter().enumerate().map(|(at, arrival)| {
        while let Some((_, step)) = next.next_if(|(first, _)| *first <= at) {
            by = by.saturating_add(step);
        }
        shift(*arrival, by)
    });
    all.collect()
}

/// By how much the lidar's clock was set forward before packet `at`; `None` if it was not.
///
/// A spacing that is frequent is that of a limited field of view, unless the delays change with it:
/// a pulse per second may set the clock by as much each time.
fn shift(
    arrivals: &[Arrival],
    offsets: &[i64],
    at: usize,
    spacing: i64,
    least_change: i64,
) -> Option<i64> {
    let device = steps(arrivals, at)?.0.as_nanos();
    let tolerance = MIN_IRREGULAR_NS.saturating_add(device.saturating_abs() / spacing * 10);
    if off_grid(device, spacing).abs() < tolerance {
        return None;
    }
    let before = phase(arrivals, at - 1, at - SIDE..at, spacing)?;
    let after = phase(arrivals, at, at..at + SIDE, spacing)?;
    let device = device + after - before;
    let mut packets = WINDOWS.map(|window| {
        let rise = rise_at(offsets, at, window);
        device
            .saturating_add(rise)
            .saturating_add(spacing / 2)
            .div_euclid(spacing)
    });
    packets.sort_unstable();
    // Packets are rarely lost just then.
    let [_, _, median, _, _] = packets;
    let passed = if packets.contains(&1) { 1 } else { median };
    let by = device.saturating_sub(passed.saturating_mul(spacing));
    let is_step = (1..=MAX_PACKETS).contains(&passed) && by.abs() >= SMALLEST_NS;
    let is_like_step = |rise: i64| (rise + by).abs() <= by.abs() / 3;
    let changes = || {
        let others = alike(arrivals, at, device, MIN_IRREGULAR_NS / 2).take(MAX_ALIKE);
        let mut others: Vec<i64> = others
            .map(|i| rise_at(offsets, i, LASTING_WINDOW))
            .collect();
        others.sort_unstable();
        let rise = rise_at(offsets, at, LASTING_WINDOW);
        let median = others.get(others.len() / 2).copied().unwrap_or(rise);
        rise.abs() >= least_change && is_like_step(rise) && is_like_step(median)
    };
    let is_rare = || !is_frequent(arrivals, at, device, MIN_IRREGULAR_NS / 2);
    (is_step && (is_rare() || changes())).then_some(by)
}

/// Distance from the nearest multiple of the spacing.
fn off_grid(device_ns: i64, spacing: i64) -> i64 {
    device_ns.saturating_add(spacing / 2).rem_euclid(spacing) - spacing / 2
}

/// Mean distance of the grid from the stamp of packet `from`; `None` without a grid.
fn phase(
    arrivals: &[Arrival],
    from: usize,
    side: core::ops::Range<usize>,
    spacing: i64,
) -> Option<i64> {
    let origin = arrivals.get(from)?.device;
    let (mut sum, mut count) = (0, 0);
    for arrival in arrivals.get(side)? {
        let device = arrival.device.saturating_since(origin).as_nanos();
        let off = off_grid(device, spacing);
        if off.abs() <= QUANTUM_NS {
            sum += off;
            count += 1;
        }
    }
    (count >= MIN_ON_GRID as i64).then(|| sum / count)
}

/// Rise of the least offset from the packets before `at` to those from it on.
fn rise_at(offsets: &[i64], at: usize, window: usize) -> i64 {
    let least = |from: usize, to: usize| {
        let some = offsets.get(from..to.min(offsets.len()));
        some.unwrap_or_default().iter().min().copied()
    };
    let sides = (least(at, at + window)).zip(least(at.saturating_sub(window), at));
    sides.map_or(0, |(after, before)| after.saturating_sub(before))
}
