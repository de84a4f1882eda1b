//! Whose datagram is it: told by what is in it, since ports and addresses are whatever somebody has
//! set.
//!
//! Deliberately shallow: what the packet says is the decoder's matter, and so is what exactly is
//! wrong with a damaged one.

use protocol::vlp16::{BLOCK_LEN, BLOCKS, DATA_LEN, POSITION_LEN};

/// A block's flag (VLP-16 user manual 63-9243, 9.3.2).
const FLAG: [u8; 2] = [0xFF, 0xEE];
/// Flags that make 1206 bytes a lidar's packet though others are wrong: one may stand in anybody's
/// packet by chance.
const FLAGS_OF_A_LIDAR: usize = 2;
/// State of the pulse-per-second input, 0 to 3 (manual 9.3.3).
const PPS_AT: usize = 202;
/// Where the NMEA sentence begins.
const NMEA_AT: usize = 206;

/// What a UDP payload is, judged by its content alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DatagramKind {
    /// A data packet: 1206 bytes, `FF EE` in front of all twelve blocks.
    Data,
    /// A position packet: 512 bytes, a known PPS state, a sentence or none where one belongs.
    Position,
    /// A lidar's, but not as the manual has it: another length behind `FF EE`, some flags wrong (a
    /// damaged packet, or a larger model). For the decoder to say what is wrong.
    Damaged,
    /// Something else that shared the wire.
    Foreign,
}

impl DatagramKind {
    /// Judges a UDP payload.
    #[must_use]
    pub fn of(payload: &[u8]) -> Self {
        match payload.len() {
            DATA_LEN => {
                let starts = payload.chunks_exact(BLOCK_LEN).take(BLOCKS);
                match starts.filter(|block| block.starts_with(&FLAG)).count() {
                    BLOCKS => Self::Data,
                    FLAGS_OF_A_LIDAR.. => Self::Damaged,
                    _ => Self::Foreign,
                }
            }
            POSITION_LEN if position(payload) => Self::Position,
            _ if payload.starts_with(&FLAG) => Self::Damaged,
            _ => Self::Foreign,
        }
    }

    /// Whether it came from a lidar.
    #[must_use]
    pub fn is_lidar(self) -> bool {
        self != Self::Foreign
    }
}

/// 512 bytes that can be a position packet: the rest is not promised to be zero, and real sensors
/// do fill it.
fn position(payload: &[u8]) -> bool {
    let pps = payload.get(PPS_AT).is_some_and(|&state| state <= 3);
    let nmea = payload.get(NMEA_AT);
    pps && nmea.is_some_and(|first| matches!(first, 0 | b'$' | b'!' | b'\r' | b'\n'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_decides() {
        let mut data = vec![0; 1206];
        for block in data.chunks_exact_mut(100) {
            block[..2].copy_from_slice(&[0xFF, 0xEE]);
        }
        assert_eq!(DatagramKind::of(&data), DatagramKind::Data);
        data[1100] = 0;
        assert_eq!(DatagramKind::of(&data), DatagramKind::Damaged);
        assert_eq!(DatagramKind::of(&data[..700]), DatagramKind::Damaged);
        for at in (200..1200).step_by(100) {
            data[at] = 0;
        }
        assert_eq!(DatagramKind::of(&data), DatagramKind::Damaged, "two flags");
        data[0] = 0;
        assert_eq!(DatagramKind::of(&data), DatagramKind::Foreign, "one");

        let mut position = vec![0; 512];
        assert_eq!(DatagramKind::of(&position), DatagramKind::Position);
        position[206] = b'$';
        position[202] = 3;
        assert_eq!(DatagramKind::of(&position), DatagramKind::Position);
        position[202] = 4;
        assert_eq!(DatagramKind::of(&position), DatagramKind::Foreign);
        position[202] = 0;
        position[206] = b'x';
        assert_eq!(DatagramKind::of(&position), DatagramKind::Foreign);
        assert_eq!(DatagramKind::of(&[]), DatagramKind::Foreign);
        assert_eq!(DatagramKind::of(&[0xFF]), DatagramKind::Foreign);
    }
}
