//! Variants of recording formats, encoded by hand, intact and damaged.

use super::*;

/// Value of `if_tsresol` for nanoseconds.
const NANOSECONDS: &[u8] = &[9];

fn block_of(big: bool, kind: u32, words: &[u32], data: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    for word in words {
        put(&mut body, *word, big);
    }
    body.extend(data);
    body.resize(body.len().next_multiple_of(4), 0);
    block(kind, big, &body)
}

/// An IPv6 packet with its next header and payload.
fn ip6(source: [u8; 16], next: u8, payload: &[u8]) -> Vec<u8> {
    let mut out = vec![0x60, 0, 0, 0];
    out.extend((payload.len() as u16).to_be_bytes());
    out.extend([next, 64]);
    out.extend(source);
    out.extend([0xFF, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]);
    out.extend(payload);
    out
}

fn udp(port: u16, payload: &[u8]) -> Vec<u8> {
    let length = (payload.len() + 8) as u16;
    let mut out = port.to_be_bytes().to_vec();
    out.extend(port.to_be_bytes());
    out.extend(length.to_be_bytes());
    out.extend([0, 0]);
    out.extend(payload);
    out
}

/// An IPv4 fragment: bytes of a UDP datagram from `offset` on.
fn ip_part(id: u16, offset: usize, more: bool, part: &[u8]) -> Vec<u8> {
    let mut out = vec![0x45, 0];
    out.extend((part.len() as u16 + 20).to_be_bytes());
    out.extend(id.to_be_bytes());
    out.extend((u16::from(more) << 13 | (offset / 8) as u16).to_be_bytes());
    out.extend([64, 17, 0, 0]);
    out.extend(SOURCE);
    out.extend([255; 4]);
    out.extend(part);
    out
}

fn one(link: u32, data: &[u8]) -> (Vec<OwnedRecord>, End, RecordingCounts) {
    read(&pcap(0xA1B2_C3D4, false, link, &[(1, 0, None, data)]))
}

const SECOND_NS: i64 = 1_000_000_000;

#[test]
fn lidars_are_recognised_by_content_on_any_port() {
    let position = [0; 512];
    let packets = [
        ethernet(&[], &ip(2368, &data_packet(1))),
        ethernet(&[], &ip(53, &data_packet(2))),
        ethernet(&[], &ip(60_000, &position)),
        ethernet(&[], &ip(2368, b"not a lidar's")),
        ethernet(&[], &ip(2368, &[7; 1206])),
        ethernet(&[], &ip(8308, &[7; 512])),
        ethernet(&[], &ip(2368, &data_packet(3)[..500])),
    ];
    let records: Vec<_> = (0..)
        .zip(&packets)
        .map(|(s, p)| (s, 0, None, p.as_slice()))
        .collect();
    let file = pcap(0xA1B2_C3D4, false, 1, &records);
    let mut recording = Recording::new(file.as_slice(), "").unwrap();
    let mut got = Vec::new();
    while let Some(record) = recording.next_record().unwrap() {
        got.push(OwnedRecord::from(&record));
    }
    assert_eq!(
        got,
        [
            datagram(0, 2368, &data_packet(1)),
            datagram(SECOND_NS, 53, &data_packet(2)),
            datagram(2 * SECOND_NS, 60_000, &position),
            // Damaged, which the decoder reports.
            datagram(6 * SECOND_NS, 2368, &data_packet(3)[..500]),
        ]
    );
    let counts = recording.counts();
    assert_eq!((counts.records, counts.other, counts.malformed), (7, 3, 0));
    assert_eq!(counts.datagrams, 4);
    let (all, _, again) = read(&file);
    assert_eq!(all.len(), 7, "unless requested");
    assert_eq!(again, *counts);
}

#[test]
fn ipv6_is_read_on_every_link() {
    let source = [0xFE, 0x80, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7];
    let packet = ip6(source, 17, &udp(2368, b"firing"));
    let tags = [0x88, 0xA8, 0, 7, 0x81, 0x00, 0x00, 0x05];
    let on_ethernet = |tags: &[u8]| [&[0xFF; 12][..], tags, &[0x86, 0xDD], &packet].concat();
    let stand_in = link::source_of(source.into());
    let expected = OwnedRecord::from(&Record {
        host: Stamp::from_nanos(SECOND_NS),
        wire: Wire::Lidar {
            source: stand_in,
            port: 2368,
            payload: b"firing",
        },
    });
    for (link, data) in [
        (1, on_ethernet(&[])),
        (1, on_ethernet(&tags[4..])),
        (1, on_ethernet(&tags)),
        (113, [&[0; 14][..], &[0x86, 0xDD], &packet].concat()),
        (276, [&[0x86, 0xDD][..], &[0; 18], &packet].concat()),
        (101, packet.clone()),
        (229, packet.clone()),
    ] {
        let (records, _, counts) = one(link, &data);
        assert_eq!(
            records,
            std::slice::from_ref(&expected),
            "link {link}: {counts:?}"
        );
        // Truncated anywhere it is malformed, with the offset in the packet.
        for cut in 0..data.len() {
            let (records, end, counts) = one(link, &data[..cut]);
            assert_eq!(
                (records.len(), end),
                (0, End::Complete),
                "link {link}, {cut}"
            );
            assert_eq!(counts.malformed, 1, "link {link} cut at {cut}: {counts:?}");
            if let PacketFault::Short {
                offset,
                expected,
                got,
                ..
            } = counts.first_malformed.unwrap().fault
            {
                assert!(
                    offset <= cut && expected > got,
                    "{offset} {expected} {got} of {cut}"
                );
            }
        }
    }
    let mapped = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 192, 168, 1, 201];
    let (records, ..) = one(101, &ip6(mapped, 17, &udp(8308, b"x")));
    assert_eq!(records, [datagram(SECOND_NS, 8308, b"x")]);
}

