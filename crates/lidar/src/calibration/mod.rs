//! Calibration files: the YAML of ROS drivers, or this project's TOML.
//!
//! Both give [`Corrections`]. Missing, repeated, unknown or implausible values are errors with
//! their line, since an ignored correction would look like a bad sensor. Corrections of
//! reflectivity are not applied.

mod native;
mod ros;
mod yaml;

use protocol::vlp16::LidarModel;
use thiserror::Error;

use crate::corrections::{Corrections, LaserCorrection};

pub use native::from_toml;
pub use ros::{Ignored, RosCalibration, from_ros_yaml};

/// Largest plausible difference from the model's angles. Real ones are some hundredths of a degree;
/// larger ones are another laser, model or sign.
const MAX_OFFSET_DEG: f64 = 2.0;
/// Largest plausible offset of a beam's origin or range.
const MAX_OFFSET_M: f64 = 1.0;

/// Error in a calibration file, with its line, counted from 1.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CalibrationError {
    /// Invalid syntax.
    #[error("{layer} line {line}: {message}")]
    Syntax {
        /// The kind of file.
        layer: &'static str,
        /// Line of the error.
        line: usize,
        /// The parser's message.
        message: String,
    },
    /// An unknown key.
    #[error("{layer} line {line}: key {key} is not known")]
    UnknownKey {
        /// The kind of file.
        layer: &'static str,
        /// Its line.
        line: usize,
        /// The key.
        key: String,
    },
    /// A missing key.
    #[error("{layer} line {line}: expected key {key}, which is missing")]
    MissingKey {
        /// The kind of file.
        layer: &'static str,
        /// Start of the table or mapping.
        line: usize,
        /// The key.
        key: &'static str,
    },
    /// An invalid value.
    #[error("{layer} line {line}: {key}: expected {expected}, got {got}")]
    Value {
        /// The kind of file.
        layer: &'static str,
        /// Its line.
        line: usize,
        /// The key.
        key: String,
        /// Valid values.
        expected: String,
        /// The value found.
        got: String,
    },
    /// A correction that [`LaserCorrection`] cannot represent.
    #[error("{layer} line {line}: {key} is not supported: {why}")]
    Unsupported {
        /// The kind of file.
        layer: &'static str,
        /// Its line.
        line: usize,
        /// The key.
        key: &'static str,
        /// The reason.
        why: &'static str,
    },
    /// Another number of lasers than the model's.
    #[error("{layer} line {line}: expected the {expected} lasers of a {model}, got {got}")]
    Lasers {
        /// The kind of file.
        layer: &'static str,
        /// Start of the list.
        line: usize,
        /// The model.
        model: &'static str,
        /// Lasers of the model.
        expected: usize,
        /// Lasers of the file.
        got: usize,
    },
}

/// One laser of a file, with the lines of its values.
struct LaserEntry {
    /// Index in the firing order, and its line.
    id: (i64, usize),
    correction: LaserCorrection,
    /// Keys and lines of the values.
    lines: EntryLines,
}

/// Keys and lines of a laser's values.
struct EntryLines {
    elevation: (&'static str, usize),
    azimuth: (&'static str, usize),
    range: (&'static str, usize),
    /// Offsets of the beam's origin, with their values.
    offsets: Vec<(&'static str, usize, f64)>,
}

/// Sorts entries into firing order and checks that each laser occurs once.
fn assemble(
    layer: &'static str,
    line: usize,
    model: &'static LidarModel,
    entries: Vec<LaserEntry>,
) -> Result<Corrections, CalibrationError> {
    let expected = model.lasers.len();
    if entries.len() != expected {
        return Err(CalibrationError::Lasers {
            layer,
            line,
            model: model.name,
            expected,
            got: entries.len(),
        });
    }
    let mut slots: Vec<Option<LaserEntry>> = Vec::new();
    slots.resize_with(expected, || None);
    for entry in entries {
        let (id, id_line) = entry.id;
        let value = |expected| CalibrationError::Value {
            layer,
            line: id_line,
            key: "laser number".to_owned(),
            expected,
            got: id.to_string(),
        };
        match usize::try_from(id).ok().and_then(|id| slots.get_mut(id)) {
            Some(slot @ None) => *slot = Some(entry),
            Some(Some(_)) => return Err(value("each number once".to_owned())),
            None => {
                let last = expected - 1;
                return Err(value(format!("0 to {last}, in firing order")));
            }
        }
    }
    // Every slot is filled: there are as many entries as slots, and none occurs twice.
    let mut lasers = Vec::with_capacity(expected);
    for (entry, laser) in slots.into_iter().flatten().zip(model.lasers) {
        check_plausible(layer, model, &entry, LaserCorrection::from(laser))?;
        lasers.push(entry.correction);
    }
    Ok(Corrections { lasers })
}

/// Refuses implausible values for the model.
fn check_plausible(
    layer: &'static str,
    model: &'static LidarModel,
    entry: &LaserEntry,
    of_model: LaserCorrection,
) -> Result<(), CalibrationError> {
    let refuse = |(key, line): (&'static str, usize), expected: String, got: String| {
        Err(CalibrationError::Value {
            layer,
            line,
            key: key.to_owned(),
            expected,
            got,
        })
    };
    let (
        LaserEntry {
            id: (id, _),
            correction,
            lines,
        },
        name,
    ) = (entry, model.name);
    let angles = [
        (
            lines.elevation,
            "elevation",
            of_model.elevation_deg,
            correction.elevation_deg,
        ),
        (
            lines.azimuth,
            "azimuth offset",
            of_model.azimuth_offset_deg,
            correction.azimuth_offset_deg,
        ),
    ];
    for (location, quantity, model_deg, deg) in angles {
        if (deg - model_deg).abs() > MAX_OFFSET_DEG {
            let near = format!(
                "an {quantity} within {MAX_OFFSET_DEG} deg of the {model_deg} deg of laser {id} of a {name}"
            );
            return refuse(location, near, format!("{deg:.3} deg"));
        }
    }
    let range = (lines.range.0, lines.range.1, correction.range_offset_m);
    for &(key, line, m) in lines.offsets.iter().chain([&range]) {
        if m.abs() > MAX_OFFSET_M {
            return refuse(
                (key, line),
                format!("at most {MAX_OFFSET_M} m either way"),
                format!("{m} m"),
            );
        }
    }
    Ok(())
}
