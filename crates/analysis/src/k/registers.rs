//! Choice of the registers in which pairs are counted. The counts are the same in all.

use fearless_simd::{Level, dispatch};

use super::sign_mask::{PortableSignMask, SignMask};

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

/// Work that can be done in any registers.
pub(super) trait LaneWork {
    fn run<L: SignMask>(&mut self, on: L);
}

impl Registers {
    /// Does the work in these registers, or in narrower ones that the processor has.
    pub(super) fn run(self, work: &mut impl LaneWork) {
        let level = self.level();
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            use super::sign_mask::x86::{Avx2SignMask, Avx512SignMask};
            use fearless_simd::Simd as _;
            if let Some(avx512) = level.as_avx512() {
                return avx512.vectorize(
                    #[inline(always)]
                    || work.run(Avx512SignMask(avx512)),
                );
            }
            if let Some(avx2) = level.as_avx2() {
                return avx2.vectorize(
                    #[inline(always)]
                    || work.run(Avx2SignMask(avx2)),
                );
            }
        }
        dispatch!(level, simd => work.run(PortableSignMask(simd)));
    }

    /// The level of these registers, or a lower one that the processor has.
    fn level(self) -> Level {
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
