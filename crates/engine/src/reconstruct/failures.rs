//! Failures of a reconstruction, with what to do about them.

use std::path::Path;

use protocol::record::DriveLink;
use scanner::{ScanError, UnreachableTolerance};

use crate::failure::{Failure, Kind};

/// The failure for a scanner error; `link` is that of the drive, if known.
#[must_use]
pub fn scan_failure(path: &Path, link: Option<DriveLink>, error: &ScanError) -> Failure {
    if let ScanError::UnreachableTolerance(out) = error {
        return out_of_reach(path, link, out);
    }
    let help = match error {
        ScanError::NoLidarPackets => {
            "use a recording of the lidar's UDP traffic (ports 2368 and 8308); velomotion info lists what this file holds"
        }
        ScanError::NoTilt => {
            "this is a plain lidar recording: velomotion replay with --tilt none makes a cloud in the sensor's own frame, with --tilt ANGLES.csv a tilted one"
        }
        ScanError::NoSweep => {
            "the recording ended before a sweep began: replay --tilt none gives its points in the sensor's own frame"
        }
        ScanError::UnseenSweep { .. } => {
            "the command alone would place its points: scan again, and see why the drive's link was silent; replay --tilt none gives them in the sensor's own frame"
        }
        ScanError::SurplusSweep { .. } => {
            "a program has joined the logs of several scans: replay each by itself; replay --tilt none gives all points in the sensor's own frame"
        }
        ScanError::SetByHours { .. } => {
            "the lidar's stamps repeat every hour and do not show the true time: correct the host's clock and scan again; replay --tilt none gives the points in the sensor's own frame"
        }
        ScanError::AmbiguousMotion { .. } => {
            "the recorder dropped the command: whether this was a sweep cut short or another move, the log does not show; replay --tilt none gives its points in the sensor's own frame"
        }
        ScanError::Table(_) => {
            "give times as Unix seconds like the recording's, or as seconds since its first packet"
        }
        ScanError::NoBound => "omit --tolerance, or use the angles of the log",
        ScanError::UnreachableTolerance(_) => "ask for less",
        ScanError::Gearing(_) => "correct encoder_lines and gear in the configuration",
    };
    Failure::new(Kind::BadInput, format!("{}: {error}", path.display())).help(help)
}

/// The requested tolerance cannot be met; lists what can.
fn out_of_reach(path: &Path, link: Option<DriveLink>, out: &UnreachableTolerance) -> Failure {
    let mut would = Vec::new();
    if let Some(speed) = out.speed_that_would_do() {
        would.push(format!("sweeps at {:.2} deg/s or slower", speed.0));
    }
    if out.delay_share > 0.5 && link != Some(DriveLink::Can) {
        would.push("a drive link with shorter round trips (CAN)".to_owned());
    }
    let coarser = out.tolerance_that_would_do();
    let mm = format!("{:.6}", coarser.off.0 * 1e3);
    would.push(format!(
        "for this recording --tolerance {}mm@{}m",
        mm.trim_end_matches('0').trim_end_matches('.'),
        coarser.at.0
    ));
    Failure::new(Kind::Incomplete, format!("{}: {out}", path.display())).help(format!(
        "no cloud was made; the recording is unchanged. The bound is that of tilt angle and clock, without the error of the ranges. Alternatives: {}",
        would.join("; ")
    ))
}
