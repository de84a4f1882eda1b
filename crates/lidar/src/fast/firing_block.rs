//! What one block of a packet holds, or one pair of blocks with dual returns: 32 channels that are
//! placed together.
//!
//! A [`FiringBlock`] is two firings of a 16-laser model, or one of a 32-laser one.
//! [`FiringBlock::firings`] is the plain way on; [`FiringBlock::place`] is the fast one, several
//! channels at a time, and gives the same points to some 1e-14 of their distance. Left out:
//! everything after the sensor's own frame.

use protocol::vlp16::{CHANNELS, Model};
use units::{Lidar, Real, Span, Stamp};

use super::azimuth::{PaceOffsets, SinCos};
use super::unpack::{RawChannels, UnpackedBlock};
use crate::firing::{Duplicates, Echo, Firing, FiringChannels};
use crate::geometry::Geometry;

/// The returns of one block: each channel's only one, or of a pair of blocks each channel's first
/// or second.
#[derive(Clone, Copy, Debug)]
pub struct ReturnLayer<'a> {
    raw: &'a RawChannels,
    sorted: &'a UnpackedBlock,
    kept: u32,
}

/// The firings of one block.
#[derive(Clone, Copy, Debug)]
pub struct FiringBlock<'a> {
    /// When channel 0 fired.
    pub start: Stamp<Lidar>,
    pub(crate) azimuth_cdeg: i32,
    pub(crate) pace_cdeg: f64,
    pub(crate) geometry: &'a Geometry,
    pub(crate) azimuth: SinCos,
    pub(crate) ahead: &'a PaceOffsets,
    pub(crate) returns: BlockReturns<'a>,
}

/// Where channels look along the horizon: one, or several.
#[derive(Clone, Copy, Debug)]
pub struct Heading<V> {
    /// How far right a count gets, metres.
    across: V,
    /// How far forward, metres.
    along: V,
}

/// One block, or a pair of them.
#[derive(Clone, Copy, Debug)]
pub(crate) enum BlockReturns<'a> {
    One {
        only: ReturnLayer<'a>,
        echo: Echo,
    },
    Two {
        last: ReturnLayer<'a>,
        strongest: ReturnLayer<'a>,
        duplicates: Duplicates,
    },
}

impl<'a> ReturnLayer<'a> {
    #[inline(always)]
    pub(crate) const fn new(raw: &'a RawChannels, sorted: &'a UnpackedBlock) -> Self {
        Self {
            raw,
            sorted,
            kept: sorted.returns,
        }
    }

    /// Bit c is set where channel c has a return that is to become a point.
    #[inline]
    #[must_use]
    pub const fn kept(&self) -> u32 {
        self.kept
    }

    /// Each channel's distance in the model's unit; 0 where nothing came back.
    #[inline]
    #[must_use]
    pub const fn counts(&self) -> &'a [f64; CHANNELS] {
        &self.sorted.counts
    }

    /// Each channel's calibrated reflectivity.
    #[inline]
    #[must_use]
    pub const fn reflectivities(&self) -> &'a [u8; CHANNELS] {
        &self.sorted.reflectivities
    }
}

impl<'a> BlockReturns<'a> {
    #[inline(always)]
    pub(crate) const fn one(only: ReturnLayer<'a>, echo: Echo) -> Self {
        Self::One { only, echo }
    }

    #[inline(always)]
    pub(crate) fn two(
        last: ReturnLayer<'a>,
        strongest: ReturnLayer<'a>,
        duplicates: Duplicates,
    ) -> Self {
        let mut strongest = strongest;
        if duplicates == Duplicates::Unique {
            strongest.kept &= strongest.sorted.changed;
        }
        Self::Two {
            last,
            strongest,
            duplicates,
        }
    }

    /// FiringChannels with a distance, and the same with equal pairs counted once.
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
                let equal = last.kept & !strongest.sorted.changed;
                let returns = ones(last.kept) + ones(strongest.sorted.returns);
                (returns, returns - ones(equal))
            }
        }
    }
}

