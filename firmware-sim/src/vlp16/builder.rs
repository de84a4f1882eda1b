//! Data packets: 12 blocks of 32 channels, shared by all models.

use protocol::vlp16::ReturnMode;

use super::model::{PacketModel, firing_blocks};
use super::{BLOCK_LEN, BLOCKS, CHANNEL_LEN, DATA_LEN, FLAG, HEADER_LEN, HOUR_US, TURN_CDEG, put};

/// Collects the firings of a sensor into data packets.
#[derive(Clone, Debug)]
pub struct DataPacketBuilder {
    model: PacketModel,
    mode: ReturnMode,
    bytes: [u8; DATA_LEN],
    filled: usize,
}

impl DataPacketBuilder {
    /// An empty packet.
    #[must_use]
    pub fn new(model: PacketModel, mode: ReturnMode) -> Self {
        let mut bytes = [0; DATA_LEN];
        for block in 0..BLOCKS {
            put(&mut bytes, block * BLOCK_LEN, &FLAG);
        }
        put(&mut bytes, DATA_LEN - 2, &[mode.to_u8(), model.product()]);
        Self {
            model,
            mode,
            bytes,
            filled: 0,
        }
    }

    /// Adds the next firing, whose first laser fired at `azimuth_cdeg` hundredths of a degree
    /// (modulo a revolution).
    ///
    /// `returns` has distance (in units of the model, 0 for no return) and calibrated reflectivity
    /// of each laser in firing order. In dual return they are the last returns, and `others` the
    /// strongest, or the second strongest where the last is the strongest; other modes ignore
    /// `others`. The packet carries only the azimuth of the first firing of a block. Missing lasers
    /// have no return; surplus firings are dropped.
    pub fn firing(&mut self, azimuth_cdeg: u16, returns: &[(u16, u8)], others: &[(u16, u8)]) {
        if self.is_full() {
            return;
        }
        let per_block = self.model.firings_per_block();
        let (place, part) = (self.filled / per_block, self.filled % per_block);
        if self.mode == ReturnMode::Dual {
            self.write(2 * place, part, azimuth_cdeg, returns);
            self.write(2 * place + 1, part, azimuth_cdeg, others);
        } else {
            self.write(place, part, azimuth_cdeg, returns);
        }
        self.filled += 1;
    }

    fn write(&mut self, block: usize, part: usize, azimuth_cdeg: u16, returns: &[(u16, u8)]) {
        let start = block * BLOCK_LEN;
        if part == 0 {
            let azimuth = azimuth_cdeg % TURN_CDEG;
            put(&mut self.bytes, start + FLAG.len(), &azimuth.to_le_bytes());
        }
        let lasers = self.model.lasers();
        let first = start + HEADER_LEN + CHANNEL_LEN * part * lasers;
        let channels = self.bytes.get_mut(first..).unwrap_or_default();
        let channels = channels.chunks_exact_mut(CHANNEL_LEN).take(lasers);
        for (channel, &(distance, reflectivity)) in channels.zip(returns) {
            let [low, high] = distance.to_le_bytes();
            channel.copy_from_slice(&[low, high, reflectivity]);
        }
    }

    /// Whether the packet holds all its firings.
    #[must_use]
    pub const fn is_full(&self) -> bool {
        self.filled >= firing_blocks(self.mode) * self.model.firings_per_block()
    }

