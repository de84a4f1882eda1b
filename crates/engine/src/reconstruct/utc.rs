//! Point times in UTC from the lidar's satellite receiver.
//!
//! Points measured while the lidar's clock was not locked have no UTC; they are omitted and
//! counted.

use cloud::{
    Companion, Diagnostic, Fields, Metadata, Points, Revolution, Sink, SinkError, Summary,
    TiltTrack,
};
use lidar::{Options, Timekeeper, UtcClock};
use protocol::record::{Record, Wire};
use protocol::vlp16::PositionPacket;
use units::Stamp;

/// Tracks the satellite receiver of one lidar through a recording.
pub struct UtcSurvey {
    timekeeper: Timekeeper,
    /// The clock so far.
    pub clock: UtcClock,
}

impl UtcSurvey {
    /// Creates a survey that decodes packets with `options`.
    #[must_use]
    pub fn new(options: Options) -> Self {
        Self {
            timekeeper: Timekeeper::new(options),
            clock: UtcClock::new(),
        }
    }

    /// Processes a lidar record.
    pub fn observe(&mut self, record: &Record<'_>) {
        let Wire::Lidar { payload, .. } = record.wire else {
            return;
        };
        if let Some(timing) = self.timekeeper.packet(record.host, payload) {
            self.clock.data(timing.first_firing);
        } else if let Ok(packet) = PositionPacket::new(payload) {
            self.clock.position(record.host, &packet);
        }
    }
}

/// A sink adapter that converts point times to UTC.
pub struct InUtc<'a> {
    sink: &'a mut dyn Sink,
    clock: UtcClock,
    batch: Points,
    /// Points omitted because the lidar's clock was not locked.
    pub without: u64,
}

impl<'a> InUtc<'a> {
    /// Wraps `sink`.
    pub fn new(sink: &'a mut dyn Sink, clock: UtcClock) -> Self {
        let batch = Points::new(sink.fields());
        Self {
            sink,
            clock,
            batch,
            without: 0,
        }
    }
}

impl Sink for InUtc<'_> {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        self.batch.clear();
        for mut point in batch.iter() {
            let Some(utc) = self.clock.utc(point.device_time) else {
                self.without += 1;
                continue;
            };
            point.time = Stamp::from_nanos(utc.as_nanos());
            self.batch.push(point);
        }
        self.sink.points(&self.batch)
    }

    fn fields(&self) -> Fields {
        self.sink.fields() | Fields::DEVICE_TIME
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), SinkError> {
        self.batch = Points::new(self.sink.fields());
        self.sink.begin(metadata)
    }

    fn wants_tilt(&self) -> bool {
        self.sink.wants_tilt()
    }

    /// Omits tilt samples: they carry host times.
    fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
        self.sink.tilt(&TiltTrack {
            mount: track.mount,
            ..TiltTrack::default()
        })
    }

    fn revolution(&mut self, revolution: &Revolution) -> Result<(), SinkError> {
        self.sink.revolution(revolution)
    }

    fn diagnostics(&mut self, diagnostics: &[Diagnostic]) -> Result<(), SinkError> {
        self.sink.diagnostics(diagnostics)
    }

    fn companion(&self, file_name: &str) -> Option<Companion> {
        self.sink.companion(file_name)
    }

    fn finish(&mut self) -> Result<Summary, SinkError> {
        self.sink.finish()
    }
}
