//! Failures: kind, message, and what to do next. Clients of the engine print them.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Kind of a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
}

impl Kind {
    /// Exit code of the process.
    #[must_use]
    pub const fn exit_code(self) -> u8 {
        match self {
            Self::Usage => 2,
            Self::BadInput => 3,
            Self::NoDevice => 4,
            Self::DeviceFault => 5,
            Self::Incomplete => 6,
            Self::Interrupted => 130,
        }
    }
}

/// A failure. Its JSON keys are `error`, `help` and `kind`.
#[derive(Clone, Debug, PartialEq, Error, Serialize, Deserialize)]
#[error("{message}")]
pub struct Failure {
    /// Kind, which determines the exit code.
    pub kind: Kind,
    /// What is wrong, where, what was expected and found.
    #[serde(rename = "error")]
    pub message: String,
    /// What to do next.
    pub help: Option<String>,
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
}
