//! Ethernet, IPv4 and UDP headers for a payload from a socket. Unknown fields are those of a
//! VLP-16's factory setting: broadcast, source port equal to the destination port.

use etherparse::{EtherType, Ethernet2Header, IpFragOffset, IpNumber, Ipv4Header, UdpHeader};

/// Longest UDP payload over IPv4: 65535 bytes less both headers.
pub(super) const MAX_PAYLOAD_LEN: usize = 65_535 - 20 - 8;

/// Velodyne's prefix, and zeros for the unknown device number.
const LIDAR_MAC: [u8; 6] = [0x60, 0x76, 0x88, 0, 0, 0];
const BROADCAST_MAC: [u8; 6] = [0xFF; 6];
const BROADCAST: [u8; 4] = [255; 4];

/// The 42 bytes in front of `payload`; `None` if it is longer than [`MAX_PAYLOAD_LEN`].
pub(super) fn headers(source: [u8; 4], port: u16, payload: &[u8]) -> Option<[u8; 42]> {
    let udp_len = u16::try_from(payload.len().checked_add(UdpHeader::LEN)?).ok()?;
    let mut ip = Ipv4Header::new(udp_len, 64, IpNumber::UDP, source, BROADCAST).ok()?;
    ip.dont_fragment = true;
    ip.fragment_offset = IpFragOffset::ZERO;
    ip.header_checksum = ip.calc_header_checksum();
    let udp = UdpHeader::with_ipv4_checksum(port, port, &ip, payload).ok()?;
    let ethernet = Ethernet2Header {
        source: LIDAR_MAC,
        destination: BROADCAST_MAC,
        ether_type: EtherType::IPV4,
    };
    let mut out = [0; 42];
    let (to_ethernet, rest) = out.split_at_mut_checked(14)?;
    let (to_ip, to_udp) = rest.split_at_mut_checked(20)?;
    to_ethernet.copy_from_slice(&ethernet.to_bytes());
    to_ip.copy_from_slice(ip.to_bytes().get(..20)?);
    to_udp.copy_from_slice(&udp.to_bytes());
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The internet checksum (RFC 1071) over big-endian words, written without etherparse.
    fn sum(bytes: &[u8]) -> u16 {
        let mut sum: u32 = bytes
            .chunks(2)
            .map(|c| u32::from(c[0]) << 8 | u32::from(*c.get(1).unwrap_or(&0)))
            .sum();
        while sum > 0xFFFF {
            sum = (sum & 0xFFFF) + (sum >> 16);
        }
        sum as u16
    }

    #[test]
    fn lengths_and_checksums_are_correct() {
        for length in [0, 1, 512, 1206, MAX_PAYLOAD_LEN] {
            let payload: Vec<u8> = (0..length).map(|i| (i * 7) as u8).collect();
            let h = headers([192, 168, 1, 201], 2368, &payload).unwrap();
            assert_eq!(h[12..14], [8, 0]);
            assert_eq!(
                u16::from_be_bytes([h[16], h[17]]) as usize,
                length + 28,
                "IPv4 total length"
            );
            assert_eq!(sum(&h[14..34]), 0xFFFF, "IPv4 header checksum");
            assert_eq!(u16::from_be_bytes([h[38], h[39]]) as usize, length + 8);
            let pseudo = [&h[26..34], &[0, 17], &h[38..40], &h[34..42], &payload].concat();
            assert_eq!(sum(&pseudo), 0xFFFF, "UDP checksum, {length} bytes");
        }
    }

    #[test]
    fn oversized_payloads_are_refused() {
        assert!(headers([0; 4], 1, &vec![0; MAX_PAYLOAD_LEN + 1]).is_none());
    }
}
