//! The data packet: 12 blocks of an azimuth and 32 channels, a timestamp and the two factory bytes
//! (manual 9.3.2).
//!
//! A [`DataPacket`] is a view that is checked once; its accessors cannot fail. The model determines
//! which laser a channel belongs to and when it fired.

use super::PacketError;
use crate::codes::byte_codes;

/// Length of a data packet's UDP payload in bytes.
pub const DATA_LEN: usize = 1206;
/// Blocks in a data packet.
pub const BLOCKS: usize = 12;
/// Length of a block in bytes.
pub const BLOCK_LEN: usize = 100;
/// Channels in a block.
pub const CHANNELS: usize = 32;

const LAYER: &str = "lidar data packet";
const FLAG: [u8; 2] = [0xFF, 0xEE];
const FLAG_LEN: usize = FLAG.len();
const AZIMUTH_LEN: usize = 2;
const CHANNEL_LEN: usize = 3;
const TAIL_LEN: usize = 4 + 1 + 1;

// Manual 9.3.2: flag, azimuth and 32 channels make a block; 12 blocks, timestamp and factory bytes
// a packet.
const _: () = assert!(FLAG_LEN + AZIMUTH_LEN + CHANNELS * CHANNEL_LEN == BLOCK_LEN);
const _: () = assert!(BLOCKS * BLOCK_LEN + TAIL_LEN == DATA_LEN);

const NO_CHANNELS: [[u8; CHANNEL_LEN]; CHANNELS] = [[0; CHANNEL_LEN]; CHANNELS];

/// A revolution in hundredths of a degree.
const REVOLUTION_CDEG: u16 = 36_000;

/// A checked view of a data packet's payload.
#[derive(Clone, Copy, Debug)]
pub struct DataPacket<'a> {
    blocks: &'a [[u8; BLOCK_LEN]; BLOCKS],
    tail: &'a [u8; TAIL_LEN],
}

/// One block of a data packet.
#[derive(Clone, Copy, Debug)]
pub struct DataBlock<'a>(&'a [u8; BLOCK_LEN]);

/// One channel of a block: the measurement of one laser in one firing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChannelReturn {
    /// Distance in the model's unit (2 or 4 mm); 0 without a return.
    pub distance_raw: u16,
    /// Calibrated reflectivity: 0 to 100 diffuse, 101 to 255 retroreflective.
    pub reflectivity: u8,
}

byte_codes! {
    /// Returns that the packet carries (first factory byte, manual table 9-2).
    pub enum ReturnMode {
        /// The strongest return.
        Strongest = 0x37,
        /// The last return.
        Last = 0x38,
        /// Blocks come in pairs of one firing: the last return in the even block, the strongest in
        /// the odd one, or the second strongest where the last is the strongest.
        Dual = 0x39,
    }
}

byte_codes! {
    /// Sensor that the packet is from (second factory byte, manual table 9-2). Firmware before
    /// 3.0.29 has no factory bytes.
    pub enum Product {
        /// HDL-32E.
        Hdl32e = 0x21,
        /// VLP-16 and Puck LITE.
        Vlp16 = 0x22,
        /// Puck Hi-Res.
        PuckHiRes = 0x24,
        /// VLP-32C.
        Vlp32c = 0x28,
    }
}

impl<'a> DataPacket<'a> {
    /// Checks length, every block's flag and every block's azimuth.
    ///
    /// Factory bytes are not checked: unknown ones stay readable.
    ///
    /// # Errors
    /// [`PacketError`] with the first fault and its offset.
    pub fn new(payload: &'a [u8]) -> Result<Self, PacketError> {
        let packet = Self::view(payload).ok_or(PacketError::Length {
            layer: LAYER,
            expected: DATA_LEN,
            got: payload.len(),
        })?;
        // Nearly all packets are valid, so no early exit.
        let valid = packet
            .blocks()
            .fold(true, |valid, block| valid & block.is_valid());
        if valid { Ok(packet) } else { packet.fault() }
    }

