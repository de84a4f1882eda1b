//! The object of `velomotion calibrate --json`.

use calibration::{BaseEvidence, Calibration, ParameterEstimate, ParameterKind};
use scanner::config::MountConfig;
use serde::Serialize;
use utoipa::ToSchema;

use super::{CalibrationResult, mount_config};

/// Report of a calibration.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct CalibrateReport {
    /// The logs.
    pub logs: Vec<LogReport>,
    /// The base of each log.
    pub bases: Vec<BaseReport>,
    /// Model of the lidar.
    pub model: String,
    /// Whether the devices were simulated.
    pub simulated: bool,
    /// The calibrated mount.
    pub mount: MountConfig,
    /// The parameters of scanner and logs.
    pub parameters: Vec<ParameterReport>,
    /// Correlations of the parameters: the lower triangle by rows, without the diagonal.
    pub correlation: Vec<Vec<f64>>,
    /// Root mean square of the residuals of ranges, millimetres.
    pub residual_mm: BeforeAfter,
    /// Residuals of each laser.
    pub lasers: Vec<LaserResiduals>,
    /// Surface elements that count.
    pub patches: usize,
    /// Shots in them.
    pub shots: usize,
    /// Squared residuals per degree of freedom; 1 if the model describes them.
    pub chi2: f64,
    /// Loops until nothing moved.
    pub loops: usize,
    /// The file of the mount, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output: Option<String>,
}

/// A log of a calibration.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct LogReport {
    /// Its path.
    pub path: String,
    /// Shots with a return in its sweeps.
    pub shots: usize,
}

/// What a log says of the motion of its base.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct BaseReport {
    /// Whether it is taken to stand: the residuals show no drift.
    pub stands: bool,
    /// Whether the residuals show a drift. If it neither stands nor moves, they would not show it.
    pub moves: bool,
    /// Chi-squared of its drift; of a base that stands at most 22.5 (99.9 %).
    pub chi2: f64,
    /// A slower drift may be unseen, also of points at 20 m, millimetres per second.
    pub unseen_mm_s: f64,
}

/// A parameter, in the unit that its name states.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct ParameterReport {
    /// Name with unit.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Standard deviation.
    pub sd: f64,
    /// Whether the logs determine it: a standard deviation of at most 0.3 of that before.
    pub observable: bool,
    /// Standard deviation over that before the scan; 0 if it was fixed.
    pub posterior_over_prior: f64,
    /// Parameter with the strongest correlation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlated_with: Option<String>,
    /// That correlation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correlation: Option<f64>,
    /// Displacement of points at 20 m by the correction, millimetres.
    pub moves_mm: f64,
    /// Displacement of points at 20 m by one standard deviation, millimetres.
    pub sd_mm: f64,
    /// What would determine it, if these logs do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub help: Option<String>,
}

/// A quantity before and after the calibration.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
pub struct BeforeAfter {
    /// Before.
    pub before: f64,
    /// After.
    pub after: f64,
}

/// Residuals of a laser's ranges on the surface elements, millimetres.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct LaserResiduals {
    /// Index in firing order.
    pub laser: usize,
    /// Noise of a range.
    pub noise_mm: f64,
    /// Mean.
    pub mean_mm: BeforeAfter,
    /// Root mean square.
    pub rms_mm: BeforeAfter,
}

/// A parameter whose deviation shrinks by less is not determined.
const DETERMINED: f64 = 0.3;

