//! Recordings of any bytes: reading ends, says how, yields no more than the file holds, and counts
//! all of it. How the bytes arrive is no matter, and a file cut off in the middle says the same up
//! to there.

use std::io::Read;

use io::log::OwnedRecord;
use io::recording::{Recording, RecordingCounts};
use protocol::record::Wire;

/// The shortest record that carries anything: classic pcap's header.
const SHORTEST_RECORD: usize = 16;

/// Reads the bytes as a file: at once, in small pieces, and without their last quarter.
pub fn holds(data: &[u8]) {
    // Every other input as a tool that wants the strangers' datagrams, too.
    let strangers = data.len() % 2 == 1;
    let whole = read(data, data.len(), strangers);
    assert_eq!(read(Pieces(data), data.len(), strangers), whole);
    let cut = &data[..data.len() - data.len() / 4];
    let cut = read(cut, cut.len(), strangers);
    // Behind damage, what comes later helps to find where to go on.
    if let (Ok(whole), Ok(cut)) = (whole, cut)
        && whole.counts.damaged == 0
        && cut.counts.damaged == 0
    {
        assert!(whole.records.starts_with(&cut.records));
    }
}

/// A file that comes a few bytes at a time, as through a pipe.
struct Pieces<'a>(&'a [u8]);

impl Read for Pieces<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let len = (self.0.len() % 61 + 1).min(buffer.len()).min(self.0.len());
        let (now, later) = self.0.split_at(len);
        buffer[..len].copy_from_slice(now);
        self.0 = later;
        Ok(len)
    }
}

/// All that a recording says.
#[derive(Debug, PartialEq)]
struct Said {
    head: String,
    records: Vec<OwnedRecord>,
    end: String,
    counts: RecordingCounts,
}

/// Reads a file of `size` bytes, or says why it is no recording.
fn read(file: impl Read, size: usize, strangers: bool) -> Result<Said, String> {
    let mut recording = Recording::new(file, "fuzz").map_err(|error| error.to_string())?;
    if strangers {
        recording = recording.keep_foreign();
    }
    let head = format!("{:?}", recording.metadata());
    let mut records = Vec::new();
    while let Some(record) = recording.next_record().expect("memory can be read") {
        let (Wire::Lidar { payload: bytes, .. } | Wire::Drive { frame: bytes, .. }) = record.wire;
        assert!(bytes.len() <= size, "{} bytes of {size}", bytes.len());
        records.push(OwnedRecord::from(&record));
        assert!(records.len() <= size / SHORTEST_RECORD);
    }
    assert!(matches!(recording.next_record(), Ok(None)), "it goes on");
    let counts = recording.counts().clone();
    add_up(&counts, &records, size, strangers);
    let end = recording.end().expect("it ended").to_string();
    Ok(Said {
        head,
        records,
        end,
        counts,
    })
}

fn add_up(counts: &RecordingCounts, records: &[OwnedRecord], size: usize, strangers: bool) {
    let datagrams = counts.datagrams.values().sum::<u64>() + counts.more_datagrams;
    let driven = counts.to_drive + counts.from_drive;
    let kinds = [
        datagrams,
        driven,
        counts.other,
        counts.fragments,
        counts.joined,
        counts.malformed,
    ];
    assert_eq!(kinds.iter().sum::<u64>(), counts.records, "{counts:?}");
    assert!(counts.damaged + counts.snapped + counts.timeless <= counts.malformed);
    assert!(counts.damaged_bytes <= size as u64);
    assert_eq!(counts.malformed > 0, counts.first_malformed.is_some());
    assert!(counts.foreign.values().sum::<u64>() <= counts.other);
    let is_lidar = |record: &&OwnedRecord| matches!(record.as_record().wire, Wire::Lidar { .. });
    let yielded = records.iter().filter(is_lidar).count() as u64;
    assert_eq!(records.len() as u64 - yielded, driven);
    if strangers {
        assert!((datagrams..=datagrams + counts.other).contains(&yielded));
    } else {
        assert_eq!(yielded, datagrams);
    }
}
