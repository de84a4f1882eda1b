//! Between columns and registers: as many values at a time as a register holds.
//!
//! Loops over the 32 channels of a block are written this way because the compiler, left alone, unrolls them into single values
//! before it looks for registers. Left out: what is computed.

use fearless_simd::prelude::*;

/// The values of `column` from place `at` on; 0 where it is too short.
#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, column: &[f64], at: usize) -> S::f64s {
    match column.get(at..at + S::f64s::LEN) {
        Some(values) => S::f64s::from_slice(simd, values),
        None => S::f64s::splat(simd, 0.0),
    }
}

/// Writes them to `column` from place `at` on, where it is long enough.
#[inline(always)]
pub(crate) fn store<S: Simd, V: SimdBase<S>>(values: V, column: &mut [V::Element], at: usize) {
    if let Some(to) = column.get_mut(at..at + V::LEN) {
        values.store_slice(to);
    }
}
