//! How a command fails: what to say, what to do next, and the exit code. Printed once, in `main`.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What kind of failure it is: decides the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The command line asks for something that cannot be (2).
    Usage,
    /// A file is missing, or not what it should be (3).
    BadInput,
    /// No device (4).
    NoDevice,
    /// A device that reports a fault, or does not answer (5).
    DeviceFault,
    /// Not all could be done; what was captured is saved (6).
    Incomplete,
    /// Stopped by the user; what was captured is saved (130).
    Interrupted,
}

impl Kind {
    /// The process's exit code.
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

/// A failed command. As JSON: error, help, kind.
#[derive(Clone, Debug, PartialEq, Error, Serialize, Deserialize)]
#[error("{message}")]
pub struct Failure {
    /// Decides the exit code.
    pub kind: Kind,
    /// What happened, where, what was expected and what was there.
    #[serde(rename = "error")]
    pub message: String,
    /// What to do next.
    pub help: Option<String>,
}

impl Failure {
    /// A failure that says `message`.
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
