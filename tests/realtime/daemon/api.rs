//! Requests and their answers.

use serde_json::{Value, json};

use super::rig::{Rig, post, request};

/// Bodies of invalid captures.
fn invalid_captures() -> Vec<Value> {
    vec![
        json!({}),
        json!([]),
        json!("fast"),
        json!(null),
        json!({"speed_deg_s": 0.0}),
        json!({"speed_deg_s": -5.0}),
        json!({"speed_deg_s": 1e300}),
        json!({"speed_deg_s": 100.0}),
        json!({"speed_deg_s": "10"}),
        json!({"speed_deg_s": 10.0, "to_deg": -60.0}),
        json!({"speed_deg_s": 10.0, "from_deg": 5.0}),
        json!({"speed_deg_s": 10.0, "from_deg": -10.0, "to_deg": -10.0}),
        json!({"speed_deg_s": 10.0, "accel_deg_s2": 0.0}),
        json!({"speed_deg_s": 10.0, "sweeps": 0}),
        json!({"speed_deg_s": 10.0, "sweeps": 10_001}),
        json!({"speed_deg_s": 10.0, "sweeps": -1}),
        json!({"speed_deg_s": 10.0, "sweeps": 1.5}),
        json!({"speed_deg_s": 10.0, "tolerance": "some"}),
        json!({"speed_deg_s": 10.0, "name": "../../etc"}),
        json!({"speed_deg_s": 10.0, "name": ""}),
        json!({"speed_deg_s": 10.0, "speed": 10.0}),
    ]
}

#[test]
fn invalid_requests_are_refused_and_nothing_moves() {
    let rig = Rig::new();
    rig.ready();
    for body in invalid_captures() {
        let what = body.to_string();
        rig.post("/api/v1/captures", &body).refused(400, &what);
    }
    for body in [
        json!({}),
        json!({"to_deg": 10.0}),
        json!({"to_deg": -60.0}),
        json!({"to_deg": -10.0, "speed_deg_s": 1e9}),
        json!({"to_deg": -10.0, "accel_deg_s2": -1.0}),
        json!({"to_deg": null}),
        json!({"to_deg": -10.0, "now": true}),
    ] {
        rig.post("/api/v1/tilt/goto", &body)
            .refused(400, &body.to_string());
    }
    for path in [
        "/api/v1/plan",
        "/api/v1/plan?speed_deg_s=x",
        "/api/v1/plan?speed_deg_s=10&speed_deg_s=11",
        "/api/v1/plan?speed_deg_s=NaN",
        "/api/v1/plan?speed_deg_s=10&name=a/b",
        "/api/v1/events",
        "/api/v1/events?points=perhaps",
        "/api/v1/events?thin=0",
        "/api/v1/events?thin=100000",
    ] {
        rig.get(path).refused(400, path);
    }
    for path in [
        "/api/v1/scans/none",
        "/api/v1/scans/none/log",
        "/api/v1/scans/none/cloud",
        "/api/v1/scans/none/thumbnail",
        "/api/v1/scans/..%2f..%2fetc%2fpasswd",
        "/api/v1/scans/%00",
        "/api/v2/status",
        "/nothing",
        "/../../etc/passwd",
    ] {
        rig.get(path).refused(404, path);
    }
    for (method, path) in [
        ("PUT", "/api/v1/captures"),
        ("GET", "/api/v1/captures"),
        ("POST", "/api/v1/status"),
        ("DELETE", "/api/v1/scans"),
        ("PUT", "/api/v1/scans/none"),
        ("POST", "/"),
    ] {
        let answer = request(rig.address, method, path, "", "");
        answer.refused(405, path);
        assert!(
            answer.head.to_lowercase().contains("\nallow:"),
            "{}",
            answer.head
        );
    }
    let text = "content-type: text/plain\r\n";
    request(
        rig.address,
        "POST",
        "/api/v1/captures",
        text,
        "{\"speed_deg_s\": 10}",
    )
    .refused(415, "text");
    let json_type = "content-type: application/json\r\n";
    request(
        rig.address,
        "POST",
        "/api/v1/captures",
        json_type,
        "{\"speed",
    )
    .refused(400, "half a body");
    // Nothing has moved: the axis has no reference yet.
    let status = rig.status();
    assert_eq!(status["activity"]["doing"], "idle");
    assert_eq!(status["drive"]["referenced"], false);
    assert_eq!(rig.get("/api/v1/scans").json()["scans"], json!([]));
}

