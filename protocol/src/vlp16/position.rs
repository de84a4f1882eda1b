//! The position packet: the sensor's own time, the state of its PPS input and the last NMEA
//! sentence (manual 9.3.3).
//!
//! Of the sentence, time, date and validity are read ([`Rmc`]); position and motion of the receiver
//! and the inertial data of an HDL-32E (first 198 bytes) are not.

use super::{NmeaError, PacketError, Rmc};
use crate::codes::byte_codes;

/// Length of a position packet's UDP payload in bytes.
pub const POSITION_LEN: usize = 512;

const LAYER: &str = "lidar position packet";
const TIMESTAMP_AT: usize = 198;
const PPS_AT: usize = 202;
pub(super) const NMEA_AT: usize = 206;

// Manual table 9-3: timestamp, PPS status and three reserved bytes precede the sentence.
const _: () = assert!(TIMESTAMP_AT + 4 == PPS_AT && PPS_AT + 1 + 3 == NMEA_AT);

/// A view of a position packet's payload of the right length.
#[derive(Clone, Copy, Debug)]
pub struct PositionPacket<'a> {
    status: &'a [u8; NMEA_AT - TIMESTAMP_AT],
    sentence: &'a [u8],
}

byte_codes! {
    /// State of the pulse-per-second input.
    pub enum Pps {
        /// No pulse; the clock runs free.
        Absent = 0,
        /// Pulses detected, not yet locked.
        Synchronising = 1,
        /// The clock follows the pulse.
        Locked = 2,
        /// The pulse is in error.
        Error = 3,
    }
}

impl<'a> PositionPacket<'a> {
    /// Checks the length. Unused bytes are not always zero, so nothing else can be checked.
    ///
    /// # Errors
    /// [`PacketError::Length`].
    pub fn new(payload: &'a [u8]) -> Result<Self, PacketError> {
        Self::view(payload).ok_or(PacketError::Length {
            layer: LAYER,
            expected: POSITION_LEN,
            got: payload.len(),
        })
    }

    fn view(payload: &'a [u8]) -> Option<Self> {
        let payload: &[u8; POSITION_LEN] = payload.try_into().ok()?;
        let (_, rest) = payload.split_at_checked(TIMESTAMP_AT)?;
        let (status, sentence) = rest.split_first_chunk()?;
        Some(Self { status, sentence })
    }

    /// Time at which the packet was assembled: microseconds past the hour. It may be out of order
    /// with data packets.
    #[must_use]
    pub const fn timestamp_us(&self) -> u32 {
        let [a, b, c, d, ..] = *self.status;
        u32::from_le_bytes([a, b, c, d])
    }

    /// State of the PPS input.
    #[must_use]
    pub const fn pps(&self) -> Pps {
        Pps::from_u8(self.status[PPS_AT - TIMESTAMP_AT])
    }

    /// The NMEA sentence without its line end; empty without a receiver. It may contain any bytes.
    #[must_use]
    pub fn nmea(&self) -> &'a [u8] {
        self.sentence
            .split(|&byte| matches!(byte, b'\r' | b'\n' | 0))
            .next()
            .unwrap_or_default()
    }

    /// Time and validity in the sentence.
    ///
    /// # Errors
    /// [`NmeaError`], with offsets into the payload.
    pub fn rmc(&self) -> Result<Rmc, NmeaError> {
        Rmc::parse(self.nmea())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;
    use std::vec;

    use super::*;

    #[test]
    fn golden_bytes_match_the_manual() {
        let mut bytes = [0u8; POSITION_LEN];
        bytes[198..202].copy_from_slice(&[0x01, 0x02, 0x03, 0x04]);
        bytes[202] = 2;
        let sentence = b"$GPRMC,083124,A,3650.4,N,00228.1,W,0.0,0.0,210116,1.1,W*63";
        bytes[206..206 + sentence.len()].copy_from_slice(sentence);
        bytes[206 + sentence.len()..][..2].copy_from_slice(b"\r\n");
        let packet = PositionPacket::new(&bytes).unwrap();
        assert_eq!(packet.timestamp_us(), 0x0403_0201);
        assert_eq!(packet.pps(), Pps::Locked);
        assert_eq!(packet.nmea(), sentence);
    }

    #[test]
    fn without_a_receiver_there_is_no_sentence() {
        let packet = PositionPacket::new(&[0; POSITION_LEN]).unwrap();
        assert_eq!((packet.pps(), packet.nmea()), (Pps::Absent, &b""[..]));
    }

    #[test]
    fn a_sentence_that_fills_the_packet_ends_with_it() {
        let bytes = [b'A'; POSITION_LEN];
        let packet = PositionPacket::new(&bytes).unwrap();
        assert_eq!(packet.nmea().len(), 306);
        assert_eq!(packet.pps(), Pps::Unknown(b'A'));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn arbitrary_payload_lengths_do_not_panic(len in 0usize..1300, byte: u8) {
            let bytes = vec![byte; len];
            match PositionPacket::new(&bytes) {
                Ok(packet) => prop_assert!(len == 512 && packet.nmea().len() <= 306),
                Err(error) => prop_assert_eq!(error, PacketError::Length {
                    layer: LAYER, expected: 512, got: len,
                }),
            }
        }
    }
}
