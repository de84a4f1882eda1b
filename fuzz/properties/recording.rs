//! Recordings of any bytes: reading ends with a result, returns no more than the file contains, and
//! counts everything. The result does not depend on how the bytes arrive, and a file that is cut
//! off gives the same result up to the cut.

use std::io::Read;

use io::log::OwnedRecord;
use io::recording::{Recording, RecordingCounts};
use protocol::record::Wire;

/// The shortest record with data: the header of classic pcap.
const SHORTEST_RECORD: usize = 16;

/// Reads the bytes as a file: at once, in small pieces, and without their last quarter.
pub fn holds(data: &[u8]) {
    // Every other input is read with the datagrams of other senders.
    let other_senders = data.len() % 2 == 1;
    let whole = read(data, data.len(), other_senders);
    assert_eq!(read(Pieces(data), data.len(), other_senders), whole);
    let cut = &data[..data.len() - data.len() / 4];
    let cut = read(cut, cut.len(), other_senders);
    // After damage, later bytes influence where reading resumes.
    if let (Ok(whole), Ok(cut)) = (whole, cut)
        && whole.counts.damaged == 0
        && cut.counts.damaged == 0
    {
        assert!(whole.records.starts_with(&cut.records));
    }
}

/// A file that arrives in pieces of a few bytes, as through a pipe.
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

/// The result of reading a recording.
#[derive(Debug, PartialEq)]
struct ReadResult {
    head: String,
    records: Vec<OwnedRecord>,
    end: String,
    counts: RecordingCounts,
}

/// Reads a file of `size` bytes, or returns why it is not a recording.
fn read(file: impl Read, size: usize, other_senders: bool) -> Result<ReadResult, String> {
    let mut recording = Recording::new(file, "fuzz").map_err(|error| error.to_string())?;
    if other_senders {
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
    add_up(&counts, &records, size, other_senders);
    let end = recording.end().expect("it ended").to_string();
    Ok(ReadResult {
        head,
        records,
        end,
        counts,
    })
}

fn add_up(counts: &RecordingCounts, records: &[OwnedRecord], size: usize, other_senders: bool) {
    let (datagrams, driven) = (counts.datagrams, counts.drive);
    let kinds = [
        datagrams,
        driven,
        counts.other,
        counts.fragments,
        counts.joined,
        counts.malformed,
    ];
    assert_eq!(kinds.iter().sum::<u64>(), counts.records, "{counts:?}");
    assert!(counts.damaged + counts.snapped <= counts.malformed);
    assert!(counts.damaged_bytes <= size as u64);
    assert_eq!(counts.malformed > 0, counts.first_malformed.is_some());
    let is_lidar = |record: &&OwnedRecord| matches!(record.as_record().wire, Wire::Lidar { .. });
    let yielded = records.iter().filter(is_lidar).count() as u64;
    assert_eq!(records.len() as u64 - yielded, driven);
    if other_senders {
        assert!((datagrams..=datagrams + counts.other).contains(&yielded));
    } else {
        assert_eq!(yielded, datagrams);
    }
}
