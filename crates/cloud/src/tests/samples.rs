//! Shared by the tests of formats: a cloud, metadata, and outputs that store or refuse bytes.

use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex};

use units::{Degrees, Stamp};

use crate::{Fields, Metadata, Point, Points};

/// A second before 2100.
pub const LATE_NS: i64 = 4_102_444_799_000_000_000;

pub fn metadata() -> Metadata {
    Metadata {
        simulated: true,
        source: "VLP-16 on a tilt axis".into(),
        software: "velomotion 0.1.0".into(),
        time_reference: "Unix seconds, host clock".into(),
        dual_return: false,
        sensor_frame: false,
        east_north_up: None,
        comments: vec!["first\nsecond".into()],
    }
}

/// A time that every format can hold: ROS counts seconds until 2038.
pub const NOW_NS: i64 = 1_795_226_733_000_000_000;

/// `count` points over the whole range of a VLP-16, with every column.
pub fn cloud(count: u32) -> Points {
    cloud_from(count, LATE_NS)
}

/// `count` points from `start_ns` on.
pub fn cloud_from(count: u32, start_ns: i64) -> Points {
    let mut points = Points::new(Fields::ALL);
    for i in 0..count {
        let turn = f64::from(i) * 2.399_963;
        let range_m = 1.0 + 99.0 * f64::from(i) / f64::from(count);
        points.push(Point {
            position_m: [
                range_m * turn.sin(),
                range_m * turn.cos(),
                0.25 * range_m * (turn * 7.0).sin(),
            ],
            intensity: (i % 256) as u8,
            ring: (i % 16) as u8,
            laser: (i * 7 % 16) as u8,
            time: Stamp::from_nanos(start_ns + i64::from(i) * 2_304),
            device_time: Stamp::from_nanos(i64::from(i) * 2_304),
            tilt: Degrees(-45.0 + 45.0 * f64::from(i) / f64::from(count)),
            sd_m: 1e-3 * (1.0 + f64::from(i % 9)),
            echo: (i % 5) as u8,
        });
    }
    points
}

/// Bytes that outlive the sink that owns the output.
#[derive(Clone, Default)]
pub struct SharedOutput(Arc<Mutex<Cursor<Vec<u8>>>>);

impl SharedOutput {
    pub fn content(&self) -> Vec<u8> {
        self.0.lock().unwrap().get_ref().clone()
    }
}

impl Write for SharedOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for SharedOutput {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.0.lock().unwrap().read(bytes)
    }
}

impl Seek for SharedOutput {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.lock().unwrap().seek(to)
    }
}

/// A disk of limited size; written bytes can be overwritten.
#[derive(Default)]
pub struct SmallDisk {
    pub file: Cursor<Vec<u8>>,
    pub room: u64,
}

impl SmallDisk {
    pub fn new(room: u64) -> Self {
        Self {
            room,
            ..Self::default()
        }
    }
}

impl Write for SmallDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let left = self.room.saturating_sub(self.file.position());
        let take = bytes.len().min(left as usize);
        if take == 0 && !bytes.is_empty() {
            return Err(io::Error::from(io::ErrorKind::StorageFull));
        }
        self.file.write(&bytes[..take])
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for SmallDisk {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.file.read(bytes)
    }
}

impl Seek for SmallDisk {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}
