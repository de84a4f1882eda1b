//! Summary of an incomplete scan for people: what went wrong, what is kept, what to do. It names no
//! folders, which are of no use in a browser.

use std::path::Path;

use engine::failure::Failure;
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
    let place = place.display().to_string();
    let (why, help) = match &record.why {
        Some(why) => (
            why.message.replace(&format!("{place}/"), ""),
            help_sentences(why, record.no_cloud.as_deref(), &place),
        ),
        None => (String::new(), Vec::new()),
    };
    let mut all = vec![sentence(&why), left.to_owned()];
    all.extend(help);
    all.retain(|text| !text.is_empty());
    Some(all.join(" "))
}

/// The help, one sentence per line. Lines that name a folder are left out, except the one on the
/// missing cloud.
fn help_sentences(why: &Failure, no_cloud: Option<&str>, place: &str) -> Vec<String> {
    let help = why.help.as_deref().unwrap_or_default();
    let mut lines: Vec<String> = Vec::new();
    let wanted = help
        .lines()
        .filter(|line| !line.contains(place) || Some(*line) == no_cloud)
        .map(|line| line.replace(&format!("{place}/"), ""));
    for line in wanted {
        let goes_on = line.starts_with('(') || lines.last().is_some_and(|l| l.ends_with(','));
        match lines.last_mut() {
            Some(before) if goes_on => *before = format!("{before} {}", line.trim()),
            _ => lines.push(line.trim().to_owned()),
        }
    }
    lines.iter().map(|line| sentence(line)).collect()
}

/// The line with a capital first letter and a full stop.
fn sentence(line: &str) -> String {
    let mut letters = line.chars();
    let Some(first) = letters.next() else {
        return String::new();
    };
    let stop = match line.ends_with(['.', '!', '?']) {
        true => "",
        false => ".",
    };
    format!("{}{}{stop}", first.to_uppercase(), letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scans::{CLOUD, LOG};
    use engine::capture::run::{self, Outcome};
    use engine::failure::Kind;
    use engine::service::scan_record::ScanHead;

    const PLACE: &str = "/data/my scans/hall";

    fn describe(state: ScanState, why: Failure, waits: bool, has_log: bool) -> String {
        describe_with(state, why, waits, has_log, None)
    }

    fn describe_with(
        state: ScanState,
        why: Failure,
        waits: bool,
        has_log: bool,
        no_cloud: Option<String>,
    ) -> String {
        let record = ScanRecord {
            head: ScanHead {
                id: "hall".to_owned(),
                state,
                why: Some(why),
                waits_for_room: waits,
                simulated: true,
                ..ScanHead::default()
            },
            no_cloud,
            ..ScanRecord::default()
        };
        of(&record, Path::new(PLACE), has_log).unwrap()
    }

    /// Failure of a capture without a cloud.
    fn without_cloud(recording: Option<Failure>, making: Failure) -> Failure {
        let files = [CLOUD, LOG].map(|name| Path::new(PLACE).join(name));
        let outcome = Outcome {
            failure: recording,
            ..Outcome::default()
        };
        run::conclude(Err(making), outcome, (&files[0], &files[1])).unwrap_err()
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
        assert_eq!(
            describe(ScanState::Failed, without_cloud(None, full()), true, true),
            "The cloud cloud.ply could not be written: disk full. \
             The log is kept: its cloud is made as soon as the disk has room. Free some space."
        );
        let making = Failure::new(Kind::BadInput, format!("{PLACE}/log.pcapng: no packet"));
        let no_cloud = Some(run::no_cloud(&making));
        let both = without_cloud(Some(stopped()), making);
        assert!(both.help.as_ref().unwrap().contains(PLACE), "{both:?}");
        assert_eq!(
            describe_with(ScanState::Failed, both, false, true, no_cloud),
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
