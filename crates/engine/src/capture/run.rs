//! A capture from the first packet to the verdict, whoever asked for it: the command with devices of its own, or the daemon with those that
//! it keeps.
//!
//! Whatever ends it early, the axis is stopped first, then the log is closed. Opening devices, and saying things to people, is left to the
//! caller.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use drive::{CommandProgress, DriveClient, DriveEvent, ShaftSample};
use io::port::{Port, RecordingPort};
use io::udp::ListenConfig;
use protocol::record::{DriveLink, Record};
use scanner::{ScanConfig, TiltSource};
use sim::Truth;
use units::{Degrees, Host, Stamp};

use crate::capture::completeness::{self as wholeness, Watch};
use crate::capture::log_recorder::{Recorded, Recording};
use crate::capture::moves::{self as motion, MoveProgress, Step};
use crate::capture::request::CapturePlan;
use crate::devices::drive_session::{Session, SessionError};
use crate::devices::lidar_receiver::LidarReceiver;
use crate::devices::lidar_sockets::listen_config;
use crate::failure::{Failure, Kind};
use crate::output::Target;
use crate::reconstruct::replay::{self, Reconstruction, TimeReference};
use crate::reconstruct::report::{Reception, ScanReport};
use crate::reconstruct::source::Source;

/// Begins the line that says why there is no cloud of what else went wrong.
pub const NO_CLOUD: &str = "there is no cloud: ";
/// A lidar that turns sends 754 packets a second; one that sends none in this time will not send any during the sweep.
const LIDAR_WAIT: Duration = Duration::from_secs(2);

/// What a capture works with.
pub struct Job<'a> {
    /// What was decided beforehand.
    pub setup: &'a CapturePlan,
    /// Set by whoever wants the axis to stop.
    pub interrupt: &'a Arc<AtomicBool>,
    /// The lidar.
    pub hearing: &'a Arc<LidarReceiver>,
    /// The drive's port.
    pub port: &'a mut dyn Port,
    /// How the drive is attached.
    pub link: DriveLink,
    /// Speed of an RS232 line.
    pub rs232_baud: Option<u32>,
    /// Whoever else looks at the drive's records. It may not wait.
    pub onlooker: &'a dyn Fn(&Record<'_>),
}

/// What happens on the way.
#[derive(Clone, Copy, Debug)]
pub enum CaptureEvent<'a> {
    /// The moves begin: the lidar is heard.
    Begins,
    /// Move number `number`, from 0, of the plan begins.
    Move {
        /// Which.
        number: usize,
        /// What.
        step: &'a Step,
    },
    /// The axis is somewhere.
    Moved {
        /// When the drive said so.
        at: Stamp<Host>,
        /// Where.
        angle: Degrees,
        /// Lidar packets of this capture so far.
        packets: u64,
    },
    /// The drive client's own words.
    Progress(&'a CommandProgress),
    /// The axis has made its last move.
    Over,
    /// The disk is waited for, every few milliseconds.
    Saving,
    /// Something to be said.
    Warning(&'a str),
}

/// How a recording ended: both halves, for either may have failed.
pub struct Ended {
    motion: Result<(), SessionError>,
    recorded: Result<Recorded, Failure>,
    /// Why the capture itself had the axis stopped.
    stopped: Option<Failure>,
}

/// What there is to say of a recording whatever becomes of its cloud.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// What went wrong.
    pub failure: Option<Failure>,
    /// Records that were lost on the way to the log.
    pub lost_records: u64,
    /// What was heard.
    pub reception: Option<Reception>,
}

