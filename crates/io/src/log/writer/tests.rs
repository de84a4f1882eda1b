use super::*;
use proptest::prelude::*;
use std::process::Command;

use crate::log::OwnedRecord;
use crate::recording::{End, Recording};

fn lidar(ns: i64, payload: &[u8]) -> Record<'_> {
    Record {
        host: Stamp::from_nanos(ns),
        wire: Wire::Lidar {
            source: [192, 168, 1, 201],
            port: 2368,
            payload,
        },
    }
}

fn drive(ns: i64, direction: Direction, frame: &[u8]) -> Record<'_> {
    Record {
        host: Stamp::from_nanos(ns),
        wire: Wire::Drive {
            link: DriveLink::Usb,
            direction,
            frame,
        },
    }
}

/// Twenty thousand records of both devices, like a sweep.
fn a_sweep() -> Vec<OwnedRecord> {
    let start = 1_763_000_000_123_456_789;
    (0..20_000_i64)
        .map(|i| {
            let ns = start + i * 441_001;
            let bytes: Vec<u8> = (0..1206_i64).map(|b| (i * 31 + b) as u8).collect();
            let record = match i % 3 {
                0 => lidar(ns, &bytes),
                1 => drive(ns, Direction::ToDrive, &bytes[..10]),
                _ => drive(ns, Direction::FromDrive, &bytes[..14 + (i % 5) as usize]),
            };
            OwnedRecord::from(&record)
        })
        .collect()
}

#[test]
fn twenty_thousand_records_round_trip() {
    let records = a_sweep();
    let config = LogConfig {
        metadata: "speed_deg_s = 56.25".to_owned(),
        drive: Some(DriveLink::Usb),
    };
    let mut writer = LogWriter::new(Vec::new(), &config).unwrap();
    for record in &records {
        writer.write(&record.as_record()).unwrap();
    }
    let (counts, file) = writer.finish().unwrap();
    assert_eq!((counts.lidar, counts.drive), (6667, 13_333));
    assert_eq!(counts.bytes, file.len() as u64);

    let mut recording = Recording::new(file.as_slice(), "log")
        .unwrap()
        .keep_foreign();
    for (n, expected) in records.iter().enumerate() {
        let record = recording.next_record().unwrap().unwrap();
        assert_eq!(OwnedRecord::from(&record), *expected, "record {n}");
    }
    assert!(recording.next_record().unwrap().is_none());
    assert_eq!(recording.end(), Some(&End::Complete));
    let counts = recording.counts();
    assert_eq!((counts.other, counts.drive), (6667, 6667 + 6666));
    assert_eq!(counts.malformed, 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn any_records_round_trip(
        records in prop::collection::vec(
            (0..=i64::MAX, any::<[u8; 4]>(), any::<u16>(), 0..4_u8, any::<bool>(), prop::collection::vec(any::<u8>(), 0..100)),
            0..20,
        ),
        metadata in any::<String>(),
    ) {
        let records: Vec<OwnedRecord> = records.iter().map(|(ns, source, port, kind, to, bytes)| {
            let direction = if *to { Direction::ToDrive } else { Direction::FromDrive };
            // A CAN frame has 16 bytes, the fifth of them its length.
            let mut can = [0; 16];
            can.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
            can[4] %= 9;
            let used = 8 + usize::from(can[4]);
            can[used..].fill(0);
            let wire = match kind {
                0 => Wire::Lidar { source: *source, port: *port, payload: bytes },
                1 => Wire::Drive { link: DriveLink::Usb, direction, frame: bytes },
                2 => Wire::Drive { link: DriveLink::Rs232, direction, frame: bytes },
                _ => Wire::Drive { link: DriveLink::Can, direction, frame: &can },
            };
            OwnedRecord::from(&Record { host: Stamp::from_nanos(*ns), wire })
        }).collect();
        let metadata = metadata.trim_end_matches('\0').to_owned();
        let config = LogConfig { metadata: metadata.clone(), drive: None };
        let mut writer = LogWriter::new(Vec::new(), &config).unwrap();
        for record in &records {
            writer.write(&record.as_record()).unwrap();
        }
        let (_, file) = writer.finish().unwrap();
        let mut recording = Recording::new(file.as_slice(), "log").unwrap().keep_foreign();
        prop_assert_eq!(recording.metadata().unwrap_or(""), metadata);
        for expected in &records {
            let record = recording.next_record().unwrap().unwrap();
            prop_assert_eq!(&OwnedRecord::from(&record), expected);
        }
        prop_assert!(recording.next_record().unwrap().is_none());
    }
}

#[test]
fn an_existing_log_is_refused_or_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.pcapng");
    std::fs::write(&path, "precious").unwrap();
    let config = LogConfig::default();
    let refused = LogWriter::create(&path, &config, Overwrite::Refuse).unwrap_err();
    assert!(matches!(refused, LogError::Exists { .. }), "{refused}");
    assert_eq!(std::fs::read(&path).unwrap(), b"precious");
    let too_long = LogConfig {
        metadata: "x".repeat(65_536),
        drive: None,
    };
    let error = LogWriter::create(&path, &too_long, Overwrite::Replace).unwrap_err();
    assert!(matches!(error, LogError::Metadata { got: 65_536, .. }));
    assert_eq!(
        std::fs::read(&path).unwrap(),
        b"precious",
        "a failed replacement keeps the file"
    );
    LogWriter::create(&path, &config, Overwrite::Replace).unwrap();
    assert!(Recording::open(&path).unwrap().metadata().is_none());
    let nowhere = folder.path().join("missing/log.pcapng");
    let error = LogWriter::create(nowhere, &config, Overwrite::Refuse).unwrap_err();
    assert!(matches!(error, LogError::Create { .. }), "{error}");
}

