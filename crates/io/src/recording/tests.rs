use super::*;
use protocol::vlp16::DATA_LEN;

mod cuts;
mod damage;
mod dialects;
mod encoded;

use crate::files::Overwrite;
use encoded::*;

use crate::log::{LogConfig, LogWriter, OwnedRecord};

const SOURCE: [u8; 4] = [192, 168, 1, 201];

#[test]
fn pcap_is_read_in_both_resolutions_and_byte_orders() {
    let data = ethernet(&[], &ip(2368, b"firing"));
    for big_endian in [false, true] {
        for (magic, nanoseconds) in [(0xA1B2_C3D4, false), (0xA1B2_3C4D, true)] {
            let file = pcap(
                magic,
                big_endian,
                1,
                &[(1_599_213_599, 872_340, None, &data)],
            );
            let fraction = if nanoseconds { 872_340 } else { 872_340_000 };
            let (records, end, counts) = read(&file);
            let ns = 1_599_213_599_000_000_000 + fraction;
            assert_eq!(records, [datagram(ns, 2368, b"firing")]);
            assert_eq!(end, End::Complete);
            assert_eq!(counts.other, 1);
        }
    }
}

#[test]
fn all_link_headers_are_supported() {
    let ip = ip(8308, b"$GPRMC");
    let tag = [0x81, 0x00, 0x00, 0x05];
    let double_tag = [0x88, 0xA8, 0, 7, 0x81, 0x00, 0x00, 0x05];
    let cooked1 = [&[0, 0, 0, 1, 0, 6, 1, 2, 3, 4, 5, 6, 0, 0, 8, 0][..], &ip].concat();
    let cooked2 = [&[8, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 6][..], &[0; 8], &ip].concat();
    for (link, data) in [
        (1, ethernet(&[], &ip)),
        (1, [ethernet(&[], &ip), vec![0; 10]].concat()), // padding or check sequence
        (1, ethernet(&tag, &ip)),
        (1, ethernet(&double_tag, &ip)),
        (113, cooked1),
        (276, cooked2),
        (101, ip.clone()),
        (228, ip.clone()),
        (1 | 0x2400_0000, ethernet(&[], &ip)), // with the length of the check sequence in its field
    ] {
        let (records, end, counts) = read(&pcap(0xA1B2_C3D4, false, link, &[(1, 0, None, &data)]));
        assert_eq!(
            records,
            [datagram(1_000_000_000, 8308, b"$GPRMC")],
            "link {link}: {counts:?}"
        );
        assert_eq!(end, End::Complete);
    }
}

#[test]
fn other_packets_are_counted_by_kind() {
    let good = ethernet(&[], &ip(2368, b"good"));
    let arp = {
        let mut frame = ethernet(&[], &[0; 28]);
        frame[12..14].copy_from_slice(&[8, 6]);
        frame[14..22].copy_from_slice(&[0, 1, 8, 0, 6, 4, 0, 1]);
        frame
    };
    let mut first_fragment = ethernet(&[], &ip(2368, b"part"));
    first_fragment[20] = 0x20; // more fragments
    let mut last_fragment = ethernet(&[], &ip(2368, b"part"));
    last_fragment[20..22].copy_from_slice(&[0, 9]);
    let mut lies = ethernet(&[], &ip(2368, b"lies"));
    lies[39] += 1; // UDP length exceeds the packet
    let mut lldp = good.clone();
    lldp[12..14].copy_from_slice(&[0x88, 0xCC]);
    let file = pcap(
        0xA1B2_C3D4,
        false,
        1,
        &[
            (1, 0, None, &arp),
            (2, 0, None, &first_fragment),
            (3, 0, None, &last_fragment),
            (4, 0, None, &lldp),
            (5, 0, Some(1248), &good[..44]), // truncated by a snap length
            (6, 0, None, &lies),
            (7, 0, None, &good[..20]),
            (8, 0, None, &[]),
            (9, 0, None, &good),
        ],
    );
    let (records, end, counts) = read(&file);
    assert_eq!(records, [datagram(9_000_000_000, 2368, b"good")]);
    assert_eq!(end, End::Complete);
    assert_eq!(
        (
            counts.records,
            counts.other,
            counts.fragments,
            counts.malformed
        ),
        (9, 2 + 1, 2, 4)
    );
    let first = counts.first_malformed.unwrap();
    let before: usize = [&arp, &first_fragment, &last_fragment, &lldp]
        .iter()
        .map(|data| 16 + data.len())
        .sum();
    assert_eq!(first.offset, 24 + before as u64);
    assert_eq!(first.fault.to_string(), "the capture kept 44 bytes of 1248");
    assert_eq!(counts.snapped, 1);
}

