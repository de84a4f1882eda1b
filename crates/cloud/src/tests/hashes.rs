//! Type hashes computed from the definitions: ROS 2's RIHS01 (REP 2016), the SHA-256 of the
//! descriptions of a type and its referenced types, as JSON in the order and with the blanks of
//! `rosidl`.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use sha2::{Digest, Sha256};

use crate::messages::actions::{CANCEL_GOAL, CAPTURE, GOAL_STATUS_ARRAY, MOVE_TILT};
use crate::messages::parameters::ParameterService;
use crate::messages::{MessageType, TRIGGER, Topic};

/// Type, name.
type Field = (String, String);

/// Type of a field: id, capacity, nested type (`type_description_interfaces/msg/FieldType`).
fn kind(package: &str, text: &str) -> (u32, u32, String) {
    let (element, more, capacity) = match text.strip_suffix(']').and_then(|t| t.split_once('[')) {
        None => (text, 0, 0),
        Some((element, "")) => (element, 144, 0),
        Some((element, size)) => match size.strip_prefix("<=") {
            Some(bound) => (element, 96, bound.parse().unwrap()),
            None => (element, 48, size.parse().unwrap()),
        },
    };
    let plain = match element {
        "uint8" | "char" => 3,
        "int8" => 2,
        "int32" => 6,
        "uint32" => 7,
        "int64" => 8,
        "uint64" => 9,
        "float64" => 11,
        "bool" => 15,
        "byte" => 16,
        "string" => 17,
        _ => {
            let name = match element.split('/').collect::<Vec<_>>()[..] {
                [name] => format!("{package}/msg/{name}"),
                [package, name] => format!("{package}/msg/{name}"),
                _ => element.to_owned(),
            };
            return (1 + more, capacity, name);
        }
    };
    (plain + more, capacity, String::new())
}

fn fields(text: &str) -> Vec<Field> {
    let lines = text
        .lines()
        .filter(|line| !line.contains('=') || line.contains("<="));
    lines
        .map(|line| {
            let mut words = line.split(' ');
            let kind = words.next().unwrap().to_owned();
            (kind, words.next().unwrap().to_owned())
        })
        .collect()
}

/// Every type of a definition, by its full name.
fn types(definition: &MessageType) -> BTreeMap<String, Vec<Field>> {
    let line = format!("{}\nMSG: ", "=".repeat(80));
    let mut parts = definition.definition.split(&line);
    let first = fields(parts.next().unwrap());
    let mut all = BTreeMap::from([(definition.name.to_owned(), first)]);
    for part in parts {
        let (name, text) = part.split_once('\n').unwrap();
        all.insert(name.replace('/', "/msg/"), fields(text));
    }
    all
}

/// A type and the types that it references.
fn described(
    name: &str,
    all: &BTreeMap<String, Vec<Field>>,
    nested: &mut BTreeSet<String>,
) -> String {
    let package = name.split('/').next().unwrap();
    let empty = [(
        "uint8".to_owned(),
        "structure_needs_at_least_one_member".to_owned(),
    )];
    let fields = match all[name].as_slice() {
        [] => &empty[..],
        fields => fields,
    };
    let mut text = format!("{{\"type_name\": \"{name}\", \"fields\": [");
    for (number, (type_text, field)) in fields.iter().enumerate() {
        let (id, capacity, inner) = kind(package, type_text);
        let comma = if number == 0 { "" } else { ", " };
        write!(
            text,
            "{comma}{{\"name\": \"{field}\", \"type\": {{\"type_id\": {id}, \"capacity\": {capacity}, \
             \"string_capacity\": 0, \"nested_type_name\": \"{inner}\"}}}}"
        )
        .unwrap();
        if !inner.is_empty() && nested.insert(inner.clone()) {
            described(&inner, all, nested);
        }
    }
    text + "]}"
}

