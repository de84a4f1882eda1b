//! Lasting jumps of (arrival - device time).
//!
//! The minima over the six seconds before and after each packet are compared. A difference beyond
//! the drift of clocks that arises within a tenth of a second is a jump. A delay is none, even of
//! seconds: delayed packets arrive together, so the values fall back as fast as they rose. Near the
//! ends of a recording the values must be level instead. Jumps up that are undone within six
//! seconds are not found.
//!
//! Smaller jumps are found where something else confirms them: those of the lidar's clock by the
//! spacing of packets, those of the host's clock by a silence, in which the host slept, or by the
//! motion of the axis.

mod grid;
mod quiet;
mod whole_packets;

use std::collections::VecDeque;

use units::Span;

use crate::clock::Arrival;
pub(super) use grid::shifted;
use quiet::{Level, certain};

/// The smallest jump to look for.
pub(crate) const LEAST: Span = Span::from_millis(10);
const LEAST_NS: i64 = LEAST.as_nanos();
/// The smallest jump of the lidar's clock to look for, which the spacing of packets shows.
const SMALLEST_NS: i64 = 90_000;
/// Least deviation of a spacing from whole packets that is irregular.
const MIN_IRREGULAR_NS: i64 = 20_000;
/// Packets on either side that confirm a small jump.
const SMALL_WINDOW: usize = 256;
/// Shortest silence of a host that slept.
const SILENCE: Span = Span::from_millis(500);
/// The smallest jump of the host's clock to look for: the delays of most networks vary by less.
pub(super) const SMALLEST_OF_HOST_NS: i64 = 1_000_000;
/// Largest relative drift of two crystals, in ppm.
const DRIFT_PPM: i64 = 200;
/// Time for which a jump must last.
const WINDOW_NS: i64 = 6_000_000_000;
/// Least number of packets that form a level, and greatest number within which a jump happens.
const MIN_LEVEL_PACKETS: usize = 32;
const MAX_JUMP_PACKETS: usize = 64;
/// Reordered packets go back by at most this, in host stamps and device time.
const BACK: Span = Span::from_millis(-10);
/// Greatest distance of a jump from its packet, in packets.
const NEAR: usize = 8;
/// Stamps are whole microseconds.
const QUANTUM_NS: i64 = 3_000;
/// Greatest number of packets lost in a row; after a longer silence the lidar may have restarted.
const MAX_LOST: i64 = 750;
/// Spacings that differ by less are equal: gaps of a limited field of view, block by block.
const SAME_SPACING_NS: i64 = 500_000;

/// A lasting jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Jump {
    /// First packet after it.
    pub at: usize,
    /// Change of the delay.
    pub by: Span,
    /// Evidence of it, besides the delays.
    pub evidence: Evidence,
}

/// Evidence of which clock jumped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Evidence {
    /// Nothing in the packets.
    Delays,
    /// The grid of stamps: the lidar's clock, by exactly this much.
    Grid,
    /// The spacing of packets: the lidar's clock.
    Spacing,
    /// A silence of this length in regular packets: the host's clock, if the host slept.
    Silence(Span),
    /// Packets that go on regularly: the host's clock, if the samples of the axis jump too.
    Regular(Regular),
}

/// Certainty of a jump of regular packets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Regular {
    /// It may be chance or a slew, unless something else confirms it.
    Possible,
    /// It is no chance, and sudden.
    Certain {
        /// First packet after it.
        at: usize,
        /// Change of the delay.
        by: Span,
    },
}

/// Jumps and outliers of a recording.
pub(crate) struct JumpReport {
    pub jumps: Vec<Jump>,
    /// Packets that precede their earliest possible arrival: damaged stamps.
    pub strays: Vec<usize>,
    spacing_ns: i64,
    /// The packets without the jumps that the grid shows.
    pub level: Vec<Arrival>,
}