#[test]
fn truncated_ipv4_packets_are_malformed_on_every_link() {
    let ip = ip(2368, b"firing");
    let tags = [0x88, 0xA8, 0, 7, 0x81, 0x00, 0x00, 0x05];
    for (link, data) in [
        (1, ethernet(&[], &ip)),
        (1, ethernet(&tags[4..], &ip)),
        (1, ethernet(&tags, &ip)),
        (113, [&[0; 14][..], &[8, 0], &ip].concat()),
        (113, [&[0; 14][..], &[0x81, 0, 0, 5, 8, 0], &ip].concat()), // a tag after the cooked header
        (276, [&[8, 0][..], &[0; 18], &ip].concat()),
        (101, ip.clone()),
        (228, ip.clone()),
    ] {
        assert_eq!(one(link, &data).0, [datagram(SECOND_NS, 2368, b"firing")]);
        for cut in 0..data.len() {
            let (records, _, counts) = one(link, &data[..cut]);
            assert_eq!(records, [], "link {link} cut at {cut}");
            assert_eq!(counts.malformed, 1, "link {link} cut at {cut}: {counts:?}");
        }
    }
    let (_, _, counts) = one(101, &[0x75; 40]);
    assert_eq!(
        counts.first_malformed.unwrap().fault.to_string(),
        "IP version: expected 4 or 6, got 7"
    );
}

#[test]
fn a_wrong_ip_length_is_ignored_if_the_udp_length_is_correct() {
    // VLP-16 firmware of 2014.
    let mut packet = ip(8308, &[0; 512]);
    packet[2..4].copy_from_slice(&1234_u16.to_be_bytes());
    for (link, data) in [
        (1, ethernet(&[], &packet)),
        (1, ethernet(&[0x81, 0, 0, 5], &packet)),
        (113, [&[0; 14][..], &[8, 0], &packet].concat()),
        (276, [&[8, 0][..], &[0; 18], &packet].concat()),
        (101, packet.clone()),
    ] {
        assert_eq!(
            one(link, &data).0,
            [datagram(SECOND_NS, 8308, &[0; 512])],
            "link {link}"
        );
    }
}

#[test]
fn fragments_are_reassembled_and_faults_reported() {
    let whole = udp(2368, &data_packet(9));
    let parts = |id| {
        [
            ethernet(&[], &ip_part(id, 0, true, &whole[..576])),
            ethernet(&[], &ip_part(id, 576, true, &whole[576..1152])),
            ethernet(&[], &ip_part(id, 1152, false, &whole[1152..])),
        ]
    };
    let ([a0, a1, a2], [b0, b1, b2]) = (parts(1), parts(2));
    let lone = ethernet(&[], &ip_part(3, 0, true, &whole[..8]));
    let mut lies = udp(2368, b"lies");
    lies[5] += 1;
    let lies = [
        ethernet(&[], &ip_part(4, 0, true, &lies[..8])),
        ethernet(&[], &ip_part(4, 8, false, &lies[8..])),
    ];
    let order = [&a0, &b2, &a1, &b0, &lone, &a2, &b1, &lies[0], &lies[1]];
    let records: Vec<_> = (0..)
        .zip(order)
        .map(|(us, p)| (1, us, None, p.as_slice()))
        .collect();
    let (records, end, counts) = read(&pcap(0xA1B2_C3D4, false, 1, &records));
    assert_eq!(
        records,
        [
            datagram(SECOND_NS + 5_000, 2368, &data_packet(9)),
            datagram(SECOND_NS + 6_000, 2368, &data_packet(9)),
        ],
        "each with the time of its last fragment"
    );
    assert_eq!(end, End::Complete);
    assert_eq!(counts.records, 9);
    assert_eq!(counts.datagrams, 2);
    assert_eq!(
        (counts.fragments, counts.joined, counts.reassembled),
        (1, 5, 3)
    );
    assert_eq!(counts.malformed, 1);
    let first = counts.first_malformed.unwrap();
    assert_eq!(
        first.fault.to_string(),
        "UDP payload at byte 0 of the packet: expected 13 bytes, got 12"
    );
}

