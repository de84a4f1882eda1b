//! `velomotion capture`: home, sweep, record, and make the cloud of what was recorded.
//!
//! Whatever ends a capture early, the axis is stopped first, then the log is closed and the cloud made of what it holds.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use drive::{Client, Event, ShaftSample};
use io::port::Recorder;
use io::udp::ListenConfig;
use scanner::ScanConfig;
use scanner::TiltSource;
use sim::Truth;

use super::Said;
use super::replay::{self, Request};
use crate::cli::{self, Common, TimeOf};
use crate::control::Control;
use crate::failure::{Failure, Kind};
use crate::motion::{self, Told};
use crate::output::{self, Aside, Target};
use crate::progress::Progress;
use crate::recording::{Ear, Recorded, Recording, listen_config};
use crate::recordings::Source;
use crate::report::{Reception, Scan};
use crate::session::{Session, SessionError};
use crate::setup::Setup;
use crate::signals;
use crate::simulated::{self, Simulated};
use crate::{devices, ports};

/// A lidar that turns sends 754 packets a second; one that sends none in this time will not send any during the sweep.
const LIDAR_WAIT: Duration = Duration::from_secs(2);

/// How a recording ended: both halves, for either may have failed.
struct Ended {
    motion: Result<(), SessionError>,
    recorded: Result<Recorded, Failure>,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] where nothing was recorded, or no cloud came of it.
pub fn run(arguments: &cli::Capture, common: &Common) -> Result<Said, Failure> {
    let setup = Setup::new(arguments, common)?;
    output::one_for_stdout(Some(&setup.cloud), common.json)?;
    let target = Target::open(&setup.cloud, arguments.output.fields(), setup.force)?;
    output::check_free(&setup.log, setup.force)?;
    let interrupt = signals::interrupt_flag()?;
    let mut progress = Progress::new(common);
    for line in setup.headline() {
        progress.say(&line);
    }

    let older_log = Aside::put(&setup.log)?;
    let (truth, ended) = if devices::simulated(&setup.device) {
        simulate(&setup, &interrupt, &mut progress)?
    } else {
        let ear = Ear::bind(&listen_config(&setup.device))?;
        let place = ports::place(&setup.name, &setup.device)?;
        (
            None,
            record(&setup, ear, &place, &interrupt, &mut progress)?,
        )
    };
    // The stop is over; from here on Ctrl-C means the making of the cloud.
    interrupt.store(false, Ordering::Relaxed);
    progress.say("making the cloud");
    let stdout = target.is_stdout();
    let source = Source::open(&setup.log, None)?;
    let request = Request {
        recording: &source,
        tilt: TiltSource::Log,
        options: lidar::Options::default(),
        time: TimeOf::Host,
        accuracy: arguments.accuracy.wanted(),
        pace: None,
        truth: truth.as_ref(),
        interrupt: &interrupt,
    };
    let made = replay::make(&request, target);
    // A log without a sweep is not worth an older one; any other is.
    if !matches!(&made, Err(failure) if failure.kind == Kind::BadInput) {
        older_log.replaced();
    }
    conclude(&setup, made, ended, stdout)
}

/// The same, against software devices that are started for it; with what truly happened.
fn simulate(
    setup: &Setup,
    interrupt: &Arc<AtomicBool>,
    progress: &mut Progress,
) -> Result<(Option<Truth>, Ended), Failure> {
    let ear = Ear::bind(&ListenConfig {
        address: setup.device.lidar,
        data_port: 0,
        position_port: Some(0),
        ..ListenConfig::default()
    })?;
    let rig = simulated::rig(&setup.axis, &setup.scan, io::clock::now());
    let devices = Simulated::start(rig, ear.ports())?;
    let path = devices.port().to_owned();
    let ended = record(setup, ear, &path, interrupt, progress);
    let truth = devices.stop();
    Ok((Some(truth?), ended?))
}

