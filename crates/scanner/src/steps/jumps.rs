//! Jumps of (arrival - device time) that stay.
//!
//! Before and after each packet stand the least values of six seconds. Where they differ by more
//! than clocks drift in that time, and the difference is already there within a tenth of a second,
//! it is a jump. A delay is none, be it of seconds: what was held up comes all at once, so that the
//! values fall back within as long as it was held up. Near the ends of a recording, where there are
//! no six seconds, the values must be level instead. Left out: jumps up that are undone within six
//! seconds, and whose clock it was.

use std::collections::VecDeque;

use units::Span;

use crate::clock::Arrival;

/// Smaller ones are not looked for.
pub(crate) const LEAST: Span = Span::from_millis(10);
const LEAST_NS: i64 = LEAST.as_nanos();
/// How long it must stay.
const WINDOW_NS: i64 = 6_000_000_000;
/// The fewest packets that are a level, and the most within which a jump happens.
const LEVEL: usize = 32;
const LOCAL: usize = 64;
/// Host stamps that go back by more were not reordered; nor was device time.
const BACK: Span = Span::from_millis(-10);
/// How far from a jump its packet may be.
const NEAR: usize = 8;
/// Stamps are whole microseconds.
const QUANTUM_NS: i64 = 3_000;
/// More packets than this in a row are not lost; who was silent for longer may have begun anew.
const MOST_LOST: i64 = 750;
/// Spacings that differ by less are alike: gaps of a limited field of view, block by block.
const ALIKE_NS: i64 = 500_000;

/// A jump that stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Jump {
    /// First packet after it.
    pub at: usize,
    /// How much later packets are since.
    pub by: Span,
}

/// What there is in a recording.
pub(crate) struct JumpReport {
    pub jumps: Vec<Jump>,
    /// Packets that came before they can have: damaged stamps.
    pub strays: Vec<usize>,
    spacing_ns: i64,
}

/// Looks through packets in the order in which they were recorded.
pub(crate) fn find(arrivals: &[Arrival]) -> JumpReport {
    let offsets = offsets(arrivals);
    let spacing_ns = spacing_ns(arrivals);
    let window = usize::try_from(WINDOW_NS / spacing_ns.max(100_000)).unwrap_or(LEVEL);
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
    };
    for (at, offset) in offsets.iter().enumerate() {
        let (Some(before), Some(after)) = (search.behind.get(), ahead.get(at)) else {
            search.behind.push(at, *offset, window);
            continue;
        };
        match search.judge(at, before, *after) {
            PacketKind::Goes => search.behind.push(at, *offset, window),
            PacketKind::Stray => found.strays.push(at),
            PacketKind::Jumped(by) => {
                found.jumps.push(Jump { at, by });
                search.behind = SlidingMinimum::default();
                search.behind.push(at, *offset, window);
                search.since = at;
            }
        }
    }
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
    Goes,
    Stray,
    Jumped(Span),
}

impl JumpSearch<'_> {
    fn judge(&self, at: usize, before: i64, after: i64) -> PacketKind {
        let rise = after.saturating_sub(before);
        let here = self.offsets.get(at).copied().unwrap_or(before);
        let early = here.saturating_sub(before) <= -LEAST_NS / 2;
        if rise >= LEAST_NS && self.is_sudden(at, rise) && self.stays(at) {
            return PacketKind::Jumped(Span::from_nanos(rise));
        }
        if !early {
            return PacketKind::Goes;
        }
        // Nobody is early for nothing: another jump within the window changes nothing of this one.
        let fall = self
            .least(at, at + LOCAL)
            .map_or(0, |least| least.saturating_sub(before));
        let next = self.least(at + 1, at + LOCAL);
        if next.is_none_or(|next| next.saturating_sub(before) > -LEAST_NS / 2) {
            return PacketKind::Stray;
        }
        // But those before may all have been late.
        let was_level = at - self.since >= self.window || self.is_level(self.since, at);
        if fall <= -LEAST_NS && (was_level || self.went_back(at)) {
            return PacketKind::Jumped(Span::from_nanos(fall));
        }
        PacketKind::Goes
    }

    fn least(&self, from: usize, to: usize) -> Option<i64> {
        let to = to.min(self.offsets.len());
        self.offsets.get(from..to)?.iter().copied().min()
    }

    /// Most of the rise is there within some packets.
    fn is_sudden(&self, at: usize, rise: i64) -> bool {
        let before = self.least(at.saturating_sub(LOCAL).max(self.since), at);
        let after = self.least(at, at + LOCAL);
        before.zip(after).is_some_and(|(before, after)| {
            let local = after.saturating_sub(before);
            local.signum() == rise.signum() && local.unsigned_abs() >= rise.unsigned_abs() / 2
        })
    }

    /// Whether what follows is not a delay that is being made up for.
    fn stays(&self, at: usize) -> bool {
        let end = self.offsets.len();
        end - at >= self.window || self.is_level(at, end)
    }

    fn is_level(&self, from: usize, to: usize) -> bool {
        let middle = from + to.saturating_sub(from) / 2;
        let halves = self.least(from, middle).zip(self.least(middle, to));
        to.saturating_sub(from) >= LEVEL
            && halves.is_some_and(|(a, b)| a.saturating_sub(b).saturating_abs() < LEAST_NS / 2)
    }

    /// Whether one of the clocks shows it by itself.
    fn went_back(&self, at: usize) -> bool {
        steps(self.arrivals, at).is_some_and(|(device, host)| host < BACK || device < BACK)
    }
}

