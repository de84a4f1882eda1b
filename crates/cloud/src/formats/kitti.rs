//! The `.bin` of KITTI (Geiger et al. 2013, "Vision meets robotics: The KITTI dataset"): of each
//! point x forward, y left, z up in metres and the reflectance from 0 to 1, as little-endian f32.
//! Georeferenced clouds are turned alike, to x north, y west, so that readers need not tell them
//! apart.
//!
//! The file has no place for anything else. Its metadata are in a text file of its name beside it.

use std::io::Write;

use super::file_sink::{EncodeError, FileSink, FormatEncoder};
use crate::{Companion, Fields, Metadata, Points, Summary};

/// Bytes of a point.
pub(crate) const ROW_BYTES: usize = 16;
/// Greatest intensity.
pub(crate) const FULL: f32 = 255.0;

/// Writes `.bin`.
pub(super) type KittiWriter<W> = FileSink<KittiEncoder<W>>;

/// Encoder of [`KittiWriter`].
#[derive(Debug)]
pub(super) struct KittiEncoder<W> {
    output: W,
    lines: Vec<String>,
    /// Rows of a batch, kept for their memory.
    rows: Vec<u8>,
}

impl<W: Write> KittiWriter<W> {
    /// A writer into `output`.
    pub(super) fn new(output: W) -> Self {
        let encoder = KittiEncoder {
            output,
            lines: Vec::new(),
            rows: Vec::new(),
        };
        Self::of(encoder, Fields::INTENSITY)
    }
}

impl<W: Write> FormatEncoder for KittiEncoder<W> {
    fn format(&self) -> &'static str {
        "bin"
    }

    fn begin(&mut self, metadata: &Metadata) -> Result<(), EncodeError> {
        self.lines = metadata.lines();
        Ok(())
    }

    fn points(&mut self, batch: &Points) -> Result<(), EncodeError> {
        self.rows.clear();
        for point in batch.iter() {
            let [right, forward, up] = point.position_m.map(|axis| axis as f32);
            let reflectance = f32::from(point.intensity) / FULL;
            for value in [forward, -right, up, reflectance] {
                self.rows.extend(value.to_le_bytes());
            }
        }
        Ok(self.output.write_all(&self.rows)?)
    }

    fn finish(&mut self, _: &Summary) -> Result<(), EncodeError> {
        Ok(self.output.flush()?)
    }

    fn companion(&self, file_name: &str) -> Option<Companion> {
        let columns = "x y z, reflectance from 0 to 1, each f32";
        let turned = |line: &String| {
            line.replace("x right, y forward", "x forward, y left")
                .replace("x east, y north", "x north, y west")
        };
        let lines: Vec<String> = self.lines.iter().map(turned).collect();
        Some(Companion::metadata(file_name, columns, &lines))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Sink;
    use crate::tests::samples::{cloud, metadata};

    #[test]
    fn axes_are_forward_left_up_and_the_metadata_beside_it() {
        let given = cloud(2);
        let mut writer = KittiWriter::new(Vec::new());
        writer.begin(&metadata()).unwrap();
        writer.points(&given).unwrap();
        writer.finish().unwrap();
        let file = &writer.encoder.output;
        assert_eq!(file.len(), 2 * ROW_BYTES);
        let point = given.iter().nth(1).unwrap();
        let row: Vec<f32> = file[ROW_BYTES..]
            .chunks_exact(4)
            .map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap()))
            .collect();
        let [x, y, z] = point.position_m.map(|axis| axis as f32);
        assert_eq!(row, [y, -x, z, f32::from(point.intensity) / 255.0]);
        let companion = writer.companion("scan.bin").unwrap();
        assert_eq!(companion.name, "scan.bin.txt");
        let axes = Some(crate::EastNorthUp::new(units::Degrees(0.0)));
        let georeferenced = Metadata {
            east_north_up: axes,
            ..metadata()
        };
        let mut turned = KittiWriter::new(Vec::new());
        turned.begin(&georeferenced).unwrap();
        let beside = turned.companion("scan.bin").unwrap();
        assert!(beside.text.contains("\nframe: x north, y west, z up"));
        for part in ["\nSIMULATED", "\nframe: x forward, y left, z up"] {
            assert!(companion.text.contains(part), "{}", companion.text);
        }
    }
}
