//! `plan`, `calibrate` and `simulate`: the commands' requests and reports.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use analysis::plan::PlanLimits;
use engine::calibrate::{CalibrateReport, CalibrateRequest, to_toml};
use engine::capture::scan_planner::{PlanRequest, ScanPlanner};
use engine::config;
use engine::devices::profile;
use engine::document::Document;
use engine::simulate::{
    Sampler, SimulationFiles, SimulationRequest, choose_effects, find, make, read, unmet,
};
use engine::{Failure, Kind, calibrate as calibration};
use pyo3::prelude::*;
use sim::effect_models::{EffectTolerance, EffectsConfig};
use sim::scene_file::SHIPPED;

use crate::arguments::{MountArgument, lidar_sheet};
use crate::binding_error::{BindingError, check_readable};
use crate::table::to_python;
use crate::work;

/// Predicts accuracy, density and time of a capture, and chooses its speed.
///
/// Parameters
/// ----------
/// at_m : float
///     Distance at which errors and gaps count, m.
/// error_mm : float, optional
///     Tolerated error of 95 % of points there, mm.
/// gap_deg : float, optional
///     Tolerated angle from a direction to the nearest point, for 99 % of directions in view.
/// time_s : float, optional
///     Time for the scan with homing.
/// lidar : str, optional
///     vlp16, hi-res, hdl32e, vlp32c, hdl64e, utm30lx or lms151; by default the configuration's.
/// rpm : int or sequence of int, optional
///     Revolutions of the lidar per minute to choose from.
/// range_sd_m, mount_sd_deg : float, optional
///     Standard deviations of a range, and of mount and zero of the tilt.
/// from_deg, to_deg : float, optional
///     Ends of the sweep.
/// config : path, optional
///     A velomotion.toml; by default the usual one.
/// device : str, optional
///     Device of the configuration, or "sim".
///
/// Returns
/// -------
/// dict
///     The object of velomotion plan --json: rows (command, scan_s, points, gap_deg, error_mm,
///     ...), chosen, and unmet if no setting meets the limits.
#[pyfunction]
#[pyo3(signature = (*, at_m=20.0, error_mm=None, gap_deg=None, time_s=None, lidar=None, rpm=None, range_sd_m=None,
    mount_sd_deg=None, from_deg=None, to_deg=None, config=None, device=None))]
#[expect(clippy::too_many_arguments, reason = "they are named in Python")]
pub(crate) fn plan<'py>(
    py: Python<'py>,
    at_m: f64,
    error_mm: Option<f64>,
    gap_deg: Option<f64>,
    time_s: Option<f64>,
    lidar: Option<String>,
    rpm: Option<&Bound<'py, PyAny>>,
    range_sd_m: Option<f64>,
    mount_sd_deg: Option<f64>,
    from_deg: Option<f64>,
    to_deg: Option<f64>,
    config: Option<PathBuf>,
    device: Option<String>,
) -> PyResult<Bound<'py, PyAny>> {
    let rpm: Vec<u32> = match rpm {
        None => Vec::new(),
        Some(rpm) => {
            let several: Vec<u32> = rpm
                .extract::<u32>()
                .map_or_else(|_| rpm.extract().unwrap_or_default(), |rpm| vec![rpm]);
            if several.is_empty() {
                let what = "rpm: expected a whole number, or several";
                return Err(BindingError::usage(what).into_py(py));
            }
            several
        }
    };
    let report = work::run(py, move |_| {
        if let Some(file) = &config {
            check_readable(file)?;
        }
        let config = config::load(config.as_deref())?;
        let (name, device) = profile::choose(&config, device.as_deref())?;
        let configured = config.lidar.sheet;
        let lidar = lidar.as_deref().map_or(Ok(configured), lidar_sheet)?;
        let rpm = match rpm.is_empty() {
            true if lidar == configured => vec![config.lidar.rpm],
            true => vec![lidar.usual_rpm()],
            false => rpm,
        };
        let request = PlanRequest {
            limits: PlanLimits {
                error_mm,
                gap_deg,
                time_s,
            },
            rpm,
            range_sd_m,
            mount_sd_deg,
            from_deg,
            to_deg,
            ..PlanRequest::new(at_m, lidar, 0)
        };
        let planner = ScanPlanner::new(&config, (&name, &device), request)?;
        Ok(planner.plan()?.to_json())
    })?;
    to_python(py, &report)
}