#[test]
fn errors_name_the_truncated_layer() {
    let mut lies = ethernet(&[], &ip(2368, b"lies"));
    lies[39] += 1;
    let (_, _, counts) = read(&pcap(0xA1B2_C3D4, false, 1, &[(6, 0, None, &lies)]));
    let fault = counts.first_malformed.unwrap().fault;
    assert!(
        matches!(
            &fault,
            PacketFault::Short {
                expected: 13,
                got: 12,
                ..
            }
        ),
        "{fault}"
    );
    assert!(fault.to_string().contains("UDP"), "{fault}");
}

#[test]
fn pcapng_times_are_read_in_every_resolution_and_byte_order() {
    let data = ethernet(&[], &ip(2368, b"x"));
    let second = 1_700_000_000_i64;
    for big in [false, true] {
        for (resolution, units) in [
            (None, second as u64 * 1_000_000 + 5),
            (Some(9), second as u64 * 1_000_000_000 + 5_000),
            (Some(10), second as u64 * 10_000_000_000 + 50_009), // drops 0.1 ns
            (Some(0x80 | 20), ((second as u64) << 20) + 6),      // 6 / 2^20 s = 5722.0 ns
        ] {
            let options: Vec<(u16, Vec<u8>)> = resolution.iter().map(|&r| (9, vec![r])).collect();
            let options: Vec<(u16, &[u8])> =
                options.iter().map(|(c, v)| (*c, v.as_slice())).collect();
            let file = [
                section(big),
                interface(big, 1, &options),
                packet(big, 0, units, &data, None),
            ]
            .concat();
            let expected = match resolution {
                Some(0x94) => 5_722,
                _ => 5_000,
            };
            let (records, end, _) = read(&file);
            let ns = second * 1_000_000_000 + expected;
            assert_eq!(records, [datagram(ns, 2368, b"x")], "{resolution:?} {big}");
            assert_eq!(end, End::Complete);
        }
        let offset = if big {
            100_i64.to_be_bytes()
        } else {
            100_i64.to_le_bytes()
        };
        let file = [
            section(big),
            interface(big, 1, &[(14, &offset)]),
            packet(big, 0, 7, &data, None),
        ]
        .concat();
        assert_eq!(read(&file).0, [datagram(100_000_007_000, 2368, b"x")]);
    }
}

#[test]
fn extreme_time_resolutions_do_not_wrap() {
    let data = ethernet(&[], &ip(2368, b"x"));
    for (resolution, expected) in [(0, i64::MAX), (127, 0), (0xFF, 0)] {
        let file = [
            section(false),
            interface(false, 1, &[(9, &[resolution])]),
            packet(false, 0, u64::MAX, &data, None),
        ]
        .concat();
        assert_eq!(read(&file).0, [datagram(expected, 2368, b"x")]);
    }
}

#[test]
fn pcapng_sections_reset_interfaces_and_other_blocks_are_skipped() {
    let data = ethernet(&[], &ip(2368, b"x"));
    let can = [0, 0, 6, 1, 8, 0, 0, 0, 0x40, 0x41, 0x60, 0, 0, 0, 0, 0];
    let file = [
        section(false),
        interface(false, 1, &[]),
        block(4, false, &[0; 8]), // name resolution
        packet(false, 0, 1, &data, None),
        packet(false, 1, 2, &data, None), // no such interface
        block(3, false, &[1, 0, 0, 0, 0xAA, 0, 0, 0]), // simple packet
        block(0x7777, false, &[1; 400]),  // of an unknown type
        block(6, false, &[0xFF; 40]),     // lengths exceed the block
        section(true),                    // the other byte order
        interface(true, 227, &[]),
        interface(true, 1, &[]),
        packet(true, 0, 3, &can, Some(1)),
        packet(true, 0, 4, &can, None), // by its function code: to the drive
        packet(true, 1, 5, &data, None),
    ]
    .concat();
    let (records, end, counts) = read(&file);
    assert_eq!(
        records,
        [
            datagram(1_000, 2368, b"x"),
            frame(3_000, DriveLink::Can, Direction::FromDrive, &can),
            frame(4_000, DriveLink::Can, Direction::ToDrive, &can),
            datagram(5_000, 2368, b"x"),
        ]
    );
    assert_eq!(end, End::Complete);
    assert_eq!((counts.records, counts.malformed), (7, 3));
    assert_eq!(
        counts.first_malformed.unwrap().fault,
        PacketFault::Interface {
            got: 1,
            described: 1
        }
    );
}

