//! Several lidars in one recording.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use cloud::{Fields, Points};
use engine::failure::Failure;
use engine::reconstruct::replay::{self, Reconstruction};
use engine::reconstruct::report::ScanReport;
use engine::reconstruct::source::Source;
use io::files::Overwrite;
use io::log::{LogConfig, LogWriter};
use protocol::record::{Record, Wire};
use scanner::TiltSource;
use velomotion_tests::capture::{Captured, Setting};

/// Copies a log and repeats every lidar packet from each of `others`.
fn with_others(log: &Path, others: &[([u8; 4], u16)], to: &Path) {
    let head = LogConfig {
        metadata: String::new(),
        drive: None,
    };
    let mut writer = LogWriter::create(to, &head, Overwrite::Refuse).unwrap();
    let source = Source::open(log, None).unwrap();
    source
        .read_all(|record| {
            let Wire::Lidar { port, payload, .. } = record.wire else {
                return Ok(());
            };
            writer.write(record).unwrap();
            for (source, data_port) in others {
                writer
                    .write(&Record {
                        host: record.host,
                        wire: Wire::Lidar {
                            source: *source,
                            port: if port == 2368 { *data_port } else { port },
                            payload,
                        },
                    })
                    .unwrap();
            }
            Ok(())
        })
        .unwrap();
    writer.finish().unwrap();
}

fn scan(log: &Path, sensor: Option<&str>) -> Result<ScanReport, Failure> {
    let sensor = sensor.map(|name| name.parse().unwrap());
    let request = Reconstruction {
        recording: &Source::open(log, sensor).unwrap(),
        tilt: TiltSource::None,
        options: lidar::Options::default(),
        time: engine::reconstruct::replay::TimeReference::Host,
        accuracy: scanner::Accuracy::Best,
        pace: None,
        truth: None,
        live: false,
        lost_records: 0,
        georeference: None,
        interrupt: &AtomicBool::new(false),
    };
    replay::scan(
        &request,
        &mut Points::new(Fields::NONE),
        Path::new("memory"),
    )
}

#[test]
fn one_of_several_lidars_must_be_selected() {
    let captured = Captured::new(Setting::default());
    let alone = scan(&captured.log(), None).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("several.pcapng");
    let others = [([192, 168, 1, 202], 2368), ([192, 168, 1, 202], 2369)];
    with_others(&captured.log(), &others, &log);

    let refused = scan(&log, None).unwrap_err().to_string();
    for name in [
        "192.168.1.201:2368",
        "192.168.1.202:2368",
        "192.168.1.202:2369",
    ] {
        assert!(refused.contains(name), "{refused}");
    }
    let several = scan(&log, Some("192.168.1.202")).unwrap_err().to_string();
    assert!(several.contains("2 lidars"), "{several}");
    let absent = scan(&log, Some("10.0.0.1")).unwrap_err().to_string();
    assert!(absent.contains("no lidar at 10.0.0.1"), "{absent}");
    for name in ["192.168.1.201", "192.168.1.202:2368", "192.168.1.202:2369"] {
        let one = scan(&log, Some(name)).unwrap();
        assert_eq!(one.points, alone.points, "{name}");
        assert_eq!(one.contents.lost_packets, 0, "{name}");
    }
}