impl CalibrateReport {
    /// The report of a calibration.
    #[must_use]
    pub fn new(calibrated: &CalibrationResult) -> Self {
        let calibration = &calibrated.calibration;
        let evidence = &calibration.evidence;
        let [before, after] = evidence.rms_m.map(|rms| 1e3 * rms);
        let logs = calibrated.logs.iter().map(|(path, shots)| LogReport {
            path: path.display().to_string(),
            shots: *shots,
        });
        let bases = evidence.bases.iter().map(|base| BaseReport {
            stands: base.stands,
            moves: base.moves(),
            chi2: base.chi2,
            unseen_mm_s: 1e3 * base.unseen_m_s,
        });
        Self {
            logs: logs.collect(),
            bases: bases.collect(),
            model: calibrated.model.name.to_owned(),
            simulated: calibrated.simulated,
            mount: mount_config(&calibration.mount()),
            parameters: calibration
                .parameters
                .iter()
                .map(|estimate| ParameterReport::new(estimate, &evidence.bases))
                .collect(),
            correlation: correlations(calibration, calibration.parameters.len()),
            residual_mm: BeforeAfter { before, after },
            lasers: lasers(calibration),
            patches: evidence.patches,
            shots: evidence.shots,
            chi2: evidence.chi2,
            loops: evidence.loops,
            output: None,
        }
    }
}

/// Correlations of the first parameters: the lower triangle by rows, four decimals.
pub(super) fn correlations(calibration: &Calibration, count: usize) -> Vec<Vec<f64>> {
    let size = calibration.parameters.len();
    let covariance = |i: usize, j: usize| calibration.covariance.get(i * size + j).copied();
    let correlation = |i: usize, j: usize| {
        let both = covariance(i, i)?.sqrt() * covariance(j, j)?.sqrt();
        let r = covariance(i, j)? / both;
        (both > 0.0).then(|| ((r * 1e4).round() / 1e4).clamp(-1.0, 1.0))
    };
    let row = |i: usize| (0..i).map(|j| correlation(i, j).unwrap_or(0.0)).collect();
    (0..count).map(row).collect()
}

fn lasers(calibration: &Calibration) -> Vec<LaserResiduals> {
    let evidence = &calibration.evidence;
    let each = evidence
        .before_m
        .iter()
        .zip(&evidence.after_m)
        .zip(&evidence.noise_m);
    let of = |before: f64, after: f64| BeforeAfter {
        before: 1e3 * before,
        after: 1e3 * after,
    };
    let each = each
        .enumerate()
        .map(|(laser, ((before, after), noise))| LaserResiduals {
            laser,
            noise_mm: 1e3 * noise,
            mean_mm: of(before[0], after[0]),
            rms_mm: of(before[1], after[1]),
        });
    each.collect()
}

impl ParameterReport {
    fn new(estimate: &ParameterEstimate, bases: &[BaseEvidence]) -> Self {
        let stands = match estimate.kind {
            ParameterKind::Drift(log) => bases.get(log - 1).is_some_and(|base| base.stands),
            _ => false,
        };
        let observable = stands || estimate.posterior_over_prior <= DETERMINED;
        let (correlated_with, correlation) = estimate.correlation.clone().unzip();
        Self {
            name: estimate.name.clone(),
            value: estimate.value,
            sd: estimate.sd,
            observable,
            posterior_over_prior: estimate.posterior_over_prior,
            correlated_with,
            correlation,
            moves_mm: 1e3 * estimate.at_20_m[0],
            sd_mm: 1e3 * estimate.at_20_m[1],
            help: (!observable).then(|| help(estimate.kind).to_owned()),
        }
    }
}

/// Advice on scans that determine a parameter.
const fn help(kind: ParameterKind) -> &'static str {
    match kind {
        ParameterKind::Delay | ParameterKind::Play => "scan both ways, at two speeds",
        ParameterKind::Drift(_) | ParameterKind::Scale => "scan both ways",
        ParameterKind::RippleSin | ParameterKind::RippleCos => {
            "scan more turns of the motor, with surfaces beyond 10 m"
        }
        ParameterKind::Range(_) | ParameterKind::Elevation(_) | ParameterKind::Azimuth(_) => {
            "scan surfaces that this laser meets at several tilts, in several directions"
        }
        ParameterKind::MountRotation | ParameterKind::MountPosition => {
            "scan a wider range of tilt, with surfaces in several directions"
        }
    }
}
