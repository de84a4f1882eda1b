//! The sensors that share the packet of the VLP-16: a factory byte identifies them.
//!
//! Sources: the manuals 63-9243 (VLP-16, Puck Hi-Res), 63-9325 (VLP-32C) and that of the HDL-32E.

use protocol::vlp16::ReturnMode;

use super::BLOCKS;

/// A sensor model, as its packets differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketModel {
    /// VLP-16 and Puck LITE: two firings of 16 lasers a block.
    Vlp16,
    /// Puck Hi-Res: the same.
    PuckHiRes,
    /// HDL-32E: a firing of 32 lasers a block, one after the other.
    Hdl32e,
    /// VLP-32C: a firing of 32 lasers a block, in pairs; distances in units of 4 mm.
    Vlp32c,
}

impl PacketModel {
    /// All models.
    pub const ALL: [Self; 4] = [Self::Vlp16, Self::PuckHiRes, Self::Hdl32e, Self::Vlp32c];

    /// The factory byte of the model.
    #[must_use]
    pub const fn product(self) -> u8 {
        match self {
            Self::Vlp16 => 0x22,
            Self::PuckHiRes => 0x24,
            Self::Hdl32e => 0x21,
            Self::Vlp32c => 0x28,
        }
    }

    /// The number of lasers.
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

    /// Nanoseconds from one block to the next of other firings.
    #[must_use]
    pub const fn block_period_ns(self) -> i64 {
        self.firings_per_block() as i64 * self.firing_period_ns()
    }

    /// Nanoseconds from one packet to the next.
    #[must_use]
    pub const fn packet_period_ns(self, mode: ReturnMode) -> i64 {
        firing_blocks(mode) as i64 * self.block_period_ns()
    }
}

/// Blocks of a packet that belong to different firings.
#[must_use]
pub const fn firing_blocks(mode: ReturnMode) -> usize {
    match mode {
        ReturnMode::Dual => BLOCKS / 2,
        _ => BLOCKS,
    }
}

const _: () = {
    assert!(PacketModel::Vlp16.packet_period_ns(ReturnMode::Strongest) == 1_327_104);
    assert!(PacketModel::Hdl32e.packet_period_ns(ReturnMode::Strongest) == 552_960);
    assert!(PacketModel::Hdl32e.packet_period_ns(ReturnMode::Dual) == 276_480);
    assert!(PacketModel::Vlp32c.packet_period_ns(ReturnMode::Last) == 663_552);
    // Sixteen slots and the recharge: 16 x 2.304 + 18.432; 32 x 1.152 + 9.216 (HDL-32E).
    assert!(PacketModel::Vlp32c.firing_period_ns() == 16 * 2_304 + 18_432);
    assert!(PacketModel::Hdl32e.firing_period_ns() == 32 * 1_152 + 9_216);
};