impl<'a> FiringBlock<'a> {
    /// The model it was decoded as.
    #[must_use]
    pub const fn model(&self) -> &'static Model {
        self.geometry.model
    }

    /// The returns, and with dual returns each channel's second ones. Of one channel the first
    /// comes first.
    #[inline]
    #[must_use]
    pub const fn layers(&self) -> (&ReturnLayer<'a>, Option<&ReturnLayer<'a>>) {
        match &self.returns {
            BlockReturns::One { only, .. } => (only, None),
            BlockReturns::Two {
                last, strongest, ..
            } => (last, Some(strongest)),
        }
    }

    /// Which return each channel's is ([`Echo::code`]), a row a layer; of no meaning where a
    /// channel has none.
    #[inline(never)]
    #[must_use]
    pub fn echo_codes(&self) -> [[u8; CHANNELS]; 2] {
        match &self.returns {
            BlockReturns::One { echo, .. } => [[echo.code(); CHANNELS]; 2],
            BlockReturns::Two { strongest, .. } => {
                let changed = strongest.sorted.changed;
                let codes = |apart: Echo| {
                    core::array::from_fn(|channel| match changed >> channel & 1 {
                        0 => Echo::LastAndStrongest.code(),
                        _ => apart.code(),
                    })
                };
                [codes(Echo::Last), codes(Echo::StrongestOrSecond)]
            }
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

    /// Where channels look along the horizon: how far right and forward they get by one count. `of`
    /// takes the values of some channels, the same ones every time, from a column of all.
    #[inline(always)]
    pub fn heading<V: Real>(&self, of: impl Fn(&[f64; CHANNELS]) -> V) -> Heading<V> {
        let (SinCos { sin, cos }, ahead) = (self.azimuth, self.ahead);
        let (ahead_sin, ahead_cos) = (of(&ahead.sin), of(&ahead.cos));
        Heading {
            across: ahead_cos * sin + ahead_sin * cos,
            along: ahead_cos * cos - ahead_sin * sin,
        }
    }

    /// The points of channels in the sensor's frame (x right, y forward, z up, metres) from their
    /// distance counts. Of a channel without a return that is a place of no meaning.
    #[inline(always)]
    pub fn place<V: Real>(
        &self,
        counts: V,
        heading: Heading<V>,
        of: impl Fn(&[f64; CHANNELS]) -> V,
    ) -> [V; 3] {
        let (fan, Heading { across, along }) = (&self.geometry.fan, heading);
        let out = counts + of(&fan.out_counts);
        let up_m = counts * of(&fan.up_per_count) + of(&fan.up_m);
        match &fan.aside_counts {
            None => [out * across, out * along, up_m],
            Some(aside) => {
                let aside = of(aside);
                let x_m = out * across - aside * along;
                [x_m, out * along + aside * across, up_m]
            }
        }
    }

    /// The firings one by one, in order of time.
    pub fn firings(&self) -> impl ExactSizeIterator<Item = Firing<'a>> + use<'a> {
        let block = *self;
        let model = block.geometry.model;
        let period_ns = f64::from(model.block_period_ns());
        let firing_cdeg = block.pace_cdeg / model.firings_per_block as f64;
        (0..model.firings_per_block).map(move |n| {
            let after = Span::from_nanos(n as i64 * i64::from(model.firing_period_ns));
            let azimuth_cdeg = f64::from(block.azimuth_cdeg) + firing_cdeg * n as f64;
            Firing {
                start: block.start + after,
                azimuth_deg: (azimuth_cdeg / 100.0).rem_euclid(360.0),
                azimuth_rate_deg_s: block.pace_cdeg / 100.0 / (period_ns * 1e-9),
                model,
                rays: &block.geometry.rays,
                channels: block.channels(n),
                part: after.as_nanos() as f64 / period_ns,
            }
        })
    }

    /// The channels of firing `n`.
    fn channels(&self, n: usize) -> FiringChannels<'a> {
        let lasers = self.geometry.model.lasers.len();
        let of = |layer: &ReturnLayer<'a>| {
            let raw = layer.raw.get(n * lasers..(n + 1) * lasers);
            raw.unwrap_or_default()
        };
        match &self.returns {
            BlockReturns::One { only, echo } => FiringChannels::One {
                raw: of(only),
                echo: *echo,
            },
            BlockReturns::Two {
                last,
                strongest,
                duplicates,
            } => FiringChannels::Two {
                last: of(last),
                strongest: of(strongest),
                duplicates: *duplicates,
            },
        }
    }
}
