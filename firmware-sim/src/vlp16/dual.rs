//! Data packets of dual-return mode: 12 firing sequences, each told of by two blocks.
//!
//! Blocks come in pairs with one azimuth. The even block of a pair holds the last returns, the odd one the strongest;
//! where the last return is the strongest, the odd block holds the second strongest (manual 63-9243, "Dual return mode").

use super::{Blocks, DATA_LEN, DUAL_SEQUENCES, Returns};

/// Return mode byte: last and strongest return of each firing.
const DUAL: u8 = 0x39;

/// Collects 12 firing sequences into a data packet of return mode dual.
#[derive(Clone, Debug)]
pub struct DualPacketBuilder {
    blocks: Blocks,
    filled: usize,
}

impl Default for DualPacketBuilder {
    fn default() -> Self {
        Self::new()
    }
}

impl DualPacketBuilder {
    /// A builder of an empty packet.
    #[must_use]
    pub fn new() -> Self {
        Self {
            blocks: Blocks::empty(DUAL),
            filled: 0,
        }
    }

    /// Adds the next sequence, whose laser 0 fired at `azimuth_cdeg` hundredths of a degree (modulo a turn).
    ///
    /// `strongest` holds the second strongest return of a laser whose last return is its strongest. The packet carries
    /// only the azimuth of every other sequence. Sequences beyond the 12th have no place and are dropped.
    pub fn firing(&mut self, azimuth_cdeg: u16, last: &Returns, strongest: &Returns) {
        if self.is_full() {
            return;
        }
        let (pair, half) = (self.filled / 2, self.filled % 2);
        for (block, returns) in [(2 * pair, last), (2 * pair + 1, strongest)] {
            if half == 0 {
                self.blocks.azimuth(block, azimuth_cdeg);
            }
            self.blocks.returns(block, half, returns);
        }
        self.filled += 1;
    }

    /// Whether all 12 sequences are there.
    #[must_use]
    pub const fn is_full(&self) -> bool {
        self.filled >= DUAL_SEQUENCES
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
    use super::*;
    use crate::vlp16::LASERS;

    #[test]
    fn golden_bytes() {
        let mut builder = DualPacketBuilder::new();
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
}