/// Records both devices while the axis makes its moves.
///
/// # Errors
/// [`Failure`] where nothing moved and nothing is recorded: no log is left then.
pub fn record(job: Job<'_>, told: &mut dyn FnMut(CaptureEvent<'_>)) -> Result<Ended, Failure> {
    let Job {
        setup, interrupt, ..
    } = job;
    let scan = ScanConfig {
        rs232_baud: job.rs232_baud,
        ..setup.scan.clone()
    };
    let recording = Recording::start(job.hearing, &setup.log, &scan, job.link)?;
    if let Err(failure) = await_lidar(&recording, setup, interrupt) {
        // Nothing has moved and nothing is recorded.
        let unwanted = recording
            .finish(&mut || {})
            .map_or(0, |heard| heard.lidar.unwanted);
        let _ = std::fs::remove_file(&setup.log);
        return Err(match unwanted {
            0 => failure,
            _ => Failure {
                message: format!(
                    "{}; {unwanted} packets came from other addresses",
                    failure.message
                ),
                ..failure
            },
        });
    }
    told(CaptureEvent::Begins);
    let (log, onlooker) = (recording.handle(), job.onlooker);
    let port = RecordingPort::new(job.port, job.link, move |record| {
        log.record(record);
        onlooker(record);
    });
    let client = DriveClient::new(setup.axis.clone(), job.link);
    let mut session = Session::new(client, port, Arc::clone(interrupt));
    let gearing = setup.axis.gearing;
    let mut number = 0;
    let mut watch = Watch::new(recording.packets());
    let motion = motion::run(&mut session, &setup.steps, &mut |what| {
        if recording.failed() || watch.silent(recording.packets()) {
            // A sweep that is not recorded is not worth making.
            interrupt.store(true, Ordering::Relaxed);
        }
        match what {
            MoveProgress::Step(step) => {
                told(CaptureEvent::Move { number, step });
                number += 1;
            }
            MoveProgress::Event(DriveEvent::Sample(ShaftSample {
                answer, position, ..
            })) => told(CaptureEvent::Moved {
                at: *answer,
                angle: gearing.angle(*position),
                packets: recording.packets(),
            }),
            MoveProgress::Event(DriveEvent::Progress(step)) => told(CaptureEvent::Progress(step)),
            MoveProgress::Event(event) => tracing::debug!(?event),
        }
    });
    told(CaptureEvent::Over);
    drop(session);
    let recorded = recording.finish(&mut || told(CaptureEvent::Saving));
    if let Ok(Recorded { lidar, .. }) = &recorded
        && lidar.without_kernel_time > 0
    {
        told(CaptureEvent::Warning(&format!(
            "{} lidar packets came without a kernel time: their times are less certain",
            lidar.without_kernel_time
        )));
    }
    Ok(Ended {
        stopped: watch.failure(),
        ..Ended::new(motion, recorded)
    })
}

/// Waits for the first packet: a sweep without a lidar is a sweep for nothing.
fn await_lidar(
    recording: &Recording,
    setup: &CapturePlan,
    interrupt: &AtomicBool,
) -> Result<(), Failure> {
    let pause = Duration::from_millis(5);
    let mut waited = Duration::ZERO;
    while recording.packets() == 0 {
        if interrupt.load(Ordering::Relaxed) {
            return Err(Failure::new(Kind::Interrupted, "stopped by the user")
                .help("nothing had moved yet"));
        }
        if waited >= LIDAR_WAIT {
            return Err(silence(&listen_config(&setup.device)));
        }
        std::thread::sleep(pause);
        waited += pause;
    }
    Ok(())
}

/// Nothing came to where a lidar was to be heard.
#[must_use]
pub fn silence(config: &ListenConfig) -> Failure {
    let data = config.data_port;
    let ports = match config.position_port.filter(|&position| position != data) {
        Some(position) => format!("UDP ports {data} and {position}"),
        None => format!("UDP port {data}"),
    };
    let source = match config.sources.as_slice() {
        [source, ..] => format!(" from {source}"),
        [] => String::new(),
    };
    let to = match config.group {
        Some(group) => format!("the group {group} on {}", config.address),
        None => config.address.to_string(),
    };
    Failure::new(
        Kind::NoDevice,
        format!("no lidar: no packet came{source} to {to}, {ports}, in 2 s"),
    )
    .help(format!(
        "see whether the lidar is powered and turns, its cable is in, this machine's address is the one it sends to\n\
         (its web page, or tcpdump -n udp port {data}), and no firewall drops its packets"
    ))
}

