//! The sensors that share the VLP-16's packet: 12 blocks of 32 channels, told apart by a factory byte.
//!
//! From the makers' manuals: 63-9243 (VLP-16, Puck Hi-Res), the HDL-32E's, 63-9325 (VLP-32C). Left out: angles of lasers, which are nothing a
//! packet knows of.

use super::{BLOCKS, Blocks, DATA_LEN};

/// Which sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// VLP-16 and Puck LITE: two firings of 16 lasers a block.
    Vlp16,
    /// Puck Hi-Res: the same.
    PuckHiRes,
    /// HDL-32E: a firing of 32 lasers a block, one after the other.
    Hdl32e,
    /// VLP-32C: a firing of 32 lasers a block, in pairs; distances in units of 4 mm.
    Vlp32c,
}

/// Which of a laser's returns go into packets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ReturnMode {
    /// The strongest.
    #[default]
    Strongest,
    /// The last.
    Last,
    /// Two: the last in even blocks, and in odd ones the strongest, or the second strongest where the last is the strongest.
    Dual,
}

impl Model {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Vlp16, Self::PuckHiRes, Self::Hdl32e, Self::Vlp32c];

    /// The factory byte that names it.
    #[must_use]
    pub const fn product(self) -> u8 {
        match self {
            Self::Vlp16 => 0x22,
            Self::PuckHiRes => 0x24,
            Self::Hdl32e => 0x21,
            Self::Vlp32c => 0x28,
        }
    }

    /// How many lasers it has.
    #[must_use]
    pub const fn lasers(self) -> usize {
        match self {
            Self::Vlp16 | Self::PuckHiRes => 16,
            Self::Hdl32e | Self::Vlp32c => 32,
        }
    }

    /// Firings of all lasers that a block holds.
    #[must_use]
    pub const fn firings_per_block(self) -> usize {
        32 / self.lasers()
    }

    /// Nanoseconds from one firing of all lasers to the next.
    #[must_use]
    pub const fn firing_period_ns(self) -> i64 {
        match self {
            Self::Vlp16 | Self::PuckHiRes | Self::Vlp32c => 55_296,
            Self::Hdl32e => 46_080,
        }
    }

    /// Millimetres in one unit of distance.
    #[must_use]
    pub const fn distance_unit_mm(self) -> u32 {
        match self {
            Self::Vlp16 | Self::PuckHiRes | Self::Hdl32e => 2,
            Self::Vlp32c => 4,
        }
    }

    /// Nanoseconds that a block's firings take.
    #[must_use]
    pub const fn block_period_ns(self) -> i64 {
        self.firings_per_block() as i64 * self.firing_period_ns()
    }

    /// Nanoseconds from one packet to the next.
    #[must_use]
    pub const fn packet_period_ns(self, mode: ReturnMode) -> i64 {
        mode.blocks() as i64 * self.block_period_ns()
    }
}

impl ReturnMode {
    /// The byte that names it.
    #[must_use]
    pub const fn byte(self) -> u8 {
        match self {
            Self::Strongest => 0x37,
            Self::Last => 0x38,
            Self::Dual => 0x39,
        }
    }

    /// Blocks of a packet that tell of different firings.
    #[must_use]
    pub const fn blocks(self) -> usize {
        match self {
            Self::Strongest | Self::Last => BLOCKS,
            Self::Dual => BLOCKS / 2,
        }
    }
}

const _: () = {
    assert!(Model::Vlp16.packet_period_ns(ReturnMode::Strongest) == 1_327_104);
    assert!(Model::Hdl32e.packet_period_ns(ReturnMode::Strongest) == 552_960);
    assert!(Model::Hdl32e.packet_period_ns(ReturnMode::Dual) == 276_480);
    assert!(Model::Vlp32c.packet_period_ns(ReturnMode::Last) == 663_552);
    // Sixteen slots and the recharge: 16 x 2.304 + 18.432; 32 x 1.152 + 9.216 (HDL-32E).
    assert!(Model::Vlp32c.firing_period_ns() == 16 * 2_304 + 18_432);
    assert!(Model::Hdl32e.firing_period_ns() == 32 * 1_152 + 9_216);
};

/// Collects the firings of any model into data packets.
#[derive(Clone, Debug)]
pub struct ModelPacket {
    model: Model,
    mode: ReturnMode,
    blocks: Blocks,
    filled: usize,
}

impl ModelPacket {
    /// An empty packet.
    #[must_use]
    pub fn new(model: Model, mode: ReturnMode) -> Self {
        Self {
            model,
            mode,
            blocks: Blocks::of(mode.byte(), model.product()),
            filled: 0,
        }
    }

