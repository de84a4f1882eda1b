//! Errors of samples, estimated from their neighbours.
//!
//! A sample's angle is exact to an encoder count, but its instant is known only within its bound,
//! which is an error of the angle at speed. The share of the bound that errors take up follows from
//! the deviations between neighbours. A delay common to all samples does not appear here.

use units::Degrees;

use super::AngleSample;

/// Size of the samples' errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation of a sample's instant as a share of its bound, 0 to 1.
    pub share: f64,
    /// Standard deviation of the angle, degrees: the encoder's count.
    pub angle_sd_deg: f64,
}

/// Standard deviation of a uniform distribution, in halves of its width: 1 / sqrt(3).
const UNIFORM_SD: f64 = 0.577_350_269_189_625_8;

impl Noise {
    /// Errors uniform over the bounds, if nothing is known.
    pub const UNIFORM: Self = Self {
        share: UNIFORM_SD,
        angle_sd_deg: 0.0,
    };

    /// The noise of `samples`, whose angles come in steps of `quantum`. Without motion, errors
    /// count as uniform within the bounds.
    #[must_use]
    pub fn of(samples: &[AngleSample], quantum: Degrees) -> Self {
        let angle_sd_deg = quantum.0.abs() * UNIFORM_SD / 2.0;
        let (mut seen, mut possible, mut unbounded, mut count) = (0.0, 0.0, 0.0, 0.0);
        for window in samples.windows(3) {
            let [a, b, c] = window else { continue };
            let (whole, part) = (seconds(a, c), seconds(a, b));
            if whole <= 0.0 {
                continue;
            }
            let (rate, share) = ((c.angle.0 - a.angle.0) / whole, part / whole);
            let off = a.angle.0 + (c.angle.0 - a.angle.0) * share - b.angle.0;
            let weights = [1.0 - share, 1.0, share].map(|w| w * w);
            let counts: f64 = weights.iter().sum();
            seen += off * off - angle_sd_deg * angle_sd_deg * counts;
            unbounded += off * off / counts;
            count += 1.0;
            possible += [a, b, c]
                .iter()
                .zip(weights)
                .map(|(s, w)| w * (rate * s.bound.as_secs_f64()).powi(2))
                .sum::<f64>();
        }
        if count > 0.0 && possible == 0.0 && samples.iter().all(|s| s.bound.as_nanos() == 0) {
            // Their instants are unknown: the samples are all there is.
            let sd = f64::sqrt(unbounded / count);
            return Self {
                share: 0.0,
                angle_sd_deg: sd.max(angle_sd_deg),
            };
        }
        let share = if possible > 0.0 {
            f64::sqrt(f64::max(seen, 0.0) / possible).min(1.0)
        } else {
            UNIFORM_SD
        };
        Self {
            share,
            angle_sd_deg,
        }
    }

    /// Standard deviation of a sample's angle at `rate` degrees per second.
    #[must_use]
    pub fn sd_deg(&self, sample: &AngleSample, rate: f64) -> f64 {
        f64::hypot(
            self.angle_sd_deg,
            self.share * sample.bound.as_secs_f64() * rate,
        )
    }
}

/// From one sample to another.
pub(super) fn seconds(a: &AngleSample, b: &AngleSample) -> f64 {
    b.host.saturating_since(a.host).as_secs_f64()
}

/// Degrees per second at each sample: between its neighbours, at the ends to the only one. Samples
/// are in strictly increasing time.
pub(super) fn rates(samples: &[AngleSample]) -> Vec<f64> {
    let last = samples.len().saturating_sub(1);
    (0..samples.len())
        .map(|i| {
            let pair = samples
                .get(i.saturating_sub(1))
                .zip(samples.get((i + 1).min(last)));
            match pair {
                Some((a, b)) if seconds(a, b) > 0.0 => (b.angle.0 - a.angle.0) / seconds(a, b),
                _ => 0.0,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use units::{Span, Stamp};

    #[test]
    fn the_ratio_of_errors_to_their_bounds_is_estimated() {
        // 50 deg/s at 1 kHz, bounds of 0.5 ms; errors of +-0.1 ms alternate irregularly.
        let samples: Vec<_> = (0..2_000i64)
            .map(|i| {
                let off = if (i * i / 7) % 2 == 0 {
                    100_000
                } else {
                    -100_000
                };
                AngleSample {
                    host: Stamp::from_nanos(i * 1_000_000 + off),
                    bound: Span::from_micros(500),
                    angle: Degrees(50e-3 * i as f64),
                }
            })
            .collect();
        let noise = Noise::of(&samples, Degrees(0.0));
        assert!((noise.share - 0.2).abs() < 0.02, "{noise:?}");
    }

    #[test]
    fn at_rest_errors_count_as_uniform() {
        let samples: Vec<_> = (0..100i64)
            .map(|i| AngleSample {
                host: Stamp::from_nanos(i * 1_000_000),
                bound: Span::from_micros(500),
                angle: Degrees(1.0),
            })
            .collect();
        assert_eq!(Noise::of(&samples, Degrees(0.0015)).share, UNIFORM_SD);
        assert_eq!(Noise::of(&[], Degrees(0.0015)).share, UNIFORM_SD);
    }
}
