//! Damage within pcapng files, and memory use of hostile files.

use proptest::prelude::*;

use super::*;

/// A file of `n` data packets, and the start of each block.
fn valid_file(big: bool, n: u8) -> (Vec<u8>, Vec<usize>) {
    let mut file = section(big);
    let mut starts = vec![0, file.len()];
    file.extend(interface(big, 1, &[(2, b"lidar"), (9, &[9])]));
    for i in 0..n {
        starts.push(file.len());
        let data = ethernet(&[], &ip(2368, &data_packet(i)));
        file.extend(packet(big, 0, i.into(), &data, Some(1)));
    }
    (file, starts)
}

fn expected(n: u8, without: &[u8]) -> Vec<OwnedRecord> {
    (0..n)
        .filter(|i| !without.contains(i))
        .map(|i| datagram(i.into(), 2368, &data_packet(i)))
        .collect()
}

#[test]
fn one_damaged_block_costs_one_packet() {
    for big in [false, true] {
        let (file, starts) = valid_file(big, 6);
        let start = starts[4]; // packet 2
        let length = starts[5] - start;
        // First the length at the start: too small, odd, larger than the block, the file, or the
        // limit. Then the length at the end.
        let fields = [12_u32, 15, 64, 2_000, 1 << 20, 15 << 20, u32::MAX];
        let damages = fields
            .iter()
            .map(|&value| (start + 4, value))
            .chain([(starts[5] - 4, 0), (starts[5] - 4, length as u32 + 4)]);
        for (at, value) in damages {
            let mut damaged = file.clone();
            let mut field = Vec::new();
            put(&mut field, value, big);
            damaged[at..at + 4].copy_from_slice(&field);
            let (records, end, counts) = read(&damaged);
            assert!(records == expected(6, &[2]), "{value:#x} at {at}");
            assert_eq!(end, End::Complete);
            assert_eq!(
                (counts.records, counts.malformed, counts.damaged),
                (6, 1, 1)
            );
            assert_eq!(counts.damaged_bytes, length as u64);
            let first = counts.first_malformed.unwrap();
            assert_eq!(first.offset, start as u64, "{}", first.fault);
        }
    }
}

#[test]
fn missing_and_surplus_bytes_are_skipped() {
    for big in [false, true] {
        let (file, starts) = valid_file(big, 6);
        let (cut, next) = (starts[4] + 700, starts[6]);
        // A gap from packet 2 into packet 3 that is no multiple of four.
        let missing = [&file[..cut], &file[next - 333..]].concat();
        let (records, end, counts) = read(&missing);
        assert!(records == expected(6, &[2, 3]));
        assert_eq!((end, counts.damaged), (End::Complete, 1));
        assert_eq!(counts.damaged_bytes, 700 + 333);

        // A run of zeros as left by a file system, larger than one search window.
        for hole in [1, 5, 4096, 1_000_001] {
            let holed = [&file[..starts[4]], &vec![0; hole], &file[starts[4]..]].concat();
            let (records, end, counts) = read(&holed);
            assert!(records == expected(6, &[]), "hole of {hole}");
            assert_eq!((end, counts.damaged), (End::Complete, 1));
            assert_eq!(counts.damaged_bytes, hole as u64);
        }
    }
}

#[test]
fn a_damaged_description_keeps_its_number() {
    let data = ethernet(&[], &ip(2368, b"x"));
    let mut first = interface(false, 113, &[]);
    let last = first.len() - 4;
    first[last] ^= 0x40;
    let file = [
        section(false),
        first,
        interface(false, 1, &[(9, &[9])]),
        packet(false, 0, 1, &data, None),
        packet(false, 1, 2, &data, None),
    ]
    .concat();
    let (records, end, counts) = read(&file);
    assert_eq!(records, [datagram(2, 2368, b"x")]);
    assert_eq!(end, End::Complete);
    assert_eq!((counts.damaged, counts.other), (1, 1 + 1));
}

#[test]
fn a_damaged_section_header_of_the_other_byte_order_is_skipped() {
    for big in [false, true] {
        let (one, _) = valid_file(big, 2);
        let (mut two, starts) = valid_file(!big, 3);
        for at in [4, 8, starts[1] - 1] {
            two[at] ^= 0x5A;
            let (records, end, counts) = read(&[one.clone(), two.clone()].concat());
            let all = [expected(2, &[]), expected(3, &[])].concat();
            assert!(records == all, "byte {at}");
            assert_eq!((end, counts.damaged), (End::Complete, 1));
            two[at] ^= 0x5A;
        }
    }
}