#[test]
fn a_plan_describes_the_capture() {
    let rig = Rig::new();
    rig.ready();
    let plan = rig.get("/api/v1/plan?speed_deg_s=56.25&accel_deg_s2=500&sweeps=2&both_ways=true");
    let plan = plan.json();
    assert_eq!(plan["motor_rpm"], 1125);
    let near = |key: &str, wanted: f64, within: f64| {
        let got = plan[key].as_f64().unwrap();
        assert!((got - wanted).abs() < within, "{key}: {got}, not {wanted}");
    };
    near("cruise_deg_s", 56.25, 1e-9);
    near("sweep_s", 0.8 + 56.25 / 500.0, 1e-3);
    near("moves_s", 2.0 * (0.8 + 56.25 / 500.0), 1e-3);
    // 10 revolutions per second.
    near("step_deg", 5.625, 0.05);
    // The paper's value: 75 deg shared by 16 lasers in 8 revolutions.
    near("resolution_deg", 0.586, 0.005);
    near("gap_deg", 0.8, 0.4);
    near("error_mm", 9.9, 0.3);
    assert_eq!(plan["warning"], json!(null));
    let plan = rig.get("/api/v1/plan?speed_deg_s=20").json();
    let warning = plan["warning"].as_str().unwrap();
    assert!(warning.contains("scan lines coincide"), "{warning}");
    assert_eq!(rig.get("/api/v1/plan?speed_deg_s=1").status, 200);
}

#[test]
fn homing_before_a_scan_is_planned_and_reported() {
    let rig = Rig::new();
    rig.ready();
    let plan = || rig.get("/api/v1/plan?speed_deg_s=56.25").json();
    assert_eq!(
        plan()["homing_s"],
        json!(null),
        "the angle of the axis is unknown"
    );
    for (path, body) in [
        ("home", json!({})),
        ("goto", json!({"to_deg": -30.0, "speed_deg_s": 50.0})),
    ] {
        let moved = rig.post(&format!("/api/v1/tilt/{path}"), &body);
        assert_eq!(moved.status, 200, "{}", moved.text());
    }
    // 31 deg to the switch and one back at 10 deg/s, and 0.62 s of checks.
    let homing_s = plan()["homing_s"].as_f64().unwrap();
    assert!((homing_s - 3.82).abs() < 0.01, "{homing_s}");
    let answer = rig.post("/api/v1/captures", &json!({"speed_deg_s": 56.25}));
    assert_eq!(answer.status, 201, "{}", answer.text());
    // Status reports angles while the axis homes.
    let mut seen: Vec<f64> = Vec::new();
    super::rig::wait("the sweep", || {
        let status = rig.status();
        let (activity, drive) = (&status["activity"], &status["drive"]);
        if activity["homes"] == true
            && let Some(angle) = drive["angle_deg"].as_f64()
        {
            seen.push(angle);
        }
        (activity["step"].as_u64() > Some(0) || activity["doing"] == "idle").then_some(())
    });
    rig.post("/api/v1/captures/stop", &json!({}));
    rig.finished(answer.json()["id"].as_str().unwrap());
    let ways = |from: f64, to: f64| seen.iter().any(|angle| (from..to).contains(angle));
    assert!(ways(-28.0, -20.0) && ways(-15.0, -5.0), "{seen:?}");
}

#[test]
fn the_axis_is_moved_by_single_commands() {
    let rig = Rig::new();
    rig.ready();
    let home = rig.post("/api/v1/tilt/home", &json!({}));
    assert_eq!(home.status, 200, "{}", home.text());
    assert_eq!(home.json()["referenced"], true);
    let there = rig.post(
        "/api/v1/tilt/goto",
        &json!({"to_deg": -5.0, "speed_deg_s": 50.0}),
    );
    assert_eq!(there.status, 200, "{}", there.text());
    let angle = rig.get("/api/v1/tilt").json()["angle_deg"]
        .as_f64()
        .unwrap();
    assert!((angle + 5.0).abs() < 0.01, "{angle}");
    let stopped = rig.post("/api/v1/tilt/stop", &json!({}));
    assert_eq!(stopped.status, 200, "{}", stopped.text());
    assert_eq!(rig.post("/api/v1/tilt/clear", &json!({})).status, 200);
    assert_eq!(rig.status()["simulated"], true);
}

