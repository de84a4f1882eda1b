//! Statistics of a scan: those of `velomotion analyze`, and never during a capture.

use serde_json::{Value, json};

use super::rig::{Rig, request, run, sweep};

/// Whether two numbers agree to a share of them.
fn agree(found: &Value, expected: &Value, share: f64) {
    let (found, expected) = (found.as_f64().unwrap(), expected.as_f64().unwrap());
    assert!(
        (found - expected).abs() <= share * expected.abs(),
        "{found} {expected}"
    );
}

#[test]
fn statistics_are_those_of_analyze_and_of_the_plan() {
    let rig = Rig::new();
    rig.ready();
    let scan = rig.whole_scan(&json!({"speed_deg_s": 20.0}));
    let id = scan["id"].as_str().unwrap();
    let answer = rig.get(&format!("/api/v1/scans/{id}/statistics"));
    assert_eq!(answer.status, 200, "{}", answer.text());
    let found = answer.json();
    assert_eq!(found["points"], scan["points"]);

    let line = format!("analyze {} --json", rig.log(id).display());
    let output = run(rig.folder.path(), &line);
    assert!(output.status.success(), "{output:?}");
    let analyzed: Value = serde_json::from_slice(&output.stdout).unwrap();
    let analyzed = &analyzed["patterns"][0];
    assert_eq!(found["points"], analyzed["points"]);
    assert_eq!(found["of"], analyzed["gaps"]["of"]);
    // The range of distances, on whose ends the field of view depends, is to a centimetre here.
    let in_view = &analyzed["density_in_view"];
    for key in ["bins", "mean", "sd", "mean_per_deg2"] {
        agree(&found["density"][key], &in_view[key], 2e-3);
    }
    let gaps = &analyzed["gaps"];
    for (key, other) in [
        ("p50", "median_deg"),
        ("p95", "of_95_percent_deg"),
        ("p99", "of_99_percent_deg"),
    ] {
        agree(&found["gap_deg"][key], &gaps[other], 1e-2);
    }

    let ranges = found["ranges"].as_array().unwrap();
    let points = ranges.iter().map(|class| class["points"].as_u64().unwrap());
    assert_eq!(Some(points.sum::<u64>()), found["points"].as_u64());
    let reached: Vec<&Value> = ranges.iter().filter(|class| class["points"] != 0).collect();
    // The hall of the simulator.
    let (near, far) = (&reached[0]["from_m"], &reached[reached.len() - 1]["to_m"]);
    assert!(
        near.as_f64().unwrap() < 3.0 && far.as_f64().unwrap() > 8.0,
        "{near} {far}"
    );
    let sd = |key: &str| found["sd_mm"][key].as_f64().unwrap();
    assert!(
        0.1 < sd("p50") && sd("p50") <= sd("p95") && sd("p95") <= sd("p99"),
        "{found}"
    );

    let plan = rig.get("/api/v1/plan?speed_deg_s=20").json();
    let budget = found["budget"].as_array().unwrap();
    let at_20_m = budget.iter().find(|row| row["at_m"] == 20.0).unwrap();
    agree(&at_20_m["error_mm"]["total"], &plan["error_mm"], 1e-9);
    assert!(budget.len() >= 4, "{found}");
}

#[test]
fn no_statistics_are_made_during_a_capture_or_of_what_has_no_log() {
    let rig = Rig::with("", |options| {
        let place = options.config.daemon.scans.clone().unwrap().join("empty");
        std::fs::create_dir_all(&place).unwrap();
        std::fs::write(place.join("cloud.ply"), "none").unwrap();
        std::fs::write(place.join("scan.json"), "{\"state\": 7}").unwrap();
    });
    rig.ready();
    let id = rig.whole_scan(&json!({"speed_deg_s": 56.25}))["id"].clone();
    let path = |id: &str| format!("/api/v1/scans/{id}/statistics");
    let of_scan = path(id.as_str().unwrap());
    rig.get(&path("none")).refused(404, "unknown");
    rig.get(&path("empty")).refused(404, "without a log");
    let running = sweep(rig.address);
    rig.get(&path(&running)).refused(409, "recorded");
    let refused = rig.get(&of_scan);
    assert_eq!(refused.refused(409, "during a capture")["kind"], "busy");
    rig.post("/api/v1/captures/stop", &json!({}));
    rig.finished(&running);
    assert_eq!(request(rig.address, "GET", &of_scan, "", "").status, 200);
}