    /// The first fault.
    #[cold]
    fn fault(self) -> Result<Self, PacketError> {
        for (i, block) in self.blocks().enumerate() {
            let offset = i * BLOCK_LEN;
            if block.flag() != FLAG {
                return Err(PacketError::BlockFlag {
                    layer: LAYER,
                    offset,
                    got: block.flag(),
                });
            }
            if block.azimuth_cdeg() > REVOLUTION_CDEG {
                return Err(PacketError::Azimuth {
                    layer: LAYER,
                    offset: offset + FLAG_LEN,
                    got: block.azimuth_cdeg(),
                });
            }
        }
        Ok(self)
    }

    fn view(payload: &'a [u8]) -> Option<Self> {
        let (blocks, tail) = payload.split_at_checked(BLOCKS * BLOCK_LEN)?;
        let (blocks, _) = blocks.as_chunks::<BLOCK_LEN>();
        Some(Self {
            blocks: blocks.try_into().ok()?,
            tail: tail.try_into().ok()?,
        })
    }

    /// Block `i` in wire order; `None` from 12 on.
    #[must_use]
    pub fn block(&self, i: usize) -> Option<DataBlock<'a>> {
        self.blocks.get(i).map(DataBlock)
    }

    /// The twelve blocks in wire order.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = DataBlock<'a>> + Clone + use<'a> {
        self.blocks.iter().map(DataBlock)
    }

    /// Start of the first firing of the first block in microseconds past the hour: 0 to
    /// 3,599,999,999 by the manual; some devices run past it for a while.
    #[must_use]
    pub const fn timestamp_us(&self) -> u32 {
        let [a, b, c, d, _, _] = *self.tail;
        u32::from_le_bytes([a, b, c, d])
    }

    /// The return mode byte.
    #[must_use]
    pub const fn return_mode(&self) -> ReturnMode {
        ReturnMode::from_u8(self.tail[4])
    }

    /// The product byte.
    #[must_use]
    pub const fn product(&self) -> Product {
        Product::from_u8(self.tail[5])
    }
}

impl<'a> DataBlock<'a> {
    fn is_valid(self) -> bool {
        (self.flag() == FLAG) & (self.azimuth_cdeg() <= REVOLUTION_CDEG)
    }

    const fn flag(self) -> [u8; FLAG_LEN] {
        let [a, b, ..] = *self.0;
        [a, b]
    }

    /// Azimuth at the block's first firing in hundredths of a degree, clockwise from the y axis
    /// seen from above: 0 to 36000. 36000 occurs on the wire and means 0.
    #[must_use]
    pub const fn azimuth_cdeg(self) -> u16 {
        let [_, _, lo, hi, ..] = *self.0;
        u16::from_le_bytes([lo, hi])
    }

    /// Channel `i` in wire order; `None` from 32 on.
    #[must_use]
    pub fn channel(self, i: usize) -> Option<ChannelReturn> {
        self.raw_channels()
            .get(i)
            .copied()
            .map(ChannelReturn::from_bytes)
    }

    /// The 32 channels in wire order.
    pub fn channels(self) -> impl Iterator<Item = ChannelReturn> + Clone + use<'a> {
        self.raw_channels()
            .iter()
            .copied()
            .map(ChannelReturn::from_bytes)
    }

    /// The 32 channels as on the wire, three bytes each, for [`ChannelReturn::from_bytes`].
    #[inline]
    #[must_use]
    pub fn raw_channels(self) -> &'a [[u8; CHANNEL_LEN]; CHANNELS] {
        let (_, channels) = self.0.split_at(FLAG_LEN + AZIMUTH_LEN);
        // The assertion at the top of the file proves that a block is long enough; the compiler
        // removes the default.
        channels.as_chunks().0.first_chunk().unwrap_or(&NO_CHANNELS)
    }
}