/// Searches packets in order of recording.
pub(crate) fn find(arrivals: &[Arrival]) -> JumpReport {
    let spacing_ns = spacing_ns(arrivals);
    let shifts = grid::jumps(arrivals, spacing_ns);
    let level = grid::without(arrivals, &shifts);
    let arrivals = level.as_slice();
    let offsets = offsets(arrivals);
    let window = usize::try_from(WINDOW_NS / spacing_ns.max(100_000)).unwrap_or(MIN_LEVEL_PACKETS);
    let ahead = least_ahead(&offsets, window);
    let mut search = JumpSearch {
        arrivals,
        offsets: &offsets,
        window,
        behind: SlidingMinimum::default(),
        since: 0,
    };
    let mut found = JumpReport {
        jumps: Vec::new(),
        strays: Vec::new(),
        spacing_ns,
        level: Vec::new(),
    };
    for (at, offset) in offsets.iter().enumerate() {
        let (Some(before), Some(after)) = (search.behind.get(), ahead.get(at)) else {
            search.behind.push(at, *offset, window);
            continue;
        };
        match search.classify(at, before, *after) {
            PacketKind::Regular => search.behind.push(at, *offset, window),
            PacketKind::Stray => found.strays.push(at),
            PacketKind::Jumped(by) => {
                found.jumps.push(Jump {
                    at,
                    by,
                    evidence: Evidence::Delays,
                });
                search.behind = SlidingMinimum::default();
                search.behind.push(at, *offset, window);
                search.since = at;
            }
        }
    }
    let small = found.small_device_jumps(arrivals, &offsets);
    found.jumps.extend(small);
    let whole = found.jumps_of_whole_packets(arrivals, &offsets);
    found.jumps.extend(whole);
    let across = found.jumps_across_silence(arrivals, &offsets);
    found.jumps.extend(across);
    let regular = found.jumps_of_regular_packets(arrivals, &offsets, window);
    found.jumps.extend(regular);
    found.jumps.extend(shifts);
    found.jumps.sort_by_key(|jump| jump.at);
    found.level = level;
    found
}

struct JumpSearch<'a> {
    arrivals: &'a [Arrival],
    offsets: &'a [i64],
    window: usize,
    behind: SlidingMinimum,
    /// First packet since the last jump.
    since: usize,
}

enum PacketKind {
    Regular,
    Stray,
    Jumped(Span),
}

impl JumpSearch<'_> {
    fn classify(&self, at: usize, before: i64, after: i64) -> PacketKind {
        let rise = after.saturating_sub(before);
        let here = self.offsets.get(at).copied().unwrap_or(before);
        let early = here.saturating_sub(before) <= -LEAST_NS / 2;
        if rise >= LEAST_NS && self.is_sudden(at, rise) && self.stays(at) {
            return PacketKind::Jumped(Span::from_nanos(rise));
        }
        if !early {
            return PacketKind::Regular;
        }
        // An early packet always has a cause; another jump within the window does not change this
        // one.
        let fall = self
            .least(at, at + MAX_JUMP_PACKETS)
            .map_or(0, |least| least.saturating_sub(before));
        let next = self.least(at + 1, at + MAX_JUMP_PACKETS);
        if next.is_none_or(|next| next.saturating_sub(before) > -LEAST_NS / 2) {
            return PacketKind::Stray;
        }
        // All packets before it may have been late.
        let was_level = at - self.since >= self.window || self.is_level(self.since, at);
        if fall <= -LEAST_NS && (was_level || self.went_back(at)) {
            return PacketKind::Jumped(Span::from_nanos(fall));
        }
        PacketKind::Regular
    }

    fn least(&self, from: usize, to: usize) -> Option<i64> {
        let to = to.min(self.offsets.len());
        self.offsets.get(from..to)?.iter().copied().min()
    }

    /// Whether most of the rise happens within some packets.
    fn is_sudden(&self, at: usize, rise: i64) -> bool {
        let before = self.least(at.saturating_sub(MAX_JUMP_PACKETS).max(self.since), at);
        let after = self.least(at, at + MAX_JUMP_PACKETS);
        before.zip(after).is_some_and(|(before, after)| {
            let local = after.saturating_sub(before);
            local.signum() == rise.signum() && local.unsigned_abs() >= rise.unsigned_abs() / 2
        })
    }

    /// Whether the rise lasts, unlike a delay.
    fn stays(&self, at: usize) -> bool {
        let end = self.offsets.len();
        end - at >= self.window || self.is_level(at, end)
    }

    fn is_level(&self, from: usize, to: usize) -> bool {
        let middle = from + to.saturating_sub(from) / 2;
        let halves = self.least(from, middle).zip(self.least(middle, to));
        to.saturating_sub(from) >= MIN_LEVEL_PACKETS
            && halves.is_some_and(|(a, b)| a.saturating_sub(b).saturating_abs() < LEAST_NS / 2)
    }

    /// Whether one of the clocks goes back.
    fn went_back(&self, at: usize) -> bool {
        steps(self.arrivals, at).is_some_and(|(device, host)| host < BACK || device < BACK)
    }
}

