//! What a capture would be, before anything moves: time, resolution, bytes.

use std::path::PathBuf;

use protocol::vlp16::models;

use super::pulse::disk_full;
use super::shared::Shared;
use super::view::PlanView;
use engine::capture::request::{CapturePlan, CaptureRequest};
use engine::failure::Failure;

/// Bytes a second of the log where the lidar has not been heard: VLP-16 in dual return, 1508 packets of 1206 bytes with their heads, position
/// packets, and the drive.
const LOG_BYTES_S: f64 = 2.2e6;
/// Bytes of a packet and its frames in a log.
const PACKET_BYTES: f64 = 1_320.0;
/// Bytes of a data packet alone.
const PAYLOAD_BYTES: f64 = 1_206.0;
/// Bytes a second of the drive's share of a log: up to 1000 polls of two frames.
const DRIVE_BYTES_S: f64 = 2e5;
/// Rows of a PLY, and channels of a packet.
const ROW_BYTES: f64 = 29.0;
const CHANNELS: f64 = 384.0;
/// Packets a second in dual return.
const PACKETS_S: f64 = 1_508.0;
/// Homing and the rest before the first sweep, seconds.
const BEFORE_S: f64 = 15.0;
/// Turns a minute of a lidar that was not heard.
const RPM: f64 = 600.0;

/// The capture that is asked for, decided, with files named so.
///
/// # Errors
/// As [`CapturePlan::of`].
pub fn setup(
    shared: &Shared,
    asked: &CaptureRequest,
    cloud: PathBuf,
    log: PathBuf,
) -> Result<CapturePlan, Failure> {
    let device = (shared.name.as_str(), &shared.device);
    CapturePlan::of(asked, &shared.config, device, cloud, log)
}

/// What a capture would be.
#[must_use]
pub fn plan(shared: &Shared, asked: &CaptureRequest, setup: &CapturePlan) -> PlanView {
    let lidar = shared.lidar();
    let rpm = lidar.rpm.unwrap_or(RPM);
    let sweeps = || setup.steps.iter().filter(|step| step.sweep);
    let seconds = |step: &engine::capture::moves::Step| step.plan.duration.as_secs_f64();
    let moves_s: f64 = setup.steps.iter().map(seconds).sum();
    let sweeps_s: f64 = sweeps().map(seconds).sum();
    let first = sweeps().next().map(|step| step.plan);
    let packets_s = match lidar.packets_per_s {
        heard if heard > 0.0 => heard,
        _ => PACKETS_S,
    };
    let log_s = match lidar.packets_per_s {
        heard if heard > 0.0 => heard * PACKET_BYTES + DRIVE_BYTES_S,
        _ => LOG_BYTES_S,
    };
    let bytes = (moves_s + BEFORE_S) * log_s + sweeps_s * packets_s * CHANNELS * ROW_BYTES;
    PlanView {
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
        homing_s: homing_s(shared),
        frames: first.map(|plan| plan.duration.as_secs_f64() * rpm / 60.0),
        bytes: bytes as u64,
        headline: setup.headline(),
    }
}

/// The paper's vertical resolution: what is seen from the lowest laser at one end of a sweep to the highest at the other, shared by all lasers in
/// all turns, ramps left out. A lidar that was not heard is a VLP-16.
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

/// How long the axis takes to its home from where it stands: at the speed of the search, what it does around the switch left out.
fn homing_s(shared: &Shared) -> Option<f64> {
    let homing = &shared.config.axis.homing;
    let angle_deg = shared.drive().angle_deg?;
    Some((angle_deg - homing.to_deg).abs() / homing.speed_deg_s)
}

/// Most points of a log of so many bytes: all of it packets, and every channel of each a return.
#[must_use]
pub fn most_points(log_bytes: u64) -> u64 {
    (log_bytes as f64 / PAYLOAD_BYTES * CHANNELS) as u64
}

/// Most bytes of the cloud of a log of so many bytes.
#[must_use]
pub fn most_cloud_bytes(log_bytes: u64) -> u64 {
    (most_points(log_bytes) as f64 * ROW_BYTES) as u64
}

/// Bytes that the scans that are being recorded or made may need beyond what they have.
#[must_use]
pub fn still_needed(shared: &Shared) -> u64 {
    let under_way = shared.scans.under_way();
    let needed = under_way.iter().map(|scan| {
        let asked = scan.head.asked.as_ref();
        let planned = asked.and_then(|asked| {
            let setup = setup(shared, asked, "cloud".into(), "log".into()).ok()?;
            Some(plan(shared, asked, &setup).bytes)
        });
        // Of a log that was found nobody knows what it was to be: its cloud is to come.
        match planned {
            Some(whole) => whole.saturating_sub(scan.bytes),
            None => most_cloud_bytes(scan.log_bytes.unwrap_or(0)),
        }
    });
    needed.fold(0, u64::saturating_add)
}

/// What is said of room that is promised.
#[must_use]
pub fn promise(bytes: u64) -> String {
    match bytes {
        0 => String::new(),
        bytes => format!(
            ", a scan that is under way may still need {} MB",
            bytes.div_ceil(1_000_000)
        ),
    }
}

/// Refuses a capture for which there is no room.
///
/// # Errors
/// [`disk_full`], saying how much it would need.
pub fn fits(shared: &Shared, plan: &PlanView) -> Result<(), Failure> {
    let reserve = shared.settings().reserve_bytes;
    let Ok(free) = (shared.world.free_bytes)(shared.scans.folder()) else {
        return Ok(());
    };
    let promised = still_needed(shared);
    if free.saturating_sub(reserve).saturating_sub(promised) >= plan.bytes {
        return Ok(());
    }
    let failure = disk_full(free, reserve);
    let message = format!(
        "{}{}, and this scan may need {} MB",
        failure.message,
        promise(promised),
        plan.bytes / 1_000_000
    );
    Err(Failure { message, ..failure })
}
