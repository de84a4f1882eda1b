//! Default names of output files.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// A time in RFC 3339, UTC.
#[must_use]
pub fn time_text(time: SystemTime) -> String {
    humantime::format_rfc3339_seconds(time).to_string()
}

/// Default cloud of a capture: date, and `simulated` for simulated devices.
#[must_use]
pub fn cloud(start: SystemTime, simulated: bool) -> PathBuf {
    let time = time_text(start).replace(':', "-");
    let what = if simulated { "-simulated" } else { "" };
    PathBuf::from(format!("velomotion{what}-{time}.ply"))
}

/// Default log of a cloud: the same name with `.pcapng`. A cloud on stdout gets a log in the
/// working directory.
#[must_use]
pub fn log_of(cloud: &Path, start: SystemTime, simulated: bool) -> PathBuf {
    if cloud == Path::new("-") {
        return self::cloud(start, simulated).with_extension("pcapng");
    }
    cloud.with_extension("pcapng")
}

/// Default cloud of a recording, in the working directory.
#[must_use]
pub fn cloud_of(recording: &Path) -> PathBuf {
    if recording == Path::new("-") {
        return PathBuf::from("recording.ply");
    }
    let mut name = recording
        .file_stem()
        .unwrap_or(recording.as_os_str())
        .to_owned();
    name.push(".ply");
    PathBuf::from(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn simulated_scans_are_named_so() {
        let start = SystemTime::UNIX_EPOCH + Duration::from_secs(1_795_226_733);
        assert_eq!(
            cloud(start, true),
            Path::new("velomotion-simulated-2026-11-21T02-05-33Z.ply")
        );
        assert_eq!(
            log_of(&cloud(start, false), start, false),
            Path::new("velomotion-2026-11-21T02-05-33Z.pcapng")
        );
        assert_eq!(
            log_of(Path::new("-"), start, true),
            Path::new("velomotion-simulated-2026-11-21T02-05-33Z.pcapng")
        );
    }

    #[test]
    fn the_cloud_of_a_recording_goes_to_the_current_directory() {
        assert_eq!(
            cloud_of(Path::new("/data/hall.pcap")),
            Path::new("hall.ply")
        );
        assert_eq!(cloud_of(Path::new("-")), Path::new("recording.ply"));
        assert_eq!(cloud_of(Path::new("a.b.pcapng")), Path::new("a.b.ply"));
    }
}
