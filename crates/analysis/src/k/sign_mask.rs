//! Registers of sixteen lanes for counting pairs, with AVX-512 where the processor has it, and
//! masks of the signs of sixteen rows, which also mark numbers too near to zero to tell.
//!
//! All access goes through `fearless_simd`, whose tokens prove what the processor has.
//!
//! Where two registers can be joined by their upper halves, two bits of a float suffice: its sign,
//! and the first bit of its exponent, which is set from 2 on. All numbers are scaled so that the
//! band where f32 cannot tell is as wide as 2, and shifted by half its width so that nothing in it
//! is negative: the two bits are 00 in the band, 01 above it, and the first is 1 below zero. The
//! scale is a power of two and rounds nothing. (A scale towards the smallest floats would need one
//! instruction less for two rows, but subnormal numbers take Intel's processors ten times as long.)

use fearless_simd::{Simd, f32x16, prelude::*, u32x16};

use super::lanes::{AlignedLanes, LANES};
use super::leaf_pair::F32_BAND;

/// Registers of sixteen lanes, and sign masks in them.
pub(super) trait SignMask: Copy {
    /// The registers' type.
    type S: Simd;

    /// The mask of up to sixteen rows.
    type Mask: Copy;

    /// Whether the mask tells which numbers are too near to zero.
    const MASK_NAMES_PAIRS: bool;

    /// Scale of rows and thresholds.
    const SCALE: f32;

    /// Shift of thresholds downwards, before the scale.
    const MOVED: f32;

    fn simd(self) -> Self::S;

    /// Per lane, the number nearer to zero; its sign may be lost.
    #[inline(always)]
    fn nearer_zero(self, a: f32x16<Self::S>, b: f32x16<Self::S>) -> f32x16<Self::S> {
        a.min(b.abs())
    }

    fn empty_mask(self) -> Self::Mask;

    /// Records two rows.
    fn record(self, mask: &mut Self::Mask, row: f32x16<Self::S>, next: f32x16<Self::S>);

    /// Adds the number of negative numbers to the lanes of each edge; returns whether any number
    /// was too near to zero.
    fn add_up<const E: usize>(
        self,
        mask: &[Self::Mask; E],
        lanes: &mut [AlignedLanes<u32>],
    ) -> bool;

    /// The lanes of a row that are too near to zero.
    fn undecided(self, row: f32x16<Self::S>) -> u64;

    /// The words of the mask with any marks, and all words. A word has 16 bits with ones for
    /// numbers too near to zero: bits 15, 13 and so on for rows 0 and 1, 2 and 3 and so on. Words
    /// come by twos, a lane of the first row and the same one of the next. All are zero unless
    /// [`SignMask::MASK_NAMES_PAIRS`].
    #[inline(always)]
    fn which(self, _: Self::Mask) -> (u32, [u16; 2 * LANES]) {
        (0, [0; 2 * LANES])
    }
}

/// The registers of any processor: AVX2, SSE, NEON or none.
#[derive(Clone, Copy)]
pub(super) struct PortableSignMask<S>(pub S);

impl<S: Simd> SignMask for PortableSignMask<S> {
    type S = S;
    type Mask = (u32x16<S>, f32x16<S>);

    const MASK_NAMES_PAIRS: bool = false;
    const SCALE: f32 = 1.0;
    const MOVED: f32 = 0.0;

    #[inline(always)]
    fn simd(self) -> S {
        self.0
    }

    #[inline(always)]
    fn empty_mask(self) -> Self::Mask {
        (u32x16::splat(self.0, 0), f32x16::splat(self.0, 4.0))
    }

    #[inline(always)]
    fn record(self, (negative, nearest): &mut Self::Mask, row: f32x16<S>, next: f32x16<S>) {
        for row in [row, next] {
            *negative += row.bitcast::<u32x16<S>>() >> 31;
            *nearest = self.nearer_zero(*nearest, row);
        }
    }

