//! Parts of the writers of all formats but MCAP: the order of calls, the number of points, and
//! errors that name the format.

use std::error::Error;
use std::io;

use super::stage::Stage;
use crate::{
    Companion, EastNorthUp, Fields, Metadata, Points, Sink, SinkError, Summary, TiltTrack,
};

/// Encodes a file. [`FileSink`] calls it in the order begin, points (any number), finish.
pub trait FormatEncoder {
    /// Name of the format in errors.
    fn format(&self) -> &'static str;

    /// Greatest magnitude of a coordinate in metres; `None` if the format holds any.
    fn limit_m(&self) -> Option<f64> {
        None
    }

    /// Columns that the file does not have but that its values follow from, such as those of the
    /// return numbers of LAS.
    fn extra_columns(&self) -> Fields {
        Fields::NONE
    }

    /// Writes the header. It must contain `metadata.lines()` as plain text, such as comments:
    /// `velomotion view` finds the mark SIMULATED and the frame there. A format without a header
    /// has them in its companion.
    ///
    /// # Errors
    /// [`EncodeError`] if the output or the library fails.
    fn begin(&mut self, metadata: &Metadata) -> Result<(), EncodeError>;

    /// Like [`Sink::wants_tilt`].
    fn wants_tilt(&self) -> bool {
        false
    }

    /// Takes the track of the tilt, before the first batch.
    fn tilt(&mut self, track: &TiltTrack) {
        let _ = track;
    }

    /// Whether the file has a pose for its points, which then stay in the scanner's axes.
    fn has_pose(&self) -> bool {
        false
    }

    /// Writes a batch that has the columns.
    ///
    /// # Errors
    /// [`EncodeError`] if the output or the library fails; no batch follows.
    fn points(&mut self, batch: &Points) -> Result<(), EncodeError>;

    /// Completes the file.
    ///
    /// # Errors
    /// [`EncodeError`] if the output or the library fails.
    fn finish(&mut self, summary: &Summary) -> Result<(), EncodeError>;

    /// Like [`Sink::companion`].
    fn companion(&self, file_name: &str) -> Option<Companion> {
        let _ = file_name;
        None
    }
}

/// Failure of an encoder.
#[derive(Debug)]
pub enum EncodeError {
    /// The output refused bytes.
    Output(io::Error),
    /// The library of the format failed.
    Library(Box<dyn Error + Send + Sync>),
}

impl From<io::Error> for EncodeError {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

impl EncodeError {
    pub(super) fn library(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Library(error.into())
    }

    /// The error after `points` whole points.
    pub(super) fn into_sink_error(self, points: u64, format: &'static str) -> SinkError {
        match self {
            Self::Output(source) => SinkError::Write {
                format,
                points,
                source,
            },
            Self::Library(source) => SinkError::Encode {
                format,
                points,
                source,
            },
        }
    }
}

/// Writes a file by a [`FormatEncoder`].
#[derive(Debug)]
pub struct FileSink<E> {
    pub(super) encoder: E,
    fields: Fields,
    east_north_up: Option<EastNorthUp>,
    stage: Stage,
    summary: Summary,
}

impl<E: FormatEncoder> FileSink<E> {
    /// A file with the columns `fields`.
    pub(super) fn of(encoder: E, fields: Fields) -> Self {
        Self {
            encoder,
            fields,
            east_north_up: None,
            stage: Stage::default(),
            summary: Summary::default(),
        }
    }

    fn error(&self, error: EncodeError) -> SinkError {
        error.into_sink_error(self.summary.points, self.encoder.format())
    }
}

/// After a failed batch, [`Sink::finish`] still completes a file of the batches before it, if the
/// format can.
impl<E: FormatEncoder> Sink for FileSink<E> {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        let format = self.encoder.format();
        self.stage.points(format)?;
        batch.fields().require(self.fields)?;
        let placed = &*EastNorthUp::apply(self.east_north_up, batch);
        let batch = if self.encoder.has_pose() {
            batch
        } else {
            placed
        };
        if let Some(limit_m) = self.encoder.limit_m() {
            batch.check_coordinates(format, limit_m, self.summary.points)?;
        }
        if let Err(fault) = self.encoder.points(batch) {
            self.stage = Stage::Cut;
            return Err(self.error(fault));
        }
        self.summary.add(placed.summary());
        Ok(())
    }

    fn fields(&self) -> Fields {
        self.fields | self.encoder.extra_columns()
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), SinkError> {
        self.stage.begin(self.encoder.format())?;
        let begun = self.encoder.begin(metadata);
        begun.map_err(|fault| self.error(fault))?;
        self.east_north_up = metadata.east_north_up;
        self.stage = Stage::Open;
        Ok(())
    }

    fn wants_tilt(&self) -> bool {
        self.encoder.wants_tilt()
    }

    fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
        self.stage.points(self.encoder.format())?;
        self.encoder.tilt(track);
        Ok(())
    }

    fn finish(&mut self) -> Result<Summary, SinkError> {
        self.stage.finish(self.encoder.format())?;
        let finished = self.encoder.finish(&self.summary);
        finished.map_err(|fault| self.error(fault))?;
        Ok(self.summary)
    }

    fn companion(&self, file_name: &str) -> Option<Companion> {
        self.encoder.companion(file_name)
    }
}
