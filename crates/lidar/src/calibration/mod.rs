//! Per-laser corrections from a file: the YAML of ROS drivers, or this project's own TOML.
//!
//! Both become [`Corrections`]. A file is believed only as a whole: what is missing, twice there,
//! not understood or out of all proportion is an error with its line, because a correction that is
//! silently not applied looks like a bad sensor. Left out: opening files, corrections of
//! reflectivity, and telling which file belongs to which sensor.

mod native;
mod ros;
mod yaml;

use protocol::vlp16::Model;
use thiserror::Error;

use crate::corrections::{Corrections, LaserCorrection};

pub use native::from_toml;
pub use ros::{Ignored, RosCalibration, from_ros_yaml};

/// A sensor's own angles are some hundredths of a degree off its model's; more is another laser,
/// another model or another sign.
const MOST_OFF_DEG: f64 = 2.0;
/// No beam of this family starts further from the origin, or is further off in range.
const MOST_OFF_M: f64 = 1.0;

/// What is wrong with a calibration file, and in which line, counted from 1.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CalibrationError {
    /// Not the language that it should be in.
    #[error("{layer} line {line}: {message}")]
    Syntax {
        /// The kind of file.
        layer: &'static str,
        /// Where.
        line: usize,
        /// What the parser says.
        message: String,
    },
    /// A key that is not of this kind of file.
    #[error("{layer} line {line}: key {key} is not known")]
    UnknownKey {
        /// The kind of file.
        layer: &'static str,
        /// Where it is.
        line: usize,
        /// The key.
        key: String,
    },
    /// A key that has to be there.
    #[error("{layer} line {line}: expected key {key}, which is missing")]
    MissingKey {
        /// The kind of file.
        layer: &'static str,
        /// Where the table or mapping begins that lacks it.
        line: usize,
        /// The key.
        key: &'static str,
    },
    /// A value that it cannot have.
    #[error("{layer} line {line}: {key}: expected {expected}, got {got}")]
    Value {
        /// The kind of file.
        layer: &'static str,
        /// Where it is.
        line: usize,
        /// The key.
        key: String,
        /// What it may be.
        expected: String,
        /// What is there.
        got: String,
    },
    /// A correction that has no place in [`LaserCorrection`].
    #[error("{layer} line {line}: {key} is not supported: {why}")]
    Unsupported {
        /// The kind of file.
        layer: &'static str,
        /// Where it is.
        line: usize,
        /// The key.
        key: &'static str,
        /// Why.
        why: &'static str,
    },
    /// Not as many lasers as the model has.
    #[error("{layer} line {line}: expected the {expected} lasers of a {model}, got {got}")]
    Lasers {
        /// The kind of file.
        layer: &'static str,
        /// Where the list begins.
        line: usize,
        /// The model.
        model: &'static str,
        /// Lasers of the model.
        expected: usize,
        /// Lasers of the file.
        got: usize,
    },
}

/// One laser of a file, with the lines of what may be out of proportion.
struct LaserEntry {
    /// The laser's number in firing order, and its line.
    id: (i64, usize),
    correction: LaserCorrection,
    /// Key and line of elevation, azimuth offset, and of each length.
    lines: EntryLines,
}

/// Which key, in which line, a quantity came from.
struct EntryLines {
    elevation: (&'static str, usize),
    azimuth: (&'static str, usize),
    range: (&'static str, usize),
    /// Lengths that say where a beam starts, each with its value.
    offsets: Vec<(&'static str, usize, f64)>,
}

/// Puts entries, in any order, into firing order, each laser once.
fn assemble(
    layer: &'static str,
    line: usize,
    model: &'static Model,
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
    // Every slot is taken: as many entries as slots, none twice.
    let mut lasers = Vec::with_capacity(expected);
    for (entry, usual) in slots.into_iter().flatten().zip(model.lasers) {
        plausible(layer, model, &entry, LaserCorrection::from(usual))?;
        lasers.push(entry.correction);
    }
    Ok(Corrections { lasers })
}

/// Refuses what no sensor of the model can have.
fn plausible(
    layer: &'static str,
    model: &'static Model,
    entry: &LaserEntry,
    usual: LaserCorrection,
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
            usual.elevation_deg,
            correction.elevation_deg,
        ),
        (
            lines.azimuth,
            "azimuth offset",
            usual.azimuth_offset_deg,
            correction.azimuth_offset_deg,
        ),
    ];
    for (at, what, usual_deg, deg) in angles {
        if (deg - usual_deg).abs() > MOST_OFF_DEG {
            let near = format!(
                "an {what} within {MOST_OFF_DEG} deg of the {usual_deg} deg of laser {id} of a {name}"
            );
            return refuse(at, near, format!("{deg:.3} deg"));
        }
    }
    let range = (lines.range.0, lines.range.1, correction.range_offset_m);
    for &(key, line, m) in lines.offsets.iter().chain([&range]) {
        if m.abs() > MOST_OFF_M {
            return refuse(
                (key, line),
                format!("at most {MOST_OFF_M} m either way"),
                format!("{m} m"),
            );
        }
    }
    Ok(())
}
