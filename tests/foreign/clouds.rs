//! Clouds in foreign readers: MCAP in mcap and rosbags, E57 in pye57, PLY and PCD in Open3D. LAZ
//! in laspy is in `main.rs`. XYZ is read by Open3D, too, KITTI and npz by numpy.

use cloud::Summary;
use serde_json::{Value, json};
use units::{Host, Stamp};
use velomotion_tests::capture::{Captured, Setting};

use super::run_script;

/// Checks that counts are equal, and bounds up to rounding to f32.
fn same(summary: &Summary, got: &Value, least: &str, greatest: &str) {
    let bounds = summary.bounds.unwrap();
    for (name, wanted) in [(least, bounds.min_m), (greatest, bounds.max_m)] {
        for (axis, wanted) in wanted.iter().enumerate() {
            let got = got[name][axis].as_f64().unwrap();
            assert!((got - wanted).abs() < 4e-6, "{name} {axis}: {got} {wanted}");
        }
    }
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn mcap_and_rosbags_read_our_recording_completely() {
    let scan = Captured::new(Setting::default());
    let recording = scan.cloud_file("cloud.mcap");
    let (report, cloud) = scan.scan();
    let got = run_script("mcap_reads.py", &[&recording]);
    assert_eq!(got["profile"], "ros2");
    assert_eq!(got["encodings"], json!([["cdr", "ros2msg"]]));
    assert_eq!(got["records"]["velomotion"]["simulated"], "true");
    let about = got["records"]["velomotion"]["about"].as_str().unwrap();
    assert!(about.starts_with("SIMULATED"), "{about}");

    let summary = cloud.summary();
    assert_eq!(got["points"].as_u64(), Some(summary.points));
    assert_eq!(got["bag_points"].as_u64(), Some(summary.points));
    same(&summary, &got, "min", "max");
    assert_eq!(got["counts"]["/velomotion/points"], report.sweeps.len());
    // All but the slowest tenth of the polls, whose instants are unknown.
    let samples = report.contents.tilt.as_ref().unwrap().samples;
    let states = got["counts"]["/joint_states"].as_u64().unwrap();
    assert!(
        states * 10 >= samples * 9 && states <= samples,
        "{states} of {samples}"
    );
    for topic in ["/tf", "/tf_static", "/diagnostics"] {
        assert!(got["counts"][topic].as_u64() > Some(0), "{topic}: {got}");
    }
    assert_eq!(got["counts"], got["bag_counts"]);
    let all: u64 = got["counts"]
        .as_object()
        .unwrap()
        .values()
        .filter_map(Value::as_u64)
        .sum();
    assert_eq!(got["bag_messages"], all);
    let span = got["log_span_ns"].as_i64().unwrap();
    // rosbags includes the last nanosecond.
    assert_eq!(got["bag_duration_ns"].as_i64(), Some(span + 1));

    assert_eq!(
        got["same_bytes"], true,
        "messages encoded again are the same"
    );
    assert_eq!(
        got["same_types"], true,
        "definitions are those of ROS 2 Jazzy"
    );
    assert_eq!(got["latched"], json!(["/tf_static"]));
    assert_eq!(got["sorted"], true);
    assert_eq!(
        got["fields"],
        json!(["x", "y", "z", "intensity", "ring", "time"])
    );
    assert_eq!(got["least_time_s"], 0.0);
    let first = cloud.time().iter().min().unwrap();
    assert_eq!(got["stamps"][0].as_i64(), Some(first.as_nanos()));
    assert_eq!(
        got["frames"],
        json!([
            "base_link",
            "base_link/tilt_base",
            "tilt_base/tilt_platform",
            "tilt_platform/lidar"
        ])
    );
    let [low, high] = [0, 1].map(|i| got["tilt_deg"][i].as_f64().unwrap());
    let sweep = report.sweeps[0];
    let (from, to) = (
        sweep.from_deg.min(sweep.to_deg),
        sweep.from_deg.max(sweep.to_deg),
    );
    assert!(
        low < from + 0.01 && high > to - 0.01,
        "{low} {high} {from} {to}"
    );
    let checks = &got["checks"];
    assert_eq!(checks["velomotion: devices"]["level"], 1, "{checks}");
    assert_eq!(
        checks["velomotion: lidar"]["values"]["lost_packets"], "0",
        "{checks}"
    );
    for (check, value) in [
        ("velomotion: clock", "residual_us"),
        ("velomotion: tilt", "residual_rms_deg"),
    ] {
        let value = checks[check]["values"][value].as_str().unwrap();
        assert!(value.parse::<f64>().is_ok(), "{check}: {checks}");
    }
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn pye57_reads_our_e57_with_the_right_count_and_bounds() {
    let scan = Captured::new(Setting::default());
    let file = scan.cloud_file("cloud.e57");
    let got = run_script("e57_reads.py", &[&file]);
    let cloud = scan.cloud();
    let summary = cloud.summary();
    assert_eq!(got["scans"], 1);
    assert_eq!(got["points"].as_u64(), Some(summary.points));
    assert_eq!(got["read"], got["points"]);
    same(&summary, &got, "min", "max");
    same(&summary, &got, "header_min", "header_max");
    let span = |values: &[u8]| json!([values.iter().min().unwrap(), values.iter().max().unwrap()]);
    assert_eq!(got["rows"], span(cloud.ring()));
    let [least, greatest] = [0, 1].map(|i| got["intensity"][i].as_f64().unwrap() as u8);
    assert_eq!(json!([least, greatest]), span(cloud.intensity()));
    // Offset from the whole second of the first point.
    let first = cloud.time().iter().min().unwrap().as_nanos();
    for (i, time) in [cloud.time().iter().min(), cloud.time().iter().max()]
        .into_iter()
        .enumerate()
    {
        let since = (time.unwrap().as_nanos() - first.div_euclid(1_000_000_000) * 1_000_000_000)
            as f64
            * 1e-9;
        let time = got["times_s"][i].as_f64().unwrap();
        assert!((time - since).abs() < 1e-9, "{time} {since}");
    }
    for (i, wanted) in [f64::min as fn(f64, f64) -> f64, f64::max]
        .into_iter()
        .enumerate()
    {
        let wanted = cloud.tilt_deg().iter().copied().reduce(wanted).unwrap();
        let tilt = got["tilt_deg"][i].as_f64().unwrap();
        assert!((tilt - wanted).abs() < 4e-6, "{tilt} {wanted}");
    }
    // Points are in the frame of the file. GPS time began at Unix second 315,964,800, and is 18
    // leap seconds ahead since 2017.
    assert_eq!(got["pose"], json!([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]));
    let last = cloud.time().iter().max().unwrap().as_nanos();
    for (i, unix_s) in [first.div_euclid(1_000_000_000) as f64, last as f64 * 1e-9]
        .into_iter()
        .enumerate()
    {
        let time = got["acquired_gps_s"][i].as_f64().unwrap();
        assert!(
            (time - (unix_s - 315_964_800.0 + 18.0)).abs() < 1e-6,
            "{time} {unix_s}"
        );
    }
    let description = got["description"].as_str().unwrap();
    assert!(description.starts_with("SIMULATED"), "{description}");
    let fields = got["fields"].as_array().unwrap();
    assert!(
        fields.iter().any(|field| field == "velomotion:tilt"),
        "{fields:?}"
    );
}

/// The scans of a file are the sweeps of the log, and together its cloud.
#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn pye57_reads_each_sweep_of_our_e57_as_a_scan() {
    let mut setting = Setting::default();
    setting.sweep_request.sweeps = 3;
    setting.sweep_request.both_ways = true;
    let scan = Captured::new(setting);
    let files = ["cloud.e57", "cloud.csv"].map(|name| scan.cloud_file(name));
    let got = run_script("e57_scans.py", &[&files[0], &files[1]]);
    let sweeps = scan.sweep_spans();
    assert_eq!(sweeps.len(), 3);
    let names = [1, 2, 3].map(|number| format!("SIMULATED sweep {number}"));
    assert_eq!(got["names"], json!(names));
    let mut guids: Vec<&str> = got["guids"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(Value::as_str)
        .collect();
    guids.sort_unstable();
    guids.dedup();
    assert_eq!(guids.len(), 3, "{got}");
    let cloud = scan.cloud();
    for (index, (begin, end)) in sweeps.into_iter().enumerate() {
        assert_eq!(
            got["poses"][index],
            json!([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
        );
        let within = cloud
            .time()
            .iter()
            .filter(|time| (begin..=end).contains(*time));
        assert_eq!(got["points"][index], within.clone().count());
        let seconds = |stamp: &Stamp<Host>| stamp.as_nanos() as f64 * 1e-9;
        let span = [within.clone().min(), within.max()].map(|time| seconds(time.unwrap()));
        for (got, wanted) in [
            (&got["spans_s"][index][0], span[0]),
            (&got["spans_s"][index][1], span[1]),
            (&got["ends_s"][index], span[1]),
        ] {
            let got = got.as_f64().unwrap();
            assert!((got - wanted).abs() < 1e-6, "{got} {wanted}");
        }
    }
    assert_eq!(got["rows"].as_u64(), Some(cloud.summary().points));
    let largest = |name: &str| got[name].as_f64().unwrap();
    assert!(largest("max_difference_m") < 4e-6, "{got}");
    assert!(largest("max_time_difference_s") < 1e-6, "{got}");
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn open3d_reads_our_ply_and_pcd_with_the_right_count_and_bounds() {
    let scan = Captured::new(Setting::default());
    let summary = scan.cloud().summary();
    for name in ["cloud.ply", "cloud.pcd"] {
        let file = scan.cloud_file(name);
        let got = run_script("open3d_reads.py", &[&file]);
        assert_eq!(got["points"].as_u64(), Some(summary.points), "{name}");
        same(&summary, &got, "min", "max");
        assert_eq!(
            got["columns"],
            json!(["intensity", "positions", "ring", "tilt", "time"]),
            "{name}"
        );
    }
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn open3d_reads_our_xyz_and_numpy_our_kitti_and_npz() {
    let scan = Captured::new(Setting::default());
    let summary = scan.cloud().summary();
    for (name, columns) in [
        ("cloud.xyz", json!(["positions"])),
        ("cloud.bin", json!(["positions", "reflectance"])),
        ("cloud.npz", json!(["intensity", "ring", "tilt", "time"])),
    ] {
        let file = scan.cloud_file(name);
        let got = run_script("open3d_reads.py", &[&file]);
        assert_eq!(got["points"].as_u64(), Some(summary.points), "{name}");
        same(&summary, &got, "min", "max");
        assert_eq!(got["columns"], columns, "{name}");
    }
}
