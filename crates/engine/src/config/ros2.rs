//! `[daemon.ros2]`: router, domain, namespace.
//!
//! Every build parses it, so that a build without ROS 2 can report what it lacks.

use serde::Deserialize;

use crate::capture_request::CaptureRequest;

/// Longest name or address, bytes.
const LONGEST: usize = 200;
/// Largest domain (`ROS_DOMAIN_ID`) that ROS 2 supports on every system.
const LAST_DOMAIN: u8 = 232;

/// The `[daemon.ros2]` table.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Ros2 {
    /// The zenoh router.
    pub router: Router,
    /// `ROS_DOMAIN_ID` of the subscribers.
    pub domain: Domain,
    /// Namespace of the node and its topics.
    pub namespace: Namespace,
    /// Prefix of the frame names.
    pub frame_prefix: FramePrefix,
    /// Capture that the service `start_capture` starts; without it the service is absent.
    pub capture: Option<CaptureRequest>,
}

/// An endpoint in zenoh's notation: `tcp/HOST:PORT`.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct Router(String);

impl Default for Router {
    /// Default address of `rmw_zenohd`.
    fn default() -> Self {
        Self("tcp/localhost:7447".to_owned())
    }
}

impl Router {
    /// The endpoint.
    #[must_use]
    pub fn endpoint(&self) -> &str {
        &self.0
    }
}

impl TryFrom<String> for Router {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let place = text
            .strip_prefix("tcp/")
            .and_then(|place| place.rsplit_once(':'));
        let allowed = |byte: u8| byte.is_ascii_alphanumeric() || b"-._:[]%".contains(&byte);
        let is_host = |host: &str| (1..=LONGEST).contains(&host.len()) && host.bytes().all(allowed);
        let is_port = |port: &str| port.parse::<u16>().is_ok_and(|port| port > 0);
        match place {
            Some((host, port)) if is_host(host) && is_port(port) => Ok(Self(text)),
            _ => Err(format!(
                "router: expected tcp/HOST:PORT, such as tcp/localhost:7447, got {text:?}"
            )),
        }
    }
}

/// A ROS domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(try_from = "u64")]
pub struct Domain(pub u8);

impl TryFrom<u64> for Domain {
    type Error = String;

    fn try_from(number: u64) -> Result<Self, String> {
        let small = u8::try_from(number).ok().filter(|n| *n <= LAST_DOMAIN);
        small
            .map(Self)
            .ok_or_else(|| format!("domain: expected 0 to {LAST_DOMAIN}, got {number}"))
    }
}

/// A namespace: `/`, or names each preceded by a slash.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct Namespace(String);

impl Default for Namespace {
    fn default() -> Self {
        Self("/".to_owned())
    }
}

impl Namespace {
    /// The namespace with its leading slash.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.0
    }

    /// Absolute name of `topic`, which begins with a slash.
    #[must_use]
    pub fn resolve(&self, topic: &str) -> String {
        match self.0.as_str() {
            "/" => topic.to_owned(),
            namespace => format!("{namespace}{topic}"),
        }
    }
}

impl TryFrom<String> for Namespace {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let is_name = |name: &str| {
            let begins = name.bytes().next().is_some_and(|b| !b.is_ascii_digit());
            begins && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
        };
        let names = text.strip_prefix('/');
        let whole = names.is_some_and(|names| names.is_empty() || names.split('/').all(is_name));
        if whole && text.len() <= LONGEST {
            return Ok(Self(text));
        }
        Err(format!(
            "namespace: expected / or names of letters, digits and _ with a slash before each, such as /left, got {text:?}"
        ))
    }
}

/// Prefix of frame names; empty by default.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct FramePrefix(pub String);

impl TryFrom<String> for FramePrefix {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let allowed = |byte: u8| byte.is_ascii_alphanumeric() || b"_-/".contains(&byte);
        if text.len() <= LONGEST && text.bytes().all(allowed) && !text.starts_with('/') {
            return Ok(Self(text));
        }
        Err(format!(
            "frame_prefix: expected letters, digits, _, - and /, no slash first, such as left/, got {text:?}"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(text: &str) -> Result<Ros2, String> {
        toml::from_str(text).map_err(|error| error.to_string())
    }

    #[test]
    fn nothing_said_is_the_router_of_this_machine_and_no_motion() {
        let usual = settings("").unwrap();
        assert_eq!(usual.router.endpoint(), "tcp/localhost:7447");
        assert_eq!((usual.domain.0, usual.namespace.name()), (0, "/"));
        assert_eq!(usual.namespace.resolve("/tf"), "/tf");
        assert!(usual.capture.is_none());
    }

    #[test]
    fn what_can_be_said_is_taken() {
        let said = settings(
            "router = 'tcp/[fe80::1%eth0]:7448'\ndomain = 232\nnamespace = '/left/top_2'\nframe_prefix = 'left/'\n\
             [capture]\nspeed_deg_s = 20.0\nboth_ways = true",
        )
        .unwrap();
        assert_eq!(said.namespace.resolve("/x/y"), "/left/top_2/x/y");
        assert!(said.capture.unwrap().both_ways);
    }

    #[test]
    fn what_cannot_be_is_refused_with_what_was_expected() {
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
            let said = settings(text).unwrap_err();
            assert!(said.contains(wanted), "{text}: {said}");
        }
        let long = format!("namespace = '/{}'", "n".repeat(LONGEST));
        assert!(settings(&long).is_err());
    }
}
