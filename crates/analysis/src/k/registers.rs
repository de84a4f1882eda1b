//! Which registers pairs are counted in.
//!
//! Left out: what is done with them. Counts are the same in all.

use fearless_simd::Level;

/// The widest registers that may be used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Registers {
    /// The widest that the processor has.
    #[default]
    Best,
    /// AVX2 with fused multiply-add, where the processor has it.
    Avx2,
    /// SSE 4.2, where the processor has it.
    Sse4,
    /// What every processor of its kind has.
    Least,
}

impl Registers {
    /// Those, or less where the processor lacks them.
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
