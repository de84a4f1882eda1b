//! The VLP-16's output stage: sixteen returns and an azimuth in, UDP payloads out.
//!
//! Written from the maker's manual (63-9243, "Data Packet Structure" and "Position Packet Structure") and deliberately
//! without the decoder of the `protocol` crate, so that the two agreeing says something. Integer arithmetic only.
//! Left out: the optics and the spinning head (what a laser sees, and when, is the caller's), UDP and IP headers.

mod data;
mod dual;
mod model;
mod position;

pub use data::PacketBuilder;
pub use dual::DualPacketBuilder;
pub use model::{Model, ModelPacket, ReturnMode};
pub use position::{Pps, position_packet};

/// Bytes of a data packet's UDP payload.
pub const DATA_LEN: usize = BLOCKS * BLOCK_LEN + 6;
/// Bytes of a position packet's UDP payload.
pub const POSITION_LEN: usize = 512;
/// UDP port that data packets are sent to unless configured otherwise.
pub const DATA_PORT: u16 = 2368;
/// UDP port that position packets are sent to unless configured otherwise.
pub const POSITION_PORT: u16 = 8308;

/// Lasers, and so returns of one firing sequence.
pub const LASERS: usize = 16;
/// Data blocks of a data packet.
pub const BLOCKS: usize = 12;
/// Firing sequences of a data packet in a single-return mode: two a block.
pub const SEQUENCES: usize = 2 * BLOCKS;
/// Firing sequences of a data packet in dual-return mode: blocks come in pairs that tell of the same firings.
pub const DUAL_SEQUENCES: usize = SEQUENCES / 2;

/// Nanoseconds from one laser of a sequence to the next.
pub const LASER_PERIOD_NS: i64 = 2_304;
/// Nanoseconds without firing at the end of a sequence, after the sixteenth laser's slot.
pub const RECHARGE_NS: i64 = 18_432;
/// Nanoseconds from one firing sequence to the next.
pub const SEQUENCE_PERIOD_NS: i64 = 55_296;
/// Nanoseconds from one data packet to the next in a single-return mode.
pub const PACKET_PERIOD_NS: i64 = SEQUENCES as i64 * SEQUENCE_PERIOD_NS;
/// Nanoseconds from one data packet to the next in dual-return mode.
pub const DUAL_PACKET_PERIOD_NS: i64 = DUAL_SEQUENCES as i64 * SEQUENCE_PERIOD_NS;

/// Millimetres in one unit of distance.
pub const DISTANCE_UNIT_MM: u32 = 2;
/// Hundredths of a degree in a turn of the head: azimuths are below this.
pub const TURN_CDEG: u16 = 36_000;
/// Microseconds of an hour: timestamps are below this.
pub const HOUR_US: u32 = 3_600_000_000;

/// What one firing sequence brought back, laser 0 first: distance in units of 2 mm (0 for no return) and calibrated
/// reflectivity (0..=100 diffuse, above that retroreflecting).
pub type Returns = [(u16, u8); LASERS];

/// Bytes of a block: flag, azimuth, 32 channels of three bytes.
const BLOCK_LEN: usize = 4 + 2 * HALF_LEN;
/// Bytes of the sixteen channels of one sequence.
const HALF_LEN: usize = 3 * LASERS;
/// Opens every block.
const FLAG: [u8; 2] = [0xFF, 0xEE];
/// Factory byte of the VLP-16 (and of the Puck LITE).
const PRODUCT: u8 = 0x22;

const _: () = {
    assert!(DATA_LEN == 1_206);
    assert!(LASERS as i64 * LASER_PERIOD_NS + RECHARGE_NS == SEQUENCE_PERIOD_NS);
    assert!(PACKET_PERIOD_NS == 1_327_104);
    assert!(DUAL_PACKET_PERIOD_NS == 663_552);
};

/// Twelve blocks and the factory bytes, being filled.
#[derive(Clone, Debug)]
struct Blocks {
    bytes: [u8; DATA_LEN],
}

impl Blocks {
    /// Blocks with flags, azimuth 0 and no returns.
    fn empty(return_mode: u8) -> Self {
        Self::of(return_mode, PRODUCT)
    }

    /// The same of another product.
    fn of(return_mode: u8, product: u8) -> Self {
        let mut bytes = [0; DATA_LEN];
        let (blocks, tail) = bytes.split_at_mut(BLOCKS * BLOCK_LEN);
        for block in blocks.chunks_exact_mut(BLOCK_LEN) {
            put(block, 0, &FLAG);
        }
        put(tail, 4, &[return_mode, product]);
        Self { bytes }
    }

    /// Writes the azimuth of a block, which is that of its first firing.
    fn azimuth(&mut self, block: usize, azimuth_cdeg: u16) {
        let at = block * BLOCK_LEN + FLAG.len();
        put(
            &mut self.bytes,
            at,
            &(azimuth_cdeg % TURN_CDEG).to_le_bytes(),
        );
    }

    /// Writes the first (0) or second (1) sequence of a block.
    fn returns(&mut self, block: usize, half: usize, returns: &Returns) {
        self.channels(block, half * LASERS, returns);
    }

    /// Writes channels of a block from `first` on; what does not fit is not written.
    fn channels(&mut self, block: usize, first: usize, returns: &[(u16, u8)]) {
        let (from, to) = (block * BLOCK_LEN + 4 + 3 * first, (block + 1) * BLOCK_LEN);
        let channels = self.bytes.get_mut(from..to).unwrap_or_default();
        for (channel, &(distance, reflectivity)) in channels.chunks_exact_mut(3).zip(returns) {
            let [low, high] = distance.to_le_bytes();
            channel.copy_from_slice(&[low, high, reflectivity]);
        }
    }

    /// The packet whose first firing was at `timestamp_us` past the hour.
    fn finish(mut self, timestamp_us: u32) -> [u8; DATA_LEN] {
        let stamp = (timestamp_us % HOUR_US).to_le_bytes();
        put(&mut self.bytes, BLOCKS * BLOCK_LEN, &stamp);
        self.bytes
    }
}

/// Copies `bytes` to offset `at`; what does not fit is not written.
fn put(to: &mut [u8], at: usize, bytes: &[u8]) {
    for (to, from) in to.iter_mut().skip(at).zip(bytes) {
        *to = *from;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_manuals_arithmetic() {
        // 63-9243, "Firing sequence timing": 24 sequences of 55.296 us fill a packet in 1327.104 us, 754 packets a second.
        assert_eq!(24 * 55_296, PACKET_PERIOD_NS);
        assert_eq!(16 * 2_304 + 18_432, 55_296);
        assert_eq!(
            (1_000_000_000 + PACKET_PERIOD_NS / 2) / PACKET_PERIOD_NS,
            754
        );
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
