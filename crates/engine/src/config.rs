//! The configuration file: devices and geometry of the scanner.
//!
//! Command-line values override the file, the file overrides the defaults. An unknown key is an
//! error with its line: a misspelt limit must not pass as no limit.

mod axis;
pub mod daemon;
mod device;
mod lidar;
mod mount;
pub mod origin;
pub mod ros2;

use std::path::{Path, PathBuf};

use serde::Deserialize;
use units::ShortNumber;

pub use axis::{AxisSettings, HomingSettings, LimitSwitchSettings, WithoutBrake};
pub use device::{Device, DeviceKind, Devices};
pub use lidar::LidarSettings;
pub use mount::{MountSettings, load_mount};

use crate::config::daemon::DaemonConfig;
use crate::failure::{Failure, Kind};

/// The whole file.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// `device = "NAME"`, or one `[device.NAME]` table per device and `[device] default = "NAME"`.
    pub device: Devices,
    /// Pose of the lidar on the tilt axis, or the file of a calibration.
    pub mount: MountSettings,
    /// The lidar; simulated devices have their own.
    pub lidar: LidarSettings,
    /// The tilt axis.
    pub axis: AxisSettings,
    /// The daemon.
    pub daemon: DaemonConfig,
}

/// Reads `file`, else the first existing default file, else returns the defaults.
///
/// # Errors
/// An unreadable or invalid file.
pub fn load(file: Option<&Path>) -> Result<Config, Failure> {
    let Some(path) = file.map(Path::to_owned).or_else(usual_place) else {
        return Ok(Config::default());
    };
    let text = std::fs::read_to_string(&path).map_err(|error| {
        Failure::new(
            Kind::BadInput,
            format!("cannot read the configuration {}: {error}", path.display()),
        )
        .help("name an existing text file with --config, or omit the option")
    })?;
    let mut config: Config = toml::from_str(&text).map_err(|error| {
        Failure::new(
            Kind::BadInput,
            format!(
                "the configuration {}, {}",
                path.display(),
                toml_error(&text, &error)
            ),
        )
        .help(format!(
            "correct that line; velomotion help {} shows every key",
            page(&text, &error)
        ))
    })?;
    config.check().map_err(|what| {
        Failure::new(
            Kind::BadInput,
            format!("the configuration {}: {what}", path.display()),
        )
        .help("correct that value; velomotion help wiring describes every key")
    })?;
    config.mount.load_file(&path)?;
    Ok(config)
}

impl Config {
    /// Refuses impossible numbers (TOML allows nan and inf).
    fn check(&self) -> Result<(), String> {
        self.mount.check()?;
        let lidar = &self.lidar;
        between("lidar.range_sd_m", lidar.accuracy().range_sd_m, 0.0, 10.0)?;
        let sheet = lidar.sheet;
        let rpm = sheet.check_rpm(lidar.rpm);
        rpm.map_err(|what| format!("lidar.rpm: {what}"))?;
        self.axis.check()?;
        let mut devices = self.device.profiles.iter();
        devices.try_for_each(|(name, device)| device.check(name))
    }
}

/// The page of the book that describes the table in which an error is.
fn page(text: &str, error: &toml::de::Error) -> &'static str {
    let end = error.span().map_or(0, |span| span.end);
    let tables = text.get(..end).unwrap_or(text).lines().rev();
    let table = tables.map(str::trim).find(|line| line.starts_with('['));
    match table.unwrap_or_default() {
        table if table.starts_with("[daemon.ros2") => "ros2",
        table if table.starts_with("[daemon") => "daemon",
        _ => "wiring",
    }
}

/// An error of TOML in one line, with its place.
fn toml_error(text: &str, error: &toml::de::Error) -> String {
    let message = error.message().trim().replace('\n', ", ");
    let Some(span) = error.span() else {
        return message;
    };
    let before = text.get(..span.start).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = before.matches('\n').count() + 1;
    let column = before.get(line_start..).unwrap_or_default().chars().count() + 1;
    let rest = text.get(line_start..).unwrap_or_default();
    let quoted = rest.lines().next().unwrap_or_default().trim();
    format!("line {line}, column {column}: {message}: {quoted}")
}

/// Refuses a number outside `low..=high`, NaN included.
fn between(name: &str, value: f64, low: f64, high: f64) -> Result<(), String> {
    match (low..=high).contains(&value) {
        true => Ok(()),
        false => Err(format!(
            "{name}: expected a number from {low} to {high}, got {}",
            ShortNumber(value)
        )),
    }
}

/// Refuses a number that is not above 0 or exceeds `high`: these quantities have no sign.
fn positive(name: &str, value: f64, high: f64) -> Result<(), String> {
    match value > 0.0 && value <= high {
        true => Ok(()),
        false => Err(format!(
            "{name}: expected a number above 0 up to {high}, got {}",
            ShortNumber(value)
        )),
    }
}

/// The configuration that is read without `--config`, if there is one.
#[must_use]
pub fn usual_place() -> Option<PathBuf> {
    let var = |name| std::env::var_os(name).map(PathBuf::from);
    let system = if cfg!(windows) { var("APPDATA") } else { None };
    let home = || var("HOME").map(|home| home.join(".config"));
    let user = var("XDG_CONFIG_HOME").or(system).or_else(home);
    [
        Some(PathBuf::from("velomotion.toml")),
        user.map(|dir| dir.join("velomotion/velomotion.toml")),
        Some(PathBuf::from("/etc/velomotion/velomotion.toml")),
    ]
    .into_iter()
    .flatten()
    .find(|path| path.is_file())
}

#[cfg(test)]
mod tests;
