//! `velomotion capture`: home, sweep, record, and make the cloud of what was recorded, with devices of its own or through a daemon that
//! has them.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use io::udp::ListenConfig;
use sim::Truth;

use super::{Said, through_daemon};
use crate::cli::{self, Common};
use crate::control::Control;
use crate::daemon::client::Client;
use crate::failure::{Failure, Kind};
use crate::hearing::Hearing;
use crate::job::{self, Ended, Happening, Job};
use crate::output::{self, Aside, Target};
use crate::ports::Looks;
use crate::progress::Progress;
use crate::recording::{Ear, listen_config};
use crate::setup::Setup;
use crate::signals;
use crate::simulated::{self, Simulated};
use crate::{devices, ports};

/// Runs the command.
///
/// # Errors
/// [`Failure`] where nothing was recorded, or no cloud came of it.
pub fn run(arguments: &cli::Capture, common: &Common) -> Result<Said, Failure> {
    let setup = Setup::new(arguments, common)?;
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
    let (truth, ended) = if devices::simulated(&setup.device) {
        simulate(&setup, &interrupt, &mut progress)?
    } else {
        let place = ports::place(
            &setup.name,
            &setup.device,
            Looks::Once,
            &io::discover::discover,
        )?;
        let ear = Ear::bind(&listen_config(&setup.device))?;
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
    Ok(Said::scan(&scan, failure, stdout))
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
    let mut opened = ports::open(&setup.device, place)?;
    if let Some(warning) = &opened.warning {
        progress.say(&format!("warning: {warning}"));
    }
    let hearing = Arc::new(Hearing::start(ear, Box::new(|_| {}))?);
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
fn show(happening: Happening<'_>, progress: &mut Progress) {
    match happening {
        Happening::Begins | Happening::Saving => {}
        Happening::Move { step, .. } => progress.begin_move(&step.plan),
        Happening::Moved { at, angle, packets } => progress.moved(at, angle, packets),
        Happening::Progress(step) => tracing::info!(?step),
        Happening::Over => progress.end_move(),
        Happening::Warning(text) => progress.say(&format!("warning: {text}")),
    }
}