impl JumpReport {
    /// Whether the lidar's clock deviates from its spacing near packet `at`.
    pub fn device_jumped(&self, arrivals: &[Arrival], at: usize) -> bool {
        let near = at.saturating_sub(NEAR).max(1)..at + NEAR;
        near.filter_map(|i| steps(arrivals, i))
            .map(|(device, _)| device.as_nanos())
            .any(|device| {
                !self.is_usual(device) && !is_frequent(arrivals, at, device, SAME_SPACING_NS)
            })
    }

    /// Steps of the lidar's clock that its own spacing shows and the delays confirm.
    fn small_device_jumps(&self, arrivals: &[Arrival], offsets: &[i64]) -> Vec<Jump> {
        let mut small: Vec<Jump> = Vec::new();
        for at in MIN_LEVEL_PACKETS..arrivals.len().saturating_sub(MIN_LEVEL_PACKETS) {
            let Some((device, _)) = steps(arrivals, at) else {
                continue;
            };
            let spacing = self.spacing_ns.max(1);
            let off = (device.as_nanos() + spacing / 2).rem_euclid(spacing) - spacing / 2;
            let count = device.as_nanos().abs() / spacing;
            if off.abs() < MIN_IRREGULAR_NS + count * 10 || !self.is_apart(at) {
                continue;
            }
            let Some(rise) = self.rise_at(offsets, at, SMALL_WINDOW) else {
                continue;
            };
            // The step that the spacing shows, up to whole packets, is the one nearest to the rise.
            let whole = (-rise - off + spacing / 2).div_euclid(spacing);
            let by = -(off + whole * spacing);
            let is_confirmed = (rise - by).abs() < (by.abs() / 3).min(spacing / 4);
            let is_apart = small.last().is_none_or(|last| at - last.at > SMALL_WINDOW);
            if by.abs() >= SMALLEST_NS
                && is_confirmed
                && is_apart
                && !is_frequent(arrivals, at, device.as_nanos(), MIN_IRREGULAR_NS / 2)
            {
                small.push(Jump {
                    at,
                    by: Span::from_nanos(by),
                    evidence: Evidence::Spacing,
                });
            }
        }
        small
    }

    /// Steps between packets that are far apart, though whole packets by the lidar's clock.
    fn jumps_across_silence(&self, arrivals: &[Arrival], offsets: &[i64]) -> Vec<Jump> {
        let spacing = self.spacing_ns.max(1);
        let ends = MIN_LEVEL_PACKETS..arrivals.len().saturating_sub(MIN_LEVEL_PACKETS);
        ends.filter(|at| self.is_apart(*at))
            .filter_map(|at| {
                let (device, _) = steps(arrivals, at).filter(|(device, _)| *device > SILENCE)?;
                let off = (device.as_nanos() + spacing / 2).rem_euclid(spacing) - spacing / 2;
                let count = device.as_nanos() / spacing;
                let by = self.rise_at(offsets, at, SMALL_WINDOW)?;
                let drift = device.as_nanos() / 1_000_000 * DRIFT_PPM;
                let is_regular = off.abs() < MIN_IRREGULAR_NS + count * 10;
                (is_regular && by.abs() >= SMALLEST_OF_HOST_NS + drift).then(|| Jump {
                    at,
                    by: Span::from_nanos(by),
                    evidence: Evidence::Silence(device),
                })
            })
            .collect()
    }

