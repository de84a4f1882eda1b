//! Data packets of the single-return modes: 24 firing sequences, two a block.

use super::{Blocks, DATA_LEN, Returns, SEQUENCES};

/// Return mode byte: the strongest return of each firing.
const STRONGEST: u8 = 0x37;

/// Collects 24 firing sequences into a data packet of return mode strongest.
#[derive(Clone, Debug)]
pub struct PacketBuilder {
    blocks: Blocks,
    filled: usize,
}

impl Default for PacketBuilder {
    fn default() -> Self {
        Self::new()
    }
}

impl PacketBuilder {
    /// A builder of an empty packet.
    #[must_use]
    pub fn new() -> Self {
        Self {
            blocks: Blocks::empty(STRONGEST),
            filled: 0,
        }
    }

    /// Adds the next sequence, whose laser 0 fired at `azimuth_cdeg` hundredths of a degree (modulo a turn).
    ///
    /// The packet carries only the azimuth of the first of the two sequences of a block. Sequences beyond the
    /// 24th have no place and are dropped.
    pub fn firing(&mut self, azimuth_cdeg: u16, returns: &Returns) {
        if self.is_full() {
            return;
        }
        let (block, half) = (self.filled / 2, self.filled % 2);
        if half == 0 {
            self.blocks.azimuth(block, azimuth_cdeg);
        }
        self.blocks.returns(block, half, returns);
        self.filled += 1;
    }

    /// Whether all 24 sequences are there.
    #[must_use]
    pub const fn is_full(&self) -> bool {
        self.filled >= SEQUENCES
    }

    /// The UDP payload, its first firing at `timestamp_us` past the hour (modulo an hour); the builder starts anew.
    ///
    /// Sequences that were not added are there without returns.
    pub fn finish(&mut self, timestamp_us: u32) -> [u8; DATA_LEN] {
        core::mem::take(self).blocks.finish(timestamp_us)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::vlp16::{HOUR_US, LASERS};

    /// Returns that differ in every place: distance 100 x sequence + laser, reflectivity laser.
    fn distinct(sequence: usize) -> Returns {
        core::array::from_fn(|laser| ((100 * sequence + laser) as u16, laser as u8))
    }

    fn golden() -> [u8; DATA_LEN] {
        let mut builder = PacketBuilder::new();
        for sequence in 0..SEQUENCES {
            assert!(!builder.is_full());
            builder.firing(35_980 + 20 * sequence as u16, &distinct(sequence));
        }
        assert!(builder.is_full());
        builder.finish(3_599_999_999)
    }

    #[test]
    fn golden_bytes() {
        let packet = golden();
        // Block 0: flag, azimuth 359.80 deg = 0x8C8C, laser 0 and 1 of sequence 0.
        assert_eq!(
            packet[..10],
            [0xFF, 0xEE, 0x8C, 0x8C, 0x00, 0x00, 0x00, 0x01, 0x00, 0x01]
        );
        // Its second sequence begins after 16 channels of 3 bytes: 100 = 0x0064.
        assert_eq!(packet[52..58], [0x64, 0x00, 0x00, 0x65, 0x00, 0x01]);
        // Block 1: its first sequence is the third, at 360.20 deg, which is 0.20.
        assert_eq!(packet[100..107], [0xFF, 0xEE, 20, 0, 0xC8, 0x00, 0x00]);
        // Block 11, last channel: 2315 = 0x090B, reflectivity 15.
        assert_eq!(packet[1197..1200], [0x0B, 0x09, 0x0F]);
        // 3,599,999,999 = 0xD693A3FF; strongest, VLP-16.
        assert_eq!(packet[1200..], [0xFF, 0xA3, 0x93, 0xD6, 0x37, 0x22]);
    }

    #[test]
    fn the_next_packet_starts_empty_and_a_25th_sequence_is_dropped() {
        let mut builder = PacketBuilder::new();
        for sequence in 0..SEQUENCES {
            builder.firing(35_980 + 20 * sequence as u16, &distinct(sequence));
        }
        builder.firing(1, &distinct(99));
        assert_eq!(builder.finish(3_599_999_999), golden());
        let empty = builder.finish(0);
        for (at, &byte) in empty.iter().enumerate() {
            let expected = match (at, at % 100) {
                (1204, _) => 0x37,
                (1205, _) => 0x22,
                (..1200, 0) => 0xFF,
                (..1200, 1) => 0xEE,
                _ => 0,
            };
            assert_eq!(byte, expected, "byte {at}");
        }
    }

    #[test]
    fn a_stamp_past_the_hour_wraps() {
        let packet = PacketBuilder::new().finish(HOUR_US + 5);
        assert_eq!(packet[1200..1204], [5, 0, 0, 0]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn every_return_is_where_the_manual_puts_it(
            sequence in 0..SEQUENCES, laser in 0..LASERS, distance: u16, reflectivity: u8, azimuth in 0_u16..36_000,
        ) {
            let mut builder = PacketBuilder::new();
            for s in 0..SEQUENCES {
                let mut returns = [(0, 0); LASERS];
                if s == sequence {
                    returns[laser] = (distance, reflectivity);
                }
                builder.firing(azimuth, &returns);
            }
            let packet = builder.finish(0);
            // Block n/2 of 100 bytes, channel 16 x (n odd) + laser of 3 bytes after 4.
            let at = 100 * (sequence / 2) + 4 + 3 * (16 * (sequence % 2) + laser);
            prop_assert_eq!(u16::from_le_bytes([packet[at], packet[at + 1]]), distance);
            prop_assert_eq!(packet[at + 2], reflectivity);
            let others = (0..12).flat_map(|block| 100 * block + 4..100 * (block + 1));
            prop_assert!(others.filter(|i| !(at..at + 3).contains(i)).all(|i| packet[i] == 0));
            for block in 0..12 {
                let at = 100 * block + 2;
                prop_assert_eq!(u16::from_le_bytes([packet[at], packet[at + 1]]), azimuth);
            }
        }
    }
}
