//! The order of a writer's calls: begin, points, finish.

use crate::SinkError;

/// Progress of a writer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Stage {
    /// Nothing written.
    #[default]
    New,
    /// The header is written; points may follow.
    Open,
    /// A batch failed: no more points, but the batches before it can be completed.
    Cut,
    /// Finished, or the header failed.
    Closed,
}

impl Stage {
    /// Begins. It counts as closed until the header is written, so that a failed header ends the
    /// file.
    pub(super) fn begin(&mut self, format: &'static str) -> Result<(), SinkError> {
        match self {
            Self::New => {
                *self = Self::Closed;
                Ok(())
            }
            Self::Open | Self::Cut => Err(order(format, "points or finish", "begin")),
            Self::Closed => Err(order(format, "nothing more", "begin")),
        }
    }

    pub(super) fn points(self, format: &'static str) -> Result<(), SinkError> {
        match self {
            Self::Open => Ok(()),
            Self::New => Err(order(format, "begin", "points")),
            Self::Cut => Err(order(format, "finish after a failed batch", "points")),
            Self::Closed => Err(order(format, "nothing more", "points")),
        }
    }

    pub(super) fn finish(&mut self, format: &'static str) -> Result<(), SinkError> {
        match self {
            Self::Open | Self::Cut => {
                *self = Self::Closed;
                Ok(())
            }
            Self::New => Err(order(format, "begin", "finish")),
            Self::Closed => Err(order(format, "nothing more", "finish")),
        }
    }
}

fn order(format: &'static str, expected: &'static str, got: &'static str) -> SinkError {
    SinkError::Order {
        format,
        expected,
        got,
    }
}