#[test]
fn only_one_motion_runs_at_a_time_and_a_stop_takes_over() {
    let rig = Rig::new();
    rig.ready();
    let address = rig.address;
    let long = std::thread::spawn(move || post(address, "/api/v1/tilt/home", &json!({})));
    super::rig::wait("homing", || {
        (rig.status()["activity"]["doing"] == "homing").then_some(())
    });
    assert_eq!(rig.get("/health").status, 503);
    let busy = rig.post("/api/v1/captures", &json!({"speed_deg_s": 10.0}));
    assert!(busy.head.contains("\nretry-after: 5"), "{}", busy.head);
    assert_eq!(busy.refused(409, "busy")["kind"], "busy");
    rig.post("/api/v1/tilt/goto", &json!({"to_deg": -5.0}))
        .refused(409, "busy");
    assert_eq!(rig.post("/api/v1/tilt/stop", &json!({})).status, 200);
    assert_eq!(rig.status()["activity"]["doing"], "idle");
    let answer = long.join().unwrap();
    assert_eq!(answer.refused(409, "stopped")["kind"], "interrupted");
}

/// The network may delay a request beyond the stop of its motion.
#[test]
fn a_motion_that_was_asked_for_before_a_stop_is_refused() {
    let rig = Rig::new();
    rig.ready();
    let known = rig.status()["stops"].as_u64().unwrap();
    assert_eq!(known, 0);
    let stopped = rig.post("/api/v1/tilt/stop", &json!({}));
    assert!(
        stopped.head.contains("\nvelomotion-stops: 1"),
        "{}",
        stopped.head
    );
    assert_eq!(rig.status()["stops"], 1);
    let late = |path: &str, stops: &str, body: &Value| {
        let headers = format!("content-type: application/json\r\nvelomotion-stops: {stops}\r\n");
        request(rig.address, "POST", path, &headers, &body.to_string())
    };
    let goto = json!({"to_deg": -5.0});
    for (path, body) in [
        ("/api/v1/tilt/home", &json!({})),
        ("/api/v1/tilt/goto", &goto),
        ("/api/v1/captures", &json!({"speed_deg_s": 40.0})),
    ] {
        let refused = late(path, "0", body).refused(409, "stopped before");
        assert_eq!(refused["kind"], "interrupted", "{refused}");
    }
    assert_eq!(rig.get("/api/v1/scans").json()["scans"], json!([]));
    late("/api/v1/tilt/goto", "many", &goto).refused(400, "velomotion-stops");
    // A stop of captures alone is none of the axis.
    assert_eq!(rig.post("/api/v1/captures/stop", &json!({})).status, 200);
    assert_eq!(late("/api/v1/tilt/home", "1", &json!({})).status, 200);
    assert_eq!(late("/api/v1/tilt/goto", "1", &goto).status, 200);
}

#[test]
fn prometheus_metrics_and_the_page_are_served() {
    let rig = Rig::new();
    rig.ready();
    let metrics = rig.get("/metrics");
    assert_eq!(metrics.status, 200);
    let text = metrics.text();
    for line in [
        "velomotion_drive_connected 1",
        "velomotion_lidar_connected 1",
        "velomotion_captures_total 0",
        "# EOF",
    ] {
        assert!(text.contains(line), "no {line} in\n{text}");
    }
    let page = rig.get("/");
    assert!(page.text().contains("<!doctype html>"));
    assert!(page.head.to_lowercase().contains("content-security-policy"));
    page_is_sent_once_and_packed(&rig);
    let described = rig.get("/api/v1/openapi.json").json();
    assert_eq!(described["openapi"], "3.1.0");
    // The schema describes every key of the answer.
    let status = rig.status();
    let wanted = &described["components"]["schemas"]["ServiceStatus"]["properties"];
    for part in ["activity", "drive", "lidar", "axis", "disk", "clients"] {
        let keys =
            |value: &Value| -> Vec<String> { value.as_object().unwrap().keys().cloned().collect() };
        let name = wanted[part]["$ref"].as_str().unwrap();
        let described = described.pointer(name.trim_start_matches('#')).unwrap();
        assert_eq!(
            keys(&status[part]),
            keys(&described["properties"]),
            "{part}"
        );
    }
}

