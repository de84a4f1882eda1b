//! Refused and failed requests, all in the form of a failed command.

use axum::body::to_bytes;
use axum::extract::rejection::QueryRejection;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use engine::document::{Document, ErrorReport};
use engine::failure::{Failure, Kind};
#[cfg(devices)]
use engine::service::LeaseError;

use crate::limits::BODY_BYTES;

/// Seconds until another download, client or motion may have ended, or a device returned.
pub const RETRY_S: u32 = 5;

/// A refused request.
#[derive(Clone, Debug)]
pub struct Refusal {
    status: StatusCode,
    failure: Failure,
    /// After how many seconds the client may try again.
    retry_after_s: Option<u32>,
}

impl Refusal {
    /// A refusal with an error and what to do about it.
    #[must_use]
    pub fn new(
        status: StatusCode,
        kind: Kind,
        error: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Self {
            status,
            failure: Failure::new(kind, error).help(help),
            retry_after_s: None,
        }
    }

    /// The failure, without its place in HTTP.
    #[must_use]
    pub fn into_failure(self) -> Failure {
        self.failure
    }

    /// Adds when to try again.
    #[must_use]
    pub fn retry_after(self, s: u32) -> Self {
        Self {
            retry_after_s: Some(s),
            ..self
        }
    }

    /// Invalid request.
    #[must_use]
    pub fn usage(error: impl Into<String>) -> Self {
        Self::new(
            StatusCode::BAD_REQUEST,
            Kind::Usage,
            error,
            "GET /api/v1/openapi.json describes all requests",
        )
    }

    /// An answer that cannot be made.
    #[must_use]
    pub fn defect(error: impl Into<String>, help: &str) -> Self {
        Self::new(
            StatusCode::INTERNAL_SERVER_ERROR,
            Kind::Incomplete,
            error,
            help,
        )
    }

    /// No such scan.
    #[must_use]
    pub fn no_scan(id: &str) -> Self {
        Self::new(
            StatusCode::NOT_FOUND,
            Kind::NotFound,
            format!("there is no scan {id:?}"),
            "GET /api/v1/scans lists all scans",
        )
    }

    /// The scan has no such file.
    #[must_use]
    pub fn no_file(what: &str) -> Self {
        Self::new(
            StatusCode::NOT_FOUND,
            Kind::NotFound,
            format!("this scan has no {what}"),
            "see its state and why",
        )
    }

    /// Too little disk space.
    #[must_use]
    pub fn no_room(failure: Failure) -> Self {
        Self {
            status: StatusCode::INSUFFICIENT_STORAGE,
            retry_after_s: Some(RETRY_S),
            ..failure.into()
        }
    }

    /// Too many of something at once.
    #[must_use]
    pub fn too_many(what: &str) -> Self {
        Self::new(
            StatusCode::TOO_MANY_REQUESTS,
            Kind::Limit,
            format!("too many {what} at once"),
            "try again when others have ended",
        )
        .retry_after(RETRY_S)
    }
}

/// The response, with an error of the framework in the form of all others.
pub async fn in_one_form(response: Response) -> Response {
    let status = response.status();
    let content = response.headers().get(header::CONTENT_TYPE);
    let is_text = content.is_some_and(|content| content.as_bytes().starts_with(b"text/plain"));
    if !(is_text && (status.is_client_error() || status.is_server_error())) {
        return response;
    }
    let text = to_bytes(response.into_body(), BODY_BYTES).await;
    let text = String::from_utf8_lossy(&text.unwrap_or_default()).into_owned();
    Refusal {
        status,
        ..Refusal::usage(text)
    }
    .into_response()
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        let body = ErrorReport {
            error: self.failure,
        };
        let mut response = super::json(self.status, &body.to_json());
        if let Some(s) = self.retry_after_s {
            response.headers_mut().insert(header::RETRY_AFTER, s.into());
        }
        response
    }
}

impl From<Failure> for Refusal {
    /// Invalid requests are 400, failures of devices and disk 409.
    fn from(failure: Failure) -> Self {
        Self {
            status: match failure.kind {
                Kind::Usage => StatusCode::BAD_REQUEST,
                _ => StatusCode::CONFLICT,
            },
            failure,
            retry_after_s: None,
        }
    }
}

#[cfg(devices)]
impl From<LeaseError> for Refusal {
    fn from(error: LeaseError) -> Self {
        match error {
            LeaseError::Failure(failure) => failure.into(),
            LeaseError::Busy(task) => Self::new(
                StatusCode::CONFLICT,
                Kind::Busy,
                format!("the axis is busy: {}", task.description()),
                "wait until it is done, or stop it (velomotion tilt stop)",
            )
            .retry_after(RETRY_S),
        }
    }
}

impl From<QueryRejection> for Refusal {
    fn from(rejection: QueryRejection) -> Self {
        Self::usage(rejection.body_text())
    }
}
