//! A capture from the first packet to the report on it, with devices that the caller has opened.
//!
//! If it ends early, the axis is stopped first, then the log is closed.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use drive::{CommandProgress, DriveClient, DriveEvent};
use io::port::{Port, RecordingPort};
use io::udp::ListenConfig;
use protocol::record::{DriveLink, Record};
use scanner::{Accuracy, ScanConfig};
use sim::Truth;

use crate::capture::capture_log::{CaptureCounts, CaptureLog};
use crate::capture::completeness::{self, SilenceWatch};
use crate::capture::plan::CapturePlan;
use crate::capture::run_moves::{self, MoveProgress};
use crate::devices::drive_session::{Session, SessionError};
use crate::devices::guardian::Guardian;
use crate::devices::lidar_receiver::LidarReceiver;
use crate::devices::lidar_sockets::listen_config;
use crate::failure::{Failure, Kind};
use crate::output::Target;
use crate::reconstruct::replay::{self, Reconstruction};
use crate::reconstruct::report::{Reception, ScanReport};
use crate::reconstruct::source::Source;

/// Wait for the first packet. A lidar in rotation sends 754 packets per second: one that sends none
/// in this time will send none during the sweep.
const LIDAR_WAIT: Duration = Duration::from_secs(2);
/// Between two polls for the first packet.
const LIDAR_POLL: Duration = Duration::from_millis(5);

/// Devices and files of a capture.
#[non_exhaustive]
pub struct CaptureJob<'a> {
    /// The plan.
    pub plan: &'a CapturePlan,
    /// Set to stop the axis.
    pub interrupt: &'a Arc<AtomicBool>,
    /// The lidar.
    pub lidar: &'a Arc<LidarReceiver>,
    /// The drive's port.
    pub port: &'a mut dyn Port,
    /// Stops the axis if this process dies.
    pub guardian: Option<&'a mut Guardian>,
    /// Whether the machine stays awake while the axis may move: it is no simulated device.
    pub keeps_awake: bool,
    /// Link of the drive.
    pub link: DriveLink,
    /// Speed of an RS232 line.
    pub rs232_baud: Option<u32>,
    /// Called with each of the drive's records. It may not block.
    pub tap: &'a dyn Fn(&Record<'_>),
}

/// Progress of a capture.
#[derive(Clone, Copy, Debug)]
pub enum CaptureEvent<'a> {
    /// The lidar sends packets; the moves begin.
    Started,
    /// Progress of the moves, and the lidar packets of this capture so far.
    Motion(MoveProgress<'a>, u64),
    /// The last move has ended.
    MotionEnded,
    /// The log is being written to disk; sent every few milliseconds.
    Saving,
}

/// The end of a recording: motion and log, either of which may have failed.
pub struct RecordingEnd {
    motion: Result<(), SessionError>,
    log: Result<CaptureCounts, Failure>,
    /// Reason for which the capture itself stopped the axis.
    stopped: Option<Failure>,
    /// Whether it failed before the axis had power: no log is left then.
    pub is_empty: bool,
}

/// The recording's part of the report, independent of its cloud.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// The failure.
    pub failure: Option<Failure>,
    /// Records lost on the way to the log.
    pub lost_records: u64,
    /// Counts of packets.
    pub reception: Option<Reception>,
    /// Warnings about its completeness and its motion.
    pub warnings: Vec<String>,
}

