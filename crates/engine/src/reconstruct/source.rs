//! Recordings as a source of records: passes over a file or pipe, the selected sensor, the log's
//! configuration.

use std::collections::BTreeSet;
use std::fmt;
use std::io::ErrorKind;
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use io::recording::{
    DatagramKind, End, Recording, RecordingCounts, RecordingError, RecordingInput, SPOOL_LIMIT,
};
use protocol::record::{Record, Wire};
use scanner::ScanConfig;

use super::copies::RecordCopies;
use crate::config::MountSettings;
use crate::failure::{Failure, Kind};

/// A recording and its selected sensor.
#[derive(Debug)]
pub struct Source {
    path: PathBuf,
    input: RecordingInput,
    wanted: Option<SensorAddress>,
    mount: Option<MountSettings>,
}

/// Name of a sensor: its address, and its data port if one address has several.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SensorAddress {
    pub(super) address: Ipv4Addr,
    pub(super) port: Option<u16>,
}

/// Result of one pass over a recording.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PassSummary {
    /// Packet counts by kind.
    pub counts: RecordingCounts,
    /// Place and cause of an early end of the file.
    pub truncated: Option<String>,
    /// Data packets that the file has twice. The second ones were left out.
    pub doubled_packets: u64,
    /// Records of the drive that the file has twice. The second ones were left out.
    pub doubled_frames: u64,
}

impl FromStr for SensorAddress {
    type Err = String;

    /// `ADDRESS` or `ADDRESS:PORT`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (address, port) = match text.split_once(':') {
            None => (text, None),
            Some((address, port)) => {
                let port = port
                    .parse()
                    .map_err(|_| format!("expected a port from 0 to 65535, got {port:?}"))?;
                (address, Some(port))
            }
        };
        let address = address
            .parse()
            .map_err(|_| format!("expected an IPv4 address, got {address:?}"))?;
        Ok(Self { address, port })
    }
}

impl fmt::Display for SensorAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.address)?;
        match self.port {
            Some(port) => write!(f, ":{port}"),
            None => Ok(()),
        }
    }
}

/// The largest number of separate sensors, which bounds memory.
const MAX_SENSORS: usize = 256;

/// Selects the records of one sensor; by default of the first that sends data.
#[derive(Debug)]
struct Filter {
    source: Option<[u8; 4]>,
    port: Option<u16>,
    /// Sensors that send data.
    sensors: BTreeSet<SensorAddress>,
}

impl Filter {
    /// Whether a record is of the drive or of the selected sensor.
    fn takes(&mut self, record: &Record<'_>) -> bool {
        let Wire::Lidar {
            source,
            port,
            payload,
        } = record.wire
        else {
            return true;
        };
        match DatagramKind::of(payload) {
            DatagramKind::Data => {
                if self.sensors.len() < MAX_SENSORS {
                    self.sensors.insert(SensorAddress {
                        address: source.into(),
                        port: Some(port),
                    });
                }
                *self.source.get_or_insert(source) == source
                    && *self.port.get_or_insert(port) == port
            }
            // A damaged packet of another sender is not the lidar's.
            DatagramKind::Damaged => {
                self.source.is_none_or(|wanted| wanted == source)
                    && self.port.is_none_or(|wanted| wanted == port)
            }
            DatagramKind::Position => self.source.is_none_or(|wanted| wanted == source),
            DatagramKind::Foreign => true,
        }
    }
}

impl Source {
    /// Opens a recording; `-` is stdin. A pipe is spooled to a temporary file.
    ///
    /// # Errors
    /// [`Kind::BadInput`] for a missing, empty or foreign file.
    pub fn open(path: &Path, wanted: Option<SensorAddress>) -> Result<Self, Failure> {
        let input = RecordingInput::open(path, SPOOL_LIMIT).map_err(|error| failure(&error))?;
        let source = Self {
            path: path.to_owned(),
            input,
            wanted,
            mount: None,
        };
        drop(source.recording()?);
        Ok(source)
    }

