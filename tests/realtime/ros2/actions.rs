//! Actions, used as a client of `rcl_action` with rmw_zenoh does. Names, types and hashes are
//! written out: they are those that a workspace with `velomotion_msgs` makes.

use std::time::Duration;

use serde_json::{Value, json};

use crate::peer::{Peer, alone, connected, daemon, endpoint, figure, python};
use crate::rig::{Rig, sweep, sweeps, wait};

const CANCEL: &str = "action_msgs::srv::dds_::CancelGoal_/RIHS01_573d8b0a534451d7bc2ac8c5ffde8ac14b8593b7001175d0cd6516dcbeb8689a";
const STATUS: &str = "action_msgs::msg::dds_::GoalStatusArray_/RIHS01_6c1684b00f177d37438febe6e709fc4e2b0d4248dca4854946f9ed8b30cda83e";
const CAPTURE: Action = Action {
    name: "capture",
    kind: "Capture",
    send_goal: "475c6507cf9cdd9f563b6332059d7a5f1f8e37d5c72cfbaa992895b99f54d996",
    get_result: "ef1823e83a30e59dea5ec023b80480442147a977850043a5e49a1671f3fa00af",
    feedback: "80951e0c6fc67ef64cdb27e956db602d08cadd6d4cee3660b1be39a4b8539d46",
};
const MOVE_TILT: Action = Action {
    name: "move_tilt",
    kind: "MoveTilt",
    send_goal: "143caf737131a8366c841b9cdf3042c1d5834af797fa60f38ab40387a878d975",
    get_result: "9843ee28e218e7f1e635c00e5738d8aca058b82b3c9cf344af0f3c98f9c60955",
    feedback: "9b105b6bf50414b37d59ae43d19778066ee42d991282d9b2b01bec78c617b66b",
};
/// States of a goal (`action_msgs/msg/GoalStatus`).
const UNKNOWN: i64 = 0;
const SUCCEEDED: i64 = 4;
const CANCELED: i64 = 5;
const ABORTED: i64 = 6;

struct Action {
    name: &'static str,
    kind: &'static str,
    send_goal: &'static str,
    get_result: &'static str,
    feedback: &'static str,
}

impl Action {
    fn key(&self, part: &str, kind: &str) -> String {
        format!("0/velomotion/{}/_action/{part}/{kind}", self.name)
    }

    fn own_key(&self, part: &str, kind: &str, hash: &str) -> String {
        let own = format!(
            "velomotion_msgs::action::dds_::{}_{kind}_/RIHS01_{hash}",
            self.kind
        );
        self.key(part, &own)
    }

    fn topic(&self, part: &str) -> String {
        format!("/velomotion/{}/_action/{part}", self.name)
    }

    /// Subscribes to feedback and states.
    fn subscribe(&self, router: &mut Peer) {
        let feedback = self.own_key("feedback", "FeedbackMessage", self.feedback);
        router.request(&json!({ "do": "subscribe", "who": "a", "key": feedback }));
        let status = self.key("status", STATUS);
        router.request(&json!({ "do": "subscribe_latched", "who": "a", "key": status }));
    }

    /// Calls a service, waits for this number of answers, and returns the last one.
    fn ask(
        &self,
        router: &mut Peer,
        key: &str,
        part: &str,
        request: &Value,
        count: usize,
    ) -> Value {
        let kind = format!("velomotion_msgs/msg/{}_{part}", self.kind);
        let command = json!({ "do": "ask", "key": key, "kind": kind, "request": request });
        router.request(&command);
        answers(router, key, count).last().unwrap().clone()
    }

    /// Offers the goal number `id`. Returns the answer.
    fn offer(&self, router: &mut Peer, id: u8, goal: &Value) -> Value {
        let key = self.own_key("send_goal", "SendGoal", self.send_goal);
        let before = received(router, &key).len();
        let request = json!({ "goal_id": { "uuid": uuid(id) }, "goal": goal });
        self.ask(router, &key, "SendGoal", &request, before + 1)
    }