#[test]
fn can_recordings_in_classic_pcap_are_read() {
    let answer = [
        0, 0, 5, 0x81, 8, 0, 0, 0, 0x4B, 0x41, 0x60, 0, 0x40, 1, 0, 0,
    ];
    let file = pcap(0xA1B2_C3D4, false, 227, &[(1, 0, None, &answer)]);
    assert_eq!(
        read(&file).0,
        [frame(
            1_000_000_000,
            DriveLink::Can,
            Direction::FromDrive,
            &answer
        )]
    );
}

#[test]
fn a_wrong_length_ends_the_reading_with_its_offset() {
    let data = ethernet(&[], &ip(2368, b"x"));
    let mut file = pcap(0xA1B2_C3D4, false, 1, &[(1, 0, None, &data)]);
    let offset = file.len() as u64;
    file.extend([0xFF; 64]);
    let (records, end, _) = read(&file);
    assert_eq!(records.len(), 1);
    assert!(
        matches!(end, End::Unreadable { offset: at, fault: PacketFault::Length { .. } } if at == offset),
        "{end:?}"
    );

    let mut broken = packet(false, 0, 1, &data, None);
    let last = broken.len() - 4;
    broken[last] ^= 4;
    let head = [section(false), interface(false, 1, &[])].concat();
    let (records, end, _) = read(&[head.clone(), broken].concat());
    assert_eq!(records.len(), 0);
    assert!(
        matches!(end, End::Unreadable { offset, fault: PacketFault::Lengths { .. } } if offset == head.len() as u64),
        "{end:?}"
    );
}

#[test]
fn other_files_are_described() {
    let folder = tempfile::tempdir().unwrap();
    let missing = Recording::open(folder.path().join("missing.pcap")).unwrap_err();
    assert!(matches!(missing, RecordingError::Open { .. }), "{missing}");
    // Windows opens no directory.
    let directory = Recording::open(folder.path()).unwrap_err();
    assert!(
        match &directory {
            RecordingError::Read { offset: 0, .. } => cfg!(unix),
            RecordingError::Open { .. } => cfg!(windows),
            _ => false,
        },
        "{directory}"
    );

    let open = |bytes: &[u8]| Recording::new(bytes, "file").unwrap_err().to_string();
    assert_eq!(
        open(b""),
        "file: expected a pcap or pcapng recording, got an empty file"
    );
    assert!(open(b"ply\nformat binary").ends_with("got a PLY cloud"));
    assert!(open(&[0x1F, 0x8B, 8, 0]).contains("gzip"));
    assert!(open(b"time_s,angle_deg\n0,0\n1,1\n").ends_with("starts 74 69 6D 65 5F 73 2C 61"));
    assert!(open(&pcap(0xA1B2_C3D4, false, 105, &[])).ends_with("got 105"));
    let user0 = pcap(0xA1B2_C3D4, false, 147, &[]);
    assert!(
        open(&user0).ends_with("got 147"),
        "the link type does not identify the protocol"
    );
    let mut wrong_order = section(false);
    wrong_order[8] ^= 1;
    assert!(open(&wrong_order).contains("byte-order magic"));
}

#[test]
fn real_recordings_have_the_known_content() {
    let cuts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/recordings");
    let contents = [
        ("vlp16-strongest-gps.pcap", 26, 5),
        ("vlp16-dual.pcap", 14, 0),
        // Position packets: the IP length is that of a data packet, the UDP length is correct.
        ("vlp16-2014-no-factory-bytes.pcap", 115, 21),
        ("vlp16-fov-limited-malformed.pcap", 41, 36),
    ];
    assert_content(&cuts, &contents);
}

#[test]
#[ignore = "needs the whole recordings"]
fn whole_recordings_have_the_known_content() {
    let folder = std::env::var_os("VELOMOTION_RECORDINGS").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings"),
        PathBuf::from,
    );
    let contents = [
        ("vlp16-strongest-gps.pcap", 293, 57),
        ("vlp16-dual.pcap", 603, 0),
        ("vlp16-2014-no-factory-bytes.pcap", 1902, 367),
    ];
    assert_content(&folder, &contents);
}

