//! The YAML of the ROS Velodyne drivers.
//!
//! Their convention, with the measured range d, in this project's axes (theirs are x forward, y
//! left): azimuth a = raw - rot_correction, elevation w = vert_correction, D = d + dist_correction;
//! xy = D cos w - vert_offset sin w, x = xy sin a - horiz_offset cos a, y = xy cos a + horiz_offset
//! sin a, z = D sin w + vert_offset cos w. So the vertical offset is perpendicular to the beam.
//! Angles are radians, lengths metres. `laser_id` is the channel's index in the packet, which is
//! the firing order of every model here. Corrections of reflectivity are listed in
//! [`RosCalibration::ignored`].

use std::f64::consts::PI;

use protocol::vlp16::LidarModel;

use super::yaml::{YamlNode, YamlValue, parse};
use super::{CalibrationError, EntryLines, LaserEntry, assemble};
use crate::corrections::{Corrections, LaserCorrection};

const LAYER: &str = "calibration YAML";
/// Keys of the top level.
const TOP: [&str; 3] = ["lasers", "num_lasers", "distance_resolution"];
/// Keys of a laser that affect positions.
const LASER: [&str; 9] = [
    "laser_id",
    "rot_correction",
    "vert_correction",
    "dist_correction",
    "two_pt_correction_available",
    "dist_correction_x",
    "dist_correction_y",
    "vert_offset_correction",
    "horiz_offset_correction",
];
/// Keys of a laser that affect reflectivity, with their neutral value.
const REFLECTIVITY: [(&str, f64); 4] = [
    ("focal_distance", 0.0),
    ("focal_slope", 0.0),
    ("min_intensity", 0.0),
    ("max_intensity", 255.0),
];

/// Content of a file.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RosCalibration {
    /// Corrections of every laser in firing order.
    pub corrections: Corrections,
    /// Effective corrections of reflectivity, which are not applied.
    pub ignored: Vec<Ignored>,
}

/// A correction that is not applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ignored {
    /// Line of its value.
    pub line: usize,
    /// Its key.
    pub key: &'static str,
}

/// Parses the text of such a file for a sensor of `model`.
///
/// Two-point corrections, made for the HDL-64E, lengthen x and y differently. [`LaserCorrection`]
/// cannot represent them unless they are equal.
///
/// # Errors
/// [`CalibrationError`], with the line.
pub fn from_ros_yaml(
    text: &str,
    model: &'static LidarModel,
) -> Result<RosCalibration, CalibrationError> {
    let root = parse(LAYER, text)?;
    let top = YamlMapping::new(&root, "the file", |key| TOP.contains(&key))?;
    check_unit(&top, model)?;
    let lasers = top.required("lasers")?;
    let YamlValue::List(items) = &lasers.value else {
        return Err(value("lasers", lasers, "a list"));
    };
    let count = top.required("num_lasers")?;
    let used = usize::try_from(whole("num_lasers", count)?).ok();
    let Some((used, rest)) = used.and_then(|used| items.split_at_checked(used)) else {
        let expected = format!("at most {}, the length of the list", items.len());
        return Err(value("num_lasers", count, &expected));
    };
    let mut ignored = Vec::new();
    let entries = used.iter().map(|item| entry(item, &mut ignored));
    let entries = entries.collect::<Result<_, _>>()?;
    // The drivers' file for the HDL-32E lists 64 lasers, of which 32 count.
    for item in rest {
        let unused = entry(item, &mut Vec::new())?.id;
        if usize::try_from(unused.0).is_ok_and(|id| id < used.len()) {
            return Err(CalibrationError::Value {
                layer: LAYER,
                line: unused.1,
                key: "laser_id".to_owned(),
                expected: format!("{} or more beyond the first num_lasers", used.len()),
                got: unused.0.to_string(),
            });
        }
    }
    Ok(RosCalibration {
        corrections: assemble(LAYER, lasers.line, model, entries)?,
        ignored,
    })
}

/// Checks the distance unit, which is that of the packets: another unit means another model.
fn check_unit(top: &YamlMapping<'_>, model: &'static LidarModel) -> Result<(), CalibrationError> {
    let Some(unit) = top.get("distance_resolution") else {
        return Ok(());
    };
    let unit_m = number("distance_resolution", unit)?;
    if (unit_m - model.distance_unit_m).abs() > 1e-9 {
        let expected = format!("the {} m of a {}", model.distance_unit_m, model.name);
        return Err(value("distance_resolution", unit, &expected));
    }
    Ok(())
}

