//! MCAP with ROS 2 messages, by the `mcap` crate: the points of every
//! `sensor_msgs/msg/PointCloud2`, each in the frame of its message; without transforms between
//! frames. Clouds of velomotion, which are in ROS's axes, are turned back to x right, y forward.
//! Times count from the message's stamp, but for those of 64 bits, as Hesai's and
//! RoboSense's drivers write them.

use std::collections::{HashMap, HashSet};

use mcap::McapError;
use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::source::{ReadError, SourceField, SourceNumber, SourceRow};
use super::stored_cloud::StoredCloud;
use crate::Column;
use crate::formats::Format;
use crate::messages::cdr::{CdrError, CdrReader};

use crate::messages::{Topic, frames, from_ros};

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

pub(super) fn read(bytes: &[u8], cloud: &mut StoredCloud) -> Result<(), ReadError> {
    let limit = bytes.len().saturating_mul(TIMES_LARGER).max(ANY_CASE);
    let options = LinearReaderOptions::default()
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(limit);
    let mut reader = LinearReader::new_with_options(options);
    let mut clouds = CloudCollector {
        schemas: HashSet::new(),
        channels: HashMap::new(),
        cloud,
    };
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
    Ok(())
}

/// Points read so far.
struct CloudCollector<'a> {
    /// Schemas of point clouds.
    schemas: HashSet<u16>,
    /// Channels of point clouds, and whether a scanner of velomotion published them.
    channels: HashMap<u16, bool>,
    cloud: &'a mut StoredCloud,
}

impl CloudCollector<'_> {
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
                // A namespace may precede the name.
                let ours = [Topic::Points, Topic::LivePoints]
                    .iter()
                    .any(|topic| channel.topic.ends_with(topic.name()));
                self.channels.insert(channel.id, ours);
            }
            Record::Message { header, data } => {
                if let Some(ours) = self.channels.get(&header.channel_id) {
                    // The offset is within the message.
                    points(&data, *ours, self.cloud)
                        .map_err(|error| wrong(error.offset, &error.expected, error.got))?;
                }
            }
            _ => {}
        }
        Ok(())
    }
}

