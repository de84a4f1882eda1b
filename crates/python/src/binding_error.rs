//! Failures as Python's exceptions, which `velomotion/_errors.py` defines.

use std::ffi::CString;
use std::fs::File;
use std::path::Path;

use engine::{Failure, Kind};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

/// A failure and the exception that it becomes.
#[derive(Clone, Debug)]
pub(crate) struct BindingError {
    class: &'static str,
    message: String,
    help: Option<String>,
}

impl BindingError {
    /// An invalid argument.
    pub fn usage(message: impl Into<String>) -> Self {
        Failure::new(Kind::Usage, message).into()
    }

    /// An error of this program.
    pub fn internal() -> Self {
        Self {
            class: "Error",
            message: "the work ended without a result".to_owned(),
            help: Some("report it with the input: it is an error of velomotion".to_owned()),
        }
    }

    /// The exception.
    pub fn into_py(self, py: Python<'_>) -> PyErr {
        let exception = || {
            let class = py.import("velomotion._errors")?.getattr(self.class)?;
            let exception = class.call1((&self.message,))?;
            exception.setattr("help", &self.help)?;
            Ok(exception)
        };
        match exception() {
            _ if self.class == INTERRUPTED => PyKeyboardInterrupt::new_err(self.message),
            Ok(exception) => PyErr::from_value(exception),
            Err(error) => error,
        }
    }
}

/// Class of an interruption, which is Python's own.
const INTERRUPTED: &str = "KeyboardInterrupt";

impl From<Failure> for BindingError {
    fn from(failure: Failure) -> Self {
        let class = match failure.kind {
            Kind::Usage => "UsageError",
            Kind::BadInput | Kind::NotFound => "InputError",
            Kind::Incomplete => "IncompleteError",
            Kind::Interrupted => INTERRUPTED,
            Kind::NoDevice | Kind::DeviceFault | Kind::Busy | Kind::Denied | Kind::Limit => "Error",
        };
        Self {
            class,
            message: failure.message,
            help: failure.help,
        }
    }
}

/// Refuses a file that the system does not open.
pub(crate) fn check_readable(path: &Path) -> Result<(), BindingError> {
    // Opening a pipe would wait for its writer.
    let why = match path.metadata() {
        Ok(there) if there.is_dir() => Some("it is a folder".to_owned()),
        Ok(there) if there.is_file() => File::open(path).err().map(|error| error.to_string()),
        Ok(_) => None,
        Err(error) => Some(error.to_string()),
    };
    why.map_or(Ok(()), |why| {
        Err(BindingError {
            class: "FileError",
            message: format!("{}: cannot read: {why}", path.display()),
            help: Some("check the name and the read permission".to_owned()),
        })
    })
}

/// Warns that a result is incomplete.
pub(crate) fn warn_incomplete(py: Python<'_>, missing: &str) -> PyResult<()> {
    let category = py
        .import("velomotion._errors")?
        .getattr("IncompleteWarning")?;
    let text = CString::new(missing.replace('\0', " ")).unwrap_or_default();
    PyErr::warn(py, &category, &text, 1)
}
