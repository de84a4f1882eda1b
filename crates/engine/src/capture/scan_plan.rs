//! Plans of captures: what a request gives and costs, and the settings that meet limits.
//!
//! `analysis::plan` predicts; the moves are those that [`super::moves`] plans for the drive.

use analysis::plan::{
    ErrorModel, LinkTiming, PlanLaser, PlanLidar, PlanLimits, PlanRow, PlannedScan, ScanPredictor,
    ScanSetting, TiltSweep,
};
use drive::AxisConfig;
use protocol::vlp16::Model;
use serde::Serialize;
use units::{Degrees, Rpm};
use utoipa::ToSchema;

use super::moves::{self, Step};
use super::request::{CapturePlan, sweep_request};
use crate::capture_request::CaptureRequest;
use crate::config::{Config, Device, DeviceKind};
use crate::devices::{profile, simulated};
use crate::failure::{Failure, Kind};

/// What a plan is about.
#[derive(Clone, Debug)]
pub struct PlanRequest {
    /// Distance from the tilt axis, metres.
    pub at_m: f64,
    /// The limits.
    pub limits: PlanLimits,
    /// The lidar.
    pub model: &'static Model,
    /// Revolutions of the lidar per minute to choose from.
    pub rpm: Vec<u32>,
    /// Standard deviation of a range, metres; the configuration's without it.
    pub range_sd_m: Option<f64>,
    /// Standard deviation of mount and zero of the tilt, degrees; they count as exact without it.
    pub mount_sd_deg: Option<f64>,
    /// Ends of the sweep, degrees; those of the axis without them.
    pub from_deg: Option<f64>,
    /// The other end.
    pub to_deg: Option<f64>,
    /// Where the axis rests before the scan; without it where the scan before ended.
    pub rest_deg: Option<f64>,
}

/// A row with its command.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct CommandRow {
    /// The capture.
    pub command: String,
    /// What it gives.
    #[serde(flatten)]
    pub row: PlanRow,
}

/// A plan.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PlanReport {
    /// The device.
    pub device: String,
    /// Whether it is software.
    pub simulated: bool,
    /// Model of the lidar.
    pub lidar: String,
    /// Distance of gaps and errors, metres.
    pub at_m: f64,
    /// Settings that no other beats in time, 99 % gap and error at once, one for each class of scan
    /// time.
    pub rows: Vec<CommandRow>,
    /// The fastest setting within the limits; with a limit of time only, the densest. Null without
    /// limits, and if no setting meets them.
    pub chosen: Option<CommandRow>,
    /// Why no setting meets the limits.
    pub unmet: Option<String>,
    /// What the figures assume.
    pub assumptions: Vec<String>,
}

/// Distance at which a capture reports gaps and errors, metres.
pub const USUAL_M: f64 = 20.0;
/// Rate of an unknown lidar, revolutions per minute: the factory setting of a VLP-16.
pub const USUAL_RPM: u32 = 600;
/// Time of homing besides the way: checks, ramps, and the edge of the switch; seconds. Measured in
/// virtual time over USB, as `STEP_S`.
const HOMING_S: f64 = 0.62;
/// Time between two moves: at rest before and after, and the commands; seconds.
const STEP_S: f64 = 0.15;
/// Ramps to choose from, as parts of the device's: a gentler one loads no head more.
const RAMPS: [f64; 4] = [1.0, 0.5, 0.25, 0.1];
/// Numbers of sweeps to choose from.
const SWEEPS: [u32; 2] = [1, 2];
/// Ratios of neighbouring speeds: of the search, and of the table.
const FINE: f64 = 1.01;
const COARSE: f64 = 1.45;
/// Ratio of a speed to a slower one that should see no more.
const SLOWER: f64 = 0.95;
/// Ratio of their gaps that is a resonance.
const RESONANCE: f64 = 1.15;

/// Plans captures with one device.
pub struct ScanPlanner {
    config: Config,
    name: String,
    device: Device,
    axis: AxisConfig,
    request: PlanRequest,
    predictor: ScanPredictor,
}

