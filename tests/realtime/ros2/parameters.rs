//! Parameters, used as `ros2 param` with rmw_zenoh does. Types and hashes are written out: they are
//! those of `rcl_interfaces` in Jazzy.

use serde_json::{Value, json};

use crate::calls;
use crate::peer::{Peer, alone, connected, daemon, endpoint, figure, python};
use crate::rig::wait;

const DESCRIBE: Service = Service {
    name: "describe_parameters",
    kind: "DescribeParameters",
    hash: "845b484d71eb0673dae682f2e3ba3c4851a65a3dcfb97bddd82c5b57e91e4cff",
};
const GET: Service = Service {
    name: "get_parameters",
    kind: "GetParameters",
    hash: "bf9803d5c74cf989a5de3e0c2e99444599a627c7ff75f97b8c05b01003675cbc",
};
const GET_TYPES: Service = Service {
    name: "get_parameter_types",
    kind: "GetParameterTypes",
    hash: "da199c878688b3e530bdfe3ca8f74cb9fa0c303101e980a9e8f260e25e1c80ca",
};
const LIST: Service = Service {
    name: "list_parameters",
    kind: "ListParameters",
    hash: "3e6062bfbb27bfb8730d4cef2558221f51a11646d78e7bb30a1e83afac3aad9d",
};
const SET: Service = Service {
    name: "set_parameters",
    kind: "SetParameters",
    hash: "56eed9a67e169f9cb6c1f987bc88f868c14a8fc9f743a263bc734c154015d7e0",
};
const SET_ATOMICALLY: Service = Service {
    name: "set_parameters_atomically",
    kind: "SetParametersAtomically",
    hash: "0e192ef259c07fc3c07a13191d27002222e65e00ccec653ca05e856f79285fcd",
};

struct Service {
    name: &'static str,
    kind: &'static str,
    hash: &'static str,
}

impl Service {
    fn kind_and_hash(&self) -> String {
        let (kind, hash) = (self.kind, self.hash);
        format!("rcl_interfaces::srv::dds_::{kind}_/RIHS01_{hash}")
    }

    fn key(&self) -> String {
        format!("0/velomotion/{}/{}", self.name, self.kind_and_hash())
    }

    /// Calls the service, and waits for the answer, which rosbags decodes.
    fn ask(&self, router: &mut Peer, request: &Value) -> Value {
        let key = self.key();
        let answers = |router: &Peer| {
            router.all(|value| (value["answer"] == key).then(|| value["response"].clone()))
        };
        let before = answers(router).len();
        let kind = format!("rcl_interfaces/msg/{}", self.kind);
        router.request(&json!({ "do": "ask", "key": key, "kind": kind, "request": request }));
        wait("an answer about parameters", || {
            answers(router).get(before).cloned()
        })
    }
}

pub fn double(name: &str, value: f64) -> Value {
    json!({ "name": name, "value": { "type": 3, "double_value": value } })
}

/// Sets a parameter. Returns whether it was set, and else the reason.
pub fn set(router: &mut Peer, parameter: &Value) -> (bool, String) {
    let answer = SET.ask(router, &json!({ "parameters": [parameter] }));
    assert_eq!(answer["results"].as_array().unwrap().len(), 1, "{answer}");
    result(&answer["results"][0])
}

fn result(result: &Value) -> (bool, String) {
    let reason = result["reason"].as_str().unwrap().to_owned();
    (result["successful"] == true, reason)
}

fn get(router: &mut Peer, name: &str) -> Value {
    let answer = GET.ask(router, &json!({ "names": [name] }));
    answer["values"][0].clone()
}