#[test]
fn captures_with_complete_datagrams_are_valid() {
    let data = ethernet(&[], &ip(2368, b"firing"));
    let file = pcap(
        0xA1B2_C3D4,
        false,
        1,
        &[
            (1, 0, Some(data.len() as u32 + 4), &data), // without the check sequence
            (2, 0, Some(data.len() as u32), &data[..data.len() - 1]),
        ],
    );
    let (records, _, counts) = read(&file);
    assert_eq!(records, [datagram(SECOND_NS, 2368, b"firing")]);
    assert_eq!((counts.malformed, counts.snapped), (1, 1));
}

#[test]
fn pcapng_of_several_sections_interfaces_and_packet_blocks_is_read() {
    let packet_of = |tag: u8| ethernet(&[], &ip(2368, &[tag]));
    let cooked = [&[0; 14][..], &[8, 0], &ip(2368, b"c")].concat();
    for (one, two) in [(false, true), (true, false), (false, false), (true, true)] {
        let offset = |big: bool| match big {
            true => (-100_i64).to_be_bytes(),
            false => (-100_i64).to_le_bytes(),
        };
        let data = packet_of(b'a');
        let mut oversized = packet(one, 1, 0, &cooked, None);
        oversized[if one { 21 } else { 22 }] = 0x10; // captured length: 1 MiB
        let file = [
            section(one),
            interface(one, 1, &[(9, NANOSECONDS)]),
            interface(one, 113, &[(14, &offset(one))]),
            interface(one, 195, &[]), // IEEE 802.15.4, unsupported
            packet(one, 0, 7, &data, None),
            packet(one, 1, 200_000_000, &cooked, None),
            oversized,                        // exceeds its block
            packet(one, 9, 0, &cooked, None), // of an undescribed interface
            packet(one, 2, 8, &data, None),
            block_of(one, 3, &[data.len() as u32], &data),
            block(5, one, &[0; 12]),
            block(0x4000_0BAD, one, &[0; 400]),
            section(two),
            interface(two, 101, &[(9, &[6]), (14, &offset(two))]),
            packet(two, 0, 100_000_001, &ip(2368, b"d"), None),
        ]
        .concat();
        let (records, end, counts) = read(&file);
        assert_eq!(
            records,
            [
                datagram(7, 2368, b"a"),
                datagram(100 * SECOND_NS, 2368, b"c"),
                datagram(1_000, 2368, b"d"),
            ]
        );
        assert_eq!(end, End::Complete);
        assert_eq!(
            (counts.records, counts.other, counts.malformed),
            (7, 1 + 3, 3)
        );
        assert_eq!(counts.damaged, 0);
        let first = counts.first_malformed.unwrap().fault;
        assert_eq!(first, PacketFault::Block { kind: 6 });
    }
}

#[test]
fn simple_packet_blocks_are_malformed() {
    let data = ethernet(&[], &ip(2368, &data_packet(1)));
    let file = [
        section(false),
        interface(false, 1, &[]),
        block_of(false, 3, &[data.len() as u32], &data),
    ]
    .concat();
    let (records, _, counts) = read(&file);
    assert_eq!((records.len(), counts.malformed), (0, 1));
    let first = counts.first_malformed.unwrap();
    assert_eq!(
        first.offset,
        file.len() as u64 - 16 - data.len().next_multiple_of(4) as u64
    );
    assert_eq!(
        first.fault.to_string(),
        "a pcapng simple packet block, which has no time"
    );
}

#[test]
fn several_sensors_in_one_file_are_distinguished() {
    let from = |last: u8, port, payload: &[u8]| {
        let mut packet = ip(port, payload);
        packet[15] = last;
        ethernet(&[], &packet)
    };
    let packets = [
        from(201, 2368, &data_packet(0)),
        from(202, 2368, &data_packet(0)),
        from(201, 8308, &[0; 512]),
        from(202, 2368, &data_packet(0)),
        from(203, 123, b"time?"),
    ];
    let records: Vec<_> = (0..)
        .zip(&packets)
        .map(|(s, p)| (s, 0, None, p.as_slice()))
        .collect();
    let file = pcap(0xA1B2_C3D4, false, 1, &records);
    let mut recording = Recording::new(file.as_slice(), "two").unwrap();
    let mut found = Vec::new();
    while let Some(record) = recording.next_record().unwrap() {
        if let Wire::Lidar { source, port, .. } = record.wire {
            found.push((source[3], port, record.host.as_nanos()));
        }
    }
    assert_eq!(
        found,
        [
            (201, 2368, 0),
            (202, 2368, SECOND_NS),
            (201, 8308, 2 * SECOND_NS),
            (202, 2368, 3 * SECOND_NS),
        ]
    );
}
