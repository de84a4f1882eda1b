//! The garbage in unused words of a real drive, seeded for repeatable runs.

/// A generator of arbitrary numbers (SplitMix64).
#[derive(Clone, Debug)]
pub(super) struct GarbageGenerator(u64);

impl GarbageGenerator {
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}
