//! Results per fault, the table of docs/src/chaos.md.

use std::fmt;
use std::time::Duration;

use engine::service::scan_record::ScanState;

use crate::plan::ROWS;
use crate::real::{CaptureOutcome, CaptureResult};

/// Markers around the table in the page.
const MARKS: (&str, &str) = ("<!-- table -->\n", "<!-- end of the table -->");

#[derive(Clone, Copy, Debug, Default)]
struct Row {
    whole: u32,
    partial: u32,
    failed: u32,
    skipped: u32,
    safe_after: Option<Duration>,
}

/// Results, one row per fault.
#[derive(Clone, Debug)]
pub struct Table([Row; ROWS.len()]);

impl Default for Table {
    fn default() -> Self {
        Self([Row::default(); ROWS.len()])
    }
}

impl Table {
    /// Counts one capture.
    pub fn count(&mut self, row: usize, made: CaptureResult) {
        let row = &mut self.0[row];
        *match made.came {
            CaptureOutcome::Scan(ScanState::Whole) => &mut row.whole,
            CaptureOutcome::Scan(ScanState::Partial) => &mut row.partial,
            CaptureOutcome::Scan(_) => &mut row.failed,
            CaptureOutcome::Skipped => &mut row.skipped,
        } += 1;
        row.safe_after = row.safe_after.max(made.safe_after);
    }

    /// Replaces the table in the page.
    pub fn bless(&self) {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/src/chaos.md");
        let page = std::fs::read_to_string(path).unwrap();
        let (before, rest) = page.split_once(MARKS.0).unwrap();
        let (_, after) = rest.split_once(MARKS.1).unwrap();
        std::fs::write(path, format!("{before}{}{self}{}{after}", MARKS.0, MARKS.1)).unwrap();
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "| fault | captures | whole | partial | failed | skipped | longest time until the axis is safe |"
        )?;
        writeln!(f, "|---|---|---|---|---|---|---|")?;
        for (name, row) in ROWS.iter().zip(&self.0) {
            let all = row.whole + row.partial + row.failed + row.skipped;
            let safe = row.safe_after.map_or("-".to_owned(), |after| {
                format!("{:.1} s", after.as_secs_f64())
            });
            writeln!(
                f,
                "| {name} | {all} | {} | {} | {} | {} | {safe} |",
                row.whole, row.partial, row.failed, row.skipped
            )?;
        }
        Ok(())
    }
}