    /// Sends the goal number `id`, which is accepted, and asks for its result.
    fn send(&self, router: &mut Peer, id: u8, goal: &Value) {
        let answer = self.offer(router, id, goal);
        assert_eq!(answer["accepted"], true, "{answer}");
        assert!(
            answer["stamp"]["sec"].as_i64() > Some(1_700_000_000),
            "{answer}"
        );
        let key = self.own_key("get_result", "GetResult", self.get_result);
        let request = json!({ "goal_id": { "uuid": uuid(id) } });
        self.ask(router, &key, "GetResult", &request, 0);
    }

    /// The result number `count` of all goals, from 1: its state and content.
    fn result(&self, router: &Peer, count: usize) -> (i64, Value) {
        let key = self.own_key("get_result", "GetResult", self.get_result);
        let answer = answers(router, &key, count)[count].clone();
        (answer["status"].as_i64().unwrap(), answer["result"].clone())
    }

    /// Cancels a goal, or all with 0. Returns the code.
    fn cancel(&self, router: &mut Peer, id: u8) -> i64 {
        let key = self.key("cancel_goal", CANCEL);
        let before = received(router, &key).len();
        let request = json!({ "goal_info": { "goal_id": { "uuid": uuid(id) } } });
        let answer = self.ask(router, &key, "CancelGoal", &request, before + 1);
        answer["return_code"].as_i64().unwrap()
    }

    /// The last states of all goals.
    fn states(&self, router: &Peer) -> Vec<i64> {
        let messages = router.received("a", &self.topic("status"));
        let last = messages.last().unwrap()["printed"]["status_list"].clone();
        let states = last.as_array().unwrap().iter();
        states
            .map(|goal| goal["status"].as_i64().unwrap())
            .collect()
    }
}

fn uuid(id: u8) -> String {
    format!("{id:02x}").repeat(16)
}

/// Answers of a service so far.
fn received(router: &Peer, key: &str) -> Vec<Value> {
    router.all(|value| (value["answer"] == key).then(|| value["response"].clone()))
}

/// Waits for this number of answers; the first value is a placeholder.
fn answers(router: &Peer, key: &str, count: usize) -> Vec<Value> {
    wait("an answer of an action", || {
        let mut all = received(router, key);
        all.insert(0, Value::Null);
        (all.len() > count).then_some(all)
    })
}

fn started(more: &str) -> (Peer, Rig) {
    let place = endpoint();
    let router = Peer::start(&python(), "router", &place);
    let rig = daemon(&place, more);
    connected(&rig, true);
    rig.ready();
    (router, rig)
}

