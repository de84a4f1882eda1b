//! MCAP with ROS 2 messages, by the `mcap` crate: the points of every
//! `sensor_msgs/msg/PointCloud2`, each in the frame of its message; without transforms between
//! frames.

use std::collections::HashSet;

use mcap::McapError;
use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::source::{Positions, ReadError, SourceNumber};
use crate::formats::Format;
use crate::messages::Topic;

/// Bytes before a CDR message; alignment counts from their end.
const ENCAPSULATION: usize = 4;

fn wrong(offset: usize, expected: &str, got: impl ToString) -> ReadError {
    ReadError {
        format: Format::Mcap,
        offset,
        expected: expected.to_owned(),
        got: got.to_string(),
    }
}

/// Greatest size of a chunk or record, relative to the file and absolute: a limit of reserved
/// memory.
const TIMES_LARGER: usize = 256;
const ANY_CASE: usize = 64 << 20;

pub(super) fn positions(bytes: &[u8]) -> Result<Positions, ReadError> {
    let limit = bytes.len().saturating_mul(TIMES_LARGER).max(ANY_CASE);
    let options = LinearReaderOptions::default()
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(limit);
    let mut reader = LinearReader::new_with_options(options);
    let mut clouds = CloudCollector::default();
    let mut rest = bytes;
    while let Some(event) = reader.next_event() {
        let at = bytes.len() - rest.len();
        let bad = |error: McapError| wrong(at, "an MCAP file", error);
        match event.map_err(bad)? {
            LinearReadEvent::ReadRequest(wanted) => {
                let (now, later) = rest.split_at(wanted.min(rest.len()));
                let room = reader.insert(now.len());
                room.iter_mut().zip(now).for_each(|(to, from)| *to = *from);
                reader.notify_read(now.len());
                rest = later;
            }
            LinearReadEvent::Record { data, opcode } => {
                clouds.record(opcode, data, bad)?;
            }
        }
    }
    Ok(clouds.positions)
}

/// Points read so far.
#[derive(Default)]
struct CloudCollector {
    /// Schemas of point clouds.
    schemas: HashSet<u16>,
    /// Channels of point clouds.
    channels: HashSet<u16>,
    positions: Positions,
}

impl CloudCollector {
    fn record(
        &mut self,
        opcode: u8,
        data: &[u8],
        bad: impl Fn(McapError) -> ReadError,
    ) -> Result<(), ReadError> {
        if !matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE) {
            return Ok(());
        }
        match mcap::parse_record(opcode, data).map_err(bad)? {
            Record::Schema { header, .. } if header.name == Topic::Points.message_type().name => {
                self.schemas.insert(header.id);
            }
            Record::Channel(channel)
                if self.schemas.contains(&channel.schema_id)
                    && channel.message_encoding == "cdr" =>
            {
                self.channels.insert(channel.id);
            }
            Record::Message { header, data } if self.channels.contains(&header.channel_id) => {
                cloud(&data, &mut self.positions)?;
            }
            _ => {}
        }
        Ok(())
    }
}

/// Reads a message from its beginning. Offsets of errors are within the message.
struct CdrReader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> CdrReader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], ReadError> {
        let left = self.bytes.get(self.at..).unwrap_or_default();
        let taken = left.get(..count);
        let taken = taken.ok_or_else(|| wrong(self.at, &format!("{count} bytes"), left.len()))?;
        self.at += count;
        Ok(taken)
    }

    fn u8(&mut self) -> Result<u8, ReadError> {
        Ok(self.take(1)?.first().copied().unwrap_or(0))
    }

    fn u32(&mut self) -> Result<usize, ReadError> {
        let padding = (self.at - ENCAPSULATION).next_multiple_of(4) + ENCAPSULATION - self.at;
        self.take(padding)?;
        let bytes = self.take(4)?.first_chunk().copied().unwrap_or_default();
        Ok(u32::from_le_bytes(bytes) as usize)
    }

    /// A sequence of bytes, or a string with its zero.
    fn sequence(&mut self) -> Result<&'a [u8], ReadError> {
        let length = self.u32()?;
        self.take(length)
    }
}

/// Adds the points of a `sensor_msgs/msg/PointCloud2`, finite or not.
fn cloud(message: &[u8], positions: &mut Positions) -> Result<(), ReadError> {
    let mut cdr = CdrReader {
        bytes: message,
        at: 0,
    };
    match cdr.take(ENCAPSULATION)? {
        [0, 1, ..] => {}
        other => return Err(wrong(0, "CDR, little-endian", format!("{other:02x?}"))),
    }
    // Stamp and frame; height and width.
    cdr.u32()?;
    cdr.u32()?;
    cdr.sequence()?;
    cdr.u32()?;
    cdr.u32()?;
    let mut axes: [Option<(usize, SourceNumber)>; 3] = [None; 3];
    for _ in 0..cdr.u32()? {
        let name = cdr.sequence()?;
        let offset = cdr.u32()?;
        let number = match cdr.u8()? {
            7 => Some(SourceNumber::F32),
            8 => Some(SourceNumber::F64),
            _ => None,
        };
        cdr.u32()?;
        let axis = [b"x\0", b"y\0", b"z\0"].iter().position(|it| name == *it);
        if let Some(axis) = axis.and_then(|axis| axes.get_mut(axis)) {
            *axis = number.map(|number| (offset, number));
        }
    }
    let [Some(x), Some(y), Some(z)] = axes else {
        return Err(wrong(
            cdr.at,
            "fields x, y and z of FLOAT32 or FLOAT64",
            "others",
        ));
    };
    let big_endian = cdr.u8()? != 0;
    let point_bytes = cdr.u32()?;
    cdr.u32()?;
    for row in cdr.sequence()?.chunks_exact(point_bytes.max(1)) {
        let read =
            |(offset, number): (usize, SourceNumber)| number.read(row.get(offset..)?, big_endian);
        if let (Some(x), Some(y), Some(z)) = (read(x), read(y), read(z)) {
            positions.push([x, y, z]);
        }
    }
    Ok(())
}
