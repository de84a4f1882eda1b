//! The firings of one block, or of a pair of blocks with dual returns: 32 channels that are placed
//! together.
//!
//! A [`FiringBlock`] is two firings of a 16-laser model, or one of a 32-laser model.
//! [`FiringBlock::firings`] gives the plain definition. [`FiringBlock::place`] places several
//! channels at a time, to within 1e-14 of the distance.

use protocol::vlp16::{CHANNELS, LidarModel};
use units::{Host, Lidar, Real, Span, Stamp};

use super::azimuth::{PaceOffsets, SinCos};
use super::unpack::{RawChannels, UnpackedBlock};
use crate::firing::{Duplicates, Firing, FiringChannels, ReturnKind};
use crate::geometry::Geometry;

/// One return per channel: the only ones of a block, or the first or second ones of a pair.
#[derive(Clone, Copy, Debug)]
pub struct ReturnLayer<'a> {
    raw: &'a RawChannels,
    unpacked: &'a UnpackedBlock,
    kept: u32,
}

/// The firings of one block.
#[derive(Clone, Copy, Debug)]
pub struct FiringBlock<'a> {
    /// Firing time of channel 0.
    pub start: Stamp<Lidar>,
    /// Receive time of its packet, less the time that the lidar takes to fill it. This is the
    /// host's time of the packet's first firing, but for the delay of the link.
    pub began: Stamp<Host>,
    pub(crate) azimuth_cdeg: i32,
    pub(crate) step_per_block_cdeg: f64,
    pub(crate) geometry: &'a Geometry,
    pub(crate) azimuth: SinCos,
    pub(crate) offsets: &'a PaceOffsets,
    pub(crate) returns: BlockReturns<'a>,
}

/// Horizontal direction of one or several channels.
#[derive(Clone, Copy, Debug)]
pub struct Heading<V> {
    /// Metres to the right per count.
    across: V,
    /// Metres forward per count.
    along: V,
}

/// Returns of one block, or of a pair.
#[derive(Clone, Copy, Debug)]
pub(crate) enum BlockReturns<'a> {
    One {
        only: ReturnLayer<'a>,
        echo: ReturnKind,
    },
    Two {
        last: ReturnLayer<'a>,
        strongest: ReturnLayer<'a>,
        duplicates: Duplicates,
    },
}

impl<'a> ReturnLayer<'a> {
    #[inline(always)]
    pub(crate) const fn new(raw: &'a RawChannels, unpacked: &'a UnpackedBlock) -> Self {
        Self {
            raw,
            unpacked,
            kept: unpacked.returns,
        }
    }

    /// Bit c is set if channel c has a return that becomes a point.
    #[inline]
    #[must_use]
    pub const fn kept(&self) -> u32 {
        self.kept
    }

    /// Distance of each channel in the model's unit; 0 without a return.
    #[inline]
    #[must_use]
    pub const fn counts(&self) -> &'a [f64; CHANNELS] {
        &self.unpacked.counts
    }

    /// Calibrated reflectivity of each channel.
    #[inline]
    #[must_use]
    pub const fn reflectivities(&self) -> &'a [u8; CHANNELS] {
        &self.unpacked.reflectivities
    }
}

impl<'a> BlockReturns<'a> {
    #[inline(always)]
    pub(crate) const fn one(only: ReturnLayer<'a>, echo: ReturnKind) -> Self {
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
            strongest.kept &= strongest.unpacked.changed;
        }
        Self::Two {
            last,
            strongest,
            duplicates,
        }
    }

    /// Number of returns, and the same with equal pairs counted once.
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
                let equal = last.kept & !strongest.unpacked.changed;
                let returns = ones(last.kept) + ones(strongest.unpacked.returns);
                (returns, returns - ones(equal))
            }
        }
    }
}

