//! velomotion's logs, and the same datagrams in the other readable formats.

use firmware_sim::vlp16::{DataPacketBuilder, PacketModel, Pps, ReturnMode, position_packet};
use io::log::{LogConfig, LogWriter};
use protocol::canopen::NodeId;
use protocol::canopen::sdo::SdoRequest;
use protocol::epos2::message::ReadObject;
use protocol::epos2::{objects, rs232, usb};
use protocol::record::{Direction, DriveLink, Record, Wire};
use units::Stamp;

use crate::Seed;

const START_NS: i64 = 1_795_000_000_000_000_000;
const SOURCE: [u8; 4] = [192, 168, 1, 201];

pub fn seeds() -> Vec<Seed> {
    let mut seeds = Vec::new();
    let links = [
        ("usb", DriveLink::Usb),
        ("rs232", DriveLink::Rs232),
        ("can", DriveLink::Can),
    ];
    for (name, link) in links {
        let whole = log(link, &[2368, 8308]);
        seeds.push((
            format!("log-{name}-cut"),
            whole[..whole.len() - 30].to_vec(),
        ));
        seeds.push((format!("log-{name}"), whole));
        seeds.push((format!("log-{name}-short"), log(link, &[])));
    }
    // Small payloads leave more of an input to headers.
    let packet = ip(2368, b"\xFF\xEEfiring!");
    let ethernet = [&[0xFF; 6][..], &[2; 6], &[8, 0], &packet].concat();
    let tagged = [&[0xFF; 6][..], &[2; 6], &[0x81, 0, 0, 5, 8, 0], &packet].concat();
    let cooked = [
        &[0, 0, 0, 1, 0, 6, 1, 2, 3, 4, 5, 6, 0, 0, 8, 0][..],
        &packet,
    ]
    .concat();
    for (name, link, data) in [
        ("ethernet", 1, &ethernet),
        ("tagged", 1, &tagged),
        ("cooked", 113, &cooked),
        ("ip", 101, &packet),
        ("loopback", 0, &[&[2, 0, 0, 0][..], &packet].concat()),
        (
            "can",
            227,
            &[0, 0, 6, 1, 8, 0, 0, 0, 0x40, 0x41, 0x60, 0, 0, 0, 0, 0].to_vec(),
        ),
    ] {
        let twice = [data.clone(), data.clone()];
        for (order, magic) in [("us", 0xA1B2_C3D4_u32), ("ns", 0xA1B2_3C4D)] {
            seeds.push((
                format!("pcap-{name}-{order}"),
                pcap(magic, link, &twice, false),
            ));
            seeds.push((
                format!("pcap-{name}-{order}-big"),
                pcap(magic, link, &twice, true),
            ));
        }
    }
    // The same datagram in two fragments, in both orders.
    let (first, last) = packet.split_at(28);
    let fragment = |flags: u16, payload: &[u8]| {
        let mut fragment = [&packet[..20], payload].concat();
        let length = fragment.len() as u16;
        fragment[2..4].copy_from_slice(&length.to_be_bytes());
        fragment[6..8].copy_from_slice(&flags.to_be_bytes());
        fragment
    };
    let fragments = [fragment(0x2000, &first[20..]), fragment(1, last)];
    let file = pcap(0xA1B2_C3D4, 101, &fragments, false);
    seeds.push(("fragments".to_owned(), file));
    let [first, last] = fragments;
    let file = pcap(0xA1B2_C3D4, 101, &[last, first], false);
    seeds.push(("fragments-late".to_owned(), file));
    // Damage between valid blocks, and an old capture in the other byte order.
    let mut damaged = log(DriveLink::Usb, &[2368]);
    let at = damaged.len() / 3;
    damaged[at..at + 40].fill(0x5A);
    seeds.push(("log-damaged".to_owned(), damaged));
    seeds
}

/// A log of one exchange with the drive and one datagram to each port.
fn log(link: DriveLink, ports: &[u16]) -> Vec<u8> {
    let config = LogConfig {
        metadata: "device = \"sim\"\n".to_owned(),
        drive: Some(link),
    };
    let mut file = Vec::new();
    let mut writer = LogWriter::new(&mut file, &config).expect("memory takes it");
    let address = objects::POSITION_ACTUAL.address;
    let read = ReadObject { node: 1, address }.to_frame();
    let frame = match link {
        DriveLink::Usb => usb::to_bytes(&read).as_slice().to_vec(),
        DriveLink::Rs232 => {
            let mut body = Vec::new();
            rs232::encode_body(&read, &mut body).expect("a request has words");
            body
        }
        DriveLink::Can => {
            let request = SdoRequest::InitiateUpload { address };
            request.to_frame(NodeId::MAX).to_socketcan().to_vec()
        }
    };
    let mut wires = vec![
        Wire::Drive {
            link,
            direction: Direction::ToDrive,
            frame: &frame,
        },
        Wire::Drive {
            link,
            direction: Direction::FromDrive,
            frame: &frame,
        },
    ];
    let data = DataPacketBuilder::new(PacketModel::Vlp16, ReturnMode::Strongest).finish(5);
    let position = position_packet(5, Pps::Absent, b"");
    for &port in ports {
        let payload = if port == 2368 {
            &data[..]
        } else {
            &position[..]
        };
        wires.push(Wire::Lidar {
            source: SOURCE,
            port,
            payload,
        });
    }
    for (n, wire) in (0..).zip(wires) {
        let host = Stamp::from_nanos(START_NS + 1_000_000 * n);
        writer
            .write(&Record { host, wire })
            .expect("memory takes it");
    }
    writer.finish().expect("memory takes it");
    file
}

fn ip(port: u16, payload: &[u8]) -> Vec<u8> {
    let udp_len = payload.len() as u16 + 8;
    let mut packet = vec![0x45, 0];
    packet.extend((udp_len + 20).to_be_bytes());
    packet.extend([0, 0, 0x40, 0, 64, 17, 0, 0]);
    packet.extend(SOURCE);
    packet.extend([255; 4]);
    packet.extend(port.to_be_bytes());
    packet.extend(port.to_be_bytes());
    packet.extend(udp_len.to_be_bytes());
    packet.extend([0, 0]);
    packet.extend(payload);
    packet
}

/// A pcap file of two records.
fn pcap(magic: u32, link: u32, records: &[Vec<u8>; 2], big_endian: bool) -> Vec<u8> {
    let word = |value: u32| {
        if big_endian {
            value.to_be_bytes()
        } else {
            value.to_le_bytes()
        }
    };
    let mut file = word(magic).to_vec();
    file.extend(if big_endian {
        [0, 2, 0, 4]
    } else {
        [2, 0, 4, 0]
    });
    for value in [0, 0, 65_535, link] {
        file.extend(word(value));
    }
    for (second, data) in (1..).zip(records) {
        let length = data.len() as u32;
        for value in [second, 872_340, length, length] {
            file.extend(word(value));
        }
        file.extend(data);
    }
    file
}