    /// Path of the recording.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn recording(&self) -> Result<Recording, Failure> {
        self.input.recording().map_err(|error| failure(&error))
    }

    /// Replaces mount and calibration of the recording's configuration.
    pub fn set_mount(&mut self, mount: MountSettings) {
        self.mount = Some(mount);
    }

    /// Whether the recording is a log with the configuration of its scanner.
    ///
    /// # Errors
    /// [`Kind::BadInput`] for an unreadable file.
    pub fn has_config(&self) -> Result<bool, Failure> {
        Ok(self.recording()?.metadata().is_some_and(is_own))
    }

    /// The configuration in a log; defaults for a plain recording.
    ///
    /// # Errors
    /// [`Kind::BadInput`] for an unreadable file or an invalid configuration in a log.
    pub fn config(&self) -> Result<ScanConfig, Failure> {
        let config = self.recorded_config()?;
        Ok(match &self.mount {
            None => config,
            Some(mount) => ScanConfig {
                mount: mount.pose(),
                calibration: mount.calibration().cloned(),
                ..config
            },
        })
    }

    fn recorded_config(&self) -> Result<ScanConfig, Failure> {
        let recording = self.recording()?;
        let Some(text) = recording.metadata().filter(|text| is_own(text)) else {
            return Ok(ScanConfig::default());
        };
        let (text, merged) = text.split_once(MERGED).unwrap_or((text, ""));
        if merged.matches("\nFile").count() > 1 {
            return Err(self
                .joined("mergecap has joined it with other files".to_owned())
                .help("replay each of these files"));
        }
        let wrong = |what: String| {
            Failure::new(
                Kind::BadInput,
                format!(
                    "{}: the log's configuration is invalid:\n{what}",
                    self.path.display()
                ),
            )
            .help("replay the log with the version named in its first line")
        };
        let config: ScanConfig = toml::from_str(text).map_err(|error| wrong(error.to_string()))?;
        if !config.mount.is_finite() {
            return Err(wrong(format!("the mount is {:?}", config.mount)));
        }
        let calibration = config.calibration.as_ref();
        calibration
            .map_or(Ok(()), |calibration| calibration.check())
            .map_err(|error| wrong(error.to_string()))?;
        Ok(config)
    }

    /// Passes every record of the selected sensor and of the drive to `take`, in file order.
    ///
    /// # Errors
    /// The file is unreadable, the selected sensor is absent or ambiguous, or `take` fails.
    pub fn read(
        &self,
        take: impl FnMut(&Record<'_>) -> Result<(), Failure>,
    ) -> Result<PassSummary, Failure> {
        let mut filter = self.filter();
        let pass = self.read_where(|record| filter.takes(record), take)?;
        self.check(&filter.sensors)?;
        Ok(pass)
    }

    /// Passes records of the selected sensor and of the drive to `take` until it returns false.
    ///
    /// # Errors
    /// The file is unreadable.
    pub fn read_until(&self, mut take: impl FnMut(&Record<'_>) -> bool) -> Result<(), Failure> {
        let mut filter = self.filter();
        let mut recording = self.recording()?;
        let mut copies = RecordCopies::default();
        while let Some(record) = recording.next_record().map_err(|error| failure(&error))? {
            if filter.takes(&record) && !copies.has(&record) && !take(&record) {
                break;
            }
        }
        Ok(())
    }

    fn filter(&self) -> Filter {
        Filter {
            source: self.wanted.map(|wanted| wanted.address.octets()),
            port: self.wanted.and_then(|wanted| wanted.port),
            sensors: BTreeSet::new(),
        }
    }

    /// Passes every record to `take`, in file order; copies of recent ones are left out.
    ///
    /// # Errors
    /// The file is unreadable or `take` fails.
    pub fn read_all(
        &self,
        take: impl FnMut(&Record<'_>) -> Result<(), Failure>,
    ) -> Result<PassSummary, Failure> {
        self.read_where(|_| true, take)
    }

    fn read_where(
        &self,
        mut is_wanted: impl FnMut(&Record<'_>) -> bool,
        mut take: impl FnMut(&Record<'_>) -> Result<(), Failure>,
    ) -> Result<PassSummary, Failure> {
        let mut recording = self.recording()?;
        let mut copies = RecordCopies::default();
        while let Some(record) = recording.next_record().map_err(|error| failure(&error))? {
            // Copies of other sensors are not counted.
            if is_wanted(&record) && !copies.has(&record) {
                take(&record)?;
            }
        }
        let counts = recording.counts().clone();
        if let Some(offset) = counts.second_section.filter(|_| self.is_own(&recording)) {
            let file = self.path.display();
            return Err(self.joined(format!("a second one begins at byte {offset}")).help(format!(
                "cut it apart there:\n  head -c {offset} {file} > first.pcapng\n  tail -c +{} {file} > second.pcapng",
                offset.saturating_add(1)
            )));
        }
        Ok(PassSummary {
            counts,
            truncated: recording.end().and_then(cut_off),
            doubled_packets: copies.doubled_packets,
            doubled_frames: copies.doubled_frames,
        })
    }

    fn is_own(&self, recording: &Recording) -> bool {
        recording.metadata().is_some_and(is_own)
    }

    /// A file of several logs: each has its own clocks, zero and configuration.
    fn joined(&self, how: String) -> Failure {
        let file = self.path.display();
        Failure::new(
            Kind::BadInput,
            format!("{file}: expected one log, got several: {how}"),
        )
    }

    /// Checks that the selection names exactly one sensor that is present.
    fn check(&self, sensors: &BTreeSet<SensorAddress>) -> Result<(), Failure> {
        let list = || {
            let names: Vec<String> = sensors.iter().map(ToString::to_string).collect();
            names.join(", ")
        };
        let is_meant = |sensor: &&SensorAddress| {
            self.wanted.is_none_or(|wanted| {
                wanted.address == sensor.address
                    && wanted.port.is_none_or(|port| sensor.port == Some(port))
            })
        };
        let path = self.path.display();
        match (sensors.iter().filter(is_meant).count(), self.wanted) {
            (1, _) | (0, None) => Ok(()),
            (0, Some(wanted)) => Err(Failure::new(
                Kind::BadInput,
                format!("{path}: no lidar at {wanted}; there is: {}", list()),
            )
            .help("name one of these with --sensor")),
            (several, _) => Err(Failure::new(
                Kind::BadInput,
                format!("{path}: {several} lidars in one recording: {}", list()),
            )
            .help("choose one with --sensor ADDRESS or --sensor ADDRESS:PORT; velomotion info describes each")),
        }
    }
}

/// Beginning of what mergecap appends to a comment: the files, a line each.
const MERGED: &str = "\nFile created by merging:";

/// Whether a comment is a log's configuration. Other programs write comments too.
fn is_own(comment: &str) -> bool {
    comment.trim_start().starts_with("velomotion = ")
}

fn cut_off(end: &End) -> Option<String> {
    (*end != End::Complete).then(|| end.to_string())
}

/// The failure for a recording error.
#[must_use]
pub fn failure(error: &RecordingError) -> Failure {
    let help = match error {
        RecordingError::Open { .. } => "check the name and the read permission",
        RecordingError::Read { source, .. } if source.kind() == ErrorKind::IsADirectory => {
            "name one recording in it"
        }
        RecordingError::Read { .. } => "check the disk; copy the file and try the copy",
        RecordingError::Empty { .. } | RecordingError::Short { .. } => {
            "copy the recording from its source again"
        }
        RecordingError::Foreign { .. } => {
            "give a pcap or pcapng with lidar packets, as tcpdump, Wireshark or velomotion capture write it; velomotion view shows clouds, by their extension: .ply for a PLY"
        }
        RecordingError::Link { .. } => {
            "record on an Ethernet interface (tcpdump -i eth0 udp), or convert with editcap"
        }
    };
    Failure::new(Kind::BadInput, error.to_string()).help(help)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sensors_are_named_by_address_and_port() {
        for text in ["192.168.1.201", "10.0.0.7:2369"] {
            assert_eq!(text.parse::<SensorAddress>().unwrap().to_string(), text);
        }
        for text in ["", "lidar", "10.0.0.7:", "10.0.0.7:70000", "10.0.0:2368"] {
            assert!(text.parse::<SensorAddress>().is_err(), "{text}");
        }
    }
}
