//! Evaluates a clock along mostly increasing device times, one tangent per firing block.

use fearless_simd::prelude::*;
use units::{Host, Lidar, Span, Stamp};

use crate::clock::{ClockSegment, DeviceClock, Moment, ROUND_TO_INTEGER, round};

/// The clock over some microseconds, where it is a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tangent {
    /// Host time at its start.
    pub at: Moment,
    /// Nanoseconds that the host gains per nanosecond of the device.
    pub gain: f64,
}

/// Follows a clock through mostly increasing device times.
#[derive(Debug)]
pub(super) struct ClockCursor<'a> {
    clock: &'a DeviceClock<Lidar>,
    segment: Option<ClockSegment>,
    /// Approximate receive time of the firings that come next.
    received: Option<Stamp<Host>>,
}

/// Greatest distance of a blend from its tangent: at 1 rad/s it moves a point 100 m away by 0.05
/// nm.
const MAX_BEND_NS: f64 = 5e-4;

impl<'a> ClockCursor<'a> {
    pub(super) const fn new(clock: &'a DeviceClock<Lidar>) -> Self {
        Self {
            clock,
            segment: None,
            received: None,
        }
    }

    /// Sets the receive time of the next firings, for device times that occur twice.
    #[inline]
    pub(super) fn received(&mut self, host: Stamp<Host>) {
        if self.clock.is_cut() {
            self.received = Some(host);
            self.segment = None;
        }
    }

    /// The clock from `device` on for `length`; `None` where it is not a straight line.
    #[inline(always)]
    pub(super) fn tangent(&mut self, device: Stamp<Lidar>, length: Span) -> Option<Tangent> {
        let x = self.clock.since_origin(device);
        let segment = match &self.segment {
            Some(segment) if segment.from_ns <= x && x < segment.to_ns => segment,
            _ => self
                .segment
                .insert(self.clock.segment(device, self.received)),
        };
        let length_ns = length.as_nanos() as f64;
        (x + length_ns < segment.to_ns && segment.bend_ns(length_ns) < MAX_BEND_NS).then(|| {
            Tangent {
                at: segment.moment(device, x),
                gain: segment.slope_at(x),
            }
        })
    }
}

impl Tangent {
    /// The device's own clock, its times taken for the host's.
    #[inline(always)]
    pub(super) const fn of_device<C>(start: Stamp<C>) -> Self {
        Self {
            at: Moment::at(Stamp::from_nanos(start.as_nanos())),
            gain: 0.0,
        }
    }

    /// Host time that `length` of device time takes, to the nearest nanosecond.
    #[inline(always)]
    pub(super) fn stretched(&self, length: Span) -> Span {
        let more_ns = round(length.as_nanos() as f64 * self.gain);
        length.saturating_add(Span::from_nanos(more_ns))
    }

    /// Host times `delays_ns` of device time after the start, to the nearest nanosecond.
    #[inline(always)]
    pub(super) fn nanos<S: Simd>(&self, simd: S, delays_ns: S::f64s) -> S::i64s {
        let whole = delays_ns * (1.0 + self.gain) + self.at.rest_ns + ROUND_TO_INTEGER;
        let bits: S::i64s = whole.bitcast();
        let origin = self.at.host.as_nanos();
        bits + S::i64s::splat(simd, origin.wrapping_sub(ROUND_TO_INTEGER.to_bits() as i64))
    }
}
