//! Errors of the reconstruction.

use thiserror::Error;
use units::{Degrees, GearingError, Span};

use crate::angles::AngleTableError;
use crate::tolerance::UnreachableTolerance;

/// Reason why no scan could be made of the records.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ScanError {
    /// No lidar data packet.
    #[error("no lidar data packet: expected UDP payloads of 1206 bytes, got none")]
    NoLidarPackets,
    /// The log holds no tilt angles.
    #[error("no tilt angle: expected answers of the tilt drive in the log, got none")]
    NoTilt,
    /// The drive made none of the planned sweeps.
    #[error(
        "no sweep: the drive's traffic holds no move from one end of the plan towards the other"
    )]
    NoSweep,
    /// The log holds no positions of the sweeps.
    #[error(
        "no positions of the sweep from {:.3} to {:.3} deg: expected answers of the drive while the axis moved, got none", from.0, to.0
    )]
    UnseenSweep {
        /// Angle at which it began.
        from: Degrees,
        /// Angle at which it ended.
        to: Degrees,
    },
    /// The axis moved, but the log lacks the target.
    #[error(
        "no sweep: the axis moved from {:.3} to {:.3} deg, not to the end of the plan, and the log lacks the target of the move", from.0, to.0
    )]
    AmbiguousMotion {
        /// Angle at which it began.
        from: Degrees,
        /// Angle at which it ended.
        to: Degrees,
    },
    /// The plan of the log begins once more after its last sweep: the log holds several scans.
    #[error(
        "more sweeps than the log's configuration plans: after the last one another goes from {:.3} to {:.3} deg", from.0, to.0
    )]
    SurplusSweep {
        /// Angle at which it began.
        from: Degrees,
        /// Angle at which it ended.
        to: Degrees,
    },
    /// The host's clock was set by hours in mid-sweep, while nothing was recorded.
    #[error(
        "the recording is silent for {:.1} s in a sweep, at {:.3} deg, but the axis moved on as far as in {:.1} s: the host's clock was set by hours meanwhile", silence.as_secs_f64(), at.0, motion.as_secs_f64()
    )]
    SetByHours {
        /// Angle before the silence.
        at: Degrees,
        /// Its length.
        silence: Span,
        /// Time that the axis needed for the way between.
        motion: Span,
    },
    /// The table of angles is unusable.
    #[error(transparent)]
    Table(#[from] AngleTableError),
    /// A tolerance that no method meets for this recording.
    #[error("{0}")]
    UnreachableTolerance(UnreachableTolerance),
    /// A tolerance for angles of unknown accuracy.
    #[error(
        "a tolerance was requested, but the tilt angles are not of the log: nothing says how accurate they are"
    )]
    NoBound,
    /// A gearing with a zero.
    #[error("gearing: {0}")]
    Gearing(#[from] GearingError),
}