/// Calibrates mount, axis and lasers of a scanner by its logs, without targets.
///
/// Parameters
/// ----------
/// logs : path or sequence of paths
///     Logs of one scanner.
/// mount : path or float, optional
///     Mount to start from: a file, or the height above the tilt axis in m. By default the first
///     log's.
/// fix : sequence of str
///     Parameters that stay as they are: all whose names begin with one of these.
/// level_floor : bool
///     Whether the floor sets the zero of the tilt.
///
/// Returns
/// -------
/// dict
///     The object of velomotion calibrate --json (mount, parameters with value, sd and observable,
///     correlation, residual_mm, lasers, ...), and toml, the text for a mount.toml.
#[pyfunction]
#[pyo3(signature = (logs, *, mount=None, fix=Vec::new(), level_floor=false))]
pub(crate) fn calibrate<'py>(
    py: Python<'py>,
    logs: &Bound<'py, PyAny>,
    mount: Option<&Bound<'py, PyAny>>,
    fix: Vec<String>,
    level_floor: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let logs: Vec<PathBuf> = match logs.extract::<PathBuf>() {
        Ok(log) => vec![log],
        Err(_) => logs.extract()?,
    };
    let mount = MountArgument::new(mount)?;
    let (report, toml) = work::run(py, move |interrupt| {
        logs.iter().try_for_each(|log| check_readable(log))?;
        let start = mount.map(|mount| mount.load()).transpose()?;
        let request = CalibrateRequest {
            logs: &logs,
            start: start.map(|mount| mount.pose()),
            fixed: &fix,
            level_floor,
            interrupt,
        };
        let calibrated = calibration::calibrate(&request, &mut |_| {})?;
        let toml = to_toml(&calibrated, env!("CARGO_PKG_VERSION"));
        let toml = toml.map_err(|error| Failure::new(Kind::Incomplete, error.to_string()))?;
        Ok((CalibrateReport::new(&calibrated).to_json(), toml))
    })?;
    let report = to_python(py, &report)?;
    report.set_item("toml", toml)?;
    Ok(report)
}

/// Simulates a scene into a log, as the devices would send it.
///
/// Parameters
/// ----------
/// scene : path or str
///     A scene file (TOML), or a built-in scene such as "hall".
/// output : path
///     The log to write: .pcapng, or .pcap for the lidar's packets alone; the measured cloud of a
///     lidar whose packets are not simulated.
/// truth : path, optional
///     Cloud of the true points (.ply, .pcd, .las, .laz, .e57, .mcap, .csv, .xyz, .bin,
///     .npz).
/// seed : int, optional
///     Random seed; by default the scene's.
/// without : sequence of str
///     Effects of the scene to omit, or "all".
/// tolerance : str, optional
///     As few effects as keep the cloud this close to one with all, such as "5mm,1%"; by default
///     the scene's.
/// threads : int, optional
///     Threads that make packets; the log does not depend on it. By default one per core.
/// force : bool
///     Whether to overwrite existing files.
///
/// After Ctrl-C log and truth are there, complete up to that time.
///
/// Returns
/// -------
/// dict
///     The object of velomotion simulate --json: packets, returned, effects, warnings, log, ...
#[pyfunction]
#[pyo3(signature = (scene, output, *, truth=None, seed=None, without=Vec::new(), tolerance=None, threads=None,
    force=false))]
#[expect(clippy::too_many_arguments, reason = "they are named in Python")]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    scene: PathBuf,
    output: PathBuf,
    truth: Option<PathBuf>,
    seed: Option<u64>,
    without: Vec<String>,
    tolerance: Option<&str>,
    threads: Option<usize>,
    force: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let tolerance = tolerance.map(str::parse::<EffectTolerance>).transpose();
    let tolerance = tolerance
        .map_err(|error| BindingError::usage(format!("tolerance: {error}")).into_py(py))?;
    let report = work::run(py, move |interrupt| {
        let is_known = |effect: &&String| {
            *effect != ALL_EFFECTS && !EffectsConfig::NAMES.contains(&effect.as_str())
        };
        if let Some(unknown) = without.iter().find(is_known) {
            let known = EffectsConfig::NAMES.join(", ");
            return Err(BindingError::usage(format!(
                "without: expected some of {known}, {ALL_EFFECTS}; got {unknown:?}"
            )));
        }
        let is_shipped = SHIPPED.iter().any(|(name, _)| scene.as_os_str() == *name);
        if !is_shipped {
            check_readable(&scene)?;
        }
        let cores = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        let threads = threads.map_or_else(|| Some(cores()), NonZeroUsize::new);
        let threads =
            threads.ok_or_else(|| BindingError::usage("threads: expected 1 or more, got 0"))?;
        let (name, text) = find(&scene)?;
        let mut scene_file = read(&name, &text, seed, None)?;
        for (name, path) in [("output", Some(&output)), ("truth", truth.as_ref())] {
            if path.is_some_and(|path| path.as_os_str() == "-") {
                let what = format!("{name}: expected a file, got \"-\"");
                return Err(BindingError::usage(what));
            }
        }
        let files = SimulationFiles {
            scene: &scene,
            output: &output,
            option: "output",
            truth: truth.as_deref(),
            force,
        };
        let (output, truth) = files.open(&scene_file)?;
        let is_out =
            |effect: &str| (without.iter()).any(|name| name == effect || name == ALL_EFFECTS);
        let choice = choose_effects(
            &mut scene_file,
            &name,
            is_out,
            tolerance,
            threads,
            None,
            None,
        )?;
        let is_chosen_out = |effect: &str| {
            (choice.iter()).any(|choice| choice.off.iter().any(|out| out.effect == effect))
        };
        let warnings = unmet(&Sampler::new(&scene_file, threads), None, &is_chosen_out)?;
        let request = SimulationRequest {
            name,
            output,
            truth,
            threads,
            explain: false,
            interrupt,
            progressed: &mut |_| {},
        };
        let (mut report, failure) = make(scene_file, request)?;
        if let Some(failure) = failure {
            return Err(failure.into());
        }
        report.warnings.extend(warnings);
        report.choice = choice;
        Ok(report.to_json())
    })?;
    to_python(py, &report)
}

/// Name of all effects in `without`.
const ALL_EFFECTS: &str = "all";
