//! Errors of sinks.

use std::error::Error;
use std::io;

use crate::MissingColumns;

/// Reason why a sink could not take points.
#[derive(Debug, thiserror::Error)]
pub enum SinkError {
    /// The output refused bytes (disk full, pipe closed, ...).
    #[error("{format}: writing failed after {points} points: {source}")]
    Write {
        /// The format being written.
        format: &'static str,
        /// Points written whole before it.
        points: u64,
        /// Error of the output.
        source: io::Error,
    },
    /// The library of the format failed.
    #[error("{format}: encoding failed after {points} points: {source}")]
    Encode {
        /// The format being written.
        format: &'static str,
        /// Points written whole before it.
        points: u64,
        /// Error of the library.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A batch lacks a column that the sink requested.
    #[error(transparent)]
    Columns(#[from] MissingColumns),
    /// A coordinate that the format cannot hold.
    #[error(
        "{format}: {axis} of point {point} is {got_m} m, expected a number within +-{limit_m} m"
    )]
    Coordinate {
        /// The format being written.
        format: &'static str,
        /// Axis of the coordinate.
        axis: char,
        /// Index of the point among all points of the sink.
        point: u64,
        /// The coordinate.
        got_m: f64,
        /// Greatest magnitude of the format.
        limit_m: f64,
    },
    /// Calls in the wrong order: begin, then points, then finish.
    #[error("{format}: expected {expected}, got {got}")]
    Order {
        /// The format being written.
        format: &'static str,
        /// Expected call.
        expected: &'static str,
        /// Actual call.
        got: &'static str,
    },
    /// Another kind of sink failed.
    #[error(transparent)]
    Other(Box<dyn Error + Send + Sync>),
}
