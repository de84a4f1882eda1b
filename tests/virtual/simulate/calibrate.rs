//! Calibration from a log to a mount file, of a scanner that is known.

use std::sync::atomic::AtomicBool;

use engine::calibrate::{CalibrateRequest, calibrate, to_toml};
use engine::config::load_mount;
use scanner::config::MountConfig;

use super::Simulated;

#[test]
fn the_mount_of_a_simulated_scanner_is_found_and_its_file_is_read_back() {
    let text = "scene = \"hall\"\n[motion]\nkind = \"sweeps\"\nfrom_deg = 0.0\nto_deg = -45.0\nspeed_deg_s = 56.25\naccel_deg_s2 = 5000.0\n\
                both_ways = true\n[mount]\nd_m = 0.07\nposition_m = [0.005, 0.0, 0.0]\nrotation_deg = [1.2, 0.0, -0.9]\n\
                [effects]\nall = false\n[effects.range_noise]\nsd_m = 0.01\n[effects.laser_errors]\nrange_m = [0.012, -0.008]\nelevation_deg = [0.0, 0.05]\n";
    let scene = Simulated::new(text, |_| {});
    let interrupt = AtomicBool::new(false);
    let logs = [scene.log()];
    let request = CalibrateRequest {
        logs: &logs,
        start: Some(MountConfig::upright(0.06)),
        fixed: &[],
        level_floor: false,
        interrupt: &interrupt,
    };
    let made = calibrate(&request, &mut |_| {}).unwrap();
    for (name, truth) in [
        ("mount_rotation_x_deg", 1.2),
        ("mount_rotation_z_deg", -0.9),
        ("mount_position_x_m", 0.005),
        ("mount_position_z_m", 0.07),
        ("laser_1_elevation_deg", 0.05),
    ] {
        let estimate = made.calibration.parameter(name).unwrap();
        let off = (estimate.value - truth).abs();
        assert!(off < 5.0 * estimate.sd, "{estimate:?}");
        assert!(estimate.posterior_over_prior < 0.3, "{estimate:?}");
    }
    let value = |name: &str| made.calibration.parameter(name).unwrap().value;
    let apart_m = value("laser_0_range_m") - value("laser_1_range_m");
    assert!((apart_m + 0.02).abs() < 1e-3, "{apart_m}");

    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mount.toml");
    std::fs::write(&file, to_toml(&made, "0").unwrap()).unwrap();
    let read = load_mount(&file).unwrap();
    let rotation = made.calibration.mount().rotation_deg();
    assert!((read.pose().rotation_deg[0] - rotation[0]).abs() < 1e-12);
    let calibration = read.calibration().unwrap();
    assert_eq!(
        (calibration.laser.len(), calibration.model.as_deref()),
        (16, Some("VLP-16"))
    );
    let covariance = calibration.covariance.as_ref().unwrap();
    assert_eq!(covariance.names.len(), 9 + 48);
}
