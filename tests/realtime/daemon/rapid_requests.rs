//! Clients that send many requests, send them early, or send the wrong shape.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::{Value, json};

use super::rig::{Rig, post, request, wait};

/// A list is not an object: its numbers in order must not start a sweep.
#[test]
fn a_list_instead_of_an_object_is_refused() {
    let rig = Rig::new();
    rig.ready();
    for (path, body) in [
        (
            "/api/v1/captures",
            json!([50, 0, -45, 500, 1, false, null, "list"]),
        ),
        ("/api/v1/tilt/goto", json!([-5, 10, null])),
    ] {
        rig.post(path, &body).refused(400, "expected a JSON object");
    }
    assert_eq!(rig.status()["activity"]["doing"], "idle");
    let scans = rig.get("/api/v1/scans").json();
    assert!(scans["scans"].as_array().unwrap().is_empty(), "{scans}");
}

/// A stop that arrives before the scan has an id stops the scan, one that arrives before it begins
/// prevents it.
#[test]
fn a_stop_just_after_the_start_is_not_lost() {
    let rig = Rig::new();
    let stop = || rig.post("/api/v1/captures/stop", &json!({})).json();
    for turn in 0..8 {
        rig.ready();
        let address = rig.address;
        // 45 s without a stop.
        let answer = std::thread::spawn(move || {
            post(address, "/api/v1/captures", &json!({ "speed_deg_s": 1.0 }))
        });
        let mut stopped = Value::Null;
        if turn % 2 == 0 {
            while stopped["stopped"] != true && !answer.is_finished() {
                stopped = stop();
            }
        } else {
            wait("the capture", || {
                (rig.status()["activity"]["doing"] == "capturing").then_some(())
            });
        }
        if stopped["stopped"] != true {
            stopped = stop();
        }
        let answer = answer.join().unwrap();
        if turn % 2 == 0 && answer.status == 409 {
            assert_eq!(answer.refused(409, "stopped before")["kind"], "interrupted");
            continue;
        }
        assert_eq!(stopped["stopped"], true, "{stopped}");
        assert_eq!(answer.status, 201, "{}", answer.text());
        let id = answer.json()["id"].as_str().unwrap().to_owned();
        assert!(
            stopped["scan"].is_null() || stopped["scan"] == id.as_str(),
            "{stopped}"
        );
        let scan = rig.finished(&id);
        assert_ne!(scan["state"], "whole", "{scan}");
    }
}

/// Frequent reads of the status must not get moves refused.
#[test]
fn status_reads_do_not_get_moves_refused() {
    let rig = Rig::new();
    rig.ready();
    let address = rig.address;
    let over = Arc::new(AtomicBool::new(false));
    let looking: Vec<_> = (0..2)
        .map(|_| {
            let over = Arc::clone(&over);
            std::thread::spawn(move || {
                let mut looks = 0;
                while !over.load(Ordering::Relaxed) {
                    let look = request(address, "GET", "/api/v1/tilt", "", "");
                    looks += usize::from(look.status == 200);
                }
                looks
            })
        })
        .collect();
    for to in [-1.0, 0.0].repeat(6) {
        let moved = rig.post("/api/v1/tilt/goto", &json!({ "to_deg": to }));
        assert_eq!(moved.status, 200, "{}", moved.text());
    }
    over.store(true, Ordering::Relaxed);
    for thread in looking {
        assert!(thread.join().unwrap() > 0);
    }
}
