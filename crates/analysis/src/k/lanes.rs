//! Registers of sixteen lanes for counting pairs, with AVX-512 where the processor has it.
//!
//! All access goes through `fearless_simd`, whose tokens prove what the processor has.

use fearless_simd::{Simd, f32x16, prelude::*};

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
use fearless_simd::x86::{Avx2, Avx512};

/// Points per leaf and lanes per register.
pub(super) const LANES: usize = 16;

/// Sixteen numbers on a cache line of their own.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct AlignedLanes<T>(pub [T; LANES]);

/// Registers of sixteen lanes.
pub(super) trait SimdLanes: Copy {
    /// The registers' type.
    type S: Simd;

    fn simd(self) -> Self::S;

    /// Per lane, the number nearer to zero; its sign may be lost.
    fn nearer_zero(self, a: f32x16<Self::S>, b: f32x16<Self::S>) -> f32x16<Self::S>;
}

/// The registers of any processor: AVX2, SSE, NEON or none.
#[derive(Clone, Copy)]
pub(super) struct Portable<S>(pub S);

impl<S: Simd> SimdLanes for Portable<S> {
    type S = S;

    #[inline(always)]
    fn simd(self) -> S {
        self.0
    }

    #[inline(always)]
    fn nearer_zero(self, a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
        a.min(b.abs())
    }
}

/// AVX-512, in which selecting the nearer number is one instruction.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
#[derive(Clone, Copy)]
pub(super) struct Wide(pub Avx512);

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
impl SimdLanes for Wide {
    type S = Avx512;

    #[inline(always)]
    fn simd(self) -> Avx512 {
        self.0
    }

    #[inline(always)]
    fn nearer_zero(self, a: f32x16<Avx512>, b: f32x16<Avx512>) -> f32x16<Avx512> {
        x86::nearer(self.0, a, b)
    }
}

/// AVX2.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
#[derive(Clone, Copy)]
pub(super) struct Half(pub Avx2);

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
impl SimdLanes for Half {
    type S = Avx2;

    #[inline(always)]
    fn simd(self) -> Avx2 {
        self.0
    }

    #[inline(always)]
    fn nearer_zero(self, a: f32x16<Avx2>, b: f32x16<Avx2>) -> f32x16<Avx2> {
        Portable(self.0).nearer_zero(a, b)
    }
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod x86 {
    #[cfg(target_arch = "x86")]
    use std::arch::x86::*;
    #[cfg(target_arch = "x86_64")]
    use std::arch::x86_64::*;

    use fearless_simd::x86::Avx512;
    use fearless_simd::{f32x16, prelude::*};

    fearless_simd::kernel!(
        #[inline(always)]
        pub(super) fn nearer(
            token: Avx512,
            a: f32x16<Avx512>,
            b: f32x16<Avx512>,
        ) -> f32x16<Avx512> {
            // 0b0010: the smaller magnitude, with the sign cleared.
            _mm512_range_ps::<0b1010>(a.into(), b.into()).simd_into(token)
        }
    );
}
