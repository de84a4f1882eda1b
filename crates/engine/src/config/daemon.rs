//! `[daemon]`: listening address, access, storage of scans.

use std::fmt;
use std::hint::black_box;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;

use serde::Deserialize;

use super::origin::Origin;
use super::ros2::Ros2;
use crate::failure::{Failure, Kind};

/// Default port.
const PORT: u16 = 8016;
/// Shortest token, bytes.
pub const TOKEN_BYTES: usize = 16;
/// Longest token, bytes.
const TOKEN_MOST: usize = 256;

/// The `[daemon]` table.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DaemonConfig {
    /// Address and port.
    pub listen: SocketAddr,
    /// Token required in every request over TCP.
    pub token: Option<Token>,
    /// Further origins whose pages may send changes, such as a TLS proxy in front of the daemon.
    pub origins: Vec<Origin>,
    /// Folder of the scans.
    pub scans: Option<PathBuf>,
    /// Number of scans to keep.
    pub keep_scans: u64,
    /// Total size of the scans to keep, bytes.
    pub keep_bytes: u64,
    /// Disk space to leave free, bytes.
    pub reserve_bytes: u64,
    /// `[daemon.ros2]`; without it ROS 2 gets nothing.
    pub ros2: Option<Ros2>,
}

impl Default for DaemonConfig {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, PORT)),
            token: None,
            origins: Vec::new(),
            scans: None,
            keep_scans: 100,
            keep_bytes: 50_000_000_000,
            reserve_bytes: 1_000_000_000,
            ros2: None,
        }
    }
}

/// A secret. It is never printed, and comparing it takes constant time.
#[derive(Clone, PartialEq, Deserialize)]
#[serde(try_from = "String")]
pub struct Token(String);

impl TryFrom<String> for Token {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let length = TOKEN_BYTES..=TOKEN_MOST;
        let allowed = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte);
        if length.contains(&text.len()) && text.bytes().all(allowed) {
            return Ok(Self(text));
        }
        Err(format!(
            "token: expected {TOKEN_BYTES} to {TOKEN_MOST} letters, digits or -_.~, got {} bytes",
            text.len()
        ))
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token(...)")
    }
}

impl Token {
    /// Compares in a time that depends only on the length of `given`.
    #[must_use]
    pub fn is(&self, given: &[u8]) -> bool {
        equal(self.0.as_bytes(), given)
    }
}

/// Compares two secrets in a time that depends only on the length of the second.
#[must_use]
pub fn equal(secret: &[u8], given: &[u8]) -> bool {
    let mut different = secret.len() ^ given.len();
    for (index, byte) in given.iter().enumerate() {
        let own = secret.get(index % secret.len().max(1)).unwrap_or(&0);
        different |= usize::from(black_box(own ^ byte));
    }
    black_box(different) == 0
}

impl DaemonConfig {
    /// Refuses to listen beyond this machine without a token.
    ///
    /// # Errors
    /// [`Kind::Usage`].
    pub fn check(&self, listen: SocketAddr) -> Result<(), Failure> {
        if self.token.is_some() || listen.ip().is_loopback() {
            return Ok(());
        }
        Err(Failure::new(
            Kind::Usage,
            format!("{listen} accepts other machines without a token: anyone could move the axis"),
        )
        .help(
            "set token = \"...\" under [daemon] of the configuration (head -c 24 /dev/urandom | base64 | tr +/ -_ makes one),\n\
             or listen on 127.0.0.1",
        ))
    }

    /// Folder of the scans.
    ///
    /// # Errors
    /// [`Kind::Usage`] if none is configured and the environment gives no default.
    pub fn folder(&self) -> Result<PathBuf, Failure> {
        let var = |name| std::env::var_os(name).map(PathBuf::from);
        let service = || var("STATE_DIRECTORY").map(|state| state.join("scans"));
        let user = || {
            let state = var("XDG_STATE_HOME")
                .or_else(|| var("HOME").map(|home| home.join(".local/state")))?;
            Some(state.join("velomotion/scans"))
        };
        self.scans
            .clone()
            .or_else(service)
            .or_else(user)
            .ok_or_else(|| {
                Failure::new(
                    Kind::Usage,
                    "no folder for scans: neither $STATE_DIRECTORY nor $HOME is set",
                )
                .help("name one with scans = \"...\" under [daemon] of the configuration")
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(text: &str) -> Result<DaemonConfig, String> {
        toml::from_str(text).map_err(|error| error.to_string())
    }

    #[test]
    fn remote_addresses_need_a_token() {
        let open = DaemonConfig::default();
        for local in ["127.0.0.1:1", "127.8.0.1:1", "[::1]:1"] {
            assert!(open.check(local.parse().unwrap()).is_ok(), "{local}");
        }
        for other in ["0.0.0.0:1", "192.168.1.5:1", "[::]:1"] {
            let failure = open.check(other.parse().unwrap()).unwrap_err();
            assert_eq!(failure.kind, Kind::Usage, "{other}");
        }
        let closed = settings("token = '0123456789abcdef'").unwrap();
        assert!(closed.check("0.0.0.0:1".parse().unwrap()).is_ok());
    }

    #[test]
    fn tokens_have_a_minimum_length_and_are_not_printed() {
        assert!(settings("token = 'short'").unwrap_err().contains("16"));
        assert!(settings("token = '0123456789 abcdef'").is_err());
        let settings = settings("token = '0123456789abcdef'").unwrap();
        assert!(!format!("{settings:?}").contains("0123"));
        let token = settings.token.unwrap();
        assert!(token.is(b"0123456789abcdef"));
        for wrong in [
            "",
            "0123456789abcdeg",
            "0123456789abcde",
            "0123456789abcdef0123456789abcdef",
        ] {
            assert!(!token.is(wrong.as_bytes()), "{wrong}");
        }
    }

    #[test]
    fn misspelt_keys_are_refused() {
        assert!(settings("keep = 3").is_err());
        assert!(settings("listen = 'here'").is_err());
        assert!(settings("origins = ['scanner.example']").is_err());
    }
}
