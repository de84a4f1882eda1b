//! Status of the devices and of what they do, in the form that clients read (docs/src/daemon.md).

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::axis_report::DriveFault;
use crate::failure::Failure;

/// What the axis is used for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum AxisTask {
    /// Nothing.
    #[default]
    Idle,
    /// The drive was found and is being configured.
    Connecting,
    /// The axis searches its home position.
    Homing,
    /// The axis moves to an angle.
    Moving,
    /// A scan is recorded.
    Capturing,
    /// The axis is being stopped, or a short request is under way.
    Stopping,
}

impl AxisTask {
    /// The task in a message.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::Capturing => "a scan is recorded",
            Self::Homing => "it is homing",
            Self::Moving => "it moves",
            Self::Connecting => "the drive is being set up",
            Self::Stopping | Self::Idle => "it is being stopped",
        }
    }
}

/// The task of the axis and its progress.
#[derive(Clone, Debug, Default, PartialEq, Serialize, ToSchema)]
#[schema(example = json!({
    "doing": "capturing", "scan": "2026-05-04-101500", "homes": false, "step": 1, "steps": 1,
    "from_deg": 0.0, "to_deg": -45.0, "left_s": 0.4, "received": 377,
}))]
#[non_exhaustive]
pub struct Activity {
    /// The task.
    pub doing: AxisTask,
    /// Id of the scan.
    pub scan: Option<String>,
    /// Whether the task only reads the drive's state.
    #[serde(skip)]
    pub reads_only: bool,
    /// Whether the axis is homing, which every capture begins with.
    pub homes: bool,
    /// Number of the move, from 1; 0 before the first.
    pub step: usize,
    /// Number of moves.
    pub steps: usize,
    /// Start of the move, degrees.
    pub from_deg: Option<f64>,
    /// End of the move, degrees.
    pub to_deg: Option<f64>,
    /// Time left of the move, seconds.
    pub left_s: Option<f64>,
    /// Lidar packets of this capture so far.
    pub received: u64,
}

/// State of a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum DeviceHealth {
    /// Not connected.
    #[default]
    Absent,
    /// Connected and without fault.
    Connected,
    /// Connected, with a fault or another problem.
    Fault,
}

/// The drive as the status shows it: what it reported last, and whether it is connected.
#[derive(Clone, Debug, Default, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct DriveSnapshot {
    /// State.
    pub state: DeviceHealth,
    /// What is wrong and what to do about it.
    pub problem: Option<Failure>,
    /// Port.
    pub port: Option<String>,
    /// usb, rs232 or can.
    #[schema(schema_with = crate::document::links)]
    pub link: Option<&'static str>,
    /// State of the CiA 402 state machine.
    pub cia402: Option<String>,
    /// Whether the axis is homed.
    pub referenced: bool,
    /// Angle of the axis, degrees; absent while unknown.
    pub angle_deg: Option<f64>,
    /// Speed of the axis, degrees per second.
    pub speed_deg_s: f64,
    /// Error history, newest first.
    pub faults: Vec<DriveFault>,
}

/// The lidar.
#[derive(Clone, Debug, Default, PartialEq, Serialize, ToSchema)]
#[schema(example = json!({
    "state": "connected", "problem": null, "model": "VLP-16", "return_mode": "strongest",
    "rpm": 600.0, "received": 90_512, "packets_per_s": 905.0, "lost_packets": 0, "dropped_by_kernel": 0,
}))]
#[non_exhaustive]
pub struct LidarStatus {
    /// State.
    pub state: DeviceHealth,
    /// What is wrong and what to do about it.
    pub problem: Option<Failure>,
    /// Model.
    pub model: Option<&'static str>,
    /// strongest, last or dual.
    #[schema(schema_with = crate::document::return_modes)]
    pub return_mode: Option<String>,
    /// Revolutions per minute.
    pub rpm: Option<f64>,
    /// Data and position packets so far.
    pub received: u64,
    /// Packets in the last second.
    pub packets_per_s: f64,
    /// Data packets missing by the lidar's own time.
    pub lost_packets: u64,
    /// Packets dropped by the kernel because this program was too slow.
    pub dropped_by_kernel: u64,
}

