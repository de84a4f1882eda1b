//! Files, packets and records of the tests, encoded by hand.

use super::*;

/// An IPv4 packet with UDP, encoded without etherparse and without checksums, which recordings
/// often lack.
pub(super) fn ip(port: u16, payload: &[u8]) -> Vec<u8> {
    let udp_len = (payload.len() + 8) as u16;
    let mut out = vec![0x45, 0];
    out.extend((udp_len + 20).to_be_bytes());
    out.extend([0, 0, 0x40, 0, 64, 17, 0, 0]);
    out.extend(SOURCE);
    out.extend([255; 4]);
    out.extend(port.to_be_bytes());
    out.extend(port.to_be_bytes());
    out.extend(udp_len.to_be_bytes());
    out.extend([0, 0]);
    out.extend(payload);
    out
}

pub(super) fn ethernet(tags: &[u8], packet: &[u8]) -> Vec<u8> {
    [
        &[0xFF; 6][..],
        &[0x60, 0x76, 0x88, 1, 2, 3],
        tags,
        &[8, 0],
        packet,
    ]
    .concat()
}

pub(super) fn put(out: &mut Vec<u8>, value: u32, big_endian: bool) {
    out.extend(if big_endian {
        value.to_be_bytes()
    } else {
        value.to_le_bytes()
    });
}

/// A pcap file; records are (seconds, fraction, original length if it differs, data).
pub(super) fn pcap(
    magic: u32,
    big: bool,
    link: u32,
    records: &[(u32, u32, Option<u32>, &[u8])],
) -> Vec<u8> {
    let mut out = Vec::new();
    put(&mut out, magic, big);
    out.extend(if big { [0, 2, 0, 4] } else { [2, 0, 4, 0] });
    for value in [0, 0, 65_535, link] {
        put(&mut out, value, big);
    }
    for (s, fraction, original, data) in records {
        let length = data.len() as u32;
        for value in [*s, *fraction, length, original.unwrap_or(length)] {
            put(&mut out, value, big);
        }
        out.extend(*data);
    }
    out
}

pub(super) fn block(kind: u32, big: bool, body: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let length = body.len() as u32 + 12;
    put(&mut out, kind, big);
    put(&mut out, length, big);
    out.extend(body);
    put(&mut out, length, big);
    out
}

pub(super) fn section(big: bool) -> Vec<u8> {
    let mut body = Vec::new();
    put(&mut body, 0x1A2B_3C4D, big);
    body.extend(if big { [0, 1, 0, 0] } else { [1, 0, 0, 0] });
    body.extend([0xFF; 8]);
    block(0x0A0D_0D0A, big, &body)
}

pub(super) fn interface(big: bool, link: u16, options: &[(u16, &[u8])]) -> Vec<u8> {
    let u16s = |value: u16| {
        if big {
            value.to_be_bytes()
        } else {
            value.to_le_bytes()
        }
    };
    let mut body = u16s(link).to_vec();
    body.extend([0; 6]);
    for (code, value) in options {
        body.extend(u16s(*code));
        body.extend(u16s(value.len() as u16));
        body.extend(*value);
        body.resize(body.len().next_multiple_of(4), 0);
    }
    block(1, big, &body)
}

pub(super) fn packet(
    big: bool,
    interface: u32,
    time: u64,
    data: &[u8],
    flags: Option<u32>,
) -> Vec<u8> {
    let mut body = Vec::new();
    let length = data.len() as u32;
    for value in [interface, (time >> 32) as u32, time as u32, length, length] {
        put(&mut body, value, big);
    }
    body.extend(data);
    body.resize(body.len().next_multiple_of(4), 0);
    if let Some(flags) = flags {
        body.extend(if big { [0, 2, 0, 4] } else { [2, 0, 4, 0] });
        put(&mut body, flags, big);
    }
    block(6, big, &body)
}

/// A data packet with block flags and arbitrary content.
pub(super) fn data_packet(fill: u8) -> Vec<u8> {
    let mut data = vec![fill; DATA_LEN];
    for block in data.chunks_exact_mut(100) {
        block[..2].copy_from_slice(&[0xFF, 0xEE]);
    }
    data
}

/// All records, foreign ones included, with the end and the counts.
pub(super) fn read(bytes: &[u8]) -> (Vec<OwnedRecord>, End, RecordingCounts) {
    let mut recording = Recording::new(bytes, "test").unwrap().keep_foreign();
    let mut records = Vec::new();
    while let Some(record) = recording.next_record().unwrap() {
        records.push(OwnedRecord::from(&record));
    }
    let end = recording.end().cloned().unwrap();
    (records, end, recording.counts().clone())
}

pub(super) fn datagram(ns: i64, port: u16, payload: &[u8]) -> OwnedRecord {
    OwnedRecord::from(&Record {
        host: Stamp::from_nanos(ns),
        wire: Wire::Lidar {
            source: SOURCE,
            port,
            payload,
        },
    })
}

pub(super) fn frame(ns: i64, link: DriveLink, direction: Direction, frame: &[u8]) -> OwnedRecord {
    OwnedRecord::from(&Record {
        host: Stamp::from_nanos(ns),
        wire: Wire::Drive {
            link,
            direction,
            frame,
        },
    })
}
