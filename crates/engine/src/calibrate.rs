//! Calibration of the scanner from logs of its own.

mod file;
mod report;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use calibration::{Calibration, CalibrationRefusal, NominalLaser, Scan};
use cloud::Points;
use cloud::mount::Mount;
use lidar::Options;
use protocol::vlp16::LidarModel;
use protocol::vlp16::models::ALL;
use scanner::config::MountConfig;
use scanner::{Accuracy, ScanConfig, TiltSource};

pub use file::to_toml;
pub use report::{CalibrateReport, LaserResiduals, LogReport, ParameterReport};

use crate::capture::completeness;
use crate::config::MountSettings;
use crate::failure::{Failure, Kind};
use crate::reconstruct::replay::{self, Reconstruction, TimeReference};
use crate::reconstruct::report::ScanReport;
use crate::reconstruct::source::Source;

/// A calibration to make.
#[derive(Clone, Debug)]
pub struct CalibrateRequest<'a> {
    /// The logs, of one scanner.
    pub logs: &'a [PathBuf],
    /// Mount to start from; without it that of the first log.
    pub start: Option<MountConfig>,
    /// Parameters that stay as they are: all whose names begin with one of these.
    pub fixed: &'a [String],
    /// Whether the floor sets the zero of the tilt.
    pub level_floor: bool,
    /// Stops the calibration when set.
    pub interrupt: &'a AtomicBool,
}

/// Progress of a calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CalibrateProgress<'a> {
    /// A log is read.
    Reading(&'a Path),
    /// All logs are read, with this many shots.
    Shots(usize),
    /// A loop is done; the largest move in standard deviations.
    Loop(usize, f64),
}

/// A calibration with its origin.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CalibrationResult {
    /// The result.
    pub calibration: Calibration,
    /// The lidar.
    pub model: &'static LidarModel,
    /// Whether a log is of simulated devices.
    pub simulated: bool,
    /// The logs with their shots.
    pub logs: Vec<(PathBuf, usize)>,
}

/// A log that was read.
pub(crate) struct ReadLog {
    pub scan: Scan,
    pub model: &'static LidarModel,
    pub config: ScanConfig,
    pub gear: f64,
    pub report: ScanReport,
}

/// Calibrates a scanner by its logs.
///
/// # Errors
/// [`Kind::BadInput`] for logs that cannot be used, [`Kind::Incomplete`] with the evidence where
/// they do not support a calibration.
pub fn calibrate(
    request: &CalibrateRequest<'_>,
    progress: &mut dyn FnMut(CalibrateProgress<'_>),
) -> Result<CalibrationResult, Failure> {
    let mut logs = Vec::new();
    for path in request.logs {
        progress(CalibrateProgress::Reading(path));
        logs.push(read(path, TiltSource::Log, request.interrupt)?);
    }
    let first = one_scanner(&logs, request.logs)?;
    let (model, gear) = (first.model, first.gear);
    let start = request.start.unwrap_or(first.config.mount).mount();
    let simulated = logs.iter().any(|log| log.report.contents.simulated);
    let scans: Vec<Scan> = logs.into_iter().map(|log| log.scan).collect();
    progress(CalibrateProgress::Shots(scans.iter().map(Scan::len).sum()));
    let lasers = tables(model);
    let estimate = calibration::CalibrationRequest {
        scans: &scans,
        lasers: &lasers,
        start,
        gear,
        fixed: request.fixed,
    };
    let made = calibration::calibrate(&estimate, &mut |loops, moves_sd| {
        progress(CalibrateProgress::Loop(loops, moves_sd));
        request.interrupt.load(Ordering::Relaxed)
    });
    let mut calibration = made.map_err(|refusal| refused(&refusal, request))?;
    if request.level_floor {
        calibration = calibration
            .level(&scans)
            .map_err(|refusal| refused(&refusal, request))?;
    }
    let shots = scans.iter().map(Scan::len);
    Ok(CalibrationResult {
        calibration,
        model,
        simulated,
        logs: request.logs.iter().cloned().zip(shots).collect(),
    })
}

/// The first of the logs; all are of its lidar and gear.
pub(crate) fn one_scanner<'a>(
    logs: &'a [ReadLog],
    paths: &[PathBuf],
) -> Result<&'a ReadLog, Failure> {
    let Some(first) = logs.first() else {
        return Err(Failure::new(Kind::Usage, "no log").help("name one or more"));
    };
    // Other scans do not last as long to the nanosecond.
    let same = |a: &ReadLog, b: &ReadLog| {
        let of = |log: &ReadLog| (log.report.contents.duration_s.to_bits(), log.scan.len());
        of(a) == of(b)
    };
    for (index, log) in logs.iter().enumerate() {
        if let Some(twin) = logs
            .iter()
            .take(index)
            .position(|earlier| same(earlier, log))
        {
            let name = |index: usize| {
                paths
                    .get(index)
                    .map_or_else(String::new, |path| path.display().to_string())
            };
            let what = format!("{} and {} are the same scan", name(twin), name(index));
            return Err(Failure::new(Kind::Usage, what).help("name each scan once"));
        }
    }
    let is_other = |log: &ReadLog| log.model != first.model || log.gear != first.gear;
    match logs.iter().zip(paths).find(|(log, _)| is_other(log)) {
        None => Ok(first),
        Some((_, path)) => {
            let what = format!(
                "{}: another lidar or gear than the first log's",
                path.display()
            );
            Err(Failure::new(Kind::BadInput, what).help("use the logs of one scanner at a time"))
        }
    }
}

