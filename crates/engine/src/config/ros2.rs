//! `[daemon.ros2]` of the configuration: which router, which domain, and the names there.
//!
//! It is read by every build, so that one without ROS 2 can say what it lacks.

use serde::Deserialize;

use crate::capture::request::CaptureRequest;

/// Most bytes of a name or an address.
const LONGEST: usize = 200;
/// Largest domain (`ROS_DOMAIN_ID`), as ROS 2 has it on every system.
const LAST_DOMAIN: u8 = 232;

/// `[daemon.ros2]`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Ros2 {
    /// The zenoh router.
    pub router: Router,
    /// `ROS_DOMAIN_ID` of those who are to see the topics.
    pub domain: Domain,
    /// Namespace of the node, before the names of its topics.
    pub namespace: Namespace,
    /// What is before the names of its frames.
    pub frame_prefix: FramePrefix,
    /// The capture that `start_capture` begins; without it there is no such service.
    pub capture: Option<CaptureRequest>,
}

/// An endpoint as zenoh writes it: `tcp/HOST:PORT`.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct Router(String);

impl Default for Router {
    /// Where `rmw_zenohd` listens.
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

/// A domain.
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

/// A namespace: `/`, or names with a slash before each.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct Namespace(String);

impl Default for Namespace {
    fn default() -> Self {
        Self("/".to_owned())
    }
}

impl Namespace {
    /// It, with its slash.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.0
    }

    /// `topic`, which begins with a slash, in it.
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

/// What is before the names of frames; nothing by default.
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
