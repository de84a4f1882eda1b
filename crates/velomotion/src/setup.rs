//! Everything about a capture that is decided before a device is touched.

use std::path::PathBuf;
use std::time::SystemTime;

use scanner::{ScanConfig, SweepPlan};
use units::{DegPerS, DegPerS2, Degrees};

use crate::cli::{self, Common};
use crate::config::{self, Config, Device};
use crate::failure::Failure;
use crate::motion::{self, Step, Wish};
use crate::{devices, names, output, simulated};

/// A capture, decided.
pub struct Setup {
    /// Name of the device's profile.
    pub name: String,
    /// The device.
    pub device: Device,
    /// The axis as its client knows it.
    pub axis: drive::AxisConfig,
    /// The moves.
    pub steps: Vec<Step>,
    /// What the log carries.
    pub scan: ScanConfig,
    /// Where the cloud goes.
    pub cloud: PathBuf,
    /// Where the log goes.
    pub log: PathBuf,
    /// Whether files that exist are overwritten.
    pub force: bool,
}

impl Setup {
    /// Checks what was asked for against the axis, and plans the moves.
    ///
    /// # Errors
    /// [`Kind::Usage`](crate::failure::Kind::Usage) for what this axis cannot do or names that clash, [`Kind::BadInput`](crate::failure::Kind::BadInput) for a wrong configuration,
    /// [`Kind::NoDevice`](crate::failure::Kind::NoDevice) where none is plugged in.
    pub fn new(arguments: &cli::Capture, common: &Common) -> Result<Self, Failure> {
        let start = SystemTime::now();
        let config = config::load(common.config.as_deref())?;
        let (name, device) = devices::choose(&config, common.device.as_deref())?;
        let axis = devices::axis(&config.axis)?;
        let wish = Wish {
            from: Degrees(arguments.from.unwrap_or(config.axis.max_deg)),
            to: Degrees(arguments.to.unwrap_or(config.axis.min_deg)),
            speed: DegPerS(arguments.speed),
            acceleration: DegPerS2(arguments.accel.unwrap_or(device.accel_deg_s2)),
            sweeps: arguments
                .sweeps
                .unwrap_or(if arguments.both_ways { 2 } else { 1 }),
            both_ways: arguments.both_ways,
        };
        let steps = motion::steps(&wish, &axis, Degrees(config.axis.homing.to_deg))?;
        let simulated = devices::simulated(&device);
        let cloud = arguments
            .output
            .output
            .clone()
            .unwrap_or_else(|| names::cloud(start, simulated));
        let log = arguments
            .log
            .clone()
            .unwrap_or_else(|| names::log_of(&cloud, start, simulated));
        output::two_files(&log, &cloud)?;
        Ok(Self {
            scan: scan_config(&config, &name, simulated, &wish, &steps),
            name,
            device,
            axis,
            steps,
            cloud,
            log,
            force: arguments.output.force,
        })
    }

    /// What is about to happen, as the drive will do it.
    #[must_use]
    pub fn headline(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if self.scan.simulated {
            lines.push(
                "SIMULATED: software devices in a made-up hall, no scan of anything real"
                    .to_owned(),
            );
        }
        let Some(Step { plan, .. }) = self.steps.iter().find(|step| step.sweep) else {
            return lines;
        };
        lines.push(format!(
            "{} deg/s is {} rpm of the motor, {} deg/s",
            plan.requested.0,
            plan.speed.0,
            trim(self.axis.gearing.rate(plan.speed).0)
        ));
        let shape = if plan.triangle {
            format!("too short to cruise, peak {:.2} deg/s", plan.cruise.0)
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

/// What the log carries: speeds and accelerations as they are commanded, in whole rpm.
#[must_use]
pub fn scan_config(
    config: &Config,
    device: &str,
    simulated: bool,
    wish: &Wish,
    steps: &[Step],
) -> ScanConfig {
    let sweep = steps.iter().find(|step| step.sweep).map(|step| SweepPlan {
        from_deg: step.plan.from.0,
        to_deg: step.plan.to.0,
        cruise_deg_s: step.plan.cruise.0,
        accel_deg_s2: step.plan.cruise.0 / step.plan.ramp.as_secs_f64(),
        sweeps: wish.sweeps,
        both_ways: wish.both_ways,
    });
    ScanConfig {
        device: device.to_owned(),
        simulated,
        mount: config.mount,
        lidar: match simulated {
            true => simulated::lidar(),
            false => config.lidar,
        },
        axis: config.axis.scan(),
        sweep,
        ..ScanConfig::default()
    }
}

/// A number without the noise of its last bits.
fn trim(x: f64) -> f64 {
    (x * 1e6).round() / 1e6 + 0.0
}