impl<'a> FiringBlock<'a> {
    /// The decoded model.
    #[must_use]
    pub const fn model(&self) -> &'static LidarModel {
        self.geometry.model
    }

    /// The returns, and the second ones of dual returns. For each channel the first return precedes
    /// the second.
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

    /// Kind of each channel's return ([`ReturnKind::code`]), one row per layer; meaningless without
    /// a return.
    #[inline(never)]
    #[must_use]
    pub fn echo_codes(&self) -> [[u8; CHANNELS]; 2] {
        match &self.returns {
            BlockReturns::One { echo, .. } => [[echo.code(); CHANNELS]; 2],
            BlockReturns::Two { strongest, .. } => {
                let changed = strongest.unpacked.changed;
                let codes = |differing: ReturnKind| {
                    core::array::from_fn(|channel| match changed >> channel & 1 {
                        0 => ReturnKind::LastAndStrongest.code(),
                        _ => differing.code(),
                    })
                };
                [
                    codes(ReturnKind::Last),
                    codes(ReturnKind::StrongestOrSecond),
                ]
            }
        }
    }

    /// Firing time of each channel in nanoseconds after the start.
    #[inline]
    #[must_use]
    pub const fn delays_ns(&self) -> &'a [i64; CHANNELS] {
        &self.geometry.channels.delay_ns
    }

    /// [`FiringBlock::delays_ns`] as floating-point numbers.
    #[inline]
    #[must_use]
    pub const fn delays_f64_ns(&self) -> &'a [f64; CHANNELS] {
        &self.geometry.channels.delay_f64_ns
    }

    /// Time from the start to the last channel.
    #[inline]
    #[must_use]
    pub const fn length(&self) -> Span {
        self.geometry.channels.length
    }

    /// Variance of each channel's azimuth, square radians ([`crate::azimuth_variance_rad2`]).
    #[inline]
    #[must_use]
    pub const fn azimuth_variances_rad2(&self) -> &'a [f64; CHANNELS] {
        &self.geometry.channels.azimuth_variance_rad2
    }

    /// Laser of each channel, by index in the firing order.
    #[inline]
    #[must_use]
    pub const fn lasers(&self) -> &'a [u8; CHANNELS] {
        &self.geometry.channels.laser
    }

    /// Ring of each channel by elevation, 0 the lowest.
    #[inline]
    #[must_use]
    pub const fn rings(&self) -> &'a [u8; CHANNELS] {
        &self.geometry.channels.ring
    }

    /// Horizontal direction of channels. `of` selects the values of these channels from a column of
    /// all.
    #[inline(always)]
    pub fn heading<V: Real>(&self, of: impl Fn(&[f64; CHANNELS]) -> V) -> Heading<V> {
        let (SinCos { sin, cos }, offsets) = (self.azimuth, self.offsets);
        let (offset_sin, offset_cos) = (of(&offsets.sin), of(&offsets.cos));
        Heading {
            across: offset_cos * sin + offset_sin * cos,
            along: offset_cos * cos - offset_sin * sin,
        }
    }

    /// Points of channels in the sensor's frame (x right, y forward, z up, metres) from their
    /// distance counts; meaningless without a return.
    #[inline(always)]
    pub fn place<V: Real>(
        &self,
        counts: V,
        heading: Heading<V>,
        of: impl Fn(&[f64; CHANNELS]) -> V,
    ) -> [V; 3] {
        let (channels, Heading { across, along }) = (&self.geometry.channels, heading);
        let out = counts + of(&channels.out_counts);
        let up_m = counts * of(&channels.up_per_count) + of(&channels.up_m);
        match &channels.tangential_counts {
            None => [out * across, out * along, up_m],
            Some(tangential) => {
                let tangential = of(tangential);
                let x_m = out * across - tangential * along;
                [x_m, out * along + tangential * across, up_m]
            }
        }
    }

    /// The firings in order of time.
    pub fn firings(&self) -> impl ExactSizeIterator<Item = Firing<'a>> + use<'a> {
        let block = *self;
        let model = block.geometry.model;
        let period_ns = f64::from(model.block_period_ns());
        let firing_cdeg = block.step_per_block_cdeg / model.firings_per_block as f64;
        (0..model.firings_per_block).map(move |n| {
            let after = Span::from_nanos(n as i64 * i64::from(model.firing_period_ns));
            let azimuth_cdeg = f64::from(block.azimuth_cdeg) + firing_cdeg * n as f64;
            Firing {
                start: block.start + after,
                azimuth_deg: (azimuth_cdeg / 100.0).rem_euclid(360.0),
                azimuth_rate_deg_s: block.step_per_block_cdeg / 100.0 / (period_ns * 1e-9),
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
