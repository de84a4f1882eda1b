//! A plan for people and programs: commands, causes and assumptions.

use analysis::plan::{PlanRow, PlannedScan, ScanSetting};
use serde::Serialize;
use utoipa::ToSchema;

use super::{ScanPlanner, is_simulated, trim};
use crate::devices::profile;

/// A row with its command.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct CommandRow {
    /// The capture; null where the device is simulated and has another lidar.
    pub command: Option<String>,
    /// The limits that it does not keep, with the cause.
    pub unmet: Vec<UnmetLimit>,
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
    /// Settings that no other beats in time, 99 % gap and error at once, the fastest for each class
    /// of gap.
    pub rows: Vec<CommandRow>,
    /// The fastest setting within the limits; with a limit of time only, the densest. Null without
    /// limits, and if no setting meets them.
    pub chosen: Option<CommandRow>,
    /// Why no setting meets the limits.
    pub unmet: Option<String>,
    /// What the figures assume.
    pub assumptions: Vec<String>,
}

/// A limit that a row does not keep.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct UnmetLimit {
    /// `error`, `gap` or `time`.
    pub limit: &'static str,
    /// What the row has: millimetres, degrees or seconds.
    pub value: f64,
    /// What it comes from.
    pub cause: String,
}

impl ScanPlanner {
    pub(super) fn with_command(&self, row: PlanRow) -> CommandRow {
        let other = profile::simulated(&self.device) && !is_simulated(&self.request);
        CommandRow {
            command: (!other).then(|| self.command(&row.setting)),
            unmet: self.unmet_of(&row),
            row,
        }
    }

    fn command(&self, setting: &ScanSetting) -> String {
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
        command
    }

    /// The limits that a row does not keep.
    fn unmet_of(&self, row: &PlanRow) -> Vec<UnmetLimit> {
        let limits = &self.request.limits;
        let (setting, error) = (&row.setting, &row.error_mm);
        let terms = [
            (error.of_ranges(), "the ranges, at any speed"),
            (error.without_ranges(), "the angles at this speed"),
        ];
        let (of_most, most) = terms
            .into_iter()
            .fold((0.0, ""), |a, b| if b.0 > a.0 { b } else { a });
        let tilt_deg = 60.0 * setting.speed_deg_s / setting.rpm;
        let checks = [
            (
                ("error", error.total, limits.error_mm),
                format!("{of_most:.1} mm by {most}"),
            ),
            (
                ("gap", row.gap_deg.p99, limits.gap_deg),
                format!(
                    "{tilt_deg:.2} deg of tilt per revolution, {} sweeps",
                    setting.sweeps
                ),
            ),
            (
                ("time", row.scan_s, limits.time_s),
                format!(
                    "homing and {} sweeps of {:.1} deg/s",
                    setting.sweeps, setting.speed_deg_s
                ),
            ),
        ];
        let unmet = checks
            .into_iter()
            .filter_map(|((limit, value, allowed), cause)| {
                (value > allowed?).then_some(UnmetLimit {
                    limit,
                    value,
                    cause,
                })
            });
        unmet.collect()
    }

    /// Which limit no setting meets.
    pub(super) fn unmet(&self, scans: &[PlannedScan]) -> String {
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
                least.of_ranges(),
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
    pub(super) fn assumptions(&self) -> Vec<String> {
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
                match (self.request.range_sd_m, is_simulated(&self.request)) {
                    (Some(_), _) => "--range-sd",
                    (None, true) if profile::simulated(&self.device) => "the simulated lidar's",
                    (None, _) => "[lidar] range_sd_m of the configuration",
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
