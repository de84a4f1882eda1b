//! Python's arguments as requests to the engine.

use std::path::{Path, PathBuf};

use engine::config::{MountSettings, load_mount, usual_place};
use engine::lidars::{LIDARS, LidarSheet};
use engine::reconstruct::decoder_options::DecoderRequest;
use engine::reconstruct::replay::TimeReference;
use engine::reconstruct::source::{SensorAddress, Source};
use engine::reconstruct::tilt_table::tilt_source;
use lidar::Duplicates;
use numpy::PyReadonlyArray2;
use protocol::record::Wire;
use protocol::vlp16::LidarModel;
use pyo3::prelude::*;
use scanner::config::MountConfig;
use scanner::{AngleTable, TiltSource};

use crate::binding_error::{BindingError, check_readable};

/// Source of the tilt angles.
pub(crate) enum TiltArgument {
    /// The log's, if it has a drive; else none.
    Usual,
    /// `log`, `none`, or the path of a table.
    Named(String),
    /// Times and angles.
    Rows(Vec<(f64, f64)>),
}

/// The mount of the lidar.
pub(crate) enum MountArgument {
    /// Height above the tilt axis, metres.
    Height(f64),
    /// A file with `[mount]`.
    File(PathBuf),
}

impl TiltArgument {
    pub fn new(argument: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let Some(argument) = argument else {
            return Ok(Self::Usual);
        };
        if let Ok(path) = argument.extract::<PathBuf>() {
            return Ok(Self::Named(path.display().to_string()));
        }
        let py = argument.py();
        let wrong = || {
            BindingError::usage(
                "tilt: expected \"log\", \"none\", a path, or an array of shape (n, 2) with times in s and angles in deg",
            )
            .into_py(py)
        };
        let numpy = py.import("numpy")?;
        let array = numpy.call_method1("require", (argument, "f8", "CA"));
        let array = array.map_err(|_| wrong())?;
        let rows: PyReadonlyArray2<'_, f64> = array.extract().map_err(|_| wrong())?;
        let rows = rows.as_array();
        if rows.ncols() != 2 {
            return Err(wrong());
        }
        let pair = |row: numpy::ndarray::ArrayView1<'_, f64>| (row[0], row[1]);
        Ok(Self::Rows(rows.rows().into_iter().map(pair).collect()))
    }

    /// The angles for a recording.
    pub fn resolve(self, source: &Source) -> Result<TiltSource, BindingError> {
        match self {
            Self::Usual => Ok(match has_drive(source)? {
                true => TiltSource::Log,
                false => TiltSource::None,
            }),
            Self::Named(name) => {
                if name != "log" && name != "none" {
                    check_readable(Path::new(&name))?;
                }
                Ok(tilt_source(&name)?)
            }
            Self::Rows(rows) => {
                let table = AngleTable::new(rows);
                let table = table.map_err(|error| BindingError::usage(format!("tilt: {error}")))?;
                Ok(TiltSource::Table(table))
            }
        }
    }
}

/// Whether a recording has traffic of a drive.
fn has_drive(source: &Source) -> Result<bool, BindingError> {
    let mut found = false;
    source.read_until(|record| {
        found = matches!(record.wire, Wire::Drive { .. });
        !found
    })?;
    Ok(found)
}

impl MountArgument {
    pub fn new(argument: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Self>> {
        let Some(argument) = argument else {
            return Ok(None);
        };
        if let Ok(height) = argument.extract::<f64>() {
            return Ok(Some(Self::Height(height)));
        }
        let file = argument.extract::<PathBuf>().map_err(|_| {
            BindingError::usage("mount: expected a path, or the height above the axis in m")
                .into_py(argument.py())
        })?;
        Ok(Some(Self::File(file)))
    }

    pub fn load(&self) -> Result<MountSettings, BindingError> {
        match self {
            Self::Height(d_m) if d_m.abs() <= 10.0 => {
                Ok(MountSettings::from(MountConfig::upright(*d_m)))
            }
            Self::Height(d_m) => Err(BindingError::usage(format!(
                "mount: expected a height from -10 to 10 m, got {d_m}"
            ))),
            Self::File(file) => {
                check_readable(file)?;
                Ok(load_mount(file)?)
            }
        }
    }
}

/// The mount that replaces the recording's, as `velomotion replay` takes it.
pub(crate) fn mount_for(
    mount: Option<&MountArgument>,
    tilt: &TiltSource,
    source: &Source,
) -> Result<Option<MountSettings>, BindingError> {
    match (mount, tilt) {
        (Some(_), TiltSource::None) => Err(BindingError::usage(
            "mount: it is for a tilted lidar; without tilt points are in the lidar's own frame",
        )),
        (Some(mount), _) => mount.load().map(Some),
        (None, TiltSource::Table(_)) if !source.has_config()? => match usual_place() {
            Some(file) => Ok(Some(load_mount(&file)?)),
            None => Err(BindingError::usage(
                "mount: the recording has no configuration; expected its height above the tilt axis in m, or the path of a mount.toml",
            )),
        },
        (None, _) => Ok(None),
    }
}

/// Reads a name.
pub(crate) fn time_reference(name: &str) -> Result<TimeReference, BindingError> {
    match name {
        "host" => Ok(TimeReference::Host),
        "utc" => Ok(TimeReference::Utc),
        _ => Err(BindingError::usage(format!(
            "time: expected \"host\" or \"utc\", got {name:?}"
        ))),
    }
}

/// Reads the address of a sensor.
pub(crate) fn sensor(text: Option<&str>) -> Result<Option<SensorAddress>, BindingError> {
    let address = text.map(str::parse).transpose();
    address.map_err(|error| BindingError::usage(format!("sensor: {error}")))
}

/// Reads how packets are decoded.
pub(crate) fn decoder_request(
    model: Option<&str>,
    calibration: Option<PathBuf>,
    equal_returns: &str,
) -> Result<DecoderRequest, BindingError> {
    let duplicates = match equal_returns {
        "once" => Duplicates::Unique,
        "twice" => Duplicates::All,
        _ => {
            let what = "equal_returns: expected \"once\" or \"twice\"";
            return Err(BindingError::usage(format!(
                "{what}, got {equal_returns:?}"
            )));
        }
    };
    Ok(DecoderRequest {
        model: model.map(captured_model).transpose()?,
        calibration,
        duplicates,
        one_origin: false,
    })
}

fn captured_model(name: &str) -> Result<&'static LidarModel, BindingError> {
    let model = LidarSheet::named(name).and_then(|sheet| sheet.model);
    model.ok_or_else(|| {
        unknown(
            "model",
            name,
            LIDARS.iter().filter(|sheet| sheet.model.is_some()),
        )
    })
}

/// Reads the name of a lidar that may be planned with.
pub(crate) fn lidar_sheet(name: &str) -> Result<&'static LidarSheet, BindingError> {
    LidarSheet::named(name).ok_or_else(|| unknown("lidar", name, LIDARS.iter()))
}

fn unknown<'a>(
    argument: &str,
    name: &str,
    known: impl Iterator<Item = &'a &'static LidarSheet>,
) -> BindingError {
    let known: Vec<&str> = known.map(|sheet| sheet.name).collect();
    BindingError::usage(format!(
        "{argument}: expected one of {}, got {name:?}",
        known.join(", ")
    ))
}