/// Adds the points of a `sensor_msgs/msg/PointCloud2`. Those of earlier versions of velomotion are
/// in another frame, and georeferenced ones in [`frames::MAP`]: neither is turned.
fn points(message: &[u8], ours: bool, cloud: &mut StoredCloud) -> Result<(), CdrError> {
    let mut cdr = CdrReader::new(message)?;
    // Stamp and frame; height and width.
    let stamp_s = f64::from(cdr.u32()?) + f64::from(cdr.u32()?) * 1e-9;
    let frame = std::str::from_utf8(cdr.sequence()?).unwrap_or_default();
    // A prefix may precede the name.
    let turned = ours && frame.trim_end_matches('\0').ends_with(frames::ROOT);
    cdr.u32()?;
    cdr.u32()?;
    let mut fields = Vec::new();
    for _ in 0..cdr.u32()? {
        let name = cdr.sequence()?;
        let byte = cdr.u32()? as usize;
        let number = match cdr.u8()? {
            1 => Some(SourceNumber::I8),
            2 => Some(SourceNumber::U8),
            3 => Some(SourceNumber::I16),
            4 => Some(SourceNumber::U16),
            5 => Some(SourceNumber::I32),
            6 => Some(SourceNumber::U32),
            7 => Some(SourceNumber::F32),
            8 => Some(SourceNumber::F64),
            _ => None,
        };
        cdr.u32()?;
        let name = std::str::from_utf8(name)
            .unwrap_or_default()
            .trim_end_matches('\0');
        let field = |number| SourceField {
            word: 0,
            byte,
            number,
        };
        fields.extend(number.map(|number| (name, field(number))));
    }
    let row = SourceRow::of(fields)
        .map_err(|axis| CdrError::new(cdr.offset(), "numbers x, y and z", format!("no {axis}")))?;
    cloud.begin(&row.columns, 0);
    let big_endian = cdr.u8()? != 0;
    let point_bytes = cdr.u32()? as usize;
    cdr.u32()?;
    let time = row.columns.get(Column::Time);
    let start_s = match time.map(|field| field.number) {
        Some(SourceNumber::F64) => 0.0,
        _ => stamp_s,
    };
    for bytes in cdr.sequence()?.chunks_exact(point_bytes.max(1)) {
        let read = |field: SourceField| field.number.read(bytes.get(field.byte..)?, big_endian);
        let position = row.axes.map(|field| read(field).unwrap_or(f64::NAN));
        let position = if turned { from_ros(position) } else { position };
        cloud.push(position, |column| {
            let value = row.columns.value(column, read)?;
            Some(match column {
                Column::Time => start_s + value,
                _ => value,
            })
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Fields;
    use crate::messages::cdr::Cdr;

    /// A message of one point at 1, 2, 3, stamped at a whole second.
    fn message(second: i32, fields: &[(&str, u8, &[u8])]) -> Vec<u8> {
        message_in("lidar", second, fields)
    }

    fn message_in(frame: &str, second: i32, fields: &[(&str, u8, &[u8])]) -> Vec<u8> {
        let mut data: Vec<u8> = [1.0_f32, 2.0, 3.0]
            .iter()
            .flat_map(|axis| axis.to_le_bytes())
            .collect();
        let mut cdr = Cdr::new();
        cdr.i32(second);
        cdr.u32(0);
        cdr.string(frame);
        cdr.u32(1);
        cdr.u32(1);
        cdr.length(3 + fields.len());
        let mut field = |name: &str, offset: usize, datatype: u8| {
            cdr.string(name);
            cdr.u32(offset as u32);
            cdr.u8(datatype);
            cdr.u32(1);
        };
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            field(name, 4 * axis, 7);
        }
        for (name, datatype, bytes) in fields {
            field(name, data.len(), *datatype);
            data.extend(*bytes);
        }
        cdr.u8(0);
        cdr.u32(data.len() as u32);
        cdr.u32(data.len() as u32);
        cdr.length(data.len());
        data.iter().for_each(|byte| cdr.u8(*byte));
        cdr.u8(1);
        cdr.bytes().to_vec()
    }

    fn read(messages: &[Vec<u8>]) -> Vec<(Column, Vec<f32>)> {
        let mut cloud = StoredCloud::new(Fields::ALL);
        for message in messages {
            points(message, false, &mut cloud).unwrap();
        }
        assert_eq!(cloud.positions, vec![[1.0, 2.0, 3.0]; messages.len()]);
        cloud.columns
    }

    /// Velodyne's and Ouster's drivers count from the stamp; Hesai's and RoboSense's do not.
    #[test]
    fn times_of_drivers_are_read() {
        let velodyne = |second, time: f32| message(second, &[("time", 7, &time.to_le_bytes())]);
        let ouster = |second, t: u32| message(second, &[("t", 6, &t.to_le_bytes())]);
        let hesai = |at: f64| message(9, &[("timestamp", 8, &at.to_le_bytes())]);
        for messages in [
            [velodyne(100, 0.5), velodyne(102, 0.0)],
            [ouster(100, 500_000_000), ouster(102, 0)],
            [hesai(1_700_000_000.5), hesai(1_700_000_002.0)],
            // Livox's, in nanoseconds of the sensor.
            [hesai(200_000_000_512.0), hesai(201_500_000_512.0)],
        ] {
            assert_eq!(read(&messages), [(Column::Time, vec![0.0, 1.5])]);
        }
    }

    #[test]
    fn clouds_in_ros_axes_are_turned_back_if_they_are_velomotions() {
        for (frame, ours, expected) in [
            ("left/base_link", true, [-2.0, 1.0, 3.0]),
            ("base_link", false, [1.0, 2.0, 3.0]),
            // Georeferenced: x east, y north.
            ("map", true, [1.0, 2.0, 3.0]),
            // Written before clouds were in ROS's axes.
            ("tilt_base", true, [1.0, 2.0, 3.0]),
        ] {
            let mut cloud = StoredCloud::new(Fields::ALL);
            points(&message_in(frame, 1, &[]), ours, &mut cloud).unwrap();
            assert_eq!(cloud.positions, [expected], "{frame}");
        }
    }

    #[test]
    fn messages_are_joined_by_the_columns_that_all_have() {
        let both = message(1, &[("ring", 4, &[5, 0]), ("intensity", 2, &[200])]);
        let one = message(2, &[("intensity", 7, &0.5_f32.to_le_bytes())]);
        let expected = [(Column::Intensity, vec![200.0, 0.5])];
        assert_eq!(read(&[both.clone(), one]), expected);
        assert_eq!(read(&[both]).len(), 2);
    }
}