impl ChannelReturn {
    /// Reads a channel's three bytes.
    #[must_use]
    pub const fn from_bytes([lo, hi, reflectivity]: [u8; CHANNEL_LEN]) -> Self {
        Self {
            distance_raw: u16::from_le_bytes([lo, hi]),
            reflectivity,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;
    use std::string::ToString;
    use std::vec::Vec;

    use super::*;

    /// A packet written byte by byte from manual 9.3.2: block b has azimuth 100 b, channel c
    /// distance 256 b + c and reflectivity c + 1.
    fn golden() -> Vec<u8> {
        let mut bytes = Vec::new();
        for block in 0..12u8 {
            bytes.extend([0xFF, 0xEE]);
            bytes.extend((100 * u16::from(block)).to_le_bytes());
            for channel in 0..32u8 {
                bytes.extend([channel, block, channel + 1]);
            }
        }
        bytes.extend([0xD3, 0x27, 0x83, 0x40, 0x37, 0x22]); // 1082337235 us
        bytes
    }

    #[test]
    fn golden_bytes_decode_as_in_the_manual() {
        let bytes = golden();
        let packet = DataPacket::new(&bytes).unwrap();
        assert_eq!(packet.timestamp_us(), 0x4083_27D3);
        assert_eq!(packet.return_mode(), ReturnMode::Strongest);
        assert_eq!(packet.product(), Product::Vlp16);
        assert_eq!(packet.blocks().len(), 12);
        for (b, block) in packet.blocks().enumerate() {
            assert_eq!(usize::from(block.azimuth_cdeg()), 100 * b);
            assert_eq!(block.channels().count(), 32);
            for (c, channel) in block.channels().enumerate() {
                assert_eq!(usize::from(channel.distance_raw), 256 * b + c);
                assert_eq!(usize::from(channel.reflectivity), c + 1);
                assert_eq!(block.channel(c), Some(channel));
            }
            assert_eq!(block.channel(32), None);
        }
        assert!(packet.block(11).is_some() && packet.block(12).is_none());
    }

    #[test]
    fn errors_name_the_offset() {
        let mut bytes = golden();
        bytes[301] = 0xDD; // the second flag byte of an HDL-64E's lower block
        let error = DataPacket::new(&bytes).unwrap_err();
        assert_eq!(
            error.to_string(),
            "lidar data packet offset 300: expected block flag FF EE, got FF DD"
        );
        bytes[301] = 0xEE;
        bytes[302..304].copy_from_slice(&36_001u16.to_le_bytes());
        assert!(matches!(
            DataPacket::new(&bytes),
            Err(PacketError::Azimuth {
                offset: 302,
                got: 36_001,
                ..
            })
        ));
        bytes[302..304].copy_from_slice(&36_000u16.to_le_bytes());
        assert!(DataPacket::new(&bytes).is_ok());
        assert!(matches!(
            DataPacket::new(&bytes[1..]),
            Err(PacketError::Length { got: 1205, .. })
        ));
    }

    #[test]
    fn factory_bytes_round_trip() {
        for byte in 0..=255 {
            assert_eq!(ReturnMode::from_u8(byte).to_u8(), byte);
            assert_eq!(Product::from_u8(byte).to_u8(), byte);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn arbitrary_lengths_do_not_panic(bytes in prop::collection::vec(any::<u8>(), 0..1300)) {
            let valid = DataPacket::new(&bytes).is_ok();
            prop_assert!(!valid || bytes.len() == DATA_LEN);
        }

        #[test]
        fn a_flipped_bit_is_read_or_rejected(at in 0..DATA_LEN * 8) {
            let mut bytes = golden();
            bytes[at / 8] ^= 1 << (at % 8);
            let in_flag = (at / 8) < 1200 && (at / 8) % 100 < 2;
            match DataPacket::new(&bytes) {
                Ok(packet) => {
                    prop_assert!(!in_flag);
                    prop_assert_eq!(packet.blocks().flat_map(DataBlock::channels).count(), 384);
                }
                Err(error) => prop_assert!(
                    in_flag || matches!(error, PacketError::Azimuth { .. }), "{}", error
                ),
            }
        }
    }
}
