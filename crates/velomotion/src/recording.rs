//! A recording under way: the lidar's socket on a thread of its own, both devices' traffic into one log.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;

use io::files::Overwrite;
use io::log::{LogConfig, LogError, LogWriter, Recorder, RecorderCounts, RecorderHandle};
use io::udp::{ListenConfig, ListenCounts, Listener, UdpError};
use protocol::record::{DriveLink, Record, Wire};
use scanner::ScanConfig;

use crate::config::Device;
use crate::failure::{Failure, Kind};
use crate::simulated::Destinations;

/// UDP port of data packets (VLP-16 manual, section 9).
pub const DATA_PORT: u16 = 2368;
/// UDP port of position packets.
pub const POSITION_PORT: u16 = 8308;

/// The lidar's sockets, bound; nothing is recorded yet.
pub struct Ear {
    listener: Listener,
    ports: Destinations,
}

/// Where a device's lidar is to be heard.
#[must_use]
pub fn listen_config(device: &Device) -> ListenConfig {
    ListenConfig {
        address: device.lidar,
        data_port: device.data_port.unwrap_or(DATA_PORT),
        position_port: Some(device.position_port.unwrap_or(POSITION_PORT)),
        group: device.lidar_group,
        sources: device.lidar_source.into_iter().collect(),
        ..ListenConfig::default()
    }
}

/// A recording under way.
pub struct Recording {
    log: Recorder,
    stop: Arc<AtomicBool>,
    packets: Arc<AtomicU64>,
    lidar: JoinHandle<Result<ListenCounts, UdpError>>,
}

/// What was recorded.
#[derive(Clone, Copy, Debug)]
pub struct Recorded {
    /// What the lidar's sockets heard and the kernel dropped.
    pub lidar: ListenCounts,
    /// What is in the log.
    pub log: RecorderCounts,
}

impl Ear {
    /// Binds the sockets.
    ///
    /// # Errors
    /// [`Kind::NoDevice`] where another program has the ports, or the address is not this machine's.
    pub fn bind(config: &ListenConfig) -> Result<Self, Failure> {
        let listener = Listener::bind(config).map_err(|error| lidar_failure(&error))?;
        let mut local = listener.sockets().iter().map(|s| s.address().port());
        let ports = Destinations {
            data: local.next().unwrap_or(DATA_PORT),
            position: local.next().unwrap_or(POSITION_PORT),
        };
        Ok(Self { listener, ports })
    }

    /// The local ports.
    #[must_use]
    pub fn ports(&self) -> Destinations {
        self.ports
    }
}

impl Recording {
    /// Makes the log and records from now on.
    ///
    /// # Errors
    /// [`Kind::Usage`] where the log exists and may not be replaced, [`Kind::BadInput`] where it cannot be made.
    pub fn start(
        ear: Ear,
        path: &Path,
        config: &ScanConfig,
        link: DriveLink,
    ) -> Result<Self, Failure> {
        let head = LogConfig {
            metadata: toml::to_string(config).map_err(|error| {
                Failure::new(
                    Kind::BadInput,
                    format!("the configuration has no TOML: {error}"),
                )
                .help("see whether every number in the configuration is finite")
            })?,
            drive: Some(link),
        };
        let writer =
            LogWriter::create(path, &head, Overwrite::Refuse).map_err(|e| log_failure(&e))?;
        let log = Recorder::start(writer).map_err(|e| log_failure(&e))?;
        let stop = Arc::new(AtomicBool::new(false));
        let packets = Arc::new(AtomicU64::new(0));
        let lidar = listen(ear, log.handle(), Arc::clone(&stop), Arc::clone(&packets))?;
        Ok(Self {
            log,
            stop,
            packets,
            lidar,
        })
    }

    /// Where the drive's records go.
    #[must_use]
    pub fn handle(&self) -> RecorderHandle {
        self.log.handle()
    }

    /// Lidar packets heard so far.
    #[must_use]
    pub fn packets(&self) -> u64 {
        self.packets.load(Ordering::Relaxed)
    }

    /// Whether the log cannot be written any more.
    #[must_use]
    pub fn failed(&self) -> bool {
        self.log.failed()
    }

    /// Stops listening and closes the log.
    ///
    /// # Errors
    /// [`Kind::Incomplete`] where the log could not be written to its end or the lidar's socket failed; what was written stays.
    pub fn finish(self) -> Result<Recorded, Failure> {
        self.stop.store(true, Ordering::Release);
        let lidar = self.lidar.join();
        let log = self.log.finish().map_err(|e| log_failure(&e))?;
        match lidar {
            Ok(Ok(lidar)) => Ok(Recorded { lidar, log }),
            Ok(Err(error)) => Err(Failure {
                kind: Kind::Incomplete,
                ..lidar_failure(&error)
            }),
            Err(_) => Err(
                Failure::new(Kind::Incomplete, "the lidar's thread panicked")
                    .help("this is a defect of the program; run with -vv and report what it says"),
            ),
        }
    }
}

fn listen(
    ear: Ear,
    log: RecorderHandle,
    stop: Arc<AtomicBool>,
    packets: Arc<AtomicU64>,
) -> Result<JoinHandle<Result<ListenCounts, UdpError>>, Failure> {
    let Ear {
        mut listener,
        ports,
    } = ear;
    std::thread::Builder::new()
        .name("lidar".to_owned())
        .spawn(move || {
            listener.run(&stop, |record| {
                packets.fetch_add(1, Ordering::Relaxed);
                log.record(&with_port_of_the_lidar(record, ports));
            })
        })
        .map_err(|error| Failure::new(Kind::NoDevice, format!("no thread for the lidar: {error}")))
}

/// In a log the lidar's packets stand under the ports that they have by the manual, whatever the socket's was.
fn with_port_of_the_lidar<'a>(record: &Record<'a>, local: Destinations) -> Record<'a> {
    let mut record = *record;
    if let Wire::Lidar { port, .. } = &mut record.wire {
        if *port == local.data {
            *port = DATA_PORT;
        } else if *port == local.position {
            *port = POSITION_PORT;
        }
    }
    record
}

fn lidar_failure(error: &UdpError) -> Failure {
    let help = match error {
        UdpError::Busy { .. } => {
            "close the other program that listens to the lidar (another capture, VeloView, a ROS driver)"
        }
        UdpError::NoInterface { .. } => {
            "give lidar in the device's profile an address of this machine, or 0.0.0.0"
        }
        UdpError::Io { action: "join", .. } => {
            "see whether lidar in the device's profile is the address of an interface that is up, or, where it is 0.0.0.0, whether a\n\
             route to lidar_group exists (ip route get GROUP)"
        }
        UdpError::NoRuntime { .. } | UdpError::Io { .. } => {
            "see whether the network interface is up and this user may open sockets"
        }
    };
    Failure::new(Kind::NoDevice, error.to_string()).help(help)
}

fn log_failure(error: &LogError) -> Failure {
    let (kind, help) = match error {
        LogError::Exists { .. } => (
            Kind::Usage,
            "choose another name with --log or -o, or overwrite it with --force",
        ),
        LogError::Create { .. } => (
            Kind::BadInput,
            "see whether the folder exists and may be written to",
        ),
        _ => (
            Kind::Incomplete,
            "see whether the disk is full; what was written is there and can be replayed",
        ),
    };
    Failure::new(kind, error.to_string()).help(help)
}
