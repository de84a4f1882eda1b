//! Sines and cosines of a turning head without computing one for every firing.
//!
//! A block's azimuth is a whole number of hundredths of a degree: a table of whole degrees and one
//! of hundredths, joined by the addition theorem, give its sine and cosine as exactly as an angle
//! in radians can say it, some 1e-15. How far each channel is ahead of its block depends on the
//! rotor's pace alone, which takes few values: their sines and cosines are kept by pace. Every
//! value is a function of its key, so that what was kept before changes no result. Left out: the
//! azimuth itself ([`crate::Firing`] has it).

use core::array;
use std::sync::LazyLock;

use protocol::vlp16::CHANNELS;

use crate::geometry::{ChannelTable, PerChannel};

/// Whole degrees of a turn.
const DEGREES: usize = 360;
/// AzimuthSteps of a degree on the wire.
const HUNDREDTHS: usize = 100;
/// Paces that are kept; a power of two. A rotor held at one speed shows three or four.
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

/// How far each channel's azimuth is ahead of its block's: sine and cosine, times the way along the
/// horizon of one count. Aligned as [`ChannelTable`] is.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct PaceOffsets {
    pub sin: PerChannel<f64>,
    pub cos: PerChannel<f64>,
    /// Bits of the pace, so that any two paces differ.
    pace: u64,
}

/// Sine and cosine of every azimuth that a packet can say.
#[derive(Clone, Debug)]
pub(crate) struct SineTable {
    degrees: [SinCos; DEGREES],
    hundredths: [SinCos; HUNDREDTHS],
}

/// How far channels are ahead, by pace, for one sensor.
#[derive(Clone, Debug)]
pub(crate) struct PaceCache {
    paces: Box<[PaceOffsets; PACES]>,
}

impl SineTable {
    /// The only one: it is the same for all sensors, and for a short recording it would be much of
    /// the work.
    pub(crate) fn get() -> &'static Self {
        static COMPASS: LazyLock<SineTable> = LazyLock::new(|| {
            let table = |i: usize, step_deg: f64| SinCos::of_degrees(i as f64 * step_deg);
            SineTable {
                degrees: array::from_fn(|i| table(i, 1.0)),
                hundredths: array::from_fn(|i| table(i, 0.01)),
            }
        });
        &COMPASS
    }

    /// Of an azimuth in hundredths of a degree, 0 up to 36000.
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
    pub(crate) fn new(fan: &ChannelTable) -> Self {
        let still = PaceOffsets::new(fan, 0.0);
        Self {
            paces: Box::new(array::from_fn(|_| still.clone())),
        }
    }

    /// Of the channels at a pace in hundredths of a degree per block period.
    #[inline]
    pub(crate) fn ahead(&mut self, fan: &ChannelTable, pace_cdeg: f64) -> &PaceOffsets {
        // Neighbouring whole paces fall on different places.
        let place = pace_cdeg as i64 as usize % PACES;
        let kept = &mut self.paces[place];
        if kept.pace != pace_cdeg.to_bits() {
            *kept = PaceOffsets::new(fan, pace_cdeg);
        }
        kept
    }
}

impl PaceOffsets {
    #[cold]
    fn new(fan: &ChannelTable, pace_cdeg: f64) -> Self {
        let mut ahead = Self {
            pace: pace_cdeg.to_bits(),
            sin: [0.0; CHANNELS],
            cos: [0.0; CHANNELS],
        };
        let channels = ahead.sin.iter_mut().zip(&mut ahead.cos);
        let angles = fan.part.iter().zip(&fan.azimuth_offset_deg);
        for (((sin, cos), (part, offset_deg)), out_per_count) in
            channels.zip(angles).zip(&fan.out_per_count)
        {
            let degrees = pace_cdeg / 100.0 * part + offset_deg;
            (*sin, *cos) = degrees.to_radians().sin_cos();
            *sin *= out_per_count;
            *cos *= out_per_count;
        }
        ahead
    }
}

#[cfg(test)]
mod tests {
    use protocol::vlp16::models::{VLP_16, VLP_32C};

    use super::*;
    use crate::geometry::Geometry;

    #[test]
    fn every_azimuth_of_the_wire_has_its_sine_and_cosine() {
        let compass = SineTable::get();
        for cdeg in 0..36_000 {
            let (sin, cos) = (f64::from(cdeg) / 100.0).to_radians().sin_cos();
            let got = compass.azimuth(cdeg);
            assert!((got.sin - sin).abs() < 1.5e-15, "{cdeg}: {got:?}");
            assert!((got.cos - cos).abs() < 1.5e-15, "{cdeg}: {got:?}");
        }
    }

    #[test]
    fn what_is_kept_by_pace_is_what_is_computed_anew() {
        for model in [&VLP_16, &VLP_32C] {
            let fan = Geometry::new(model, true, None).fan;
            let mut rotor = PaceCache::new(&fan);
            // Paces that share a place, come back, stand still, run backwards and are no whole
            // numbers.
            for pace_cdeg in [
                39.0, 40.0, 47.0, 39.0, 0.0, -0.0, -40.0, 39.818, 36_000.0, 40.0,
            ] {
                let new = PaceOffsets::new(&fan, pace_cdeg);
                let kept = rotor.ahead(&fan, pace_cdeg);
                assert_eq!((kept.sin, kept.cos), (new.sin, new.cos), "{pace_cdeg}");
            }
        }
    }

    #[test]
    fn the_last_channel_is_ahead_by_its_share_of_the_pace() {
        let fan = Geometry::new(&VLP_16, true, None).fan;
        let mut rotor = PaceCache::new(&fan);
        // 55.296 and 15 x 2.304 us of 110.592 us: 0.8125 of 0.4 deg; 15 deg up, 2 mm a count.
        let ahead = rotor.ahead(&fan, 40.0);
        let across = 0.002 * 15_f64.to_radians().cos();
        assert!((ahead.sin[31] - across * 0.325_f64.to_radians().sin()).abs() < 1e-18);
        assert!((ahead.cos[31] - across * 0.325_f64.to_radians().cos()).abs() < 1e-18);
    }
}