    #[inline(always)]
    fn add_up<const E: usize>(
        self,
        mask: &[Self::Mask; E],
        lanes: &mut [AlignedLanes<u32>],
    ) -> bool {
        let mut least = f32x16::splat(self.0, 4.0);
        for ((negative, nearest), lanes) in mask.iter().zip(lanes) {
            let sum = u32x16::load_array_ref(self.0, &lanes.0) + *negative;
            sum.store_array(&mut lanes.0);
            least = self.nearer_zero(least, *nearest);
        }
        least.simd_le(F32_BAND).any_true()
    }

    #[inline(always)]
    fn undecided(self, row: f32x16<S>) -> u64 {
        row.abs().simd_le(F32_BAND).to_bitmask()
    }
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
pub(super) mod x86 {
    #[cfg(target_arch = "x86")]
    use std::arch::x86::*;
    #[cfg(target_arch = "x86_64")]
    use std::arch::x86_64::*;

    use fearless_simd::x86::{Avx2, Avx512};
    use fearless_simd::{f32x8, f32x16, prelude::*, u16x16, u16x32, u32x16};

    use super::super::lanes::{AlignedLanes, LANES};
    use super::super::leaf_pair::F32_BAND;
    use super::SignMask;

    /// Floats from 0 to below this are in the band; from it on the first bit of their exponent is
    /// set.
    const BAND_END: f32 = 2.0;
    /// The scale at which twice the band is 2 wide.
    const BAND_SCALE: f32 = BAND_END / (2.0 * F32_BAND);
    /// The upper half of 32 bits.
    const UPPER: i32 = 0xffff_0000_u32.cast_signed();

    /// AVX-512, in which selecting the nearer number is one instruction.
    #[derive(Clone, Copy)]
    pub(in super::super) struct Avx512SignMask(pub Avx512);

    impl SignMask for Avx512SignMask {
        type S = Avx512;

        /// Two bits per row in words of 16 bits.
        type Mask = u32x16<Avx512>;

        const MASK_NAMES_PAIRS: bool = true;
        const SCALE: f32 = BAND_SCALE;
        const MOVED: f32 = F32_BAND;

        #[inline(always)]
        fn simd(self) -> Avx512 {
            self.0
        }

        #[inline(always)]
        fn nearer_zero(self, a: f32x16<Avx512>, b: f32x16<Avx512>) -> f32x16<Avx512> {
            nearer(self.0, a, b)
        }

        #[inline(always)]
        fn empty_mask(self) -> Self::Mask {
            u32x16::splat(self.0, 0)
        }

        #[inline(always)]
        fn record(self, mask: &mut Self::Mask, row: f32x16<Avx512>, next: f32x16<Avx512>) {
            *mask = shifted_in(self.0, *mask, row, next);
        }

        #[inline(always)]
        fn add_up<const E: usize>(
            self,
            mask: &[Self::Mask; E],
            lanes: &mut [AlignedLanes<u32>],
        ) -> bool {
            let mut decided = u32x16::splat(self.0, u32::MAX);
            for (mask, lanes) in mask.iter().zip(lanes) {
                let sum = u32x16::load_array_ref(self.0, &lanes.0) + ones(self.0, *mask);
                sum.store_array(&mut lanes.0);
                decided &= *mask | (*mask << 1);
            }
            !(decided | 0x5555_5555).simd_eq(u32::MAX).all_true()
        }

        #[inline(always)]
        fn undecided(self, row: f32x16<Avx512>) -> u64 {
            let bits = row.bitcast::<u32x16<Avx512>>();
            bits.simd_lt(BAND_END.to_bits()).to_bitmask()
        }

        #[inline(always)]
        fn which(self, mask: Self::Mask) -> (u32, [u16; 2 * LANES]) {
            let near = !(mask | (mask << 1)) & 0xaaaa_aaaa;
            let words = near.bitcast::<u16x32<Avx512>>();
            let mut which = [0; 2 * LANES];
            words.store_array(&mut which);
            (!words.simd_eq(0).to_bitmask() as u32, which)
        }
    }

    /// AVX2.
    #[derive(Clone, Copy)]
    pub(in super::super) struct Avx2SignMask(pub Avx2);

    impl SignMask for Avx2SignMask {
        type S = Avx2;

