//! Services, called as `ros2 service call` with rmw_zenoh does.

use cloud::messages::TRIGGER;
use serde_json::{Value, json};

use crate::parameters::{double, set};
use crate::peer::{Peer, alone, connected, daemon, endpoint, figure, python};
use crate::rig::{Rig, sweeps};

fn key(service: &str) -> String {
    let hash = TRIGGER.hash;
    format!("0/velomotion/{service}/std_srvs::srv::dds_::Trigger_/{hash}")
}

/// Calls a service. Returns success and message.
pub fn call(router: &mut Peer, service: &str) -> (bool, String) {
    call_key(router, &key(service), "rmw_zenoh")
}

/// Calls the service with this key.
pub fn call_key(router: &mut Peer, key: &str, attachment: &str) -> (bool, String) {
    let command = json!({ "do": "call", "key": key, "attachment": attachment });
    let printed = router.request(&command);
    let answers: Vec<&Value> = printed
        .iter()
        .filter(|v| v.get("answered").is_some())
        .collect();
    assert_eq!(answers.len(), 1, "{printed:?}");
    let answer = answers[0];
    assert_eq!(
        (&answer["own"], &answer["later"]),
        (&json!(true), &json!(true))
    );
    let message = answer["message"].as_str().unwrap().to_owned();
    (answer["success"] == true, message)
}

/// Starts a capture and waits until the axis sweeps. Returns the scan's id.
fn begin(rig: &Rig, router: &mut Peer) -> String {
    rig.ready();
    let (done, id) = call(router, "start_capture");
    assert!(done, "{id}");
    assert!(sweeps(rig.address), "no sweep");
    id
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn a_capture_is_started_and_stopped_by_service_calls() {
    let _alone = alone();
    let python = python();
    let place = endpoint();
    let mut router = Peer::start(&python, "router", &place);
    let rig = daemon(
        &place,
        "[daemon.ros2.capture]\nspeed_deg_s = 5.0\nname = 'called'\n",
    );
    connected(&rig, true);
    rig.ready();
    let (done, message) = call(&mut router, "stop_capture");
    assert_eq!(
        (done, message.as_str()),
        (true, "nothing was being captured")
    );

    // Without actions nodes have no speeds of their own.
    let speed = double("capture.speed_deg_s", 20.0);
    let (is_set, reason) = set(&mut router, &speed);
    assert!(!is_set && reason.contains("actions = true"), "{reason}");

    let id = begin(&rig, &mut router);
    assert!(id.contains("called"), "{id}");
    let (done, message) = call(&mut router, "start_capture");
    assert!(!done && message.contains("busy"), "{message}");
    let (done, message) = call(&mut router, "stop_capture");
    assert_eq!((done, message), (true, format!("stopped {id}")));
    assert_eq!(rig.status()["activity"]["doing"], "idle");
    let scan = rig.finished(&id);
    assert_eq!(
        (&scan["state"], &scan["asked"]["speed_deg_s"]),
        (&json!("partial"), &json!(5.0))
    );

    // A request that is not rmw_zenoh's moves nothing.
    let command = json!({ "do": "call", "key": key("start_capture"), "attachment": "none" });
    let printed = router.request(&command);
    assert!(
        printed
            .iter()
            .any(|v| v["refused"].to_string().contains("33 bytes")),
        "{printed:?}"
    );
    assert_eq!(rig.status()["activity"]["doing"], "idle");
    assert_eq!(
        rig.get("/api/v1/scans").json()["scans"]
            .as_array()
            .unwrap()
            .len() as u64,
        scans(&rig)
    );
}

/// Number of started scans.
fn scans(rig: &Rig) -> u64 {
    figure(rig, "captures")
}

/// Without a configured capture the service does not exist.
#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn ros_moves_nothing_unless_configured() {
    let _alone = alone();
    let python = python();
    let place = endpoint();
    let mut router = Peer::start(&python, "router", &place);
    let rig = daemon(&place, "");
    connected(&rig, true);
    rig.ready();
    let command = json!({ "do": "call", "key": key("start_capture"), "attachment": "rmw_zenoh" });
    let printed = router.request(&command);
    let answered = printed.iter().any(|v| v.get("answered").is_some());
    assert!(!answered, "{printed:?}");
    assert!(call(&mut router, "stop_capture").0);
    assert_eq!(scans(&rig), 0);
}
