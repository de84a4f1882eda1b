//! Authorisation of requests by token, browser cookie, Origin and Host, and their length limits.
//!
//! On the Unix socket its file permissions decide alone.

use std::collections::VecDeque;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use axum::extract::{Request, State};
use axum::http::{Extensions, HeaderMap, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::api::Api;
use super::connection_limits::{Connection, Trust};
use super::page;
use super::refusal::Refusal;
use super::secret::secret;
use crate::limits::{SIGNED_IN, WRONG_TOKENS, WRONG_TOKENS_WITHIN};
use engine::config::daemon::Token;
use engine::config::daemon::equal;
use engine::config::origin::Origin;
use engine::failure::Kind;

/// Transport of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Peer {
    /// Over the Unix socket.
    Local,
    /// Over TCP, to this address.
    Tcp(IpAddr),
}

/// The cookie's name.
const COOKIE: &str = "velomotion";
/// Lifetime of the cookie: 30 days.
const COOKIE_S: u32 = 30 * 24 * 3600;
/// Wrong tokens that are remembered of all hosts.
const MOST_WRONG: usize = 10_000;
/// The cookie of a browser that is signed out.
pub const NO_COOKIE: &str = "velomotion=; Path=/; Max-Age=0; HttpOnly; SameSite=Strict";

/// Secrets of the browsers that are signed in, until the daemon ends.
#[derive(Debug, Default)]
pub struct Sessions {
    secrets: Mutex<VecDeque<String>>,
    /// The hosts of wrong tokens and their times, oldest first.
    wrong: Mutex<VecDeque<(Option<IpAddr>, Instant)>>,
}

impl Sessions {
    /// Compares a token from a host.
    ///
    /// # Errors
    /// [`Refusal`] for a wrong one, and for any after too many wrong ones.
    pub fn check_token(
        &self,
        token: &Token,
        given: &[u8],
        host: Option<IpAddr>,
        now: Instant,
    ) -> Result<(), Refusal> {
        let mut wrong = self.wrong.lock().unwrap_or_else(PoisonError::into_inner);
        while let Some(&(_, at)) = wrong.front()
            && now.saturating_duration_since(at) >= WRONG_TOKENS_WITHIN
        {
            wrong.pop_front();
        }
        let tries = wrong.iter().filter(|(other, _)| *other == host).count();
        if tries >= WRONG_TOKENS {
            return Err(Refusal::new(
                StatusCode::TOO_MANY_REQUESTS,
                Kind::Limit,
                format!("{tries} wrong tokens in the last minute"),
                "try again in a minute",
            )
            .retry_after(60));
        }
        if token.is(given) {
            return Ok(());
        }
        if wrong.len() >= MOST_WRONG {
            wrong.pop_front();
        }
        wrong.push_back((host, now));
        let from = host.map_or("this machine".to_owned(), |host| host.to_string());
        tracing::warn!("wrong token from {from}, {} in the last minute", tries + 1);
        Err(Refusal::new(
            StatusCode::UNAUTHORIZED,
            Kind::Denied,
            "the token is missing or wrong",
            "send Authorization: Bearer TOKEN with the token of the daemon's configuration",
        ))
    }

    /// Signs a browser out.
    pub fn end(&self, headers: &HeaderMap) {
        let mut secrets = self.secrets.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(given) = cookie(headers) {
            secrets.retain(|secret| !equal(secret.as_bytes(), given.as_bytes()));
        }
    }

    /// Signs a browser in: the cookie to set, for TLS only if the browser came over TLS, that of
    /// the daemon (`secure`) or of a proxy.
    ///
    /// # Errors
    /// Where the system provides no random bytes.
    pub fn begin(&self, headers: &HeaderMap, secure: bool) -> std::io::Result<String> {
        let secret = secret()?;
        let mut secrets = self.secrets.lock().unwrap_or_else(PoisonError::into_inner);
        if secrets.len() >= SIGNED_IN {
            secrets.pop_front();
        }
        secrets.push_back(secret.clone());
        // Browsers name the origin.
        let origin = text(headers, header::ORIGIN).unwrap_or_default();
        let secure = if secure || origin.starts_with("https://") {
            "; Secure"
        } else {
            ""
        };
        Ok(format!(
            "{COOKIE}={secret}; Path=/; Max-Age={COOKIE_S}; HttpOnly; SameSite=Strict{secure}"
        ))
    }

