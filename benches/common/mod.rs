//! Real recordings in memory, and the timing of code.
//!
//! Tests use the cuts of `tests/recordings`. Benchmarks use the whole recordings of
//! `$VELOMOTION_RECORDINGS`, or of `shared/recordings` next to the repository.
#![expect(
    clippy::disallowed_methods,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a bench of recordings"
)]
#![allow(dead_code, reason = "each bench uses a part")]

use std::path::{Path, PathBuf};
use std::time::Instant;

use drive::record::{Record, Wire};
use lidar::Options;
use scanner::{Accuracy, Alignment, AngleTable, ScanConfig, TiltSource};
use units::{Host, Stamp};

/// Ethernet, IPv4 without options, UDP.
const HEADERS: usize = 14 + 20 + 8;
const FILE_HEADER: usize = 24;
const RECORD_HEADER: usize = 16;

pub const RECORDINGS: [&str; 5] = [
    "vlp16-2014-no-factory-bytes.pcap",
    "vlp16-strongest-gps.pcap",
    "vlp16-dual.pcap",
    "hdl32e-strongest.pcap",
    "vlp16-fov-limited-malformed.pcap",
];

/// UDP payloads one after another in memory, with their times.
pub struct Recording {
    pub name: &'static str,
    bytes: Vec<u8>,
    datagrams: Vec<(Stamp<Host>, std::ops::Range<usize>)>,
}

impl Recording {
    /// Reads a cut in `tests/recordings`.
    pub fn read_cut(name: &'static str) -> Self {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/recordings");
        Self::read(Path::new(folder), name)
    }

    /// Reads a whole recording.
    pub fn read_whole(name: &'static str) -> Self {
        let default =
            || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings");
        let folder = std::env::var_os("VELOMOTION_RECORDINGS").map_or_else(default, PathBuf::from);
        Self::read(&folder, name)
    }

    fn read(folder: &Path, name: &'static str) -> Self {
        let path = folder.join(name);
        let bytes =
            std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let mut datagrams = datagrams(&bytes);
        if !datagrams.is_sorted_by_key(|(host, _)| *host) {
            println!("{name}: its times go back; they are taken from the sensor's own clock here");
            restamp(&bytes, &mut datagrams);
        }
        Self {
            name,
            bytes,
            datagrams,
        }
    }

    pub fn records(&self) -> impl Iterator<Item = Record<'_>> {
        self.datagrams.iter().map(|(host, range)| Record {
            host: *host,
            wire: Wire::Lidar {
                source: [0; 4],
                port: 2368,
                payload: &self.bytes[range.clone()],
            },
        })
    }

    /// Clock and angle of a platform that goes from 0 to -45 degrees and back at 56.25 deg/s,
    /// polled every millisecond.
    pub fn tilting(&self) -> Alignment {
        let hosts = || self.datagrams.iter().map(|(host, _)| *host);
        let (from, to) = (hosts().min().unwrap(), hosts().max().unwrap());
        let seconds = (to - from).as_secs_f64();
        let rows = (0..)
            .map(|i| f64::from(i) * 1e-3 - 0.1)
            .take_while(|t| *t < seconds + 0.1)
            .map(|t| (t, swing_deg(t)))
            .collect();
        self.aligned(&TiltSource::Table(AngleTable::new(rows).unwrap()))
    }

    pub fn at_rest(&self) -> Alignment {
        self.aligned(&TiltSource::None)
    }

    fn aligned(&self, tilt: &TiltSource) -> Alignment {
        let (config, options) = (ScanConfig::default(), Options::default());
        scanner::align(self.records(), &config, options, tilt, Accuracy::Best).unwrap()
    }
}

/// 0 to -45 degrees and back at 56.25 deg/s.
fn swing_deg(t: f64) -> f64 {
    let way = (t * 56.25).rem_euclid(90.0);
    -(45.0 - (way - 45.0).abs())
}

/// Datagrams of a classic pcap file in microseconds and this machine's byte order, Ethernet.
fn datagrams(bytes: &[u8]) -> Vec<(Stamp<Host>, std::ops::Range<usize>)> {
    let mut at = FILE_HEADER;
    let mut datagrams = Vec::new();
    let word = |at: usize| -> Option<i64> {
        let word = bytes.get(at..at + 4)?.try_into().ok()?;
        Some(i64::from(u32::from_le_bytes(word)))
    };
    while let (Some(s), Some(us), Some(length)) = (word(at), word(at + 4), word(at + 8)) {
        let start = at + RECORD_HEADER;
        let end = start + length as usize;
        let frame = bytes.get(start..end).unwrap_or_default();
        if frame.get(23) == Some(&17) && frame.len() > HEADERS {
            let host = Stamp::from_nanos((s * 1_000_000 + us) * 1_000);
            datagrams.push((host, start + HEADERS..end));
        }
        at = end;
    }
    datagrams
}

/// Stamps every data packet with its own time.
fn restamp(bytes: &[u8], datagrams: &mut [(Stamp<Host>, std::ops::Range<usize>)]) {
    for (host, range) in datagrams {
        if let [.., a, b, c, d, _, _] = bytes[range.clone()] {
            let us = i64::from(u32::from_le_bytes([a, b, c, d]));
            *host = Stamp::from_nanos(us * 1_000);
        }
    }
}

/// Run times, seconds.
#[derive(Clone, Debug)]
pub struct Timing(Vec<f64>);

impl Timing {
    /// Runs every task once to warm up, and then `runs` times, alternating.
    pub fn in_turns(runs: usize, work: &mut [&mut dyn FnMut()]) -> Vec<Self> {
        for work in work.iter_mut() {
            work();
        }
        let mut timings = vec![Self(Vec::new()); work.len()];
        for _ in 0..runs {
            for (work, timing) in work.iter_mut().zip(&mut timings) {
                let start = Instant::now();
                work();
                timing.0.push(start.elapsed().as_secs_f64());
            }
        }
        for timing in &mut timings {
            timing.0.sort_by(f64::total_cmp);
        }
        timings
    }

    pub fn least(&self) -> f64 {
        self.0[0]
    }

    pub fn quantile(&self, part: f64) -> f64 {
        self.0[((self.0.len() - 1) as f64 * part) as usize]
    }
}