impl PlanRequest {
    /// At a distance, with a lidar at one rate, and no limits.
    #[must_use]
    pub fn new(at_m: f64, model: &'static Model, rpm: u32) -> Self {
        Self {
            at_m,
            limits: PlanLimits::default(),
            model,
            rpm: vec![rpm],
            range_sd_m: None,
            mount_sd_deg: None,
            from_deg: None,
            to_deg: None,
            rest_deg: None,
        }
    }
}

impl ScanPlanner {
    /// A planner.
    ///
    /// # Errors
    /// [`Kind::Usage`] for impossible limits, [`Kind::BadInput`] for an invalid configuration.
    pub fn new(
        config: &Config,
        (name, device): (&str, &Device),
        request: PlanRequest,
    ) -> Result<Self, Failure> {
        let axis = profile::axis(&config.axis)?;
        check(&request)?;
        let lidar = plan_lidar(request.model, config.mount.d_m);
        let configured = match profile::simulated(device) {
            true => simulated::lidar(),
            false => config.lidar,
        };
        let errors = ErrorModel {
            range_m: request.at_m,
            range_sd_m: request.range_sd_m.unwrap_or(configured.range_sd_m),
            count_deg: axis.gearing.degrees_per_qc(),
            link: link(device.kind),
            mount_sd_deg: request.mount_sd_deg,
        };
        let tilts_deg = [
            request.from_deg.unwrap_or(config.axis.max_deg),
            request.to_deg.unwrap_or(config.axis.min_deg),
        ];
        let predictor = ScanPredictor::new(lidar, errors, request.limits.gap_deg, tilts_deg);
        Ok(Self {
            config: config.clone(),
            name: name.to_owned(),
            device: device.clone(),
            axis,
            request,
            predictor,
        })
    }

    /// A planner for one capture, with gaps and errors at [`USUAL_M`].
    ///
    /// # Errors
    /// [`Kind::BadInput`] for an invalid configuration.
    pub fn of_capture(
        config: &Config,
        capture: &CapturePlan,
        model: &'static Model,
        rpm: u32,
    ) -> Result<Self, Failure> {
        let first = capture.steps.iter().find(|step| step.sweep);
        let request = PlanRequest {
            from_deg: first.map(|step| step.plan.from.0),
            to_deg: first.map(|step| step.plan.to.0),
            ..PlanRequest::new(USUAL_M, model, rpm)
        };
        Self::new(config, (&capture.name, &capture.device), request)
    }

    /// What the moves of a capture give.
    #[must_use]
    pub fn row(&self, steps: &[Step]) -> PlanRow {
        let rpm = self.request.rpm.first().copied().unwrap_or_default();
        self.predictor.brief_row(&self.scan(steps, rpm))
    }

    /// What a capture gives.
    ///
    /// # Errors
    /// [`Kind::Usage`] for a request outside the axis's limits.
    pub fn of_request(&self, request: &CaptureRequest) -> Result<PlanRow, Failure> {
        Ok(self.row(&self.steps(request)?))
    }

    /// What to expect of a capture, and a warning about its speed, for people.
    #[must_use]
    pub fn expectation(&self, request: &CaptureRequest, row: &PlanRow) -> Vec<String> {
        let expected = format!(
            "expected of a {} at {} rpm: {:.2} million points in {:.1} s with homing; 99 % of directions have a point within {:.2} deg; error \
             of 95 % of points {:.1} mm at {} m",
            self.predictor.lidar.name,
            row.setting.rpm,
            row.points as f64 * 1e-6,
            row.scan_s,
            row.gap_deg.p99,
            row.error_mm.total,
            self.request.at_m,
        );
        let warning = self.resonance(request, row);
        let warning = warning.map(|warning| format!("warning: {warning}"));
        [expected].into_iter().chain(warning).collect()
    }

    /// Time of homing from an angle, seconds.
    #[must_use]
    pub fn homing_s(&self, rest_deg: f64) -> f64 {
        let homing = &self.config.axis.homing;
        let way_deg = (rest_deg - homing.at_deg).abs() + (homing.at_deg - homing.to_deg).abs();
        way_deg / homing.speed_deg_s + HOMING_S
    }

