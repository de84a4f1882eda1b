//! What one block of a packet holds, or one pair of blocks with dual returns: 32 channels that are placed together.
//!
//! A [`Volley`] is two firings of a 16-laser model, or one of a 32-laser one. [`Volley::firings`] is the plain way on;
//! [`Volley::place`] is the fast one, a column at a time, and gives the same points to some 1e-14 of their distance.
//! Left out: everything after the sensor's own frame.

use protocol::vlp16::{CHANNELS, Model};
use units::{Lidar, Span, Stamp};

use crate::firing::{Channels, Duplicates, Echo, Firing};
use crate::geometry::Geometry;
use crate::rotor::{Ahead, SinCos};

/// The channels of a block as they are on the wire.
pub(crate) type Raw = [[u8; 3]; CHANNELS];

/// Room for the distances of a block or of a pair.
pub(crate) type Counts = [[u16; CHANNELS]; 2];

/// The returns of one block: each channel's only one, or of a pair of blocks each channel's first or second.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    raw: &'a Raw,
    counts: &'a [u16; CHANNELS],
    kept: u32,
}

/// The firings of one block.
#[derive(Clone, Copy, Debug)]
pub struct Volley<'a> {
    /// When channel 0 fired.
    pub start: Stamp<Lidar>,
    pub(crate) azimuth_cdeg: i32,
    pub(crate) pace_cdeg: f64,
    pub(crate) geometry: &'a Geometry,
    pub(crate) azimuth: SinCos,
    pub(crate) ahead: &'a Ahead,
    pub(crate) returns: Layers<'a>,
}

/// One block, or a pair of them.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Layers<'a> {
    One {
        only: Layer<'a>,
        echo: Echo,
    },
    Two {
        last: Layer<'a>,
        strongest: Layer<'a>,
        duplicates: Duplicates,
    },
}

impl<'a> Layer<'a> {
    #[inline(always)]
    fn new(raw: &'a Raw, counts: &'a mut [u16; CHANNELS]) -> Self {
        for (count, [lo, hi, _]) in counts.iter_mut().zip(raw) {
            *count = u16::from_le_bytes([*lo, *hi]);
        }
        let kept = nonzero(counts);
        Self { raw, counts, kept }
    }

    /// Bit c is set where channel c has a return that is to become a point.
    #[inline]
    #[must_use]
    pub const fn kept(&self) -> u32 {
        self.kept
    }

    /// Each channel's calibrated reflectivity.
    #[inline]
    pub fn reflectivities(&self, out: &mut [u8; CHANNELS]) {
        for (out, [_, _, reflectivity]) in out.iter_mut().zip(self.raw) {
            *out = *reflectivity;
        }
    }
}

impl<'a> Layers<'a> {
    #[inline(always)]
    pub(crate) fn one(raw: &'a Raw, counts: &'a mut Counts, echo: Echo) -> Self {
        let [counts, _] = counts;
        Self::One {
            only: Layer::new(raw, counts),
            echo,
        }
    }

    #[inline(always)]
    pub(crate) fn two(
        last: &'a Raw,
        strongest: &'a Raw,
        counts: &'a mut Counts,
        duplicates: Duplicates,
    ) -> Self {
        let [even, odd] = counts;
        let (last, mut strongest) = (Layer::new(last, even), Layer::new(strongest, odd));
        if duplicates == Duplicates::Unique {
            strongest.kept &= different(last.counts, strongest.counts);
        }
        Self::Two {
            last,
            strongest,
            duplicates,
        }
    }

    /// Channels with a distance, and the same with equal pairs counted once.
    #[inline(always)]
    pub(crate) fn count(&self) -> (u64, u64) {
        let ones = |mask: u32| u64::from(mask.count_ones());
        match self {
            Self::One { only, .. } => {
                let returns = ones(only.kept);
                (returns, returns)
            }
            Self::Two {
                last, strongest, ..
            } => {
                let equal = last.kept & !different(last.counts, strongest.counts);
                let returns = ones(last.kept) + ones(nonzero(strongest.counts));
                (returns, returns - ones(equal))
            }
        }
    }
}

