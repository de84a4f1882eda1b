//! Inputs that fuzzing found, run through the same properties on stable Rust: `inputs/TARGET/NAME`,
//! one file per input.
//!
//! The properties are those of the fuzz targets (`fuzz/properties`). Further tests show that they
//! check something: a successful session gives samples, and packets of a sensor give firings.

#[path = "../../fuzz/properties/mod.rs"]
mod properties;

use std::fs;
use std::path::{Path, PathBuf};

use properties::input::Input;

/// A target and its property.
type Target = (&'static str, fn(&[u8]));

const TARGETS: [Target; 6] = [
    ("recording", properties::recording::holds),
    ("sdo", properties::sdo::holds),
    ("serial_frame", properties::serial_frame::holds),
    ("slcan", properties::slcan::holds),
    ("vlp16_data", |data| {
        properties::vlp16_data::holds(data);
    }),
    ("vlp16_position", properties::vlp16_position::holds),
];

fn inputs(target: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("virtual/fuzz_regressions/inputs");
    let Ok(directory) = fs::read_dir(root.join(target)) else {
        return Vec::new();
    };
    let mut paths: Vec<_> = directory.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

#[test]
fn inputs_that_once_failed_pass() {
    let mut run = 0;
    for (target, holds) in TARGETS {
        // The empty input is valid, too.
        holds(&[]);
        for path in inputs(target) {
            let data = fs::read(&path).unwrap();
            // Names the input of a failure.
            println!("{}", path.display());
            holds(&data);
            run += 1;
        }
    }
    let stored =
        fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("virtual/fuzz_regressions/inputs"));
    let stored: usize = stored
        .unwrap()
        .map(|target| fs::read_dir(target.unwrap().path()).unwrap().count())
        .sum();
    assert_eq!(run, stored, "inputs of an unknown target");
    assert!(run > 0);
}

#[test]
fn an_undisturbed_client_samples_on_each_link() {
    // Connect, home at the current position, sweep: steps of `properties::drive_link`.
    let script = [3, 0, 0, 2, 60, 3, 0, 1, 2, 40, 3, 8, 3, 2, 60];
    // With the shaft's own positions, and with one position per poll.
    for link in [0, 1, 2, 0x80, 0x81, 0x82] {
        let bytes = [&[link], &script[..]].concat();
        let samples = properties::drive_link::holds(&mut Input::new(&bytes));
        assert!(samples > 50, "link {link}: {samples} samples");
    }
}

#[test]
fn packets_of_a_sensor_give_firings() {
    // Host and device at 0, then 50 packets in time: 24 firings each.
    let script = [0; 8 + 4 + 1 + 50];
    assert_eq!(properties::vlp16_data::holds(&script), 50 * 24);
}