    /// Whether a request has the cookie of a session.
    pub fn includes(&self, headers: &HeaderMap) -> bool {
        cookie(headers).is_some_and(|secret| self.has(secret))
    }

    fn has(&self, given: &str) -> bool {
        let secrets = self.secrets.lock().unwrap_or_else(PoisonError::into_inner);
        // All are compared, so that the time taken tells nothing.
        secrets.iter().fold(false, |found, secret| {
            found | equal(secret.as_bytes(), given.as_bytes())
        })
    }
}

/// Refuses requests without authorisation.
pub async fn guard(
    State((api, peer)): State<(Arc<Api>, Peer)>,
    request: Request,
    next: Next,
) -> Response {
    match check(&api, peer, &request) {
        Ok(trust) => {
            if let Some(connection) = request.extensions().get::<Arc<Connection>>() {
                connection.raise(trust);
            }
            next.run(request).await
        }
        // A browser gets the page that signs in.
        Err(refusal) if wants_page(&request) && refusal.1 => super::page::sign_in(),
        Err((refusal, _)) => refusal.into_response(),
    }
}

fn wants_page(request: &Request) -> bool {
    let accept = text(request.headers(), header::ACCEPT);
    request.method() == Method::GET && accept.is_some_and(|accept| accept.contains("text/html"))
}

fn text(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    headers.get(name)?.to_str().ok()
}

/// The trust that a request proves; or the refusal, and whether signing in would help.
fn check(api: &Api, peer: Peer, request: &Request) -> Result<Trust, (Refusal, bool)> {
    let Peer::Tcp(own) = peer else {
        return Ok(Trust::Local);
    };
    let (headers, path) = (request.headers(), request.uri().path());
    let token = api.state.settings().token.as_ref();
    let host = text(headers, header::HOST).unwrap_or_default();
    if token.is_none() && !is_own_name(host, own) {
        return Err((
            denied(
                format!("{host:?} is not a name of this daemon"),
                "use http://127.0.0.1, or set a token to allow other host names",
            ),
            false,
        ));
    }
    // The handshake of a WebSocket is a GET that browsers let any page make.
    let changes = !matches!(*request.method(), Method::GET | Method::HEAD)
        || headers.contains_key(header::UPGRADE);
    if changes && let Some(origin) = headers.get(header::ORIGIN) {
        let origin = origin.to_str().unwrap_or_default();
        let page = Origin::of_host(api.secure, host);
        if !may_change(origin, page.as_ref(), &api.state.settings().origins) {
            return Err((
                denied(
                    format!("a page of {origin:?} is not allowed to do this"),
                    "use the daemon's own page, or a program that sends no Origin; a proxy with TLS in front of the daemon is named by \
                     origins = [\"https://...\"] under [daemon] of the configuration",
                ),
                false,
            ));
        }
    }
    if page::is_open(path) {
        return Ok(Trust::None);
    }
    let Some(token) = token else {
        return Ok(Trust::Local);
    };
    if api.sessions.includes(headers) {
        return Ok(Trust::Token);
    }
    let bearer = text(headers, header::AUTHORIZATION)
        .and_then(|value| value.split_once(' '))
        .filter(|(scheme, _)| scheme.eq_ignore_ascii_case("bearer"));
    if let Some((_, given)) = bearer {
        let given = given.trim().as_bytes();
        let checked =
            api.sessions
                .check_token(token, given, host_of(request.extensions()), Instant::now());
        return checked
            .map(|()| Trust::Token)
            .map_err(|refusal| (refusal, true));
    }
    Err((
        Refusal::new(
            StatusCode::UNAUTHORIZED,
            Kind::Denied,
            "the token is missing or wrong",
            "send Authorization: Bearer TOKEN with the token of the daemon's configuration",
        ),
        true,
    ))
}

