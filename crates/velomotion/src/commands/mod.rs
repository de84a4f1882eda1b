//! The commands, one file each.

pub mod accuracy;
pub mod analyze;
pub mod calibrate;
#[cfg(devices)]
pub mod capture;
#[cfg(devices)]
pub mod daemon;
#[cfg(devices)]
pub mod device_backend;
#[cfg(devices)]
pub mod doctor;
#[cfg(devices)]
pub mod firmware_sim;
#[cfg(devices)]
pub mod guard_axis;
pub mod help;
pub mod info;
pub mod plan;
pub mod replay;
pub mod simulate;
#[cfg(devices)]
pub mod tilt;
pub mod tradeoff;
pub mod view;

use std::path::{Path, PathBuf};

use engine::document::{Document, ErrorReport};
use engine::failure::{Failure, Kind};
use engine::reconstruct::report::ScanReport;

/// Output of a command: one JSON object or text.
#[derive(Default)]
pub struct CommandOutput {
    /// Output with `--json`; of several files an array, printed as an object per line.
    pub json: serde_json::Value,
    /// Output without `--json`.
    pub text: String,
    /// A failure that left a usable result. It sets the exit code and is printed after the text.
    pub failure: Option<Failure>,
    /// Whether stdout holds a cloud, which moves the text to stderr.
    pub stdout_taken: bool,
    /// Whether the text is the requested result, which `--quiet` keeps.
    pub is_result: bool,
}

impl CommandOutput {
    /// Report of an action.
    fn report(report: &impl Document, text: String) -> Self {
        Self {
            json: report.to_json(),
            text,
            ..Self::default()
        }
    }

    /// Report that is the result of the command.
    fn result(report: &impl Document, text: String) -> Self {
        Self {
            is_result: true,
            ..Self::report(report, text)
        }
    }

    /// Runs a command for each file. The output for several is that of each, in their order: an
    /// object per line, or the texts. A file that fails does not stop the others; its failure is
    /// printed at once.
    fn of_each(
        files: &[PathBuf],
        run: impl Fn(&Path) -> Result<Self, Failure>,
    ) -> Result<Self, Failure> {
        if let [file] = files {
            return run(file);
        }
        let mut objects = Vec::new();
        let mut all = Self::default();
        let mut failed = Vec::new();
        for file in files {
            let mut output = run(file).unwrap_or_else(|error| {
                let json = ErrorReport {
                    error: error.clone(),
                };
                Self {
                    failure: Some(error),
                    ..Self::report(&json, String::new())
                }
            });
            if let Some(failure) = output.failure.take() {
                let is_interrupted = failure.kind == Kind::Interrupted;
                if let Some(object) = output.json.as_object_mut() {
                    object.insert("error".to_owned(), serde_json::json!(failure));
                }
                if is_interrupted {
                    objects.push(output.json);
                    all.json = serde_json::Value::Array(objects);
                    all.failure = Some(failure);
                    return Ok(all);
                }
                crate::logging::failed(&failure);
                failed.push((file, failure.kind));
            }
            objects.push(output.json);
            if !all.text.is_empty() && !output.text.is_empty() {
                all.text.push_str("\n\n");
            }
            all.text.push_str(&output.text);
            all.is_result |= output.is_result;
        }
        all.json = serde_json::Value::Array(objects);
        all.failure = failed.first().map(|(file, kind)| {
            let (count, all) = (failed.len(), files.len());
            let what = format!(
                "{count} of {all} files failed, the first is {}",
                file.display()
            );
            Failure::new(*kind, what).help("the messages above say why")
        });
        Ok(all)
    }

    /// Report on a scan.
    fn scan(scan: &ScanReport, failure: Option<Failure>, stdout_taken: bool) -> Self {
        Self {
            failure,
            stdout_taken,
            ..Self::report(scan, crate::tables::scan_table(scan))
        }
    }
}
