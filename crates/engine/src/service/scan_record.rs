//! Records of scans: as stored in their folder, in lists, and in full.

use std::ops::{Deref, DerefMut};

use scanner::Accuracy;
use serde::{Deserialize, Deserializer, Serialize};
use utoipa::ToSchema;

use crate::capture::run::{Outcome, ScanFailure};
use crate::capture_request::CaptureRequest;
use crate::failure::{Failure, Kind};
use crate::reconstruct::report::Reception;

/// Longest name of a scan in its capture request, bytes.
pub const NAME_BYTES: usize = 60;
/// Longest name that a scan can get later, characters.
pub const NAME_CHARS: usize = 60;
/// Longest notes on a scan, characters.
pub const NOTES_CHARS: usize = 2_000;

/// State of a scan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ScanState {
    /// The devices are recorded.
    #[default]
    Recording,
    /// The log is complete, the cloud is being made.
    Making,
    /// Complete.
    Whole,
    /// Incomplete.
    Partial,
    /// There is no cloud.
    Failed,
}

impl ScanState {
    /// Whether the state does not change any more.
    #[must_use]
    pub const fn is_final(self) -> bool {
        matches!(self, Self::Whole | Self::Partial | Self::Failed)
    }
}

/// The part of a scan's record that every form of it has.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ScanHead {
    /// The name of its folder.
    pub id: String,
    /// Name given by the user.
    #[serde(default)]
    pub name: Option<String>,
    /// Notes of the user.
    #[serde(default)]
    pub notes: Option<String>,
    /// State.
    pub state: ScanState,
    /// Why it is incomplete.
    pub why: Option<Failure>,
    /// Whether its cloud is made as soon as the disk has room.
    #[serde(default)]
    pub waits_for_room: bool,
    /// Start, Unix seconds.
    pub started_s: f64,
    /// Whether the devices were simulated.
    pub simulated: bool,
    /// The request; absent where it is lost, or was written by a later version.
    #[serde(default, deserialize_with = "if_understood", rename = "asked")]
    #[schema(inline)]
    pub request: Option<CaptureRequest>,
    /// Points of the cloud.
    pub points: Option<u64>,
    /// Length of the recording, seconds.
    pub duration_s: Option<f64>,
}

impl ScanHead {
    /// The requested accuracy of its cloud.
    #[must_use]
    pub fn accuracy(&self) -> Accuracy {
        let request = self.request.as_ref();
        request
            .and_then(|request| request.accuracy().ok())
            .unwrap_or(Accuracy::Best)
    }
}

/// The request, if this version can read it. New requests with unknown options are refused, but the
/// scan of one is kept.
fn if_understood<'de, D: Deserializer<'de>>(from: D) -> Result<Option<CaptureRequest>, D::Error> {
    let value = Option::<serde_json::Value>::deserialize(from)?;
    Ok(value.and_then(|value| serde_json::from_value(value).ok()))
}

/// Body of `PATCH /scans/ID`. Absent keys change nothing, an empty text removes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(default, deny_unknown_fields)]
#[schema(example = json!({"name": "Hall, north end", "notes": "Door open.\nTripod on the gallery."}))]
pub struct ScanEdit {
    /// The name, one line.
    #[schema(max_length = 60)]
    pub name: Option<String>,
    /// The notes, plain text.
    #[schema(max_length = 2_000)]
    pub notes: Option<String>,
}

impl ScanEdit {
    /// Refuses texts that are too long or have control characters.
    ///
    /// # Errors
    /// [`Kind::Usage`].
    pub fn check(&self) -> Result<(), Failure> {
        check_text("name", self.name.as_deref(), NAME_CHARS, "")?;
        check_text("notes", self.notes.as_deref(), NOTES_CHARS, "\n\t")
    }

    /// Changes the texts of a scan.
    pub fn apply(&self, head: &mut ScanHead) {
        let changes = [(&self.name, &mut head.name), (&self.notes, &mut head.notes)];
        for (new, text) in changes {
            if let Some(new) = new {
                *text = Some(new.trim().to_owned()).filter(|new| !new.is_empty());
            }
        }
    }
}

/// Refuses a text with more than `most` characters, or control characters other than `allowed`.
fn check_text(key: &str, text: Option<&str>, most: usize, allowed: &str) -> Result<(), Failure> {
    let text = text.unwrap_or_default();
    let length = text.chars().count();
    if length > most {
        return Err(Failure::new(
            Kind::Usage,
            format!("{key}: expected at most {most} characters, got {length}"),
        )
        .help("shorten it"));
    }
    match text
        .chars()
        .find(|c| c.is_control() && !allowed.contains(*c))
    {
        None => Ok(()),
        Some(control) => Err(Failure::new(
            Kind::Usage,
            format!("{key}: expected plain text, got the control character {control:?}"),
        )
        .help("remove it; only notes may have line breaks (\\n) and tabs")),
    }
}