/// Every switch but that of the actions is on.
#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn without_their_switch_there_are_no_actions() {
    let _alone = alone();
    let (mut router, rig) = started("[daemon.ros2.capture]\nspeed_deg_s = 5.0\n");
    let goals = [
        (&CAPTURE, json!({ "speed_deg_s": [20.0] })),
        (&MOVE_TILT, json!({ "home": true })),
    ];
    for (action, goal) in goals {
        let key = action.own_key("send_goal", "SendGoal", action.send_goal);
        let request = json!({ "goal_id": { "uuid": uuid(1) }, "goal": goal });
        action.ask(&mut router, &key, "SendGoal", &request, 0);
    }
    std::thread::sleep(Duration::from_secs(1));
    for action in [&CAPTURE, &MOVE_TILT] {
        let key = action.own_key("send_goal", "SendGoal", action.send_goal);
        assert!(received(&router, &key).is_empty());
    }
    assert_eq!(rig.status()["activity"]["doing"], "idle");
    assert_eq!(figure(&rig, "captures"), 0);
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn a_capture_goal_reports_its_progress_and_its_scan() {
    let _alone = alone();
    let (mut router, rig) = started("actions = true\n");
    CAPTURE.subscribe(&mut router);
    let goal = json!({ "speed_deg_s": [56.25], "name": ["goal"] });
    CAPTURE.send(&mut router, 1, &goal);
    let (status, result) = CAPTURE.result(&router, 1);
    let state = (status, &result["state"]);
    assert_eq!(state, (SUCCEEDED, &json!("whole")), "{result}");
    let id = result["scan_id"].as_str().unwrap();
    assert!(id.contains("goal"), "{id}");
    let scan = rig.finished(id);
    assert_eq!(scan["points"], result["points"]);
    assert_eq!(scan["asked"]["speed_deg_s"], 56.25);
    assert_eq!(CAPTURE.states(&router), [SUCCEEDED]);
    let feedback = router.received("a", &CAPTURE.topic("feedback"));
    assert!(feedback.len() > 10, "{}", feedback.len());
    let mut lowest: f64 = 0.0;
    for message in &feedback {
        assert_eq!(message["printed"]["goal_id"]["uuid"], uuid(1));
        let progress = &message["printed"]["feedback"];
        let numbers = (progress["step"].as_u64(), progress["steps"].as_u64());
        assert!(numbers.0 <= numbers.1, "{progress}");
        lowest = lowest.min(progress["angle_deg"].as_f64().unwrap());
    }
    assert!((lowest + 45.0).abs() < 1.0, "{lowest} deg");

    // The end of a goal can be asked for later, and it cannot be cancelled any more.
    let key = CAPTURE.own_key("get_result", "GetResult", CAPTURE.get_result);
    for (goal, status) in [(1, SUCCEEDED), (9, UNKNOWN)] {
        let before = received(&router, &key).len();
        let request = json!({ "goal_id": { "uuid": uuid(goal) } });
        let answer = CAPTURE.ask(&mut router, &key, "GetResult", &request, before + 1);
        assert_eq!(answer["status"], status, "{answer}");
    }
    assert_eq!(CAPTURE.cancel(&mut router, 1), 3);
    assert_eq!(CAPTURE.cancel(&mut router, 9), 2);
    assert_eq!(CAPTURE.cancel(&mut router, 0), 1);
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn cancelling_a_capture_stops_the_axis() {
    let _alone = alone();
    let (mut router, rig) = started("actions = true\n");
    CAPTURE.subscribe(&mut router);
    CAPTURE.send(&mut router, 1, &json!({ "speed_deg_s": [5.0] }));
    assert!(sweeps(rig.address), "no sweep");
    CAPTURE.send(&mut router, 2, &json!({ "speed_deg_s": [5.0] }));
    let (status, result) = CAPTURE.result(&router, 1);
    assert_eq!(status, ABORTED);
    // As a client of HTTP is refused.
    let refused = rig.post("/api/v1/captures", &json!({ "speed_deg_s": 5.0 }));
    let refused = refused.refused(409, "a second capture");
    let message = result["message"].as_str().unwrap();
    assert!(
        message.starts_with(refused["message"].as_str().unwrap()),
        "{message}"
    );

    // One call waits already; seven more do, and the others are refused.
    let key = CAPTURE.own_key("get_result", "GetResult", CAPTURE.get_result);
    let request = json!({ "goal_id": { "uuid": uuid(1) } });
    for call in 0..9 {
        let answered = if call < 7 { 1 } else { call - 5 };
        CAPTURE.ask(&mut router, &key, "GetResult", &request, answered);
    }
    assert_eq!(CAPTURE.cancel(&mut router, 1), 0);
    for answer in &answers(&router, &key, 11)[2..] {
        let status = answer["status"].as_i64().unwrap();
        let message = answer["result"]["message"].as_str().unwrap();
        match status {
            CANCELED => assert_eq!(answer["result"]["state"], "partial", "{answer}"),
            _ => assert!(
                status == UNKNOWN && message.contains("too many"),
                "{answer}"
            ),
        }
    }
    let canceled = |answer: &&Value| answer["status"] == CANCELED;
    assert_eq!(received(&router, &key).iter().filter(canceled).count(), 8);
    assert_eq!(rig.status()["activity"]["doing"], "idle");
    assert_eq!(CAPTURE.states(&router), [CANCELED, ABORTED]);
}

/// A capture of a client of HTTP goes on while goals are cancelled.
#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn a_cancellation_stops_no_motion_of_other_clients() {
    let _alone = alone();
    let (mut router, rig) = started("actions = true\n");
    let id = sweep(rig.address);
    MOVE_TILT.send(&mut router, 1, &json!({ "to_deg": [-20.0] }));
    assert_eq!(MOVE_TILT.result(&router, 1).0, ABORTED);
    for goal in [0, 1, 2] {
        MOVE_TILT.cancel(&mut router, goal);
        CAPTURE.cancel(&mut router, goal);
    }
    assert!(sweeps(rig.address), "the capture was stopped");
    rig.post("/api/v1/captures/stop", &json!({}));
    assert_eq!(rig.finished(&id)["state"], "partial");
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn the_axis_moves_within_its_limits_and_stops_when_a_move_is_cancelled() {
    let _alone = alone();
    let (mut router, rig) = started("actions = true\n");
    MOVE_TILT.subscribe(&mut router);
    let captures = [
        json!({}),
        json!({ "speed_deg_s": ["nan"] }),
        json!({ "speed_deg_s": [-5.0] }),
        json!({ "speed_deg_s": [1e300] }),
        json!({ "speed_deg_s": [20.0], "to_deg": [-500.0] }),
        json!({ "speed_deg_s": [20.0], "from_deg": ["inf"] }),
        json!({ "speed_deg_s": [20.0], "accel_deg_s2": [1e9] }),
        json!({ "speed_deg_s": [20.0], "sweeps": [4_000_000_000_u32] }),
        json!({ "speed_deg_s": [20.0], "tolerance": ["?"] }),
        json!({ "speed_deg_s": [20.0], "name": ["../hall"] }),
        json!({ "speed_deg_s": [20.0], "name": ["n".repeat(100_000)] }),
    ];
    let moves = [
        json!({}),
        json!({ "home": true, "to_deg": [0.0] }),
        json!({ "to_deg": [500.0] }),
        json!({ "to_deg": ["nan"] }),
        json!({ "to_deg": [-20.0], "speed_deg_s": [1e6] }),
        json!({ "to_deg": [-20.0], "speed_deg_s": [0.0] }),
    ];
    let captures = captures.iter().map(|goal| (&CAPTURE, goal));
    for (action, goal) in captures.chain(moves.iter().map(|goal| (&MOVE_TILT, goal))) {
        let answer = action.offer(&mut router, 99, goal);
        assert_eq!(answer["accepted"], false, "{goal}");
        assert_eq!(rig.status()["activity"]["doing"], "idle", "{goal}");
    }
    assert_eq!(figure(&rig, "captures"), 0);

    let goals = [
        (json!({ "home": true }), 0.0),
        (json!({ "to_deg": [-20.0], "speed_deg_s": [40.0] }), -20.0),
    ];
    for (number, (goal, angle)) in goals.iter().enumerate() {
        MOVE_TILT.send(&mut router, 1 + number as u8, goal);
        let (status, result) = MOVE_TILT.result(&router, number + 1);
        assert_eq!(status, SUCCEEDED, "{goal}: {result}");
        let at = result["angle_deg"].as_f64().unwrap();
        assert!((at - angle).abs() < 0.1, "{goal}: {result}");
    }
    let slow = json!({ "to_deg": [-45.0], "speed_deg_s": [2.0] });
    MOVE_TILT.send(&mut router, 3, &slow);
    wait("feedback of the slow move", || {
        let feedback = router.received("a", &MOVE_TILT.topic("feedback"));
        (feedback.last()?["printed"]["goal_id"]["uuid"] == uuid(3)).then_some(())
    });
    assert_eq!(MOVE_TILT.cancel(&mut router, 0), 0);
    let (status, result) = MOVE_TILT.result(&router, 3);
    assert_eq!(status, CANCELED, "{result}");
    let axis = rig.get("/api/v1/tilt").json();
    let angle = axis["angle_deg"].as_f64().unwrap();
    assert!((-44.0..-19.0).contains(&angle), "{axis}");
    assert_eq!(MOVE_TILT.states(&router), [SUCCEEDED, SUCCEEDED, CANCELED]);
}
