//! The names of `zenoh-bridge-ros2dds`; `tests/foreign/dds` has the bridge itself.

use cloud::messages::Topic;
use serde_json::json;

use crate::calls::call_key;
use crate::peer::{Peer, alone, connected, daemon, endpoint, python};
use crate::rig::wait;

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn topics_services_and_actions_have_the_names_of_the_bridge_to_dds() {
    let _alone = alone();
    let place = endpoint();
    let mut router = Peer::start(&python(), "router", &place);
    let rig = daemon(
        &place,
        "dds = true\nnamespace = '/left'\nactions = true\ncapture.speed_deg_s = 56.25\n",
    );
    connected(&rig, true);
    rig.ready();
    let tokens = wait("all tokens", || {
        let tokens = router.tokens();
        // The bridge, seven publishers, two services and six of parameters, two actions.
        (tokens.len() == 18).then_some(tokens)
    });
    let begin = tokens.iter().min_by_key(|token| token.len()).unwrap();
    let hash = Topic::Points.message_type().hash;
    for expected in [
        "SS/left§velomotion§start_capture/std_srvs§srv§Trigger".to_owned(),
        "SS/left§velomotion§set_parameters/rcl_interfaces§srv§SetParameters".to_owned(),
        "AS/left§velomotion§move_tilt/velomotion_msgs§action§MoveTilt".to_owned(),
        format!("MP/left§velomotion§points/sensor_msgs§msg§PointCloud2/:1:0:0,10:typehash={hash};"),
    ] {
        let token = format!("{begin}/{expected}");
        assert!(tokens.contains(&token), "{token}: {tokens:#?}");
    }

    for (topic, name, how) in [
        (Topic::StaticTransforms, "tf_static", "subscribe_latched"),
        (Topic::Points, "left/velomotion/points", "subscribe"),
    ] {
        let kind = topic.message_type().name;
        router.request(&json!({ "do": how, "who": "bridge", "key": name, "kind": kind }));
    }
    let (done, id) = call_key(&mut router, "left/velomotion/start_capture", "dds");
    assert!(done, "{id}");
    assert_eq!(rig.finished(&id)["state"], "whole");
    let cloud = wait("the cloud", || {
        router.received("bridge", "/left/velomotion/points").pop()
    });
    assert!(
        cloud["printed"]["points"].as_u64().unwrap() > 100_000,
        "{cloud}"
    );
    assert_eq!(router.received("bridge", "/tf_static").len(), 1);
}