#[test]
#[ignore = "needs python3 with the packages of tests/foreign/requirements.txt"]
fn parameters_set_the_next_capture_and_move_nothing() {
    let _alone = alone();
    let place = endpoint();
    let mut router = Peer::start(&python(), "router", &place);
    let rig = daemon(
        &place,
        "frame_prefix = 'left/'\nactions = true\n[daemon.ros2.capture]\nspeed_deg_s = 5.0\n",
    );
    connected(&rig, true);
    rig.ready();
    let tokens = router.tokens();
    for service in [DESCRIBE, GET, GET_TYPES, LIST, SET, SET_ATOMICALLY] {
        let end = format!(
            "/SS/%/%/velomotion/%velomotion%{}/{}/::,1000:,:,:,,",
            service.name,
            service.kind_and_hash()
        );
        assert!(tokens.iter().any(|token| token.ends_with(&end)), "{end}");
    }

    let listed = LIST.ask(&mut router, &json!({}))["result"].clone();
    assert_eq!(listed["prefixes"], json!(["axis", "capture"]));
    let names = listed["names"].clone();
    assert_eq!(names.as_array().unwrap().len(), 13, "{names}");
    let values = GET.ask(&mut router, &json!({ "names": names }))["values"].clone();
    let types = GET_TYPES.ask(&mut router, &json!({ "names": names }))["types"].clone();
    let values = values.as_array().unwrap().iter();
    let codes = values.map(|value| format!("{:02x}", value["type"].as_u64().unwrap()));
    assert_eq!(types, codes.collect::<String>());
    assert_eq!(get(&mut router, "frame_prefix")["string_value"], "left/");
    assert_eq!(get(&mut router, "capture.sweeps")["integer_value"], 1);
    assert_eq!(get(&mut router, "capture.both_ways")["bool_value"], false);
    assert_eq!(get(&mut router, "capture.to_deg")["double_value"], -45.0);
    assert_eq!(get(&mut router, "capture.speed"), Value::Null);
    let about = ["axis.min_deg", "capture.speed_deg_s"];
    let described = DESCRIBE.ask(&mut router, &json!({ "names": about }))["descriptors"].clone();
    for (number, is_read_only) in [(0, true), (1, false)] {
        let one = &described[number];
        assert_eq!(one["name"], about[number]);
        assert_eq!(
            (&one["type"], &one["read_only"]),
            (&json!(3), &json!(is_read_only))
        );
        assert!(one["description"].to_string().contains("deg"), "{one}");
    }

    let speed = "capture.speed_deg_s";
    let integer = json!({ "name": speed, "value": { "type": 2, "integer_value": 20 } });
    for (parameter, reason) in [
        (double(speed, 1e4), "98"),
        (integer, "type double, got integer"),
        (double("axis.max_deg", 90.0), "read-only"),
    ] {
        let (is_set, got) = set(&mut router, &parameter);
        assert!(!is_set && got.contains(reason), "{got}");
    }
    let both = |to| json!({ "parameters": [double(speed, 30.0), double("capture.to_deg", to)] });
    let answer = SET_ATOMICALLY.ask(&mut router, &both(-80.0));
    let (is_set, reason) = result(&answer["result"]);
    assert!(!is_set && reason.contains("-45"), "{reason}");
    assert_eq!(get(&mut router, speed)["double_value"], 5.0);
    let answer = SET_ATOMICALLY.ask(&mut router, &both(-20.0));
    assert_eq!(result(&answer["result"]), (true, String::new()));
    assert_eq!(
        set(&mut router, &double(speed, 56.25)),
        (true, String::new())
    );
    assert_eq!(get(&mut router, speed)["double_value"], 56.25);
    // A request that is not of this type.
    let command = json!({ "do": "call", "key": LIST.key(), "attachment": "rmw_zenoh" });
    let printed = router.request(&command);
    let refused = printed.iter().find(|value| value.get("refused").is_some());
    assert!(
        refused.unwrap()["refused"].to_string().contains("CDR"),
        "{printed:?}"
    );
    assert_eq!(rig.status()["activity"]["doing"], "idle");
    assert_eq!(figure(&rig, "captures"), 0);

    let (done, id) = calls::call(&mut router, "start_capture");
    assert!(done, "{id}");
    let scan = rig.finished(&id);
    assert_eq!(scan["state"], "whole");
    assert_eq!(scan["asked"]["speed_deg_s"], 56.25);
    assert_eq!(scan["asked"]["to_deg"], -20.0);
}
