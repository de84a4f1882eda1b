//! Defects of the daemon itself: a panic in the thread that has the drive.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use engine::failure::Kind;
use engine::service::status::AxisTask;
use serde_json::json;

use crate::rig::{Rig, sweep, wait};

/// A daemon whose keeper panics once, the next time that it shows that it is alive while it does
/// `when`, after the flag is set.
fn fragile(when: AxisTask) -> (Rig, Arc<AtomicBool>) {
    let defect = Arc::new(AtomicBool::new(false));
    let set = Arc::clone(&defect);
    let rig = Rig::with("", move |options| {
        options.environment.heartbeat = Arc::new(move |doing| {
            if doing == when && set.swap(false, Ordering::AcqRel) {
                panic!("a defect, made up by a test");
            }
        });
    });
    (rig, defect)
}

#[test]
fn a_panic_while_the_axis_moves_stops_it_and_the_daemon_goes_on() {
    let (rig, defect) = fragile(AxisTask::Capturing);
    let mut attempt = 0;
    let scan = loop {
        let id = sweep(rig.address);
        defect.store(true, Ordering::Release);
        let scan = rig.finished(&id);
        if scan["why"].to_string().contains("a defect of the program") {
            break scan;
        }
        // A drive that was silent while the machine kept it waiting.
        defect.store(false, Ordering::Release);
        attempt += 1;
        assert!(
            attempt < 4 && crate::rig::kept_waiting(&scan["why"].to_string()),
            "{scan}"
        );
    };
    assert_eq!(scan["state"], "partial", "{scan}");
    assert!(scan["points"].as_u64().unwrap() > 0, "{scan}");
    // The sweep had most of its way before it: the axis was stopped there.
    rig.ready();
    let angle = || {
        let tilt = rig.get("/api/v1/tilt").json();
        assert_eq!(tilt["velocity_rpm"], 0, "{tilt}");
        assert_eq!(tilt["state"], "switch-on disabled", "{tilt}");
        tilt["position_qc"].as_i64().unwrap()
    };
    let there = angle();
    // 0.0015 deg a quadcount, from 0 to -45.
    assert!((-29_000..0).contains(&there), "{there} qc");
    assert_eq!(angle(), there);
    // It is as ready as ever.
    rig.whole_scan(&json!({"speed_deg_s": 56.25}));
}

#[test]
fn a_keeper_that_is_gone_ends_the_daemon_with_an_error() {
    let (mut rig, defect) = fragile(AxisTask::Idle);
    rig.ready();
    defect.store(true, Ordering::Release);
    wait("the keeper's end", || {
        rig.daemon().is_broken().then_some(())
    });
    // `velomotion daemon` looks at that ten times a second, ends, and its service manager starts it
    // again.
    let failure = rig.daemon.take().unwrap().stop(|| true).unwrap_err();
    assert_eq!(failure.kind, Kind::DeviceFault);
    assert!(failure.message.contains("panicked"), "{failure:?}");
}
