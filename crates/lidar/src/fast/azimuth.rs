//! Sines and cosines of azimuths from tables and caches.
//!
//! A block's azimuth is a whole number of hundredths of a degree. A table of whole degrees and one
//! of hundredths, joined by the addition theorem, give its sine and cosine to 1e-15. The azimuth of
//! each channel relative to its block depends only on the rotor's pace, which takes few values, so
//! its sines and cosines are cached by pace. Cached values are functions of their key, so the cache
//! never changes a result.

use core::array;
use std::sync::LazyLock;

use protocol::vlp16::CHANNELS;

use crate::geometry::{ChannelTable, PerChannel};

/// Whole degrees of a revolution.
const DEGREES: usize = 360;
/// Azimuth units per degree in packets.
const HUNDREDTHS: usize = 100;
/// Cached paces, a power of two. A rotor at constant speed shows three or four.
const PACES: usize = 8;

/// Sine and cosine of an angle.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SinCos {
    pub sin: f64,
    pub cos: f64,
}

impl SinCos {
    fn of_degrees(degrees: f64) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Self { sin, cos }
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        Self {
            sin: self.sin * other.cos + self.cos * other.sin,
            cos: self.cos * other.cos - self.sin * other.sin,
        }
    }
}

/// Sine and cosine of each channel's azimuth relative to its block, times the horizontal distance
/// of one count. Aligned like [`ChannelTable`].
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct PaceOffsets {
    pub sin: PerChannel<f64>,
    pub cos: PerChannel<f64>,
    /// Bits of the pace, which differ for any two paces.
    pace: u64,
}

/// Sine and cosine of every azimuth in packets.
#[derive(Clone, Debug)]
pub(crate) struct AzimuthSines {
    degrees: [SinCos; DEGREES],
    hundredths: [SinCos; HUNDREDTHS],
}

/// Cache of [`PaceOffsets`] for one sensor.
#[derive(Clone, Debug)]
pub(crate) struct PaceCache {
    paces: Box<[PaceOffsets; PACES]>,
}

impl AzimuthSines {
    /// The shared table. It is the same for all sensors, and building it takes long compared with a
    /// short recording.
    pub(crate) fn get() -> &'static Self {
        static TABLE: LazyLock<AzimuthSines> = LazyLock::new(|| {
            let entry = |i: usize, step_deg: f64| SinCos::of_degrees(i as f64 * step_deg);
            AzimuthSines {
                degrees: array::from_fn(|i| entry(i, 1.0)),
                hundredths: array::from_fn(|i| entry(i, 0.01)),
            }
        });
        &TABLE
    }

    /// Sine and cosine of an azimuth in hundredths of a degree, 0 to 35999.
    #[inline]
    pub(crate) fn azimuth(&self, azimuth_cdeg: i32) -> SinCos {
        let cdeg = azimuth_cdeg as usize;
        let whole = self.degrees.get(cdeg / HUNDREDTHS);
        let rest = self.hundredths.get(cdeg % HUNDREDTHS);
        match (whole, rest) {
            (Some(whole), Some(rest)) => whole.plus(*rest),
            _ => SinCos::default(),
        }
    }
}

impl PaceCache {
    pub(crate) fn new(channels: &ChannelTable) -> Self {
        let zero = PaceOffsets::new(channels, 0.0);
        Self {
            paces: Box::new(array::from_fn(|_| zero.clone())),
        }
    }

    /// Offsets at a pace in hundredths of a degree per block period.
    #[inline]
    pub(crate) fn offsets(
        &mut self,
        channels: &ChannelTable,
        step_per_block_cdeg: f64,
    ) -> &PaceOffsets {
        // Neighbouring whole paces use different slots.
        let slot = step_per_block_cdeg as i64 as usize % PACES;
        let cached = &mut self.paces[slot];
        if cached.pace != step_per_block_cdeg.to_bits() {
            *cached = PaceOffsets::new(channels, step_per_block_cdeg);
        }
        cached
    }
}

impl PaceOffsets {
    #[cold]
    fn new(channels: &ChannelTable, step_per_block_cdeg: f64) -> Self {
        let mut offsets = Self {
            pace: step_per_block_cdeg.to_bits(),
            sin: [0.0; CHANNELS],
            cos: [0.0; CHANNELS],
        };
        let sines_and_cosines = offsets.sin.iter_mut().zip(&mut offsets.cos);
        let angles = channels.part.iter().zip(&channels.azimuth_offset_deg);
        for (((sin, cos), (part, offset_deg)), out_per_count) in
            sines_and_cosines.zip(angles).zip(&channels.out_per_count)
        {
            let degrees = step_per_block_cdeg / 100.0 * part + offset_deg;
            (*sin, *cos) = degrees.to_radians().sin_cos();
            *sin *= out_per_count;
            *cos *= out_per_count;
        }
        offsets
    }
}

#[cfg(test)]
mod tests {
    use protocol::vlp16::models::{VLP_16, VLP_32C};

    use super::*;
    use crate::geometry::Geometry;

    #[test]
    fn the_sine_table_agrees_with_f64() {
        let table = AzimuthSines::get();
        for cdeg in 0..36_000 {
            let (sin, cos) = (f64::from(cdeg) / 100.0).to_radians().sin_cos();
            let got = table.azimuth(cdeg);
            assert!((got.sin - sin).abs() < 1.5e-15, "{cdeg}: {got:?}");
            assert!((got.cos - cos).abs() < 1.5e-15, "{cdeg}: {got:?}");
        }
    }

    #[test]
    fn cached_offsets_equal_computed_ones() {
        for model in [&VLP_16, &VLP_32C] {
            let channels = Geometry::new(model, true, None).channels;
            let mut cache = PaceCache::new(&channels);
            // Paces that share a slot, recur, are zero, negative or fractional.
            for step_per_block_cdeg in [
                39.0, 40.0, 47.0, 39.0, 0.0, -0.0, -40.0, 39.818, 36_000.0, 40.0,
            ] {
                let new = PaceOffsets::new(&channels, step_per_block_cdeg);
                let cached = cache.offsets(&channels, step_per_block_cdeg);
                assert_eq!(
                    (cached.sin, cached.cos),
                    (new.sin, new.cos),
                    "{step_per_block_cdeg}"
                );
            }
        }
    }

    #[test]
    fn offsets_grow_with_the_delay_of_the_channel() {
        let channels = Geometry::new(&VLP_16, true, None).channels;
        let mut cache = PaceCache::new(&channels);
        // 55.296 and 15 x 2.304 us of 110.592 us: 0.8125 of 0.4 deg; 15 deg up, 2 mm a count.
        let offsets = cache.offsets(&channels, 40.0);
        let across = 0.002 * 15_f64.to_radians().cos();
        assert!((offsets.sin[31] - across * 0.325_f64.to_radians().sin()).abs() < 1e-18);
        assert!((offsets.cos[31] - across * 0.325_f64.to_radians().cos()).abs() < 1e-18);
    }
}