/// Makes the cloud of what was recorded.
///
/// # Errors
/// As [`replay::make`].
pub fn cloud(
    setup: &CapturePlan,
    truth: Option<&Truth>,
    lost_records: u64,
    interrupt: &AtomicBool,
    target: Target,
) -> Result<ScanReport, Failure> {
    let source = Source::open(&setup.log, None)?;
    let request = Reconstruction {
        recording: &source,
        tilt: TiltSource::Log,
        options: lidar::Options::default(),
        time: TimeReference::Host,
        accuracy: setup.accuracy,
        pace: None,
        truth,
        lost_records,
        interrupt,
    };
    replay::make(&request, target)
}

impl Ended {
    /// Of its two halves.
    #[must_use]
    pub const fn new(
        motion: Result<(), SessionError>,
        recorded: Result<Recorded, Failure>,
    ) -> Self {
        Self {
            motion,
            recorded,
            stopped: None,
        }
    }

    /// What went wrong with the moves.
    #[must_use]
    pub fn motion_error(&self) -> Option<&SessionError> {
        self.motion.as_ref().err()
    }

    /// Whether the axis stands.
    #[must_use]
    pub fn stands(&self) -> bool {
        !self.motion.as_ref().is_err_and(SessionError::may_move)
    }

    /// Whether the drive's port has failed.
    #[must_use]
    pub fn port_failed(&self) -> bool {
        matches!(self.motion, Err(SessionError::Port(_)))
    }

    /// Records that were lost on the way to the log.
    #[must_use]
    pub fn lost_records(&self) -> u64 {
        self.recorded.as_ref().map_or(0, lost_records)
    }

    /// What there is to say of it. What went wrong first is what the user must hear first.
    #[must_use]
    pub fn outcome(self) -> Outcome {
        let lost_records = self.lost_records();
        let reception = self.recorded.as_ref().ok().map(reception);
        let failure = match (self.motion, self.recorded) {
            // The log's failure is why the session was interrupted.
            (Err(SessionError::Interrupted), Err(failure)) | (Ok(()), Err(failure)) => {
                Some(failure)
            }
            (Err(SessionError::Interrupted), Ok(_)) if self.stopped.is_some() => self.stopped,
            (Err(error), recorded) => Some(motion_failure(&error, recorded.err())),
            (Ok(()), Ok(recorded)) => loss(&recorded),
        };
        Outcome {
            failure,
            lost_records,
            reception,
        }
    }
}

/// Says how it ended: a scan, and what is incomplete of it, be it that packets never came.
///
/// # Errors
/// Where there is no cloud.
pub fn conclude(
    made: Result<ScanReport, Failure>,
    outcome: Outcome,
    (cloud, log): (&Path, &Path),
) -> Result<(ScanReport, Option<Failure>), Failure> {
    let saved = match &made {
        Ok(_) => format!(
            "what was captured is saved: the cloud {} and the log {}",
            cloud.display(),
            log.display()
        ),
        Err(failure) => format!(
            "{NO_CLOUD}{}\nthe log is {}",
            failure.message,
            log.display()
        ),
    };
    let missing = || wholeness::missing(made.as_ref().ok()?);
    let failure = outcome.failure.clone().or_else(missing).map(|failure| {
        let help = failure
            .help
            .clone()
            .map_or(saved.clone(), |help| format!("{help}\n{saved}"));
        failure.help(help)
    });
    match (made, failure) {
        (Ok(scan), failure) => {
            let scan = ScanReport {
                reception: outcome.reception,
                ..scan
            };
            Ok((scan, failure))
        }
        (Err(_), Some(failure)) => Err(failure),
        (Err(failure), None) => Err(without_cloud(failure, log)),
    }
}

