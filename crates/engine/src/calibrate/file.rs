//! The file of a calibration, `mount.toml`.

use calibration::ParameterKind;
use scanner::config::{
    AxisCorrection, DeviceCalibration, LaserCalibration, MountConfig, ParameterCovariance,
};
use serde::Serialize;

use super::report::correlations;
use super::{CalibrationResult, mount_config};

#[derive(Serialize)]
struct CalibrationFileText<'a> {
    #[serde(flatten)]
    calibration: DeviceCalibration,
    mount: MountConfig,
    evidence: EvidenceTable<'a>,
}

#[derive(Serialize)]
struct EvidenceTable<'a> {
    velomotion: &'a str,
    simulated: bool,
    logs: Vec<String>,
    shots: usize,
    patches: usize,
    chi2: f64,
    loops: usize,
}

/// The calibration as TOML, with the version of the program that made it.
///
/// # Errors
/// The serialiser's error.
pub fn to_toml(calibrated: &CalibrationResult, version: &str) -> Result<String, toml::ser::Error> {
    let evidence = &calibrated.calibration.evidence;
    let file = CalibrationFileText {
        calibration: device_calibration(calibrated),
        mount: mount_config(&calibrated.calibration.mount()),
        evidence: EvidenceTable {
            velomotion: version,
            simulated: calibrated.simulated,
            logs: calibrated
                .logs
                .iter()
                .map(|(path, _)| path.display().to_string())
                .collect(),
            shots: evidence.shots,
            patches: evidence.patches,
            chi2: evidence.chi2,
            loops: evidence.loops,
        },
    };
    let first = match calibrated.simulated {
        true => "# SIMULATED: calibrated by logs of simulated devices\n",
        false => "",
    };
    let text = toml::to_string(&file)?;
    Ok(format!("{first}{text}"))
}

/// Results of the calibration besides the mount.
fn device_calibration(calibrated: &CalibrationResult) -> DeviceCalibration {
    let calibration = &calibrated.calibration;
    let value = |kind| calibration.value(kind);
    let scanner = calibration.of_the_scanner();
    let lasers = calibrated.model.lasers.iter().zip(0_u8..).enumerate();
    DeviceCalibration {
        model: Some(calibrated.model.name.to_owned()),
        axis_correction: AxisCorrection {
            delay_us: value(ParameterKind::Delay),
            scale: value(ParameterKind::Scale),
            ripple_deg: [ParameterKind::RippleSin, ParameterKind::RippleCos].map(value),
            play_deg: value(ParameterKind::Play),
        },
        laser: lasers
            .map(|(index, (laser, id))| LaserCalibration {
                id,
                elevation_deg: laser.elevation_deg + value(ParameterKind::Elevation(index)),
                azimuth_offset_deg: laser.azimuth_offset_deg + value(ParameterKind::Azimuth(index)),
                range_offset_m: value(ParameterKind::Range(index)),
            })
            .collect(),
        covariance: Some(ParameterCovariance {
            names: scanner
                .iter()
                .map(|estimate| estimate.name.clone())
                .collect(),
            sd: scanner.iter().map(|estimate| estimate.sd).collect(),
            correlation: correlations(calibration, scanner.len()),
        }),
    }
}
