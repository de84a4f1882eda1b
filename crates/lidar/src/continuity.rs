//! How many packets are missing between two, by device time.
//!
//! Packets leave at the model's spacing, so that missing ones leave a whole number of spacings. A
//! sensor with a limited field of view is also silent while it looks away, for a time that is no
//! such multiple; once a jump inside a packet has shown where it looks away, missing packets are
//! counted by azimuth, that sector left out. Left out: what the missing packets held.

use crate::plan::{AzimuthSteps, CONTIGUOUS_NS, REVOLUTION_CDEG, Successor, turned};

/// Where blocks fall before and after the gap varies by a step or two.
const EDGE_CDEG: i32 = 150;

/// The sector in which a sensor with a limited field of view does not fire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BlindSector {
    /// Azimuth of the last block before the gap.
    pub from: i32,
    /// Azimuth of the first block after it.
    pub to: i32,
}

impl BlindSector {
    /// Whether a step from `from` to `to` skips this sector and nothing else.
    pub(crate) fn is_between(self, from: i32, to: i32) -> bool {
        let near = |a: i32, b: i32| {
            let apart = (a - b).rem_euclid(REVOLUTION_CDEG);
            apart.min(REVOLUTION_CDEG - apart) <= EDGE_CDEG
        };
        near(self.from, from) && near(self.to, to)
    }

    /// Whether an azimuth lies well within the sector.
    pub(crate) fn hides(self, azimuth: i32) -> bool {
        let width = (self.to - self.from).rem_euclid(REVOLUTION_CDEG);
        let depth = (azimuth - self.from).rem_euclid(REVOLUTION_CDEG);
        EDGE_CDEG < depth && depth < width - EDGE_CDEG
    }

    /// How often a way of `way_cdeg` forward from `azimuth` passes this sector.
    fn passes(self, azimuth: i32, way_cdeg: f64) -> f64 {
        let since = (azimuth - self.from - EDGE_CDEG).rem_euclid(REVOLUTION_CDEG);
        ((f64::from(since) + way_cdeg) / f64::from(REVOLUTION_CDEG)).floor()
    }
}

/// Packets missing between a packet with these steps and its successor.
pub(crate) fn missing(steps: &AzimuthSteps, next: Successor, blind: Option<BlindSector>) -> u64 {
    let excess_ns = next.after.as_nanos().saturating_sub(steps.fill_ns());
    if excess_ns <= CONTIGUOUS_NS {
        return 0;
    }
    let count = match blind {
        Some(blind) if steps.mean_cdeg > 0.0 => by_azimuth(steps, next, blind, excess_ns),
        _ => by_time(steps, excess_ns),
    };
    u64::try_from(count).unwrap_or(0)
}

/// Whole spacings in the excess; 0 where it is no whole number of them.
fn by_time(steps: &AzimuthSteps, excess_ns: i64) -> i64 {
    let spacing = steps.fill_ns();
    let count = excess_ns.saturating_add(spacing / 2) / spacing;
    let off = (excess_ns - count * spacing).abs();
    // Being steered by a pulse per second moves the clock by some tens of ppm.
    if off <= CONTIGUOUS_NS + (excess_ns >> 14) {
        count
    } else {
        0
    }
}

/// The way the rotor went between the packets, without the blind sector, in packets.
fn by_azimuth(steps: &AzimuthSteps, next: Successor, blind: BlindSector, excess_ns: i64) -> i64 {
    let turn = f64::from(REVOLUTION_CDEG);
    let step = f64::from(turned(steps.last_azimuth(), next.azimuth_cdeg));
    let swept = (excess_ns as f64 - steps.gaps_ns()) / steps.fill_ns() as f64 * steps.fill_cdeg();
    let way = step + ((swept + steps.mean_cdeg - step) / turn).round().max(0.0) * turn;
    let width = f64::from(turned(blind.from, blind.to)) - steps.mean_cdeg;
    let fired = way - blind.passes(steps.last_azimuth(), way) * width;
    ((fired - steps.mean_cdeg) / steps.fill_cdeg()).round() as i64
}
