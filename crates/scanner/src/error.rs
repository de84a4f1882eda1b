//! Errors of the reconstruction.

use thiserror::Error;
use units::GearingError;

use crate::tolerance::UnreachableTolerance;

/// Why no scan could be made of the records.
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
    /// The table of angles is of another time.
    #[error(
        "the tilt angles cover {table_from_s:.3}..{table_to_s:.3} s, the recording {recording_from_s:.3}..{recording_to_s:.3} s: they do not overlap"
    )]
    TableElsewhere {
        /// First time of the table.
        table_from_s: f64,
        /// Last time of the table.
        table_to_s: f64,
        /// First packet.
        recording_from_s: f64,
        /// Last packet.
        recording_to_s: f64,
    },
    /// A table with fewer than two rows.
    #[error("tilt angles: expected at least two rows of time_s,angle_deg, got {rows}")]
    TableShort {
        /// Rows with numbers.
        rows: usize,
    },
    /// A table with a number out of range.
    #[error("tilt angles: row {row}: expected seconds within +-1e10 and degrees within +-3600")]
    TableRange {
        /// Row, counted from 1 over the rows with numbers.
        row: usize,
    },
    /// A table whose times do not increase.
    #[error("tilt angles: row {row} is not later than the row before it")]
    TableOrder {
        /// Row, counted from 1 over the rows with numbers.
        row: usize,
    },
    /// A tolerance that no method meets for this recording.
    #[error("{0}")]
    UnreachableTolerance(UnreachableTolerance),
    /// A tolerance for angles of unknown accuracy.
    #[error(
        "a tolerance was asked for, but the tilt angles are not of the log: nothing says how accurate they are"
    )]
    NoBound,
    /// A gearing with a zero.
    #[error("gearing: {0}")]
    Gearing(#[from] GearingError),
}
