//! Whatever is refused or goes wrong, in one form: error, help, kind.

use std::fmt;

use axum::extract::rejection::QueryRejection;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde::Serialize;

use crate::shared::Refused;
use crate::view::Doing;
use engine::failure::{Failure, Kind};

/// An answer that says no.
#[derive(Clone, Debug, Serialize)]
pub struct Refusal {
    #[serde(skip)]
    status: StatusCode,
    error: String,
    help: Option<String>,
    kind: &'static str,
}

impl Refusal {
    /// One that says so.
    #[must_use]
    pub fn new(
        status: StatusCode,
        kind: &'static str,
        error: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Self {
            status,
            error: error.into(),
            help: Some(help.into()),
            kind,
        }
    }

    /// Whether the axis is busy: it may be free a moment later.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.kind == "busy"
    }

    /// What was asked for cannot be.
    #[must_use]
    pub fn usage(error: impl Into<String>) -> Self {
        Self::new(
            StatusCode::BAD_REQUEST,
            "usage",
            error,
            "GET /api/v1/openapi.json says what there is to ask for",
        )
    }

    /// No such scan.
    #[must_use]
    pub fn no_scan(id: &str) -> Self {
        Self::new(
            StatusCode::NOT_FOUND,
            "not-found",
            format!("there is no scan {id:?}"),
            "GET /api/v1/scans lists those that there are",
        )
    }

    /// The scan has no such file.
    #[must_use]
    pub fn no_file(what: &str) -> Self {
        Self::new(
            StatusCode::NOT_FOUND,
            "not-found",
            format!("this scan has no {what}"),
            "its state and why say more",
        )
    }

    /// Too little room on the disk.
    #[must_use]
    pub fn no_room(failure: Failure) -> Self {
        Self {
            status: StatusCode::INSUFFICIENT_STORAGE,
            ..failure.into()
        }
    }

    /// Too many at once.
    #[must_use]
    pub fn too_many(what: &str) -> Self {
        Self::new(
            StatusCode::TOO_MANY_REQUESTS,
            "limit",
            format!("too many {what} at once"),
            "try again when others have ended",
        )
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.error)?;
        match &self.help {
            Some(help) => write!(f, " ({help})"),
            None => Ok(()),
        }
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        super::json(self.status, &self)
    }
}

impl From<Failure> for Refusal {
    /// What a person asked for in vain is 400, what the devices or the disk do not do now 409.
    fn from(failure: Failure) -> Self {
        let (status, kind) = match failure.kind {
            Kind::Usage => (StatusCode::BAD_REQUEST, "usage"),
            Kind::BadInput => (StatusCode::CONFLICT, "bad-input"),
            Kind::NoDevice => (StatusCode::CONFLICT, "no-device"),
            Kind::DeviceFault => (StatusCode::CONFLICT, "device-fault"),
            Kind::Incomplete => (StatusCode::CONFLICT, "incomplete"),
            Kind::Interrupted => (StatusCode::CONFLICT, "interrupted"),
        };
        Self {
            status,
            error: failure.message,
            help: failure.help,
            kind,
        }
    }
}

impl From<Refused> for Refusal {
    fn from(refused: Refused) -> Self {
        match refused {
            Refused::Failure(failure) => failure.into(),
            Refused::Busy(doing) => Self::new(
                StatusCode::CONFLICT,
                "busy",
                format!(
                    "the axis is busy: {}",
                    match doing {
                        Doing::Capturing => "a scan is recorded",
                        Doing::Homing => "it is homing",
                        Doing::Moving => "it moves",
                        Doing::Connecting => "the drive is being set up",
                        Doing::Stopping | Doing::Idle => "it is being stopped",
                    }
                ),
                "wait until it is done, or stop it (POST /api/v1/tilt/stop, tilt stop)",
            ),
        }
    }
}

impl From<QueryRejection> for Refusal {
    fn from(rejection: QueryRejection) -> Self {
        Self::usage(rejection.body_text())
    }
}
