//! Shapes of a change of speed (6086): linear, or by the square of a sine, in integers.
//!
//! After the share `u` of its time a sin2 ramp has made `(1 - cos(pi u)) / 2` of its change of
//! speed. Its peak acceleration is pi/2 times its mean. The guides at hand do not say which of
//! them the profile acceleration (6083) is; here it is the peak, which makes ramps longer.

/// Shape of a ramp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum RampShape {
    #[default]
    Linear,
    Sin2,
}

/// Fractional bits of shares.
const SHARE_BITS: u32 = 60;
const ONE: i128 = 1 << SHARE_BITS;
/// Pi and its inverse with [`SHARE_BITS`].
const PI: i128 = 3_622_009_729_038_561_421;
const INVERSE_PI: i128 = 366_986_312_910_250_153;
/// 2 / pi with 32 fractional bits, rounded down.
const MEAN_OF_PEAK: u64 = 2_734_261_102;

impl RampShape {
    /// Mean of an acceleration with this peak, whole rpm/s, rounded down; at least 1 if the peak
    /// is.
    pub const fn mean_rate(self, peak: u32) -> u32 {
        match self {
            Self::Linear => peak,
            Self::Sin2 => {
                let mean = ((peak as u64 * MEAN_OF_PEAK) >> 32) as u32;
                if mean == 0 && peak > 0 { 1 } else { mean }
            }
        }
    }
}

/// Progress of a sin2 ramp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sin2Progress {
    /// Share of the change of speed.
    share: i128,
    /// Twice the integral of that share over time.
    pub integral: i128,
}

impl Sin2Progress {
    /// At `time` of a ramp that takes `duration`.
    pub fn at(time: i128, duration: i128) -> Self {
        let passed = if duration == 0 {
            ONE
        } else {
            (time << SHARE_BITS) / duration
        };
        let half = sin_pi(passed / 2);
        let lag = (sin_pi(passed) * INVERSE_PI) >> SHARE_BITS;
        Self {
            // Rounding may put the sine a bit above one.
            share: ((half * half) >> SHARE_BITS).min(ONE),
            integral: (duration * (passed - lag)) >> SHARE_BITS,
        }
    }

    /// The share of `change` that is done.
    pub const fn of(self, change: i128) -> i128 {
        (change * self.share) >> SHARE_BITS
    }
}

/// Sine of pi times `x`, from 0 to 1: the Taylor series to the 21st power, exact to the last bits.
fn sin_pi(x: i128) -> i128 {
    let y = (PI * x.min(ONE - x)) >> SHARE_BITS;
    let square = (y * y) >> SHARE_BITS;
    let series = (1..=10).rev().fold(ONE, |rest, k| {
        ONE - ((square * rest) >> SHARE_BITS) / (2 * k * (2 * k + 1))
    });
    (y * series) >> SHARE_BITS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_are_accurate() {
        for (x, sine) in [
            (0, 0.0),
            (6, 0.5),
            (4, core::f64::consts::FRAC_1_SQRT_2),
            (3, 0.866_025_403_784_438_6),
            (2, 1.0),
        ] {
            let share = if x == 0 { 0 } else { ONE / x };
            for share in [share, ONE - share] {
                let off = sin_pi(share) as f64 / ONE as f64 - sine;
                assert!(off.abs() < 1e-15, "1/{x}: {off}");
            }
        }
    }

    #[test]
    fn a_ramp_begins_at_zero_and_ends_complete_half_way_through_its_work() {
        let at = |time| Sin2Progress::at(time, 1000);
        assert_eq!((at(0).of(1 << 40), at(0).integral), (0, 0));
        assert_eq!(at(1000).of(1 << 40), 1 << 40);
        assert_eq!(at(1000).integral, 1000);
        assert!((at(500).of(1 << 40) - (1 << 39)).abs() <= 1);
        // 500 - 1000 / pi.
        assert_eq!(at(500).integral, 181);
        assert_eq!(Sin2Progress::at(0, 0).of(7), 7);
    }

    /// 2^-32 ms before the end of a ramp of a second to 1000 rpm, the speed was above 1000 rpm.
    #[test]
    fn no_ramp_goes_beyond_its_end() {
        let (duration, change) = (1000 << 32, 1000 << 32);
        for before in 1..100 {
            let progress = Sin2Progress::at(duration - before, duration);
            assert!(progress.of(change) <= change);
            assert!(progress.of(-change) >= -change);
        }
    }

    #[test]
    fn the_mean_is_two_over_pi_of_the_peak() {
        assert_eq!(RampShape::Sin2.mean_rate(10_000), 6_366);
        assert_eq!(RampShape::Sin2.mean_rate(u32::MAX), 2_734_261_101);
        assert_eq!(
            [0, 1, 2].map(|peak| RampShape::Sin2.mean_rate(peak)),
            [0, 1, 1]
        );
        assert_eq!(RampShape::Linear.mean_rate(1), 1);
    }
}