/// Parses one laser.
fn entry(item: &YamlNode, ignored: &mut Vec<Ignored>) -> Result<LaserEntry, CalibrationError> {
    let is_reflectivity = |key: &str| REFLECTIVITY.iter().any(|&(known, _)| known == key);
    let laser = YamlMapping::new(item, "a laser", |key| {
        LASER.contains(&key) || is_reflectivity(key)
    })?;
    let id = laser.required("laser_id")?;
    let angle = |key| {
        let node = laser.required(key)?;
        let radians = number(key, node)?;
        if radians.abs() <= PI {
            Ok((radians, (key, node.line)))
        } else {
            Err(value(key, node, "radians, at most half a revolution"))
        }
    };
    let length = |key| {
        let node = laser.required(key)?;
        Ok((number(key, node)?, (key, node.line)))
    };
    let (rotation, azimuth) = angle("rot_correction")?;
    let (w, elevation) = angle("vert_correction")?;
    let (range_offset_m, range) = length("dist_correction")?;
    let (vertical_m, vertical) = length("vert_offset_correction")?;
    let (horizontal_m, horizontal) = length("horiz_offset_correction")?;
    two_point(&laser, range_offset_m)?;
    for (key, idle) in REFLECTIVITY {
        if let Some(node) = laser.get(key)
            && (number(key, node)? - idle).abs() > 0.0
        {
            let line = node.line;
            ignored.push(Ignored { line, key });
        }
    }
    Ok(LaserEntry {
        id: (whole("laser_id", id)?, id.line),
        correction: LaserCorrection {
            elevation_deg: w.to_degrees(),
            azimuth_offset_deg: -rotation.to_degrees(),
            range_offset_m,
            radial_offset_m: -vertical_m * w.sin(),
            tangential_offset_m: horizontal_m,
            vertical_offset_m: vertical_m * w.cos(),
        },
        lines: EntryLines {
            elevation,
            azimuth,
            range,
            offsets: vec![
                (vertical.0, vertical.1, vertical_m),
                (horizontal.0, horizontal.1, horizontal_m),
            ],
        },
    })
}

/// Accepts two-point corrections only if both equal the correction for all distances.
fn two_point(laser: &YamlMapping<'_>, range_offset_m: f64) -> Result<(), CalibrationError> {
    const AVAILABLE: &str = "two_pt_correction_available";
    let Some(available) = laser.get(AVAILABLE) else {
        return Ok(());
    };
    match available.as_str().map(str::to_ascii_lowercase).as_deref() {
        Some("false" | "no" | "off" | "n") => return Ok(()),
        Some("true" | "yes" | "on" | "y") => {}
        _ => return Err(value(AVAILABLE, available, "true or false")),
    }
    for key in ["dist_correction_x", "dist_correction_y"] {
        let node = laser.required(key)?;
        if (number(key, node)? - range_offset_m).abs() > 1e-9 {
            return Err(CalibrationError::Unsupported {
                layer: LAYER,
                line: node.line,
                key,
                why: "a range correction that differs between x and y; only one equal to dist_correction can be applied",
            });
        }
    }
    Ok(())
}

/// A mapping with known keys only.
struct YamlMapping<'a> {
    line: usize,
    pairs: &'a [(YamlNode, YamlNode)],
}

impl<'a> YamlMapping<'a> {
    fn new(
        node: &'a YamlNode,
        what: &'static str,
        known: impl Fn(&str) -> bool,
    ) -> Result<Self, CalibrationError> {
        let YamlValue::Map(pairs) = &node.value else {
            return Err(value(what, node, "a mapping"));
        };
        for (key, _) in pairs {
            let name = key.as_str().unwrap_or_default();
            if !known(name) {
                return Err(CalibrationError::UnknownKey {
                    layer: LAYER,
                    line: key.line,
                    key: name.to_owned(),
                });
            }
        }
        Ok(Self {
            line: node.line,
            pairs,
        })
    }

    fn get(&self, key: &str) -> Option<&'a YamlNode> {
        let mut pairs = self.pairs.iter();
        pairs
            .find(|(name, _)| name.as_str() == Some(key))
            .map(|(_, value)| value)
    }

    fn required(&self, key: &'static str) -> Result<&'a YamlNode, CalibrationError> {
        self.get(key).ok_or(CalibrationError::MissingKey {
            layer: LAYER,
            line: self.line,
            key,
        })
    }
}

fn value(key: &str, node: &YamlNode, expected: &str) -> CalibrationError {
    CalibrationError::Value {
        layer: LAYER,
        line: node.line,
        key: key.to_owned(),
        expected: expected.to_owned(),
        got: node.describe(),
    }
}

fn number(key: &str, node: &YamlNode) -> Result<f64, CalibrationError> {
    let read = node.as_str().and_then(|text| text.parse::<f64>().ok());
    read.filter(|x| x.is_finite())
        .ok_or_else(|| value(key, node, "a finite number"))
}

fn whole(key: &str, node: &YamlNode) -> Result<i64, CalibrationError> {
    let read = node.as_str().and_then(|text| text.parse().ok());
    read.ok_or_else(|| value(key, node, "a whole number"))
}
