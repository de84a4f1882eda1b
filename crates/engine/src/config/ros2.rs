//! `[daemon.ros2]`: router, domain, namespace.
//!
//! Every build parses it, so that a build without ROS 2 can report what it lacks.

use serde::de::Error;
use serde::{Deserialize, Deserializer};

use crate::capture_request::CaptureRequest;

/// Longest name or address, bytes.
const LONGEST: usize = 200;
/// Largest domain (`ROS_DOMAIN_ID`) that ROS 2 supports on every system.
const LAST_DOMAIN: u8 = 232;

/// The `[daemon.ros2]` table.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Ros2 {
    /// The zenoh router in zenoh's notation: `tcp/HOST:PORT`.
    #[serde(deserialize_with = "router")]
    pub router: String,
    /// Whether the router is a `zenoh-bridge-ros2dds`, whose subscribers use DDS.
    pub dds: bool,
    /// `ROS_DOMAIN_ID` of the subscribers; the bridge to DDS has its own.
    #[serde(deserialize_with = "domain")]
    pub domain: u8,
    /// Namespace of the node and its topics: `/`, or names each preceded by a slash.
    #[serde(deserialize_with = "namespace")]
    pub namespace: String,
    /// Prefix of the frame names.
    #[serde(deserialize_with = "frame_prefix")]
    pub frame_prefix: String,
    /// Whether actions are offered: their clients choose angles and speeds within the limits of
    /// the axis.
    pub actions: bool,
    /// Capture that the service `start_capture` starts; without it the service is absent.
    pub capture: Option<CaptureRequest>,
}

impl Default for Ros2 {
    fn default() -> Self {
        Self {
            // Default address of `rmw_zenohd`.
            router: "tcp/localhost:7447".to_owned(),
            dds: false,
            domain: 0,
            namespace: "/".to_owned(),
            frame_prefix: String::new(),
            actions: false,
            capture: None,
        }
    }
}

impl Ros2 {
    /// Absolute name of `topic`, which begins with a slash.
    #[must_use]
    pub fn resolve(&self, topic: &str) -> String {
        format!("{}{topic}", self.namespace.trim_end_matches('/'))
    }
}

/// The `[daemon.ros2]` table, whose settings agree.
pub(super) fn table<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Ros2>, D::Error> {
    let settings = Ros2::deserialize(from)?;
    if settings.dds && settings.domain != 0 {
        return Err(D::Error::custom(format!(
            "domain: with dds = true the domain is that of zenoh-bridge-ros2dds (-d, ROS_DOMAIN_ID); expected 0, got {}",
            settings.domain
        )));
    }
    Ok(Some(settings))
}

/// The text, if it is valid.
fn checked<'de, D: Deserializer<'de>>(
    from: D,
    expected: &str,
    is_valid: impl FnOnce(&str) -> bool,
) -> Result<String, D::Error> {
    let text = String::deserialize(from)?;
    if is_valid(&text) {
        return Ok(text);
    }
    Err(D::Error::custom(format!("{expected}, got {text:?}")))
}

fn router<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    let expected = "router: expected tcp/HOST:PORT, such as tcp/localhost:7447";
    checked(from, expected, |text| {
        let allowed = |byte: u8| byte.is_ascii_alphanumeric() || b"-._:[]%".contains(&byte);
        let is_host = |host: &str| (1..=LONGEST).contains(&host.len()) && host.bytes().all(allowed);
        let is_port = |port: &str| port.parse::<u16>().is_ok_and(|port| port > 0);
        let place = text.strip_prefix("tcp/");
        let place = place.and_then(|place| place.rsplit_once(':'));
        place.is_some_and(|(host, port)| is_host(host) && is_port(port))
    })
}

fn domain<'de, D: Deserializer<'de>>(from: D) -> Result<u8, D::Error> {
    let number = i64::deserialize(from)?;
    let domain = u8::try_from(number).ok().filter(|n| *n <= LAST_DOMAIN);
    domain.ok_or_else(|| {
        D::Error::custom(format!("domain: expected 0 to {LAST_DOMAIN}, got {number}"))
    })
}

