//! Names of `rmw_zenoh_cpp` (Jazzy and later): keys, liveliness tokens, gids, attachments, as in
//! its `liveliness_utils.cpp`, `attachment_helpers.cpp` and `qos.cpp`.

use cloud::messages::MessageType;
use xxhash_rust::xxh3::xxh3_128;

use engine::config::ros2::Ros2;

/// Name of the node.
pub const NODE: &str = "velomotion";
/// The node's own number in its session.
const NODE_ID: u32 = 0;
/// `rmw_zenoh`'s default depth, which is not written.
const USUAL_DEPTH: u32 = 42;
/// Bytes of an attachment: two i64, a length, a gid.
const ATTACHMENT_BYTES: usize = 33;
pub const GID_BYTES: usize = 16;

/// Identity of a publisher or a client in `rmw_zenoh`.
pub type Gid = [u8; GID_BYTES];

/// Offered quality of service (`rmw/types.h`): history is keep last, and deadline, lifespan and
/// liveliness are without limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QualityOfService {
    /// Reliable, else best effort.
    pub reliable: bool,
    /// Transient local, else volatile.
    pub latched: bool,
    /// Number of samples kept.
    pub depth: u32,
}

impl QualityOfService {
    /// Text in liveliness tokens; `rmw_zenoh`'s defaults are left empty.
    fn text(self) -> String {
        let reliability = if self.reliable { "" } else { "2" };
        let durability = if self.latched { "1" } else { "" };
        let depth = match self.depth {
            USUAL_DEPTH => String::new(),
            depth => depth.to_string(),
        };
        format!("{reliability}:{durability}:,{depth}:,:,:,,")
    }
}

/// A type as DDS and `rmw_zenoh` write it: `sensor_msgs::msg::dds_::PointCloud2_`.
fn type_name(kind: &MessageType) -> String {
    let parts: Vec<&str> = kind.name.split('/').collect();
    match parts.split_last() {
        Some((name, path)) => format!("{}::dds_::{name}_", path.join("::")),
        None => String::new(),
    }
}

/// A name as one part of a key.
fn mangled(name: &str) -> String {
    name.replace('/', "%")
}

/// Key of a topic or service whose full name is `name`.
#[must_use]
pub fn key(settings: &Ros2, name: &str, kind: &MessageType) -> String {
    let domain = settings.domain;
    let name = name.trim_matches('/');
    format!("{domain}/{name}/{}/{}", type_name(kind), kind.hash)
}

/// Kind of an entity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entity {
    /// A publisher.
    Publisher,
    /// A service.
    Service,
}

/// Token of the node in the session `zid`.
#[must_use]
pub fn node_token(settings: &Ros2, zid: &str) -> String {
    token_begin(settings, zid, NODE_ID, "NN")
}

/// Token of its entity number `id`, from 1.
#[must_use]
pub fn token(
    settings: &Ros2,
    zid: &str,
    (id, entity): (u32, Entity),
    (name, kind): (&str, &MessageType),
    quality: QualityOfService,
) -> String {
    let entity = match entity {
        Entity::Publisher => "MP",
        Entity::Service => "SS",
    };
    format!(
        "{}/{}/{}/{}/{}",
        token_begin(settings, zid, id, entity),
        mangled(name),
        type_name(kind),
        kind.hash,
        quality.text()
    )
}

fn token_begin(settings: &Ros2, zid: &str, id: u32, entity: &str) -> String {
    // No security enclave is the root.
    let (domain, namespace) = (settings.domain, mangled(&settings.namespace));
    format!("@ros2_lv/{domain}/{zid}/{NODE_ID}/{id}/{entity}/%/{namespace}/{NODE}")
}

/// The gid of who has this token.
#[must_use]
pub fn gid(token: &str) -> Gid {
    xxh3_128(token.as_bytes()).to_le_bytes()
}

/// Attachment of a message: its number, from 1, its time of sending (nanoseconds since 1970), and
/// its sender.
#[must_use]
pub fn attachment(number: i64, sent_ns: i64, gid: &Gid) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(ATTACHMENT_BYTES);
    bytes.extend_from_slice(&number.to_le_bytes());
    bytes.extend_from_slice(&sent_ns.to_le_bytes());
    bytes.push(GID_BYTES as u8);
    bytes.extend_from_slice(gid);
    bytes
}