/// Reads the shots of a log, without mount and corrections.
pub(crate) fn read(
    path: &Path,
    tilt: TiltSource,
    interrupt: &AtomicBool,
) -> Result<ReadLog, Failure> {
    let mut source = Source::open(path, None)?;
    let config = source.config()?;
    source.set_mount(MountSettings::from(MountConfig::upright(0.0)));
    let request = Reconstruction {
        recording: &source,
        tilt,
        options: Options::default(),
        time: TimeReference::Host,
        accuracy: Accuracy::Best,
        pace: None,
        truth: None,
        live: false,
        lost_records: 0,
        georeference: None,
        interrupt,
    };
    let mut points = Points::new(Scan::FIELDS);
    let report =
        replay::scan(&request, &mut points, path).map_err(|failure| match failure.kind {
            // The advice is for a cloud, and there are options that these commands lack.
            Kind::BadInput => failure.help("use logs of captures with whole sweeps"),
            _ => failure,
        })?;
    if let Some(missing) = completeness::missing(&report) {
        tracing::warn!("{}: {missing}", path.display());
    }
    let name = report.contents.model.as_deref();
    let model = ALL
        .into_iter()
        .find(|model| Some(model.name) == name)
        .ok_or_else(|| {
            let what = format!("{}: the model of the lidar is unknown", path.display());
            Failure::new(Kind::BadInput, what).help("use logs of captures")
        })?;
    let scan = Scan::new(&points, &tables(model)).map_err(|error| {
        Failure::new(Kind::BadInput, format!("{}: {error}", path.display()))
            .help("use logs of captures")
    })?;
    let [motor, axis] = config.axis.gear;
    Ok(ReadLog {
        scan,
        model,
        config,
        gear: f64::from(motor) / f64::from(axis),
        report,
    })
}

pub(crate) fn tables(model: &LidarModel) -> Vec<NominalLaser> {
    let lasers = model.lasers.iter().map(|laser| NominalLaser {
        elevation_deg: laser.elevation_deg,
        vertical_offset_m: laser.vertical_offset_m,
    });
    lasers.collect()
}

/// The failure for a refusal, with what helps.
fn refused(refusal: &CalibrationRefusal, request: &CalibrateRequest<'_>) -> Failure {
    if *refusal == CalibrationRefusal::Interrupted {
        return Failure::new(
            Kind::Interrupted,
            "stopped by the user during the calibration",
        )
        .help("nothing was written; run the command again");
    }
    if matches!(refusal, CalibrationRefusal::UnknownParameter { .. }) {
        return Failure::new(Kind::Usage, format!("--fix: {refusal}"))
            .help("name a parameter, or its first words, such as mount_rotation");
    }
    let help = match refusal {
        CalibrationRefusal::FewPatches { .. } => {
            "scan where walls, floors or other smooth surfaces are within 50 m"
        }
        CalibrationRefusal::Drift { .. } => {
            "fasten the base and scan again; a soft floor or a tripod gives way"
        }
        CalibrationRefusal::Misfit { chi2 } if *chi2 < 1.0 => {
            "the ranges agree better than their stated noise: state a smaller range_sd_m in [lidar] before the scan; \
             a simulated capture has no noise: velomotion help calibrate-simulated"
        }
        CalibrationRefusal::Misfit { .. } => {
            "the scene moved, or the scanner has an error that is not in the model; scan another place"
        }
        CalibrationRefusal::NotSettled { .. } | CalibrationRefusal::StartsDisagree { .. } => {
            "scan a place with surfaces in several directions and distances, both ways, at two speeds"
        }
        CalibrationRefusal::NoFloor => "omit --level, or scan where a floor is in view",
        _ => "report it with the logs",
    };
    let logs: Vec<String> = request
        .logs
        .iter()
        .map(|log| log.display().to_string())
        .collect();
    Failure::new(Kind::Incomplete, format!("{}: {refusal}", logs.join(", "))).help(help)
}

/// The mount that a calibration gives, for configurations.
fn mount_config(mount: &Mount) -> MountConfig {
    let [x, y, z] = mount.position_m();
    MountConfig {
        position_m: [x, y, 0.0],
        rotation_deg: mount.rotation_deg(),
        ..MountConfig::upright(z)
    }
}
