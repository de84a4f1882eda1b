//! A stretch of device time over which a clock blends linearly from one line into another.

use units::{Host, Stamp};

/// A host time and its remainder below a nanosecond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// To the nearest nanosecond.
    pub host: Stamp<Host>,
    /// The exact instant is this many nanoseconds later, -0.5 to 0.5.
    pub rest_ns: f64,
}

/// Offset over device time: `offset_ns + slope * (x - centre_ns)`, with x in nanoseconds after the
/// clock's origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OffsetLine {
    pub centre_ns: f64,
    pub offset_ns: f64,
    pub slope: f64,
}

/// A stretch of device time over which the clock blends from one line into another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClockSegment {
    /// Whole nanoseconds from device time to host time, without the offsets of the lines.
    pub whole: i64,
    pub from_ns: f64,
    pub to_ns: f64,
    pub first: OffsetLine,
    pub second: Option<OffsetLine>,
    /// Device times up to which `first` and from which `second` holds alone.
    pub blend_ns: (f64, f64),
}

impl Moment {
    /// An instant of a whole nanosecond.
    #[must_use]
    pub const fn at(host: Stamp<Host>) -> Self {
        Self { host, rest_ns: 0.0 }
    }

    /// Whether it is `host` or later.
    #[must_use]
    pub fn reaches(&self, host: Stamp<Host>) -> bool {
        self.host > host || (self.host == host && self.rest_ns >= 0.0)
    }
}

impl OffsetLine {
    pub(super) const NONE: Self = Self {
        centre_ns: 0.0,
        offset_ns: 0.0,
        slope: 0.0,
    };

    #[inline(always)]
    pub fn at(self, x: f64) -> f64 {
        self.offset_ns + self.slope * (x - self.centre_ns)
    }
}

impl ClockSegment {
    /// The segment of a clock without a line.
    pub(super) const NONE: Self = Self {
        whole: 0,
        from_ns: f64::NEG_INFINITY,
        to_ns: f64::INFINITY,
        first: OffsetLine::NONE,
        second: None,
        blend_ns: (f64::NEG_INFINITY, f64::INFINITY),
    };

    /// One line.
    pub(super) const fn straight(first: OffsetLine, whole: i64) -> Self {
        Self {
            whole,
            first,
            ..Self::NONE
        }
    }

    #[inline(always)]
    pub fn moment<C>(&self, device: Stamp<C>, x: f64) -> Moment {
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

    /// The derivative of the offset.
    #[inline(always)]
    pub fn slope_at(&self, x: f64) -> f64 {
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

    /// Distance of the blend from its tangent after `length_ns`: half of the second derivative
    /// times the length squared.
    #[inline(always)]
    pub fn bend_ns(&self, length_ns: f64) -> f64 {
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

/// 1.5 x 2^52: a number below 2^51, with this added, has its nearest integer in the low bits.
pub(crate) const ROUND_TO_INTEGER: f64 = 6_755_399_441_055_744.0;

/// The nearest whole number, the even one from halfway.
#[inline(always)]
pub(crate) fn round(x: f64) -> i64 {
    // f64::round is a call on most processors, and a saturating cast takes several steps.
    if x.abs() < ROUND_TO_INTEGER / 4.0 {
        (x + ROUND_TO_INTEGER).to_bits() as i64 - ROUND_TO_INTEGER.to_bits() as i64
    } else {
        round_large(x)
    }
}

#[cold]
fn round_large(x: f64) -> i64 {
    x.round() as i64
}
