//! E57, by the `e57` crate: every cloud of the file, at its pose.

use std::io::Cursor;

use e57::{CartesianCoordinate, E57Reader, Error};

use super::source::{Positions, ReadError};
use crate::formats::Format;

pub(super) fn positions(bytes: &[u8]) -> Result<Positions, ReadError> {
    let wrong = |error: Error| ReadError {
        format: Format::E57,
        offset: 0,
        expected: "an E57 file".to_owned(),
        got: error.to_string(),
    };
    let mut reader = E57Reader::new(Cursor::new(bytes)).map_err(wrong)?;
    let mut positions = Positions::new();
    for cloud in reader.pointclouds() {
        for point in reader.pointcloud_simple(&cloud).map_err(wrong)? {
            // Directions without a range are shots without a return.
            positions.push(match point.map_err(wrong)?.cartesian {
                CartesianCoordinate::Valid { x, y, z } => [x, y, z],
                _ => [f64::NAN; 3],
            });
        }
    }
    Ok(positions)
}
