//! What can be wrong with directions and bins.

use thiserror::Error;

/// How far the length of a direction may be from 1.
pub const UNIT_WITHIN: f64 = 1e-6;

/// Why pairs cannot be counted.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum KError {
    /// No bins, or too many.
    #[error("analysis: k: expected 1 to {} bins, got {got}", super::MOST_BINS)]
    Bins {
        /// Bins asked for.
        got: usize,
    },
    /// Not a direction: not finite, or not of length 1 within [`UNIT_WITHIN`].
    #[error(
        "analysis: k: point {index}: expected a length within {UNIT_WITHIN} of 1, got {length}"
    )]
    NotUnit {
        /// Its place among the points.
        index: usize,
        /// Its length.
        length: f64,
    },
    /// More points than are numbered in 32 bits.
    #[error("analysis: k: expected fewer than 4294967296 points, got {got}")]
    TooMany {
        /// Points given.
        got: usize,
    },
    /// Points that do not make up whole frames, or more frames than are counted.
    #[error(
        "analysis: k: expected whole frames, {} at most, got {points} points in {frames} frames",
        super::MOST_FRAMES
    )]
    Frames {
        /// Points given.
        points: usize,
        /// Frames asked for.
        frames: usize,
    },
    /// A tolerance or a risk that means nothing.
    #[error("analysis: k: expected a {name} above 0 and below 1, got {got}")]
    Wish {
        /// Which of the two.
        name: &'static str,
        /// What was asked for.
        got: f64,
    },
    /// Harmonics of no degree, or of more than are summed.
    #[error(
        "analysis: k: expected harmonics of degree 1 to {}, got {got}",
        super::MOST_DEGREE
    )]
    Degree {
        /// Degree asked for.
        got: usize,
    },
    /// A point is not where the first frame's, turned, would be.
    #[error(
        "analysis: k: point {index} of frame {frame}: expected that of frame 0, turned, within {}, got {off} from it",
        super::TURNED_WITHIN
    )]
    NotTurned {
        /// Its frame, from 0.
        frame: usize,
        /// Its place in the frame.
        index: usize,
        /// How far off it is.
        off: f64,
    },
    /// A pair is nearer than 2^-97 to an edge whose cosine is irrational. No pair of rounded points has been seen to be.
    #[error(
        "analysis: k: directions {first:?} and {second:?}: expected a side of the edge above bin {bin}, got nearer than 2^-97 to it"
    )]
    Undecided {
        /// The bin below the edge, from 0.
        bin: usize,
        /// One direction.
        first: [f64; 3],
        /// The other.
        second: [f64; 3],
    },
}