fn rihs01(name: &str, all: &BTreeMap<String, Vec<Field>>) -> String {
    let mut nested = BTreeSet::new();
    let own = described(name, all, &mut nested);
    let others: Vec<String> = nested
        .iter()
        .map(|name| described(name, all, &mut BTreeSet::new()))
        .collect();
    let text = format!(
        "{{\"type_description\": {own}, \"referenced_type_descriptions\": [{}]}}",
        others.join(", ")
    );
    let digest = Sha256::digest(text.as_bytes());
    let mut hash = "RIHS01_".to_owned();
    for byte in digest {
        write!(hash, "{byte:02x}").unwrap();
    }
    hash
}

/// Types that services and actions are made of.
const COMMON: [(&str, &str); 12] = [
    (
        "service_msgs/msg/ServiceEventInfo",
        "uint8 event_type\nbuiltin_interfaces/Time stamp\nchar[16] client_gid\nint64 sequence_number\n",
    ),
    ("builtin_interfaces/msg/Time", "int32 sec\nuint32 nanosec\n"),
    ("unique_identifier_msgs/msg/UUID", "uint8[16] uuid\n"),
    (
        "action_msgs/msg/GoalInfo",
        "unique_identifier_msgs/UUID goal_id\nbuiltin_interfaces/Time stamp\n",
    ),
    (
        "action_msgs/msg/GoalStatus",
        "GoalInfo goal_info\nint8 status\n",
    ),
    (
        "rcl_interfaces/msg/ParameterValue",
        "uint8 type\nbool bool_value\nint64 integer_value\nfloat64 double_value\nstring string_value\n\
         byte[] byte_array_value\nbool[] bool_array_value\nint64[] integer_array_value\n\
         float64[] double_array_value\nstring[] string_array_value\n",
    ),
    (
        "rcl_interfaces/msg/Parameter",
        "string name\nParameterValue value\n",
    ),
    (
        "rcl_interfaces/msg/ParameterDescriptor",
        "string name\nuint8 type\nstring description\nstring additional_constraints\nbool read_only\n\
         bool dynamic_typing\nFloatingPointRange[<=1] floating_point_range\nIntegerRange[<=1] integer_range\n",
    ),
    (
        "rcl_interfaces/msg/FloatingPointRange",
        "float64 from_value\nfloat64 to_value\nfloat64 step\n",
    ),
    (
        "rcl_interfaces/msg/IntegerRange",
        "int64 from_value\nint64 to_value\nuint64 step\n",
    ),
    (
        "rcl_interfaces/msg/ListParametersResult",
        "string[] names\nstring[] prefixes\n",
    ),
    (
        "rcl_interfaces/msg/SetParametersResult",
        "bool successful\nstring reason\n",
    ),
];

/// The hash of a type made of these and [`COMMON`].
fn hash_of(name: &str, texts: &[(String, String)]) -> String {
    let common = COMMON.map(|(name, text)| (name.to_owned(), text.to_owned()));
    let texts = common.iter().chain(texts);
    let all = texts.map(|(name, text)| (name.clone(), fields(text)));
    rihs01(name, &all.collect())
}

/// A service is a type of request, response and event; the event is the same for every service.
fn service(name: &str, request: &str, response: &str) -> Vec<(String, String)> {
    let of = |part: &str| format!("{name}_{part}");
    let [request_name, response_name, event] = ["Request", "Response", "Event"].map(of);
    vec![
        (
            name.to_owned(),
            format!(
                "{request_name} request_message\n{response_name} response_message\n{event} event_message\n"
            ),
        ),
        (
            event,
            format!(
                "service_msgs/ServiceEventInfo info\n{request_name}[<=1] request\n{response_name}[<=1] response\n"
            ),
        ),
        (request_name, request.to_owned()),
        (response_name, response.to_owned()),
    ]
}

