//! Steps of the lidar's clock by whole packets.
//!
//! The spacing after such a step is that of lost packets, or of reordered ones. But lost packets
//! take time on the host's clock too, and reordered ones are made up for. A step does neither: the
//! delays change by as much, at once and for good.

use units::Span;

use super::{
    Evidence, Jump, JumpReport, MIN_IRREGULAR_NS, MIN_LEVEL_PACKETS, QUANTUM_NS, SILENCE,
    SMALL_WINDOW, steps,
};
use crate::clock::Arrival;

/// Packets on either side over which the delays stay changed: 1.4 s.
const LASTING_PACKETS: usize = 4 * SMALL_WINDOW;

/// Deviation from whole packets up to which packets are counted as lost, as by the decoder: that
/// of a stamp, and of a steered clock.
const PHANTOM_NS: i64 = 20_000;

impl JumpReport {
    /// Packets that seem to be missing after a step of the lidar's clock by `by`.
    pub fn phantom_packets(&self, by: Span) -> u64 {
        let (by, spacing) = (by.as_nanos(), self.spacing_ns.max(1));
        let count = by.saturating_add(spacing / 2).div_euclid(spacing);
        let off = (by - count * spacing).abs();
        let is_whole = off <= PHANTOM_NS + (by >> 14);
        u64::try_from(count).ok().filter(|_| is_whole).unwrap_or(0)
    }

    /// For how long no packet came before packet `at`, by the lidar's clock; zero if that is no
    /// whole number of packets, as after a step of that clock.
    pub fn silence(&self, at: usize) -> Span {
        let spacing = self.spacing_ns.max(1);
        let device = steps(&self.level, at).map_or(Span::ZERO, |(device, _)| device);
        let count = (device.as_nanos() + spacing / 2) / spacing;
        let off = (device.as_nanos() - count * spacing).saturating_abs();
        match count > 1 && off <= QUANTUM_NS + count * 10 {
            true => device,
            false => Span::ZERO,
        }
    }

    pub(super) fn jumps_of_whole_packets(
        &self,
        arrivals: &[Arrival],
        offsets: &[i64],
    ) -> Vec<Jump> {
        let mut found: Vec<Jump> = Vec::new();
        for at in MIN_LEVEL_PACKETS..arrivals.len().saturating_sub(MIN_LEVEL_PACKETS) {
            let is_apart = found.last().is_none_or(|last| at - last.at > SMALL_WINDOW);
            if is_apart
                && self.is_apart(at)
                && let Some(by) = self.whole_packets_at(arrivals, offsets, at)
            {
                found.push(Jump {
                    at,
                    by: Span::from_nanos(by),
                    evidence: Evidence::Grid,
                });
            }
        }
        found
    }

    /// Change of the delays by whole packets at `at`.
    fn whole_packets_at(&self, arrivals: &[Arrival], offsets: &[i64], at: usize) -> Option<i64> {
        let device_ns = steps(arrivals, at)?.0.as_nanos();
        let spacing = self.spacing_ns.max(1);
        let count = device_ns.saturating_add(spacing / 2).div_euclid(spacing);
        let off = device_ns - count * spacing;
        let is_silent = device_ns > SILENCE.as_nanos();
        if count == 1 || is_silent || off.abs() >= MIN_IRREGULAR_NS + count.saturating_abs() * 10 {
            return None;
        }
        let rise = self.rise_at(offsets, at, SMALL_WINDOW)?;
        // Packets may be lost at the same time.
        let whole = rise
            .saturating_neg()
            .saturating_sub(off)
            .saturating_add(spacing / 2)
            .div_euclid(spacing);
        let by = -(off + whole * spacing);
        let lasting = self.rise_at(offsets, at, LASTING_PACKETS)?;
        let is_lasting = lasting.signum() == by.signum()
            && lasting.saturating_abs() > by.saturating_abs() / 10 * 7;
        let is_confirmed = rise.saturating_sub(by).saturating_abs() < spacing / 4;
        (whole != 0 && is_confirmed && is_lasting).then_some(by)
    }
}
