//! Stream compaction: registers are written to columns without the channels that have no return.
//!
//! Each register is written whole. The next one overwrites the values beyond its kept ones; those
//! of the last register stay beyond the last point.

use fearless_simd::prelude::*;
use fearless_simd::{mask8x32, u8x32};
use lidar::ReturnLayer;
use units::Stamp;

use super::lanes::{BLOCK_ROWS, CHANNELS, store};

/// The rows of a block, `L` adjacent ones per channel. A set bit is a row that becomes a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct CompressedRows<const L: usize>(u64);

/// Positions of the rows of one register's channels, in `L` registers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Destinations<S: Simd, const L: usize> {
    kept: [S::mask64s; L],
    at: [usize; L],
}

impl<const L: usize> CompressedRows<L> {
    /// The kept rows of a block with one layer or two.
    #[inline(always)]
    pub(super) fn kept(layers: [&ReturnLayer<'_>; L]) -> Self {
        Self(match layers.as_slice() {
            [first, second] => spread(first.kept()) | spread(second.kept()) << 1,
            [only, ..] => u64::from(only.kept()),
            [] => 0,
        })
    }

    /// Number of kept rows.
    #[inline(always)]
    pub(super) const fn count(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Number of kept rows before `row`.
    #[inline(always)]
    const fn before(self, row: usize) -> usize {
        (self.0 & ((1 << row) - 1)).count_ones() as usize
    }

    /// Destinations of `channel` and of the channels in one register with it.
    #[inline(always)]
    pub(super) fn destinations<S: Simd>(self, simd: S, channel: usize) -> Destinations<S, L> {
        let mut destinations = Destinations {
            kept: [S::mask64s::splat(simd, false); L],
            at: [0; L],
        };
        for half in 0..L {
            let row = channel * L + half * S::f64s::LEN;
            destinations.kept[half] = S::mask64s::from_bitmask(simd, self.0 >> row);
            destinations.at[half] = self.before(row);
        }
        destinations
    }

    /// Writes a column of bytes from the bytes of all channels.
    #[inline(always)]
    pub(super) fn put_bytes<S: Simd>(
        self,
        simd: S,
        column: &mut [u8; BLOCK_ROWS],
        layers: [&[u8; CHANNELS]; L],
    ) {
        let mut rows = [u8x32::splat(simd, 0); L];
        for (row, layer) in rows.iter_mut().zip(layers) {
            *row = u8x32::from_slice(simd, layer);
        }
        interleave(&mut rows);
        for (half, bytes) in rows.iter().enumerate() {
            let kept = mask8x32::from_bitmask(simd, self.0 >> (half * CHANNELS));
            store(bytes.compress(kept), column, self.before(half * CHANNELS));
        }
    }
}

impl<S: Simd, const L: usize> Destinations<S, L> {
    /// Writes those rows of a column, from a register for each layer.
    #[inline(always)]
    pub(super) fn put(&self, column: &mut [f64; BLOCK_ROWS], layers: [S::f64s; L]) {
        let mut rows = layers;
        interleave(&mut rows);
        for (half, row) in rows.iter().enumerate() {
            store(row.compress(self.kept[half]), column, self.at[half]);
        }
    }

    /// Writes those rows of a column of times, from their nanoseconds.
    #[inline(always)]
    pub(super) fn put_times<C>(&self, column: &mut [Stamp<C>; BLOCK_ROWS], layers: [S::i64s; L]) {
        let mut rows = layers;
        interleave(&mut rows);
        for (half, row) in rows.iter().enumerate() {
            let at = self.at[half];
            let nanos = row.compress(self.kept[half]);
            if let Some(to) = column.get_mut(at..at + S::i64s::LEN) {
                for (to, ns) in to.iter_mut().zip(nanos.as_slice()) {
                    *to = Stamp::from_nanos(*ns);
                }
            }
        }
    }
}

/// Interleaves two layers channel by channel; leaves one layer as it is.
#[inline(always)]
fn interleave<S: Simd, V: SimdBase<S>>(layers: &mut [V]) {
    if let [first, second] = layers {
        (*first, *second) = (first.zip_low(*second), first.zip_high(*second));
    }
}

/// Moves every bit n to bit 2 n.
#[inline(always)]
const fn spread(bits: u32) -> u64 {
    let mut x = bits as u64;
    x = (x | x << 16) & 0x0000_FFFF_0000_FFFF;
    x = (x | x << 8) & 0x00FF_00FF_00FF_00FF;
    x = (x | x << 4) & 0x0F0F_0F0F_0F0F_0F0F;
    x = (x | x << 2) & 0x3333_3333_3333_3333;
    (x | x << 1) & 0x5555_5555_5555_5555
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    use super::*;

    /// A column of bytes and one of floats, both holding the same values.
    fn put<S: Simd, const L: usize>(
        simd: S,
        rows: CompressedRows<L>,
        layers: [&[u8; CHANNELS]; L],
    ) -> [[u8; BLOCK_ROWS]; 2] {
        let (mut bytes, mut floats) = ([0; BLOCK_ROWS], [0.0; BLOCK_ROWS]);
        rows.put_bytes(simd, &mut bytes, layers);
        for channel in (0..CHANNELS).step_by(S::f64s::LEN) {
            let values = |layer: &[u8; CHANNELS]| {
                S::f64s::from_fn(simd, |lane| f64::from(layer[channel + lane]))
            };
            let destinations: Destinations<S, L> = rows.destinations(simd, channel);
            destinations.put(&mut floats, layers.map(values));
        }
        [bytes, floats.map(|value| value as u8)]
    }

    proptest! {
        #[test]
        fn compaction_equals_a_loop_over_the_bits(first: u32, second: u32) {
            let layers: [[u8; CHANNELS]; 2] = [0, 100].map(|from| std::array::from_fn(|i| from + i as u8));
            let bit = |mask: u32, n: usize| mask >> n & 1 != 0;
            let singles: Vec<u8> = (0..CHANNELS).filter(|&n| bit(first, n)).map(|n| layers[0][n]).collect();
            let pairs: Vec<u8> = (0..CHANNELS)
                .flat_map(|n| [(first, 0, n), (second, 1, n)])
                .filter(|&(mask, _, n)| bit(mask, n))
                .map(|(_, layer, n)| layers[layer][n])
                .collect();
            let level = Level::new();
            let one = CompressedRows::<1>(u64::from(first));
            let got = dispatch!(level, simd => put(simd, one, [&layers[0]]));
            prop_assert_eq!(one.count(), singles.len());
            prop_assert_eq!(got.map(|column| column[..singles.len()].to_vec()), [singles.clone(), singles]);
            let two = CompressedRows::<2>(spread(first) | spread(second) << 1);
            let got = dispatch!(level, simd => put(simd, two, [&layers[0], &layers[1]]));
            prop_assert_eq!(two.count(), pairs.len());
            prop_assert_eq!(got.map(|column| column[..pairs.len()].to_vec()), [pairs.clone(), pairs]);
        }
    }
}
