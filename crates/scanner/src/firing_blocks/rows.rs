//! From registers into columns: channels without a return are squeezed out on the way.
//!
//! A register is written whole; what stands beyond its kept values is written over by the next one, or stays beyond the last
//! point. Left out: what the values are.

use fearless_simd::prelude::*;
use fearless_simd::{mask8x32, u8x32};
use lidar::Layer;
use units::Stamp;

use super::{N, ROOM};
use crate::lanes::store;

/// The rows of a block, `L` a channel, side by side; a bit is set where a row becomes a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows<const L: usize>(u64);

/// Where the rows of a register's channels go, in `L` registers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Places<S: Simd, const L: usize> {
    kept: [S::mask64s; L],
    at: [usize; L],
}

impl<const L: usize> Rows<L> {
    /// Of a block with one layer or two.
    #[inline(always)]
    pub(super) fn kept(layers: [&Layer<'_>; L]) -> Self {
        Self(match layers.as_slice() {
            [first, second] => spread(first.kept()) | spread(second.kept()) << 1,
            [only, ..] => u64::from(only.kept()),
            [] => 0,
        })
    }

    /// How many are kept.
    #[inline(always)]
    pub(super) const fn count(self) -> usize {
        self.0.count_ones() as usize
    }

    /// How many are kept of those before `row`.
    #[inline(always)]
    const fn before(self, row: usize) -> usize {
        (self.0 & ((1 << row) - 1)).count_ones() as usize
    }

    /// Those of `channel` and of the channels in one register with it.
    #[inline(always)]
    pub(super) fn places<S: Simd>(self, simd: S, channel: usize) -> Places<S, L> {
        let mut places = Places {
            kept: [S::mask64s::splat(simd, false); L],
            at: [0; L],
        };
        for half in 0..L {
            let row = channel * L + half * S::f64s::LEN;
            places.kept[half] = S::mask64s::from_bitmask(simd, self.0 >> row);
            places.at[half] = self.before(row);
        }
        places
    }

    /// Writes a column of bytes from those of all channels.
    #[inline(always)]
    pub(super) fn put_bytes<S: Simd>(
        self,
        simd: S,
        column: &mut [u8; ROOM],
        layers: [&[u8; N]; L],
    ) {
        let mut rows = [u8x32::splat(simd, 0); L];
        for (row, layer) in rows.iter_mut().zip(layers) {
            *row = u8x32::from_slice(simd, layer);
        }
        side_by_side(&mut rows);
        for (half, bytes) in rows.iter().enumerate() {
            let kept = mask8x32::from_bitmask(simd, self.0 >> (half * N));
            store(bytes.compress(kept), column, self.before(half * N));
        }
    }
}

impl<S: Simd, const L: usize> Places<S, L> {
    /// Writes those rows of a column, from a register for each layer.
    #[inline(always)]
    pub(super) fn put(&self, column: &mut [f64; ROOM], layers: [S::f64s; L]) {
        let mut rows = layers;
        side_by_side(&mut rows);
        for (half, row) in rows.iter().enumerate() {
            store(row.compress(self.kept[half]), column, self.at[half]);
        }
    }

    /// The same for a column of times, from their nanoseconds.
    #[inline(always)]
    pub(super) fn put_times<C>(&self, column: &mut [Stamp<C>; ROOM], layers: [S::i64s; L]) {
        let mut rows = layers;
        side_by_side(&mut rows);
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

/// Of two layers the values of each channel next to each other; one layer as it is.
#[inline(always)]
fn side_by_side<S: Simd, V: SimdBase<S>>(layers: &mut [V]) {
    if let [first, second] = layers {
        (*first, *second) = (first.zip_low(*second), first.zip_high(*second));
    }
}

/// Every bit n as bit 2 n.
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

    /// A column of a byte a channel and one of a float a channel.
    fn put<S: Simd, const L: usize>(
        simd: S,
        rows: Rows<L>,
        layers: [&[u8; N]; L],
    ) -> [[u8; ROOM]; 2] {
        let (mut bytes, mut floats) = ([0; ROOM], [0.0; ROOM]);
        rows.put_bytes(simd, &mut bytes, layers);
        for channel in (0..N).step_by(S::f64s::LEN) {
            let values =
                |layer: &[u8; N]| S::f64s::from_fn(simd, |lane| f64::from(layer[channel + lane]));
            let places: Places<S, L> = rows.places(simd, channel);
            places.put(&mut floats, layers.map(values));
        }
        [bytes, floats.map(|value| value as u8)]
    }

    proptest! {
        #[test]
        fn rows_are_what_a_loop_over_the_bits_gives(first: u32, second: u32) {
            let layers: [[u8; N]; 2] = [0, 100].map(|from| std::array::from_fn(|i| from + i as u8));
            let bit = |mask: u32, n: usize| mask >> n & 1 != 0;
            let singles: Vec<u8> = (0..N).filter(|&n| bit(first, n)).map(|n| layers[0][n]).collect();
            let pairs: Vec<u8> = (0..N)
                .flat_map(|n| [(first, 0, n), (second, 1, n)])
                .filter(|&(mask, _, n)| bit(mask, n))
                .map(|(_, layer, n)| layers[layer][n])
                .collect();
            let level = Level::new();
            let one = Rows::<1>(u64::from(first));
            let got = dispatch!(level, simd => put(simd, one, [&layers[0]]));
            prop_assert_eq!(one.count(), singles.len());
            prop_assert_eq!(got.map(|column| column[..singles.len()].to_vec()), [singles.clone(), singles]);
            let two = Rows::<2>(spread(first) | spread(second) << 1);
            let got = dispatch!(level, simd => put(simd, two, [&layers[0], &layers[1]]));
            prop_assert_eq!(two.count(), pairs.len());
            prop_assert_eq!(got.map(|column| column[..pairs.len()].to_vec()), [pairs.clone(), pairs]);
        }
    }
}
