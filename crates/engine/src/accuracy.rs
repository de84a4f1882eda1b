//! Accuracy of a scanner, by its logs.

mod report;
mod truth;

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use calibration::{
    AccuracyStudy, AngleErrors, CalibrationRefusal, KnownCovariance, PointError, Scan, study,
};
use cloud::{Fields, Points};
use protocol::vlp16::LidarModel;
use scanner::config::{DeviceCalibration, ParameterCovariance};
use scanner::{Accuracy, TiltSource};

pub use report::{
    AccuracyReport, BudgetReport, LaserNoise, PointErrors, ResidualGroup, ResidualReport,
    StationReport, SweepDifference,
};
pub use truth::TruePlaces;

use crate::calibrate::{ReadLog, one_scanner, read, tables};
use crate::config::MountSettings;
use crate::failure::{Failure, Kind};
use crate::reconstruct::decoder_options::other_model;
use crate::reconstruct::replay::{self, Reconstruction};
use crate::reconstruct::source::Source;

/// A study to make.
pub struct AccuracyRequest<'a> {
    /// The logs, of one scanner.
    pub logs: &'a [PathBuf],
    /// Mount and calibration; without it those of the first log.
    pub mount: Option<MountSettings>,
    /// True place of a return, by time on the lidar's clock (nanoseconds) and laser; of one log.
    pub truth: Option<&'a dyn Fn(i64, u8) -> Option<[f64; 3]>>,
    /// Stops the study when set.
    pub interrupt: &'a AtomicBool,
}

/// A study with its origin.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct AccuracyResult {
    /// The result.
    pub study: AccuracyStudy,
    /// The lidar.
    pub model: &'static LidarModel,
    /// Whether a log is of simulated devices.
    pub simulated: bool,
    /// Whether the scanner is calibrated.
    pub calibrated: bool,
    /// The logs with their shots.
    pub logs: Vec<(PathBuf, usize)>,
    /// Points without a true place and all points, if the truth is known.
    pub without_truth: Option<[usize; 2]>,
}

/// Parameters of a motion that a fit estimates.
const MOTION_PARAMETERS: f64 = 6.0;

/// Studies the accuracy of a scanner by its logs. `reading` is called before each log.
///
/// # Errors
/// [`Kind::BadInput`] for logs that cannot be used, [`Kind::Incomplete`] without enough surfaces.
pub fn accuracy(
    request: &AccuracyRequest<'_>,
    reading: &mut dyn FnMut(&Path),
) -> Result<AccuracyResult, Failure> {
    if request.truth.is_some() && request.logs.len() != 1 {
        return Err(Failure::new(Kind::Usage, "the truth is of one log").help("name one log"));
    }
    let mut logs = Vec::new();
    for path in request.logs {
        reading(path);
        let source = Source::open(path, None)?;
        logs.push(read(path, tilt_source(&source)?, request.interrupt)?);
    }
    let first = one_scanner(&logs, request.logs)?;
    let (model, gear, lasers) = (first.model, first.gear, tables(first.model));
    let (pose, calibration) = match &request.mount {
        Some(mount) => (mount.pose(), mount.calibration().cloned()),
        None => (first.config.mount, first.config.calibration.clone()),
    };
    let of_other =
        |all: &&DeviceCalibration| all.model.as_deref().is_some_and(|of| of != model.name);
    if let Some(calibration) = calibration.as_ref().filter(of_other) {
        return Err(other_model(calibration, model));
    }
    let truth = match request.truth {
        Some(truth) => vec![point_errors(request, truth, first.report.points)?],
        None => Vec::new(),
    };
    let without_truth = truth.first().map(|points| {
        let without = points.iter().filter(|point| point.error_m.is_nan());
        [without.count(), points.len()]
    });
    let corrections = calibration.as_ref().map(|all| corrections(all, model));
    let covariance = calibration.as_ref().and_then(|all| all.covariance.as_ref());
    let rows = covariance.map(rows).unwrap_or_default();
    let angles = angle_errors(&logs);
    let simulated = logs.iter().any(|log| log.report.contents.simulated);
    let scans: Vec<Scan> = logs.into_iter().map(|log| log.scan).collect();
    let made = study(&calibration::StudyRequest {
        scans: &scans,
        lasers: &lasers,
        mount: pose.mount(),
        gear,
        corrections: corrections.as_deref().unwrap_or_default(),
        covariance: covariance.map(|known| KnownCovariance {
            names: &known.names,
            covariance: &rows,
        }),
        angles,
        truth: &truth,
    });
    Ok(AccuracyResult {
        study: made.map_err(|refusal| refused(&refusal, request))?,
        model,
        simulated,
        calibrated: calibration.is_some(),
        logs: request
            .logs
            .iter()
            .cloned()
            .zip(scans.iter().map(Scan::len))
            .collect(),
        without_truth,
    })
}

fn refused(refusal: &CalibrationRefusal, request: &AccuracyRequest<'_>) -> Failure {
    let logs = request.logs.iter().map(|log| log.display().to_string());
    let logs: Vec<String> = logs.collect();
    Failure::new(Kind::Incomplete, format!("{}: {refusal}", logs.join(", ")))
        .help("scan where walls, floors or other smooth surfaces are within 50 m")
}

