//! Reads the positions of clouds.
//!
//! The formats of [`crate::formats`], as written here and by other programs: PLY and PCD as text or
//! binary in any layout of columns, LAS and LAZ of every version of the `las` crate, E57,
//! PointCloud2 in MCAP, text with a row per point, KITTI. Positions are in metres as in the file;
//! other columns are ignored.

mod csv;
mod e57;
mod kitti;
mod las;
mod mcap;
mod pcd;
mod ply;
mod source;

use crate::formats::Format;

pub use source::{Positions, ReadError};

/// The points of a file.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct CloudPositions {
    /// Positions of the points.
    pub positions: Positions,
    /// Rows left out for a coordinate that is not finite, such as shots without a return in
    /// organised clouds.
    pub without_numbers: u64,
}

/// The positions of a cloud. Rows with a coordinate that is not finite are left out and counted.
///
/// # Errors
/// [`ReadError`] if the bytes are not of the format, or end too early.
pub fn positions(format: Format, bytes: Vec<u8>) -> Result<CloudPositions, ReadError> {
    let mut positions = match format {
        Format::Ply => ply::positions(&bytes),
        Format::Pcd => pcd::positions(&bytes),
        Format::Las | Format::Laz => las::positions(format, bytes),
        Format::E57 => e57::positions(&bytes),
        Format::Mcap => mcap::positions(&bytes),
        Format::Csv | Format::Xyz => csv::positions(format, &bytes),
        Format::Kitti => kitti::positions(&bytes),
    }?;
    let rows = positions.len();
    positions.retain(|position| position.iter().all(|axis| axis.is_finite()));
    Ok(CloudPositions {
        without_numbers: (rows - positions.len()) as u64,
        positions,
    })
}

#[cfg(test)]
mod tests;