#[test]
fn damage_without_later_valid_blocks_ends_the_reading() {
    let (file, starts) = valid_file(false, 3);
    let garbage = [&file[..starts[4]], &[0xA5; 300_000]].concat();
    let (records, end, counts) = read(&garbage);
    assert!(records == expected(2, &[]));
    assert!(
        matches!(end, End::Unreadable { offset, .. } if offset == starts[4] as u64),
        "{end:?}"
    );
    assert_eq!((counts.malformed, counts.damaged), (0, 0));
}

/// Repeats the same bytes up to a total length.
struct Repeat {
    head: Vec<u8>,
    body: Vec<u8>,
    at: u64,
    len: u64,
}

impl Read for Repeat {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let (head, body) = (self.head.len() as u64, self.body.len() as u64);
        let from = match self.at.checked_sub(head) {
            None => &self.head[self.at as usize..],
            Some(behind) => &self.body[(behind % body) as usize..],
        };
        let left = usize::try_from(self.len - self.at).unwrap_or(usize::MAX);
        let n = buffer.len().min(from.len()).min(left);
        buffer[..n].copy_from_slice(&from[..n]);
        self.at += n as u64;
        Ok(n)
    }
}

#[test]
fn reading_400_megabytes_takes_256_kib_of_memory() {
    let head = [section(false), interface(false, 1, &[(9, &[9])])].concat();
    let data = ethernet(&[], &ip(2368, &data_packet(7)));
    let body = [
        packet(false, 0, 5, &data, Some(1)),
        packet(false, 0, 6, &ethernet(&[], &unmatched_fragment()), Some(1)),
    ]
    .concat();
    let len = head.len() as u64 + body.len() as u64 * 310_000;
    assert!(len > 400 << 20);
    let reader = Repeat {
        head,
        body,
        at: 0,
        len,
    };
    let mut recording = Recording::new(reader, "400 MB").unwrap();
    let mut n = 0;
    while recording.next_record().unwrap().is_some() {
        n += 1;
    }
    assert_eq!(n, 310_000);
    assert_eq!(recording.counts().fragments, 310_000);
    assert_eq!(recording.end(), Some(&End::Complete));
    assert_eq!(recording.window.capacity(), 256 << 10);
}

/// The first of two fragments, without the second.
fn unmatched_fragment() -> Vec<u8> {
    let mut packet = ip(2368, b"part");
    packet[6] = 0x20;
    packet
}

/// A hostile file: every other block claims the longest valid length, and few bytes follow. Moving
/// or examining them again for each block would take hours.
#[test]
fn false_lengths_cost_neither_memory_nor_time() {
    let mut body = Vec::new();
    for value in [6, 16 << 20] {
        put(&mut body, value, false);
    }
    body.extend([0; 24]);
    let liar = body.len();
    body.extend(packet(false, 0, 1, &ethernet(&[], &ip(7, b"")), None));
    let blocks = 500_000;
    let (head, _) = valid_file(false, 1);
    let len = head.len() as u64 + (body.len() as u64) * blocks;
    let reader = Repeat {
        body,
        at: 0,
        len,
        head,
    };
    let mut recording = Recording::new(reader, "lies").unwrap();
    let mut n = 0;
    while recording.next_record().unwrap().is_some() {
        n += 1;
    }
    assert_eq!(n, 1);
    let counts = recording.counts();
    assert_eq!((counts.other, counts.damaged), (blocks, blocks));
    assert_eq!(counts.damaged_bytes, blocks * liar as u64);
    assert_eq!(recording.end(), Some(&End::Complete));
    assert!(recording.window.capacity() <= 32 << 20);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// All blocks outside a damaged one are read.
    #[test]
    fn damage_does_not_spread(
        big in any::<bool>(),
        which in 1_usize..7,
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..60),
    ) {
        let (mut file, starts) = valid_file(big, 8);
        let (start, end) = (starts[which + 2], starts[which + 3]);
        for (at, value) in damage {
            file[start + at.index(end - start)] = value;
        }
        let (records, ended, _) = read(&file);
        let rest = expected(8, &[which as u8]);
        prop_assert_eq!(ended, End::Complete);
        prop_assert!(rest.iter().all(|record| records.contains(record)));
    }
}
