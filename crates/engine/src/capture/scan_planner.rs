//! Plans of captures: what a request gives and costs, and the settings that meet limits.
//!
//! `analysis::plan` predicts; the moves are those that [`super::moves`] plans for the drive.

mod report;
mod settings;

use analysis::plan::{
    ErrorBudget, ErrorModel, GapQuantiles, LimitKind, LinkTiming, NearestScan, PlanLimits, PlanRow,
    PlannedScan, ScanPredictor, ScanSetting, TiltSweep,
};
use drive::AxisConfig;
use protocol::vlp16::LidarModel;
use sim::RigLidar;
use units::{Degrees, ShortNumber};

use super::moves::{self, Step};
use super::plan::{CapturePlan, sweep_request};
use crate::capture_request::CaptureRequest;
use crate::config::{Config, Device, DeviceKind};
use crate::devices::profile;
use crate::failure::{Failure, Kind};
use crate::lidars::{self, LidarSheet};

pub use report::{CommandRow, PlanReport, UnmetLimit};

/// Request for a plan: distance, limits, lidar and sweep.
#[derive(Clone, Debug)]
pub struct PlanRequest {
    /// Distance from the tilt axis, metres.
    pub at_m: f64,
    /// The limits.
    pub limits: PlanLimits,
    /// The lidar.
    pub lidar: &'static LidarSheet,
    /// Revolutions of the lidar per minute to choose from.
    pub rpm: Vec<u32>,
    /// Standard deviation of a range, metres; the configuration's or the data sheet's without it.
    pub range_sd_m: Option<f64>,
    /// Standard deviation of mount and zero of the tilt, degrees; they count as exact without it.
    pub mount_sd_deg: Option<f64>,
    /// Ends of the sweep, degrees; those of the axis without them.
    pub from_deg: Option<f64>,
    /// The other end.
    pub to_deg: Option<f64>,
    /// Rest angle before the scan, degrees; without it the end of the previous scan.
    pub rest_deg: Option<f64>,
}

/// Distance at which a capture reports gaps and errors, metres.
pub const USUAL_M: f64 = 20.0;
/// Time of homing besides the way: checks, ramps, and the edge of the switch; seconds. Measured in
/// virtual time over USB, as `STEP_S`.
const HOMING_S: f64 = 0.62;
/// Time between two moves: at rest before and after, and the commands; seconds.
const STEP_S: f64 = 0.15;
/// Ratios of neighbouring speeds and of neighbouring ramps: of the search, and of the table.
const FINE: [f64; 2] = [1.02, 1.2];
const COARSE: [f64; 2] = [1.2, 2.0];
/// Ratios of a speed to slower ones that should see little more.
const SLOWER: [f64; 2] = [0.95, 0.9];
/// Ratio of their gaps, beyond that of the speeds, that is a resonance.
const RESONANCE: f64 = 1.09;

/// Plans captures with one device.
pub struct ScanPlanner {
    config: Config,
    name: String,
    device: Device,
    axis: AxisConfig,
    request: PlanRequest,
    ranges: RangeSource,
    predictor: ScanPredictor,
}

impl PlanRequest {
    /// At a distance, with a lidar at one rate, and no limits.
    #[must_use]
    pub fn new(at_m: f64, lidar: &'static LidarSheet, rpm: u32) -> Self {
        Self {
            at_m,
            limits: PlanLimits::default(),
            lidar,
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
        let lidar = request.lidar.plan_lidar(config.mount.d_m);
        let ranges = RangeSource::of(config, device, &request);
        let errors = ErrorModel {
            range_m: request.at_m,
            range_sd_m: ranges.sd_m(config, &request),
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
            ranges,
            predictor,
        })
    }

    /// A planner for one capture, with gaps and errors at [`USUAL_M`], and the model and the rate
    /// of the lidar as far as they are known; else those of the configuration, or of the simulator.
    ///
    /// # Errors
    /// [`Kind::BadInput`] for an invalid configuration.
    pub fn of_capture(
        config: &Config,
        capture: &CapturePlan,
        model: Option<&'static LidarModel>,
        rpm: Option<u32>,
    ) -> Result<Self, Failure> {
        Self::of_capture_at(config, capture, model, rpm, USUAL_M)
    }

