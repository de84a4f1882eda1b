//! The page's files, from the binary.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write;
use std::sync::LazyLock;

use axum::body::Body;
use axum::extract::Request;
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use engine::failure::Kind;
use flate2::Compression;
use flate2::write::GzEncoder;

use super::accept::quality;
use super::partial::is_known;
use super::refusal::Refusal;

/// Path, content type, content.
type Asset = (&'static str, &'static str, &'static [u8]);

/// Content type of a page.
pub const HTML: &str = "text/html; charset=utf-8";
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

/// Asset as it is sent to clients.
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

/// The page for files instead of scans.
pub fn page_of_files() -> Response {
    static PAGE: LazyLock<String> = LazyLock::new(|| {
        let page = include_str!("../../web/dist/index.html");
        page.replace(r#"data-page="daemon""#, r#"data-page="files""#)
    });
    html(StatusCode::OK, HTML, PAGE.as_str())
}

/// A file of the page at this path.
pub fn file(path: &str, request: &Request) -> Response {
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

/// A response with a file of the page.
pub fn html(status: StatusCode, content: &'static str, body: impl Into<Body>) -> Response {
    let headers = [
        (header::CONTENT_TYPE, content),
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-cache"),
    ];
    (status, headers, body.into()).into_response()
}
