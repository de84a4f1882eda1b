//! Clouds as files: PLY, PCD, LAS/LAZ, E57, MCAP, CSV, XYZ, KITTI and numpy's npz, each a [`Sink`]
//! over a writer.
//!
//! The default columns are intensity, ring, time and tilt ([`Fields::FILE`](crate::Fields::FILE)).
//!
//! | format | positions | time | order of writing |
//! |---|---|---|---|
//! | PLY | f32, within 4 um at 100 m | f64 Unix seconds, within 0.12 us | batch by batch |
//! | PCD | f32, within 4 um at 100 m | f64 Unix seconds, within 0.12 us | batch by batch |
//! | LAS, LAZ | 0.1 mm steps | gps_time within 0.06 us, f64 Unix seconds | batch by batch |
//! | E57 | f32, within 4 um at 100 m | f64 seconds after the start, within 0.01 ns | by a thread |
//! | MCAP | f32, within 4 um at 100 m | stamp, f32 seconds after it within 0.25 us | by time |
//! | CSV, XYZ | exact | exact | batch by batch |
//! | KITTI | f32, within 4 um at 100 m | none | batch by batch |
//! | NPZ | f32, within 4 um at 100 m | f64 Unix seconds, within 0.12 us | batch by batch |

mod csv;
mod e57;
mod fallible;
mod file_sink;
mod gps_time;
pub(crate) mod kitti;
pub(crate) mod las;
mod layout;
pub mod mcap;
pub(crate) mod npz;
pub mod pcd;
pub mod ply;
mod seconds;
mod stage;

use std::fmt;
use std::io::{Read, Seek, Write};
use std::path::Path;

use crate::{Fields, Sink};

/// A file format for clouds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Format {
    /// Binary little-endian PLY.
    Ply,
    /// Binary PCD 0.7.
    Pcd,
    /// LAS 1.4, point format 6.
    Las,
    /// LAS compressed by LASzip.
    Laz,
    /// ASTM E57.
    E57,
    /// MCAP with ROS 2's messages.
    Mcap,
    /// Comma-separated text.
    Csv,
    /// Text with spaces.
    Xyz,
    /// `.bin` of KITTI: position and reflectance alone.
    Kitti,
    /// numpy's `.npz`.
    Npz,
}

/// An extension without a format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no cloud format for {}: expected one of {}", shown(.got), expected())]
#[non_exhaustive]
pub struct UnsupportedFormat {
    /// The extension without its dot; empty if the name has none.
    pub got: String,
}

fn shown(extension: &str) -> String {
    if extension.is_empty() {
        "a name without extension".to_owned()
    } else {
        format!("extension .{extension}")
    }
}

fn expected() -> String {
    Format::ALL.map(|format| format!(".{format}")).join(" ")
}

impl Format {
    /// Every format.
    pub const ALL: [Self; 10] = [
        Self::Ply,
        Self::Pcd,
        Self::Las,
        Self::Laz,
        Self::E57,
        Self::Mcap,
        Self::Csv,
        Self::Xyz,
        Self::Kitti,
        Self::Npz,
    ];

    /// Whether the metadata, and the mark SIMULATED, are only in a companion.
    #[must_use]
    pub const fn needs_companion(self) -> bool {
        matches!(self, Self::Xyz | Self::Kitti)
    }

    /// The formats that are one file with its metadata.
    pub fn single_files() -> impl Iterator<Item = Self> {
        let formats = Self::ALL.into_iter();
        formats.filter(|format| !format.needs_companion())
    }

    /// Columns whose request is an error, as the format has no place for them. It omits others
    /// that it lacks.
    #[must_use]
    pub fn refused_columns(self) -> Fields {
        match self {
            Self::Kitti => Fields::SD | Fields::ECHO | Fields::LASER,
            _ => Fields::NONE,
        }
    }

    /// The file name extension, without its dot.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Ply => "ply",
            Self::Pcd => "pcd",
            Self::Las => "las",
            Self::Laz => "laz",
            Self::E57 => "e57",
            Self::Mcap => "mcap",
            Self::Csv => "csv",
            Self::Xyz => "xyz",
            Self::Kitti => "bin",
            Self::Npz => "npz",
        }
    }

    /// The format of `extension`, given without its dot and in any case.
    ///
    /// # Errors
    /// [`UnsupportedFormat`], whose message lists the formats.
    pub fn from_extension(extension: &str) -> Result<Self, UnsupportedFormat> {
        Self::ALL
            .into_iter()
            .find(|format| extension.eq_ignore_ascii_case(format.extension()))
            .ok_or_else(|| UnsupportedFormat {
                got: extension.to_owned(),
            })
    }

    /// The format of `path`'s extension; the file is not read.
    ///
    /// # Errors
    /// [`UnsupportedFormat`] if the extension is missing or unknown.
    pub fn from_path(path: &Path) -> Result<Self, UnsupportedFormat> {
        let extension = path.extension().unwrap_or_default();
        Self::from_extension(&extension.to_string_lossy())
    }

    /// Writes this format with the columns `fields` into `output`, which should be buffered:
    /// LAZ and E57 write in small pieces. E57 reads what it wrote.
    pub fn writer<W>(self, output: W, fields: Fields) -> Box<dyn Sink + Send>
    where
        W: Read + Write + Seek + Send + Sync + 'static,
    {
        match self {
            Self::Ply => Box::new(ply::PlyWriter::new(output, fields)),
            Self::Pcd => Box::new(pcd::PcdWriter::new(output, fields)),
            Self::Las => Box::new(las::LasWriter::las(output, fields)),
            Self::Laz => Box::new(las::LasWriter::laz(output, fields)),
            Self::E57 => Box::new(e57::E57Writer::new(output, fields)),
            Self::Mcap => Box::new(mcap::McapWriter::new(output, fields)),
            Self::Csv | Self::Xyz => Box::new(csv::CsvWriter::new(output, self, fields)),
            Self::Kitti => Box::new(kitti::KittiWriter::new(output)),
            Self::Npz => Box::new(npz::NpzWriter::new(output, fields)),
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.extension())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::samples;

    #[test]
    fn extensions_name_formats_in_any_case() {
        for format in Format::ALL {
            assert_eq!(Format::from_extension(format.extension()), Ok(format));
        }
        assert_eq!(
            Format::from_path(Path::new("a.b/Scan.LAZ")),
            Ok(Format::Laz)
        );
    }

    #[test]
    fn an_unknown_extension_lists_the_formats() {
        let error = Format::from_extension("obj").unwrap_err();
        assert_eq!(
            error.to_string(),
            "no cloud format for extension .obj: expected one of .ply .pcd .las .laz .e57 .mcap .csv .xyz .bin .npz"
        );
        let error = Format::from_path(Path::new("cloud")).unwrap_err();
        assert!(error.to_string().contains("without extension"), "{error}");
    }

    #[test]
    fn every_format_writes_all_points_and_the_mark() {
        for format in Format::ALL {
            let file = samples::SharedOutput::default();
            let mut sink = format.writer(file.clone(), Fields::FILE);
            let cloud = samples::cloud_from(100, samples::NOW_NS);
            sink.begin(&samples::metadata()).unwrap();
            sink.points(&cloud).unwrap();
            let summary = sink.finish().unwrap();
            assert_eq!(summary, cloud.summary(), "{format}");
            let companion = sink.companion("cloud").filter(|_| format.needs_companion());
            let bytes = companion.map_or_else(|| file.content(), |beside| beside.text.into());
            let marked = bytes.windows(9).any(|window| window == b"SIMULATED");
            assert!(marked, "{format} is not marked SIMULATED");
        }
    }
}