    /// The same at another distance, metres.
    ///
    /// # Errors
    /// [`Kind::BadInput`] for an invalid configuration, [`Kind::Usage`] for a distance outside the
    /// lidar's range.
    pub fn of_capture_at(
        config: &Config,
        capture: &CapturePlan,
        model: Option<&'static LidarModel>,
        rpm: Option<u32>,
        at_m: f64,
    ) -> Result<Self, Failure> {
        let (usual_lidar, usual_rpm) = match profile::simulated(&capture.device) {
            true => (SIMULATED, RigLidar::default().rpm),
            false => (config.lidar.sheet, config.lidar.rpm),
        };
        let lidar = model.and_then(LidarSheet::of).unwrap_or(usual_lidar);
        let rpm = rpm.unwrap_or(usual_rpm);
        let first = capture.steps.iter().find(|step| step.sweep);
        let request = PlanRequest {
            from_deg: first.map(|step| step.plan.from.0),
            to_deg: first.map(|step| step.plan.to.0),
            ..PlanRequest::new(at_m, lidar, rpm)
        };
        Self::new(config, (&capture.name, &capture.device), request)
    }

    /// Prediction for the moves of a capture.
    #[must_use]
    pub fn row(&self, steps: &[Step]) -> PlanRow {
        let rpm = self.request.rpm.first().copied().unwrap_or_default();
        self.predictor.capture_row(&self.scan(steps, rpm))
    }

    /// Errors of a point after the moves of a capture.
    #[must_use]
    pub fn budget(&self, steps: &[Step]) -> ErrorBudget {
        let rpm = self.request.rpm.first().copied().unwrap_or_default();
        let ScanPredictor { errors, lidar, .. } = &self.predictor;
        errors.budget(lidar, &self.scan(steps, rpm).sweeps)
    }

    /// Prediction for a capture.
    ///
    /// # Errors
    /// [`Kind::Usage`] for a request outside the axis's limits.
    pub fn of_request(&self, request: &CaptureRequest) -> Result<PlanRow, Failure> {
        Ok(self.row(&self.steps(request)?))
    }

