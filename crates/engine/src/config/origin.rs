//! Origin of a web page: scheme, host and port (RFC 6454), as in the header `Origin`.

use std::str::FromStr;

use serde::Deserialize;

/// An origin.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct Origin {
    secure: bool,
    /// Lower case.
    host: String,
    port: u16,
}

impl Origin {
    /// Origin of the pages of a server addressed as `host`, with TLS if `secure`: a name, with a
    /// port unless it is the usual one.
    #[must_use]
    pub fn of_host(secure: bool, host: &str) -> Option<Self> {
        Self::new(secure, host)
    }

    fn new(secure: bool, authority: &str) -> Option<Self> {
        let (host, port) = match authority.rsplit_once(':') {
            // Colons in brackets belong to an IPv6 address.
            Some((host, port)) if !port.ends_with(']') => (host, Some(port)),
            _ => (authority, None),
        };
        let usual = if secure { 443 } else { 80 };
        let port = match port {
            None => usual,
            Some(digits) if digits.bytes().all(|byte| byte.is_ascii_digit()) => {
                digits.parse().ok().filter(|&port| port > 0)?
            }
            Some(_) => return None,
        };
        let is_host = match host.strip_prefix('[').and_then(|ip| ip.strip_suffix(']')) {
            Some(ip) => ip.parse::<std::net::Ipv6Addr>().is_ok(),
            None => {
                let allowed = |byte: u8| byte.is_ascii_alphanumeric() || b"-._".contains(&byte);
                !host.is_empty() && host.bytes().all(allowed)
            }
        };
        is_host.then(|| Self {
            secure,
            host: host.to_ascii_lowercase(),
            port,
        })
    }
}

impl FromStr for Origin {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once("://");
        let origin = parts.and_then(|(scheme, authority)| {
            let secure = scheme.eq_ignore_ascii_case("https");
            let is_http = secure || scheme.eq_ignore_ascii_case("http");
            is_http.then(|| Self::new(secure, authority)).flatten()
        });
        origin.ok_or_else(|| {
            format!("origin {text:?}: expected http:// or https://, a host, and a port if it is not the usual one; no path")
        })
    }
}

impl TryFrom<String> for Origin {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scheme_host_and_port_make_an_origin() {
        let of = |text: &str| text.parse::<Origin>().unwrap();
        assert_eq!(of("http://a.example"), of("HTTP://A.EXAMPLE:80"));
        assert_eq!(of("https://a.example"), of("https://a.example:443"));
        assert_eq!(of("http://[::1]"), of("http://[::1]:80"));
        assert_ne!(of("https://a.example"), of("http://a.example"));
        assert_ne!(of("https://a.example:80"), of("http://a.example:80"));
        assert_ne!(of("http://a.example"), of("http://a.example:8016"));
        assert_ne!(of("http://a.example"), of("http://b.example"));
        assert_eq!(
            Origin::of_host(false, "a.example:8016"),
            Some(of("http://a.example:8016"))
        );
    }

    #[test]
    fn invalid_origins_are_refused() {
        for text in [
            "",
            "null",
            "*",
            "a.example",
            "ftp://a.example",
            "file://",
            "http://",
            "http://:80",
            "http://a.example/",
            "http://a.example:",
            "http://a.example:0",
            "http://a.example:99999",
            "http://a.example:+80",
            "http://u@a.example",
            "http://[::1",
            "http://::1",
            "http://[a]",
            "https://a.example https://b.example",
        ] {
            assert!(text.parse::<Origin>().is_err(), "{text}");
        }
        for host in ["", "a.example/", "a b"] {
            assert_eq!(Origin::of_host(false, host), None, "{host}");
        }
    }
}