    /// A warning if a slightly slower sweep sees much more: the tilt per revolution is then close
    /// to a multiple or a part of the spacing of the lasers, and lines coincide.
    #[must_use]
    pub fn resonance(&self, request: &CaptureRequest, row: &PlanRow) -> Option<String> {
        let slower = CaptureRequest {
            speed_deg_s: SLOWER * row.setting.speed_deg_s,
            ..request.clone()
        };
        let slower = self.of_request(&slower).ok()?;
        let (gap, better) = (row.gap_deg.p99, slower.gap_deg.p99);
        (gap > RESONANCE * better).then(|| {
            format!(
                "at {} deg/s and {} rpm many scan lines coincide ({:.2} deg of tilt per revolution): 99 % of directions have a point within \
                 {gap:.2} deg, at {} deg/s within {better:.2} deg",
                trim(row.setting.speed_deg_s),
                row.setting.rpm,
                60.0 * row.setting.speed_deg_s / row.setting.rpm,
                trim(slower.setting.speed_deg_s),
            )
        })
    }

    /// The table, and the setting within the limits.
    ///
    /// # Errors
    /// [`Kind::Usage`] for ends of the sweep outside the axis's limits.
    pub fn plan(&self) -> Result<PlanReport, Failure> {
        let limits = &self.request.limits;
        // Ends that the axis refuses leave no setting.
        self.steps(&self.capture(self.axis.max_speed, 1.0, 1))?;
        let rows = self.predictor.table(&self.scans(COARSE));
        let has_limits = *limits != PlanLimits::default();
        let scans = if has_limits {
            self.scans(FINE)
        } else {
            Vec::new()
        };
        let unmet = has_limits.then(|| self.unmet(&scans));
        let chosen = self.predictor.choose(scans, limits);
        Ok(PlanReport {
            device: self.name.clone(),
            simulated: profile::simulated(&self.device),
            lidar: self.predictor.lidar.name.clone(),
            at_m: self.request.at_m,
            rows: rows.into_iter().map(|row| self.with_command(row)).collect(),
            unmet: unmet.filter(|_| chosen.is_none()),
            chosen: chosen.map(|row| self.with_command(row)),
            assumptions: self.assumptions(),
        })
    }

    /// What predicts.
    #[must_use]
    pub const fn predictor(&self) -> &ScanPredictor {
        &self.predictor
    }

    /// Every setting, with speeds in such a ratio.
    #[must_use]
    pub fn scans(&self, ratio: f64) -> Vec<PlannedScan> {
        let most = self.axis.max_speed.0;
        let mut speeds = vec![most];
        let mut next = f64::from(most) / ratio;
        while next >= 1.0 {
            let rpm = next.round() as u32;
            if speeds.last() != Some(&rpm) {
                speeds.push(rpm);
            }
            // Whole revolutions: slow speeds are more than the ratio apart.
            next = (next / ratio).min(f64::from(rpm) - 0.5);
        }
        let mut scans = Vec::new();
        for speed in speeds {
            for (ramp, sweeps) in RAMPS.iter().flat_map(|ramp| SWEEPS.map(|n| (ramp, n))) {
                let request = self.capture(Rpm(speed), *ramp, sweeps);
                // A ramp that the axis refuses is no setting.
                let Ok(steps) = self.steps(&request) else {
                    continue;
                };
                let rates = self.request.rpm.iter();
                scans.extend(rates.map(|rpm| self.scan(&steps, *rpm)));
            }
        }
        scans
    }

    /// A capture with a part of the device's ramps.
    fn capture(&self, speed: Rpm, ramp: f64, sweeps: u32) -> CaptureRequest {
        CaptureRequest {
            speed_deg_s: self.axis.gearing.rate(speed).0,
            accel_deg_s2: Some(ramp * self.device.accel_deg_s2),
            both_ways: sweeps > 1,
            sweeps: Some(sweeps),
            from_deg: self.request.from_deg,
            to_deg: self.request.to_deg,
            ..CaptureRequest::default()
        }
    }

