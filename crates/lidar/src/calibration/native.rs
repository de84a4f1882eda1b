//! This project's own TOML: `model`, and a `[[laser]]` table for each laser with its units in the
//! keys' names.
//!
//! `id` is the laser's place in the firing order and `elevation_deg` its angle; of the other keys,
//! one that is absent leaves what the model's table says. Quantities are those of
//! [`LaserCorrection`]. Left out: writing such a file.

use std::ops::Range;

use protocol::vlp16::Model;
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

/// Reads the text of such a file for a sensor of `model`.
///
/// # Errors
/// [`CalibrationError`], with the line.
pub fn from_toml(text: &str, model: &'static Model) -> Result<Corrections, CalibrationError> {
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
    fn entry(&self, text: &str, model: &'static Model) -> Result<LaserEntry, CalibrationError> {
        let id_line = line(text, self.id.span());
        let laser = usize::try_from(*self.id.get_ref()).ok();
        // A number beyond the model's is refused when all is put together.
        let usual = laser.and_then(|id| model.lasers.get(id));
        let usual = usual.map_or_else(LaserCorrection::default, LaserCorrection::from);
        let read = |key: &'static str, given: Option<&Spanned<f64>>, usual: f64| {
            let Some(given) = given else {
                return Ok((usual, (key, id_line)));
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
        let (azimuth_offset_deg, azimuth) = read(
            "azimuth_offset_deg",
            self.azimuth_offset_deg.as_ref(),
            usual.azimuth_offset_deg,
        )?;
        let (range_offset_m, range) = read("range_offset_m", self.range_offset_m.as_ref(), 0.0)?;
        let (radial_offset_m, radial) =
            read("radial_offset_m", self.radial_offset_m.as_ref(), 0.0)?;
        let (tangential_offset_m, tangential) = read(
            "tangential_offset_m",
            self.tangential_offset_m.as_ref(),
            0.0,
        )?;
        let (vertical_offset_m, vertical) = read(
            "vertical_offset_m",
            self.vertical_offset_m.as_ref(),
            usual.vertical_offset_m,
        )?;
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

/// The line in which a span begins.
fn line(text: &str, span: Range<usize>) -> usize {
    let before = text.as_bytes().iter().take(span.start);
    1 + before.filter(|&&byte| byte == b'\n').count()
}
