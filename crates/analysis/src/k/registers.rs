//! Choice of the registers in which pairs are counted. The counts are the same in all.

use fearless_simd::Level;

/// The widest registers to use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Registers {
    /// The widest of the processor.
    #[default]
    Best,
    /// AVX2 with fused multiply-add, if the processor has it.
    Avx2,
    /// SSE 4.2, if the processor has it.
    Sse4,
    /// The baseline of the target.
    Least,
}

impl Registers {
    /// The level of these registers, or a lower one that the processor has.
    pub(super) fn level(self) -> Level {
        let best = Level::new();
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        let narrower = match self {
            Self::Avx2 => best.as_avx2().map(Level::Avx2),
            Self::Sse4 => best.as_sse4_2().map(Level::Sse4_2),
            Self::Best | Self::Least => None,
        };
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        let narrower = None;
        match self {
            Self::Least => Level::baseline(),
            _ => narrower.unwrap_or(best),
        }
    }
}