/// The angles of a log; a recording of a lidar alone has none.
fn tilt_source(source: &Source) -> Result<TiltSource, Failure> {
    Ok(match source.has_config()? {
        true => TiltSource::Log,
        false => TiltSource::None,
    })
}

/// Standard deviations of tilt and clock: of tilt by the residuals of each sweep's fit, of the
/// clock by its bound.
fn angle_errors(logs: &[ReadLog]) -> AngleErrors {
    let mut largest = AngleErrors::default();
    for log in logs {
        let sync = &log.report.sync;
        let samples = log
            .report
            .contents
            .tilt
            .as_ref()
            .map_or(0, |tilt| tilt.samples);
        // Each sweep has a fit of its own.
        let fitted = MOTION_PARAMETERS * log.report.sweeps.len().max(1) as f64;
        let tilt_rad = sync.angle_rms_deg.unwrap_or(0.0).to_radians();
        let tilt_sd_rad = tilt_rad * (fitted / (samples as f64).max(fitted)).sqrt();
        let clock_sd_s = 1e-6 * sync.clock_bound_us / 3_f64.sqrt();
        largest.tilt_sd_rad = largest.tilt_sd_rad.max(tilt_sd_rad);
        largest.clock_sd_s = largest.clock_sd_s.max(clock_sd_s);
    }
    largest
}

/// Values of parameters by name.
fn corrections(calibration: &DeviceCalibration, model: &LidarModel) -> Vec<(String, f64)> {
    let axis = &calibration.axis_correction;
    let [ripple_sin, ripple_cos] = axis.ripple_deg;
    let mut values: Vec<(String, f64)> = [
        ("delay_us", axis.delay_us),
        ("scale", axis.scale),
        ("ripple_sin_deg", ripple_sin),
        ("ripple_cos_deg", ripple_cos),
        ("play_deg", axis.play_deg),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    for laser in &calibration.laser {
        let Some(nominal) = model.lasers.get(usize::from(laser.id)) else {
            continue;
        };
        let of = |kind: &str| format!("laser_{}_{kind}", laser.id);
        values.push((of("range_m"), laser.range_offset_m));
        let elevation_deg = laser.elevation_deg - nominal.elevation_deg;
        values.push((of("elevation_deg"), elevation_deg));
        let azimuth_deg = laser.azimuth_offset_deg - nominal.azimuth_offset_deg;
        values.push((of("azimuth_deg"), azimuth_deg));
    }
    values
}

/// A covariance by rows.
fn rows(known: &ParameterCovariance) -> Vec<f64> {
    let size = known.names.len();
    let sd = |i: usize| known.sd.get(i).copied().unwrap_or(0.0);
    let correlation = |i: usize, j: usize| match i == j {
        true => 1.0,
        false => {
            let row = known.correlation.get(i.max(j));
            row.and_then(|row| row.get(i.min(j)))
                .copied()
                .unwrap_or(0.0)
        }
    };
    (0..size * size)
        .map(|index| (index / size, index % size))
        .map(|(i, j)| sd(i) * sd(j) * correlation(i, j))
        .collect()
}

/// Errors of the first log's points against the truth after a turn about the tilt axis: no scan
/// shows the encoder's zero.
fn point_errors(
    request: &AccuracyRequest<'_>,
    truth: &dyn Fn(i64, u8) -> Option<[f64; 3]>,
    expected: u64,
) -> Result<Vec<PointError>, Failure> {
    let [path] = request.logs else {
        return Err(Failure::new(Kind::Usage, "the truth is of one log").help("name one log"));
    };
    let mut source = Source::open(path, None)?;
    if let Some(mount) = &request.mount {
        source.set_mount(mount.clone());
    }
    let fields = Fields::DEVICE_TIME.union(Fields::LASER).union(Fields::SD);
    let mut points = Points::new(fields);
    let reconstruction = Reconstruction {
        tilt: tilt_source(&source)?,
        ..Reconstruction::of_log(&source, Accuracy::Best, request.interrupt)?
    };
    let placed = replay::scan(&reconstruction, &mut points, path)?.points;
    if placed != expected {
        let what = format!(
            "{}: {placed} points with the calibration, {expected} without",
            path.display()
        );
        return Err(Failure::new(Kind::BadInput, what)
            .help("omit --scene: points with and without the calibration cannot be matched"));
    }
    let pairs = || {
        points
            .iter()
            .map(|p| (p, truth(p.device_time.as_nanos(), p.laser)))
    };
    let (mut along, mut squares) = (0.0, 0.0);
    for (point, hit) in pairs() {
        let (Some([x, _, z]), [px, _, pz]) = (hit, point.position_m) else {
            continue;
        };
        along += z * (px - x) - x * (pz - z);
        squares += x * x + z * z;
    }
    if squares == 0.0 {
        let what = format!("{}: no point is in the truth", path.display());
        return Err(Failure::new(Kind::BadInput, what)
            .help("name the scene and the seed with which the log was simulated"));
    }
    let turn = along / squares;
    let errors = pairs().map(|(point, hit)| {
        let error_m = hit.map_or(f64::NAN, |[x, y, z]| {
            let [px, py, pz] = point.position_m;
            let off = [px - x - turn * z, py - y, pz - z + turn * x];
            off.iter().map(|part| part * part).sum::<f64>().sqrt()
        });
        PointError {
            error_m,
            sd_m: point.sd_m,
        }
    });
    Ok(errors.collect())
}
