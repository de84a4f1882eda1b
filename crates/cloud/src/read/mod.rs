//! Reads clouds: positions, and the columns that a file has.
//!
//! The formats of [`crate::formats`], as written here and by other programs: PLY and PCD as text or
//! binary in any layout of columns, LAS and LAZ of every version of the `las` crate, E57,
//! PointCloud2 in MCAP, text with a row per point, KITTI, structured arrays of numpy. Positions are
//! in metres as in the file.

mod csv;
mod e57;
mod kitti;
mod las;
mod mcap;
mod npz;
mod pcd;
mod ply;
mod source;
mod stored_cloud;

use crate::Fields;
use crate::formats::Format;

pub use source::{Positions, ReadError};
pub use stored_cloud::StoredCloud;

/// The positions of a cloud, and those of the columns `wanted` that the file has, under the names
/// of velomotion or usual ones of other programs. The lidar's own times are not read. Rows with a
/// coordinate that is not finite are left out and counted.
///
/// # Errors
/// [`ReadError`] if the bytes are not of the format, or end too early.
pub fn cloud(format: Format, bytes: Vec<u8>, wanted: Fields) -> Result<StoredCloud, ReadError> {
    let mut cloud = StoredCloud::new(wanted);
    match format {
        Format::Ply => ply::read(&bytes, &mut cloud),
        Format::Pcd => pcd::read(&bytes, &mut cloud),
        Format::Las | Format::Laz => las::read(format, bytes, &mut cloud),
        Format::E57 => e57::read(&bytes, &mut cloud),
        Format::Mcap => mcap::read(&bytes, &mut cloud),
        Format::Csv | Format::Xyz => csv::read(format, &bytes, &mut cloud),
        Format::Kitti => kitti::read(&bytes, &mut cloud),
        Format::Npz => npz::read(&bytes, &mut cloud),
    }?;
    Ok(cloud)
}

/// The positions of a cloud, as [`cloud`] reads them without columns.
///
/// # Errors
/// As [`cloud`].
pub fn positions(format: Format, bytes: Vec<u8>) -> Result<StoredCloud, ReadError> {
    cloud(format, bytes, Fields::NONE)
}

#[cfg(test)]
mod tests;
