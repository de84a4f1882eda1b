//! A scan as `sensor_msgs/PointCloud2` messages, one per sweep, for networks and recordings. One
//! message is held at a time.

use std::ops::Range;

use units::{Host, Span, Stamp};

use super::{CloudMessage, CloudMessageError, Frames, frames};
use crate::{EastNorthUp, Fields, Points, Sink, SinkError, Summary, TiltTrack};

const FORMAT: &str = "ros2";
/// Greatest number of points of a message: 23 MB, four seconds of a VLP-16.
pub const MOST_POINTS: u32 = 1 << 20;
/// Greatest duration of a message: the f32 times of its points then have steps of 0.5 us.
pub const MOST_SPAN: Span = Span::from_secs(8);

/// A whole message.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Cloud<'a> {
    /// Encoded message, including the encapsulation header.
    pub bytes: &'a [u8],
    /// Number of points.
    pub points: u32,
    /// Times of the first and the last point.
    pub times: (Stamp<Host>, Stamp<Host>),
}

/// Splits batches into messages. `format` is the name in errors.
pub(crate) struct MessageSplitter {
    format: &'static str,
    frames: Frames,
    /// Whether the caller ends clouds, one per revolution of the lidar; set before the first batch.
    pub(crate) by_revolution: bool,
    /// Axes of georeferenced clouds, in the frame [`frames::MAP`]; set before the first batch.
    pub(crate) east_north_up: Option<EastNorthUp>,
    /// Ends of the sweeps, in order of time.
    sweep_ends: Vec<Stamp<Host>>,
    /// Number of ends that points have passed.
    passed: usize,
    cloud: CloudMessage,
    /// Summary of all batches so far.
    pub(crate) summary: Summary,
}

impl MessageSplitter {
    /// One cloud per sweep, with these columns beside x, y, z, intensity, ring and time, in these
    /// frames.
    pub(crate) fn new(format: &'static str, fields: Fields, frames: Frames) -> Self {
        Self {
            format,
            frames,
            by_revolution: false,
            east_north_up: None,
            sweep_ends: Vec::new(),
            passed: 0,
            cloud: CloudMessage::new(fields),
            summary: Summary::default(),
        }
    }

    /// The columns that batches must have.
    pub(crate) fn fields(&self) -> Fields {
        self.cloud.fields()
    }

    /// Sets the track of the tilt, whose sweeps end clouds.
    pub(crate) fn tilt(&mut self, track: &TiltTrack) {
        if !self.by_revolution {
            self.sweep_ends = track.sweeps.iter().map(|sweep| sweep.1).collect();
        }
    }