/// Checks the numbers of data and position packets in each file.
fn assert_content(folder: &Path, contents: &[(&str, u64, u64)]) {
    for &(name, data, position) in contents {
        let path = folder.join(name);
        for pass in 1..=2 {
            let mut recording = Recording::open(&path).unwrap();
            let mut last = Stamp::from_nanos(0);
            let (mut data_packets, mut positions, mut records) = (0, 0, 0);
            while let Some(record) = recording.next_record().unwrap() {
                match record.wire {
                    Wire::Lidar {
                        port: 2368,
                        payload,
                        ..
                    } if payload.len() == 1206 => {
                        data_packets += 1;
                    }
                    Wire::Lidar {
                        port: 8308,
                        payload,
                        ..
                    } if payload.len() == 512 => {
                        positions += 1;
                    }
                    _ => {}
                }
                assert!(record.host > Stamp::from_nanos(1_300_000_000_000_000_000));
                last = last.max(record.host);
                records += 1;
            }
            let counts = recording.counts();
            assert_eq!(data_packets, data, "{name}, pass {pass}");
            assert_eq!(positions, position, "{name}");
            assert_eq!(counts.datagrams, data + position, "{name}");
            assert_eq!(records, data + position, "{name}");
            let end = recording.end().cloned().unwrap();
            if name.contains("malformed") {
                // Truncated in its last record: 258 of 554 bytes and 16 of header.
                let expected = End::Truncated {
                    offset: 72_426,
                    expected: 570,
                    got: 258,
                };
                assert_eq!(end, expected);
                assert_eq!(counts.other, 1, "an ARP question");
            } else {
                assert_eq!(end, End::Complete, "{name}");
            }
        }
    }
}

/// A reader that generates a long pcap file.
struct Endless {
    record: Vec<u8>,
    left: usize,
    at: usize,
}

impl Read for Endless {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if self.at == self.record.len() && self.left > 0 {
            self.left -= 1;
            self.at = 0;
        }
        let n = buffer.len().min(self.record.len() - self.at);
        buffer[..n].copy_from_slice(&self.record[self.at..self.at + n]);
        self.at += n;
        Ok(n)
    }
}

#[test]
fn memory_does_not_grow_with_the_recording() {
    let data = ethernet(&[], &ip(2368, &data_packet(7)));
    let file = pcap(0xA1B2_C3D4, false, 1, &[(1, 0, None, &data)]);
    let records = 100_000;
    let endless = Endless {
        record: file[24..].to_vec(),
        left: records,
        at: data.len() + 16,
    };
    let mut recording = Recording::new(file[..24].chain(endless), "126 MB").unwrap();
    let before = recording.window.capacity();
    let mut n = 0;
    while recording.next_record().unwrap().is_some() {
        n += 1;
    }
    assert_eq!(n, records);
    assert_eq!(recording.window.capacity(), before);
    assert!(before <= 1 << 20);
}

#[test]
fn logs_round_trip_with_their_configuration() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.pcapng");
    let config = LogConfig {
        metadata: "device = \"sim\"\n[mount]\nd_m = 0.06 # µ\n".to_owned(),
        drive: Some(DriveLink::Usb),
    };
    let mut writer = LogWriter::create(&path, &config, Overwrite::Refuse).unwrap();
    let records = [
        datagram(5, 2368, b"firing"),
        frame(6, DriveLink::Usb, Direction::ToDrive, &[0x90, 2, 0x10]),
        frame(7, DriveLink::Usb, Direction::FromDrive, &[]),
        frame(8, DriveLink::Rs232, Direction::FromDrive, b"O"),
        frame(9, DriveLink::Can, Direction::ToDrive, &[0; 16]),
    ];
    for record in &records {
        writer.write(&record.as_record()).unwrap();
    }
    writer.finish().unwrap();
    let mut recording = Recording::open(&path).unwrap().keep_foreign();
    assert_eq!(recording.metadata(), Some(config.metadata.as_str()));
    for expected in &records {
        let record = recording.next_record().unwrap().unwrap();
        assert_eq!(OwnedRecord::from(&record), *expected);
    }
    assert!(recording.next_record().unwrap().is_none());
    assert!(recording.next_record().unwrap().is_none(), "still");
    assert_eq!(recording.end(), Some(&End::Complete));
}
