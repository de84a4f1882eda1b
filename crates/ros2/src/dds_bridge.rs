//! Names of `zenoh-bridge-ros2dds`, which joins nodes that use DDS: keys, announcements and
//! requests, as in its `liveliness_mgt.rs` and `ros2_utils.rs` (1.10).

use cloud::messages::MessageType;

use crate::rmw::{Entity, GID_BYTES, Gid, QualityOfService};

/// Bytes of a request's attachment: `rqh`, `rmw_cyclonedds`' header (client, number), endianness.
const ATTACHMENT_BYTES: usize = 20;
/// Marks the attachment of a request.
const REQUEST: &[u8] = b"rqh";
/// Between the name of an action and those of its services and topics.
const ACTION_PART: &str = "/_action/";

/// Key of a topic or service whose full name is `name`. The bridge has the domain.
#[must_use]
pub fn key(name: &str) -> String {
    name.trim_matches('/').to_owned()
}

/// Token that declares the session `zid` as a bridge.
#[must_use]
pub fn bridge_token(zid: &str) -> String {
    format!("@/{zid}/@ros2_lv")
}

/// Token of a publisher or service. An action has a single token, declared with its service
/// `send_goal`; its other parts have none.
#[must_use]
pub fn token(
    zid: &str,
    entity: Entity,
    (name, kind): (&str, &MessageType),
    quality: QualityOfService,
) -> Option<String> {
    let begin = bridge_token(zid);
    let escaped = |text: &str| text.trim_matches('/').replace('/', "§");
    if let Some((action, part)) = name.split_once(ACTION_PART) {
        let kind = kind.name.strip_suffix("_SendGoal")?;
        let (action, kind) = (escaped(action), escaped(kind));
        return (part == "send_goal").then(|| format!("{begin}/AS/{action}/{kind}"));
    }
    let (key, type_name) = (escaped(name), escaped(kind.name));
    Some(match entity {
        Entity::Publisher => {
            // Numbers of DDS: reliable 1, transient local 1, keep last 0; and the type's hash as
            // participants publish it in USER_DATA.
            let (reliable, latched) = (u8::from(quality.reliable), u8::from(quality.latched));
            let (depth, hash) = (quality.depth, kind.hash);
            format!("{begin}/MP/{key}/{type_name}/:{reliable}:{latched}:0,{depth}:typehash={hash};")
        }
        Entity::Service => format!("{begin}/SS/{key}/{type_name}"),
    })
}

/// Number and sender of a request; `None` where it is no attachment of the bridge.
#[must_use]
pub fn request_of(attachment: &[u8]) -> Option<(i64, Gid)> {
    let bytes: &[u8; ATTACHMENT_BYTES] = attachment.try_into().ok()?;
    let (client, rest) = bytes.strip_prefix(REQUEST)?.split_first_chunk::<8>()?;
    let (number, is_little_endian) = rest.split_first_chunk::<8>()?;
    let number = match is_little_endian {
        [0] => i64::from_be_bytes(*number),
        _ => i64::from_le_bytes(*number),
    };
    let mut gid = [0; GID_BYTES];
    gid.first_chunk_mut::<8>()?.copy_from_slice(client);
    Some((number, gid))
}

#[cfg(test)]
mod tests {
    use cloud::messages::actions::{CANCEL_GOAL, CAPTURE};
    use cloud::messages::{TRIGGER, Topic};

    use super::*;

    const LATCHED: QualityOfService = QualityOfService {
        reliable: true,
        latched: true,
        depth: 1,
    };

    #[test]
    fn tokens_announce_topics_services_and_whole_actions() {
        let kind = Topic::StaticTransforms.message_type();
        let hash = kind.hash;
        assert_eq!(key("/left/tf"), "left/tf");
        assert_eq!(
            token("7a", Entity::Publisher, ("/left/tf", &kind), LATCHED).unwrap(),
            format!("@/7a/@ros2_lv/MP/left§tf/tf2_msgs§msg§TFMessage/:1:1:0,1:typehash={hash};")
        );
        let service = |name, kind| token("7a", Entity::Service, (name, kind), LATCHED);
        assert_eq!(
            service("/x/start", &TRIGGER).unwrap(),
            "@/7a/@ros2_lv/SS/x§start/std_srvs§srv§Trigger"
        );
        assert_eq!(
            service("/x/capture/_action/send_goal", &CAPTURE.send_goal).unwrap(),
            "@/7a/@ros2_lv/AS/x§capture/velomotion_msgs§action§Capture"
        );
        for (name, kind) in [
            ("/x/capture/_action/get_result", &CAPTURE.get_result),
            ("/x/capture/_action/cancel_goal", &CANCEL_GOAL),
        ] {
            assert_eq!(service(name, kind), None);
        }
    }

    #[test]
    fn requests_have_the_header_of_cyclonedds() {
        let mut bytes = b"rqh\x01\x02\x03\x04\x05\x06\x07\x08\x09\0\0\0\0\0\0\0\x01".to_vec();
        let (number, gid) = request_of(&bytes).unwrap();
        assert_eq!((number, gid[0], gid[7], gid[8]), (9, 1, 8, 0));
        bytes[19] = 0;
        assert_eq!(request_of(&bytes).unwrap().0, 9 << 56);
        bytes[0] = b'x';
        assert_eq!(request_of(&bytes), None);
        assert_eq!(request_of(&[]), None);
    }
}
