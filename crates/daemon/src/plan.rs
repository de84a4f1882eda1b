//! Estimate of a capture before anything moves: time, resolution, bytes.

use analysis::plan::{DRIVE_BYTES_S, PACKET_BYTES, ROW_BYTES};
use protocol::vlp16::models;

use crate::health_monitor::disk_full;
use crate::state::DaemonState;
use engine::capture::plan::CapturePlan;
use engine::capture::scan_planner::ScanPlanner;
use engine::capture_request::CaptureRequest;
use engine::failure::Failure;
use serde::Serialize;
use utoipa::ToSchema;

/// Bytes per second of the log of an unknown lidar: VLP-16 in dual return, 1508 packets of 1206
/// bytes with headers, position packets, and the drive.
const LOG_BYTES_S: f64 = 2.2e6;
/// Bytes of a data packet alone.
const PAYLOAD_BYTES: f64 = 1_206.0;
/// Channels of a packet.
const CHANNELS: f64 = 384.0;
/// Packets per second in dual return.
const PACKETS_S: f64 = 1_508.0;
/// Homing and the pause before the first sweep, seconds.
const BEFORE_S: f64 = 15.0;

/// Estimate of a capture.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(example = json!({
    "asked": {"speed_deg_s": 56.25, "both_ways": false}, "motor_rpm": 1_125, "cruise_deg_s": 56.25,
    "sweep_s": 0.9125, "moves_s": 0.9125, "step_deg": 5.625, "resolution_deg": 0.586,
    "gap_deg": 0.946, "error_mm": 9.81, "warning": null, "homing_s": 5.32, "frames": 9.125,
    "bytes": 31_259_975, "headline": ["56.25 deg/s is 1125 rpm of the motor"],
}))]
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
    /// Distance to the nearest point that 99 % of directions in view do not exceed, degrees.
    pub gap_deg: Option<f64>,
    /// Error that 95 % of points at 20 m do not exceed, millimetres.
    pub error_mm: Option<f64>,
    /// A slightly slower sweep that sees much more.
    pub warning: Option<String>,
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
    // A head that has just begun to turn has no rate yet.
    let rpm = lidar.rpm.filter(|rpm| *rpm >= 60.0);
    let config = state.service.config();
    let known_rpm = rpm.map(|rpm| rpm.round() as u32);
    let rpm = rpm.unwrap_or(f64::from(config.lidar.rpm));
    let sweeps = || plan.steps.iter().filter(|step| step.sweep);
    let seconds = |step: &engine::capture::moves::Step| step.plan.duration.as_secs_f64();
    let moves_s: f64 = plan.steps.iter().map(seconds).sum();
    let first = sweeps().next().map(|step| step.plan);
    // A lidar that has sent nothing yet counts as the configured one.
    let mut known = models::ALL.into_iter();
    let model = known.find(|known| Some(known.name) == lidar.model);
    // The configuration has been checked with the moves.
    let planner = ScanPlanner::of_capture(config, plan, model, known_rpm).ok();
    let row = planner.as_ref().map(|planner| planner.row(&plan.steps));
    CaptureEstimate {
        asked: asked.clone(),
        motor_rpm: first.map_or(0, |plan| plan.speed.0),
        cruise_deg_s: first.map_or(0.0, |plan| plan.cruise.0),
        sweep_s: first.map_or(0.0, |plan| plan.duration.as_secs_f64()),
        moves_s,
        step_deg: first.map(|plan| plan.cruise.0 * 60.0 / rpm),
        resolution_deg: row.as_ref().map(|row| row.resolution_deg),
        gap_deg: row.as_ref().map(|row| row.gap_deg.p99),
        error_mm: row.as_ref().map(|row| row.error_mm.total),
        warning: match (&planner, &row) {
            (Some(planner), Some(row)) => planner.resonance(asked, row),
            _ => None,
        },
        homing_s: planner
            .as_ref()
            .and_then(|planner| Some(planner.homing_s(state.service.angle_deg()?))),
        frames: first.map(|plan| plan.duration.as_secs_f64() * rpm / 60.0),
        bytes: bytes(state, plan),
        headline: plan.headline(),
    }
}

/// Bytes of disk space that a capture may need.
#[must_use]
pub fn bytes(state: &DaemonState, plan: &CapturePlan) -> u64 {
    let seconds = |sweep: bool| -> f64 {
        let steps = plan.steps.iter().filter(|step| step.sweep || !sweep);
        steps.map(|step| step.plan.duration.as_secs_f64()).sum()
    };
    let (packets_s, log_s) = match state.service.lidar().packets_per_s {
        rate if rate > 0.0 => (rate, rate * PACKET_BYTES + DRIVE_BYTES_S),
        _ => (PACKETS_S, LOG_BYTES_S),
    };
    let log_bytes = (seconds(false) + BEFORE_S) * log_s;
    (log_bytes + seconds(true) * packets_s * CHANNELS * ROW_BYTES) as u64
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
            Some(bytes(state, &plan))
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
