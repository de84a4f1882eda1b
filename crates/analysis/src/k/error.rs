//! Errors of the K function.

use glam::DVec3;
use thiserror::Error;

/// Tolerance of the length of a direction.
pub const UNIT_WITHIN: f64 = 1e-6;

/// Reason why pairs cannot be counted.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum KError {
    /// No bins, or too many.
    #[error("analysis: k: expected 1 to {} bins, got {got}", super::MOST_BINS)]
    Bins {
        /// Requested number of bins.
        got: usize,
    },
    /// Not a direction: not finite, or not of length 1 within [`UNIT_WITHIN`].
    #[error(
        "analysis: k: point {index}: expected a length within {UNIT_WITHIN} of 1, got {length}"
    )]
    NotUnit {
        /// Index of the point.
        index: usize,
        /// Its length.
        length: f64,
    },
    /// More points than 32 bits can number.
    #[error("analysis: k: expected fewer than 4294967296 points, got {got}")]
    TooMany {
        /// Number of points.
        got: usize,
    },
    /// An incomplete last frame, or too many frames.
    #[error(
        "analysis: k: expected whole frames, {} at most, got {points} points in {frames} frames",
        super::MOST_FRAMES
    )]
    Frames {
        /// Number of points.
        points: usize,
        /// Requested number of frames.
        frames: usize,
    },
    /// A tolerance or a risk out of range.
    #[error("analysis: k: expected a {name} above 0 and below 1, got {got}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// Its value.
        got: f64,
    },
    /// A point off its place in the rotated first frame.
    #[error(
        "analysis: k: point {index} of frame {frame}: expected that of frame 0, turned, within {}, got {off} from it",
        super::TURNED_WITHIN
    )]
    NotTurned {
        /// Its frame, from 0.
        frame: usize,
        /// Its index in the frame.
        index: usize,
        /// Its distance from the expected place.
        off: f64,
    },
    /// A pair nearer than 2^-97 to an edge with an irrational cosine. No pair of rounded points is
    /// known to be.
    #[error(
        "analysis: k: directions {first:?} and {second:?}: expected a side of the edge above bin {bin}, got nearer than 2^-97 to it"
    )]
    Undecided {
        /// The bin below the edge, from 0.
        bin: usize,
        /// One direction.
        first: [f64; 3],
        /// The other direction.
        second: [f64; 3],
    },
}

/// Checks the lengths and the number of directions.
pub(super) fn check(points: &[DVec3]) -> Result<(), KError> {
    if u32::try_from(points.len()).is_err() {
        return Err(KError::TooMany { got: points.len() });
    }
    let is_unit = |p: &DVec3| (p.length() - 1.0).abs() <= UNIT_WITHIN;
    match points.iter().position(|p| !is_unit(p)) {
        None => Ok(()),
        Some(index) => Err(KError::NotUnit {
            index,
            length: points.get(index).map_or(f64::NAN, |p| p.length()),
        }),
    }
}