impl<'a> Volley<'a> {
    /// The model it was decoded as.
    #[must_use]
    pub const fn model(&self) -> &'static Model {
        self.geometry.model
    }

    /// The returns, and with dual returns each channel's second ones. Of one channel the first comes first.
    #[inline]
    #[must_use]
    pub const fn layers(&self) -> (&Layer<'a>, Option<&Layer<'a>>) {
        match &self.returns {
            Layers::One { only, .. } => (only, None),
            Layers::Two {
                last, strongest, ..
            } => (last, Some(strongest)),
        }
    }

    /// When each channel fired, in nanoseconds after the start.
    #[inline]
    #[must_use]
    pub const fn delays_ns(&self) -> &'a [i64; CHANNELS] {
        &self.geometry.fan.delay_ns
    }

    /// The same as floating-point numbers.
    #[inline]
    #[must_use]
    pub const fn delays_f64_ns(&self) -> &'a [f64; CHANNELS] {
        &self.geometry.fan.delay_f64_ns
    }

    /// From the start to when the last channel fired.
    #[inline]
    #[must_use]
    pub const fn length(&self) -> Span {
        self.geometry.fan.length
    }

    /// Variance of each channel's azimuth, square radians ([`crate::azimuth_variance_rad2`]).
    #[inline]
    #[must_use]
    pub const fn azimuth_variances_rad2(&self) -> &'a [f64; CHANNELS] {
        &self.geometry.fan.azimuth_variance_rad2
    }

    /// Each channel's laser, by its place in the firing order.
    #[inline]
    #[must_use]
    pub const fn lasers(&self) -> &'a [u8; CHANNELS] {
        &self.geometry.fan.laser
    }

    /// Each channel's place by elevation, 0 the lowest.
    #[inline]
    #[must_use]
    pub const fn rings(&self) -> &'a [u8; CHANNELS] {
        &self.geometry.fan.ring
    }

    /// The points of every channel of a layer, each as `frame` makes it of the point in the sensor's frame (x right, y forward,
    /// z up, metres) and its channel. A channel without a return gets a place of no meaning.
    #[inline(always)]
    pub fn place(
        &self,
        layer: &Layer<'_>,
        frame: impl Fn(usize, [f64; 3]) -> [f64; 3],
        x_m: &mut [f64; CHANNELS],
        y_m: &mut [f64; CHANNELS],
        z_m: &mut [f64; CHANNELS],
    ) {
        let (fan, ahead, azimuth) = (&self.geometry.fan, self.ahead, self.azimuth);
        let across = |i: usize| azimuth.sin * ahead.cos[i] + azimuth.cos * ahead.sin[i];
        let along = |i: usize| azimuth.cos * ahead.cos[i] - azimuth.sin * ahead.sin[i];
        let counts = layer.counts;
        match &fan.aside_counts {
            None => {
                for i in 0..CHANNELS {
                    let count = f64::from(counts[i]);
                    let out = count + fan.out_counts[i];
                    let up_m = count * fan.up_per_count[i] + fan.up_m[i];
                    let point = frame(i, [out * across(i), out * along(i), up_m]);
                    [x_m[i], y_m[i], z_m[i]] = point;
                }
            }
            Some(aside) => {
                for i in 0..CHANNELS {
                    let count = f64::from(counts[i]);
                    let out = count + fan.out_counts[i];
                    let x_m_i = out * across(i) - aside[i] * along(i);
                    let y_m_i = out * along(i) + aside[i] * across(i);
                    let up_m = count * fan.up_per_count[i] + fan.up_m[i];
                    [x_m[i], y_m[i], z_m[i]] = frame(i, [x_m_i, y_m_i, up_m]);
                }
            }
        }
    }

    /// The firings one by one, in order of time.
    pub fn firings(&self) -> impl ExactSizeIterator<Item = Firing<'a>> + use<'a> {
        let volley = *self;
        let model = volley.geometry.model;
        let period_ns = f64::from(model.block_period_ns());
        let firing_cdeg = volley.pace_cdeg / model.firings_per_block as f64;
        (0..model.firings_per_block).map(move |n| {
            let after = Span::from_nanos(n as i64 * i64::from(model.firing_period_ns));
            let azimuth_cdeg = f64::from(volley.azimuth_cdeg) + firing_cdeg * n as f64;
            Firing {
                start: volley.start + after,
                azimuth_deg: (azimuth_cdeg / 100.0).rem_euclid(360.0),
                azimuth_rate_deg_s: volley.pace_cdeg / 100.0 / (period_ns * 1e-9),
                model,
                rays: &volley.geometry.rays,
                channels: volley.channels(n),
                part: after.as_nanos() as f64 / period_ns,
            }
        })
    }

    /// The channels of firing `n`.
    fn channels(&self, n: usize) -> Channels<'a> {
        let lasers = self.geometry.model.lasers.len();
        let of = |layer: &Layer<'a>| {
            let raw = layer.raw.get(n * lasers..(n + 1) * lasers);
            raw.unwrap_or_default()
        };
        match &self.returns {
            Layers::One { only, echo } => Channels::One {
                raw: of(only),
                echo: *echo,
            },
            Layers::Two {
                last,
                strongest,
                duplicates,
            } => Channels::Two {
                last: of(last),
                strongest: of(strongest),
                duplicates: *duplicates,
            },
        }
    }
}

/// The channels with a distance.
#[inline]
fn nonzero(counts: &[u16; CHANNELS]) -> u32 {
    different(counts, &[0; CHANNELS])
}

/// The channels in which two returns differ.
#[inline]
fn different(a: &[u16; CHANNELS], b: &[u16; CHANNELS]) -> u32 {
    let (a, b) = (a.as_chunks::<16>().0, b.as_chunks::<16>().0);
    let halves = a.iter().zip(b).rev();
    halves.fold(0, |mask, (a, b)| mask << 16 | u32::from(half(a, b)))
}

/// A bit for each place in which two halves differ, as a sum of columns rather than bit by bit.
#[inline(always)]
fn half(a: &[u16; 16], b: &[u16; 16]) -> u16 {
    const BITS: [u16; 16] = {
        let mut bits = [0; 16];
        let mut i = 0;
        while i < 16 {
            bits[i] = 1 << i;
            i += 1;
        }
        bits
    };
    let mut mask = 0;
    for ((a, b), bit) in a.iter().zip(b).zip(&BITS) {
        mask |= if a == b { 0 } else { *bit };
    }
    mask
}
