//! The page of a daemon, and the sign-in form.

use std::sync::{Arc, LazyLock};
use std::time::Instant;

use axum::body::Bytes;
use axum::extract::{Request, State};
use axum::http::{Extensions, HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use engine::failure::Kind;

use super::api::Api;
use super::assets::{self, HTML, html};
use super::captures;
use super::guard::{NO_COOKIE, host_of};
use super::openapi::{Denied, Limit, NotNow, Usage};
use super::refusal::Refusal;

/// Whether a path needs no token: the sign-in page and its style.
#[must_use]
pub fn is_open(path: &str) -> bool {
    matches!(
        path,
        "/login" | "/logout" | "/health" | "/page.css" | "/icon.svg"
    )
}

/// The page.
#[utoipa::path(get, path = "/", tag = "page", responses((status = 200, body = String, content_type = "text/html")))]
pub async fn page(request: Request) -> Response {
    asset(request).await
}

/// Answers paths without a route.
pub async fn asset(request: Request) -> Response {
    assets::file(request.uri().path(), &request)
}

/// The sign-in page, for a request without a valid token.
pub fn sign_in() -> Response {
    let page = include_str!("../../web/dist/sign-in.html");
    html(StatusCode::UNAUTHORIZED, HTML, page)
}

/// The sign-in page that says that the token of its form was wrong.
fn sign_in_again() -> Response {
    static PAGE: LazyLock<String> = LazyLock::new(|| {
        let page = include_str!("../../web/dist/sign-in.html");
        page.replace(
            "<!-- refused -->",
            r#"<p class="refused" role="alert">The token was wrong.</p>"#,
        )
    });
    html(StatusCode::UNAUTHORIZED, HTML, PAGE.as_str())
}

/// Body of `POST /login`.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({"token": "the text of the token's file"}))]
struct Login {
    /// The daemon's token.
    token: String,
}

/// Sign in a browser: sets a cookie.
#[utoipa::path(post, path = "/login", tag = "page",
    request_body(content((Login = "application/json"), (Login = "application/x-www-form-urlencoded"))), responses(
    (status = 204, description = "Signed in"), (status = 303, description = "Signed in from a form"),
    (status = 400, response = Usage), (status = 401, response = Denied), (status = 409, response = NotNow),
    (status = 415, response = Usage), (status = 429, response = Limit),
))]
pub async fn login(
    State(api): State<Arc<Api>>,
    extensions: Extensions,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Refusal> {
    let content = headers
        .get(header::CONTENT_TYPE)
        .and_then(|c| c.to_str().ok());
    let form = content.is_some_and(|c| c.starts_with("application/x-www-form-urlencoded"));
    // A token has no character that a form would escape.
    let given = match form {
        true => {
            let body = String::from_utf8_lossy(&bytes).into_owned();
            let token = body.strip_prefix("token=").filter(|t| !t.contains('&'));
            token
                .ok_or_else(|| Refusal::usage("the form: expected token, and nothing else"))?
                .to_owned()
        }
        false => captures::body::<Login>(&headers, &bytes)?.token,
    };
    if let Some(token) = api.state.settings().token.as_ref() {
        let host = host_of(&extensions);
        let checked = api
            .sessions
            .check_token(token, given.as_bytes(), host, Instant::now());
        if let Err(refusal) = checked {
            let refusal = refusal.into_response();
            return Ok(match form && refusal.status() == StatusCode::UNAUTHORIZED {
                true => sign_in_again(),
                false => refusal,
            });
        }
    }
    let cookie = api.sessions.begin(&headers, api.secure).map_err(|error| {
        Refusal::new(
            StatusCode::CONFLICT,
            Kind::Incomplete,
            format!("cannot get random bytes from the system: {error}"),
            "use Authorization: Bearer TOKEN",
        )
    })?;
    Ok(match form {
        true => (
            StatusCode::SEE_OTHER,
            [
                (header::LOCATION, "/".to_owned()),
                (header::SET_COOKIE, cookie),
            ],
        )
            .into_response(),
        false => (StatusCode::NO_CONTENT, [(header::SET_COOKIE, cookie)]).into_response(),
    })
}

/// Sign a browser out.
#[utoipa::path(post, path = "/logout", tag = "page", responses((status = 204, description = "Signed out")))]
pub async fn logout(State(api): State<Arc<Api>>, headers: HeaderMap) -> Response {
    api.sessions.end(&headers);
    (StatusCode::NO_CONTENT, [(header::SET_COOKIE, NO_COOKIE)]).into_response()
}

/// Body of `GET /login`.
#[derive(Serialize, ToSchema)]
#[schema(example = json!({"signed_in": true}))]
struct SignedIn {
    /// Whether the browser is signed in.
    signed_in: bool,
}

/// Whether the browser is signed in.
#[utoipa::path(get, path = "/login", tag = "page", responses((status = 200, body = SignedIn)))]
pub async fn signed_in(State(api): State<Arc<Api>>, headers: HeaderMap) -> Response {
    let signed_in = api.sessions.includes(&headers);
    super::json(StatusCode::OK, &SignedIn { signed_in })
}