        /// The number of negative rows in two halves of 16 lanes, and the smallest of all
        /// joined words.
        type Mask = (u16x16<Avx2>, u16x16<Avx2>);

        const MASK_NAMES_PAIRS: bool = false;
        const SCALE: f32 = BAND_SCALE;
        const MOVED: f32 = F32_BAND;

        #[inline(always)]
        fn simd(self) -> Avx2 {
            self.0
        }

        #[inline(always)]
        fn empty_mask(self) -> Self::Mask {
            (u16x16::splat(self.0, 0), u16x16::splat(self.0, u16::MAX))
        }

        #[inline(always)]
        fn record(self, (negative, least): &mut Self::Mask, row: f32x16<Avx2>, next: f32x16<Avx2>) {
            let (row, row_end) = row.split();
            let (next, next_end) = next.split();
            for (row, next) in [(row, next), (row_end, next_end)] {
                let joined = upper_halves(self.0, row, next);
                *negative += joined >> 15;
                *least = joined.min(*least);
            }
        }

        #[inline(always)]
        fn add_up<const E: usize>(
            self,
            mask: &[Self::Mask; E],
            lanes: &mut [AlignedLanes<u32>],
        ) -> bool {
            let mut least = u16x16::splat(self.0, u16::MAX);
            for ((negative, nearest), lanes) in mask.iter().zip(lanes) {
                let bits = negative.bitcast::<fearless_simd::u32x8<Avx2>>();
                let sum = (bits & 0xffff) + (bits >> 16);
                if let Some(lanes) = lanes.0.first_chunk_mut() {
                    let sum = fearless_simd::u32x8::load_array_ref(self.0, lanes) + sum;
                    sum.store_array(lanes);
                }
                least = least.min(*nearest);
            }
            (least >> 14).simd_eq(0).any_true()
        }

        #[inline(always)]
        fn undecided(self, row: f32x16<Avx2>) -> u64 {
            let bits = row.bitcast::<u32x16<Avx2>>();
            bits.simd_lt(BAND_END.to_bits()).to_bitmask()
        }
    }

    fearless_simd::kernel!(
        #[inline(always)]
        fn nearer(token: Avx512, a: f32x16<Avx512>, b: f32x16<Avx512>) -> f32x16<Avx512> {
            // 0b0010: the smaller magnitude, with the sign cleared.
            _mm512_range_ps::<0b1010>(a.into(), b.into()).simd_into(token)
        }
    );

    fearless_simd::kernel!(
        /// The mask with the first two bits of each float of two rows shifted in.
        #[inline(always)]
        fn shifted_in(
            token: Avx512,
            mask: u32x16<Avx512>,
            row: f32x16<Avx512>,
            next: f32x16<Avx512>,
        ) -> u32x16<Avx512> {
            let first = _mm512_srli_epi32::<16>(_mm512_castps_si512(row.into()));
            let second = _mm512_castps_si512(next.into());
            // 0xca: of each bit the second value's where the mask is set, else the first's.
            let upper = _mm512_set1_epi32(UPPER);
            let joined = _mm512_ternarylogic_epi32::<0xca>(upper, second, first);
            _mm512_shldi_epi16::<2>(mask.into(), joined).simd_into(token)
        }
    );

    fearless_simd::kernel!(
        /// Counts the pairs of bits that begin with a one.
        #[inline(always)]
        fn ones(token: Avx512, mask: u32x16<Avx512>) -> u32x16<Avx512> {
            let first = _mm512_and_si512(mask.into(), _mm512_set1_epi32(0xaaaa_aaaa_u32 as i32));
            _mm512_popcnt_epi32(first).simd_into(token)
        }
    );

    fearless_simd::kernel!(
        /// The upper halves of two rows, in turn.
        #[inline(always)]
        fn upper_halves(token: Avx2, row: f32x8<Avx2>, next: f32x8<Avx2>) -> u16x16<Avx2> {
            let first = _mm256_srli_epi32::<16>(_mm256_castps_si256(row.into()));
            let second = _mm256_castps_si256(next.into());
            _mm256_blend_epi16::<0b1010_1010>(first, second).simd_into(token)
        }
    );
}
