//! Routers that start late, disappear, return or block.

use cloud::messages::Topic;
use serde_json::{Value, json};

use crate::peer::{Peer, alone, connected, daemon, endpoint, figure, python};
use crate::rig::{finished, sweep, wait};

const MOUNT: &str = "0/tf_static";

/// The single message of the mount that `who` received.
fn mount(peer: &Peer, who: &str) -> Value {
    let received = wait("the mount", || {
        let received = peer.received(who, "/tf_static");
        (!received.is_empty()).then_some(received)
    });
    assert_eq!(received.len(), 1, "{received:?}");
    received[0].clone()
}

/// The mount is sent once. Early subscribers, late subscribers and those at another router each get
/// it once.
#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn a_router_that_starts_late_or_restarts_gets_everything() {
    let _alone = alone();
    let python = python();
    let place = endpoint();
    let rig = daemon(&place, "");
    rig.ready();
    connected(&rig, false);

    let mut router = Peer::start(&python, "router", &place);
    router.subscribe("before", Topic::StaticTransforms, MOUNT);
    connected(&rig, true);
    let before = mount(&router, "before");
    router.subscribe("later", Topic::StaticTransforms, MOUNT);
    let later = mount(&router, "later");
    for key in ["printed", "number", "gid", "sent_ns"] {
        assert_eq!(before[key], later[key], "{key}");
    }
    let transforms = &before["printed"]["transforms"];
    let of = |number: usize| {
        let one = &transforms[number];
        (one["parent"].as_str(), one["child"].as_str())
    };
    assert_eq!(of(0), (Some("base_link"), Some("tilt_base")));
    assert_eq!(of(1), (Some("tilt_platform"), Some("lidar")));
    assert_eq!(transforms[1]["translation"], json!([0.0, 0.0, 0.06]));
    assert_eq!(of(2), (Some("lidar"), Some("lidar_ros")));
    let tokens = wait("all tokens", || {
        let tokens = router.tokens();
        // A node, seven publishers, seven services.
        (tokens.len() == 15).then_some(tokens)
    });

    drop(router);
    connected(&rig, false);
    let mut router = Peer::start(&python, "router", &place);
    connected(&rig, true);
    let mut again = wait("all tokens again", || {
        let tokens = router.tokens();
        (tokens.len() == 15).then_some(tokens)
    });
    let mut tokens = tokens;
    tokens.sort();
    again.sort();
    assert_eq!(tokens, again);
    router.subscribe("again", Topic::StaticTransforms, MOUNT);
    assert_eq!(mount(&router, "again")["printed"], before["printed"]);
}

/// A capture does not wait for a blocked router. Once the router reads again it gets new messages.
#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn a_stalled_router_does_not_affect_the_capture() {
    let _alone = alone();
    let python = python();
    let place = endpoint();
    let mut router = Peer::start(&python, "router", &place);
    router.subscribe("a", Topic::LivePoints, "0/velomotion/live_points");
    router.subscribe("a", Topic::Diagnostics, "0/diagnostics");
    let rig = daemon(&place, "");
    connected(&rig, true);
    let received = |router: &Peer| router.received("a", "/diagnostics").len();
    wait("diagnostics", || (received(&router) > 0).then_some(()));

    let id = sweep(rig.address);
    router.signal("-STOP");
    let scan = finished(rig.address, &id);
    assert_eq!(scan["state"], "whole", "{scan}");
    assert_eq!(scan["lost_records"], 0, "{scan}");
    router.signal("-CONT");

    connected(&rig, true);
    let before = received(&router);
    wait("new diagnostics", || {
        (received(&router) > before + 2).then_some(())
    });
    let frames = router.received("a", "/velomotion/live_points").len() as u64;
    assert!(frames <= figure(&rig, "ros2_frames"));
}

/// Connecting to a port that does not speak zenoh is retried and disturbs nothing else.
#[test]
fn a_port_that_never_answers_is_retried_without_side_effects() {
    let _alone = alone();
    let silent = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let rig = daemon(&format!("tcp/{}", silent.local_addr().unwrap()), "");
    let scan = rig.ready().whole_scan(&json!({ "speed_deg_s": 56.25 }));
    assert_eq!(scan["lost_records"], 0);
    // One attempt was made.
    drop(silent.accept().unwrap());
    for name in ["ros2_connected", "ros2_messages", "ros2_missed"] {
        assert_eq!(figure(&rig, name), 0, "{name}");
    }
}