/// Why there is no cloud of a capture that went well: its log is saved, and what the log cannot be used for without being asked, such
/// as a choice between two lidars, `replay` can be told.
fn without_cloud(failure: Failure, log: &Path) -> Failure {
    let kind = match failure.kind {
        Kind::BadInput => Kind::Incomplete,
        kind => kind,
    };
    let saved = format!(
        "the log is saved: velomotion replay {} makes the cloud",
        log.display()
    );
    let help = failure
        .help
        .as_ref()
        .map_or(saved.clone(), |help| format!("{help}\n{saved}"));
    Failure { kind, ..failure }.help(help)
}

/// What the lidar's sockets and the log did.
fn reception(recorded: &Recorded) -> Reception {
    let Recorded { lidar, log } = recorded;
    Reception {
        packets: lidar.data + lidar.position,
        dropped_by_kernel: lidar.dropped,
        dropped_by_log: log.dropped + log.refused,
        without_kernel_time: lidar.without_kernel_time,
        from_others: lidar.unwanted,
    }
}

fn lost_records(recorded: &Recorded) -> u64 {
    recorded.lidar.dropped + recorded.log.dropped + recorded.log.refused
}

/// What was lost is said, never passed over.
fn loss(recorded: &Recorded) -> Option<Failure> {
    let losses = [
        (
            recorded.lidar.dropped,
            "lidar packets that this machine was too slow for",
        ),
        (
            recorded.log.dropped,
            "records that the disk was too slow for",
        ),
        (recorded.log.refused, "records that the log cannot hold"),
    ];
    let said: Vec<String> = losses
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| format!("{count} {what}"))
        .collect();
    (!said.is_empty()).then(|| {
        Failure::new(
            Kind::Incomplete,
            format!("the recording lost {}", said.join(", ")),
        )
        .help("close other programs, record to a faster disk, and scan again if the holes matter")
    })
}

fn motion_failure(error: &SessionError, recorded: Option<Failure>) -> Failure {
    let kind = match error {
        SessionError::Interrupted => Kind::Interrupted,
        SessionError::NotStopped(_) | SessionError::Drive(_) | SessionError::Port(_) => {
            Kind::DeviceFault
        }
    };
    let also = recorded.map_or(String::new(), |failure| {
        format!("; and {}", failure.message)
    });
    let failure = Failure::new(kind, format!("{error}{also}"));
    match error.help() {
        Some(help) => failure.help(help),
        None => failure,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_listened_for_in_vain_is_said() {
        let of = |config: &ListenConfig| silence(config).message;
        assert_eq!(
            of(&ListenConfig::default()),
            "no lidar: no packet came to 0.0.0.0, UDP ports 2368 and 8308, in 2 s"
        );
        let group = ListenConfig {
            data_port: 2369,
            position_port: Some(2369),
            group: Some([239, 1, 2, 3].into()),
            sources: vec![[192, 168, 1, 201].into()],
            ..ListenConfig::default()
        };
        assert_eq!(
            of(&group),
            "no lidar: no packet came from 192.168.1.201 to the group 239.1.2.3 on 0.0.0.0, UDP port 2369, in 2 s"
        );
    }

    #[test]
    fn a_capture_without_a_cloud_says_where_its_log_is() {
        let two = Failure::new(Kind::BadInput, "2 lidars in one recording")
            .help("choose one with --sensor");
        let failure = without_cloud(two, Path::new("hall.pcapng"));
        assert_eq!(failure.kind, Kind::Incomplete);
        assert_eq!(failure.message, "2 lidars in one recording");
        let help = failure.help.unwrap();
        assert!(
            help.contains("--sensor") && help.contains("replay hall.pcapng"),
            "{help}"
        );
        // Ctrl-C while the cloud is made stays what it is.
        let stopped = Failure::new(Kind::Interrupted, "stopped");
        let failure = without_cloud(stopped, Path::new("hall.pcapng"));
        assert_eq!(failure.kind, Kind::Interrupted);
    }
}
