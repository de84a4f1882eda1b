//! A scan that is incomplete in a few sentences: what went wrong, what there is of it, what to do. No file's place is in them: whoever reads them
//! in a browser has no use for one.

use std::path::Path;

use super::{ScanRecord, ScanState};
use engine::capture::run::NO_CLOUD;
use engine::failure::Failure;

/// What is said of a scan in `place`; nothing of one that is whole or has not ended.
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
            todo(why, &place),
        ),
        None => (String::new(), Vec::new()),
    };
    let said = [sentence(&why), left.to_owned()].into_iter();
    let all: Vec<String> = said.chain(help).filter(|said| !said.is_empty()).collect();
    Some(all.join(" "))
}

/// What to do, a sentence a line. Lines on where a file is are for whoever reads the API, but for the one that says why there is no cloud.
fn todo(why: &Failure, place: &str) -> Vec<String> {
    let help = why.help.as_deref().unwrap_or_default();
    let mut lines: Vec<String> = Vec::new();
    let wanted = help
        .lines()
        .filter(|line| !line.contains(place) || line.starts_with(NO_CLOUD))
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

/// With a capital at its begin and a stop at its end.
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
    use crate::scans::{CLOUD, LOG, ScanHead};
    use engine::capture::run::{self as job, Outcome};
    use engine::failure::Kind;

    const PLACE: &str = "/data/my scans/hall";

    fn said(state: ScanState, why: Failure, waits: bool, has_log: bool) -> String {
        let record = ScanRecord::new(ScanHead {
            id: "hall".to_owned(),
            name: None,
            state,
            why: Some(why),
            waits_for_room: waits,
            started_s: 0.0,
            simulated: true,
            asked: None,
            points: None,
            duration_s: None,
        });
        of(&record, Path::new(PLACE), has_log).unwrap()
    }

    /// As a capture ends of which no cloud can be made.
    fn without_cloud(recording: Option<Failure>, making: Failure) -> Failure {
        let files = [CLOUD, LOG].map(|name| Path::new(PLACE).join(name));
        let outcome = Outcome {
            failure: recording,
            ..Outcome::default()
        };
        job::conclude(Err(making), outcome, (&files[0], &files[1])).unwrap_err()
    }

    #[test]
    fn whole_sentences_without_places() {
        let stopped = || Failure::new(Kind::Interrupted, "stopped by the user");
        let full = || {
            let message = format!("the cloud {PLACE}/cloud.ply could not be written: disk full");
            Failure::new(Kind::Incomplete, message).help("free some space")
        };
        assert_eq!(
            said(ScanState::Partial, stopped(), false, true),
            "Stopped by the user. What was captured is kept."
        );
        assert_eq!(
            said(ScanState::Failed, without_cloud(None, full()), true, true),
            "The cloud cloud.ply could not be written: disk full. \
             The log is kept: its cloud is made as soon as the disk has room. Free some space."
        );
        let both = without_cloud(
            Some(stopped()),
            Failure::new(Kind::BadInput, format!("{PLACE}/log.pcapng: no packet")),
        );
        assert!(both.help.as_ref().unwrap().contains(PLACE), "{both:?}");
        assert_eq!(
            said(ScanState::Failed, both, false, true),
            "Stopped by the user. The log is kept. There is no cloud: log.pcapng: no packet."
        );
        let silent = Failure::new(Kind::NoDevice, "no lidar")
            .help("see whether it turns,\nand its cable\n(the grey one) is in");
        assert_eq!(
            said(ScanState::Failed, silent, false, false),
            "No lidar. Nothing was recorded. See whether it turns, and its cable (the grey one) is in."
        );
    }
}