/// The remote host of a request; absent for this machine.
pub fn host_of(extensions: &Extensions) -> Option<IpAddr> {
    extensions.get::<Arc<Connection>>()?.host()
}

/// Whether a page of this origin may request changes: the daemon's `own`, or a `listed` one.
fn may_change(origin: &str, own: Option<&Origin>, listed: &[Origin]) -> bool {
    let parsed: Result<Origin, _> = origin.parse();
    parsed.is_ok_and(|origin| own == Some(&origin) || listed.contains(&origin))
}

fn denied(error: String, help: &str) -> Refusal {
    Refusal::new(StatusCode::FORBIDDEN, Kind::Denied, error, help)
}

fn cookie(headers: &HeaderMap) -> Option<&str> {
    let cookies = text(headers, header::COOKIE)?.split(';');
    cookies
        .filter_map(|pair| pair.trim().split_once('='))
        .find_map(|(name, value)| (name == COOKIE).then_some(value))
}

/// Whether `host` names this machine without DNS, which another machine could answer.
fn is_own_name(host: &str, own: IpAddr) -> bool {
    let name = match host.strip_prefix('[') {
        Some(rest) => rest.split_once(']').map_or(rest, |(name, _)| name),
        None => host.split_once(':').map_or(host, |(name, _)| name),
    };
    name.eq_ignore_ascii_case("localhost")
        || name
            .parse::<IpAddr>()
            .is_ok_and(|ip| ip.is_loopback() || ip == own)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn host_names_of_this_machine_are_recognised() {
        let own: IpAddr = "127.0.0.1".parse().unwrap();
        for host in [
            "localhost",
            "LOCALHOST:80",
            "127.0.0.1:8016",
            "[::1]:1",
            "127.3.2.1",
            "[::1]",
        ] {
            assert!(is_own_name(host, own), "{host}");
        }
        for host in [
            "",
            "evil.example",
            "localhost.evil.example",
            "127.0.0.1.evil.example:80",
            "10.0.0.1",
            "[fe80::1]",
        ] {
            assert!(!is_own_name(host, own), "{host}");
        }
    }

    #[test]
    fn tokens_are_refused_for_a_minute_after_too_many_wrong_ones() {
        let (sessions, begin) = (Sessions::default(), Instant::now());
        let token = Token::try_from("0123456789abcdef".to_owned()).unwrap();
        let guess = |given: &str, host: [u8; 4], s: u64| {
            let at = begin + std::time::Duration::from_secs(s);
            let checked = sessions.check_token(&token, given.as_bytes(), Some(host.into()), at);
            checked.map_err(|refusal| refusal.into_response().status().as_u16())
        };
        let (one, other) = ([10, 0, 0, 1], [10, 0, 0, 2]);
        for s in 0..WRONG_TOKENS as u64 {
            assert_eq!(guess("0123456789abcdee", one, s), Err(401));
        }
        assert_eq!(guess("0123456789abcdef", one, 11), Err(429));
        assert_eq!(guess("0123456789abcdef", other, 11), Ok(()));
        assert_eq!(guess("0123456789abcdef", one, 60), Ok(()));
    }

    #[test]
    fn the_oldest_session_is_dropped() {
        let sessions = Sessions::default();
        let secret = |cookie: &str| cookie.split(['=', ';']).nth(1).unwrap().to_owned();
        let headers = HeaderMap::new();
        let first = secret(&sessions.begin(&headers, false).unwrap());
        assert!(sessions.has(&first) && !sessions.has("") && !sessions.has(&first[1..]));
        for _ in 0..SIGNED_IN {
            sessions.begin(&headers, false).unwrap();
        }
        assert!(!sessions.has(&first));
    }
}
