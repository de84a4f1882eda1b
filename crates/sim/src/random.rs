//! Reproducible random numbers: by key (seed, effect name, firing, channel) or in sequence.
//!
//! Keys make effects independent of each other and of the number of threads. The mixing function is
//! that of SplitMix64 (Steele, Lea and Flood 2014), a bijection of 64 bits, applied once per part
//! of the key; a sequence is SplitMix64 itself. Not for cryptography.

use core::f64::consts::TAU;

use units::random::split_mix_64;
pub(crate) use units::random::{GOLDEN, mix, unit_interval};

/// Another odd number with as little structure (from the same paper's second mixer).
const SECOND: u64 = 0xD605_BBB5_8C8A_BC03;

/// The source of one effect's draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RandomSource {
    key: u64,
}

/// A sequence of draws.
#[derive(Clone, Copy, Debug)]
pub struct Draws {
    state: u64,
}

impl RandomSource {
    /// The source of effect `name` in a run with `seed`.
    #[must_use]
    pub fn new(seed: u64, name: &str) -> Self {
        let key = name.bytes().fold(mix(seed ^ GOLDEN), |key, byte| {
            mix(key ^ u64::from(byte)).wrapping_add(GOLDEN)
        });
        Self { key }
    }

    /// The draws of a channel at an index (of a firing, packet or poll).
    #[inline]
    #[must_use]
    pub const fn at(self, index: u64, channel: u32) -> Draws {
        let row = mix(self.key.wrapping_add(index.wrapping_mul(GOLDEN)));
        Draws {
            state: mix(row.wrapping_add((channel as u64 + 1).wrapping_mul(SECOND))),
        }
    }
}

impl Draws {
    /// SplitMix64 with this seed.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// 64 random bits.
    #[inline]
    pub const fn bits(&mut self) -> u64 {
        split_mix_64(&mut self.state)
    }

    /// Uniform from 0 to below 1, in steps of 2^-53.
    #[inline]
    pub const fn unit(&mut self) -> f64 {
        unit_interval(self.bits())
    }

    /// Uniform between two numbers.
    pub(crate) const fn between(&mut self, [from, to]: [f64; 2]) -> f64 {
        from + (to - from) * self.unit()
    }

    /// Uniform among 0..count; 0 for a count of 0.
    pub(crate) const fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// Two independent draws of the standard normal distribution (Box and Muller 1958).
    #[inline]
    pub fn normals(&mut self) -> [f64; 2] {
        // Above 0, so that its logarithm is finite: at most 8.6 standard deviations.
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        let (sin, cos) = (TAU * self.unit()).sin_cos();
        [radius * cos, radius * sin]
    }

    /// A draw of the standard normal distribution.
    #[inline]
    pub fn normal(&mut self) -> f64 {
        self.normals()[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_gives_the_same_draws_in_any_order() {
        let source = RandomSource::new(7, "range noise");
        let once = source.at(12, 3).bits();
        let _ = source.at(12, 4).bits();
        assert_eq!(source.at(12, 3).bits(), once);
        for other in [
            RandomSource::new(8, "range noise").at(12, 3),
            RandomSource::new(7, "range nois").at(12, 3),
            source.at(13, 3),
            source.at(12, 2),
        ] {
            assert_ne!(other.clone().bits(), once);
        }
    }

    /// Means, variances and correlations of 2^18 draws, each with its own standard error.
    #[test]
    fn neighbouring_keys_are_uncorrelated() {
        let source = RandomSource::new(1, "x");
        let n = 1 << 18;
        let draws: Vec<f64> = (0..n)
            .map(|i| source.at(i / 16, (i % 16) as u32).unit() - 0.5)
            .collect();
        let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / n as f64;
        let error = (1.0 / 12.0 / n as f64).sqrt();
        assert!(mean(&mut draws.iter().copied()).abs() < 4.0 * error);
        let variance = mean(&mut draws.iter().map(|x| x * x));
        assert!((variance - 1.0 / 12.0).abs() < 4.0 * (1.0 / 180.0 / n as f64).sqrt());
        for lag in [1, 2, 15, 16, 17, 32] {
            let product = mean(&mut draws.iter().zip(draws.iter().skip(lag)).map(|(a, b)| a * b));
            assert!(
                product.abs() < 4.0 / 12.0 / (n as f64).sqrt(),
                "lag {lag}: {product}"
            );
        }
    }

    #[test]
    fn normal_draws_are_normal() {
        let source = RandomSource::new(2, "x");
        let n = 1 << 17;
        let (mut sum, mut squares, mut within, mut joint) = (0.0, 0.0, 0, 0.0);
        for index in 0..n {
            let [a, b] = source.at(index, 0).normals();
            sum += a + b;
            squares += a * a + b * b;
            within += u32::from(a.abs() < 1.0) + u32::from(b.abs() < 1.0);
            joint += a * b;
        }
        let count = 2.0 * n as f64;
        assert!((sum / count).abs() < 4.0 / count.sqrt());
        assert!((squares / count - 1.0).abs() < 4.0 * (2.0 / count).sqrt());
        assert!((f64::from(within) / count - 0.682_689).abs() < 4.0 * (0.2166 / count).sqrt());
        assert!((joint / n as f64).abs() < 4.0 / (n as f64).sqrt());
    }

    #[test]
    fn units_stay_below_one() {
        let mut draws = RandomSource::new(3, "x").at(0, 0);
        assert!((0..10_000).all(|_| (0.0..1.0).contains(&draws.unit())));
    }
}
