//! What the daemon says about itself, as its clients read it (docs/src/daemon.md).

use serde::Serialize;

use engine::capture::request::CaptureRequest;
use engine::failure::Failure;

/// What is being done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Doing {
    /// Nothing.
    #[default]
    Idle,
    /// The drive was found and is being set up.
    Connecting,
    /// The axis searches its zero.
    Homing,
    /// The axis moves by hand.
    Moving,
    /// A scan is recorded.
    Capturing,
    /// The axis is being stopped, or asked something that takes a moment.
    Stopping,
}

/// What is being done, and how far it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Activity {
    /// What.
    pub doing: Doing,
    /// The scan's id.
    pub scan: Option<String>,
    /// Whether the drive is only asked something.
    #[serde(skip)]
    pub only_asks: bool,
    /// Whether the axis searches its home: first of all in a capture.
    pub homes: bool,
    /// Which move, from 1; 0 before the first.
    pub step: usize,
    /// Of how many.
    pub steps: usize,
    /// The move's begin.
    pub from_deg: Option<f64>,
    /// The move's end.
    pub to_deg: Option<f64>,
    /// How long it will still take.
    pub left_s: Option<f64>,
    /// Lidar packets of this capture so far.
    pub packets: u64,
}

/// How a device is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DeviceState {
    /// Not there.
    #[default]
    Absent,
    /// As it should be.
    Connected,
    /// There, and wrong.
    Fault,
}

/// The drive.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DriveView {
    /// How it is.
    pub state: DeviceState,
    /// What is wrong and what to do about it.
    pub problem: Option<Failure>,
    /// Its port.
    pub port: Option<String>,
    /// usb, rs232 or can.
    pub link: Option<&'static str>,
    /// Its own state (CiA 402).
    pub cia402: Option<String>,
    /// Whether the axis knows where it is.
    pub referenced: bool,
    /// Where the axis is; absent while that is not known.
    pub angle_deg: Option<f64>,
    /// How fast it moves.
    pub speed_deg_s: f64,
    /// Its error history, newest first.
    pub faults: Vec<engine::capture::jog::Fault>,
}

/// The lidar.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LidarView {
    /// How it is.
    pub state: DeviceState,
    /// What is wrong and what to do about it.
    pub problem: Option<Failure>,
    /// Its model.
    pub model: Option<&'static str>,
    /// strongest, last or dual.
    pub return_mode: Option<String>,
    /// Turns a minute.
    pub rpm: Option<f64>,
    /// Data and position packets so far.
    pub packets: u64,
    /// The same in the last second.
    pub packets_per_s: f64,
    /// Data packets that are missing by the lidar's own time.
    pub lost_packets: u64,
    /// Packets for which this machine was too slow.
    pub dropped_by_kernel: u64,
}

/// What the axis may do, and what is used where nothing is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AxisView {
    /// Smallest angle.
    pub min_deg: f64,
    /// Largest angle.
    pub max_deg: f64,
    /// Largest speed.
    pub max_speed_deg_s: f64,
    /// Slowest: one turn of the motor a minute.
    pub min_speed_deg_s: f64,
    /// Largest acceleration.
    pub max_accel_deg_s2: f64,
    /// Acceleration that is used.
    pub accel_deg_s2: f64,
    /// Where homing ends.
    pub home_deg: f64,
}

/// The disk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct DiskView {
    /// Free; absent where the system does not tell.
    pub free_bytes: Option<u64>,
    /// What is left free.
    pub reserve_bytes: u64,
    /// Scans that are kept.
    pub scans: u64,
    /// Bytes of them.
    pub scans_bytes: u64,
    /// Most scans.
    pub keep_scans: u64,
    /// Most bytes of them.
    pub keep_bytes: u64,
}

/// Clients of the live events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ClientsView {
    /// Now.
    pub events: usize,
    /// Disconnected since the start because they did not read.
    pub dropped: u64,
}

/// The whole.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Status {
    /// Version of the program.
    pub version: &'static str,
    /// Name of the device's profile.
    pub device: String,
    /// Whether the devices are software.
    pub simulated: bool,
    /// When the daemon was started, Unix seconds.
    pub started_s: f64,
    /// Now, Unix seconds.
    pub now_s: f64,
    /// What is being done.
    pub activity: Activity,
    /// The drive.
    pub drive: DriveView,
    /// The lidar.
    pub lidar: LidarView,
    /// The axis.
    pub axis: AxisView,
    /// The disk.
    pub disk: DiskView,
    /// Clients.
    pub clients: ClientsView,
}

/// What a capture would be.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanView {
    /// What was asked for.
    pub asked: CaptureRequest,
    /// Speed of the motor, whole.
    pub motor_rpm: u32,
    /// The tilt speed that gives; a sweep too short for it does not reach it.
    pub cruise_deg_s: f64,
    /// One sweep.
    pub sweep_s: f64,
    /// All moves, without homing.
    pub moves_s: f64,
    /// Tilt between two turns of the lidar, degrees: the resolution where a beam stands across the tilt axis.
    pub step_deg: Option<f64>,
    /// Mean angle between neighbouring rays one above the other: what all lasers see while the axis sweeps, shared by so many lasers in so many turns.
    pub resolution_deg: Option<f64>,
    /// Homing before the first move, seconds, about; absent while the axis does not know where it is.
    pub homing_s: Option<f64>,
    /// Turns of the lidar in a sweep.
    pub frames: Option<f64>,
    /// Bytes that it may need of the disk.
    pub bytes: u64,
    /// The same in the words of the command.
    pub headline: Vec<String>,
}
