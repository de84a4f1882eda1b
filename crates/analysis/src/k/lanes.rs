//! What sixteen lanes of registers must be able to do to count pairs, with the instructions of AVX-512 where there are such.
//!
//! Everything goes through `fearless_simd`: its tokens prove what the processor has. Left out: what is counted, and how signs are noted.

use fearless_simd::{Simd, f32x16, prelude::*};

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
use fearless_simd::x86::{Avx2, Avx512};

/// Points of a leaf, and lanes of a register.
pub(super) const LANES: usize = 16;

/// Numbers of sixteen lanes on a line of the cache of their own.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(super) struct AlignedLanes<T>(pub [T; LANES]);

/// Sixteen lanes.
pub(super) trait SimdLanes: Copy {
    /// Whose registers.
    type S: Simd;

    fn simd(self) -> Self::S;

    /// Lane by lane, the one nearer to nought of these two, its sign lost or not.
    fn nearer_nought(self, a: f32x16<Self::S>, b: f32x16<Self::S>) -> f32x16<Self::S>;
}

/// Any registers that there are: AVX2, SSE, NEON, or none.
#[derive(Clone, Copy)]
pub(super) struct Portable<S>(pub S);

impl<S: Simd> SimdLanes for Portable<S> {
    type S = S;

    #[inline(always)]
    fn simd(self) -> S {
        self.0
    }

    #[inline(always)]
    fn nearer_nought(self, a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
        a.min(b.abs())
    }
}

/// AVX-512: the nearer of two is one instruction.
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
    fn nearer_nought(self, a: f32x16<Avx512>, b: f32x16<Avx512>) -> f32x16<Avx512> {
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
    fn nearer_nought(self, a: f32x16<Avx2>, b: f32x16<Avx2>) -> f32x16<Avx2> {
        Portable(self.0).nearer_nought(a, b)
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
            // 0b0010: the least by magnitude, with a sign cleared.
            _mm512_range_ps::<0b1010>(a.into(), b.into()).simd_into(token)
        }
    );
}
