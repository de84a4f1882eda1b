//! Type hashes computed from the definitions: ROS 2's RIHS01 (REP 2016), the SHA-256 of the
//! descriptions of a type and its referenced types, as JSON in the order and with the blanks of
//! `rosidl`.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use sha2::{Digest, Sha256};

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
        "int32" => 6,
        "uint32" => 7,
        "int64" => 8,
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

#[test]
fn message_hashes_match_their_definitions() {
    for topic in Topic::ALL {
        let kind = topic.message_type();
        assert_eq!(rihs01(kind.name, &types(&kind)), kind.hash, "{}", kind.name);
    }
}

/// A service is hashed as a type of request, response and event; the event is the same for every
/// service.
#[test]
fn the_service_hash_matches_its_definition() {
    let (request, response) = TRIGGER.definition.split_once("---\n").unwrap();
    let name = TRIGGER.name;
    let of = |part: &str| format!("{name}_{part}");
    let (request_name, response_name) = (of("Request"), of("Response"));
    let texts = [
        (
            name.to_owned(),
            format!(
                "{request_name} request_message\n{response_name} response_message\n{} event_message\n",
                of("Event")
            ),
        ),
        (request_name.clone(), request.to_owned()),
        (response_name.clone(), response.to_owned()),
        (
            of("Event"),
            format!(
                "service_msgs/ServiceEventInfo info\n{request_name}[<=1] request\n{response_name}[<=1] response\n"
            ),
        ),
        (
            "service_msgs/msg/ServiceEventInfo".to_owned(),
            "uint8 event_type\nbuiltin_interfaces/Time stamp\nchar[16] client_gid\nint64 sequence_number\n".to_owned(),
        ),
        (
            "builtin_interfaces/msg/Time".to_owned(),
            "int32 sec\nuint32 nanosec\n".to_owned(),
        ),
    ];
    let all = texts
        .into_iter()
        .map(|(name, text)| (name, fields(&text)))
        .collect();
    assert_eq!(rihs01(name, &all), TRIGGER.hash);
}
