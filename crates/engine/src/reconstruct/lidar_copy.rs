//! The lidar's datagrams of a recording as a classic pcap, for programs that do not read pcapng
//! with two kinds of interfaces.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use ::io::files::NewFile;
use ::io::log::{LogError, LogWriter};
use protocol::record::Wire;
use serde::Serialize;
use utoipa::ToSchema;

use super::replay::interrupted;
use super::source::Source;
use crate::failure::{Failure, Kind};
use crate::output::{file_failure, overwrite};

/// Counts of copied packets.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct LidarCopyReport {
    /// The pcap.
    #[schema(value_type = String)]
    pub output: PathBuf,
    /// Datagrams in it, those with positions included.
    pub datagrams: u64,
    /// Its size, bytes.
    pub bytes: u64,
    /// Whether the devices were simulated, which a pcap cannot say.
    pub simulated: bool,
    /// Where and why the recording ends early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truncated: Option<String>,
}

/// Copies the datagrams of the selected sensor to `output`, which gets its name once it is
/// complete.
///
/// # Errors
/// As [`Source::read`]; [`Kind::Usage`] for an existing file without `force`;
/// [`Kind::Interrupted`]; [`Kind::BadInput`] if `output` cannot be written, or without a datagram.
pub fn copy(
    source: &Source,
    output: &Path,
    force: bool,
    interrupt: &AtomicBool,
) -> Result<LidarCopyReport, Failure> {
    let cannot_write = |error: LogError| {
        Failure::new(Kind::BadInput, format!("{}: {error}", output.display()))
            .help("see whether the disk is full, or name another file with -o")
    };
    let file = NewFile::create(output, overwrite(force)).map_err(|error| file_failure(&error))?;
    let mut writer = LogWriter::pcap(file).map_err(cannot_write)?;
    let pass = source.read(|record| {
        if matches!(record.wire, Wire::Lidar { .. }) {
            writer.write(record).map_err(cannot_write)?;
        }
        match interrupt.load(Ordering::Relaxed) {
            true => Err(interrupted(source.path())),
            false => Ok(()),
        }
    })?;
    let (counts, file) = writer.finish().map_err(cannot_write)?;
    if counts.lidar == 0 {
        return Err(Failure::new(
            Kind::BadInput,
            format!(
                "{}: no datagram of a lidar to copy",
                source.path().display()
            ),
        )
        .help("velomotion info shows what the recording holds"));
    }
    let simulated = source.config()?.simulated;
    file.commit().map_err(|error| file_failure(&error))?;
    Ok(LidarCopyReport {
        output: output.to_owned(),
        datagrams: counts.lidar,
        bytes: counts.bytes,
        simulated,
        truncated: pass.truncated,
    })
}
