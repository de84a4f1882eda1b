//! `[daemon]`: listening address, access, storage of scans.

use std::fmt;
use std::hint::black_box;
use std::net::{Ipv4Addr, SocketAddr};
#[cfg(devices)]
use std::path::Path;
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
    /// File with the token.
    pub token_file: Option<PathBuf>,
    /// File with the certificate and its chain (PEM): TCP is encrypted.
    pub certificate: Option<PathBuf>,
    /// File with the certificate's private key (PEM).
    pub certificate_key: Option<PathBuf>,
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
    #[serde(deserialize_with = "super::ros2::table")]
    pub ros2: Option<Ros2>,
}

impl Default for DaemonConfig {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, PORT)),
            token: None,
            token_file: None,
            certificate: None,
            certificate_key: None,
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

/// Warns if other users can read or change a file that holds a secret. Returns whether they can.
#[cfg(devices)]
pub fn warn_if_exposed(secret: &str, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    // Bits of group and others.
    let readable = std::fs::metadata(path).is_ok_and(|there| there.mode() & 0o066 != 0);
    if readable {
        tracing::warn!(
            "other users can read or change the {secret} in {}: move it to a file of its own, chmod 600",
            path.display()
        );
    }
    readable
}

impl DaemonConfig {
    /// Reads the token of `token_file`, or of the file `token` in systemd's folder of credentials
    /// (systemd.exec(5), LoadCredential), and finds `certificate` and `certificate_key` there.
    ///
    /// # Errors
    /// [`Kind::BadInput`] for an unusable file, [`Kind::Usage`] for two tokens.
    #[cfg(devices)]
    pub fn load_credentials(&mut self, credentials: Option<&Path>) -> Result<(), Failure> {
        let credential = |name| {
            let path = credentials.map(|folder| folder.join(name));
            path.filter(|path| path.exists())
        };
        self.certificate = self.certificate.take().or(credential("certificate"));
        let key = self.certificate_key.take();
        self.certificate_key = key.or(credential("certificate_key"));
        let Some(path) = self.token_file.clone().or(credential("token")) else {
            return Ok(());
        };
        if self.token.is_some() {
            let message = format!(
                "two tokens: [daemon] token, and the file {}",
                path.display()
            );
            return Err(Failure::new(Kind::Usage, message).help("remove one of them"));
        }
        let wrong = |what: String| {
            let message = format!("the token in {}: {what}", path.display());
            Failure::new(Kind::BadInput, message)
                .help("write the token alone into the file; see man velomotion-daemon")
        };
        // Opening a pipe waits for a writer.
        if std::fs::metadata(&path).is_ok_and(|there| !there.is_file()) {
            return Err(wrong("not a regular file".to_owned()));
        }
        let text = std::fs::read_to_string(&path).map_err(|error| wrong(error.to_string()))?;
        self.token = Some(Token::try_from(text.trim().to_owned()).map_err(wrong)?);
        // Credentials are in a folder of their own that others cannot enter.
        if self.token_file.is_some() {
            warn_if_exposed("token", &path);
        }
        Ok(())
    }

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
            "set token_file = \"...\" under [daemon] of the configuration (umask 77; head -c 24 /dev/urandom | base64 | tr +/ -_ > FILE makes one), \
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

    #[cfg(devices)]
    #[test]
    fn tokens_come_from_a_file_or_a_credential() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("token");
        std::fs::write(&file, "0123456789abcdef\n").unwrap();
        let mode = |bits| std::fs::set_permissions(&file, PermissionsExt::from_mode(bits)).unwrap();
        mode(0o600);
        assert!(!warn_if_exposed("token", &file));
        for others in [0o640, 0o602] {
            mode(others);
            assert!(warn_if_exposed("token", &file));
        }
        let from_file = format!("token_file = {file:?}");
        for (text, credentials) in [(from_file.as_str(), None), ("", Some(folder.path()))] {
            let mut config = settings(text).unwrap();
            config.load_credentials(credentials).unwrap();
            assert!(config.token.unwrap().is(b"0123456789abcdef"), "{text}");
        }
        let mut both = settings(&format!("{from_file}\ntoken = '0123456789abcdef'")).unwrap();
        assert_eq!(both.load_credentials(None).unwrap_err().kind, Kind::Usage);
        std::fs::write(&file, "short").unwrap();
        let failure = settings(&from_file)
            .unwrap()
            .load_credentials(None)
            .unwrap_err();
        assert!(failure.message.contains("16"), "{failure:?}");
        assert!(!failure.message.contains("short"), "{failure:?}");
        // Nothing but a file: a pipe would be waited for.
        let folder = format!("token_file = {:?}", folder.path());
        let failure = settings(&folder)
            .unwrap()
            .load_credentials(None)
            .unwrap_err();
        assert!(
            failure.message.contains("not a regular file"),
            "{failure:?}"
        );
        let mut none = settings("").unwrap();
        none.load_credentials(Some(Path::new("/nonexistent")))
            .unwrap();
        assert_eq!(none.token, None);
    }

    #[test]
    fn misspelt_keys_are_refused() {
        assert!(settings("keep = 3").is_err());
        assert!(settings("listen = 'here'").is_err());
        assert!(settings("origins = ['scanner.example']").is_err());
    }
}
