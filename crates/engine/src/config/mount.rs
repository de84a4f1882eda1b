//! `[mount]`: the pose of the lidar on the tilt axis, and the files of calibrations.

use std::ops::Deref;
use std::path::{Path, PathBuf};

use scanner::config::{DeviceCalibration, MountConfig};
use serde::Deserialize;
use serde::de::IgnoredAny;

use super::between;
use crate::failure::{Failure, Kind};

/// `[mount]` of the configuration.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(try_from = "MountTable")]
pub struct MountSettings {
    /// The pose, that of the file if there is one.
    pose: MountConfig,
    file: Option<PathBuf>,
    /// Contents of the file besides the pose.
    calibration: Option<DeviceCalibration>,
}

/// The keys of `[mount]`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct MountTable {
    d_m: Option<f64>,
    position_m: Option<[f64; 3]>,
    rotation_deg: Option<[f64; 3]>,
    file: Option<PathBuf>,
}

/// The file of a mount: `[mount]`, and what a calibration adds.
#[derive(Debug, Deserialize)]
struct MountFile {
    mount: Option<MountTable>,
    #[serde(flatten)]
    calibration: DeviceCalibration,
    #[serde(rename = "evidence")]
    _evidence: Option<IgnoredAny>,
}

impl Deref for MountSettings {
    type Target = MountConfig;

    fn deref(&self) -> &MountConfig {
        &self.pose
    }
}

impl From<MountConfig> for MountSettings {
    fn from(pose: MountConfig) -> Self {
        Self {
            pose,
            ..Self::default()
        }
    }
}

impl MountTable {
    /// The pose; of a height that is not given the default, which only a configuration may leave
    /// out.
    fn pose(&self) -> MountConfig {
        let default = MountConfig::default();
        MountConfig {
            d_m: self.d_m.unwrap_or(default.d_m),
            position_m: self.position_m.unwrap_or(default.position_m),
            rotation_deg: self.rotation_deg.unwrap_or(default.rotation_deg),
        }
    }
}

impl TryFrom<MountTable> for MountSettings {
    type Error = &'static str;

    fn try_from(table: MountTable) -> Result<Self, &'static str> {
        let has_pose =
            table.d_m.is_some() || table.position_m.is_some() || table.rotation_deg.is_some();
        if table.file.is_some() && has_pose {
            return Err("mount.file holds the pose: omit d_m, position_m and rotation_deg");
        }
        Ok(Self {
            pose: table.pose(),
            file: table.file,
            calibration: None,
        })
    }
}

impl MountSettings {
    /// The pose.
    #[must_use]
    pub const fn pose(&self) -> MountConfig {
        self.pose
    }

    /// The calibration of axis and lasers, if a file gives one.
    #[must_use]
    pub const fn calibration(&self) -> Option<&DeviceCalibration> {
        self.calibration.as_ref()
    }

    /// Refuses impossible numbers.
    pub(super) fn check(&self) -> Result<(), String> {
        check(self.pose)
    }

    /// Reads the file that the configuration at `config` names, relative to its folder.
    pub(super) fn load_file(&mut self, config: &Path) -> Result<(), Failure> {
        let Some(file) = self.file.take() else {
            return Ok(());
        };
        *self = load_mount(&config.parent().unwrap_or(Path::new("")).join(file))?;
        Ok(())
    }
}

fn check(pose: MountConfig) -> Result<(), String> {
    between("mount.d_m", pose.d_m, -10.0, 10.0)?;
    for number in pose.position_m {
        between("mount.position_m", number, -10.0, 10.0)?;
    }
    for number in pose.rotation_deg {
        between("mount.rotation_deg", number, -360.0, 360.0)?;
    }
    Ok(())
}

/// The mount in a TOML file: its table `[mount]`, and the rest of a calibration if it has one.
///
/// # Errors
/// [`Kind::BadInput`] for an unreadable file, or one without a valid mount.
pub fn load_mount(path: &Path) -> Result<MountSettings, Failure> {
    let wrong = |what: String| {
        Failure::new(
            Kind::BadInput,
            format!("the mount {}: {what}", path.display()),
        )
        .help("give a TOML file with the height of the lidar above the tilt axis:\n[mount]\nd_m = 0.06")
    };
    let text = std::fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
    let file: MountFile =
        toml::from_str(&text).map_err(|error| wrong(super::toml_error(&text, &error)))?;
    // A height that is not given is unknown, not the default.
    let Some(table) = file.mount.filter(|mount| mount.d_m.is_some()) else {
        return Err(wrong("expected [mount] with d_m, found none".to_owned()));
    };
    if table.file.is_some() {
        return Err(wrong("mount.file is for the configuration".to_owned()));
    }
    let pose = table.pose();
    check(pose).map_err(wrong)?;
    let checked = file.calibration.check();
    checked.map_err(|error| wrong(error.to_string()))?;
    Ok(MountSettings {
        pose,
        file: None,
        calibration: (!file.calibration.is_empty()).then_some(file.calibration),
    })
}
