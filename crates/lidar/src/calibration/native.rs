//! This project's TOML: `model`, and a `[[laser]]` table per laser with units in the key names.
//!
//! `id` is the laser's index in the firing order. `id` and `elevation_deg` are required; other keys
//! default to the model's table. The quantities are those of [`LaserCorrection`].

use std::ops::Range;

use protocol::vlp16::LidarModel;
use serde::Deserialize;
use toml::Spanned;

use super::{CalibrationError, EntryLines, LaserEntry, assemble};
use crate::corrections::{Corrections, LaserCorrection};

const LAYER: &str = "calibration TOML";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CalibrationFile {
    model: Spanned<String>,
    #[serde(default)]
    laser: Vec<LaserTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LaserTable {
    id: Spanned<i64>,
    elevation_deg: Spanned<f64>,
    azimuth_offset_deg: Option<Spanned<f64>>,
    range_offset_m: Option<Spanned<f64>>,
    radial_offset_m: Option<Spanned<f64>>,
    tangential_offset_m: Option<Spanned<f64>>,
    vertical_offset_m: Option<Spanned<f64>>,
}

/// Parses the text of such a file for a sensor of `model`.
///
/// # Errors
/// [`CalibrationError`], with the line.
pub fn from_toml(text: &str, model: &'static LidarModel) -> Result<Corrections, CalibrationError> {
    let file: CalibrationFile = toml::from_str(text).map_err(|error| CalibrationError::Syntax {
        layer: LAYER,
        line: error.span().map_or(1, |span| line(text, span)),
        message: error.message().to_owned(),
    })?;
    if file.model.get_ref() != model.name {
        return Err(CalibrationError::Value {
            layer: LAYER,
            line: line(text, file.model.span()),
            key: "model".to_owned(),
            expected: format!("{:?}, which the sensor is", model.name),
            got: format!("{:?}", file.model.get_ref()),
        });
    }
    let entries = file.laser.iter().map(|table| table.entry(text, model));
    let entries = entries.collect::<Result<_, _>>()?;
    assemble(LAYER, line(text, file.model.span()), model, entries)
}

impl LaserTable {
    fn entry(
        &self,
        text: &str,
        model: &'static LidarModel,
    ) -> Result<LaserEntry, CalibrationError> {
        let id_line = line(text, self.id.span());
        let laser = usize::try_from(*self.id.get_ref()).ok();
        // An index beyond the model's lasers is refused in `assemble`.
        let of_model = laser.and_then(|id| model.lasers.get(id));
        let of_model = of_model.map_or_else(LaserCorrection::default, LaserCorrection::from);
        let read = |key: &'static str, given: Option<&Spanned<f64>>, default: f64| {
            let Some(given) = given else {
                return Ok((default, (key, id_line)));
            };
            let (number, line) = (*given.get_ref(), line(text, given.span()));
            if number.is_finite() {
                return Ok((number, (key, line)));
            }
            Err(CalibrationError::Value {
                layer: LAYER,
                line,
                key: key.to_owned(),
                expected: "a finite number".to_owned(),
                got: number.to_string(),
            })
        };
        let (elevation_deg, elevation) = read("elevation_deg", Some(&self.elevation_deg), 0.0)?;
        let [azimuth, range, radial, tangential, vertical] = [
            (
                "azimuth_offset_deg",
                &self.azimuth_offset_deg,
                of_model.azimuth_offset_deg,
            ),
            ("range_offset_m", &self.range_offset_m, 0.0),
            ("radial_offset_m", &self.radial_offset_m, 0.0),
            ("tangential_offset_m", &self.tangential_offset_m, 0.0),
            (
                "vertical_offset_m",
                &self.vertical_offset_m,
                of_model.vertical_offset_m,
            ),
        ]
        .map(|(key, given, default)| read(key, given.as_ref(), default));
        let ((azimuth_offset_deg, azimuth), (range_offset_m, range)) = (azimuth?, range?);
        let ((radial_offset_m, radial), (tangential_offset_m, tangential)) = (radial?, tangential?);
        let (vertical_offset_m, vertical) = vertical?;
        Ok(LaserEntry {
            id: (*self.id.get_ref(), id_line),
            correction: LaserCorrection {
                elevation_deg,
                azimuth_offset_deg,
                range_offset_m,
                radial_offset_m,
                tangential_offset_m,
                vertical_offset_m,
            },
            lines: EntryLines {
                elevation,
                azimuth,
                range,
                offsets: vec![
                    (radial.0, radial.1, radial_offset_m),
                    (tangential.0, tangential.1, tangential_offset_m),
                    (vertical.0, vertical.1, vertical_offset_m),
                ],
            },
        })
    }
}

/// The line at the start of a span.
fn line(text: &str, span: Range<usize>) -> usize {
    let before = text.as_bytes().iter().take(span.start);
    1 + before.filter(|&&byte| byte == b'\n').count()
}
