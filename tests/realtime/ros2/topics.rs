//! Messages equal the daemon's data to the byte, in the form that a ROS 2 node takes.

use std::collections::BTreeMap;
use std::net::TcpStream;
use std::time::Duration;

use cloud::messages::Topic;
use io::recording::Recording;
use protocol::record::Wire;
use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};
use xxhash_rust::xxh3::xxh3_128;

use crate::peer::{Peer, alone, connected, daemon, endpoint, figure, python};
use crate::rig::{Rig, wait};

/// Topics and the names of their keys. Diagnostics are last: a subscriber that has them has all
/// others.
const TOPICS: [(Topic, &str); 6] = [
    (Topic::Points, "0/left/velomotion/points"),
    (Topic::LivePoints, "0/left/velomotion/live_points"),
    (Topic::LidarPackets, "0/left/velomotion/velodyne_packets"),
    (Topic::JointStates, "0/left/joint_states"),
    (Topic::Transforms, "0/tf"),
    (Topic::Diagnostics, "0/diagnostics"),
];

fn listen(rig: &Rig) -> WebSocket<TcpStream> {
    let stream = TcpStream::connect(rig.address).unwrap();
    let limit = Some(Duration::from_secs(60));
    stream.set_read_timeout(limit).unwrap();
    let url = format!("ws://{}/api/v1/events", rig.address);
    tungstenite::client(url, stream).unwrap().0
}