    /// Adds the next firing, whose first laser fired at `azimuth_cdeg` hundredths of a degree (modulo a turn): distance in the model's units
    /// (0 for no return) and calibrated reflectivity of each laser in the order of firing.
    ///
    /// In dual return `returns` are the last ones, and `others` the strongest, or the second strongest where the last is the strongest; in the
    /// other modes `others` has no place. The packet carries only the azimuth of a block's first firing. Lasers that are missing have no return;
    /// firings beyond what fits are dropped.
    pub fn firing(&mut self, azimuth_cdeg: u16, returns: &[(u16, u8)], others: &[(u16, u8)]) {
        if self.is_full() {
            return;
        }
        let per_block = self.model.firings_per_block();
        let (place, part) = (self.filled / per_block, self.filled % per_block);
        let dual = self.mode == ReturnMode::Dual;
        let block = if dual { 2 * place } else { place };
        let first_channel = part * self.model.lasers();
        self.half(block, part, first_channel, azimuth_cdeg, returns);
        if dual {
            self.half(block + 1, part, first_channel, azimuth_cdeg, others);
        }
        self.filled += 1;
    }

    fn half(&mut self, block: usize, part: usize, channel: usize, cdeg: u16, of: &[(u16, u8)]) {
        if part == 0 {
            self.blocks.azimuth(block, cdeg);
        }
        let of = of.get(..self.model.lasers()).unwrap_or(of);
        self.blocks.channels(block, channel, of);
    }

    /// Whether no firing fits any more.
    #[must_use]
    pub const fn is_full(&self) -> bool {
        self.filled >= self.mode.blocks() * self.model.firings_per_block()
    }

    /// The UDP payload, its first firing at `timestamp_us` past the hour (modulo an hour); a new packet begins.
    ///
    /// Firings that were not added are there without returns.
    pub fn finish(&mut self, timestamp_us: u32) -> [u8; DATA_LEN] {
        let empty = Self::new(self.model, self.mode);
        core::mem::replace(self, empty).blocks.finish(timestamp_us)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;
    use crate::vlp16::{DUAL_SEQUENCES, DualPacketBuilder, LASERS, PacketBuilder, SEQUENCES};

    fn row(firing: usize, lasers: usize) -> Vec<(u16, u8)> {
        (0..lasers)
            .map(|laser| ((100 * firing + laser) as u16, laser as u8))
            .collect()
    }

    #[test]
    fn a_vlp16_is_the_vlp16s() {
        let mut ours = ModelPacket::new(Model::Vlp16, ReturnMode::Strongest);
        let mut theirs = PacketBuilder::new();
        for firing in 0..SEQUENCES {
            let returns = row(firing, LASERS);
            ours.firing(20 * firing as u16, &returns, &[]);
            theirs.firing(20 * firing as u16, &returns.try_into().unwrap());
        }
        assert!(ours.is_full());
        assert_eq!(ours.finish(77), theirs.finish(77));
        let mut ours = ModelPacket::new(Model::Vlp16, ReturnMode::Dual);
        let mut theirs = DualPacketBuilder::new();
        for firing in 0..DUAL_SEQUENCES {
            let (last, strongest) = (row(firing, LASERS), row(firing + 50, LASERS));
            ours.firing(20 * firing as u16, &last, &strongest);
            theirs.firing(
                20 * firing as u16,
                &last.try_into().unwrap(),
                &strongest.try_into().unwrap(),
            );
        }
        assert!(ours.is_full());
        assert_eq!(ours.finish(78), theirs.finish(78));
        assert!(!ours.is_full());
    }

    /// The manual's layout: block b at 100 b, azimuth 2 into it, channel c at 4 + 3 c; mode and product at the end.
    #[test]
    fn thirty_two_lasers_fill_a_block() {
        for (model, product) in [(Model::Hdl32e, 0x21), (Model::Vlp32c, 0x28)] {
            for mode in [ReturnMode::Strongest, ReturnMode::Last, ReturnMode::Dual] {
                let mut packet = ModelPacket::new(model, mode);
                for firing in 0..mode.blocks() {
                    assert!(!packet.is_full());
                    packet.firing(10 * firing as u16, &row(firing, 32), &row(firing + 20, 32));
                }
                assert!(packet.is_full());
                packet.firing(9, &row(9, 32), &row(9, 32));
                let bytes = packet.finish(5);
                assert_eq!(bytes[1200..], [5, 0, 0, 0, mode.byte(), product]);
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
    fn too_many_or_too_few_lasers_stay_in_their_firing() {
        let mut packet = ModelPacket::new(Model::PuckHiRes, ReturnMode::Strongest);
        packet.firing(0, &[(0xFFFF, 0xFF); 40], &[]);
        packet.firing(0, &[(0x0102, 3); 2], &[]);
        let bytes = packet.finish(0);
        assert!(bytes[4..52].iter().all(|&byte| byte == 0xFF));
        assert_eq!(bytes[52..58], [2, 1, 3, 2, 1, 3]);
        assert!(bytes[58..100].iter().all(|&byte| byte == 0));
        assert_eq!(bytes[1205], 0x24);
    }
}