/// Records both devices while the axis makes its moves.
fn record(
    setup: &Setup,
    ear: Ear,
    place: &Path,
    interrupt: &Arc<AtomicBool>,
    progress: &mut Progress,
) -> Result<Ended, Failure> {
    let opened = ports::open(&setup.device, place)?;
    if let Some(warning) = &opened.warning {
        progress.say(&format!("warning: {warning}"));
    }
    let scan = ScanConfig {
        rs232_baud: opened.rs232_baud,
        ..setup.scan.clone()
    };
    let recording = Recording::start(ear, &setup.log, &scan, opened.link)?;
    if let Err(failure) = await_lidar(&recording, setup, interrupt) {
        // Nothing has moved and nothing is recorded.
        let unwanted = recording.finish().map_or(0, |heard| heard.lidar.unwanted);
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
    let control = Control::listen(place, interrupt);
    let log = recording.handle();
    let port = Recorder::new(opened.port, opened.link, move |record| log.record(record));
    let client = Client::with_link(setup.axis.clone(), opened.link);
    let mut session = Session::new(client, port, Arc::clone(interrupt));
    let gearing = setup.axis.gearing;
    let motion = motion::run(&mut session, &setup.steps, &mut |told| {
        if recording.failed() {
            // A sweep that is not recorded is not worth making.
            interrupt.store(true, Ordering::Relaxed);
        }
        match told {
            Told::Step(step) => progress.begin_move(&step.plan),
            Told::Event(Event::Sample(ShaftSample {
                answer, position, ..
            })) => progress.moved(*answer, gearing.angle(*position), recording.packets()),
            Told::Event(Event::Progress(step)) => tracing::info!(?step),
            Told::Event(event) => tracing::debug!(?event),
        }
    });
    progress.end_move();
    drop(session);
    if let Some(control) = control {
        control.ended(!matches!(
            motion,
            Err(SessionError::NotStopped(_) | SessionError::Port(_))
        ));
    }
    let recorded = recording.finish();
    if let Ok(Recorded { lidar, .. }) = &recorded
        && lidar.without_kernel_time > 0
    {
        progress.say(&format!(
            "warning: {} lidar packets came without a kernel time: their times are less certain",
            lidar.without_kernel_time
        ));
    }
    Ok(Ended { motion, recorded })
}

/// Waits for the first packet: a sweep without a lidar is a sweep for nothing.
fn await_lidar(
    recording: &Recording,
    setup: &Setup,
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
fn silence(config: &ListenConfig) -> Failure {
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

/// Says how it ended. What went wrong first is what the user must hear first.
fn conclude(
    setup: &Setup,
    made: Result<Scan, Failure>,
    ended: Ended,
    stdout: bool,
) -> Result<Said, Failure> {
    let saved = match &made {
        Ok(_) => format!(
            "what was captured is saved: the cloud {} and the log {}",
            setup.cloud.display(),
            setup.log.display()
        ),
        Err(failure) => format!(
            "there is no cloud ({}); the log is {}",
            failure.message,
            setup.log.display()
        ),
    };
    let lost = ended.recorded.as_ref().map_or(0, lost_records);
    let reception = ended.recorded.as_ref().ok().map(reception);
    let failure = match (ended.motion, ended.recorded) {
        // The log's failure is why the session was interrupted.
        (Err(SessionError::Interrupted), Err(failure)) | (Ok(()), Err(failure)) => Some(failure),
        (Err(error), recorded) => Some(motion_failure(&error, recorded.err())),
        (Ok(()), Ok(recorded)) => loss(&recorded),
    };
    let failure = failure.map(|failure| {
        let help = failure
            .help
            .clone()
            .map_or(saved.clone(), |help| format!("{help}\n{saved}"));
        failure.help(help)
    });
    match (made, failure) {
        (Ok(scan), failure) => {
            let scan = Scan {
                lost_records: lost,
                reception,
                ..scan
            };
            Ok(Said::scan(&scan, failure, stdout))
        }
        (Err(_), Some(failure)) => Err(failure),
        (Err(failure), None) => Err(without_cloud(failure, &setup.log)),
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
