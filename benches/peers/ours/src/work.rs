//! Measurements of velomotion by name. A pass decodes the recording once and returns the number of
//! points.

use std::hint::black_box;

use cloud::{Fields, Points, Sink, SinkError};
use io::recording::Recording;
use lidar::{Decoder, Options};
use protocol::record::Wire;
use scanner::{Accuracy, Alignment, Placer, ScanConfig, Survey, TiltSource};

use crate::limits::Columns;
use crate::prepare::Packets;

/// Points per batch, as in the program.
const BATCH: usize = 1 << 12;
/// Bytes of a cloud larger than any cache.
const BIG_BYTES: usize = 512 << 20;
/// x, y, z, time and tilt of eight bytes, intensity and ring of one.
pub const POINT_BYTES: usize = 5 * 8 + 2;

/// A recording and the state kept between passes.
pub struct Work {
    path: String,
    packets: Packets,
    tilting: Alignment,
    at_rest: Alignment,
    tilt: TiltSource,
    points: usize,
    cloud: Points,
    big: Option<Points>,
    columns: Columns,
    batch: Columns,
    big_columns: Option<Columns>,
}

/// Counts points only.
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

impl Work {
    /// Surveys the recording.
    pub fn new(path: &str, packets: Packets) -> Self {
        let tilt = packets.tilt();
        let tilting = aligned(&packets, &tilt);
        let mut count = Count::default();
        place(&packets, &tilting, &mut count);
        Self {
            path: path.to_owned(),
            at_rest: aligned(&packets, &TiltSource::None),
            tilting,
            tilt,
            points: count.0,
            cloud: Points::with_capacity(Fields::FILE, count.0),
            big: None,
            columns: Columns::new(count.0),
            batch: Columns::new(BATCH),
            big_columns: None,
            packets,
        }
    }

    /// Does it once.
    pub fn pass(&mut self, name: &str) -> usize {
        match name {
            "blocks" => self.blocks(),
            "sensor, handed on" => self.handed_on(&self.at_rest),
            "tilted, handed on" => self.handed_on(&self.tilting),
            "tilted, one cloud" => {
                self.cloud.clear();
                place(&self.packets, &self.tilting, &mut self.cloud);
                black_box(&self.cloud).len()
            }
            "tilted, one new cloud" => {
                let mut cloud = Points::with_capacity(Fields::FILE, self.points);
                place(&self.packets, &self.tilting, &mut cloud);
                black_box(&cloud).len()
            }
            "tilted, big cloud" => self.big(),
            "file, sensor" => from_file(&self.path, &TiltSource::None),
            "file, tilted" => from_file(&self.path, &self.tilt),
            "write, batch" => {
                for _ in 0..self.points.div_ceil(BATCH) {
                    self.batch.write();
                }
                self.points.div_ceil(BATCH) * BATCH
            }
            "write, cloud" => self.columns.write(),
            "copy, cloud" => self.columns.copy_from(&self.batch),
            "write, big cloud" => self.big_columns().write(),
            "copy, big cloud" => {
                let batch = std::mem::replace(&mut self.batch, Columns::new(0));
                let points = self.big_columns().copy_from(&batch);
                self.batch = batch;
                points
            }
            other => panic!("no such work: {other}"),
        }
    }

    /// Gives back what only big clouds need.
    pub fn rest(&mut self, name: &str) {
        if name.contains("big") {
            self.big = None;
            self.big_columns = None;
        }
    }

    /// Packets taken apart into blocks, no point made.
    fn blocks(&self) -> usize {
        let mut decoder = Decoder::new(Options::default());
        for record in self.packets.records() {
            if let Wire::Lidar { payload, .. } = record.wire {
                decoder.decode_blocks(record.host, payload, &mut |block| {
                    black_box(block);
                });
            }
        }
        self.points
    }

    fn handed_on(&self, alignment: &Alignment) -> usize {
        let mut count = Count::default();
        place(&self.packets, alignment, &mut count);
        count.0
    }

    /// The recording over and over into one cloud.
    fn big(&mut self) -> usize {
        let times = (BIG_BYTES / POINT_BYTES).div_ceil(self.points);
        let room = times * self.points;
        let cloud = self
            .big
            .get_or_insert_with(|| Points::with_capacity(Fields::FILE, room));
        cloud.clear();
        for _ in 0..times {
            place(&self.packets, &self.tilting, cloud);
        }
        black_box(cloud).len()
    }

    fn big_columns(&mut self) -> &mut Columns {
        self.big_columns
            .get_or_insert_with(|| Columns::new(BIG_BYTES / POINT_BYTES))
    }
}

fn aligned(packets: &Packets, tilt: &TiltSource) -> Alignment {
    let config = ScanConfig::default();
    let options = Options::default();
    scanner::align(packets.records(), &config, options, tilt, Accuracy::Best)
        .expect("packets and angles")
}

/// The product's own second pass.
fn place(packets: &Packets, alignment: &Alignment, sink: &mut dyn Sink) {
    let options = Options::default();
    let placed = scanner::place(packets.records(), alignment, options, sink);
    black_box(placed.expect("a sink that takes all"));
}

/// Both passes over a file.
fn from_file(path: &str, tilt: &TiltSource) -> usize {
    let config = ScanConfig::default();
    let mut survey = Survey::new(&config, Options::default()).expect("the usual gearing");
    let mut recording = Recording::open(path).expect("a recording");
    while let Some(record) = recording.next_record().expect("a readable file") {
        survey.observe(&record);
    }
    let alignment = survey
        .solve(&config, tilt, Accuracy::Best)
        .expect("packets and angles");
    let mut count = Count::default();
    let mut placer = Placer::new(&alignment, Options::default(), &mut count);
    let mut recording = Recording::open(path).expect("a recording");
    while let Some(record) = recording.next_record().expect("a readable file") {
        placer.observe(&record).expect("a sink that takes all");
    }
    black_box(placer.finish().expect("a sink that takes all"));
    count.0
}