    /// Jumps of the delays that last, though the lidar's clock goes on.
    fn jumps_of_regular_packets(
        &self,
        arrivals: &[Arrival],
        offsets: &[i64],
        window: usize,
    ) -> Vec<Jump> {
        let Level {
            offsets,
            smallest_ns: smallest,
            certain_ns,
        } = Level::new(arrivals, offsets, self.spacing_ns);
        let ahead = least_ahead(&offsets, SMALL_WINDOW);
        let lasting = least_ahead(&offsets, window);
        let mut behind = SlidingMinimum::default();
        let mut long_behind = SlidingMinimum::default();
        let mut found: Vec<Jump> = Vec::new();
        for (at, offset) in offsets.iter().enumerate() {
            let least = [&behind, &long_behind].map(SlidingMinimum::get);
            behind.push(at, *offset, SMALL_WINDOW);
            long_behind.push(at, *offset, window);
            let ([Some(before), Some(long_before)], Some(after), Some(long_after)) =
                (least, ahead.get(at), lasting.get(at))
            else {
                continue;
            };
            let rise = after.saturating_sub(before);
            let lasting = long_after.saturating_sub(long_before);
            let is_lasting = lasting.signum() == rise.signum() && lasting.abs() > tenths(7, rise);
            let is_inside = at >= MIN_LEVEL_PACKETS && offsets.len() - at >= MIN_LEVEL_PACKETS;
            if rise.abs() < smallest || !is_lasting || !is_inside {
                continue;
            }
            let jump = Jump {
                at,
                by: Span::from_nanos(rise),
                evidence: Evidence::Regular(Regular::Possible),
            };
            match found.last_mut() {
                // A rise is complete at once, a fall only where it happened.
                Some(last) if at - last.at <= SMALL_WINDOW => {
                    let grows = rise.abs() > tenths(11, last.by.as_nanos());
                    if grows || (rise < 0 && rise.abs() > tenths(7, last.by.as_nanos())) {
                        *last = jump;
                    }
                }
                _ => found.push(jump),
            }
        }
        found.retain(|jump| self.is_apart(jump.at) && !self.device_jumped(arrivals, jump.at));
        for jump in &mut found {
            if let Some(certain) = certain(&offsets, jump, certain_ns) {
                jump.evidence = Evidence::Regular(certain);
            }
        }
        found
    }

    /// Whether no jump or stray packet is near.
    fn is_apart(&self, at: usize) -> bool {
        let mut jumps = self.jumps.iter().map(|jump| jump.at);
        let mut strays = self.strays.iter();
        jumps.all(|other| other.abs_diff(at) >= MIN_LEVEL_PACKETS)
            && strays.all(|other| other.abs_diff(at) > SMALL_WINDOW)
    }

    /// Rise of the least offset from the `window` of packets before `at` to that from it on, up to
    /// the next jumps.
    fn rise_at(&self, offsets: &[i64], at: usize, window: usize) -> Option<i64> {
        let before = self.jumps.iter().map(|jump| jump.at).filter(|j| *j <= at);
        let after = self.jumps.iter().map(|jump| jump.at).filter(|j| *j > at);
        let begin = before.fold(at.saturating_sub(window), usize::max);
        let end = after.fold((at + window).min(offsets.len()), usize::min);
        let least = |from: usize, to: usize| offsets.get(from..to)?.iter().min().copied();
        Some(least(at, end)?.saturating_sub(least(begin, at)?))
    }

    /// Whether a spacing is a whole number of packets, some lost, or that of reordered ones.
    fn is_usual(&self, device_ns: i64) -> bool {
        let spacing = self.spacing_ns.max(1);
        let count = (device_ns.abs() + spacing / 2) / spacing;
        let off = (device_ns.abs() - count * spacing).abs();
        let ordered = device_ns > 0 && count <= MAX_LOST;
        let reordered = device_ns <= 0 && count <= NEAR as i64;
        (ordered || reordered) && off <= QUANTUM_NS + count * 10
    }
}