/// Records both devices while the axis makes its moves.
///
/// # Errors
/// [`Failure`] where nothing moved and nothing is recorded: no log is left then.
pub fn record(
    job: CaptureJob<'_>,
    on_event: &mut dyn FnMut(CaptureEvent<'_>),
) -> Result<RecordingEnd, Failure> {
    let CaptureJob {
        plan, interrupt, ..
    } = job;
    let scan = ScanConfig {
        rs232_baud: job.rs232_baud,
        ..plan.scan.clone()
    };
    let recorder = CaptureLog::start(job.lidar, &plan.log, &scan, job.link)?;
    if let Err(failure) = await_lidar(&recorder, plan, interrupt) {
        let unwanted = recorder
            .finish(&mut || {})
            .map_or(0, |counts| counts.lidar.unwanted);
        let _ = std::fs::remove_file(&plan.log);
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
    on_event(CaptureEvent::Started);
    let (log, tap) = (recorder.handle(), job.tap);
    let port = RecordingPort::new(job.port, job.link, move |record| {
        log.record(record);
        tap(record);
    });
    let client = DriveClient::new(plan.axis.clone(), job.link);
    let mut session = Session::new(client, port, Arc::clone(interrupt))
        .guarded_by(job.guardian)
        .keeping_awake(job.keeps_awake);
    let mut watch = SilenceWatch::new(recorder.packets());
    let mut powered = false;
    let motion = run_moves::run(&mut session, &plan.steps, &mut |progress| {
        powered |= matches!(progress, MoveProgress::Event(event) if is_powered(event));
        let packets = recorder.packets();
        if recorder.failed() || watch.silent(packets) {
            // A sweep that is not recorded is not worth making.
            interrupt.store(true, Ordering::Relaxed);
        }
        on_event(CaptureEvent::Motion(progress, packets));
    });
    on_event(CaptureEvent::MotionEnded);
    drop(session);
    let log = recorder.finish(&mut || on_event(CaptureEvent::Saving));
    let is_empty = motion.is_err() && !powered;
    if is_empty {
        // A log without a move is of no use, and would be in the way of the next capture.
        let _ = std::fs::remove_file(&plan.log);
    }
    Ok(RecordingEnd {
        stopped: watch.failure(),
        is_empty,
        ..RecordingEnd::new(motion, log)
    })
}

/// Whether an event shows that the axis has power.
fn is_powered(event: &DriveEvent) -> bool {
    use CommandProgress::{Enabled, Homing, Moving};
    matches!(event, DriveEvent::Progress(Enabled | Homing | Moving(_)))
}

/// Waits for the first packet, before anything moves.
fn await_lidar(
    recorder: &CaptureLog,
    plan: &CapturePlan,
    interrupt: &AtomicBool,
) -> Result<(), Failure> {
    let mut waited = Duration::ZERO;
    while recorder.packets() == 0 {
        if interrupt.load(Ordering::Relaxed) {
            return Err(Failure::new(Kind::Interrupted, "stopped by the user")
                .help("nothing had moved yet"));
        }
        if waited >= LIDAR_WAIT {
            return Err(silence(&listen_config(&plan.device), LIDAR_WAIT));
        }
        std::thread::sleep(LIDAR_POLL);
        waited += LIDAR_POLL;
    }
    Ok(())
}

/// The failure of a lidar that sent nothing for so long.
#[must_use]
pub fn silence(config: &ListenConfig, waited: Duration) -> Failure {
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
        format!("no lidar: no packet came{source} to {to}, {ports}, in {} s",
            waited.as_secs()
        ),
    )
    .help(format!(
        "see whether the lidar is powered and turns, its cable is in, this machine's address is the one it sends to\n\
         (its web page, or tcpdump -n udp port {data}), and no firewall drops its packets"
    ))
}

/// Makes the cloud of a capture from its log, and compares it with the live view if `live`.
///
/// # Errors
/// As [`replay::make`].
pub fn cloud(
    (log, accuracy): (&Path, Accuracy),
    truth: Option<&Truth>,
    live: bool,
    lost_records: u64,
    interrupt: &AtomicBool,
    target: Target,
) -> Result<ScanReport, Failure> {
    let source = Source::open(log, None)?;
    let request = Reconstruction {
        truth,
        live,
        lost_records,
        ..Reconstruction::of_log(&source, accuracy, interrupt)?
    };
    replay::make(&request, target)
}

impl RecordingEnd {
    /// The end of a motion and of its log.
    #[must_use]
    pub const fn new(
        motion: Result<(), SessionError>,
        log: Result<CaptureCounts, Failure>,
    ) -> Self {
        Self {
            motion,
            log,
            stopped: None,
            is_empty: false,
        }
    }

    /// Error of the motion, if it failed.
    #[must_use]
    pub fn motion_error(&self) -> Option<&SessionError> {
        self.motion.as_ref().err()
    }

    /// Whether the axis is at rest.
    #[must_use]
    pub fn at_rest(&self) -> bool {
        !self.motion.as_ref().is_err_and(SessionError::may_move)
    }

    /// The report on it. What went wrong first comes first.
    #[must_use]
    pub fn outcome(self) -> Outcome {
        let counts = self.log.as_ref().ok();
        let lost_records = counts.map_or(0, lost_records);
        let reception = counts.map(reception);
        let without_time = counts.map_or(0, |counts| counts.lidar.without_kernel_time);
        let warnings = match without_time {
            0 => Vec::new(),
            count => vec![format!(
                "{count} lidar packets came without a kernel time: their times are less certain"
            )],
        };
        let failure = match (self.motion, self.log) {
            // The log's failure is why the session was interrupted.
            (Err(SessionError::Interrupted), Err(failure)) | (Ok(()), Err(failure)) => {
                Some(failure)
            }
            (Err(SessionError::Interrupted), Ok(_)) if self.stopped.is_some() => self.stopped,
            (Err(error), log) => Some(motion_failure(&error, log.err())),
            (Ok(()), Ok(counts)) => loss(&counts),
        };
        Outcome {
            failure,
            lost_records,
            reception,
            warnings,
        }
    }
}

/// Cause of an incomplete scan, and the location of the captured data.
#[derive(Debug)]
pub struct ScanFailure {
    /// The first failure.
    pub cause: Failure,
    /// Reason for the missing cloud, where it differs from the cause.
    pub no_cloud: Option<String>,
    /// Location of the captured data.
    saved: String,
}

impl ScanFailure {
    /// All of it as one failure.
    #[must_use]
    pub fn into_failure(self) -> Failure {
        let help = [self.cause.help.clone(), self.no_cloud, Some(self.saved)];
        let lines: Vec<String> = help.into_iter().flatten().collect();
        self.cause.help(lines.join("\n"))
    }
}

/// Joins the cloud and the outcome of its recording: a scan, and why it is incomplete.
///
/// # Errors
/// Where there is no cloud.
pub fn conclude(
    made: Result<ScanReport, Failure>,
    outcome: Outcome,
    (cloud, log): (&Path, &Path),
) -> Result<(ScanReport, Option<ScanFailure>), ScanFailure> {
    let log = log.display();
    let earlier = match cloud.is_file() {
        true => format!("; {} is that of an earlier scan", cloud.display()),
        false => String::new(),
    };
    Err(match (made, outcome.failure) {
        (Ok(mut scan), failure) => {
            // A daemon's report already has them.
            let warnings = &mut scan.contents.warnings;
            for warning in outcome.warnings {
                if !warnings.contains(&warning) {
                    warnings.push(warning);
                }
            }
            let cause = failure.or_else(|| completeness::missing(&scan));
            let failure = cause.map(|cause| ScanFailure {
                cause,
                no_cloud: None,
                saved: format!(
                    "what was captured is saved: the cloud {} and the log {log}",
                    cloud.display()
                ),
            });
            let reception = outcome.reception;
            return Ok((ScanReport { reception, ..scan }, failure));
        }
        (Err(making), Some(cause)) => ScanFailure {
            cause: cause.warned(outcome.warnings),
            no_cloud: Some(format!("there is no cloud: {}{earlier}", making.message)),
            saved: format!("the log is {log}"),
        },
        // The capture is complete.
        (Err(making), None) => ScanFailure {
            saved: match making.kind {
                // It needs a choice, such as one of two lidars, or lacks the positions of a sweep.
                Kind::BadInput => format!(
                    "the log is saved; make the cloud with velomotion replay {log} and the options named above{earlier}"
                ),
                _ => format!("the log is saved: velomotion replay {log} makes the cloud{earlier}"),
            },
            cause: Failure {
                kind: match making.kind {
                    Kind::BadInput => Kind::Incomplete,
                    kind => kind,
                },
                ..making.warned(outcome.warnings)
            },
            no_cloud: None,
        },
    })
}

fn reception(counts: &CaptureCounts) -> Reception {
    let CaptureCounts { lidar, log } = counts;
    Reception {
        received: lidar.data + lidar.position,
        dropped_by_kernel: lidar.dropped,
        dropped_by_log: log.dropped + log.refused,
        without_kernel_time: lidar.without_kernel_time,
        from_others: lidar.unwanted,
    }
}

fn lost_records(counts: &CaptureCounts) -> u64 {
    counts.lidar.dropped + counts.log.dropped + counts.log.refused
}

/// The failure of a recording with losses.
fn loss(counts: &CaptureCounts) -> Option<Failure> {
    let losses = [
        (
            counts.lidar.dropped,
            "lidar packets that this machine was too slow for",
        ),
        (counts.log.dropped, "records that the disk was too slow for"),
        (counts.log.refused, "records that the log cannot hold"),
    ];
    let losses: Vec<String> = losses
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| format!("{count} {what}"))
        .collect();
    (!losses.is_empty()).then(|| {
        Failure::new(
            Kind::Incomplete,
            format!("the recording lost {}", losses.join(", ")),
        )
        .help("close other programs, record to a faster disk, and scan again if the holes matter")
    })
}

