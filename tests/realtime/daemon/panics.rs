//! Defects of the daemon: a panic in the device thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use engine::failure::Kind;
use engine::service::status::AxisTask;
use serde_json::json;

use super::rig::{Rig, sweep, wait};

/// A daemon whose device thread panics once, at its next heartbeat during the task `when` after the
/// flag is set.
fn panicking_daemon(when: AxisTask) -> (Rig, Arc<AtomicBool>) {
    let defect = Arc::new(AtomicBool::new(false));
    let set = Arc::clone(&defect);
    let rig = Rig::with("", move |options| {
        options.environment.heartbeat = Arc::new(move |doing| {
            if doing == when && set.swap(false, Ordering::AcqRel) {
                panic!("a defect injected by a test");
            }
        });
    });
    (rig, defect)
}

#[test]
fn a_panic_while_the_axis_moves_stops_it_and_the_daemon_continues() {
    let (rig, defect) = panicking_daemon(AxisTask::Capturing);
    let id = sweep(rig.address);
    defect.store(true, Ordering::Release);
    let scan = rig.finished(&id);
    let why = scan["why"].to_string();
    assert!(why.contains("an internal error ended the motion"), "{scan}");
    assert_eq!(scan["state"], "partial", "{scan}");
    assert!(scan["points"].as_u64().unwrap() > 0, "{scan}");
    // The axis was stopped early in the sweep.
    rig.ready();
    let angle = || {
        let tilt = rig.get("/api/v1/tilt").json();
        assert_eq!(tilt["velocity_rpm"], 0, "{tilt}");
        assert_eq!(tilt["state"], "switch-on disabled", "{tilt}");
        tilt["position_qc"].as_i64().unwrap()
    };
    let there = angle();
    // 0.0015 deg per quadcount, from 0 to -45 deg.
    assert!((-29_000..0).contains(&there), "{there} qc");
    assert_eq!(angle(), there);
    // The daemon works as before.
    rig.whole_scan(&json!({"speed_deg_s": 56.25}));
}

#[test]
fn the_daemon_exits_with_an_error_when_the_device_thread_ends() {
    let (mut rig, defect) = panicking_daemon(AxisTask::Idle);
    rig.ready();
    defect.store(true, Ordering::Release);
    wait("the end of the device thread", || {
        rig.daemon().is_broken().then_some(())
    });
    // `velomotion daemon` checks the thread ten times per second and ends; its service manager
    // restarts it.
    let failure = rig.daemon.take().unwrap().stop(|| true).unwrap_err();
    assert_eq!(failure.kind, Kind::DeviceFault);
    assert!(failure.message.contains("panicked"), "{failure:?}");
}
