//! Truncated files and random bytes.

use proptest::prelude::*;

use super::*;

/// Reads a file truncated at each byte; `ends` are the ends of its records.
fn cut_everywhere(file: &[u8], ends: &[usize]) {
    let whole = read(file).0;
    let header_end = ends[0];
    for cut in 0..file.len() {
        let got = Recording::new(&file[..cut], "cut");
        if cut < header_end {
            match got {
                Err(RecordingError::Empty { .. }) => assert_eq!(cut, 0),
                Err(RecordingError::Short { got, .. }) => assert_eq!(got, cut as u64),
                // Fewer bytes than a magic number.
                other => panic!("cut at {cut}: {other:?}"),
            }
            continue;
        }
        let (records, end, counts) = read(&file[..cut]);
        assert_eq!(records, whole[..records.len()], "cut at {cut}");
        assert_eq!(counts.malformed, 0);
        let start = *ends.iter().rfind(|&&end| end <= cut).unwrap();
        if start == cut {
            assert_eq!(end, End::Complete, "cut at {cut}");
        } else {
            let End::Truncated {
                offset,
                expected,
                got,
            } = end
            else {
                panic!("cut at {cut}: {end:?}");
            };
            assert_eq!((offset, got), (start as u64, (cut - start) as u64));
            assert!(expected > got);
        }
    }
}

#[test]
fn a_truncated_pcap_keeps_complete_records() {
    let data = ethernet(&[], &ip(2368, b"firing"));
    let records: Vec<(u32, u32, Option<u32>, &[u8])> =
        (0..4).map(|s| (s, 0, None, data.as_slice())).collect();
    for big in [false, true] {
        let file = pcap(0xA1B2_3C4D, big, 1, &records);
        let ends: Vec<usize> = (0..=4).map(|n| 24 + n * (16 + data.len())).collect();
        cut_everywhere(&file, &ends);
    }
}

#[test]
fn a_truncated_pcapng_keeps_complete_records() {
    let data = ethernet(&[], &ip(2368, b"firing"));
    for big in [false, true] {
        let mut file = Vec::new();
        let mut ends = Vec::new();
        for part in [
            section(big),
            interface(big, 1, &[(9, &[9])]),
            packet(big, 0, 1, &data, None),
            packet(big, 0, 2, &data, Some(1)),
            packet(big, 0, 3, &data, Some(2)),
        ] {
            file.extend(part);
            ends.push(file.len());
        }
        cut_everywhere(&file, &ends);
    }
}

/// Small valid files of every format.
fn valid_files() -> Vec<Vec<u8>> {
    let data = ethernet(&[0x81, 0, 0, 5], &ip(2368, b"firing"));
    let can = [0, 0, 6, 1, 2, 0, 0, 0, 0x40, 0x41];
    let mut files = vec![
        pcap(
            0xA1B2_3C4D,
            false,
            1,
            &[(1, 2, None, &[0; 40]), (3, 4, None, &data)],
        ),
        pcap(
            0xA1B2_C3D4,
            false,
            276,
            &[(1, 2, None, &data), (3, 4, None, &data)],
        ),
        pcap(
            0xA1B2_C3D4,
            false,
            113,
            &[(1, 2, None, &data), (3, 4, None, &data)],
        ),
        pcap(
            0xA1B2_C3D4,
            false,
            101,
            &[(1, 2, None, &ip(2368, b"firing"))],
        ),
    ];
    for big in [false, true] {
        files.push(pcap(
            0xA1B2_C3D4,
            big,
            1,
            &[(1, 2, None, &data), (3, 4, None, &data)],
        ));
        files.push(
            [
                section(big),
                interface(big, 1, &[(2, b"lidar"), (9, &[9]), (14, &[0; 8])]),
                interface(big, 227, &[(2, b"can")]),
                interface(big, 147, &[(2, b"epos2-usb")]),
                packet(big, 0, 1, &data, Some(1)),
                packet(big, 1, 2, &can, Some(2)),
                packet(big, 2, 3, &[0x90, 2, 0, 0], Some(2)),
            ]
            .concat(),
        );
    }
    files
}

/// Reads bytes to their end, at once and in pieces.
fn read_all_ways(bytes: &[u8]) -> u64 {
    let pieces = exhaust_from(Pieces(bytes));
    let whole = exhaust_from(bytes);
    assert_eq!(whole, pieces);
    whole.map_or(0, |(counts, _)| counts.records)
}

/// Returns a few bytes per read, like a pipe.
struct Pieces<'a>(&'a [u8]);

impl Read for Pieces<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let n = buffer.len().min(self.0.len()).min(37);
        self.0.read(&mut buffer[..n])
    }
}

fn exhaust_from(reader: impl Read) -> Option<(RecordingCounts, End)> {
    let mut recording = Recording::new(reader, "noise").ok()?.keep_foreign();
    while recording.next_record().unwrap().is_some() {}
    let counts = recording.counts();
    let parts = counts.datagrams + counts.drive + counts.other;
    let fragments = counts.fragments + counts.joined;
    assert_eq!(counts.records, parts + fragments + counts.malformed);
    assert!(counts.snapped + counts.damaged <= counts.malformed);
    Some((counts.clone(), recording.end().cloned().unwrap()))
}

#[test]
fn the_valid_files_have_records() {
    for (n, file) in valid_files().iter().enumerate() {
        assert!(read_all_ways(file) > 0, "file {n}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn random_bytes_do_not_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        read_all_ways(&bytes);
        for file in valid_files() {
            // After a valid header.
            read_all_ways(&[&file[..24.min(file.len())], &bytes].concat());
        }
    }

    #[test]
    fn damaged_files_do_not_panic(
        n in any::<prop::sample::Index>(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), prop_oneof![Just(0_u8), Just(0xFF), any::<u8>()]), 1..12),
        cut in any::<prop::sample::Index>(),
    ) {
        let files = valid_files();
        let mut file = files[n.index(files.len())].clone();
        for (at, value) in damage {
            let at = at.index(file.len());
            file[at] = value;
        }
        read_all_ways(&file);
        read_all_ways(&file[..cut.index(file.len())]);
    }
}