fn motion_failure(error: &SessionError, log: Option<Failure>) -> Failure {
    let also = log.map_or(String::new(), |failure| {
        format!("; and {}", failure.message)
    });
    let failure = Failure::new(error.kind(), format!("{error}{also}"));
    match error.help() {
        Some(help) => failure.help(help),
        None => failure,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_lidar_is_reported_with_address_and_ports() {
        let of = |config: &ListenConfig| silence(config, LIDAR_WAIT).message;
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
    fn a_capture_without_a_cloud_reports_its_log() {
        let two = Failure::new(Kind::BadInput, "2 lidars in one recording")
            .help("choose one with --sensor");
        let without_cloud = |making| {
            let files = (Path::new("hall.ply"), Path::new("hall.pcapng"));
            let outcome = Outcome {
                warnings: vec!["the axis moved by 2.00 deg".to_owned()],
                ..Outcome::default()
            };
            let concluded = conclude(Err(making), outcome, files);
            concluded.unwrap_err().into_failure()
        };
        let failure = without_cloud(two);
        assert_eq!(failure.kind, Kind::Incomplete);
        assert_eq!(failure.message, "2 lidars in one recording");
        let help = failure.help.unwrap();
        assert!(
            ["--sensor", "replay hall.pcapng", "moved by 2.00 deg"]
                .iter()
                .all(|part| help.contains(part)),
            "{help}"
        );
        // Ctrl-C during the reconstruction remains an interruption.
        let stopped = Failure::new(Kind::Interrupted, "stopped");
        let failure = without_cloud(stopped);
        assert_eq!(failure.kind, Kind::Interrupted);
    }
}
