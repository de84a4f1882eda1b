//! Everything about a capture that is decided before a device is touched.

use std::path::PathBuf;

use scanner::{Accuracy, ScanConfig, SweepPlan, Tolerance};
use serde::{Deserialize, Serialize};
use units::{DegPerS, DegPerS2, Degrees};

use crate::capture::moves::{self as motion, Step, SweepRequest};
use crate::config::{Config, Device};
use crate::devices::profile as devices;
use crate::devices::simulated;
use crate::failure::{Failure, Kind};

/// A capture as it is asked for. What is left out is the axis's or the device's own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaptureRequest {
    /// Cruise speed of the tilt axis, degrees per second.
    pub speed_deg_s: f64,
    /// Angle where the sweep starts, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_deg: Option<f64>,
    /// Angle where it ends, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_deg: Option<f64>,
    /// Acceleration, degrees per second squared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accel_deg_s2: Option<f64>,
    /// How many sweeps; both ways 2, else 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweeps: Option<u32>,
    /// Whether the way back is a sweep too.
    #[serde(default)]
    pub both_ways: bool,
    /// How far off points may be at a distance, such as `2mm@20m`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<String>,
    /// What the scan is to be called, where it is kept by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
}

/// Most sweeps of one capture.
pub const MOST_SWEEPS: u32 = 10_000;

impl CaptureRequest {
    /// How accurate the cloud is to be.
    ///
    /// # Errors
    /// [`Kind::Usage`] for a tolerance that cannot be read.
    pub fn accuracy(&self) -> Result<Accuracy, Failure> {
        let Some(text) = &self.tolerance else {
            return Ok(Accuracy::Best);
        };
        let tolerance: Result<Tolerance, _> = text.parse();
        tolerance.map(Accuracy::Within).map_err(|error| {
            Failure::new(Kind::Usage, format!("tolerance: {error}"))
                .help("give a length at a distance, such as 2mm@20m")
        })
    }

    /// The same with every default of this axis and device put in.
    fn wish(&self, config: &Config, device: &Device) -> Result<SweepRequest, Failure> {
        let sweeps = self.sweeps.unwrap_or(if self.both_ways { 2 } else { 1 });
        if !(1..=MOST_SWEEPS).contains(&sweeps) {
            return Err(Failure::new(
                Kind::Usage,
                format!("sweeps: expected 1 to {MOST_SWEEPS}, got {sweeps}"),
            )
            .help("make several captures"));
        }
        Ok(SweepRequest {
            from: Degrees(self.from_deg.unwrap_or(config.axis.max_deg)),
            to: Degrees(self.to_deg.unwrap_or(config.axis.min_deg)),
            speed: DegPerS(self.speed_deg_s),
            acceleration: DegPerS2(self.accel_deg_s2.unwrap_or(device.accel_deg_s2)),
            sweeps,
            both_ways: self.both_ways,
        })
    }
}

/// A capture, decided.
pub struct CapturePlan {
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
    /// How accurate the cloud is to be.
    pub accuracy: Accuracy,
    /// Where the cloud goes.
    pub cloud: PathBuf,
    /// Where the log goes.
    pub log: PathBuf,
    /// Whether files that exist are overwritten.
    pub force: bool,
}

impl CapturePlan {
    /// Checks what was asked for against the axis, and plans the moves of a capture into these files.
    ///
    /// # Errors
    /// [`Kind::Usage`] for what this axis cannot do, [`Kind::BadInput`] for a wrong configuration.
    pub fn of(
        asked: &CaptureRequest,
        config: &Config,
        (name, device): (&str, &Device),
        cloud: PathBuf,
        log: PathBuf,
    ) -> Result<Self, Failure> {
        let axis = devices::axis(&config.axis)?;
        let wish = asked.wish(config, device)?;
        let steps = motion::steps(&wish, &axis, Degrees(config.axis.homing.to_deg))?;
        let simulated = devices::simulated(device);
        Ok(Self {
            scan: scan_config(config, name, simulated, &wish, &steps),
            name: name.to_owned(),
            device: device.clone(),
            axis,
            steps,
            accuracy: asked.accuracy()?,
            cloud,
            log,
            force: false,
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
    wish: &SweepRequest,
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
