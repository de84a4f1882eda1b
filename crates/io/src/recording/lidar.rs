//! Classification of datagrams by content, since ports and addresses are configurable.
//!
//! The check is shallow: the decoder interprets packets and reports what is wrong with damaged
//! ones.

use protocol::vlp16::{BLOCK_LEN, BLOCKS, DATA_LEN, POSITION_LEN};

/// A block's flag (VLP-16 user manual 63-9243, 9.3.2).
const FLAG: [u8; 2] = [0xFF, 0xEE];
/// Number of flags that make 1206 bytes a damaged lidar packet; a single one may occur by chance.
const FLAGS_OF_A_LIDAR: usize = 2;
/// Offset of the pulse-per-second state, 0 to 3 (manual 9.3.3).
const PPS_AT: usize = 202;
/// Offset of the NMEA sentence.
const NMEA_AT: usize = 206;

/// Kind of a UDP payload, by its content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DatagramKind {
    /// A data packet: 1206 bytes, `FF EE` before each of the twelve blocks.
    Data,
    /// A position packet: 512 bytes, a known PPS state, and an NMEA sentence or none at its offset.
    Position,
    /// A lidar packet that violates the manual: another length after `FF EE`, or wrong flags (a
    /// damaged packet, or a larger model).
    Damaged,
    /// Other traffic on the network.
    Foreign,
}

impl DatagramKind {
    /// Classifies a UDP payload.
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

    /// Whether a lidar sent it.
    #[must_use]
    pub fn is_lidar(self) -> bool {
        self != Self::Foreign
    }
}

/// Whether 512 bytes can be a position packet. Its reserved bytes may hold anything: real sensors
/// fill them.
fn position(payload: &[u8]) -> bool {
    let pps = payload.get(PPS_AT).is_some_and(|&state| state <= 3);
    let nmea = payload.get(NMEA_AT);
    pps && nmea.is_some_and(|first| matches!(first, 0 | b'$' | b'!' | b'\r' | b'\n'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn payloads_are_classified_by_content() {
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
