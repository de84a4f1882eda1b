//! A clock asked for one instant after the other: the fast path.
//!
//! Left out: how the clock was found.

use fearless_simd::prelude::*;
use units::{Host, Lidar, Span, Stamp};

use super::device::{DeviceClock, Line};

/// A host time and what is left of it below a nanosecond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// To the nearest nanosecond.
    pub host: Stamp<Host>,
    /// The true instant is this many nanoseconds later, -0.5 to 0.5.
    pub rest_ns: f64,
}

/// The clock over some microseconds, where it is a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangent {
    /// Host time at its start.
    pub at: Moment,
    /// Nanoseconds that the host gains per nanosecond of the device.
    pub gain: f64,
}

/// Follows a clock through device times that mostly grow.
#[derive(Debug)]
pub struct ClockCursor<'a, C = Lidar> {
    clock: &'a DeviceClock<C>,
    segment: Option<Segment>,
    /// About when what is asked for arrived.
    near: Option<Stamp<Host>>,
}

/// A stretch of device time over which the clock blends from one line into the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    /// Whole nanoseconds from device time to host time, beside the lines' offsets.
    pub whole: i64,
    pub from_ns: f64,
    pub to_ns: f64,
    pub first: Line,
    pub second: Option<Line>,
    /// Where `first` and `second` hold alone.
    pub blend_ns: (f64, f64),
}

/// A blend may bend away from its tangent by this much: at 1 rad/s it moves a point 100 m away by 0.05 nm.
const MOST_BEND_NS: f64 = 5e-4;

impl<'a, C> ClockCursor<'a, C> {
    pub(super) const fn new(clock: &'a DeviceClock<C>) -> Self {
        Self {
            clock,
            segment: None,
            near: None,
        }
    }

    /// Tells about when what is asked for next arrived, for device times that came twice (a device that was set back).
    #[inline]
    pub fn near(&mut self, host: Stamp<Host>) {
        if self.clock.is_cut() {
            self.near = Some(host);
            self.segment = None;
        }
    }

    /// The clock from `device` on for `length`. `None` where it is no straight line there: ask it instant by instant.
    #[inline(always)]
    pub fn tangent(&mut self, device: Stamp<C>, length: Span) -> Option<Tangent> {
        let x = self.clock.since_origin(device);
        let segment = match &self.segment {
            Some(segment) if segment.from_ns <= x && x < segment.to_ns => segment,
            _ => self.segment.insert(self.clock.segment(device, self.near)),
        };
        let length_ns = length.as_nanos() as f64;
        (x + length_ns < segment.to_ns && segment.bend_ns(length_ns) < MOST_BEND_NS).then(|| {
            Tangent {
                at: segment.moment(device, x),
                gain: segment.slope_at(x),
            }
        })
    }
}

// A derive would ask for `C: Clone`; the clock's name is only a name.
impl<C> Clone for ClockCursor<'_, C> {
    fn clone(&self) -> Self {
        Self {
            clock: self.clock,
            segment: self.segment,
            near: self.near,
        }
    }
}

impl Moment {
    /// Whether it is `host` or later.
    #[must_use]
    pub fn reaches(&self, host: Stamp<Host>) -> bool {
        self.host > host || (self.host == host && self.rest_ns >= 0.0)
    }
}

impl Tangent {
    /// The device's own clock, its times taken for the host's.
    #[inline(always)]
    #[must_use]
    pub const fn of_device<C>(start: Stamp<C>) -> Self {
        Self {
            at: Moment {
                host: Stamp::from_nanos(start.as_nanos()),
                rest_ns: 0.0,
            },
            gain: 0.0,
        }
    }

    /// How long `length` of the device's time takes the host, to the nearest nanosecond.
    #[inline(always)]
    #[must_use]
    pub fn stretched(&self, length: Span) -> Span {
        let more_ns = round(length.as_nanos() as f64 * self.gain);
        length.saturating_add(Span::from_nanos(more_ns))
    }

    /// Host times that are `delays_ns` after the start by the device's clock, to the nearest nanosecond.
    #[inline(always)]
    #[must_use]
    pub fn nanos<S: Simd>(&self, simd: S, delays_ns: S::f64s) -> S::i64s {
        let whole = delays_ns * (1.0 + self.gain) + self.at.rest_ns + NO_FRACTION;
        let bits: S::i64s = whole.bitcast();
        let origin = self.at.host.as_nanos();
        bits + S::i64s::splat(simd, origin.wrapping_sub(NO_FRACTION.to_bits() as i64))
    }
}

impl Segment {
    #[inline(always)]
    pub(super) fn moment<C>(&self, device: Stamp<C>, x: f64) -> Moment {
        // Only the small remainder goes through floating point: the sum stays exact at any date.
        let offset_ns = self.offset_at(x);
        let fine = round(offset_ns);
        let host = device
            .as_nanos()
            .wrapping_add(self.whole)
            .wrapping_add(fine);
        Moment {
            host: Stamp::from_nanos(host),
            rest_ns: offset_ns - fine as f64,
        }
    }

    #[inline(always)]
    fn offset_at(&self, x: f64) -> f64 {
        match self.second {
            Some(after) => {
                let weight = self.weight(x);
                self.first.at(x) * (1.0 - weight) + after.at(x) * weight
            }
            None => self.first.at(x),
        }
    }

    /// The derivative of [`Segment::offset_at`].
    #[inline(always)]
    fn slope_at(&self, x: f64) -> f64 {
        match self.second {
            Some(after) => {
                let weight = self.weight(x);
                self.first.slope * (1.0 - weight)
                    + after.slope * weight
                    + (after.at(x) - self.first.at(x)) / (self.blend_ns.1 - self.blend_ns.0)
            }
            None => self.first.slope,
        }
    }

    /// How far the blend is from its tangent after `length_ns`: half of the second derivative times the length squared.
    #[inline(always)]
    fn bend_ns(&self, length_ns: f64) -> f64 {
        self.second.map_or(0.0, |after| {
            let bend = (after.slope - self.first.slope) / (self.blend_ns.1 - self.blend_ns.0);
            bend.abs() * length_ns * length_ns
        })
    }

    #[inline(always)]
    fn weight(&self, x: f64) -> f64 {
        (x - self.blend_ns.0) / (self.blend_ns.1 - self.blend_ns.0)
    }
}

/// 1.5 x 2^52: with this added a number below 2^51 has no room left for a fraction, and its nearest integer in the low bits.
const NO_FRACTION: f64 = 6_755_399_441_055_744.0;

/// To the nearest whole number, and to the even one from halfway.
#[inline(always)]
fn round(x: f64) -> i64 {
    // f64::round is a call on most processors, and a cast that saturates takes several steps.
    if x.abs() < NO_FRACTION / 4.0 {
        (x + NO_FRACTION).to_bits() as i64 - NO_FRACTION.to_bits() as i64
    } else {
        round_far(x)
    }
}

#[cold]
fn round_far(x: f64) -> i64 {
    x.round() as i64
}
