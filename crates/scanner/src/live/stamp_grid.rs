//! Steps of the lidar's clock while packets come in.
//!
//! The lidar fires at an even rate, so that its stamps lie on a grid of whole packets, until its
//! clock is set. One packet off the grid shows the step up to whole packets, its delay how many. A
//! replay sees the packets after it too, and finds steps of whole packets as well.

use std::collections::VecDeque;

use units::{Lidar, Span, Stamp};

use crate::clock::{Arrival, OnlineClock};

/// Spacings that show the usual one, and how many of them have to be alike.
const REMEMBERED: usize = 16;
const MIN_ALIKE: usize = 12;
/// Stamps are whole microseconds.
const QUANTUM_NS: i64 = 3_000;
/// Least deviation of a spacing from whole packets that is irregular.
const MIN_IRREGULAR_NS: i64 = 20_000;
/// Irregular spacings that are remembered: a limited field of view has the same in each revolution.
const IRREGULAR: usize = 64;
/// The smallest step.
const SMALLEST_NS: i64 = 50_000;

/// Converts the lidar's stamps to its clock as it was at the beginning.
#[derive(Default)]
pub(super) struct StampGrid {
    shift: Span,
    last: Option<Stamp<Lidar>>,
    spacings: VecDeque<i64>,
    irregular: VecDeque<i64>,
    /// Delays beyond the clock of the last packets.
    late: VecDeque<i64>,
}

impl StampGrid {
    /// The arrival by the clock before all steps, of which this packet may show one.
    pub fn converted(&mut self, arrival: Arrival, clock: &OnlineClock) -> Arrival {
        let late_ns = |device: Stamp<Lidar>| {
            let due = clock.moment(device)?.host;
            Some(arrival.host.saturating_since(due).as_nanos())
        };
        let mut device = arrival.device.saturating_add(self.shift);
        if let Some(by) = late_ns(device).and_then(|late| self.step_ns(device, late)) {
            self.set(Span::from_nanos(-by));
            device = device.saturating_add(Span::from_nanos(-by));
        }
        if let Some(last) = self.last.replace(device) {
            keep(
                &mut self.spacings,
                device.saturating_since(last).as_nanos(),
                REMEMBERED,
            );
        }
        if let Some(late) = late_ns(device) {
            keep(&mut self.late, late, REMEMBERED);
        }
        Arrival { device, ..arrival }
    }

    /// Adds `by` to all stamps from now on.
    pub fn set(&mut self, by: Span) {
        self.shift = self.shift.saturating_add(by);
        self.last = self.last.map(|last| last.saturating_add(by));
    }

    /// By how much the lidar's clock was set forward before a packet that seems to be late by
    /// `late_ns`; `None` if it was not.
    fn step_ns(&mut self, device: Stamp<Lidar>, late_ns: i64) -> Option<i64> {
        let spacing = self.usual_ns()?;
        let seen = device.saturating_since(self.last?).as_nanos();
        let off = seen.saturating_add(spacing / 2).rem_euclid(spacing) - spacing / 2;
        if off.abs() < MIN_IRREGULAR_NS + seen.saturating_abs() / spacing * 10 {
            return None;
        }
        let is_alike = |other: &i64| other.abs_diff(seen) < MIN_IRREGULAR_NS.unsigned_abs() / 2;
        let is_known = self.irregular.iter().any(is_alike);
        keep(&mut self.irregular, seen, IRREGULAR);
        // A packet after a step forward seems to be early by as much.
        let early = late_ns.saturating_neg();
        let packets = early.saturating_sub(off).saturating_add(spacing / 2);
        let by = off.saturating_add(packets.div_euclid(spacing).saturating_mul(spacing));
        // Delays contradict where they are small.
        let is_plausible = late_ns.saturating_add(by).saturating_abs()
            < late_ns
                .saturating_abs()
                .saturating_add(self.usual_late_ns());
        (!is_known && by.abs() >= SMALLEST_NS && is_plausible).then_some(by)
    }

    /// The usual spacing; `None` before there is one.
    fn usual_ns(&self) -> Option<i64> {
        let usual = median(&self.spacings).filter(|usual| *usual > 0)?;
        let is_usual = |spacing: &&i64| spacing.abs_diff(usual) <= QUANTUM_NS.unsigned_abs();
        let alike = self.spacings.iter().filter(is_usual).count();
        (alike >= MIN_ALIKE).then_some(usual)
    }

    fn usual_late_ns(&self) -> i64 {
        median(&self.late).unwrap_or(0).saturating_abs()
    }
}

fn keep(values: &mut VecDeque<i64>, value: i64, most: usize) {
    if values.len() >= most {
        values.pop_front();
    }
    values.push_back(value);
}

fn median(values: &VecDeque<i64>) -> Option<i64> {
    let mut sorted: Vec<i64> = values.iter().copied().collect();
    sorted.sort_unstable();
    sorted.get(sorted.len() / 2).copied()
}