#[test]
fn invalid_records_are_refused_and_the_log_continues() {
    let mut writer = LogWriter::new(Vec::new(), &LogConfig::default()).unwrap();
    let long = vec![0; 65_536];
    assert!(matches!(
        writer.write(&lidar(1, &long)),
        Err(LogError::TooLong {
            layer: "UDP payload",
            expected: 65_507,
            got: 65_536
        })
    ));
    assert!(matches!(
        writer.write(&drive(1, Direction::ToDrive, &long)),
        Err(LogError::TooLong {
            layer: "drive frame",
            ..
        })
    ));
    assert!(matches!(
        writer.write(&lidar(-1, b"early")),
        Err(LogError::Time { .. })
    ));
    writer.write(&lidar(1, &long[..65_507])).unwrap();
    let (counts, file) = writer.finish().unwrap();
    assert_eq!((counts.lidar, counts.drive), (1, 0));
    let mut recording = Recording::new(file.as_slice(), "log")
        .unwrap()
        .keep_foreign();
    assert!(recording.next_record().unwrap().is_some());
    assert!(recording.next_record().unwrap().is_none());
    assert_eq!(recording.end(), Some(&End::Complete));
}

/// A disk with a limited capacity in bytes.
#[derive(Debug)]
struct SmallDisk {
    bytes: Vec<u8>,
    room: usize,
}

impl Write for SmallDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = bytes.len().min(self.room - self.bytes.len());
        self.bytes.extend(&bytes[..n]);
        if n == 0 && !bytes.is_empty() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn the_log_before_a_full_disk_is_readable() {
    let disk = SmallDisk {
        bytes: Vec::new(),
        room: 200_000,
    };
    let mut writer = LogWriter::new(disk, &LogConfig::default()).unwrap();
    let payload = [7; 1206];
    let error = (0..)
        .find_map(|ns| writer.write(&lidar(ns, &payload)).err())
        .unwrap();
    let LogError::Write { offset, source } = error else {
        panic!("{error}");
    };
    let first = source.to_string();
    assert_eq!(source.kind(), io::ErrorKind::StorageFull);
    assert!(offset <= 200_000);
    assert!(matches!(
        writer.write(&lidar(1, &payload)),
        Err(LogError::Failed { .. })
    ));
    // The last error names the reason as well.
    let last = writer.flush().unwrap_err();
    assert!(matches!(&last, LogError::Failed { offset: at, .. } if *at == offset));
    assert!(last.to_string().contains(&first.to_string()), "{last}");

    let mut recording = Recording::new(writer.out.bytes.as_slice(), "log")
        .unwrap()
        .keep_foreign();
    let mut n = 0;
    while recording.next_record().unwrap().is_some() {
        n += 1;
    }
    assert_eq!(
        n, 154,
        "whole packets of 1292 bytes, behind the head, in 200,000"
    );
    assert!(matches!(recording.end(), Some(End::Truncated { .. })));
}

#[test]
#[ignore = "needs tshark"]
fn wireshark_reads_logs_without_warnings() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.pcapng");
    let config = LogConfig {
        metadata: "device = \"sim\"".to_owned(),
        drive: Some(DriveLink::Usb),
    };
    let records = &a_sweep()[..600];
    let mut writer = LogWriter::create(&path, &config, Overwrite::Refuse).unwrap();
    for record in records {
        writer.write(&record.as_record()).unwrap();
    }
    writer.finish().unwrap();
    let tshark = |arguments: &[&str]| {
        let output = Command::new("tshark")
            .arg("-r")
            .arg(&path)
            .args([
                "-o",
                "ip.check_checksum:TRUE",
                "-o",
                "udp.check_checksum:TRUE",
            ])
            .args(arguments)
            .output()
            .unwrap();
        let complaint = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{complaint}");
        assert!(
            !complaint.contains("damaged") && !complaint.contains("cut short"),
            "{complaint}"
        );
        String::from_utf8(output.stdout).unwrap()
    };
    let times = tshark(&["-T", "fields", "-e", "frame.time_epoch"]);
    let expected: Vec<String> = records
        .iter()
        .map(|record| {
            let ns = record.host().as_nanos();
            format!("{}.{:09}", ns / 1_000_000_000, ns % 1_000_000_000)
        })
        .collect();
    assert_eq!(times.lines().collect::<Vec<_>>(), expected);
    let wrong = "_ws.malformed || ip.checksum.status == 0 || udp.checksum.status == 0";
    assert_eq!(tshark(&["-Y", wrong]), "");
    let sizes = tshark(&[
        "-Y",
        "udp.dstport == 2368 && udp.checksum.status == 1",
        "-T",
        "fields",
        "-e",
        "udp.length",
    ]);
    assert_eq!(sizes.lines().count(), 200);
    assert!(sizes.lines().all(|size| size == "1214"), "{sizes}");
    let outbound = tshark(&["-Y", "frame.packet_flags_direction == 2"]);
    assert_eq!(outbound.lines().count(), 200);
    let names = tshark(&["-T", "fields", "-e", "frame.interface_name"]);
    assert_eq!(
        names.lines().filter(|name| *name == "epos2-usb").count(),
        400
    );
}
