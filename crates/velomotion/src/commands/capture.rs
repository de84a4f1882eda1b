//! `velomotion capture`: homes, sweeps, records, and makes the cloud.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::SystemTime;

use daemon::client::Client;
use daemon::local::{LocalService, LocalTask};
use engine::capture::request::CapturePlan;
use engine::capture::run;
use engine::capture::scan_plan::ScanPlanner;
use engine::capture_request::CaptureRequest;
use engine::config::{self, Config};
use engine::default_paths;
use engine::devices::profile;
use engine::failure::{Failure, Kind};
use engine::output::{self, Backup, Target};
use engine::reconstruct::report::ScanReport;
use engine::service::CaptureEnd;

use super::CommandOutput;
use super::device_backend::{DaemonCapture, LocalCapture, record};
use super::guard_axis::environment;
use crate::cli::{self, Common};
use crate::signals;
use crate::terminal::{Progress, width_of, wrapped};

/// Runs the command.
///
/// # Errors
/// [`Failure`] where nothing was recorded, or no cloud was made.
pub fn run(arguments: &cli::Capture, common: &Common) -> Result<CommandOutput, Failure> {
    let config = config::load(common.config.as_deref())?;
    let plan = plan(arguments, &config)?;
    output::one_for_stdout(Some(&plan.cloud), common.json)?;
    output::log_is_file(&plan.log, "--log", &["pcapng"])?;
    let target = Target::open(&plan.cloud, arguments.output.fields(), plan.force)?;
    output::check_free(&plan.log, plan.force)?;
    let interrupt = signals::motion_interrupt_flag()?;
    let mut progress = Progress::new(common);
    // A scan that cannot be predicted can be made all the same.
    let planner = ScanPlanner::of_capture(&config, &plan, None, None);
    let expected = planner.map_or_else(
        |_| Vec::new(),
        |planner| planner.expectation(&arguments.into(), &planner.row(&plan.steps)),
    );
    for line in plan.headline().iter().chain(&expected) {
        progress.say(&wrapped(line, width_of(std::io::stderr()), "", "  "));
    }
    let client = Client::find(&plan.name, &plan.device);
    let mut by_daemon = match &client {
        Some(client) => Some(DaemonCapture::begin(client, &arguments.into())?),
        None => None,
    };
    let older_log = Backup::put(&plan.log)?;
    let recording = match &mut by_daemon {
        Some(capture) => record(capture, &plan, &interrupt, &mut progress)?,
        None => record_locally(&plan, config, &interrupt, &mut progress)?,
    };
    // The stop is over: from here on Ctrl-C ends the making of the cloud.
    interrupt.store(false, Ordering::Relaxed);
    progress.say("making the cloud");
    let stdout = target.is_stdout();
    let CaptureEnd { outcome, truth } = recording;
    let mut made = run::cloud(
        (&plan.log, plan.accuracy),
        truth.as_ref(),
        false,
        outcome.lost_records,
        &interrupt,
        target,
    );
    // The daemon's own scan is complete when the command ends. A daemon that is gone costs nothing.
    if let Some(Ok(truth)) = by_daemon.as_ref().map(|capture| capture.truth(&interrupt))
        && let Ok(scan) = &mut made
        && plan.scan.simulated
    {
        scan.truth = truth;
    }
    // A log without a sweep does not replace an older one.
    if !matches!(&made, Err(failure) if failure.kind == Kind::BadInput) {
        older_log.replaced();
    }
    let (scan, failure): (ScanReport, _) = run::conclude(made, outcome, (&plan.cloud, &plan.log))?;
    let mut output = CommandOutput::scan(&scan, failure, stdout);
    if !stdout {
        let cloud = plan.cloud.display();
        output
            .text
            .push_str(&format!("\nshow it: velomotion view {cloud}"));
    }
    Ok(output)
}

/// Records with the devices of this process, which are closed before the cloud is made.
fn record_locally(
    plan: &CapturePlan,
    config: Config,
    interrupt: &Arc<AtomicBool>,
    progress: &mut Progress,
) -> Result<CaptureEnd, Failure> {
    let device = (plan.name.clone(), plan.device.clone());
    let local = LocalService::start(config, device, LocalTask::Capture, interrupt, environment())?;
    if let Some(warning) = &local.thread.port_warning {
        progress.say(&format!("warning: {warning}"));
    }
    let recorded = LocalCapture::begin(&local, plan.clone())
        .and_then(|mut capture| record(&mut capture, plan, interrupt, progress));
    local.stop();
    recorded
}

/// Checks the arguments against the axis and plans the moves.
fn plan(arguments: &cli::Capture, config: &Config) -> Result<CapturePlan, Failure> {
    let start = SystemTime::now();
    let (name, device) = profile::choose(config, arguments.device.name.as_deref())?;
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
            config,
            (&name, &device),
            cloud,
            log,
        )?
    };
    output::two_files(&plan.log, &plan.cloud)?;
    Ok(plan)
}
