//! Number of packets missing between two packets, by device time.
//!
//! Packets are sent at the model's spacing, so missing packets leave a whole number of spacings. A
//! sensor with a limited field of view is also silent within its blind sector, for a time that is
//! no such multiple. Once a jump inside a packet has revealed the blind sector, missing packets are
//! counted by azimuth without it.

use crate::block_timing::{AzimuthSteps, CONTIGUOUS_NS, REVOLUTION_CDEG, Successor, rotation};

/// Tolerance of a sector's edges: the azimuths of blocks at a gap vary by a step or two.
const EDGE_CDEG: i32 = 150;

/// Sector in which a sensor with a limited field of view does not fire.
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
            let distance = (a - b).rem_euclid(REVOLUTION_CDEG);
            distance.min(REVOLUTION_CDEG - distance) <= EDGE_CDEG
        };
        near(self.from, from) && near(self.to, to)
    }

    /// Whether an azimuth lies within the sector by more than the tolerance.
    pub(crate) fn contains(self, azimuth: i32) -> bool {
        let width = (self.to - self.from).rem_euclid(REVOLUTION_CDEG);
        let depth = (azimuth - self.from).rem_euclid(REVOLUTION_CDEG);
        EDGE_CDEG < depth && depth < width - EDGE_CDEG
    }

    /// Number of times that a rotation by `way_cdeg` from `azimuth` passes this sector.
    fn passes(self, azimuth: i32, way_cdeg: f64) -> f64 {
        let since = (azimuth - self.from - EDGE_CDEG).rem_euclid(REVOLUTION_CDEG);
        ((f64::from(since) + way_cdeg) / f64::from(REVOLUTION_CDEG)).floor()
    }
}

/// Number of packets missing between a packet with these steps and its successor.
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

/// Spacings in the excess time; 0 if it is no whole number of them.
fn by_time(steps: &AzimuthSteps, excess_ns: i64) -> i64 {
    let spacing = steps.fill_ns();
    let count = excess_ns.saturating_add(spacing / 2) / spacing;
    let off = (excess_ns - count * spacing).abs();
    // A clock that is steered by a pulse per second deviates by some tens of ppm (61 allowed).
    if off <= CONTIGUOUS_NS + (excess_ns >> 14) {
        count
    } else {
        0
    }
}

/// Rotation between the packets without the blind sector, in packets.
fn by_azimuth(steps: &AzimuthSteps, next: Successor, blind: BlindSector, excess_ns: i64) -> i64 {
    let revolution = f64::from(REVOLUTION_CDEG);
    let step = f64::from(rotation(steps.last_azimuth(), next.azimuth_cdeg));
    let swept = (excess_ns as f64 - steps.gaps_ns()) / steps.fill_ns() as f64 * steps.fill_cdeg();
    let way = step
        + ((swept + steps.mean_cdeg - step) / revolution)
            .round()
            .max(0.0)
            * revolution;
    let width = f64::from(rotation(blind.from, blind.to)) - steps.mean_cdeg;
    let fired = way - blind.passes(steps.last_azimuth(), way) * width;
    ((fired - steps.mean_cdeg) / steps.fill_cdeg()).round() as i64
}
