//! Limits of every request.

use axum::body::{HttpBody, to_bytes};
use axum::extract::{Request, State};
use axum::http::{HeaderName, HeaderValue, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use engine::failure::Kind;

use super::refusal::{Refusal, in_one_form};
use crate::limits::{BODY_BYTES, HEAD_BYTES, HEADERS, TARGET_BYTES, Waits};

/// Refuses requests that are too long, or whose body takes too long.
pub async fn limits(State(waits): State<Waits>, request: Request, next: Next) -> Response {
    let target = request
        .uri()
        .path_and_query()
        .map_or(0, |t| t.as_str().len());
    if target > TARGET_BYTES {
        return Refusal::new(
            StatusCode::URI_TOO_LONG,
            Kind::Limit,
            format!("path and query have more than {TARGET_BYTES} bytes"),
            "no request needs as much",
        )
        .into_response();
    }
    let headers = request.headers();
    let length = |(name, value): (&HeaderName, &HeaderValue)| name.as_str().len() + value.len();
    if headers.len() > HEADERS || headers.iter().map(length).sum::<usize>() > HEAD_BYTES {
        return Refusal::new(
            StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE,
            Kind::Limit,
            format!(
                "the request has more than {HEADERS} headers, or more than {HEAD_BYTES} bytes of them"
            ),
            "no request needs as many",
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
            Kind::Limit,
            format!("the body has more than {BODY_BYTES} bytes, or did not come whole"),
            "no request needs as much",
        )
        .into_response()
    };
    if body.size_hint().lower() > BODY_BYTES as u64 {
        return too_large();
    }
    match tokio::time::timeout(waits.body, to_bytes(body, BODY_BYTES)).await {
        Ok(Ok(bytes)) => in_one_form(next.run(Request::from_parts(head, bytes.into())).await).await,
        Ok(Err(_)) => too_large(),
        Err(_elapsed) => Refusal::new(
            StatusCode::REQUEST_TIMEOUT,
            Kind::Limit,
            "the body did not come in time",
            "send it at once",
        )
        .into_response(),
    }
}
