//! SplitMix64 (Steele, Lea and Flood 2014): the same numbers from the same seed on every machine.
//! Not for cryptography.

/// The odd number next to 2^64 divided by the golden ratio: the step of the state.
pub const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// The next 64 bits of the sequence with this state, which starts as the seed.
#[inline]
pub const fn split_mix_64(state: &mut u64) -> u64 {
    *state = state.wrapping_add(GOLDEN);
    mix(*state)
}

/// A bijection in which every output bit depends on every input bit.
#[inline]
#[must_use]
pub const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The upper 53 bits as a number from 0 to below 1.
#[inline]
#[must_use]
pub const fn unit_interval(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// First outputs of Vigna's reference implementation for seeds 0 and 1234567.
    #[test]
    fn sequences_are_splitmix64() {
        assert_eq!(split_mix_64(&mut 0), 0xE220_A839_7B1D_CDAF);
        let mut state = 1_234_567;
        assert_eq!(split_mix_64(&mut state), 6_457_827_717_110_365_317);
        assert_eq!(split_mix_64(&mut state), 3_203_168_211_198_807_973);
    }

    #[test]
    fn the_unit_interval_excludes_its_end() {
        assert_eq!(unit_interval(0).to_bits(), 0);
        assert!(unit_interval(u64::MAX) < 1.0);
    }
}
