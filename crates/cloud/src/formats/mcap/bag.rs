//! Qualities of service and `metadata.yaml`, which `ros2 bag` needs besides the messages.
//!
//! Version 5 of rosbag2's format, read by Humble and later. Policies are numbers (rmw/types.h).

use std::collections::BTreeMap;
use std::fmt::Write;

use super::channels::McapChannels;
use crate::Companion;
use crate::messages::Topic;

const VERSION: u32 = 5;

/// The metadata record of rosbag2's own writer. Without it readers expect qualities of service as
/// numbers, the form before version 9; with a newer one as names.
pub(super) fn record() -> mcap::records::Metadata {
    mcap::records::Metadata {
        name: "rosbag2".to_owned(),
        metadata: BTreeMap::from([("serialized_metadata".to_owned(), String::new())]),
    }
}

/// Quality of service of a topic as YAML: reliable, latched or not, keep last, no deadlines.
pub(super) fn quality(topic: Topic) -> String {
    let (durability, depth) = if topic.is_latched() { (1, 1) } else { (2, 10) };
    let never = "\n    sec: 9223372036\n    nsec: 854775807";
    format!(
        "- history: 1\n  depth: {depth}\n  reliability: 1\n  durability: {durability}\n  deadline:{never}\n  lifespan:{never}\n  \
         liveliness: 1\n  liveliness_lease_duration:{never}\n  avoid_ros_namespace_conventions: false"
    )
}

/// `metadata.yaml` for the recording `file_name`.
pub(super) fn companion(file_name: &str, channels: &McapChannels) -> Companion {
    let (start, end) = channels.times().unwrap_or((0, 0));
    let duration = end.saturating_sub(start);
    let messages: u64 = channels.counts().map(|(_, count)| u64::from(count)).sum();
    let file = quoted(file_name);
    let mut topics = String::new();
    for (topic, count) in channels.counts() {
        let (name, kind) = (topic.name(), topic.message_type().name);
        let quality = quoted(&quality(topic));
        // Writing into a string cannot fail.
        let _ = write!(
            topics,
            "\n    - topic_metadata:\n        name: {name}\n        type: {kind}\n        serialization_format: cdr\n        \
             offered_qos_profiles: {quality}\n      message_count: {count}"
        );
    }
    if topics.is_empty() {
        topics.push_str(" []");
    }
    let text = format!(
        "rosbag2_bagfile_information:
  version: {VERSION}
  storage_identifier: mcap
  duration:
    nanoseconds: {duration}
  starting_time:
    nanoseconds_since_epoch: {start}
  message_count: {messages}
  topics_with_message_count:{topics}
  compression_format: \"\"
  compression_mode: \"\"
  relative_file_paths:
    - {file}
  files:
    - path: {file}
      starting_time:
        nanoseconds_since_epoch: {start}
      duration:
        nanoseconds: {duration}
      message_count: {messages}
"
    );
    Companion {
        name: "metadata.yaml".to_owned(),
        text,
    }
}

/// A YAML string in double quotes.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            c if c.is_control() => {
                let _ = write!(quoted, "\\u{:04x}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_break_the_yaml() {
        assert_eq!(quoted("a \"b\" \\ c\n\u{7}é"), r#""a \"b\" \\ c\n\u0007é""#);
    }

    #[test]
    fn only_the_mount_is_kept_for_late_subscribers() {
        for topic in Topic::ALL {
            let latched = quality(topic).contains("durability: 1\n");
            assert_eq!(latched, topic == Topic::StaticTransforms, "{topic:?}");
        }
    }
}