/// Hashes of an action's services and of its feedback, from the text of its definition
/// (`add_action` in `rosidl_generator_type_description`).
fn action(name: &str, text: &str) -> [String; 3] {
    let [goal, result, feedback] = text.split("---\n").collect::<Vec<_>>()[..] else {
        panic!("{name}: {text}");
    };
    let of = |part: &str| format!("{name}_{part}");
    let id = "unique_identifier_msgs/UUID goal_id\n";
    let [send_goal, get_result, message] = ["SendGoal", "GetResult", "FeedbackMessage"].map(of);
    let mut texts = [("Goal", goal), ("Result", result), ("Feedback", feedback)]
        .map(|(part, text)| (of(part), text.to_owned()))
        .to_vec();
    texts.push((message.clone(), format!("{id}{name}_Feedback feedback\n")));
    texts.extend(service(
        &send_goal,
        &format!("{id}{name}_Goal goal\n"),
        "bool accepted\nbuiltin_interfaces/Time stamp\n",
    ));
    texts.extend(service(
        &get_result,
        id,
        &format!("int8 status\n{name}_Result result\n"),
    ));
    [send_goal, get_result, message].map(|name| hash_of(&name, &texts))
}

#[test]
fn message_hashes_match_their_definitions() {
    let topics = Topic::ALL.map(Topic::message_type);
    for kind in topics.iter().chain([&GOAL_STATUS_ARRAY]) {
        assert_eq!(rihs01(kind.name, &types(kind)), kind.hash, "{}", kind.name);
    }
}

/// That of `DescribeParameters` is also in `describe_parameters__description.c`, which ROS 2's
/// generator wrote.
#[test]
fn service_hashes_match_their_definitions() {
    let parameters = ParameterService::ALL.map(ParameterService::message_type);
    for kind in [TRIGGER, CANCEL_GOAL].iter().chain(&parameters) {
        let (request, response) = kind.definition.split_once("---\n").unwrap();
        let hash = hash_of(kind.name, &service(kind.name, request, response));
        assert_eq!(hash, kind.hash, "{}", kind.name);
    }
}

/// Hashes that ROS 2's generator wrote (`fibonacci__description.c` of the package `rob599_msgs` in
/// the repository pfeiffmi/ROB599_activities).
#[test]
fn action_hashes_match_those_of_the_generator() {
    let text = "int64 number\n---\nint64[] sequence\n---\nint64 progress\n";
    let hashes = action("rob599_msgs/action/Fibonacci", text);
    let generated = [
        "3d7412ff91ff9c5abfbf9f7f5dc2171a3f32cf6da2414b2c2c82f034d176fa01",
        "8ebe968757e1b88d729ad53e9aca6d14e4b2f113272786f55541cfb26acc91fc",
        "a941cc541674f910f08c54c0d6a8a5a63be0ee7697a74928f342b2583dcfa88a",
    ];
    assert_eq!(hashes, generated.map(|hash| format!("RIHS01_{hash}")));
}

/// Clients are built from the package, so that its files must have the hashes of the daemon.
#[test]
fn action_hashes_match_the_files_of_the_package() {
    for (name, text, kind) in [
        (
            "Capture",
            include_str!("../../../../packaging/ros/velomotion_msgs/action/Capture.action"),
            CAPTURE,
        ),
        (
            "MoveTilt",
            include_str!("../../../../packaging/ros/velomotion_msgs/action/MoveTilt.action"),
            MOVE_TILT,
        ),
    ] {
        let lines = text.lines().map(|line| line.split('#').next().unwrap());
        let lines: Vec<&str> = lines
            .map(str::trim)
            .filter(|line| !line.is_empty())
            .collect();
        let text = lines.join("\n") + "\n";
        let of = [kind.send_goal, kind.get_result, kind.feedback];
        let hashes = action(&format!("velomotion_msgs/action/{name}"), &text);
        assert_eq!(hashes, of.map(|kind| kind.hash.to_owned()), "{name}");
        assert_eq!(of.map(|kind| kind.definition), [text.as_str(); 3]);
    }
}