/// `count` tenths of a magnitude. A clock without battery is set by decades, which ten times would
/// exceed 64 bits.
const fn tenths(count: i64, of: i64) -> i64 {
    let of = of.saturating_abs();
    (of / 10).saturating_mul(count) + of % 10 * count / 10
}

/// Whether a spacing occurs in other places too, within the tolerance.
fn is_frequent(arrivals: &[Arrival], at: usize, device_ns: i64, tolerance_ns: i64) -> bool {
    alike(arrivals, at, device_ns, tolerance_ns)
        .nth(2)
        .is_some()
}

/// The other places in which a spacing occurs.
fn alike(
    arrivals: &[Arrival],
    at: usize,
    device_ns: i64,
    tolerance_ns: i64,
) -> impl Iterator<Item = usize> {
    (1..arrivals.len()).filter(move |i| {
        let is_alike = |(device, _): (Span, Span)| {
            let off = device.as_nanos().saturating_sub(device_ns);
            off.saturating_abs() < tolerance_ns
        };
        i.abs_diff(at) > 2 * NEAR && steps(arrivals, *i).is_some_and(is_alike)
    })
}

/// Device time and host time from the packet before to this one.
fn steps(arrivals: &[Arrival], at: usize) -> Option<(Span, Span)> {
    let (before, this) = (arrivals.get(at.checked_sub(1)?)?, arrivals.get(at)?);
    Some((
        this.device.saturating_since(before.device),
        this.host.saturating_since(before.host),
    ))
}

/// Host time less device time, relative to the first.
fn offsets(arrivals: &[Arrival]) -> Vec<i64> {
    let offset = |a: &Arrival| a.host.as_nanos().saturating_sub(a.device.as_nanos());
    let first = arrivals.first().map_or(0, offset);
    arrivals
        .iter()
        .map(|arrival| offset(arrival).saturating_sub(first))
        .collect()
}

/// Usual spacing of packets by the device's clock: the mean of those near the median.
fn spacing_ns(arrivals: &[Arrival]) -> i64 {
    let mut spacings: Vec<i64> = (1..arrivals.len())
        .filter_map(|i| steps(arrivals, i))
        .map(|(device, _)| device.as_nanos())
        .collect();
    if spacings.is_empty() {
        return 1;
    }
    let middle = spacings.len() / 2;
    let median = *spacings.select_nth_unstable(middle).1;
    let usual = spacings
        .iter()
        .filter(|ns| ns.saturating_sub(median).saturating_abs() <= QUANTUM_NS);
    let (sum, count) = usual.fold((0i64, 0i64), |(sum, count), ns| {
        (sum.saturating_add(*ns), count + 1)
    });
    sum / count.max(1)
}

/// Minimum of the last values.
#[derive(Default)]
struct SlidingMinimum {
    /// Index and value, both increasing.
    rising: VecDeque<(usize, i64)>,
}

impl SlidingMinimum {
    fn push(&mut self, at: usize, value: i64, window: usize) {
        while self.rising.back().is_some_and(|last| last.1 >= value) {
            self.rising.pop_back();
        }
        self.rising.push_back((at, value));
        while self
            .rising
            .front()
            .is_some_and(|first| first.0 + window <= at)
        {
            self.rising.pop_front();
        }
    }

    fn get(&self) -> Option<i64> {
        self.rising.front().map(|first| first.1)
    }
}

/// Minimum of each value and the following ones within the window.
fn least_ahead(values: &[i64], window: usize) -> Vec<i64> {
    let mut least = SlidingMinimum::default();
    let mut ahead: Vec<i64> = Vec::with_capacity(values.len());
    // In reverse, so that the following values come first.
    for (at, value) in values.iter().rev().enumerate() {
        least.push(at, *value, window);
        ahead.push(least.get().unwrap_or(*value));
    }
    ahead.reverse();
    ahead
}