fn namespace<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    let expected = "namespace: expected / or names of letters, digits and _ with a slash before each, such as /left";
    checked(from, expected, |text| {
        let is_name = |name: &str| {
            let begins = name.bytes().next().is_some_and(|b| !b.is_ascii_digit());
            begins && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
        };
        let names = text.strip_prefix('/');
        let complete = names.is_some_and(|names| names.is_empty() || names.split('/').all(is_name));
        complete && text.len() <= LONGEST
    })
}

fn frame_prefix<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    let expected =
        "frame_prefix: expected letters, digits, _, - and /, no slash first, such as left/";
    checked(from, expected, |text| {
        let allowed = |byte: u8| byte.is_ascii_alphanumeric() || b"_-/".contains(&byte);
        text.len() <= LONGEST && text.bytes().all(allowed) && !text.starts_with('/')
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::daemon::DaemonConfig;

    fn settings(text: &str) -> Result<Ros2, String> {
        toml::from_str(text).map_err(|error| error.to_string())
    }

    #[test]
    fn defaults_are_the_local_router_and_no_motion() {
        let usual = settings("").unwrap();
        assert_eq!(usual.router, "tcp/localhost:7447");
        assert_eq!((usual.domain, usual.namespace.as_str()), (0, "/"));
        assert_eq!(usual.resolve("/tf"), "/tf");
        assert!(usual.capture.is_none() && !usual.actions && !usual.dds);
    }

    #[test]
    fn valid_settings_are_accepted() {
        let configured = settings(
            "router = 'tcp/[fe80::1%eth0]:7448'\ndomain = 232\nnamespace = '/left/top_2'\nframe_prefix = 'left/'\n\
             [capture]\nspeed_deg_s = 20.0\nboth_ways = true",
        )
        .unwrap();
        assert_eq!(configured.resolve("/x/y"), "/left/top_2/x/y");
        assert!(configured.capture.unwrap().both_ways);
    }

    #[test]
    fn invalid_settings_are_refused_with_the_expected_form() {
        for (text, wanted) in [
            ("router = 'localhost:7447'", "tcp/HOST:PORT"),
            ("router = 'udp/localhost:7447'", "tcp/HOST:PORT"),
            ("router = 'tcp/localhost'", "tcp/HOST:PORT"),
            ("router = 'tcp/:7447'", "tcp/HOST:PORT"),
            ("router = 'tcp/localhost:0'", "tcp/HOST:PORT"),
            ("router = 'tcp/localhost:70000'", "tcp/HOST:PORT"),
            ("router = 'tcp/localhost:7447#iface=eth0'", "tcp/HOST:PORT"),
            ("domain = 233", "0 to 232"),
            ("domain = -1", "domain"),
            ("namespace = 'left'", "/left"),
            ("namespace = '/'\nnamespaces = '/'", "unknown field"),
            ("namespace = '/left/'", "/left"),
            ("namespace = '/2left'", "/left"),
            ("namespace = '/l*'", "/left"),
            ("frame_prefix = '/left'", "left/"),
            ("frame_prefix = 'le ft'", "left/"),
            ("[capture]\nspeed = 1", "unknown field"),
            ("[capture]\n", "speed_deg_s"),
        ] {
            let message = settings(text).unwrap_err();
            assert!(message.contains(wanted), "{text}: {message}");
        }
        let daemon = "[ros2]\ndds = true\ndomain = 3";
        let message = toml::from_str::<DaemonConfig>(daemon).unwrap_err();
        assert!(message.to_string().contains("ROS_DOMAIN_ID"), "{message}");
        assert!(toml::from_str::<DaemonConfig>("[ros2]\ndds = true").is_ok());
        let long = format!("namespace = '/{}'", "n".repeat(LONGEST));
        assert!(settings(&long).is_err());
    }
}
