//! The output stage of the VLP-16 family: returns and azimuths in, UDP payloads out.
//!
//! Written from the manual (63-9243, "Data Packet Structure" and "Position Packet Structure")
//! without the decoder of the `protocol` crate, so that their agreement is evidence. Integer
//! arithmetic only. The caller models optics and rotation.

mod builder;
mod model;
mod position;

pub use builder::DataPacketBuilder;
pub use model::{PacketModel, firing_blocks};
pub use position::position_packet;
pub use protocol::vlp16::{Pps, ReturnMode};

/// Bytes of a data packet's UDP payload.
pub const DATA_LEN: usize = BLOCKS * BLOCK_LEN + 6;
/// Bytes of a position packet's UDP payload.
pub const POSITION_LEN: usize = 512;
/// UDP port that data packets are sent to unless configured otherwise.
pub const DATA_PORT: u16 = 2368;
/// UDP port that position packets are sent to unless configured otherwise.
pub const POSITION_PORT: u16 = 8308;

/// Lasers of a VLP-16.
pub const LASERS: usize = 16;
/// Data blocks of a data packet.
pub const BLOCKS: usize = 12;

/// Nanoseconds from one firing sequence to the next.
pub const SEQUENCE_PERIOD_NS: i64 = 55_296;

/// Millimetres in one unit of distance.
pub const DISTANCE_UNIT_MM: u32 = 2;
/// Hundredths of a degree in a revolution: azimuths are below this.
pub const TURN_CDEG: u16 = 36_000;
/// Microseconds of an hour: timestamps are below this.
pub const HOUR_US: u32 = 3_600_000_000;

/// Bytes of a block: flag, azimuth, 32 channels.
const BLOCK_LEN: usize = HEADER_LEN + 2 * LASERS * CHANNEL_LEN;
/// Bytes of a flag and an azimuth.
const HEADER_LEN: usize = 4;
/// Bytes of a channel: distance and reflectivity.
const CHANNEL_LEN: usize = 3;
/// First bytes of each block.
const FLAG: [u8; 2] = [0xFF, 0xEE];

const _: () = assert!(DATA_LEN == 1_206);

/// Copies `bytes` to offset `at`, up to the end of `to`.
fn put(to: &mut [u8], at: usize, bytes: &[u8]) {
    for (to, from) in to.iter_mut().skip(at).zip(bytes) {
        *to = *from;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuths_and_timestamps_match_the_manual() {
        // 63-9243, "Firing sequence timing": 24 sequences of 55.296 us fill a packet in 1327.104
        // us, 754 packets per second.
        let packet_ns = PacketModel::Vlp16.packet_period_ns(ReturnMode::Strongest);
        assert_eq!(24 * 55_296, packet_ns);
        assert_eq!(16 * 2_304 + 18_432, SEQUENCE_PERIOD_NS);
        assert_eq!((1_000_000_000 + packet_ns / 2) / packet_ns, 754);
        // "approximately 300,000 points per second".
        assert_eq!(LASERS as i64 * 1_000_000_000 / SEQUENCE_PERIOD_NS, 289_351);
    }

    #[test]
    fn writing_past_the_end_writes_nothing() {
        let mut bytes = [7; 3];
        put(&mut bytes, 2, &[1, 2]);
        put(&mut bytes, 9, &[1]);
        assert_eq!(bytes, [7, 7, 1]);
    }
}
