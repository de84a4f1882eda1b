//! A tilting scanner: log, replay, and the cloud against the truth.

use scanner::TiltSource;
use sim::scene_file::SHIPPED;

use super::{Simulated, replayed};

fn rms_and_worst(errors: &[(f64, f64)]) -> (f64, f64) {
    let squares: f64 = errors.iter().map(|(error, _)| error * error).sum();
    let worst = errors.iter().map(|(error, _)| *error).fold(0.0, f64::max);
    ((squares / errors.len() as f64).sqrt(), worst)
}

fn shipped(of: &str) -> &'static str {
    SHIPPED.iter().find(|(name, _)| *name == of).unwrap().1
}

/// The ideal scanner loses only range steps of 2 mm and azimuth steps of 0.01 deg.
#[test]
fn the_hall_is_recovered_from_its_log() {
    let scene = Simulated::new(shipped("hall"), |scene| scene.effects.leave_out(|_| true));
    assert!(scene.report.effects.is_empty());
    let (scan, cloud) = replayed(&scene.log(), TiltSource::Log);
    assert!(scan.contents.simulated);
    let [sweep] = scan.sweeps[..] else {
        panic!("{:?}", scan.sweeps)
    };
    assert!(sweep.from_deg.abs() < 1e-3 && (sweep.to_deg + 45.0).abs() < 1e-3);
    assert!((sweep.cruise_deg_s + 56.25).abs() < 1e-3, "{sweep:?}");
    assert!(cloud.len() > 230_000, "{}", cloud.len());
    let (rms_m, worst_m) = rms_and_worst(&scene.errors(&cloud));
    println!("rms {rms_m} worst {worst_m}");
    assert!(rms_m < 0.8e-3, "{rms_m}");
    assert!(worst_m < 2.2e-3, "{worst_m}");
}

/// The ideal motion of scan patterns has no ramps.
#[test]
fn sweeps_both_ways_without_ramps_are_recovered() {
    let text = "scene = \"hall\"\n[effects]\nall = false\n[motion]\nkind = \"sweeps\"\nfrom_deg = -10.0\nto_deg = 30.0\nspeed_deg_s = 100.0\nboth_ways = true\n\
                [mount]\nd_m = 0.1\n";
    let scene = Simulated::new(text, |_| {});
    let (scan, cloud) = replayed(&scene.log(), TiltSource::Log);
    let ways: Vec<_> = scan
        .sweeps
        .iter()
        .map(|s| (s.from_deg.round(), s.to_deg.round()))
        .collect();
    assert_eq!(ways, [(-10.0, 30.0), (30.0, -10.0)]);
    let (rms_m, worst_m) = rms_and_worst(&scene.errors(&cloud));
    println!("rms {rms_m} worst {worst_m}");
    assert!(rms_m < 0.8e-3, "{rms_m}");
    assert!(worst_m < 2.2e-3, "{worst_m}");
}

#[test]
fn range_noise_is_as_large_as_requested() {
    // The same room in a scene without effects.
    let text = shipped("rig").to_owned() + "\n[effects.range_noise]\nsd_m = 0.03\n";
    let scene = Simulated::new(&text, |_| {});
    assert_eq!(scene.report.effects.len(), 1);
    let (_, cloud) = replayed(&scene.log(), TiltSource::Log);
    let (rms_m, worst_m) = rms_and_worst(&scene.errors(&cloud));
    // 3 cm within half a percent for 2.4e5 draws; none over six standard deviations.
    assert!((rms_m - 0.03).abs() < 2e-4, "{rms_m}");
    assert!((0.11..0.19).contains(&worst_m), "{worst_m}");
}

/// The hall with its beam footprint: noise of 1 cm, and at edges some points between two surfaces.
#[test]
fn a_realistic_scan_of_the_hall_is_recovered() {
    let scene = Simulated::new(shipped("hall"), |_| {});
    assert_eq!(scene.report.effects.len(), 7);
    let (scan, cloud) = replayed(&scene.log(), TiltSource::Log);
    let [sweep] = scan.sweeps[..] else {
        panic!("{:?}", scan.sweeps)
    };
    assert!((sweep.to_deg + 45.0).abs() < 0.01, "{sweep:?}");
    assert_eq!(scan.contents.lost_packets, 0);
    // Frame and tripod block a ninth of the shots.
    assert!((200_000..220_000).contains(&cloud.len()), "{}", cloud.len());
    let mut errors = scene.errors(&cloud);
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    let quantile = |share: f64| errors[(share * errors.len() as f64) as usize].0;
    // Half of all normal draws are within 0.674 standard deviations, 95 % within 1.96.
    println!("{} {} {}", quantile(0.5), quantile(0.95), quantile(0.999));
    assert!((quantile(0.5) - 0.006_74).abs() < 5e-4, "{}", quantile(0.5));
    assert!(
        (0.019..0.022).contains(&quantile(0.95)),
        "{}",
        quantile(0.95)
    );
}

/// One request or answer in fifty is lost. The host times out after 20 ms and sends a probe
/// request, so that no later answer is paired with the wrong request. Otherwise every later answer
/// could belong to either of two requests and the sweep would seem to end.
#[test]
fn lost_answers_of_the_drive_cost_only_samples() {
    for seed in [3, 5, 8] {
        let lossy = format!(
            "seed = {seed}\n{}\n[effects.loss]\ndrive_share = 0.02\n",
            shipped("rig")
        );
        let scene = Simulated::new(&lossy, |_| {});
        let (scan, cloud) = replayed(&scene.log(), TiltSource::Log);
        let [sweep] = scan.sweeps[..] else {
            panic!("{:?}", scan.sweeps)
        };
        assert!(sweep.from_deg.abs() < 1e-3 && (sweep.to_deg + 45.0).abs() < 1e-3);
        assert!(cloud.len() > 230_000, "{}", cloud.len());
        let (rms_m, worst_m) = rms_and_worst(&scene.errors(&cloud));
        println!("seed {seed}: rms {rms_m} worst {worst_m}");
        assert!(rms_m < 0.8e-3, "{rms_m}");
        assert!(worst_m < 2.2e-3, "{worst_m}");
    }
}

/// The log has the whole mount, not its height alone.
#[test]
fn a_rotated_and_shifted_mount_is_recovered_from_the_log() {
    let text = "scene = \"hall\"\n[effects]\nall = false\n[motion]\nkind = \"sweeps\"\nfrom_deg = -10.0\nto_deg = 30.0\nspeed_deg_s = 100.0\n\
                [mount]\nd_m = 0.1\nposition_m = [0.01, -0.02, 0.03]\nrotation_deg = [2.0, -1.0, 170.0]\n";
    let scene = Simulated::new(text, |_| {});
    let (_, cloud) = replayed(&scene.log(), TiltSource::Log);
    let (rms_m, worst_m) = rms_and_worst(&scene.errors(&cloud));
    assert!(rms_m < 0.8e-3, "{rms_m}");
    assert!(worst_m < 2.2e-3, "{worst_m}");
}
