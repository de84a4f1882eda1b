//! A disk that does not answer for seconds, as while it wakes up or fails.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use serde_json::json;

use super::rig::{Rig, post, request, wait};

/// Releases the disk when dropped.
struct Stalled(Arc<AtomicBool>);

impl Drop for Stalled {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Release);
    }
}

#[test]
fn a_stalled_disk_does_not_delay_a_stop() {
    let stalls = Arc::new(AtomicBool::new(false));
    let waiting = Arc::new(AtomicBool::new(false));
    let (disk, waits) = (Arc::clone(&stalls), Arc::clone(&waiting));
    let rig = Rig::with("", |options| {
        options.free_bytes = Arc::new(move |_| {
            while disk.load(Ordering::Acquire) {
                waits.store(true, Ordering::Release);
                std::thread::sleep(Duration::from_millis(1));
            }
            Ok(u64::MAX)
        });
    });
    rig.ready();
    assert_eq!(rig.post("/api/v1/tilt/home", &json!({})).status, 200);
    let address = rig.address;
    let moving = std::thread::spawn(move || {
        let to = json!({"to_deg": -45.0, "speed_deg_s": 2.0});
        post(address, "/api/v1/tilt/goto", &to)
    });
    wait("a move", || {
        let angle = rig.status()["drive"]["angle_deg"].as_f64()?;
        (angle < -0.5).then_some(())
    });
    stalls.store(true, Ordering::Release);
    let stalled = Stalled(stalls);
    // The disk's watcher and several requests for scans block.
    let wanting: Vec<_> = (0..3)
        .map(|_| {
            let request = json!({"speed_deg_s": 10.0});
            std::thread::spawn(move || post(address, "/api/v1/captures", &request))
        })
        .collect();
    wait("a request at the disk", || {
        waiting.load(Ordering::Acquire).then_some(())
    });
    for path in ["/api/v1/status", "/metrics"] {
        assert_eq!(request(address, "GET", path, "", "").status, 200, "{path}");
    }
    let stopped = rig.post("/api/v1/tilt/stop", &json!({}));
    assert_eq!(stopped.status, 200, "{}", stopped.text());
    assert!(stopped.json()["angle_deg"].as_f64().unwrap() > -44.0);
    assert_eq!(moving.join().unwrap().status, 409);
    drop(stalled);
    for wanting in wanting {
        let answer = wanting.join().unwrap();
        assert!([201, 409].contains(&answer.status), "{}", answer.text());
        if answer.status == 201 {
            rig.finished(answer.json()["id"].as_str().unwrap());
        }
    }
}
