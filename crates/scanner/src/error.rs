//! What can keep records from becoming a cloud.

use thiserror::Error;
use units::GearingError;

use crate::tolerance::UnreachableTolerance;

/// Why a scan could not be made of its records.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ScanError {
    /// Not one lidar data packet.
    #[error("no lidar data packet: expected UDP payloads of 1206 bytes, got none")]
    NoLidarPackets,
    /// Tilt was asked of a log that holds none.
    #[error("no tilt angle: expected answers of the tilt drive in the log, got none")]
    NoTilt,
    /// The drive never made one of the planned sweeps.
    #[error(
        "no sweep: the drive's traffic holds no move from one end of the plan towards the other"
    )]
    NoSweep,
    /// The angles given beside the recording are for another time.
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
    /// A table between whose rows nothing lies.
    #[error("tilt angles: expected at least two rows of time_s,angle_deg, got {rows}")]
    TableShort {
        /// Rows with numbers.
        rows: usize,
    },
    /// A table of angles with a number that cannot be.
    #[error("tilt angles: row {row}: expected seconds within +-1e10 and degrees within +-3600")]
    TableRange {
        /// Row, counted from 1 over the rows with numbers.
        row: usize,
    },
    /// A table of angles that goes back in time.
    #[error("tilt angles: row {row} is not later than the row before it")]
    TableOrder {
        /// Row, counted from 1 over the rows with numbers.
        row: usize,
    },
    /// Angles more accurate than any method can tell them from this recording.
    #[error("{0}")]
    UnreachableTolerance(UnreachableTolerance),
    /// An accuracy was asked of angles that nobody says how accurate they are.
    #[error(
        "a tolerance was asked for, but the tilt angles are not of the log: nothing says how accurate they are"
    )]
    NoBound,
    /// A gearing of zeros.
    #[error("gearing: {0}")]
    Gearing(#[from] GearingError),
}