    /// Expected results of a capture, and a warning about its speed, as text.
    #[must_use]
    pub fn expectation(&self, request: &CaptureRequest, row: &PlanRow) -> Vec<String> {
        let error = &row.error_mm;
        let expected = format!(
            "expected of a {} at {} rpm: {:.2} million points in {:.1} s with homing; 99 % of directions have a point within {:.2} deg; error \
             of 95 % of points {:.1} mm at {} m, {:.1} mm by ranges ({}) and {:.1} mm by angles and times, {}",
            self.predictor.lidar.name,
            row.setting.rpm,
            row.points as f64 * 1e-6,
            row.scan_s,
            row.gap_deg.p99,
            error.total,
            self.request.at_m,
            error.of_ranges(),
            self.ranges.text(&self.request),
            error.without_ranges(),
            match error.mount {
                Some(mm) => format!("mount {mm:.1} mm (standard deviation)"),
                None => "with an exact mount".to_owned(),
            },
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
        let by_99 = self.resonance_of(request, row, 99, |gaps| gaps.p99);
        by_99.or_else(|| self.resonance_of(request, row, 95, |gaps| gaps.p95))
    }

    /// The same by the gap of so many percent of the directions.
    fn resonance_of(
        &self,
        request: &CaptureRequest,
        row: &PlanRow,
        percent: u8,
        gap_of: impl Fn(&GapQuantiles) -> f64,
    ) -> Option<String> {
        let rpm = self.request.rpm.first().copied().unwrap_or_default();
        let at = |ratio: f64| {
            let request = CaptureRequest {
                speed_deg_s: ratio * row.setting.speed_deg_s,
                ..request.clone()
            };
            Some(self.scan(&self.steps(&request).ok()?, rpm))
        };
        // Beyond what the difference of the speeds explains, of this speed and a slower one.
        let excess = |[here, slower]: [(&ScanSetting, f64); 2]| {
            here.1 / slower.1 / (here.0.speed_deg_s / slower.0.speed_deg_s)
        };
        let share = f64::from(percent) / 100.0;
        let brief_deg = |scan: &PlannedScan| self.predictor.brief_gap_deg(scan, share);
        let here = at(1.0)?;
        let here = (&here.setting, brief_deg(&here));
        let roughly = |scan: &PlannedScan| excess([here, (&scan.setting, brief_deg(scan))]);
        let slower = SLOWER.into_iter().filter_map(at);
        let slower = slower.map(|scan| (roughly(&scan), scan));
        let (rough, slower) = slower.max_by(|a, b| a.0.total_cmp(&b.0))?;
        if rough <= RESONANCE {
            return None;
        }
        let slower = self.predictor.capture_row(&slower);
        let gap_deg = |row: &PlanRow| gap_of(&row.gap_deg);
        let both = [row, &slower].map(|row| (&row.setting, gap_deg(row)));
        (excess(both) > RESONANCE).then(|| {
            format!(
                "at {} deg/s and {} rpm many scan lines coincide ({:.2} deg of tilt per revolution): {percent} % of directions have a point \
                 within {:.2} deg, at {} deg/s within {:.2} deg",
                trim(row.setting.speed_deg_s),
                row.setting.rpm,
                60.0 * row.setting.speed_deg_s / row.setting.rpm,
                gap_deg(row),
                trim(slower.setting.speed_deg_s),
                gap_deg(&slower),
            )
        })
    }

    /// The table, and the setting within the limits.
    ///
    /// # Errors
    /// [`Kind::Usage`] for ends of the sweep outside the axis's limits.
    pub fn plan(&self) -> Result<PlanReport, Failure> {
        let limits = &self.request.limits;
        for rpm in &self.request.rpm {
            let checked = self.request.lidar.check_rpm(*rpm);
            checked.map_err(|what| {
                Failure::new(Kind::Usage, format!("--rpm: {what}"))
                    .help("name a rate that the lidar runs at, with --rpm or as [lidar] rpm of the configuration")
            })?;
        }
        // Ends that the axis refuses leave no setting.
        self.steps(&self.capture(self.axis.max_speed, 1.0, 1))?;
        if !self.predictor.sees_enough() {
            let message = "the sweep is too short: too few directions are in view to examine gaps";
            return Err(
                Failure::new(Kind::Usage, message).help("set --from and --to farther apart")
            );
        }
        let coarse = self.scans(COARSE);
        let mut rows = self.predictor.table(&coarse);
        let has_limits = *limits != PlanLimits::default();
        let scans = if has_limits {
            self.different_scans(FINE)
        } else {
            Vec::new()
        };
        let nearby = |scan: &PlannedScan| self.nearby(&scan.setting);
        let mut chosen = self.predictor.choose(&scans, nearby, limits);
        let mut nearest = match &chosen {
            None if has_limits => self.predictor.nearest(&scans, nearby, limits),
            _ => None,
        };
        // A choice stays a little within the gap; this row is at its limit.
        let is_within = |nearest: &NearestScan| {
            let gap_deg = limits.gap_deg.unwrap_or_default();
            nearest.limit == LimitKind::Gap
                && nearest.row.gap_deg.p99 <= gap_deg
                && limits.time_s.is_none_or(|most| nearest.row.scan_s <= most)
        };
        if let Some(nearest) = nearest.take_if(|nearest| is_within(nearest)) {
            chosen = Some(nearest.row);
        }
        // Rows that seem to beat the choice, by few azimuths, break the limit at others or come
        // closer to it than a choice.
        if let (Some(chosen), Some(_)) = (&chosen, limits.gap_deg) {
            rows.retain(|row| row.scan_s >= chosen.scan_s || !self.unmet_of(row).is_empty());
        }
        // The same of the best setting that there is.
        if let Some(nearest) = &nearest {
            let best = &nearest.row;
            rows.retain(|row| {
                row.scan_s >= best.scan_s
                    || row.gap_deg.p99 > best.gap_deg.p99
                    || row.error_mm.total > best.error_mm.total
            });
        }
        Ok(PlanReport {
            device: self.name.clone(),
            simulated: profile::simulated(&self.device),
            lidar: self.predictor.lidar.name.clone(),
            at_m: self.request.at_m,
            unseen_beyond_deg: self.predictor.unseen_beyond_deg(),
            rows: rows.into_iter().map(|row| self.with_command(row)).collect(),
            unmet: nearest.as_ref().map(|nearest| self.unmet(nearest)),
            nearest: nearest.map(|nearest| self.with_command(nearest.row)),
            chosen: chosen.map(|row| self.with_command(row)),
            no_command: self.no_command(&self.request.rpm),
            assumptions: self.assumptions(),
        })
    }

    /// Predictor of the scans.
    #[must_use]
    pub const fn predictor(&self) -> &ScanPredictor {
        &self.predictor
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
}

/// The simulator's lidar.
const SIMULATED: &LidarSheet = &lidars::VLP_16;

/// Whether a lidar at these rates is the simulator's.
fn is_simulated(lidar: &LidarSheet, rpm: &[u32]) -> bool {
    let simulated = RigLidar::default().rpm;
    lidar == SIMULATED && rpm.iter().all(|rate| *rate == simulated)
}

/// Source of the standard deviation of a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RangeSource {
    Request,
    Simulator,
    Configuration,
    DataSheet,
}

impl RangeSource {
    fn of(config: &Config, device: &Device, request: &PlanRequest) -> Self {
        let is_configured = request.lidar == config.lidar.sheet;
        if request.range_sd_m.is_some() {
            Self::Request
        } else if profile::simulated(device) && is_simulated(request.lidar, &request.rpm) {
            Self::Simulator
        } else if is_configured && config.lidar.range_sd_m.is_some() {
            Self::Configuration
        } else {
            Self::DataSheet
        }
    }

