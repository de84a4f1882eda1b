//! Conditions that hold for scans after every fault: list, folder and files agree, and incomplete
//! scans are marked.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::sync::atomic::AtomicBool;

use cloud::{Fields, Points};
use daemon::client::Client;
use daemon::scans::{CLOUD, LOG};
use engine::reconstruct::replay::{self, Reconstruction};
use engine::reconstruct::source::Source;
use engine::service::scan_record::{ScanState, ScanView};
use io::recording::Recording;
use scanner::{Accuracy, TiltSource};

/// The required outcome of a capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Complete.
    Whole,
    /// Incomplete and marked so.
    Less,
    /// Either.
    Any,
}

/// Reads every scan that the daemon lists.
pub fn list(client: &Client) -> Result<Vec<ScanView>, String> {
    let mut answer: BTreeMap<String, Vec<ScanView>> = client
        .get("/api/v1/scans")
        .map_err(|failure| failure.to_string())?;
    answer
        .remove("scans")
        .ok_or("no scans in the list of scans".to_owned())
}

/// The only scan of that name.
pub fn named<'a>(scans: &'a [ScanView], name: &str) -> Result<&'a ScanView, String> {
    let mut of_that_name = scans
        .iter()
        .filter(|scan| scan.name.as_deref() == Some(name));
    match (of_that_name.next(), of_that_name.next()) {
        (Some(scan), None) => Ok(scan),
        (None, _) => Err(format!("{name} was started and is not listed: lost")),
        (Some(_), Some(_)) => Err(format!("{name} was started once and is listed twice")),
    }
}

/// Checks the list against the folder.
pub fn agree(scans: &[ScanView], folder: &Path) -> Result<(), String> {
    let listed: BTreeSet<String> = scans.iter().map(|scan| scan.id.clone()).collect();
    let entries = fs::read_dir(folder).map_err(|error| error.to_string())?;
    let there: BTreeSet<String> = entries
        .flatten()
        .filter(|entry| entry.path().is_dir())
        .filter_map(|entry| entry.file_name().into_string().ok())
        .collect();
    match listed == there {
        true => Ok(()),
        false => Err(format!("listed are {listed:?}, and on the disk {there:?}")),
    }
}

/// Whether the scan's record on disk equals the list. On a full disk it follows once there is
/// space.
pub fn written(scan: &ScanView, folder: &Path) -> bool {
    let reported = fs::read(folder.join(&scan.id).join("scan.json")).ok();
    let reported: Option<serde_json::Value> =
        reported.and_then(|text| serde_json::from_slice(&text).ok());
    let state = serde_json::to_value(scan.state).unwrap_or_default();
    reported.is_some_and(|reported| reported["state"] == state)
}

/// Checks a scan with its files.
pub fn check_scan(scan: &ScanView, folder: &Path, wanted: Wanted) -> Result<(), String> {
    let place = folder.join(&scan.id);
    let printed = format!("{:?}, {:?}", scan.state, scan.why);
    let wrong = |what: String| Err(format!("{}: {what} ({printed})", scan.id));
    match (scan.state, wanted) {
        (ScanState::Recording | ScanState::Making, _) => return wrong("never ended".to_owned()),
        (ScanState::Whole, Wanted::Less) => return wrong("whole, and it cannot be".to_owned()),
        (ScanState::Partial | ScanState::Failed, Wanted::Whole) => {
            return wrong("not complete, without a fault".to_owned());
        }
        _ => {}
    }
    match (&scan.why, scan.state) {
        (Some(_), ScanState::Whole) => return wrong("whole, with a reason why not".to_owned()),
        (None, ScanState::Partial | ScanState::Failed) => {
            return wrong("not whole, and no word why".to_owned());
        }
        (Some(why), _) if why.message.is_empty() || why.help.is_none() => {
            return wrong("no word of what to do".to_owned());
        }
        _ => {}
    }
    let reported =
        fs::read(place.join("scan.json")).map_err(|error| format!("{}: {error}", scan.id))?;
    let reported: serde_json::Value =
        serde_json::from_slice(&reported).map_err(|error| format!("{}: {error}", scan.id))?;
    if reported["state"] != serde_json::to_value(scan.state).unwrap_or_default() {
        return wrong(format!("on the disk it is {}", reported["state"]));
    }
    let size = |name: &str| fs::metadata(place.join(name)).ok().map(|there| there.len());
    if (scan.log_bytes, scan.cloud_bytes) != (size(LOG), size(CLOUD)) {
        return wrong("its files are not as listed".to_owned());
    }
    let cloud = place.join(CLOUD);
    match (scan.state, scan.points) {
        (ScanState::Failed, None) => {
            if cloud.exists() {
                return wrong("it has a cloud all the same".to_owned());
            }
        }
        (_, Some(points)) => {
            let there = vertices(&cloud)?;
            if there != points {
                return wrong(format!("{points} points are listed, {there} in the file"));
            }
        }
        (_, None) => return wrong("its number of points is unknown".to_owned()),
    }
    let log = place.join(LOG);
    if log.exists() {
        readable(&log).or_else(wrong)?;
    } else if scan.state != ScanState::Failed {
        return wrong("a cloud without a log".to_owned());
    }
    Ok(())
}

/// Checks that a failed scan's log holds no sweep.
pub fn check_without_sweep(scan: &ScanView, folder: &Path) -> Result<(), String> {
    let log = folder.join(&scan.id).join(LOG);
    let points = points_of(&log);
    match (scan.state, points) {
        (ScanState::Failed, Some(points)) if points > 0 => Err(format!(
            "{}: failed, and its log has {points} points ({:?})",
            scan.id, scan.why
        )),
        _ => Ok(()),
    }
}

fn points_of(log: &Path) -> Option<u64> {
    let mut points = Points::new(Fields::FILE);
    let request = Reconstruction {
        recording: &Source::open(log, None).ok()?,
        tilt: TiltSource::Log,
        options: lidar::Options::default(),
        time: engine::reconstruct::replay::TimeReference::Host,
        accuracy: Accuracy::Best,
        pace: None,
        truth: None,
        live: false,
        lost_records: 0,
        georeference: None,
        interrupt: &AtomicBool::new(false),
    };
    let scan = replay::scan(&request, &mut points, Path::new("memory"));
    scan.ok().map(|scan| scan.points)
}

/// Checks that a log can be read to its end or to where it was truncated.
fn readable(log: &Path) -> Result<(), String> {
    // A log that was truncated within its header holds nothing.
    let Ok(mut recording) = Recording::open(log) else {
        return match fs::metadata(log) {
            Ok(there) if there.len() < 4_096 => Ok(()),
            _ => Err("its log cannot be opened".to_owned()),
        };
    };
    loop {
        match recording.next_record() {
            Ok(Some(_)) => {}
            Ok(None) => return Ok(()),
            Err(error) => return Err(format!("its log cannot be read: {error}")),
        }
    }
}

/// Number of rows in a PLY's header, if the file has that size.
fn vertices(ply: &Path) -> Result<u64, String> {
    let name = ply.display();
    let file = File::open(ply).map_err(|error| format!("{name}: {error}"))?;
    for line in BufReader::new(file).lines().map_while(Result::ok) {
        if let Some(count) = line.strip_prefix("element vertex ") {
            return count.trim().parse().map_err(|_| format!("{name}: {line}"));
        }
        if line == "end_header" {
            break;
        }
    }
    Err(format!("{name}: no number of points"))
}
