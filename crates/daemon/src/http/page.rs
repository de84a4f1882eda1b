//! The page with its files from the binary, and the sign-in form.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write;
use std::sync::{Arc, LazyLock};
use std::time::Instant;

use axum::body::{Body, Bytes};
use axum::extract::{Request, State};
use axum::http::{Extensions, HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use flate2::write::GzEncoder;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use engine::failure::Kind;

use super::Api;
use super::accept::quality;
use super::captures;
use super::guard::{NO_COOKIE, host_of};
use super::openapi::{Denied, Limit, NotNow, Usage};
use super::partial::is_known;
use super::refusal::Refusal;

/// Path, content type, content.
type Asset = (&'static str, &'static str, &'static [u8]);

const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Files of the page (`web/build` makes them). They are in the binary because there may be no
/// network.
const ASSETS: [Asset; 6] = [
    ("/", HTML, include_bytes!("../../web/dist/index.html")),
    ("/page.js", SCRIPT, include_bytes!("../../web/dist/page.js")),
    (
        "/worker.js",
        SCRIPT,
        include_bytes!("../../web/dist/worker.js"),
    ),
    (
        "/page.css",
        "text/css; charset=utf-8",
        include_bytes!("../../web/dist/page.css"),
    ),
    (
        "/icon.svg",
        "image/svg+xml",
        include_bytes!("../../web/dist/icon.svg"),
    ),
    (
        "/LICENSES.txt",
        "text/plain; charset=utf-8",
        include_bytes!("../../web/dist/LICENSES.txt"),
    ),
];

/// What clients get of an asset.
struct CompressedFile {
    tag: String,
    gzip: Vec<u8>,
}

/// The assets' packed forms, in their order.
static PACKED: LazyLock<Vec<CompressedFile>> = LazyLock::new(|| {
    let pack = |(_, _, bytes): &Asset| {
        let mut hasher = DefaultHasher::new();
        bytes.hash(&mut hasher);
        let mut gzip = GzEncoder::new(Vec::new(), Compression::best());
        // Writing to memory does not fail.
        let _ = gzip.write_all(bytes);
        CompressedFile {
            tag: format!("\"{:016x}\"", hasher.finish()),
            gzip: gzip.finish().unwrap_or_default(),
        }
    };
    ASSETS.iter().map(pack).collect()
});

/// Content security policy: a page loads only files of this server.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; worker-src 'self'; \
                      base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

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
    file(request.uri().path(), &request)
}

/// The page for files instead of scans.
pub(super) fn page_of_files() -> Response {
    static PAGE: LazyLock<String> = LazyLock::new(|| {
        let page = include_str!("../../web/dist/index.html");
        page.replace(r#"data-page="daemon""#, r#"data-page="files""#)
    });
    html(StatusCode::OK, HTML, PAGE.as_str())
}

/// A file of the page at this path.
pub(super) fn file(path: &str, request: &Request) -> Response {
    let path = match path {
        "/index.html" => "/",
        path => path,
    };
    let mut assets = ASSETS.iter().zip(PACKED.iter());
    let Some(((_, content, bytes), packed)) = assets.find(|((own, ..), _)| *own == path) else {
        return Refusal::new(
            StatusCode::NOT_FOUND,
            Kind::NotFound,
            format!("there is nothing at {path}"),
            "GET /api/v1/openapi.json lists what there is",
        )
        .into_response();
    };
    if !matches!(*request.method(), Method::GET | Method::HEAD) {
        let mut response = super::no_method().into_response();
        let allow = HeaderValue::from_static("GET,HEAD");
        response.headers_mut().insert(header::ALLOW, allow);
        return response;
    }
    let mut headers = HeaderMap::new();
    headers.insert(header::VARY, HeaderValue::from_static("accept-encoding"));
    // An encoding is a version of its own.
    let accepted = request.headers().get(header::ACCEPT_ENCODING);
    let accepted = accepted.and_then(|value| value.to_str().ok());
    let is_packed = accepted.is_some_and(|accepted| quality(accepted, &["gzip", "*"]) > 0.0);
    let (tag, bytes) = match is_packed {
        true => {
            headers.insert(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"));
            (
                format!("{}-gzip\"", packed.tag.trim_end_matches('"')),
                &*packed.gzip,
            )
        }
        false => (packed.tag.clone(), *bytes),
    };
    if let Ok(value) = HeaderValue::from_str(&tag) {
        headers.insert(header::ETAG, value);
    }
    match is_known(request.headers(), &tag) {
        true => {
            headers.remove(header::CONTENT_ENCODING);
            (headers, html(StatusCode::NOT_MODIFIED, content, ())).into_response()
        }
        false => (headers, html(StatusCode::OK, content, bytes)).into_response(),
    }
}

fn html(status: StatusCode, content: &'static str, body: impl Into<Body>) -> Response {
    let headers = [
        (header::CONTENT_TYPE, content),
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-cache"),
    ];
    (status, headers, body.into()).into_response()
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
