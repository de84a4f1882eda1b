//! UDP payloads in memory to tilted points in memory: points per second on one core, next to the
//! limit of memory bandwidth.
//!
//! `cargo bench -p velomotion-scanner --bench fast_path [-- --runs N --only LINE]`
//!
//! Points have x, y, z, intensity, ring, time and tilt: 42 bytes. The platform swings at 56.25
//! deg/s, its angle is polled every millisecond. Every line is the minimum time of all runs and the
//! spread up to their median; lines of one table are measured alternately, so that other load
//! affects them equally.
#![expect(clippy::unwrap_used, reason = "a bench of recordings")]

mod common;

use std::hint::black_box;

use cloud::{Fields, Points, Sink, SinkError};
use common::{RECORDINGS, Recording, Timing};
use drive::record::Wire;
use lidar::{Decoder, Options};
use scanner::Alignment;

/// x, y, z, time and tilt of 8 bytes, intensity and ring of one.
const BYTES_PER_POINT: usize = 5 * 8 + 2;
const BATCH: usize = 1 << 12;

/// Counts points.
#[derive(Default)]
struct Count(usize);

impl Sink for Count {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        self.0 += black_box(batch).len();
        Ok(())
    }

    fn fields(&self) -> Fields {
        Fields::FILE
    }
}

fn main() {
    let runs = argument("--runs")
        .and_then(|n| n.parse().ok())
        .unwrap_or(60);
    let only = argument("--only").unwrap_or_default();
    for name in RECORDINGS {
        table(&Recording::read_whole(name), runs, &only);
    }
}

fn argument(name: &str) -> Option<String> {
    std::env::args().skip_while(|word| word != name).nth(1)
}

fn table(recording: &Recording, runs: usize, only: &str) {
    let (tilting, at_rest) = (recording.tilting(), recording.at_rest());
    let mut count = Count::default();
    place(recording, &tilting, &mut count);
    let points = count.0;
    println!("\n{}: {points} points", recording.name);
    let mut cloud = Points::with_capacity(Fields::FILE, points);
    let mut slow = Points::with_capacity(Fields::FILE, BATCH);
    let mut small = Columns::new(BATCH);
    let mut whole = Columns::new(points);
    let (from, mut copied) = (Columns::new(BATCH), Columns::new(points));
    let rows: [(&str, &mut dyn FnMut()); 8] = [
        ("decode blocks alone", &mut || {
            black_box(decode(recording));
        }),
        ("bytes to tilted points, in batches", &mut || {
            place(recording, &tilting, &mut Count::default());
        }),
        ("the same, platform at rest", &mut || {
            place(recording, &at_rest, &mut Count::default());
        }),
        ("bytes to tilted points, one cloud", &mut || {
            cloud.clear();
            place(recording, &tilting, &mut cloud);
        }),
        ("one by one, in batches", &mut || {
            one_by_one(recording, &tilting, &mut slow);
        }),
        ("writing such columns, in batches", &mut || {
            for _ in 0..points / BATCH {
                small.write();
            }
        }),
        ("writing such columns, one cloud", &mut || whole.write()),
        ("copying such columns, batch to cloud", &mut || {
            copied.copy_from(&from);
        }),
    ];
    println!(
        "{:<40}{:>10}{:>12}{:>10}{:>10}",
        "", "Mpts/s", "ns/point", "spread", "GB/s"
    );
    let selected = rows.into_iter().filter(|(name, _)| name.contains(only));
    let (names, mut work): (Vec<_>, Vec<_>) = selected.unzip();
    for (name, timing) in names.iter().zip(Timing::in_turns(runs, &mut work)) {
        let ns = timing.least() * 1e9 / points as f64;
        println!(
            "{name:<40}{:>10.1}{ns:>12.2}{:>9.0}%{:>10.1}",
            1e3 / ns,
            (timing.quantile(0.5) / timing.least() - 1.0) * 100.0,
            BYTES_PER_POINT as f64 / ns,
        );
    }
}

/// The second pass.
fn place(recording: &Recording, alignment: &Alignment, sink: &mut dyn Sink) {
    let options = Options::default();
    black_box(scanner::place(recording.records(), alignment, options, sink).unwrap());
}

fn decode(recording: &Recording) -> u64 {
    let mut decoder = Decoder::new(Options::default());
    let mut blocks = 0;
    for record in recording.records() {
        if let Wire::Lidar { payload, .. } = record.wire {
            decoder.decode_blocks(record.host, payload, &mut |block| {
                black_box(block);
                blocks += 1;
            });
        }
    }
    blocks
}

/// The definition, point by point.
fn one_by_one(recording: &Recording, alignment: &Alignment, batch: &mut Points) {
    let mut decoder = Decoder::new(Options::default());
    for record in recording.records() {
        let Wire::Lidar { payload, .. } = record.wire else {
            continue;
        };
        decoder.packet(record.host, payload, &mut |firing| {
            for point in firing.points().filter_map(|point| alignment.place(&point)) {
                batch.push(point);
            }
        });
        if batch.len() >= BATCH {
            black_box(&batch);
            batch.clear();
        }
    }
}

/// Columns of points, written without computation.
struct Columns {
    wide: [Vec<f64>; 5],
    narrow: [Vec<u8>; 2],
    value: u8,
}

impl Columns {
    fn new(rows: usize) -> Self {
        Self {
            wide: [(); 5].map(|()| vec![0.0; rows]),
            narrow: [(); 2].map(|()| vec![0; rows]),
            value: 0,
        }
    }

    /// Thirty-two rows of every column at a time.
    fn write(&mut self) {
        self.value = self.value.wrapping_add(1);
        let value = black_box(self.value);
        for row in (0..self.wide[0].len()).step_by(32) {
            for column in &mut self.wide {
                let end = column.len().min(row + 32);
                column[row..end].fill(f64::from(value));
            }
            for column in &mut self.narrow {
                let end = column.len().min(row + 32);
                column[row..end].fill(value);
            }
        }
        black_box(&self.wide);
        black_box(&self.narrow);
    }

    fn copy_from(&mut self, batch: &Self) {
        let rows = batch.wide[0].len();
        for row in (0..self.wide[0].len()).step_by(rows) {
            for (to, from) in self.wide.iter_mut().zip(&batch.wide) {
                let end = to.len().min(row + rows);
                to[row..end].copy_from_slice(&from[..end - row]);
            }
            for (to, from) in self.narrow.iter_mut().zip(&batch.narrow) {
                let end = to.len().min(row + rows);
                to[row..end].copy_from_slice(&from[..end - row]);
            }
        }
        black_box(&self.wide);
    }
}
