//! What sixteen lanes of registers must be able to do to count pairs, with the instructions of AVX-512 where there are such.
//!
//! Everything goes through `fearless_simd`: its tokens prove what the processor has. Left out: what is counted.

use fearless_simd::{Simd, f32x16, prelude::*, u32x16};

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
use fearless_simd::x86::Avx512;

/// Points of a leaf, and lanes of a register.
pub(super) const LANES: usize = 16;

/// Sixteen lanes.
pub(super) trait Lanes: Copy {
    /// Whose registers.
    type S: Simd;

    fn simd(self) -> Self::S;

    /// Lane by lane, the one nearer to nought of these two, its sign lost or not.
    fn nearer_nought(self, a: f32x16<Self::S>, b: f32x16<Self::S>) -> f32x16<Self::S>;

    /// Notes for every lane whether its number is negative. At most 32 notes before [`Lanes::notes`].
    fn note_negative(self, notes: u32x16<Self::S>, of: f32x16<Self::S>) -> u32x16<Self::S>;

    /// How many notes of every lane were of negative numbers.
    fn notes(self, notes: u32x16<Self::S>) -> u32x16<Self::S>;
}

/// Any registers that there are: AVX2, SSE, NEON, or none.
#[derive(Clone, Copy)]
pub(super) struct Portable<S>(pub S);

impl<S: Simd> Lanes for Portable<S> {
    type S = S;

    #[inline(always)]
    fn simd(self) -> S {
        self.0
    }

    #[inline(always)]
    fn nearer_nought(self, a: f32x16<S>, b: f32x16<S>) -> f32x16<S> {
        a.min(b.abs())
    }

    #[inline(always)]
    fn note_negative(self, notes: u32x16<S>, of: f32x16<S>) -> u32x16<S> {
        notes + (of.bitcast::<u32x16<S>>() >> 31)
    }

    #[inline(always)]
    fn notes(self, notes: u32x16<S>) -> u32x16<S> {
        notes
    }
}

/// AVX-512: a note is the sign shifted into a word of its lane, one instruction; so is the nearer of two.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
#[derive(Clone, Copy)]
pub(super) struct Wide(pub Avx512);

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
impl Lanes for Wide {
    type S = Avx512;

    #[inline(always)]
    fn simd(self) -> Avx512 {
        self.0
    }

    #[inline(always)]
    fn nearer_nought(self, a: f32x16<Avx512>, b: f32x16<Avx512>) -> f32x16<Avx512> {
        x86::nearer(self.0, a, b)
    }

    #[inline(always)]
    fn note_negative(self, notes: u32x16<Avx512>, of: f32x16<Avx512>) -> u32x16<Avx512> {
        x86::shifted_in(self.0, notes, of)
    }

    #[inline(always)]
    fn notes(self, notes: u32x16<Avx512>) -> u32x16<Avx512> {
        x86::ones(self.0, notes)
    }
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod x86 {
    #[cfg(target_arch = "x86")]
    use std::arch::x86::*;
    #[cfg(target_arch = "x86_64")]
    use std::arch::x86_64::*;

    use fearless_simd::x86::Avx512;
    use fearless_simd::{f32x16, prelude::*, u32x16};

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

    fearless_simd::kernel!(
        #[inline(always)]
        pub(super) fn shifted_in(
            token: Avx512,
            notes: u32x16<Avx512>,
            of: f32x16<Avx512>,
        ) -> u32x16<Avx512> {
            _mm512_shldi_epi32::<1>(notes.into(), _mm512_castps_si512(of.into())).simd_into(token)
        }
    );

    fearless_simd::kernel!(
        #[inline(always)]
        pub(super) fn ones(token: Avx512, notes: u32x16<Avx512>) -> u32x16<Avx512> {
            _mm512_popcnt_epi32(notes.into()).simd_into(token)
        }
    );
}
