//! Seeded random numbers.

use units::random::{split_mix_64, unit_interval};

/// Numbers that follow from a seed.
#[derive(Clone, Debug)]
pub struct SeededNoise(pub u64);

impl SeededNoise {
    /// The next 64 bits.
    #[inline]
    pub const fn bits(&mut self) -> u64 {
        split_mix_64(&mut self.0)
    }

    /// The next number, uniform in 0..1.
    pub fn uniform(&mut self) -> f64 {
        unit_interval(self.bits())
    }

    /// The next number of nearly normal distribution with standard deviation 1 (Irwin-Hall: the sum
    /// of twelve uniform numbers, less 6).
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_the_specified_standard_deviation() {
        let mut noise = SeededNoise(7);
        let drawn: Vec<f64> = (0..20_000).map(|_| noise.normal()).collect();
        let n = drawn.len() as f64;
        let mean = drawn.iter().sum::<f64>() / n;
        let deviation = (drawn.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
        assert!(
            mean.abs() < 0.02 && (deviation - 1.0).abs() < 0.02,
            "{mean} {deviation}"
        );
    }
}
