//! Summary of an incomplete scan for people: what went wrong, what is kept, what to do. It names no
//! folders, which are of no use in a browser.

use std::path::Path;

use engine::failure::Kind;
use engine::service::scan_record::{ScanRecord, ScanState};

/// The summary of a scan in `place`; `None` for a complete scan or one under way.
pub(super) fn of(record: &ScanRecord, place: &Path, has_log: bool) -> Option<String> {
    let left = match (record.state, record.waits_for_room, has_log) {
        (ScanState::Partial, ..) => "What was captured is kept.",
        (ScanState::Failed, true, _) => {
            "The log is kept: its cloud is made as soon as the disk has room."
        }
        (ScanState::Failed, false, true) => "The log is kept.",
        (ScanState::Failed, false, false) => "Nothing was recorded.",
        (ScanState::Recording | ScanState::Making | ScanState::Whole, ..) => return None,
    };
    let cause = record.cause.as_ref().or(record.why.as_ref());
    let what = cause.map_or("", |cause| &cause.message);
    let help = cause.and_then(|cause| cause.help.as_deref());
    let mut all = vec![sentence(what)];
    all.extend(last_sweep(record));
    all.push(left.to_owned());
    all.extend(sentences(help.unwrap_or_default()));
    all.extend(record.no_cloud.as_deref().map(sentence));
    all.retain(|text| !text.is_empty());
    Some(all.join(" ").replace(&format!("{}/", place.display()), ""))
}

/// End angle of the last sweep of a stopped scan, from its report.
fn last_sweep(record: &ScanRecord) -> Option<String> {
    let cause = record.cause.as_ref().or(record.why.as_ref())?;
    let sweeps = record.report.as_ref()?.get("sweeps")?.as_array()?;
    let to_deg = sweeps.last()?.get("to_deg")?.as_f64()?;
    let stopped = record.state == ScanState::Partial && cause.kind == Kind::Interrupted;
    stopped.then(|| format!("Sweep {} ended at {to_deg:.2} deg.", sweeps.len()))
}

/// The help, one sentence per line.
fn sentences(help: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for line in help.lines() {
        let goes_on = line.starts_with('(') || lines.last().is_some_and(|l| l.ends_with(','));
        match lines.last_mut() {
            Some(before) if goes_on => *before = format!("{before} {}", line.trim()),
            _ => lines.push(line.trim().to_owned()),
        }
    }
    lines.iter().map(|line| sentence(line)).collect()
}

/// The line with a full stop, and a capital first letter unless a file's name comes first.
fn sentence(line: &str) -> String {
    let mut letters = line.chars();
    let Some(first) = letters.next() else {
        return String::new();
    };
    let stop = match line.ends_with(['.', '!', '?']) {
        true => "",
        false => ".",
    };
    let is_file = line.split(' ').next().is_some_and(|word| {
        word.trim_end_matches(['.', ',', ':', ';'])
            .contains(['.', '/'])
    });
    match is_file {
        true => format!("{line}{stop}"),
        false => format!("{}{}{stop}", first.to_uppercase(), letters.as_str()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scans::{CLOUD, LOG};
    use engine::capture::run::{self, Outcome};
    use engine::failure::Failure;
    use engine::service::scan_record::ScanHead;

    const PLACE: &str = "/data/my scans/hall";

    fn describe(state: ScanState, why: Failure, waits: bool, has_log: bool) -> String {
        let mut record = record(state, waits);
        record.why = Some(why);
        of(&record, Path::new(PLACE), has_log).unwrap()
    }

    fn record(state: ScanState, waits_for_room: bool) -> ScanRecord {
        ScanRecord {
            head: ScanHead {
                id: "hall".to_owned(),
                state,
                waits_for_room,
                simulated: true,
                ..ScanHead::default()
            },
            ..ScanRecord::default()
        }
    }

    /// Summary of a capture without a cloud, and its failure.
    fn without_cloud(
        recording: Option<Failure>,
        making: Failure,
        waits: bool,
    ) -> (String, Failure) {
        let files = [CLOUD, LOG].map(|name| Path::new(PLACE).join(name));
        let outcome = Outcome {
            failure: recording,
            ..Outcome::default()
        };
        let failure = run::conclude(Err(making), outcome, (&files[0], &files[1])).unwrap_err();
        let mut record = record(ScanState::Failed, waits);
        record.set_failure(Some(failure));
        let summary = of(&record, Path::new(PLACE), true).unwrap();
        (summary, record.head.why.unwrap())
    }

    #[test]
    fn names_of_files_keep_their_letters() {
        assert_eq!(
            sentence("scan.json cannot be read"),
            "scan.json cannot be read."
        );
        assert_eq!(sentence("timeout: no answer"), "Timeout: no answer.");
    }

    #[test]
    fn summaries_are_complete_sentences_without_paths() {
        let stopped = || Failure::new(Kind::Interrupted, "stopped by the user");
        let full = || {
            let message = format!("the cloud {PLACE}/cloud.ply could not be written: disk full");
            Failure::new(Kind::Incomplete, message).help("free some space")
        };
        assert_eq!(
            describe(ScanState::Partial, stopped(), false, true),
            "Stopped by the user. What was captured is kept."
        );
        let mut partial = record(ScanState::Partial, false);
        partial.why = Some(stopped());
        let sweeps = [
            serde_json::json!({"to_deg": -45.0}),
            serde_json::json!({"to_deg": -12.344}),
        ];
        partial.report = Some(serde_json::json!({ "sweeps": sweeps }));
        assert_eq!(
            of(&partial, Path::new(PLACE), true).unwrap(),
            "Stopped by the user. Sweep 2 ended at -12.34 deg. What was captured is kept."
        );
        assert_eq!(
            without_cloud(None, full(), true).0,
            "The cloud cloud.ply could not be written: disk full. \
             The log is kept: its cloud is made as soon as the disk has room. Free some space."
        );
        let making = Failure::new(Kind::BadInput, format!("{PLACE}/log.pcapng: no packet"));
        let (summary, both) = without_cloud(Some(stopped()), making, false);
        assert!(both.help.as_ref().unwrap().contains(PLACE), "{both:?}");
        assert_eq!(
            summary,
            "Stopped by the user. The log is kept. There is no cloud: log.pcapng: no packet."
        );
        let silent = Failure::new(Kind::NoDevice, "no lidar")
            .help("see whether it turns,\nand its cable\n(the grey one) is in");
        assert_eq!(
            describe(ScanState::Failed, silent, false, false),
            "No lidar. Nothing was recorded. See whether it turns, and its cable (the grey one) is in."
        );
    }
}
