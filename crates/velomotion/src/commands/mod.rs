//! The commands, one file each.

pub mod analyze;
pub mod capture;
pub mod daemon;
pub mod device_backend;
pub mod doctor;
pub mod firmware_sim;
pub mod guard_axis;
pub mod help;
pub mod info;
pub mod plan;
pub mod replay;
pub mod simulate;
pub mod tilt;
pub mod tradeoff;

use engine::document::Document;
use engine::failure::Failure;
use engine::reconstruct::report::ScanReport;

/// Output of a command: one JSON object or text.
#[derive(Default)]
pub struct CommandOutput {
    /// Output with `--json`.
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

    /// Report on a scan.
    fn scan(scan: &ScanReport, failure: Option<Failure>, stdout_taken: bool) -> Self {
        Self {
            failure,
            stdout_taken,
            ..Self::report(scan, crate::tables::scan_table(scan))
        }
    }
}