/// A browser keeps the script, and asks whether it has changed.
fn page_is_sent_once_and_packed(rig: &Rig) {
    let get = |headers: &str| request(rig.address, "GET", "/page.js", headers, "");
    let (plain, packed) = (get(""), get("accept-encoding: br, gzip\r\n"));
    assert!(
        packed.head.contains("content-encoding: gzip"),
        "{}",
        packed.head
    );
    assert!(packed.body.starts_with(&[0x1F, 0x8B]));
    assert!(packed.body.len() < plain.body.len() / 2);
    for (answer, accepted) in [(&plain, ""), (&packed, "accept-encoding: gzip\r\n")] {
        let tag = answer
            .head
            .lines()
            .find_map(|line| line.strip_prefix("etag: "));
        let again = get(&format!("{accepted}if-none-match: {}\r\n", tag.unwrap()));
        assert_eq!((again.status, again.body.len()), (304, 0));
    }
    assert_eq!(get("if-none-match: \"older\"\r\n").status, 200);
}

#[test]
fn monitors_read_health_and_metrics_in_the_format_they_accept() {
    let rig = Rig::new();
    rig.ready();
    let health = rig.get("/health");
    let expected = json!({"live": true, "ready": true, "drive": "connected", "lidar": "connected"});
    assert_eq!((health.status, health.json()), (200, expected));
    let open = rig.get("/metrics").text();
    for line in [
        "velomotion_build_info{version=",
        "commit=\"",
        "process_start_time_seconds ",
        "process_cpu_seconds_total ",
        "process_resident_memory_bytes ",
        "process_open_fds ",
        "# EOF",
    ] {
        assert!(open.contains(line), "no {line} in {open}");
    }
    let plain = request(rig.address, "GET", "/metrics", "accept: text/plain\r\n", "");
    assert!(plain.head.contains("version=0.0.4"), "{}", plain.head);
    let text = plain.text();
    assert!(
        text.contains("# TYPE velomotion_requests_total counter\n"),
        "{text}"
    );
    assert!(
        !text.contains("# EOF") && !text.contains(" info\n"),
        "{text}"
    );
    let absent = Rig::with("", |options| {
        options.config = toml::from_str(&format!(
            "[device]\ndefault = 'bench'\n[device.bench]\nkind = 'usb'\nport = '/dev/nothing-here'\n[daemon]\nscans = '{}'",
            options.config.daemon.scans.as_ref().unwrap().display()
        ))
        .unwrap();
    });
    let health = absent.get("/health");
    assert_eq!(
        (health.status, &health.json()["ready"]),
        (503, &json!(false))
    );
    assert!(health.head.contains("\nretry-after: 5"), "{}", health.head);
}

#[test]
fn scans_are_listed_in_parts() {
    let rig = Rig::with("", |options| {
        let scans = options.config.daemon.scans.clone().unwrap();
        for name in ["a", "b", "c"] {
            std::fs::create_dir_all(scans.join(name)).unwrap();
            std::fs::write(scans.join(name).join("scan.json"), "no record").unwrap();
        }
    });
    let ids = |query: &str| -> Vec<String> {
        let list = rig.get(&format!("/api/v1/scans{query}")).json();
        let scans = list["scans"].as_array().unwrap().iter();
        scans
            .map(|scan| scan["id"].as_str().unwrap().to_owned())
            .collect()
    };
    let all = ids("");
    assert_eq!(all.len(), 3);
    assert_eq!(ids("?limit=2"), all[..2]);
    assert_eq!(ids(&format!("?before={}", all[0])), all[1..]);
    assert_eq!(ids(&format!("?limit=1&before={}", all[1])), all[2..]);
    rig.get("/api/v1/scans?before=nothing")
        .refused(404, "unknown");
    rig.get("/api/v1/scans?limit=-1").refused(400, "negative");
}
