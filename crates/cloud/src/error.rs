//! Why a sink could not take points.

use std::error::Error;
use std::io;

use crate::MissingColumns;

/// Why a sink could not take points.
#[derive(Debug, thiserror::Error)]
pub enum SinkError {
    /// The output refused bytes (disk full, pipe closed, ...).
    #[error("{format}: writing failed after {points} points: {source}")]
    Write {
        /// The format being written.
        format: &'static str,
        /// Points written whole before it.
        points: u64,
        /// What the output said.
        source: io::Error,
    },
    /// The format's own library refused.
    #[error("{format}: encoding failed after {points} points: {source}")]
    Encode {
        /// The format being written.
        format: &'static str,
        /// Points written whole before it.
        points: u64,
        /// What the library said.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A batch lacks a column that the sink asked for.
    #[error(transparent)]
    Columns(#[from] MissingColumns),
    /// A coordinate that the format cannot hold.
    #[error(
        "{format}: {axis} of point {point} is {got_m} m, expected a number within +-{limit_m} m"
    )]
    Coordinate {
        /// The format being written.
        format: &'static str,
        /// Which coordinate.
        axis: char,
        /// Index of the point among all that the sink was given.
        point: u64,
        /// The coordinate.
        got_m: f64,
        /// The greatest magnitude that fits.
        limit_m: f64,
    },
    /// Calls in the wrong order: begin, then points, then finish.
    #[error("{format}: expected {expected}, got {got}")]
    Order {
        /// The format being written.
        format: &'static str,
        /// What may come.
        expected: &'static str,
        /// What came.
        got: &'static str,
    },
    /// A sink of another kind failed.
    #[error(transparent)]
    Other(Box<dyn Error + Send + Sync>),
}