impl JumpReport {
    /// Whether the lidar's clock did not keep its spacing about packet `at`.
    pub fn device_jumped(&self, arrivals: &[Arrival], at: usize) -> bool {
        let near = at.saturating_sub(NEAR).max(1)..at + NEAR;
        near.filter_map(|i| steps(arrivals, i))
            .map(|(device, _)| device.as_nanos())
            .any(|device| !self.is_usual(device) && !is_frequent(arrivals, at, device))
    }

    /// A whole number of packets, some of them lost; or one of a few that came out of order.
    fn is_usual(&self, device_ns: i64) -> bool {
        let spacing = self.spacing_ns.max(1);
        let count = (device_ns.abs() + spacing / 2) / spacing;
        let off = (device_ns.abs() - count * spacing).abs();
        let ordered = device_ns > 0 && count <= MOST_LOST;
        let reordered = device_ns <= 0 && count <= NEAR as i64;
        (ordered || reordered) && off <= QUANTUM_NS + count * 10
    }
}

/// Whether a spacing is found in other places, too.
fn is_frequent(arrivals: &[Arrival], at: usize, device_ns: i64) -> bool {
    let elsewhere = (1..arrivals.len()).filter(|i| i.abs_diff(at) > 2 * NEAR);
    let alike = elsewhere
        .filter_map(|i| steps(arrivals, i))
        .filter(|(d, _)| d.as_nanos().saturating_sub(device_ns).saturating_abs() < ALIKE_NS);
    alike.take(3).count() == 3
}

/// From the packet before to this one, by the device's and the host's clock.
fn steps(arrivals: &[Arrival], at: usize) -> Option<(Span, Span)> {
    let (before, this) = (arrivals.get(at.checked_sub(1)?)?, arrivals.get(at)?);
    Some((
        this.device.saturating_since(before.device),
        this.host.saturating_since(before.host),
    ))
}

/// Host time less device time, less that of the first.
fn offsets(arrivals: &[Arrival]) -> Vec<i64> {
    let offset = |a: &Arrival| a.host.as_nanos().saturating_sub(a.device.as_nanos());
    let first = arrivals.first().map_or(0, offset);
    arrivals
        .iter()
        .map(|arrival| offset(arrival).saturating_sub(first))
        .collect()
}

/// The usual spacing of packets by the device's clock: the mean of those about the median.
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

/// The least of the last values.
#[derive(Default)]
struct SlidingMinimum {
    /// Place and value, both growing.
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

/// The least of each value and the ones after it within the window.
fn least_ahead(values: &[i64], window: usize) -> Vec<i64> {
    let mut least = SlidingMinimum::default();
    let mut ahead: Vec<i64> = Vec::with_capacity(values.len());
    // Backwards, so that what is ahead has gone before.
    for (at, value) in values.iter().rev().enumerate() {
        least.push(at, *value, window);
        ahead.push(least.get().unwrap_or(*value));
    }
    ahead.reverse();
    ahead
}