    fn steps(&self, request: &CaptureRequest) -> Result<Vec<Step>, Failure> {
        let sweeps = sweep_request(request, &self.config, &self.device)?;
        moves::steps(&sweeps, &self.axis, Degrees(self.config.axis.homing.to_deg))
    }

    fn scan(&self, steps: &[Step], rpm: u32) -> PlannedScan {
        let sweeps: Vec<&Step> = steps.iter().filter(|step| step.sweep).collect();
        let gearing = self.axis.gearing;
        let first = sweeps.first().map(|step| step.plan);
        let moves_s: f64 = steps
            .iter()
            .map(|step| step.plan.duration.as_secs_f64())
            .sum();
        let homed_deg = self.config.axis.homing.to_deg;
        let rest_deg = self
            .request
            .rest_deg
            .or(steps.last().map(|step| step.plan.to.0));
        let homing_s = self.homing_s(rest_deg.unwrap_or(homed_deg));
        PlannedScan {
            setting: ScanSetting {
                speed_deg_s: first.map_or(0.0, |plan| gearing.rate(plan.speed).0),
                accel_deg_s2: first.map_or(0.0, |plan| gearing.acceleration(plan.acceleration).0),
                rpm: f64::from(rpm),
                sweeps: sweeps.len() as u32,
            },
            sweeps: sweeps
                .iter()
                .map(|step| TiltSweep {
                    from_deg: step.plan.from.0,
                    to_deg: step.plan.to.0,
                    speed_deg_s: gearing.rate(step.plan.speed).0,
                    accel_deg_s2: gearing.acceleration(step.plan.acceleration).0,
                })
                .collect(),
            scan_s: homing_s + moves_s + STEP_S * (steps.len() as f64 - 1.0).max(0.0),
        }
    }

    fn with_command(&self, row: PlanRow) -> CommandRow {
        let setting = &row.setting;
        let mut command = format!("velomotion capture --speed {}", trim(setting.speed_deg_s));
        if trim(setting.accel_deg_s2) != trim(self.device.accel_deg_s2) {
            command += &format!(" --accel {}", trim(setting.accel_deg_s2));
        }
        if setting.sweeps > 1 {
            command += " --both-ways";
        }
        for (flag, end) in [
            ("--from", self.request.from_deg),
            ("--to", self.request.to_deg),
        ] {
            command += &end.map_or(String::new(), |end| format!(" {flag} {end}"));
        }
        // `capture` looks for a device, too, if none is configured.
        let usual = self.config.device.default.as_deref().unwrap_or("auto");
        if self.name != usual {
            command += &format!(" --device {}", self.name);
        }
        CommandRow { command, row }
    }

    /// Which limit no setting meets.
    fn unmet(&self, scans: &[PlannedScan]) -> String {
        let limits = &self.request.limits;
        let budget = |scan: &PlannedScan| {
            let errors = &self.predictor.errors;
            errors.budget(&self.predictor.lidar, &scan.sweeps)
        };
        let least = scans
            .iter()
            .map(budget)
            .min_by(|a, b| a.total.total_cmp(&b.total));
        let fastest = scans
            .iter()
            .map(|scan| scan.scan_s)
            .fold(f64::INFINITY, f64::min);
        match (limits.error_mm, limits.time_s, least) {
            (Some(limit), _, Some(least)) if least.total > limit => format!(
                "no setting has an error of {limit} mm at {} m: the least is {:.1} mm, of which {:.1} mm by the ranges (95 %)",
                self.request.at_m,
                least.total,
                1.96 * least.range.hypot(least.range_step),
            ),
            (_, Some(limit), _) if fastest > limit => {
                format!("no scan with homing takes {limit} s: the shortest takes {fastest:.1} s")
            }
            (_, Some(_), _) => {
                "no setting meets all limits: allow more time, error or gap".to_owned()
            }
            _ => format!(
                "no setting has a gap of {} deg: firings are {:.2} deg apart in azimuth, and lines never reach the poles of the tilt axis",
                limits.gap_deg.unwrap_or_default(),
                6.0 * f64::from(self.request.rpm.iter().copied().min().unwrap_or_default())
                    * self.predictor.lidar.firing_period_s,
            ),
        }
    }

