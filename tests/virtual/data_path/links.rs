//! The same scan over every attachment of the drive.

use sim::Attachment;
use velomotion_tests::capture::{Captured, Setting};

const WAYS: [Attachment; 4] = [
    Attachment::Usb,
    Attachment::Rs232,
    Attachment::Slcan,
    Attachment::Can,
];

#[test]
fn the_default_scan_is_accurate_over_every_drive_link() {
    for attached in WAYS {
        let captured = Captured::new(Setting::over(attached));
        let (scan, cloud) = captured.scan();
        let error = captured.error();
        println!(
            "{attached:?}: {} samples, rms {:.2} mm, worst {:.2} mm, angle rms {:?}",
            scan.contents.tilt.map_or(0, |tilt| tilt.samples),
            error.rms_m * 1e3,
            error.worst_m * 1e3,
            scan.sync.angle_rms_deg
        );
        assert!(
            cloud.len() > 180_000,
            "{attached:?}: {} points",
            cloud.len()
        );
        assert_eq!((error.unmatched, error.not_finite), (0, 0), "{attached:?}");
        assert!(
            error.rms_m < 2e-3 && error.worst_m < 10e-3,
            "{attached:?}: {error:?}"
        );
        assert!(captured.brake_is_set(), "{attached:?}");
    }
}

/// The log of every attachment replays to the same bytes.
#[test]
fn replay_is_bit_identical_over_every_drive_link() {
    for attached in WAYS {
        let captured = Captured::new(Setting::over(attached));
        let read = |name| std::fs::read(captured.cloud_file(name)).unwrap();
        assert!(read("first.ply") == read("second.ply"), "{attached:?}");
    }
}