/// Number of points that a WebSocket receives until the end of the scan.
fn points_of(mut socket: WebSocket<TcpStream>) -> u64 {
    let mut points = 0;
    loop {
        match socket.read().unwrap() {
            Message::Binary(bytes) => {
                assert_eq!(bytes[20..24], [0; 4], "the live view omitted records");
                points += u64::from(u32::from_le_bytes(bytes[4..8].try_into().unwrap()));
            }
            Message::Text(text) => {
                let event: Value = serde_json::from_str(&text).unwrap();
                let state = event["scan"]["state"].as_str();
                if matches!(state, Some("whole" | "partial" | "failed")) {
                    return points;
                }
            }
            _ => {}
        }
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn numbers(received: &[Value]) -> Vec<i64> {
    received
        .iter()
        .map(|one| one["number"].as_i64().unwrap())
        .collect()
}

fn sum_of_points(received: &[Value]) -> u64 {
    received
        .iter()
        .map(|one| one["printed"]["points"].as_u64().unwrap())
        .sum()
}

fn stamps(received: &[Value]) -> Vec<i64> {
    let stamp = |one: &Value| one["printed"]["stamp_ns"].as_i64();
    received.iter().map(|one| stamp(one).unwrap()).collect()
}

/// Two subscribers, one at the router and one behind it, and eight WebSockets.
#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn every_client_receives_the_whole_sweep_and_the_capture_loses_nothing() {
    let _alone = alone();
    let python = python();
    let place = endpoint();
    let mut near = Peer::start(&python, "router", &place);
    let mut far = Peer::start(&python, "client", &place);
    for (topic, name) in TOPICS {
        near.subscribe("near", topic, name);
        far.subscribe("far", topic, name);
    }
    let rig = daemon(&place, "namespace = '/left'\nframe_prefix = 'left/'\n");
    connected(&rig, true);
    for peer in [(&near, "near"), (&far, "far")] {
        wait("diagnostics", || {
            (!peer.0.received(peer.1, "/diagnostics").is_empty()).then_some(())
        });
    }
    rig.ready();
    let sockets: Vec<_> = (0..8)
        .map(|_| {
            let socket = listen(&rig);
            std::thread::spawn(move || points_of(socket))
        })
        .collect();
    wait("all eight", || {
        (rig.daemon().state().events().clients() == 8).then_some(())
    });
    let scan = rig.scan(&json!({ "speed_deg_s": 56.25 }));
    let live: Vec<u64> = sockets.into_iter().map(|s| s.join().unwrap()).collect();
    let live_points = "/left/velomotion/live_points";
    for (peer, who) in [(&near, "near"), (&far, "far")] {
        wait("all live points", || {
            (sum_of_points(&peer.received(who, live_points)) >= live[0]).then_some(())
        });
    }
    assert_eq!(scan["state"], "whole", "{scan}");
    assert_eq!(scan["lost_records"], 0);
    assert_eq!(scan["reception"]["dropped_by_kernel"], 0);
    assert!(live.iter().all(|points| *points == live[0]), "{live:?}");
    let points = scan["points"].as_u64().unwrap();
    for (peer, who) in [(&near, "near"), (&far, "far")] {
        let received = wait("the cloud", || {
            let received = peer.received(who, "/left/velomotion/points");
            (sum_of_points(&received) >= points).then_some(received)
        });
        assert_eq!(sum_of_points(&received), points);
        assert_eq!(figure(&rig, "ros2_clouds"), received.len() as u64);
        let frames = peer.received(who, live_points);
        assert_eq!(sum_of_points(&frames), live[0]);
        assert_eq!(figure(&rig, "ros2_frames"), frames.len() as u64);
        check_clouds(&received, &frames);
        check_motion(peer, who);
        check_attachments(peer, who);
    }
    let id = scan["id"].as_str().unwrap();
    check_bytes(&rig, id, &near);
    check_packets(&rig, id, &[(&near, "near"), (&far, "far")]);
    check_graph(&mut near);
    check_diagnostics(&rig, &near);
    assert_eq!(figure(&rig, "ros2_missed"), 0);
    assert_eq!(rig.status()["clients"]["dropped"], 0);
}

fn check_clouds(clouds: &[Value], frames: &[Value]) {
    for cloud in clouds.iter().chain(frames) {
        let printed = &cloud["printed"];
        assert_eq!(printed["frame"], "left/base_link");
        let fields = json!(["x", "y", "z", "intensity", "ring", "time"]);
        assert_eq!(
            (&printed["fields"], &printed["rings"]),
            (&fields, &json!(16))
        );
        let far = printed["farthest_m"].as_f64().unwrap();
        // A frame of a few milliseconds may see only the nearest wall.
        assert!((1.0..120.0).contains(&far), "{printed}");
        assert_eq!(printed["first_s"], 0.0, "{printed}");
    }
    // The sweep of 45 deg at 56.25 deg/s.
    let last = clouds.last().unwrap();
    let lasts = last["printed"]["last_s"].as_f64().unwrap();
    assert!((0.7..1.5).contains(&lasts), "{lasts}");
    assert!(frames.len() > 5 && stamps(frames).is_sorted());
}

/// Checks that the joint moves from 0 to -45 deg at rising times and that the transform agrees.
fn check_motion(peer: &Peer, who: &str) {
    // The final angle is sent at standstill.
    let joints = wait("the end of the sweep", || {
        let joints = peer.received(who, "/left/joint_states");
        let angle = joints.last()?["printed"]["position"][0].as_f64()?;
        ((angle.to_degrees() + 45.0).abs() < 0.1).then_some(joints)
    });
    let transforms = peer.received(who, "/tf");
    let by_time: BTreeMap<i64, &Value> = transforms
        .iter()
        .map(|one| {
            let transform = &one["printed"]["transforms"][0];
            (transform["stamp_ns"].as_i64().unwrap(), transform)
        })
        .collect();
    assert_eq!(by_time.len(), transforms.len(), "a time was printed twice");
    let times = stamps(&joints);
    assert!(times.is_sorted_by(|a, b| a < b), "{times:?}");
    let mut compared = 0;
    let mut lowest: f64 = 0.0;
    for joint in &joints {
        let printed = &joint["printed"];
        assert_eq!(
            (&printed["name"], &printed["others"]),
            (&json!(["tilt"]), &json!(0))
        );
        let angle = printed["position"][0].as_f64().unwrap();
        lowest = lowest.min(angle.to_degrees());
        let Some(transform) = by_time.get(&printed["stamp_ns"].as_i64().unwrap()) else {
            continue;
        };
        compared += 1;
        assert_eq!(transform["parent"], "left/tilt_base");
        assert_eq!(transform["child"], "left/tilt_platform");
        let (sin, cos) = (angle / 2.0).sin_cos();
        for (value, wanted) in [0.0, sin, 0.0, cos].into_iter().enumerate() {
            let got = transform["rotation"][value].as_f64().unwrap();
            assert!((got - wanted).abs() < 1e-12, "{transform} at {angle}");
        }
    }
    // A subscriber that joined between the two messages of a pair has one more of one kind; the
    // last transform may be on its way.
    assert!(compared + 2 >= joints.len() && compared > 10, "{compared}");
    assert!((lowest + 45.0).abs() < 0.2, "{lowest} deg");
}

/// Checks that numbers rise by one, from 1 where all were received, that times are current, and
/// that the gid is that of the publisher's token.
fn check_attachments(peer: &Peer, who: &str) {
    let tokens = peer.tokens();
    for (_, key) in TOPICS {
        let name = key.strip_prefix('0').unwrap();
        let received = peer.received(who, name);
        let printed = numbers(&received);
        assert!(
            printed.windows(2).all(|w| w[1] == w[0] + 1),
            "{name}: {printed:?}"
        );
        if name.contains("points") {
            assert_eq!(printed[0], 1, "{name}");
        }
        let mangled = format!("/{}/", name.replace('/', "%"));
        let token = tokens
            .iter()
            .find(|token| token.contains("/MP/") && token.contains(&mangled))
            .unwrap_or_else(|| panic!("no token of {name} in {tokens:?}"));
        let gid = hex(&xxh3_128(token.as_bytes()).to_le_bytes());
        let now = io::clock::now().as_nanos();
        for one in &received {
            assert_eq!(one["gid"], gid, "{name}");
            let age = now - one["sent_ns"].as_i64().unwrap();
            assert!((0..600_000_000_000).contains(&age), "{name}: {age} ns");
        }
    }
}

/// Checks that the messages of the last scan equal its recording for `ros2 bag`, apart from frame
/// names.
fn check_bytes(rig: &Rig, id: &str, peer: &Peer) {
    let recording = rig.get(&format!("/api/v1/scans/{id}/cloud?format=mcap"));
    assert_eq!(recording.status, 200, "{}", recording.text());
    let recorded: Vec<Vec<u8>> = mcap::MessageStream::new(&recording.body)
        .unwrap()
        .map(Result::unwrap)
        .filter(|message| message.channel.topic == "/velomotion/points")
        .map(|message| message.data.to_vec())
        .collect();
    let received = numbers(&peer.received("near", "/left/velomotion/points"));
    let last = &received[received.len() - recorded.len()..];
    for (number, recorded) in last.iter().zip(&recorded) {
        let file = peer.folder.path().join(format!("near-{number}.cdr"));
        let sent = std::fs::read(file).unwrap();
        // Encapsulation and stamp, then the frame's name, padded to four bytes: "left/base_link"
        // and "base_link" with their zeros.
        let (sent_head, sent_rest) = sent.split_at(12);
        let (head, rest) = recorded.split_at(12);
        assert_eq!(sent_head, head);
        assert_eq!(sent_rest[4..18], *b"left/base_link");
        assert_eq!(rest[4..13], *b"base_link");
        assert!(sent_rest[20..] == rest[16..], "cloud {number} differs");
    }
    assert!(!recorded.is_empty());
}

/// Checks that every packet of the scan's log was sent with its time, in the order of arrival and
/// one revolution per message.
fn check_packets(rig: &Rig, id: &str, peers: &[(&Peer, &str)]) {
    let mut recording = Recording::open(rig.log(id)).unwrap();
    let mut logged = Vec::new();
    while let Some(record) = recording.next_record().unwrap() {
        if let Wire::Lidar { payload, .. } = record.wire
            && payload.len() == 1206
        {
            logged.push((record.host.as_nanos(), payload.to_vec()));
        }
    }
    for (peer, who) in peers {
        // The revolution in which the scan ended is sent when the next one begins.
        let last = logged.last().unwrap().0;
        let messages = wait("the last packets", || {
            let messages = peer.received(who, "/left/velomotion/velodyne_packets");
            (*stamps(&messages).last()? >= last).then_some(messages)
        });
        let mut sent = Vec::new();
        for (place, message) in messages.iter().enumerate() {
            let printed = &message["printed"];
            let has_begin = place > 0;
            assert_eq!(printed["frame"], "left/lidar_ros");
            assert_eq!(printed["stamp_ns"], printed["last_ns"]);
            assert_eq!(printed["rises"], true, "{printed}");
            // 600 rpm: 76 packets per revolution, each of 4.8 deg.
            if has_begin {
                let packets = printed["packets"].as_u64().unwrap();
                assert!((70..=80).contains(&packets), "{printed}");
                assert!(printed["first_cdeg"].as_u64() < Some(500), "{printed}");
                assert!(printed["last_cdeg"].as_u64() > Some(35_000), "{printed}");
            }
            let number = message["number"].as_i64().unwrap();
            let file = peer
                .folder
                .path()
                .join(format!("{who}-packets-{number}.cdr"));
            sent.extend(packets(&std::fs::read(file).unwrap()));
        }
        let begin = sent.iter().position(|packet| *packet == logged[0]).unwrap();
        assert!(logged.len() > 500, "{}", logged.len());
        assert!(sent[begin..][..logged.len()] == logged, "packets differ");
    }
}

/// Times and contents of the packets of a `VelodyneScan` in the frame `left/lidar_ros`.
fn packets(message: &[u8]) -> Vec<(i64, Vec<u8>)> {
    let u32_at = |at: usize| u32::from_le_bytes(message[at..at + 4].try_into().unwrap());
    // Encapsulation and stamp; the frame's length, its name with the zero, padding.
    assert_eq!(message[16..31], *b"left/lidar_ros\0");
    let packets = u32_at(32) as usize;
    // Seconds, nanoseconds, data, and padding but behind the last one.
    assert_eq!(message.len(), 36 + 1216 * packets - 2);
    let packet = |number: usize| {
        let at = 36 + 1216 * number;
        let time = i64::from(u32_at(at)) * 1_000_000_000 + i64::from(u32_at(at + 4));
        (time, message[at + 8..][..1206].to_vec())
    };
    (0..packets).map(packet).collect()
}

/// Checks the tokens with another implementation of the format.
fn check_graph(peer: &mut Peer) {
    let printed = peer.request(&json!({ "do": "graph", "domain": 0 }));
    let graph = printed.iter().find(|value| value.get("topics").is_some());
    let graph = graph.unwrap();
    let wanted = |kind: &str, quality: (&str, &str, u32)| {
        json!({
            "types": [kind], "node": "/left/velomotion",
            "reliability": quality.0, "durability": quality.1, "depth": quality.2,
        })
    };
    let cloud = "sensor_msgs/msg/PointCloud2";
    let transform = "tf2_msgs/msg/TFMessage";
    let reliable = ("RELIABLE", "VOLATILE", 10);
    assert_eq!(
        graph["topics"],
        json!({
            "/left/velomotion/points": wanted(cloud, reliable),
            "/left/velomotion/live_points": wanted(cloud, ("BEST_EFFORT", "VOLATILE", 5)),
            "/left/velomotion/velodyne_packets":
                wanted("velodyne_msgs/msg/VelodyneScan", reliable),
            "/left/joint_states": wanted("sensor_msgs/msg/JointState", reliable),
            "/tf": wanted(transform, ("RELIABLE", "VOLATILE", 100)),
            "/tf_static": wanted(transform, ("RELIABLE", "TRANSIENT_LOCAL", 1)),
            "/diagnostics": wanted("diagnostic_msgs/msg/DiagnosticArray", reliable),
        })
    );
    let services = json!({
        "/left/velomotion/describe_parameters": ["rcl_interfaces/srv/DescribeParameters"],
        "/left/velomotion/get_parameter_types": ["rcl_interfaces/srv/GetParameterTypes"],
        "/left/velomotion/get_parameters": ["rcl_interfaces/srv/GetParameters"],
        "/left/velomotion/list_parameters": ["rcl_interfaces/srv/ListParameters"],
        "/left/velomotion/set_parameters": ["rcl_interfaces/srv/SetParameters"],
        "/left/velomotion/set_parameters_atomically":
            ["rcl_interfaces/srv/SetParametersAtomically"],
        "/left/velomotion/stop_capture": ["std_srvs/srv/Trigger"],
    });
    assert_eq!(graph["services"], services);
    let tokens = peer.tokens();
    let nodes: Vec<_> = tokens.iter().filter(|t| t.contains("/NN/")).collect();
    assert!(
        nodes.len() == 1 && nodes[0].ends_with("/0/0/NN/%/%left/velomotion"),
        "{nodes:?}"
    );
}

fn check_diagnostics(rig: &Rig, peer: &Peer) {
    let received = peer.received("near", "/diagnostics");
    let last = &received.last().unwrap()["printed"]["status"];
    for part in ["drive", "lidar", "scans", "ros2"] {
        let status = &last[format!("left/velomotion: {part}")];
        assert_eq!(status["level"], 0, "{part}: {status}");
        assert_eq!(status["hardware"], "sim", "{part}");
    }
    let values = &last["left/velomotion: ros2"]["values"];
    let frames = figure(rig, "ros2_frames").to_string();
    assert_eq!(
        (&values["ros2_missed"], &values["ros2_frames"]),
        (&json!("0"), &json!(frames))
    );
}
