//! The sensors of a recording or socket, distinguished by source address and by the port of their
//! data packets (a relay or simulator sends for several sensors).
//!
//! A position packet belongs to all sensors of its source address.

use std::net::{IpAddr, Ipv4Addr};

use protocol::record::{Record, Wire};
use units::{Host, Stamp};

use super::DatagramKind;

/// Limit of sensors, which bounds memory.
const MAX_SENSORS: usize = 256;

/// One sensor.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Sensor {
    /// Source address of its records; a hash for an IPv6 address.
    pub source: [u8; 4],
    /// UDP port of its data packets; `None` if only position packets were seen.
    pub data_port: Option<u16>,
    /// Data packets.
    pub data: u64,
    /// Damaged packets to the data port.
    pub damaged: u64,
    /// Position packets from this address.
    pub position: u64,
    /// Host time of the first packet.
    pub first: Stamp<Host>,
    /// Host time of the last packet, in order of arrival.
    pub last: Stamp<Host>,
}

/// Counts records by sensor.
#[derive(Clone, Debug, Default)]
pub struct Sensors {
    /// In order of appearance; `data_port` is `None` for position packets.
    seen: Vec<Sensor>,
    /// Index of the last record's sensor: packets of one sensor arrive in a row.
    last: usize,
    more: u64,
}

impl Sensors {
    /// Counts a record; returns whether it is a lidar's.
    pub fn observe(&mut self, record: &Record<'_>) -> bool {
        let Wire::Lidar {
            source,
            port,
            payload,
        } = record.wire
        else {
            return false;
        };
        let kind = DatagramKind::of(payload);
        let data_port = match kind {
            DatagramKind::Data | DatagramKind::Damaged => Some(port),
            DatagramKind::Position => None,
            DatagramKind::Foreign => return false,
        };
        let Some(sensor) = self.entry(source, data_port, record.host) else {
            self.more += 1;
            return true;
        };
        sensor.last = record.host;
        match kind {
            DatagramKind::Data => sensor.data += 1,
            DatagramKind::Damaged => sensor.damaged += 1,
            _ => sensor.position += 1,
        }
        true
    }

    fn entry(
        &mut self,
        source: [u8; 4],
        data_port: Option<u16>,
        host: Stamp<Host>,
    ) -> Option<&mut Sensor> {
        let same = |sensor: &Sensor| sensor.source == source && sensor.data_port == data_port;
        if !self.seen.get(self.last).is_some_and(same) {
            self.last = match self.seen.iter().position(same) {
                Some(at) => at,
                None if self.seen.len() >= MAX_SENSORS => return None,
                None => {
                    self.seen.push(Sensor {
                        source,
                        data_port,
                        data: 0,
                        damaged: 0,
                        position: 0,
                        first: host,
                        last: host,
                    });
                    self.seen.len() - 1
                }
            };
        }
        self.seen.get_mut(self.last)
    }

    /// The sensors so far, in order of source and port.
    #[must_use]
    pub fn list(&self) -> Vec<Sensor> {
        let (mut list, positions): (Vec<Sensor>, Vec<Sensor>) = self
            .seen
            .iter()
            .cloned()
            .partition(|s| s.data_port.is_some());
        for lone in positions {
            let mut found = false;
            for sensor in list.iter_mut().filter(|s| s.source == lone.source) {
                sensor.position += lone.position;
                sensor.first = sensor.first.min(lone.first);
                sensor.last = sensor.last.max(lone.last);
                found = true;
            }
            if !found {
                list.push(lone);
            }
        }
        list.sort_by_key(|sensor| (sensor.source, sensor.data_port));
        list
    }

    /// Packets of lidars beyond the limit of 256.
    #[must_use]
    pub fn more(&self) -> u64 {
        self.more
    }
}

/// The source of a record for an address.
///
/// Lidars of this family use IPv4. A mapped IPv6 address (`::ffff:a.b.c.d`) gives its IPv4 address.
/// Other IPv6 addresses, of relays, give 28 bits of their FNV-1a hash within 240.0.0.0/4, which RFC
/// 1112 reserves.
pub(super) fn source_of(address: IpAddr) -> [u8; 4] {
    let v6 = match address {
        IpAddr::V4(v4) => return v4.octets(),
        IpAddr::V6(v6) => v6,
    };
    match v6.to_ipv4_mapped() {
        Some(v4) => v4.octets(),
        None => {
            let hash = v6.octets().iter().fold(0x811C_9DC5_u32, |hash, &byte| {
                (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
            });
            Ipv4Addr::from_bits(0xF000_0000 | (hash >> 4)).octets()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn data() -> Vec<u8> {
        let mut data = vec![0; 1206];
        for block in data.chunks_exact_mut(100) {
            block[..2].copy_from_slice(&[0xFF, 0xEE]);
        }
        data
    }

    fn observe(sensors: &mut Sensors, ns: i64, source: [u8; 4], port: u16, payload: &[u8]) {
        sensors.observe(&Record {
            host: Stamp::from_nanos(ns),
            wire: Wire::Lidar {
                source,
                port,
                payload,
            },
        });
    }

    #[test]
    fn sensors_are_distinguished_by_source_and_data_port() {
        let (a, b, c) = ([10, 0, 0, 1], [10, 0, 0, 2], [10, 0, 0, 3]);
        let data = data();
        let mut sensors = Sensors::default();
        observe(&mut sensors, 1, b, 8308, &[0; 512]); // before its first data packet
        observe(&mut sensors, 2, a, 2368, &data);
        observe(&mut sensors, 3, b, 2368, &data);
        observe(&mut sensors, 4, b, 2369, &data);
        observe(&mut sensors, 5, c, 8308, &[0; 512]);
        observe(&mut sensors, 6, a, 2368, &data[..900]);
        observe(&mut sensors, 7, a, 53, b"who is");
        let sensor = |source, data_port, [data, damaged, position]: [u64; 3], first, last| Sensor {
            source,
            data_port,
            data,
            damaged,
            position,
            first: Stamp::from_nanos(first),
            last: Stamp::from_nanos(last),
        };
        let list = sensors.list();
        assert_eq!(
            list,
            [
                sensor(a, Some(2368), [1, 1, 0], 2, 6),
                sensor(b, Some(2368), [1, 0, 1], 1, 3),
                sensor(b, Some(2369), [1, 0, 1], 1, 4),
                sensor(c, None, [0, 0, 1], 5, 5),
            ]
        );
    }

    #[test]
    fn the_number_of_sensors_is_bounded() {
        let mut sensors = Sensors::default();
        for n in 0..1000_u16 {
            let [hi, lo] = n.to_be_bytes();
            observe(&mut sensors, 0, [10, 0, hi, lo], 8308, &[0; 512]);
        }
        assert_eq!(sensors.list().len(), MAX_SENSORS);
        assert_eq!(sensors.more(), 1000 - 256);
    }

    #[test]
    fn ipv6_sources_are_reserved_addresses() {
        let of = |text: &str| source_of(text.parse().unwrap());
        assert_eq!(of("192.168.1.201"), [192, 168, 1, 201]);
        assert_eq!(of("::ffff:192.168.1.201"), [192, 168, 1, 201]);
        let sources = ["fe80::1", "fe80::2", "2001:db8::1", "::"].map(of);
        for (n, source) in sources.iter().enumerate() {
            assert_eq!(source[0] >> 4, 15, "class E");
            assert!(!sources[..n].contains(source));
        }
    }
}
