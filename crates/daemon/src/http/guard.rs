//! Authorisation of requests by token, browser cookie, Origin and Host, and their length limits.
//!
//! On the Unix socket its file permissions decide alone.

use std::collections::VecDeque;
use std::io::Read;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};

use axum::body::{HttpBody, to_bytes};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::Api;
use super::connection_limits::{Connection, Trust};
use super::page;
use super::refusal::{Reason, Refusal, in_one_form};
use crate::limits::{BODY_BYTES, SIGNED_IN, TARGET_BYTES, Waits};
use engine::config::daemon::equal;
use engine::config::origin::Origin;

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
const SECRET_BYTES: usize = 16;

/// Secrets of the browsers that are signed in, until the daemon ends.
#[derive(Debug, Default)]
pub struct Sessions {
    secrets: Mutex<VecDeque<String>>,
}

impl Sessions {
    /// Signs a browser in: the cookie to set.
    ///
    /// # Errors
    /// Where the system provides no random bytes.
    pub fn begin(&self) -> std::io::Result<String> {
        let mut random = [0; SECRET_BYTES];
        std::fs::File::open("/dev/urandom")?.read_exact(&mut random)?;
        let secret: String = random.iter().map(|byte| format!("{byte:02x}")).collect();
        let mut secrets = self.secrets.lock().unwrap_or_else(PoisonError::into_inner);
        if secrets.len() >= SIGNED_IN {
            secrets.pop_front();
        }
        secrets.push_back(secret.clone());
        Ok(format!(
            "{COOKIE}={secret}; Path=/; Max-Age={COOKIE_S}; HttpOnly; SameSite=Strict"
        ))
    }

    fn has(&self, given: &str) -> bool {
        let secrets = self.secrets.lock().unwrap_or_else(PoisonError::into_inner);
        // All are compared, so that the time taken tells nothing.
        secrets.iter().fold(false, |found, secret| {
            found | equal(secret.as_bytes(), given.as_bytes())
        })
    }
}

/// Refuses requests that are too long, or whose body takes too long.
pub async fn limits(State(waits): State<Waits>, request: Request, next: Next) -> Response {
    let target = request
        .uri()
        .path_and_query()
        .map_or(0, |t| t.as_str().len());
    if target > TARGET_BYTES {
        return Refusal::new(
            StatusCode::URI_TOO_LONG,
            Reason::Limit,
            format!("path and query have more than {TARGET_BYTES} bytes"),
            "no request needs as much",
        )
        .into_response();
    }
    let (head, body) = request.into_parts();
    if body.is_end_stream() {
        return in_one_form(next.run(Request::from_parts(head, body)).await).await;
    }
    let too_large = || {
        Refusal::new(
            StatusCode::PAYLOAD_TOO_LARGE,
            Reason::Limit,
            format!("the body has more than {BODY_BYTES} bytes, or did not come whole"),
            "no request needs as much",
        )
        .into_response()
    };
    if body.size_hint().lower() > BODY_BYTES as u64 {
        return too_large();
    }
    match tokio::time::timeout(waits.body, to_bytes(body, BODY_BYTES)).await {
        Ok(Ok(bytes)) => {
            in_one_form(next.run(Request::from_parts(head, bytes.into())).await).await
        }
        Ok(Err(_)) => too_large(),
        Err(_elapsed) => Refusal::new(
            StatusCode::REQUEST_TIMEOUT,
            Reason::Limit,
            "the body did not come in time",
            "send it at once",
        )
        .into_response(),
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
        Err(refusal) if wants_page(&request) && refusal.1 => {
            super::page::sign_in(StatusCode::UNAUTHORIZED).into_response()
        }
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
                "use http://127.0.0.1, or set a token to let others in under another name",
            ),
            false,
        ));
    }
    // The handshake of a WebSocket is a GET that browsers let any page make.
    let changes = !matches!(*request.method(), Method::GET | Method::HEAD)
        || headers.contains_key(header::UPGRADE);
    if changes && let Some(origin) = headers.get(header::ORIGIN) {
        let origin = origin.to_str().unwrap_or_default();
        if !may_change(origin, host, &api.state.settings().origins) {
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
    let bearer = text(headers, header::AUTHORIZATION)
        .and_then(|value| value.split_once(' '))
        .filter(|(scheme, _)| scheme.eq_ignore_ascii_case("bearer"))
        .is_some_and(|(_, given)| token.is(given.trim().as_bytes()));
    if bearer || cookie(headers).is_some_and(|secret| api.sessions.has(secret)) {
        return Ok(Trust::Token);
    }
    Err((
        Refusal::new(
            StatusCode::UNAUTHORIZED,
            Reason::Denied,
            "the token is missing or wrong",
            "send Authorization: Bearer TOKEN with the token of the daemon's configuration",
        ),
        true,
    ))
}

/// Whether a page of this origin may request changes: the daemon's own at `host`, or a `listed`
/// one.
fn may_change(origin: &str, host: &str, listed: &[Origin]) -> bool {
    origin.parse().is_ok_and(|origin: Origin| {
        Origin::of_host(host).as_ref() == Some(&origin) || listed.contains(&origin)
    })
}

fn denied(error: String, help: &str) -> Refusal {
    Refusal::new(StatusCode::FORBIDDEN, Reason::Denied, error, help)
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
    fn the_oldest_session_is_dropped() {
        let sessions = Sessions::default();
        let secret = |cookie: &str| cookie.split(['=', ';']).nth(1).unwrap().to_owned();
        let first = secret(&sessions.begin().unwrap());
        assert!(sessions.has(&first) && !sessions.has("") && !sessions.has(&first[1..]));
        for _ in 0..SIGNED_IN {
            sessions.begin().unwrap();
        }
        assert!(!sessions.has(&first));
    }
}
