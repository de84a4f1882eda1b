//! The study of accuracy from a log, with the truth of its scene.

use std::sync::atomic::AtomicBool;

use engine::accuracy::{AccuracyReport, AccuracyRequest, accuracy};

use super::Simulated;

#[test]
fn errors_of_a_simulated_scan_are_as_large_as_stated_in_every_bin() {
    let text = "scene = \"hall\"\n[motion]\nkind = \"sweeps\"\nfrom_deg = 0.0\nto_deg = -45.0\nspeed_deg_s = 56.25\naccel_deg_s2 = 5000.0\n\
                count = 2\nboth_ways = true\n[mount]\nd_m = 0.07\n[effects]\nall = false\n[effects.range_noise]\nsd_m = 0.01\n";
    let scene = Simulated::new(text, |_| {});
    let place = |time_ns: i64, laser: u8| {
        let hits = scene.truth.get(&scene.key(time_ns, laser))?;
        hits.first().map(|hit| hit.position_m.to_array())
    };
    let logs = [scene.log()];
    let request = AccuracyRequest {
        logs: &logs,
        mount: None,
        truth: Some(&place),
        interrupt: &AtomicBool::new(false),
    };
    let report = AccuracyReport::new(&accuracy(&request, &mut |_| {}).unwrap());
    assert!(report.simulated && !report.calibrated);
    let mut compared = 0;
    for group in &report.residuals {
        for bin in group.bins.iter().filter(|bin| bin.shots > 2_000) {
            compared += 1;
            let by = &group.by;
            let ratio = bin.rms_mm / bin.expected_mm;
            let known = bin.truth.unwrap();
            println!(
                "| {by} | {:.1} | {} | {:.2} | {:.2} | {ratio:.2} | {:.2} | {:.2} | {:.2} |",
                bin.from,
                bin.shots,
                bin.mean_mm,
                bin.rms_mm,
                known.rms_mm,
                known.stated_mm,
                known.error_over_sd
            );
            assert!((0.92..1.08).contains(&ratio), "{by} {bin:?}");
            let ratio = known.error_over_sd;
            assert!((0.9..1.1).contains(&ratio), "{by} {bin:?}");
        }
    }
    assert!(compared > 40, "{compared}");
    let [pair] = report.sweeps[..] else {
        panic!("{:?}", report.sweeps)
    };
    assert!(pair.both_ways && pair.patches > 500, "{pair:?}");
    let noise_mm = report.lasers.iter().map(|laser| laser.noise_mm.unwrap());
    assert!(noise_mm.into_iter().all(|noise| (noise - 10.0).abs() < 0.7));
    println!("{pair:?}");
    for bin in &report.budget {
        println!("{bin:?}");
    }
    // Range noise is most of it; no calibration is known.
    let far = report.budget.last().unwrap();
    assert!(far.mount_mm.is_none() && far.total_mm < 11.0, "{far:?}");
}
