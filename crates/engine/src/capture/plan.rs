//! Planning of a capture, before a device is opened.

use std::path::PathBuf;

use scanner::{Accuracy, ScanConfig, SweepPlan};
use units::{DegPerS, DegPerS2, Degrees};

use crate::capture::moves::{self as motion, Step, SweepRequest};
use crate::capture_request::{CaptureRequest, MAX_SWEEPS};
use crate::config::{Config, Device};
use crate::devices::profile as devices;
use crate::failure::{Failure, Kind};
use crate::lidars;

/// The sweeps with the defaults of this axis and device filled in.
pub(super) fn sweep_request(
    request: &CaptureRequest,
    config: &Config,
    device: &Device,
) -> Result<SweepRequest, Failure> {
    let sweeps = request.sweep_count();
    if !(1..=MAX_SWEEPS).contains(&sweeps) {
        return Err(Failure::new(
            Kind::Usage,
            format!("sweeps: expected 1 to {MAX_SWEEPS}, got {sweeps}"),
        )
        .help("run several captures"));
    }
    Ok(SweepRequest {
        from: Degrees(request.from_deg.unwrap_or(config.axis.max_deg)),
        to: Degrees(request.to_deg.unwrap_or(config.axis.min_deg)),
        speed: DegPerS(request.speed_deg_s),
        acceleration: DegPerS2(request.accel_deg_s2.unwrap_or(device.accel_deg_s2)),
        sweeps,
        both_ways: request.both_ways,
    })
}

/// A checked capture: moves, files, metadata.
#[derive(Clone)]
pub struct CapturePlan {
    /// Name of the device's profile.
    pub name: String,
    /// The device.
    pub device: Device,
    /// Axis configuration of the drive client.
    pub axis: drive::AxisConfig,
    /// The moves.
    pub steps: Vec<Step>,
    /// Configuration stored in the log.
    pub scan: ScanConfig,
    /// Requested accuracy of the cloud.
    pub accuracy: Accuracy,
    /// Path of the cloud.
    pub cloud: PathBuf,
    /// Path of the log.
    pub log: PathBuf,
    /// Whether existing files are overwritten.
    pub force: bool,
}

impl CapturePlan {
    /// Checks the request against the axis and plans the moves.
    ///
    /// # Errors
    /// [`Kind::Usage`] for a request outside the axis's limits, [`Kind::BadInput`] for an invalid
    /// configuration.
    pub fn of(
        request: &CaptureRequest,
        config: &Config,
        (name, device): (&str, &Device),
        cloud: PathBuf,
        log: PathBuf,
    ) -> Result<Self, Failure> {
        let axis = devices::axis(&config.axis)?;
        let sweep_request = sweep_request(request, config, device)?;
        let steps = motion::steps(&sweep_request, &axis, Degrees(config.axis.homing.to_deg))?;
        let simulated = devices::simulated(device);
        Ok(Self {
            scan: scan_config(config, name, simulated, &sweep_request, &steps),
            name: name.to_owned(),
            device: device.clone(),
            axis,
            steps,
            accuracy: request.accuracy()?,
            cloud,
            log,
            force: false,
        })
    }

    /// Description of the first sweep as the drive will run it.
    #[must_use]
    pub fn headline(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if self.scan.simulated {
            lines.push(
                "SIMULATED: simulated devices in a generated hall, not a real scan".to_owned(),
            );
        }
        let Some(Step { plan, .. }) = self.steps.iter().find(|step| step.sweep) else {
            return lines;
        };
        let (requested, rpm) = (plan.requested.0, plan.speed.0);
        let rate = self.axis.gearing.rate(plan.speed).0;
        lines.push(match (rate - requested).abs() < 1e-9 {
            true => format!("{requested} deg/s is {rpm} rpm of the motor"),
            false => format!(
                "{requested} deg/s becomes {} deg/s, {rpm} rpm of the motor",
                trim(rate)
            ),
        });
        let shape = if plan.triangle {
            format!("too short for a cruise, peak {:.2} deg/s", plan.cruise.0)
        } else {
            format!("{:.3} s of cruise", plan.cruising.as_secs_f64())
        };
        lines.push(format!(
            "sweep {} to {} deg in {:.3} s: {shape}, ramps of {} deg/s2",
            trim(plan.from.0),
            trim(plan.to.0),
            plan.duration.as_secs_f64(),
            trim(self.axis.gearing.acceleration(plan.acceleration).0),
        ));
        lines
    }
}

/// Configuration stored in the log: speeds and accelerations as commanded, in whole rpm.
#[must_use]
pub fn scan_config(
    config: &Config,
    device: &str,
    simulated: bool,
    sweep_request: &SweepRequest,
    steps: &[Step],
) -> ScanConfig {
    let sweep = steps.iter().find(|step| step.sweep).map(|step| SweepPlan {
        from_deg: step.plan.from.0,
        to_deg: step.plan.to.0,
        cruise_deg_s: step.plan.cruise.0,
        accel_deg_s2: step.plan.cruise.0 / step.plan.ramp.as_secs_f64(),
        sweeps: sweep_request.sweeps,
        both_ways: sweep_request.both_ways,
    });
    ScanConfig {
        device: device.to_owned(),
        simulated,
        mount: config.mount.pose(),
        calibration: config.mount.calibration().cloned(),
        lidar: match simulated {
            true => lidars::simulated(),
            false => config.lidar.accuracy(),
        },
        axis: config.axis.scan(),
        sweep,
        ..ScanConfig::default()
    }
}

/// Rounds away floating-point noise.
fn trim(x: f64) -> f64 {
    (x * 1e6).round() / 1e6 + 0.0
}
