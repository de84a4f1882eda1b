//! Loads and stores between columns and registers, as many values at a time as a register holds.
//!
//! Loops over the 32 channels of a block are written this way because the compiler otherwise
//! unrolls them into scalars before it vectorises.

use fearless_simd::prelude::*;

/// Channels of a block.
pub(super) const CHANNELS: usize = 32;
/// Greatest number of points of a block: both returns of each channel.
pub(super) const BLOCK_ROWS: usize = 2 * CHANNELS;

/// The values of `column` from index `at` on; 0 where it is too short.
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, column: &[f64], at: usize) -> S::f64s {
    match column.get(at..at + S::f64s::LEN) {
        Some(values) => S::f64s::from_slice(simd, values),
        None => S::f64s::splat(simd, 0.0),
    }
}

/// Writes `values` to `column` from index `at` on, if it is long enough.
#[inline(always)]
pub(super) fn store<S: Simd, V: SimdBase<S>>(values: V, column: &mut [V::Element], at: usize) {
    if let Some(to) = column.get_mut(at..at + V::LEN) {
        values.store_slice(to);
    }
}