    /// The UDP payload, its first firing at `timestamp_us` past the hour (modulo an hour); a new
    /// packet begins. Missing firings have no returns.
    pub fn finish(&mut self, timestamp_us: u32) -> [u8; DATA_LEN] {
        let mut bytes = core::mem::replace(self, Self::new(self.model, self.mode)).bytes;
        let stamp = (timestamp_us % HOUR_US).to_le_bytes();
        put(&mut bytes, BLOCKS * BLOCK_LEN, &stamp);
        bytes
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::*;
    use crate::vlp16::LASERS;

    /// Firing sequences of a data packet in a single-return mode: two per block.
    const SEQUENCES: usize = 2 * BLOCKS;
    /// Firing sequences of a data packet in dual-return mode: two blocks share their firings.
    const DUAL_SEQUENCES: usize = SEQUENCES / 2;

    fn strongest() -> DataPacketBuilder {
        DataPacketBuilder::new(PacketModel::Vlp16, ReturnMode::Strongest)
    }

    /// Firings of 32 lasers in a packet.
    fn firings(mode: ReturnMode) -> usize {
        if mode == ReturnMode::Dual { 6 } else { 12 }
    }

    fn row(firing: usize, lasers: usize) -> Vec<(u16, u8)> {
        (0..lasers)
            .map(|laser| ((100 * firing + laser) as u16, laser as u8))
            .collect()
    }

    /// Unique returns: distance 100 x sequence + laser, reflectivity laser.
    fn distinct(sequence: usize) -> [(u16, u8); LASERS] {
        core::array::from_fn(|laser| ((100 * sequence + laser) as u16, laser as u8))
    }

    fn golden() -> [u8; DATA_LEN] {
        let mut builder = strongest();
        for sequence in 0..SEQUENCES {
            assert!(!builder.is_full());
            builder.firing(35_980 + 20 * sequence as u16, &distinct(sequence), &[]);
        }
        assert!(builder.is_full());
        builder.finish(3_599_999_999)
    }

    #[test]
    fn data_packets_match_golden_bytes() {
        let packet = golden();
        // Block 0: flag, azimuth 359.80 deg = 0x8C8C, laser 0 and 1 of sequence 0.
        assert_eq!(
            packet[..10],
            [0xFF, 0xEE, 0x8C, 0x8C, 0x00, 0x00, 0x00, 0x01, 0x00, 0x01]
        );
        // Its second sequence starts after 16 channels of 3 bytes: 100 = 0x0064.
        assert_eq!(packet[52..58], [0x64, 0x00, 0x00, 0x65, 0x00, 0x01]);
        // Block 1: its first sequence is the third of the packet, at 360.20 deg, which is 0.20 deg.
        assert_eq!(packet[100..107], [0xFF, 0xEE, 20, 0, 0xC8, 0x00, 0x00]);
        // Block 11, last channel: 2315 = 0x090B, reflectivity 15.
        assert_eq!(packet[1197..1200], [0x0B, 0x09, 0x0F]);
        // 3,599,999,999 = 0xD693A3FF; strongest, VLP-16.
        assert_eq!(packet[1200..], [0xFF, 0xA3, 0x93, 0xD6, 0x37, 0x22]);
    }

    #[test]
    fn packets_start_empty_and_drop_surplus_firings() {
        let mut builder = strongest();
        for sequence in 0..SEQUENCES {
            builder.firing(35_980 + 20 * sequence as u16, &distinct(sequence), &[]);
        }
        builder.firing(1, &distinct(99), &[]);
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
    fn timestamps_wrap_at_the_hour() {
        let packet = strongest().finish(HOUR_US + 5);
        assert_eq!(packet[1200..1204], [5, 0, 0, 0]);
    }

    #[test]
    fn dual_return_packets_match_golden_bytes() {
        let mut builder = DataPacketBuilder::new(PacketModel::Vlp16, ReturnMode::Dual);
        for sequence in 0..DUAL_SEQUENCES as u16 {
            assert!(!builder.is_full());
            let last = [(1_000 + sequence, 1); LASERS];
            let strongest = [(500 + sequence, 2); LASERS];
            builder.firing(100 * sequence, &last, &strongest);
        }
        assert!(builder.is_full());
        builder.firing(9, &[(9, 9); LASERS], &[(9, 9); LASERS]);
        let packet = builder.finish(0x0102_0304);
        // Blocks 0 and 1: azimuth 0; last 1000 = 0x03E8, strongest 500 = 0x01F4, then sequence 1.
        assert_eq!(packet[..7], [0xFF, 0xEE, 0, 0, 0xE8, 0x03, 1]);
        assert_eq!(packet[52..55], [0xE9, 0x03, 1]);
        assert_eq!(packet[100..107], [0xFF, 0xEE, 0, 0, 0xF4, 0x01, 2]);
        assert_eq!(packet[152..155], [0xF5, 0x01, 2]);
        // Blocks 10 and 11: sequences 10 and 11, azimuth 10.00 deg = 0x03E8.
        assert_eq!(packet[1000..1007], [0xFF, 0xEE, 0xE8, 0x03, 0xF2, 0x03, 1]);
        assert_eq!(packet[1100..1107], [0xFF, 0xEE, 0xE8, 0x03, 0xFE, 0x01, 2]);
        assert_eq!(packet[1197..], [0xFF, 0x01, 2, 4, 3, 2, 1, 0x39, 0x22]);
        assert!(!builder.is_full());
    }

    /// The layout of the manual: block b at 100 b, its azimuth at offset 2, channel c at offset 4 +
    /// 3 c; mode and product at the end.
    #[test]
    fn thirty_two_lasers_fill_a_block() {
        for (model, product) in [(PacketModel::Hdl32e, 0x21), (PacketModel::Vlp32c, 0x28)] {
            for mode in [ReturnMode::Strongest, ReturnMode::Last, ReturnMode::Dual] {
                let mut packet = DataPacketBuilder::new(model, mode);
                for firing in 0..firings(mode) {
                    assert!(!packet.is_full());
                    packet.firing(10 * firing as u16, &row(firing, 32), &row(firing + 20, 32));
                }
                assert!(packet.is_full());
                packet.firing(9, &row(9, 32), &row(9, 32));
                let bytes = packet.finish(5);
                assert_eq!(bytes[1200..], [5, 0, 0, 0, mode.to_u8(), product]);
                for block in 0..12 {
                    let dual = mode == ReturnMode::Dual;
                    let firing = if dual { block / 2 } else { block };
                    let azimuth = [bytes[100 * block + 2], bytes[100 * block + 3]];
                    assert_eq!(u16::from_le_bytes(azimuth), 10 * firing as u16);
                    let shown = firing + if dual && block % 2 == 1 { 20 } else { 0 };
                    for channel in 0..32 {
                        let at = 100 * block + 4 + 3 * channel;
                        let distance = u16::from_le_bytes([bytes[at], bytes[at + 1]]);
                        assert_eq!(usize::from(distance), 100 * shown + channel);
                        assert_eq!(usize::from(bytes[at + 2]), channel);
                    }
                }
            }
        }
    }

    #[test]
    fn surplus_and_missing_lasers_do_not_affect_other_firings() {
        let mut packet = DataPacketBuilder::new(PacketModel::PuckHiRes, ReturnMode::Strongest);
        packet.firing(0, &[(0xFFFF, 0xFF); 40], &[]);
        packet.firing(0, &[(0x0102, 3); 2], &[]);
        let bytes = packet.finish(0);
        assert!(bytes[4..52].iter().all(|&byte| byte == 0xFF));
        assert_eq!(bytes[52..58], [2, 1, 3, 2, 1, 3]);
        assert!(bytes[58..100].iter().all(|&byte| byte == 0));
        assert_eq!(bytes[1205], 0x24);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn every_return_is_at_the_offset_of_the_manual(
            sequence in 0..SEQUENCES, laser in 0..LASERS, distance: u16, reflectivity: u8, azimuth in 0_u16..36_000,
        ) {
            let mut builder = strongest();
            for s in 0..SEQUENCES {
                let mut returns = [(0, 0); LASERS];
                if s == sequence {
                    returns[laser] = (distance, reflectivity);
                }
                builder.firing(azimuth, &returns, &[]);
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
