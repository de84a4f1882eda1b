//! Reading recordings: passes over a file, its configuration, and its errors in the program's words.

use std::path::Path;

use io::recording::{Counts, End, Recording, RecordingError};
use protocol::record::Record;
use scanner::ScanConfig;

use crate::failure::{Failure, Kind};

/// What one pass over a recording found.
#[derive(Clone, Debug)]
pub struct Pass {
    /// Numbers of packets by kind.
    pub counts: Counts,
    /// Where and why the file ends too early.
    pub truncated: Option<String>,
}

/// Opens a recording.
///
/// # Errors
/// [`Kind::BadInput`] for what is missing, empty or no recording.
pub fn open(path: &Path) -> Result<Recording, Failure> {
    Recording::open(path).map_err(|error| failure(&error))
}

/// The configuration that a log carries; what is built in for recordings of others.
///
/// # Errors
/// [`Kind::BadInput`] where the file cannot be read, or carries a configuration of ours that cannot be understood.
pub fn config(path: &Path) -> Result<ScanConfig, Failure> {
    let recording = open(path)?;
    // Other programs comment their recordings too.
    let Some(text) = recording
        .metadata()
        .filter(|text| text.trim_start().starts_with("velomotion = "))
    else {
        return Ok(ScanConfig::default());
    };
    let wrong = |what: String| {
        Failure::new(
            Kind::BadInput,
            format!(
                "{}: the log's configuration cannot be understood:\n{what}",
                path.display()
            ),
        )
        .help("replay the log with the version that its first line names")
    };
    let config: ScanConfig = toml::from_str(text).map_err(|error| wrong(error.to_string()))?;
    if !config.mount.d_m.is_finite() {
        return Err(wrong(format!("mount.d_m is {}", config.mount.d_m)));
    }
    Ok(config)
}

/// Gives every record to `take`, in file order.
///
/// # Errors
/// Where the file cannot be read, and whatever `take` returns.
pub fn read(
    path: &Path,
    mut take: impl FnMut(&Record<'_>) -> Result<(), Failure>,
) -> Result<Pass, Failure> {
    let mut recording = open(path)?;
    while let Some(record) = recording.next_record().map_err(|error| failure(&error))? {
        take(&record)?;
    }
    Ok(Pass {
        counts: recording.counts().clone(),
        truncated: recording.end().and_then(cut_off),
    })
}

fn cut_off(end: &End) -> Option<String> {
    (*end != End::Complete).then(|| end.to_string())
}

fn failure(error: &RecordingError) -> Failure {
    let help = match error {
        RecordingError::Open { .. } => "see whether the name is right and the file may be read",
        RecordingError::Read { .. } => {
            "see whether the disk is sound; copy the file and try the copy"
        }
        RecordingError::Empty { .. } | RecordingError::Short { .. } => {
            "the recording was never written: take it from its source again"
        }
        RecordingError::Foreign { .. } => {
            "give a pcap or pcapng with lidar packets, as tcpdump, Wireshark or velomotion capture write it"
        }
        RecordingError::Link { .. } => {
            "record on an Ethernet interface (tcpdump -i eth0 udp), or convert with editcap"
        }
    };
    Failure::new(Kind::BadInput, error.to_string()).help(help)
}
