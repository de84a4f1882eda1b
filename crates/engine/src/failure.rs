//! Failures: kind, message, and what to do next. Clients of the engine print them.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};
use thiserror::Error;
use utoipa::openapi::{RefOr, Schema};
use utoipa::{PartialSchema, ToSchema};

/// Kind of a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The request is invalid.
    Usage,
    /// A file is missing or invalid.
    BadInput,
    /// A device is absent.
    NoDevice,
    /// A device reports a fault or does not answer.
    DeviceFault,
    /// The result is incomplete; what was captured is saved.
    Incomplete,
    /// The user stopped the work; what was captured is saved.
    Interrupted,
    /// The axis is in use.
    Busy,
    /// The daemon has no such scan, file or path.
    NotFound,
    /// The daemon does not allow it.
    Denied,
    /// A limit of the daemon is exceeded.
    Limit,
}

impl Kind {
    /// Exit code of the process.
    #[must_use]
    pub const fn exit_code(self) -> u8 {
        match self {
            Self::Usage => 2,
            Self::BadInput => 3,
            Self::NoDevice | Self::Busy | Self::NotFound | Self::Denied | Self::Limit => 4,
            Self::DeviceFault => 5,
            Self::Incomplete => 6,
            Self::Interrupted => 130,
        }
    }
}

/// A failure. In JSON it has its exit code, too.
#[derive(Clone, Debug, PartialEq, Error, Serialize, Deserialize)]
#[serde(into = "FailureObject")]
#[error("{message}")]
pub struct Failure {
    /// Kind, which determines the exit code.
    pub kind: Kind,
    /// What is wrong, where, what was expected and found.
    // Scans of earlier versions call it `error`.
    #[serde(alias = "error")]
    pub message: String,
    /// What to do next.
    pub help: Option<String>,
}

/// A failure in the output of commands and of the daemon.
#[derive(Serialize, ToSchema)]
struct FailureObject {
    /// Kind, which determines the exit code.
    kind: Kind,
    /// What is wrong, where, what was expected and found.
    message: String,
    /// What to do next.
    help: Option<String>,
    /// Exit code of a command that fails with it.
    exit_code: u8,
}

impl From<Failure> for FailureObject {
    fn from(failure: Failure) -> Self {
        Self {
            kind: failure.kind,
            message: failure.message,
            help: failure.help,
            exit_code: failure.kind.exit_code(),
        }
    }
}

impl PartialSchema for Failure {
    fn schema() -> RefOr<Schema> {
        FailureObject::schema()
    }
}

impl ToSchema for Failure {
    fn name() -> Cow<'static, str> {
        "Failure".into()
    }

    fn schemas(schemas: &mut Vec<(String, RefOr<Schema>)>) {
        FailureObject::schemas(schemas);
    }
}

impl Failure {
    /// Creates a failure without help.
    #[must_use]
    pub fn new(kind: Kind, message: impl Into<String>) -> Self {
        Self {
            kind,
            message: message.into(),
            help: None,
        }
    }

    /// Adds what to do next.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Adds warnings before what to do next.
    #[must_use]
    pub fn warned(mut self, warnings: Vec<String>) -> Self {
        let lines: Vec<String> = warnings.into_iter().chain(self.help).collect();
        self.help = (!lines.is_empty()).then(|| lines.join("\n"));
        self
    }
}
