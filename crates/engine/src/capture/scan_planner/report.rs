//! A plan for people and programs: commands, causes and assumptions.

use analysis::plan::{LimitKind, NearestScan, PlanRow, ScanSetting};
use serde::Serialize;
use utoipa::ToSchema;

use super::{ScanPlanner, is_simulated, trim};
use crate::devices::profile;
use crate::words::counted;

/// A row with its command.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct CommandRow {
    /// The capture; null for another lidar than the device has.
    pub command: Option<String>,
    /// The limits that it does not keep, with the cause.
    pub unmet: Vec<UnmetLimit>,
    /// What it gives.
    #[serde(flatten)]
    pub row: PlanRow,
}

/// A plan.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct PlanReport {
    /// The device.
    pub device: String,
    /// Whether it is simulated.
    pub simulated: bool,
    /// Model of the lidar.
    pub lidar: String,
    /// Distance of gaps and errors, metres.
    pub at_m: f64,
    /// Gap beyond which a direction counts as one without a point, degrees: the requested one, or
    /// 0.5.
    pub unseen_beyond_deg: f64,
    /// Settings that no other beats in time, 99 % gap and error at once, the fastest for each class
    /// of gap.
    pub rows: Vec<CommandRow>,
    /// The fastest setting within the limits; with a limit of time only, the densest. Null without
    /// limits, and if no setting meets them.
    pub chosen: Option<CommandRow>,
    /// Why no setting meets the limits, and the best that there is.
    pub unmet: Option<String>,
    /// That setting: the fastest that comes nearest to the limit which none meets.
    pub nearest: Option<CommandRow>,
    /// Why some rows have no command.
    pub no_command: Option<String>,
    /// What the figures assume.
    pub assumptions: Vec<String>,
}

/// A limit that a row does not keep.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
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
        CommandRow {
            command: (self.no_command(&[row.setting.rpm as u32]).is_none())
                .then(|| self.command(&row.setting)),
            unmet: self.unmet_of(&row),
            row,
        }
    }

    /// Reason for which settings at these speeds of the lidar have no command.
    pub(super) fn no_command(&self, rpm: &[u32]) -> Option<String> {
        let lidar = self.request.lidar;
        match lidar.model {
            None => Some(format!(
                "velomotion does not capture the {}: its packets are not those of a VLP-16's family",
                lidar.title
            )),
            Some(_) if profile::simulated(&self.device) && !is_simulated(lidar, rpm) => Some(
                "the simulated lidar is a VLP-16 at 600 rpm; name the device of another with --device"
                    .to_owned(),
            ),
            Some(_) => None,
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
    pub(super) fn unmet_of(&self, row: &PlanRow) -> Vec<UnmetLimit> {
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
                    "{tilt_deg:.2} deg of tilt per revolution, {}",
                    counted(setting.sweeps, "sweep")
                ),
            ),
            (
                ("time", row.scan_s, limits.time_s),
                format!(
                    "homing and {} of {:.1} deg/s",
                    counted(setting.sweeps, "sweep"),
                    setting.speed_deg_s
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

    /// Message about the limit that no setting meets: the nearest scan, its time and its setting.
    pub(super) fn unmet(&self, nearest: &NearestScan) -> String {
        let limits = &self.request.limits;
        let (row, at_m) = (&nearest.row, self.request.at_m);
        let setting = &row.setting;
        let by = format!(
            "{} deg/s, {} deg/s2, {} rpm, {}",
            trim(setting.speed_deg_s),
            trim(setting.accel_deg_s2),
            setting.rpm,
            counted(setting.sweeps, "sweep")
        );
        let others = match nearest.with_others {
            true => " that keeps the other limits",
            false => "",
        };
        match nearest.limit {
            LimitKind::Error => format!(
                "no setting has an error of {} mm at {at_m} m: the least is {:.2} mm; {} has {:.2} mm, of which {:.2} mm by the ranges \
                 (95 %), in {:.1} s ({by}); only a lidar with more accurate ranges lessens the latter",
                limits.error_mm.unwrap_or_default(),
                nearest.least,
                match (limits.gap_deg, nearest.with_others) {
                    (Some(_), true) => "the fastest within 4 % of it that keeps the gap",
                    (Some(_), false) => {
                        "none within 4 % of it keeps the gap; the densest"
                    }
                    (None, _) => "the fastest within 4 % of it",
                },
                row.error_mm.total,
                row.error_mm.of_ranges(),
                row.scan_s,
            ),
            LimitKind::Gap => format!(
                "no setting{others} has a gap of {} deg: the least is {:.3} deg; the fastest near it has {:.3} deg, in {:.1} s ({by}); firings are {:.2} deg apart in azimuth, and \
                 lines never reach the poles of the tilt axis",
                limits.gap_deg.unwrap_or_default(),
                nearest.least,
                row.gap_deg.p99,
                row.scan_s,
                6.0 * setting.rpm * self.predictor.lidar.firing_period_s,
            ),
            LimitKind::Time => format!(
                "no scan{others} takes at most {} s with homing: the shortest takes {:.1} s ({by})",
                limits.time_s.unwrap_or_default(),
                row.scan_s,
            ),
        }
    }

    /// Assumptions of the figures.
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
        let mut assumed = vec![
            format!(
                "ranges: standard deviation {:.2} mm, quantisation included; {}",
                1e3 * errors.range_sd_m,
                self.ranges.text(&self.request),
            ),
            "constant errors of the ranges are not included: a few mm from laser to laser, which calibrate measures"
                .to_owned(),
            "angle errors of the lasers and the width of their beams are not included".to_owned(),
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
            "the widest gap is sought from the widest of directions 2 deg apart; fewer than 1 in 1000 directions have a wider one, with a risk of \
             1 in 1000"
                .to_owned(),
            match self.request.rest_deg {
                Some(rest) => format!("homing from {rest} deg"),
                None => "homing from where the same scan before ended".to_owned(),
            },
        ];
        if self.predictor.lidar.azimuth_step_deg == 0.0 {
            assumed.push("azimuths of a planar scanner are taken as exact".to_owned());
        }
        assumed
    }
}
