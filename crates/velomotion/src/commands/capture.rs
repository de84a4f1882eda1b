//! `velomotion capture`: home, sweep, record, and make the cloud of what was recorded, with devices of its own or through a daemon that
//! has them.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::SystemTime;

use io::udp::ListenConfig;
use sim::Truth;

use super::{CommandOutput, through_daemon};
use crate::cli::{self, Common};
use crate::signals;
use crate::terminal::Progress;
use daemon::client::Client;
use engine::capture::request::CapturePlan;
use engine::capture::request::CaptureRequest;
use engine::capture::run::{self as job, CaptureEvent, Ended, Job};
use engine::config;
use engine::default_paths;
use engine::devices::drive_port as ports;
use engine::devices::drive_port::Looks;
use engine::devices::lidar_receiver::LidarReceiver;
use engine::devices::lidar_sockets::{LidarSockets, listen_config};
use engine::devices::profile;
use engine::devices::simulated::{self, Simulated};
use engine::failure::{Failure, Kind};
use engine::output::{self, Aside, Target};
use engine::stop_socket::Control;

/// Runs the command.
///
/// # Errors
/// [`Failure`] where nothing was recorded, or no cloud came of it.
pub fn run(arguments: &cli::Capture, common: &Common) -> Result<CommandOutput, Failure> {
    let setup = plan(arguments, common)?;
    output::one_for_stdout(Some(&setup.cloud), common.json)?;
    output::log_is_file(&setup.log, "--log")?;
    let target = Target::open(&setup.cloud, arguments.output.fields(), setup.force)?;
    output::check_free(&setup.log, setup.force)?;
    let interrupt = signals::interrupt_flag()?;
    let mut progress = Progress::new(common);
    for line in setup.headline() {
        progress.say(&line);
    }

    if let Some(client) = Client::find(&setup.name, &setup.device) {
        let what = (&setup, target);
        return through_daemon::capture(&client, arguments, what, &interrupt, &mut progress);
    }
    let older_log = Aside::put(&setup.log)?;
    let (truth, ended) = if profile::simulated(&setup.device) {
        simulate(&setup, &interrupt, &mut progress)?
    } else {
        let place = ports::place(
            &setup.name,
            &setup.device,
            Looks::Once,
            &io::discover::discover,
        )?;
        let ear = LidarSockets::bind(&listen_config(&setup.device))?;
        (
            None,
            record(&setup, ear, &place, &interrupt, &mut progress)?,
        )
    };
    // The stop is over; from here on Ctrl-C means the making of the cloud.
    interrupt.store(false, Ordering::Relaxed);
    progress.say("making the cloud");
    let stdout = target.is_stdout();
    let made = job::cloud(
        &setup,
        truth.as_ref(),
        ended.lost_records(),
        &interrupt,
        target,
    );
    // A log without a sweep is not worth an older one; any other is.
    if !matches!(&made, Err(failure) if failure.kind == Kind::BadInput) {
        older_log.replaced();
    }
    let (scan, failure) = job::conclude(made, ended.outcome(), (&setup.cloud, &setup.log))?;
    Ok(CommandOutput::scan(&scan, failure, stdout))
}

/// Checks the arguments against the axis and plans the moves.
fn plan(arguments: &cli::Capture, common: &Common) -> Result<CapturePlan, Failure> {
    let start = SystemTime::now();
    let config = config::load(common.config.as_deref())?;
    let (name, device) = profile::choose(&config, common.device.as_deref())?;
    let simulated = profile::simulated(&device);
    let cloud = arguments
        .output
        .output
        .clone()
        .unwrap_or_else(|| default_paths::cloud(start, simulated));
    let log = arguments
        .log
        .clone()
        .unwrap_or_else(|| default_paths::log_of(&cloud, start, simulated));
    let plan = CapturePlan {
        force: arguments.output.force,
        ..CapturePlan::of(
            &CaptureRequest::from(arguments),
            &config,
            (&name, &device),
            cloud,
            log,
        )?
    };
    output::two_files(&plan.log, &plan.cloud)?;
    Ok(plan)
}

/// The same, against software devices that are started for it; with what truly happened.
fn simulate(
    setup: &CapturePlan,
    interrupt: &Arc<AtomicBool>,
    progress: &mut Progress,
) -> Result<(Option<Truth>, Ended), Failure> {
    let ear = LidarSockets::bind(&ListenConfig {
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
    setup: &CapturePlan,
    ear: LidarSockets,
    place: &Path,
    interrupt: &Arc<AtomicBool>,
    progress: &mut Progress,
) -> Result<Ended, Failure> {
    let mut opened = ports::open(&setup.device, place)?;
    if let Some(warning) = &opened.warning {
        progress.say(&format!("warning: {warning}"));
    }
    let hearing = Arc::new(LidarReceiver::start(ear, Box::new(|_| {}))?);
    let control = Control::listen(place, interrupt);
    let job = Job {
        setup,
        interrupt,
        hearing: &hearing,
        port: &mut *opened.port,
        link: opened.link,
        rs232_baud: opened.rs232_baud,
        onlooker: &|_| {},
    };
    let ended = job::record(job, &mut |happening| show(happening, progress));
    if let Some(control) = control {
        control.ended(ended.as_ref().map_or(true, Ended::stands));
    }
    ended
}

/// What a person at the terminal sees of it.
fn show(happening: CaptureEvent<'_>, progress: &mut Progress) {
    match happening {
        CaptureEvent::Begins | CaptureEvent::Saving => {}
        CaptureEvent::Move { step, .. } => progress.begin_move(&step.plan),
        CaptureEvent::Moved { at, angle, packets } => progress.moved(at, angle, packets),
        CaptureEvent::Progress(step) => tracing::info!(?step),
        CaptureEvent::Over => progress.end_move(),
        CaptureEvent::Warning(text) => progress.say(&format!("warning: {text}")),
    }
}