/// Number and sender of a request; `None` where it is no attachment of `rmw_zenoh`.
#[must_use]
pub fn request_of(attachment: &[u8]) -> Option<(i64, Gid)> {
    let bytes: &[u8; ATTACHMENT_BYTES] = attachment.try_into().ok()?;
    let (number, rest) = bytes.split_first_chunk::<8>()?;
    let (_, rest) = rest.split_first_chunk::<8>()?;
    let (length, gid) = rest.split_first()?;
    if usize::from(*length) != GID_BYTES {
        return None;
    }
    Some((i64::from_le_bytes(*number), gid.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use cloud::messages::{TRIGGER, Topic};

    use super::*;

    fn settings(text: &str) -> Ros2 {
        toml::from_str(text).unwrap()
    }

    const RELIABLE: QualityOfService = QualityOfService {
        reliable: true,
        latched: false,
        depth: 10,
    };

    #[test]
    fn keys_match_rmw_zenoh() {
        let kind = Topic::Transforms.message_type();
        assert_eq!(
            key(&settings("domain = 7"), "/left/tf", &kind),
            "7/left/tf/tf2_msgs::msg::dds_::TFMessage_/RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"
        );
        assert!(
            key(&settings(""), "/x", &TRIGGER).starts_with("0/x/std_srvs::srv::dds_::Trigger_/")
        );
    }

    #[test]
    fn liveliness_tokens_have_no_empty_part() {
        let (plain, named) = (settings(""), settings("namespace = '/a/b'\ndomain = 3"));
        assert_eq!(
            node_token(&plain, "q1"),
            "@ros2_lv/0/q1/0/0/NN/%/%/velomotion"
        );
        let kind = Topic::Points.message_type();
        let key = token(
            &named,
            "q1",
            (2, Entity::Publisher),
            ("/a/b/velomotion/points", &kind),
            RELIABLE,
        );
        let hash = kind.hash;
        assert_eq!(
            key,
            format!(
                "@ros2_lv/3/q1/0/2/MP/%/%a%b/velomotion/%a%b%velomotion%points/sensor_msgs::msg::dds_::PointCloud2_/{hash}/::,10:,:,:,,"
            )
        );
        assert!(key.split('/').all(|part| !part.is_empty()));
    }

    #[test]
    fn default_quality_settings_are_omitted() {
        let text = |reliable, latched, depth| {
            QualityOfService {
                reliable,
                latched,
                depth,
            }
            .text()
        };
        assert_eq!(text(true, false, 42), "::,:,:,:,,");
        assert_eq!(text(true, true, 1), ":1:,1:,:,:,,");
        assert_eq!(text(false, false, 5), "2::,5:,:,:,,");
    }

    /// Vectors of the xxHash project's own test program for XXH3-128 with seed 0: the empty input,
    /// and the order of bytes.
    #[test]
    fn gids_are_xxh3_with_the_low_half_first() {
        assert_eq!(
            xxh3_128(b""),
            0x99aa_06d3_0147_98d8_6001_c324_468d_497f_u128
        );
        let gid = gid("");
        assert_eq!(gid[..8], 0x6001_c324_468d_497f_u64.to_le_bytes());
        assert_eq!(gid[8..], 0x99aa_06d3_0147_98d8_u64.to_le_bytes());
    }

    #[test]
    fn attachments_are_33_bytes_and_round_trip() {
        let gid = gid("token");
        let bytes = attachment(1, 2, &gid);
        assert_eq!(bytes.len(), 33);
        assert_eq!(bytes[..9], [1, 0, 0, 0, 0, 0, 0, 0, 2]);
        assert_eq!(bytes[16], 16);
        assert_eq!(request_of(&bytes), Some((1, gid)));
        assert_eq!(request_of(&bytes[..32]), None);
        let mut other = bytes;
        other[16] = 15;
        assert_eq!(request_of(&other), None);
        assert_eq!(request_of(&[]), None);
    }
}
