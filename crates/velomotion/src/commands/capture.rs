//! `velomotion capture`: homes, sweeps, records, and makes the cloud.

use std::sync::atomic::Ordering;
use std::time::SystemTime;

use daemon::client::Client;
use daemon::local::LocalTask;
use engine::capture::plan::CapturePlan;
use engine::capture::run::{self, ScanFailure};
use engine::capture::scan_planner::ScanPlanner;
use engine::capture_request::CaptureRequest;
use engine::config::{self, Config};
use engine::default_paths;
use engine::devices::profile;
use engine::failure::{Failure, Kind};
use engine::output::{self, Backup, Target};

use super::CommandOutput;
use super::device_backend::DeviceBackend;
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
    let older_log = Backup::put(&plan.log)?;
    let device = (plan.name.as_str(), &plan.device);
    let daemon = Client::find(device.0, device.1);
    let backend = DeviceBackend::open(daemon, &config, device, LocalTask::Capture, &interrupt)?;
    let recording = backend.record(&arguments.into(), &plan, &interrupt, &mut progress)?;
    // The stop is over: from here on Ctrl-C ends the making of the cloud.
    interrupt.store(false, Ordering::Relaxed);
    progress.say("making the cloud");
    let stdout = target.is_stdout();
    let fields = arguments.output.fields();
    let (made, outcome) = recording.cloud(&plan, fields, target, &interrupt);
    // A log without a sweep does not replace an older one.
    let log = match &made {
        Err(failure) if failure.kind == Kind::BadInput => older_log.restore(),
        _ => {
            older_log.replaced();
            plan.log.clone()
        }
    };
    let concluded = run::conclude(made, outcome, (&plan.cloud, &log));
    let (scan, failure) = concluded.map_err(ScanFailure::into_failure)?;
    let mut output = CommandOutput::scan(&scan, failure.map(ScanFailure::into_failure), stdout);
    if !stdout {
        let cloud = plan.cloud.display();
        output
            .text
            .push_str(&format!("\nshow it: velomotion view {cloud}"));
    }
    Ok(output)
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
