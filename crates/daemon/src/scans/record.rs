//! What is known of a scan: in its folder, in lists, with everything.

use std::ops::{Deref, DerefMut};

use serde::{Deserialize, Deserializer, Serialize};

use crate::limits::NAME_BYTES;
use engine::capture::request::CaptureRequest;
use engine::capture::run::Outcome;
use engine::failure::{Failure, Kind};
use engine::reconstruct::report::Reception;

/// How far a scan is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ScanState {
    /// The devices are being recorded.
    Recording,
    /// The log is complete, the cloud is being made.
    Making,
    /// All that was asked for is there.
    Whole,
    /// Less than what was asked for.
    Partial,
    /// There is no cloud.
    Failed,
}

impl ScanState {
    /// Whether nothing is to be expected any more.
    #[must_use]
    pub const fn is_final(self) -> bool {
        matches!(self, Self::Whole | Self::Partial | Self::Failed)
    }
}

/// What a scan is known by, wherever it is told of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScanHead {
    /// The name of its folder.
    pub id: String,
    /// What the user called it.
    #[serde(default)]
    pub name: Option<String>,
    /// How far it is.
    pub state: ScanState,
    /// Why it is incomplete.
    pub why: Option<Failure>,
    /// Whether the disk was full when its cloud was made: it is made of the log once there is room.
    #[serde(default)]
    pub waits_for_room: bool,
    /// When it was begun, Unix seconds.
    pub started_s: f64,
    /// Whether the devices were software.
    pub simulated: bool,
    /// What was asked for; absent where nobody knows any more, or a later program knows more of.
    #[serde(default, deserialize_with = "if_understood")]
    pub asked: Option<CaptureRequest>,
    /// Points of the cloud.
    pub points: Option<u64>,
    /// Length of the recording, seconds.
    pub duration_s: Option<f64>,
}

/// What was asked for, where it can be read: requests with options that nobody knows are refused, but a scan that was made is a scan.
fn if_understood<'de, D: Deserializer<'de>>(from: D) -> Result<Option<CaptureRequest>, D::Error> {
    let value = Option::<serde_json::Value>::deserialize(from)?;
    Ok(value.and_then(|value| serde_json::from_value(value).ok()))
}

/// What is kept of a scan beside its files: `scan.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScanRecord {
    /// What it is known by.
    #[serde(flatten)]
    pub head: ScanHead,
    /// Scans are numbered as they are made: clocks may be set, and what is newest must not hang on them.
    #[serde(default)]
    pub number: u64,
    /// Whether the file could not be read: then nothing is written over it, and the scan stays until somebody deletes it.
    #[serde(skip)]
    pub unreadable: bool,
    /// What was said on the way.
    #[serde(default)]
    pub messages: Vec<String>,
    /// What went wrong with the recording itself.
    #[serde(default)]
    pub recording: Option<Failure>,
    /// Records that were lost.
    #[serde(default)]
    pub lost_records: u64,
    /// What was heard.
    #[serde(default)]
    pub reception: Option<Reception>,
    /// What `capture --json` prints.
    #[serde(default)]
    pub report: Option<serde_json::Value>,
}

impl ScanRecord {
    /// Of a scan of which nothing has been told yet.
    #[must_use]
    pub const fn new(head: ScanHead) -> Self {
        Self {
            head,
            number: 0,
            unreadable: false,
            messages: Vec::new(),
            recording: None,
            lost_records: 0,
            reception: None,
            report: None,
        }
    }

    /// What there is to say of its recording.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        Outcome {
            failure: self.recording.clone(),
            lost_records: self.lost_records,
            reception: self.reception,
        }
    }
}

/// A scan as a list shows it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScanView {
    /// What it is known by.
    #[serde(flatten)]
    pub head: ScanHead,
    /// All its files.
    pub bytes: u64,
    /// Its log.
    pub log_bytes: Option<u64>,
    /// Its cloud.
    pub cloud_bytes: Option<u64>,
    /// Whether there is a picture.
    pub thumbnail: bool,
    /// Why it is incomplete and what there is of it, in sentences for people, without files' places.
    pub summary: Option<String>,
}

/// One with everything.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WholeView {
    /// As in the list.
    #[serde(flatten)]
    pub scan: ScanView,
    /// What was said on the way.
    pub messages: Vec<String>,
    /// What went wrong with the recording itself.
    pub recording: Option<Failure>,
    /// Records that were lost.
    pub lost_records: u64,
    /// What was heard.
    pub reception: Option<Reception>,
    /// What `capture --json` prints.
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

/// Refuses a name that cannot be part of an id.
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
