//! Reports on the state of the drive and the axis.

use drive::cia402::{DeviceState, status};
use drive::{DeviceError, DriveIdentity, DriveStatus};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::status::AxisTask;

/// State of the drive.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(example = json!({
    "device": "epos2", "unit": "EPOS2 24/5", "state": "operation enabled", "statusword": 1_591,
    "mode": 1, "referenced": true, "angle_deg": -12.5, "position_qc": -8_333, "velocity_rpm": 0,
    "negative_limit": false, "positive_limit": false, "home_switch": false, "faults": [],
    "simulated": false, "power": true, "activity": "moving", "age_s": 0.02, "switches_age_s": 1.4,
    "warnings": [],
}))]
#[non_exhaustive]
pub struct AxisReport {
    /// Name of the device's profile.
    pub device: String,
    /// The drive: name, versions and serial number.
    pub unit: String,
    /// The drive's state (CiA 402).
    pub state: String,
    /// Statusword (6041).
    pub statusword: u16,
    /// Mode of operation (6061).
    pub mode: i8,
    /// Whether the axis is homed.
    pub referenced: bool,
    /// Angle, degrees; absent while the axis is not homed.
    pub angle_deg: Option<f64>,
    /// Position, quadcounts.
    pub position_qc: i32,
    /// Speed of the motor, revolutions per minute.
    pub velocity_rpm: i32,
    /// Whether the lower limit switch is pressed.
    pub negative_limit: bool,
    /// Whether the upper limit switch is pressed.
    pub positive_limit: bool,
    /// Whether the home switch is pressed.
    pub home_switch: bool,
    /// The error history, newest first.
    pub faults: Vec<DriveFault>,
    /// Whether the drive is simulated.
    pub simulated: bool,
    /// Whether the power stage is on.
    pub power: bool,
    /// What the axis is used for.
    pub activity: AxisTask,
    /// Age of state, power, angle and speed, seconds.
    pub age_s: f64,
    /// Age of switches and error history, seconds; absent if they have not been read.
    pub switches_age_s: Option<f64>,
    /// Warnings about the motion that this report is the answer to.
    #[serde(default)]
    pub warnings: Vec<String>,
}

/// An entry of the error history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct DriveFault {
    /// Four hexadecimal digits.
    pub code: String,
    /// Name in the Firmware Specification.
    pub name: Option<String>,
    /// Meaning.
    pub meaning: Option<String>,
    /// What to do about it.
    pub remedy: Option<String>,
}

/// Answer to `POST /tilt/stop` of a service that ends with its command.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct StoppedCommand {
    /// Name of the device's profile.
    pub device: String,
    /// Whether the axis was stopped.
    pub stopped: bool,
    /// The drive's state (CiA 402).
    pub state: String,
    /// Whether the power stage is on.
    pub power: bool,
}

/// Answer to `POST /tilt/stop`.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(example = json!({
    "device": "epos2", "unit": "EPOS2 24/5", "state": "switch-on disabled", "statusword": 33_088,
    "mode": 1, "referenced": true, "angle_deg": -12.5, "position_qc": -8_333, "velocity_rpm": 0,
    "negative_limit": false, "positive_limit": false, "home_switch": false, "faults": [],
    "simulated": false, "power": false, "activity": "idle", "age_s": 0.0, "switches_age_s": 0.0,
    "warnings": [],
}))]
#[serde(untagged)]
pub enum StopAnswer {
    /// Of a daemon: the drive's state.
    Report(Box<AxisReport>),
    /// Of a command.
    Command(StoppedCommand),
}

impl AxisReport {
    /// The report on the drive called `device`.
    #[must_use]
    pub fn new(device: &str, status: &DriveStatus, simulated: bool) -> Self {
        let mut report = Self {
            device: device.to_owned(),
            unit: unit(&status.identity),
            mode: status.mode,
            angle_deg: status.angle.map(|angle| angle.0),
            position_qc: status.position.0,
            velocity_rpm: status.velocity_rpm,
            negative_limit: status.inputs & 1 != 0,
            positive_limit: status.inputs & 2 != 0,
            home_switch: status.inputs & 4 != 0,
            faults: status.history.iter().map(|error| fault(*error)).collect(),
            simulated,
            switches_age_s: Some(0.0),
            ..Self::default()
        };
        report.set_statusword(status.statusword);
        report
    }

    /// Whether the drive is in its state of fault.
    #[must_use]
    pub fn is_in_fault(&self) -> bool {
        DeviceState::from_statusword(self.statusword) == Some(DeviceState::Fault)
    }

    /// Sets the statusword and what it shows.
    pub(crate) fn set_statusword(&mut self, statusword: u16) {
        self.statusword = statusword;
        self.state = state_name(statusword);
        self.referenced = is_referenced(statusword);
        self.power = has_power(statusword);
    }
}

/// Name, versions and serial number of a drive.
#[must_use]
pub fn unit(identity: &DriveIdentity) -> String {
    let DriveIdentity {
        name,
        software,
        hardware,
        serial,
        ..
    } = identity;
    format!("{name}, firmware {software:04X}, hardware {hardware:04X}, serial {serial:08X}")
}

/// Whether a statusword shows a homed axis.
pub(crate) const fn is_referenced(statusword: u16) -> bool {
    statusword & status::REFERENCED != 0
}

/// Whether a statusword shows that the power stage is on.
pub(crate) const fn has_power(statusword: u16) -> bool {
    statusword & status::VOLTAGE_ENABLED != 0
}

/// The name of the state that a statusword shows.
pub(crate) fn state_name(statusword: u16) -> String {
    DeviceState::from_statusword(statusword).map_or("unknown".to_owned(), |state| state.to_string())
}

/// Remedy of a fault that the public guides do not list.
const UNKNOWN: &str =
    "look the code up in the manual of the drive's firmware; then clear the fault";

/// A fault of the drive with its meaning and remedy.
#[must_use]
pub fn fault(error: DeviceError) -> DriveFault {
    let meaning = error.meaning();
    DriveFault {
        code: format!("{:04X}", error.0),
        name: meaning.map(|m| m.name.to_owned()),
        meaning: meaning.map(|m| m.meaning.to_owned()),
        remedy: Some(meaning.map_or(UNKNOWN, |m| m.remedy).to_owned()),
    }
}