    /// Ends a revolution of the lidar.
    pub(crate) fn revolution(
        &mut self,
        take: impl FnOnce(Cloud<'_>) -> Result<(), SinkError>,
    ) -> Result<(), SinkError> {
        match self.by_revolution {
            true => self.end(take),
            false => Ok(()),
        }
    }

    /// Refuses a batch that no message can hold.
    pub(crate) fn check(&self, batch: &Points) -> Result<(), SinkError> {
        batch.fields().require(self.fields())?;
        let most = f64::from(f32::MAX);
        batch.check_coordinates(self.format, most, self.summary.points)
    }

    /// Adds a batch, and passes on complete clouds.
    pub(crate) fn points(
        &mut self,
        batch: &Points,
        take: &mut impl FnMut(Cloud<'_>) -> Result<(), SinkError>,
    ) -> Result<(), SinkError> {
        let batch = &*EastNorthUp::apply(self.east_north_up, batch);
        let mut rows = 0..batch.len();
        while let Some(time) = batch.time().get(rows.start).copied() {
            let end = self.cloud_end(batch.time(), &rows);
            if end == rows.start && self.cloud.points() > 0 {
                self.end(&mut *take)?;
                continue;
            }
            if end == rows.start && self.write_until(time) {
                continue;
            }
            // A point always fits into an empty message.
            let end = end.max(rows.start + 1);
            let frame = match self.east_north_up {
                Some(_) => frames::MAP,
                None => self.frames.of_clouds(),
            };
            let pushed = self.cloud.push(batch, rows.start..end, frame);
            pushed.map_err(|error| self.encoding(error))?;
            rows.start = end;
        }
        self.summary.add(batch.summary());
        Ok(())
    }

    /// Passes on the current cloud, if it has points.
    pub(crate) fn end(
        &mut self,
        take: impl FnOnce(Cloud<'_>) -> Result<(), SinkError>,
    ) -> Result<(), SinkError> {
        let (points, times) = (self.cloud.points(), self.cloud.times());
        if points == 0 {
            return Ok(());
        }
        take(Cloud {
            bytes: self.cloud.finish(),
            points,
            times,
        })
    }

    /// End of those of `rows` that belong to the current cloud.
    fn cloud_end(&self, times: &[Stamp<Host>], rows: &Range<usize>) -> usize {
        let room = MOST_POINTS.saturating_sub(self.cloud.points()) as usize;
        let end = rows.end.min(rows.start.saturating_add(room));
        let part = times.get(rows.start..end).unwrap_or_default();
        let first = match self.cloud.points() {
            0 => part.first().copied(),
            _ => Some(self.cloud.times().0),
        };
        let Some(first) = first else {
            return end;
        };
        let mut latest = first.saturating_add(MOST_SPAN);
        if let Some(sweep_end) = self.sweep_ends.get(self.passed) {
            latest = latest.min(*sweep_end);
        }
        let over = part.iter().position(|time| *time > latest);
        over.map_or(end, |over| rows.start + over)
    }

    /// Advances to the sweep of `time`, or the next one; returns whether a sweep ended.
    fn write_until(&mut self, time: Stamp<Host>) -> bool {
        let before = self.passed;
        let ends = self.sweep_ends.iter().skip(before);
        self.passed += ends.take_while(|end| **end < time).count();
        self.passed > before
    }

    fn encoding(&self, error: CloudMessageError) -> SinkError {
        match error {
            CloudMessageError::Columns(missing) => missing.into(),
            late @ CloudMessageError::Time(_) => SinkError::Encode {
                format: self.format,
                points: self.summary.points,
                source: late.into(),
            },
        }
    }
}

/// Passes each cloud to `take`.
pub struct Clouds<F> {
    take: F,
    cutting: MessageSplitter,
}

impl<F: FnMut(Cloud<'_>) -> Result<(), SinkError>> Clouds<F> {
    /// Clouds with x, y, z, intensity, ring and time, in these frames.
    pub fn new(frames: Frames, take: F) -> Self {
        let cutting = MessageSplitter::new(FORMAT, Fields::NONE, frames);
        Self { take, cutting }
    }
}

impl<F: FnMut(Cloud<'_>) -> Result<(), SinkError>> Sink for Clouds<F> {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        self.cutting.check(batch)?;
        self.cutting.points(batch, &mut self.take)
    }

    fn fields(&self) -> Fields {
        self.cutting.fields()
    }

    fn wants_tilt(&self) -> bool {
        true
    }

    fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
        self.cutting.tilt(track);
        Ok(())
    }

    fn finish(&mut self) -> Result<Summary, SinkError> {
        self.cutting.end(&mut self.take)?;
        Ok(self.cutting.summary)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use crate::mount::Mount;
    use mcap::MessageStream;
    use units::{Degrees, Metres};

    use super::*;
    use crate::formats::mcap::McapWriter;
    use crate::tests::samples::{self, NOW_NS, metadata};

    /// Two sweeps, and points before, in, between and after them.
    fn track() -> TiltTrack {
        let at = |ms: i64| Stamp::from_nanos(NOW_NS + ms * 1_000_000);
        TiltTrack {
            mount: Some(Mount::new(Metres(0.06))),
            samples: vec![(at(0), Degrees(0.0)), (at(9), Degrees(-9.0))],
            sweeps: vec![(at(1), at(3)), (at(4), at(6))],
        }
    }

    fn feed(sink: &mut dyn Sink, batch: usize) {
        let cloud = samples::cloud_from(2000, NOW_NS);
        sink.begin(&metadata()).unwrap();
        sink.tilt(&track()).unwrap();
        let mut part = Points::new(cloud.fields());
        for (number, point) in cloud.iter().enumerate() {
            part.push(point);
            if (number + 1) % batch == 0 {
                sink.points(&part).unwrap();
                part = Points::new(cloud.fields());
            }
        }
        sink.points(&part).unwrap();
        assert_eq!(sink.finish().unwrap().points, 2000);
    }

    /// The messages equal those of a recording, bit for bit, for any batches.
    #[test]
    fn clouds_equal_those_of_a_recording() {
        let mut writer = McapWriter::new(Cursor::new(Vec::new()), Fields::FILE);
        feed(&mut writer, 100);
        let bytes = writer.into_inner().unwrap().into_inner();
        let recorded: Vec<Vec<u8>> = MessageStream::new(&bytes)
            .unwrap()
            .map(Result::unwrap)
            .filter(|message| message.channel.topic == "/velomotion/points")
            .map(|message| message.data.to_vec())
            .collect();
        assert!(recorded.len() > 1, "{} clouds", recorded.len());
        for batch in [1, 7, 5000] {
            let mut sent = Vec::new();
            let mut points = 0;
            let mut sink = Clouds::new(Frames::default(), |cloud| {
                sent.push(cloud.bytes.to_vec());
                points += cloud.points;
                Ok(())
            });
            feed(&mut sink, batch);
            drop(sink);
            assert_eq!(sent, recorded, "{batch}");
            assert_eq!(points, 2000);
        }
    }

    #[test]
    fn an_error_of_the_receiver_ends_the_stream() {
        let mut sink = Clouds::new(Frames::default(), |_| {
            Err(SinkError::Order {
                format: FORMAT,
                expected: "a reader",
                got: "none",
            })
        });
        sink.points(&samples::cloud_from(10, NOW_NS)).unwrap();
        assert!(sink.finish().is_err());
    }
}
