//! Estimate of a capture before anything moves: time, resolution, bytes.

use protocol::vlp16::models;

use crate::health_monitor::disk_full;
use crate::state::DaemonState;
use engine::capture::request::CapturePlan;
use engine::capture_request::CaptureRequest;
use engine::failure::Failure;
use serde::Serialize;
use utoipa::ToSchema;

/// Bytes per second of the log of an unknown lidar: VLP-16 in dual return, 1508 packets of 1206
/// bytes with headers, position packets, and the drive.
const LOG_BYTES_S: f64 = 2.2e6;
/// Bytes of a packet and its frames in a log.
const PACKET_BYTES: f64 = 1_320.0;
/// Bytes of a data packet alone.
const PAYLOAD_BYTES: f64 = 1_206.0;
/// Bytes per second of the drive's part of a log: up to 1000 polls of two frames.
const DRIVE_BYTES_S: f64 = 2e5;
/// Rows of a PLY, and channels of a packet.
const ROW_BYTES: f64 = 29.0;
const CHANNELS: f64 = 384.0;
/// Packets per second in dual return.
const PACKETS_S: f64 = 1_508.0;
/// Homing and the pause before the first sweep, seconds.
const BEFORE_S: f64 = 15.0;
/// Revolutions per minute of an unknown lidar.
const RPM: f64 = 600.0;

/// Estimate of a capture.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct CaptureEstimate {
    /// The request.
    pub asked: CaptureRequest,
    /// Speed of the motor, whole revolutions per minute.
    pub motor_rpm: u32,
    /// Tilt speed at this motor speed; short sweeps do not reach it.
    pub cruise_deg_s: f64,
    /// Time of one sweep.
    pub sweep_s: f64,
    /// Time of all moves, without homing.
    pub moves_s: f64,
    /// Tilt between two revolutions of the lidar, degrees: the resolution where a beam is
    /// perpendicular to the tilt axis.
    pub step_deg: Option<f64>,
    /// Mean angle between rays that are neighbours in elevation.
    pub resolution_deg: Option<f64>,
    /// Estimated time of homing, seconds; absent while the axis is not homed.
    pub homing_s: Option<f64>,
    /// Revolutions of the lidar per sweep.
    pub frames: Option<f64>,
    /// Bytes of disk space that it may need.
    pub bytes: u64,
    /// The same as text.
    pub headline: Vec<String>,
}

/// Estimates a capture.
#[must_use]
pub fn estimate(
    state: &DaemonState,
    asked: &CaptureRequest,
    plan: &CapturePlan,
) -> CaptureEstimate {
    let lidar = state.service.lidar();
    let rpm = lidar.rpm.unwrap_or(RPM);
    let sweeps = || plan.steps.iter().filter(|step| step.sweep);
    let seconds = |step: &engine::capture::moves::Step| step.plan.duration.as_secs_f64();
    let moves_s: f64 = plan.steps.iter().map(seconds).sum();
    let sweeps_s: f64 = sweeps().map(seconds).sum();
    let first = sweeps().next().map(|step| step.plan);
    let packets_s = match lidar.packets_per_s {
        rate if rate > 0.0 => rate,
        _ => PACKETS_S,
    };
    let log_s = match lidar.packets_per_s {
        rate if rate > 0.0 => rate * PACKET_BYTES + DRIVE_BYTES_S,
        _ => LOG_BYTES_S,
    };
    let bytes = (moves_s + BEFORE_S) * log_s + sweeps_s * packets_s * CHANNELS * ROW_BYTES;
    CaptureEstimate {
        asked: asked.clone(),
        motor_rpm: first.map_or(0, |plan| plan.speed.0),
        cruise_deg_s: first.map_or(0.0, |plan| plan.cruise.0),
        sweep_s: first.map_or(0.0, |plan| plan.duration.as_secs_f64()),
        moves_s,
        step_deg: first.map(|plan| plan.cruise.0 * 60.0 / rpm),
        resolution_deg: first.map(|plan| {
            let tilt_deg = (plan.to.0 - plan.from.0).abs();
            let turns = tilt_deg / plan.cruise.0.abs() * rpm / 60.0;
            resolution_deg(lidar.model, tilt_deg, turns)
        }),
        homing_s: homing_s(state),
        frames: first.map(|plan| plan.duration.as_secs_f64() * rpm / 60.0),
        bytes: bytes as u64,
        headline: plan.headline(),
    }
}

/// The paper's vertical resolution: the angle from the lowest laser at one end of a sweep to the
/// highest at the other, divided by all lasers in all revolutions, without ramps. An unknown lidar
/// counts as a VLP-16.
fn resolution_deg(model: Option<&str>, tilt_deg: f64, turns: f64) -> f64 {
    let known = models::ALL
        .into_iter()
        .find(|known| Some(known.name) == model);
    let lasers = known.unwrap_or(&models::VLP_16).lasers;
    let angles = lasers.iter().map(|laser| laser.elevation_deg);
    let (low, high) = angles.fold((f64::MAX, f64::MIN), |(low, high), at| {
        (low.min(at), high.max(at))
    });
    let count = u32::try_from(lasers.len()).unwrap_or(u32::MAX);
    analysis::device::vertical_resolution_deg(tilt_deg + high - low, count, turns)
}

/// Time of homing from the present angle at the speed of the search, without the search of the
/// edge.
fn homing_s(state: &DaemonState) -> Option<f64> {
    let homing = &state.service.config().axis.homing;
    let angle_deg = state.service.angle_deg()?;
    Some((angle_deg - homing.to_deg).abs() / homing.speed_deg_s)
}

/// Largest number of points of a log: packets with a return in every channel.
#[must_use]
pub fn most_points(log_bytes: u64) -> u64 {
    (log_bytes as f64 / PAYLOAD_BYTES * CHANNELS) as u64
}

/// Largest size of the cloud of a log, bytes.
#[must_use]
pub fn most_cloud_bytes(log_bytes: u64) -> u64 {
    (most_points(log_bytes) as f64 * ROW_BYTES) as u64
}

/// Bytes that scans being recorded or made may still need.
fn still_needed(state: &DaemonState) -> u64 {
    let under_way = state.scans.under_way();
    let needed = under_way.iter().map(|scan| {
        let asked = scan.head.request.as_ref();
        let planned = asked.and_then(|asked| {
            let plan = state
                .service
                .plan(asked, "cloud".into(), "log".into())
                .ok()?;
            Some(estimate(state, asked, &plan).bytes)
        });
        // The request of a log found on disk is unknown; its cloud is still to be made.
        match planned {
            Some(whole) => whole.saturating_sub(scan.bytes),
            None => most_cloud_bytes(scan.log_bytes.unwrap_or(0)),
        }
    });
    needed.fold(0, u64::saturating_add)
}

/// Refuses bytes that do not fit next to the reserve and the scans under way; `need` names them.
///
/// # Errors
/// Returns `disk_full` with the bytes needed.
pub fn check_room(state: &DaemonState, bytes: u64, need: &str) -> Result<(), Failure> {
    let reserve = state.settings().reserve_bytes;
    let Ok(free) = (state.free_bytes)(state.scans.folder()) else {
        return Ok(());
    };
    let promised = still_needed(state);
    if free.saturating_sub(reserve).saturating_sub(promised) >= bytes {
        return Ok(());
    }
    let failure = disk_full(free, reserve);
    let under_way = match promised {
        0 => String::new(),
        bytes => format!(
            ", a scan that is under way may still need {} MB",
            bytes.div_ceil(1_000_000)
        ),
    };
    let message = format!("{}{under_way}, and {need}", failure.message);
    Err(Failure { message, ..failure })
}
