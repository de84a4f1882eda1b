//! Which of the rows written at once become points, worked out eight at a time.
//!
//! A bit a row says whether it is kept. A table gives for every byte of such bits the places of those that are set, so that
//! it takes no branch and no loop over rows. Left out: the rows.

/// Rows that become points, out of `R`, and in which order.
#[derive(Clone, Copy, Debug)]
pub struct Order<const R: usize> {
    rows: [u8; R],
    len: usize,
}

/// What a byte of bits gives: places, one a byte from the lowest, and how many.
#[derive(Clone, Copy)]
struct Places {
    places: u64,
    count: usize,
}

/// Bits are eight rows in order.
static EIGHT: [Places; 256] = places(&[0, 1, 2, 3, 4, 5, 6, 7], 1);
/// The low four bits are four rows, the high four those 32 further on; of two with one place the low one comes first.
static FOUR_PAIRS: [Places; 256] = places(&[0, 32, 1, 33, 2, 34, 3, 35], 4);
/// Adds one to each of eight bytes.
const ONES: u64 = 0x0101_0101_0101_0101;

impl Order<32> {
    /// The rows whose bits are set, the lowest first.
    #[inline]
    #[must_use]
    pub fn of(mask: u32) -> Self {
        let mut order = Self {
            rows: [0; 32],
            len: 0,
        };
        for (eighth, byte) in mask.to_le_bytes().into_iter().enumerate() {
            order.add(EIGHT[usize::from(byte)], 8 * eighth as u64);
        }
        order
    }
}

impl Order<64> {
    /// Of rows in pairs, n and 32 + n, those whose bits n are set in `first` and in `second`; both of a pair side by side.
    #[inline]
    #[must_use]
    pub fn of_pairs(first: u32, second: u32) -> Self {
        let mut order = Self {
            rows: [0; 64],
            len: 0,
        };
        for fourth in 0..8 {
            let bits = |mask: u32| mask >> (4 * fourth) & 0xF;
            let byte = bits(first) | bits(second) << 4;
            order.add(FOUR_PAIRS[(byte & 0xFF) as usize], 4 * fourth);
        }
        order
    }
}

impl<const R: usize> Order<R> {
    /// Adds rows counted from `base`; what is written beyond their number is written over next time.
    #[inline(always)]
    fn add(&mut self, rows: Places, base: u64) {
        let places = rows.places + base * ONES;
        if let Some(room) = self.rows.get_mut(self.len..self.len + 8) {
            room.copy_from_slice(&places.to_le_bytes());
        }
        self.len += rows.count;
    }

    /// The rows.
    #[inline]
    #[must_use]
    pub fn rows(&self) -> &[u8] {
        self.rows.get(..self.len).unwrap_or_default()
    }

    /// How many rows there are.
    #[inline]
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    #[inline]
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }
}

/// For every byte the places of its bits. Place n of the list belongs to bit n / 2 and 4 + n / 2 in turns where rows come in
/// pairs (`stride` 4), else to bit n.
const fn places(list: &[u8; 8], stride: usize) -> [Places; 256] {
    let mut table = [Places {
        places: 0,
        count: 0,
    }; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut n = 0;
        while n < 8 {
            let bit = if stride == 4 { n / 2 + 4 * (n % 2) } else { n };
            if byte >> bit & 1 != 0 {
                table[byte].places |= (list[n] as u64) << (8 * table[byte].count);
                table[byte].count += 1;
            }
            n += 1;
        }
        byte += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn orders_are_what_a_loop_over_the_bits_gives(first: u32, second: u32) {
            let bit = |mask: u32, n: u8| mask >> n & 1 != 0;
            let singles: Vec<u8> = (0..32).filter(|&n| bit(first, n)).collect();
            let order = Order::of(first);
            prop_assert_eq!(order.rows(), singles);
            let pairs: Vec<u8> = (0..32)
                .flat_map(|n| [(first, n, n), (second, n, n + 32)])
                .filter(|&(mask, n, _)| bit(mask, n))
                .map(|(_, _, row)| row)
                .collect();
            let order = Order::of_pairs(first, second);
            prop_assert_eq!(order.rows(), pairs);
        }
    }

    #[test]
    fn all_and_none() {
        assert!(Order::of(0).is_empty() && Order::of_pairs(0, 0).is_empty());
        assert_eq!(Order::of(u32::MAX).len(), 32);
        assert_eq!(Order::of_pairs(u32::MAX, u32::MAX).rows()[62..], [31, 63]);
    }
}
