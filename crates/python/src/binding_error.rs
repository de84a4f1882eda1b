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
            message: with_arguments(&failure.message),
            help: failure.help.as_deref().map(with_arguments),
        }
    }
}

/// Arguments whose names are not those of the command line's options.
const ARGUMENTS: [(&str, &str); 8] = [
    ("--at", "at_m"),
    ("--error", "error_mm"),
    ("--gap", "gap_deg"),
    ("--time:", "time_s:"),
    ("--range-sd", "range_sd_m"),
    ("--mount-sd", "mount_sd_deg"),
    ("--from", "from_deg"),
    ("--to", "to_deg"),
];

/// A message about options of the command line, with Python's arguments instead. A message that
/// names a command stays as it is.
fn with_arguments(text: &str) -> String {
    if text.contains("velomotion ") || text.contains("replay --") {
        return text.to_owned();
    }
    let words = text.split(' ').map(|word| {
        let Some(option) = word.strip_prefix("--") else {
            return word.to_owned();
        };
        let argument = ARGUMENTS.iter().find_map(|(known, argument)| {
            let rest = word.strip_prefix(known)?;
            let ends = !rest.starts_with(|next: char| next == '-' || next.is_alphanumeric());
            ends.then(|| format!("{argument}{rest}"))
        });
        argument.unwrap_or_else(|| option.replace('-', "_"))
    });
    words.collect::<Vec<_>>().join(" ")
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

/// Warns of `what` by a class of `velomotion/_errors.py`.
pub(crate) fn warn(py: Python<'_>, class: &str, what: &str) -> PyResult<()> {
    let category = py.import("velomotion._errors")?.getattr(class)?;
    let text = CString::new(what.replace('\0', " ")).unwrap_or_default();
    PyErr::warn(py, &category, &text, 1)
}
