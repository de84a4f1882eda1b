//! Position packets: the sensor's clock, the state of its PPS input, and the last NMEA sentence.
//!
//! All other bytes are reserved; sensors send zeros.

use protocol::vlp16::Pps;

use super::{HOUR_US, POSITION_LEN, put};

/// Offset of the timestamp, u32 little-endian, microseconds past the hour.
const TIMESTAMP_AT: usize = 198;
/// Offset of the PPS status.
const PPS_AT: usize = 202;
/// Offset of the NMEA sentence.
const NMEA_AT: usize = 206;
/// Space for the NMEA sentence with CR LF.
const NMEA_LEN: usize = 128;

const _: () = {
    assert!(PPS_AT == TIMESTAMP_AT + 4);
    assert!(NMEA_AT + NMEA_LEN <= POSITION_LEN);
};

/// The UDP payload of a position packet sent at `timestamp_us` past the hour (modulo an hour).
///
/// `nmea` is the `$GPRMC` sentence with CR LF, or empty; it is cut at 128 bytes.
#[must_use]
pub fn position_packet(timestamp_us: u32, pps: Pps, nmea: &[u8]) -> [u8; POSITION_LEN] {
    let mut bytes = [0; POSITION_LEN];
    put(
        &mut bytes,
        TIMESTAMP_AT,
        &(timestamp_us % HOUR_US).to_le_bytes(),
    );
    put(&mut bytes, PPS_AT, &[pps.to_u8()]);
    put(&mut bytes, NMEA_AT, nmea.get(..NMEA_LEN).unwrap_or(nmea));
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn position_packets_match_golden_bytes() {
        let packet = position_packet(0x4083_3A71, Pps::Locked, b"$GPRMC,081802.00\r\n");
        assert_eq!(packet[198..206], [0x71, 0x3A, 0x83, 0x40, 2, 0, 0, 0]);
        assert_eq!(&packet[206..224], b"$GPRMC,081802.00\r\n");
        assert!(packet[..198].iter().all(|&byte| byte == 0));
        assert!(packet[224..].iter().all(|&byte| byte == 0));
    }

    #[test]
    fn without_a_receiver_all_but_the_stamp_is_zero() {
        let packet = position_packet(HOUR_US + 1, Pps::Absent, b"");
        assert_eq!(packet[198], 1);
        assert_eq!(packet.iter().filter(|&&byte| byte != 0).count(), 1);
    }

    #[test]
    fn an_overlong_sentence_is_truncated() {
        let packet = position_packet(0, Pps::Error, &[b'x'; 400]);
        assert_eq!(packet[202], 3);
        assert_eq!(
            packet.iter().filter(|&&byte| byte == b'x').count(),
            NMEA_LEN
        );
        assert_eq!(packet[206 + NMEA_LEN], 0);
    }
}