/// The file `scan.json` in a scan's folder.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ScanRecord {
    /// Head.
    #[serde(flatten)]
    pub head: ScanHead,
    /// Scans are numbered in their order, which a clock that is set cannot change.
    #[serde(default)]
    pub number: u64,
    /// Whether the file could not be read. It is not overwritten then, and the scan is deleted only
    /// on request.
    #[serde(skip)]
    pub unreadable: bool,
    /// Messages during the capture.
    #[serde(default)]
    pub messages: Vec<String>,
    /// Why the recording is incomplete.
    #[serde(default)]
    pub recording: Option<Failure>,
    /// Records lost on the way to the log.
    #[serde(default)]
    pub lost_records: u64,
    /// Warnings about its completeness and its motion.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// Counts of packets.
    #[serde(default)]
    pub reception: Option<Reception>,
    /// The failure in `why`, without what was saved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<Failure>,
    /// Why there is no cloud, where that is another reason than the cause.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub no_cloud: Option<String>,
    /// The object that `capture --json` prints.
    #[serde(default)]
    pub report: Option<serde_json::Value>,
}

impl ScanRecord {
    /// Sets why the scan is incomplete.
    pub fn set_failure(&mut self, failure: Option<ScanFailure>) {
        self.cause = failure.as_ref().map(|failure| failure.cause.clone());
        self.no_cloud = failure.as_ref().and_then(|f| f.no_cloud.clone());
        self.head.why = failure.map(ScanFailure::into_failure);
    }

    /// The outcome of its recording.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        Outcome {
            failure: self.recording.clone(),
            lost_records: self.lost_records,
            reception: self.reception,
            warnings: self.warnings.clone(),
        }
    }
}

/// A scan in a list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(example = json!({
    "id": "hall-2026-11-26T09-17-55Z", "name": "hall", "notes": null, "state": "whole", "why": null,
    "waits_for_room": false, "started_s": 1_795_684_675.219, "simulated": false,
    "asked": {"speed_deg_s": 56.25, "both_ways": false, "name": "hall"}, "points": 262_749,
    "duration_s": 2.783, "bytes": 10_819_191, "log_bytes": 3_144_848, "cloud_bytes": 7_620_246,
    "thumbnail": true, "summary": null,
}))]
pub struct ScanView {
    /// Head.
    #[serde(flatten)]
    pub head: ScanHead,
    /// Bytes of all its files.
    pub bytes: u64,
    /// Bytes of its log.
    pub log_bytes: Option<u64>,
    /// Bytes of its cloud.
    pub cloud_bytes: Option<u64>,
    /// Whether it has a thumbnail.
    pub thumbnail: bool,
    /// Why it is incomplete and what it has, in sentences without file names.
    pub summary: Option<String>,
}

/// A scan in full.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(example = json!({
    "id": "hall-2026-11-26T09-17-55Z", "name": "hall", "notes": null, "state": "whole", "why": null,
    "waits_for_room": false, "started_s": 1_795_684_675.219, "simulated": false,
    "asked": {"speed_deg_s": 56.25, "both_ways": false, "name": "hall"}, "points": 262_749,
    "duration_s": 2.783, "bytes": 10_819_191, "log_bytes": 3_144_848, "cloud_bytes": 7_620_246,
    "thumbnail": true, "summary": null,
    "messages": ["homing by method 18"], "recording": null, "lost_records": 0, "warnings": [],
    "reception": {
        "received": 2_516, "dropped_by_kernel": 0, "dropped_by_log": 0, "without_kernel_time": 0,
        "from_others": 0,
    },
    "report": null,
}))]
pub struct ScanDetails {
    /// As in a list.
    #[serde(flatten)]
    pub scan: ScanView,
    /// Messages during the capture.
    pub messages: Vec<String>,
    /// Why the recording is incomplete.
    pub recording: Option<Failure>,
    /// Records lost on the way to the log.
    pub lost_records: u64,
    /// Warnings about its completeness and its motion; also in those of the report.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// Counts of packets.
    pub reception: Option<Reception>,
    /// The object that `capture --json` prints.
    pub report: Option<serde_json::Value>,
}

impl Deref for ScanRecord {
    type Target = ScanHead;

    fn deref(&self) -> &ScanHead {
        &self.head
    }
}

impl DerefMut for ScanRecord {
    fn deref_mut(&mut self) -> &mut ScanHead {
        &mut self.head
    }
}

impl Deref for ScanView {
    type Target = ScanHead;

    fn deref(&self) -> &ScanHead {
        &self.head
    }
}

/// Refuses a name that may not be part of an id.
///
/// # Errors
/// [`Kind::Usage`].
pub fn check_name(name: &str) -> Result<(), Failure> {
    let allowed = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
    if !name.is_empty() && name.len() <= NAME_BYTES && name.bytes().all(allowed) {
        return Ok(());
    }
    Err(Failure::new(
        Kind::Usage,
        format!("name: expected 1 to {NAME_BYTES} letters, digits, - or _"),
    )
    .help("choose another name, or leave it out: scans are named after their time"))
}