/// Limits and defaults of the axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct AxisStatus {
    /// Smallest angle, degrees.
    pub min_deg: f64,
    /// Largest angle, degrees.
    pub max_deg: f64,
    /// Highest speed, degrees per second.
    pub max_speed_deg_s: f64,
    /// Lowest speed: one revolution of the motor per minute.
    pub min_speed_deg_s: f64,
    /// Highest acceleration, degrees per second squared.
    pub max_accel_deg_s2: f64,
    /// Default acceleration, degrees per second squared.
    pub accel_deg_s2: f64,
    /// Angle at which homing ends, degrees.
    pub home_deg: f64,
}

/// The disk of the scans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, ToSchema)]
pub struct DiskStatus {
    /// Free bytes; absent where the system does not report them.
    pub free_bytes: Option<u64>,
    /// Bytes that are left free.
    pub reserve_bytes: u64,
    /// Scans kept.
    pub scans: u64,
    /// Bytes of the scans.
    pub scans_bytes: u64,
    /// Limit of the number of scans.
    pub keep_scans: u64,
    /// Limit of their bytes.
    pub keep_bytes: u64,
}

/// Event clients.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct ClientsStatus {
    /// Connected clients.
    pub events: usize,
    /// Clients disconnected because they did not read.
    pub dropped: u64,
}

/// Status of the whole service: the body of `GET /api/v1/status`.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(example = json!({
    "version": "0.1.0", "device": "epos2", "simulated": false, "started_s": 1_795_684_672.186,
    "now_s": 1_795_684_684.279, "stops": 0,
    "activity": {
        "doing": "idle", "scan": null, "homes": false, "step": 0, "steps": 0, "from_deg": null,
        "to_deg": null, "left_s": null, "received": 0,
    },
    "drive": {
        "state": "connected", "problem": null, "port": "/dev/ttyUSB0", "link": "rs232",
        "cia402": "switch-on disabled", "referenced": true, "angle_deg": -45.0, "speed_deg_s": 0.0,
        "faults": [],
    },
    "lidar": {
        "state": "connected", "problem": null, "model": "VLP-16", "return_mode": "strongest",
        "rpm": 600.0, "received": 10_849, "packets_per_s": 754.0, "lost_packets": 0,
        "dropped_by_kernel": 0,
    },
    "axis": {
        "min_deg": -45.0, "max_deg": 0.0, "max_speed_deg_s": 98.0, "min_speed_deg_s": 0.05,
        "max_accel_deg_s2": 10_000.0, "accel_deg_s2": 500.0, "home_deg": 0.0,
    },
    "disk": {
        "free_bytes": 48_911_720_448_u64, "reserve_bytes": 1_000_000_000, "scans": 1,
        "scans_bytes": 10_819_191, "keep_scans": 100, "keep_bytes": 50_000_000_000_u64,
    },
    "clients": {"events": 0, "dropped": 0},
}))]
#[non_exhaustive]
pub struct ServiceStatus {
    /// Version of the program.
    pub version: &'static str,
    /// Name of the device's profile.
    pub device: String,
    /// Whether the devices are simulated.
    pub simulated: bool,
    /// Start of the service, Unix seconds.
    pub started_s: f64,
    /// Time of this status, Unix seconds.
    pub now_s: f64,
    /// Stops of the axis that clients have requested since the start. Send it as `Velomotion-Stops`
    /// with a request that moves the axis.
    pub stops: u64,
    /// Task of the axis.
    pub activity: Activity,
    /// The drive.
    pub drive: DriveSnapshot,
    /// The lidar.
    pub lidar: LidarStatus,
    /// The axis.
    pub axis: AxisStatus,
    /// The disk.
    pub disk: DiskStatus,
    /// Clients.
    pub clients: ClientsStatus,
}