    /// What the figures assume.
    fn assumptions(&self) -> Vec<String> {
        let errors = &self.predictor.errors;
        let per_tenth_deg_mm = 1e3 * errors.range_m * 0.1_f64.to_radians();
        let mount = match errors.mount_sd_deg {
            Some(sd) => format!("mount and zero of the tilt known to {sd} deg"),
            None => format!(
                "mount and zero of the tilt are not calibrated and count as exact: each 0.1 deg is {per_tenth_deg_mm:.0} mm, the same in \
                 every scan; --mount-sd includes it"
            ),
        };
        vec![
            format!(
                "ranges: standard deviation {:.2} mm, quantisation included; {}",
                1e3 * errors.range_sd_m,
                match (self.request.range_sd_m, profile::simulated(&self.device)) {
                    (Some(_), _) => "--range-sd",
                    (None, true) => "the simulated lidar's",
                    (None, false) => "[lidar] range_sd_m of the configuration",
                }
            ),
            format!(
                "drive: a position every {:.2} ms, {:.0} us off, and a delay of up to {:.2} ms that no scan reveals",
                1e3 * errors.link.poll_s,
                1e6 * errors.link.sd_s,
                1e3 * errors.link.shared_s,
            ),
            mount,
            "gear: its error behind the encoder is not known and counts as none".to_owned(),
            "azimuth of the lidar at the start is not controlled: gaps are those of the worst of it"
                .to_owned(),
            match self.request.rest_deg {
                Some(rest) => format!("homing from {rest} deg"),
                None => "homing from where the same scan before ended".to_owned(),
            },
        ]
    }
}

/// Refuses impossible limits.
fn check(request: &PlanRequest) -> Result<(), Failure> {
    let limits = &request.limits;
    let positive = [
        ("--at", Some(request.at_m), "m"),
        ("--error", limits.error_mm, "mm"),
        ("--gap", limits.gap_deg, "deg"),
        ("--time", limits.time_s, "s"),
    ];
    for (flag, value, unit) in positive {
        if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
            let message = format!("{flag}: expected a number above 0 {unit}, got {value}");
            return Err(Failure::new(Kind::Usage, message));
        }
    }
    let nearest = 1.0;
    if request.at_m < nearest {
        let message = format!("--at: expected at least {nearest} m, got {}", request.at_m);
        return Err(Failure::new(Kind::Usage, message));
    }
    Ok(())
}

/// A model as the planner sees it.
fn plan_lidar(model: &Model, d_m: f64) -> PlanLidar {
    let lasers = model.lasers.iter().map(|laser| PlanLaser {
        elevation_deg: laser.elevation_deg,
        height_m: laser.vertical_offset_m,
        azimuth_deg: laser.azimuth_offset_deg,
        delay_s: f64::from(laser.delay_ns) * 1e-9,
    });
    PlanLidar {
        name: model.name.to_owned(),
        lasers: lasers.collect(),
        firing_period_s: f64::from(model.firing_period_ns) * 1e-9,
        packet_period_s: f64::from(model.packet_period_ns(false)) * 1e-9,
        range_step_m: model.distance_unit_m,
        d_m,
    }
}

/// Timing of a device's link; the simulated drive is on USB.
const fn link(kind: DeviceKind) -> LinkTiming {
    match kind {
        DeviceKind::Sim | DeviceKind::Usb | DeviceKind::Slcan => LinkTiming::USB,
        DeviceKind::Rs232 => LinkTiming::RS232,
        DeviceKind::Can => LinkTiming::CAN,
    }
}

/// Rounds away floating-point noise.
fn trim(x: f64) -> f64 {
    (x * 1e6).round() / 1e6
}