    fn sd_m(self, config: &Config, request: &PlanRequest) -> f64 {
        let sheet_m = request.lidar.range_sd_m(request.at_m);
        match self {
            Self::Request => request.range_sd_m.unwrap_or(sheet_m),
            Self::Simulator => lidars::simulated().range_sd_m,
            Self::Configuration => config.lidar.accuracy().range_sd_m,
            Self::DataSheet => sheet_m,
        }
    }

    /// Its name, for people.
    const fn text(self, request: &PlanRequest) -> &'static str {
        match self {
            Self::Request => "--range-sd",
            Self::Simulator => "the simulated lidar's: steps of 2 mm, no noise",
            Self::Configuration => "[lidar] range_sd_m of the configuration",
            Self::DataSheet => request.lidar.source,
        }
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
            let message = format!(
                "{flag}: expected a number above 0 {unit}, got {}",
                ShortNumber(value)
            );
            let help = "velomotion plan --help explains the limits";
            return Err(Failure::new(Kind::Usage, message).help(help));
        }
    }
    let deviations = [
        ("--range-sd", request.range_sd_m, 10.0, "m"),
        ("--mount-sd", request.mount_sd_deg, 90.0, "deg"),
    ];
    for (flag, value, most, unit) in deviations {
        if let Some(value) = value.filter(|value| !(0.0..=most).contains(value)) {
            let got = ShortNumber(value);
            let message = format!("{flag}: expected 0 to {most} {unit}, got {got}");
            let help = "give a standard deviation, or leave it out";
            return Err(Failure::new(Kind::Usage, message).help(help));
        }
    }
    let range = request.lidar.sensor.range();
    if !(range.min_m..=range.max_m).contains(&request.at_m) {
        let message = format!(
            "--at: expected {} to {} m, the range of the {}, got {}",
            range.min_m,
            range.max_m,
            request.lidar.title,
            ShortNumber(request.at_m)
        );
        return Err(Failure::new(Kind::Usage, message)
            .help("name a distance within it, or another --lidar"));
    }
    Ok(())
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
