//! `velomotion capture`: home, sweep, record, and make the cloud of what was recorded.
//!
//! Whatever ends a capture early, the axis is stopped first, then the log is closed and the cloud made of what it holds.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::SystemTime;

use drive::{Client, Event, ShaftSample};
use io::port::{PortError, Recorder, SerialPort};
use io::udp::ListenConfig;
use protocol::record::DriveLink;
use scanner::{ScanConfig, SweepPlan, TiltSource};
use sim::Truth;
use units::{DegPerS, DegPerS2, Degrees};

use super::Said;
use super::replay::{self, Request};
use crate::cli::{self, Common};
use crate::config::{self, Config, Device};
use crate::devices;
use crate::failure::{Failure, Kind};
use crate::motion::{self, Step, Told, Wish};
use crate::names;
use crate::output::{self, Target};
use crate::progress::Progress;
use crate::recording::{Ear, Recorded, Recording};
use crate::session::{Session, SessionError};
use crate::simulated::{self, Simulated};

/// Everything that is decided before a device is touched.
struct Setup {
    name: String,
    device: Device,
    axis: drive::AxisConfig,
    steps: Vec<Step>,
    scan: ScanConfig,
    cloud: PathBuf,
    log: PathBuf,
    force: bool,
}

/// EPOS2 on USB: 1 Mbaud by the Communication Guide.
const USB_BAUD: u32 = 1_000_000;

/// Runs the command.
///
/// # Errors
/// [`Failure`] where nothing was recorded, or no cloud came of it.
pub fn run(arguments: &cli::Capture, common: &Common) -> Result<Said, Failure> {
    let setup = setup(arguments, common)?;
    output::one_for_stdout(Some(&setup.cloud), common.json)?;
    let target = Target::open(&setup.cloud, setup.force)?;
    output::check_free(&setup.log, setup.force)?;
    let interrupt = interrupt_flag()?;
    let mut progress = Progress::new(common);
    for line in headline(&setup) {
        progress.say(&line);
    }

    let (truth, motion) = if devices::simulated(&setup.device) {
        simulate(&setup, interrupt, &mut progress)?
    } else {
        let ear = Ear::bind(&ListenConfig {
            address: setup.device.lidar,
            ..ListenConfig::default()
        })?;
        let path = devices::port_path(&setup.name, &setup.device)?;
        (None, record(&setup, ear, path, interrupt, &mut progress)?)
    };
    progress.say("making the cloud");
    finish(&setup, target, truth.as_ref(), motion)
}

/// Checks what was asked for against the axis, and plans the moves. Touches nothing.
fn setup(arguments: &cli::Capture, common: &Common) -> Result<Setup, Failure> {
    let start = SystemTime::now();
    let config = config::load(common.config.as_deref())?;
    let (name, device) = devices::choose(&config, common.device.as_deref())?;
    let axis = devices::axis(&config.axis)?;
    let wish = Wish {
        from: Degrees(arguments.from.unwrap_or(config.axis.max_deg)),
        to: Degrees(arguments.to.unwrap_or(config.axis.min_deg)),
        speed: DegPerS(arguments.speed),
        acceleration: DegPerS2(arguments.accel.unwrap_or(device.accel_deg_s2)),
        sweeps: arguments.sweeps,
        both_ways: arguments.both_ways,
    };
    let steps = motion::steps(&wish, &axis, Degrees(config.axis.homing.to_deg))?;
    let simulated = devices::simulated(&device);
    let cloud = arguments
        .output
        .output
        .clone()
        .unwrap_or_else(|| names::cloud(start, simulated));
    let log = arguments
        .log
        .clone()
        .unwrap_or_else(|| names::log_of(&cloud, start, simulated));
    Ok(Setup {
        scan: scan_config(&config, &name, simulated, &wish, &steps),
        name,
        device,
        axis,
        steps,
        cloud,
        log,
        force: arguments.output.force,
    })
}

fn scan_config(
    config: &Config,
    device: &str,
    simulated: bool,
    wish: &Wish,
    steps: &[Step],
) -> ScanConfig {
    let sweep = steps.iter().find(|step| step.sweep).map(|step| SweepPlan {
        from_deg: step.plan.from.0,
        to_deg: step.plan.to.0,
        cruise_deg_s: step.plan.cruise.0,
        accel_deg_s2: wish.acceleration.0,
        sweeps: wish.sweeps,
        both_ways: wish.both_ways,
    });
    ScanConfig {
        device: device.to_owned(),
        simulated,
        mount: config.mount,
        axis: config.axis.scan(),
        sweep,
        ..ScanConfig::default()
    }
}

/// What is about to happen, as the drive will do it.
fn headline(setup: &Setup) -> Vec<String> {
    let mut lines = Vec::new();
    if setup.scan.simulated {
        lines.push(
            "SIMULATED: software devices in a made-up hall, no scan of anything real".to_owned(),
        );
    }
    let Some(Step { plan, .. }) = setup.steps.iter().find(|step| step.sweep) else {
        return lines;
    };
    lines.push(format!(
        "{} deg/s is {} rpm of the motor, {} deg/s",
        plan.requested.0,
        plan.speed.0,
        trim(setup.axis.gearing.rate(plan.speed).0)
    ));
    let shape = if plan.triangle {
        format!("too short to cruise, peak {:.2} deg/s", plan.cruise.0)
    } else {
        format!("{:.3} s of cruise", plan.cruising.as_secs_f64())
    };
    lines.push(format!(
        "sweep {} to {} deg in {:.3} s: {shape}, ramps of {} deg/s2",
        trim(plan.from.0),
        trim(plan.to.0),
        plan.duration.as_secs_f64(),
        trim(setup.axis.gearing.acceleration(plan.acceleration).0),
    ));
    lines
}

/// A number without the noise of its last bits.
fn trim(x: f64) -> f64 {
    (x * 1e6).round() / 1e6 + 0.0
}

/// The same, against software devices that are started for it; with what truly happened.
fn simulate(
    setup: &Setup,
    interrupt: Arc<AtomicBool>,
    progress: &mut Progress,
) -> Result<(Option<Truth>, Result<(), SessionError>), Failure> {
    let ear = Ear::bind(&ListenConfig {
        address: setup.device.lidar,
        data_port: 0,
        position_port: Some(0),
        ..ListenConfig::default()
    })?;
    let rig = simulated::rig(&setup.axis, &setup.scan, io::clock::now());
    let devices = Simulated::start(rig, ear.ports())?;
    let path = devices.port().to_owned();
    let motion = record(setup, ear, &path, interrupt, progress);
    let truth = devices.stop()?;
    Ok((Some(truth), motion?))
}

/// Records both devices while the axis makes its moves.
fn record(
    setup: &Setup,
    ear: Ear,
    path: &Path,
    interrupt: Arc<AtomicBool>,
    progress: &mut Progress,
) -> Result<Result<(), SessionError>, Failure> {
    let port = SerialPort::open(path, USB_BAUD).map_err(|error| port_failure(&error))?;
    let recording = Recording::start(
        ear,
        &setup.log,
        output::overwrite(setup.force),
        &setup.scan,
        DriveLink::Usb,
    )?;
    let log = recording.handle();
    let port = Recorder::new(port, DriveLink::Usb, move |record| log.record(record));
    let client = Client::new(setup.axis.clone());
    let mut session = Session::new(client, port, |_| io::clock::now(), interrupt);
    let gearing = setup.axis.gearing;
    let motion = motion::run(&mut session, &setup.steps, &mut |told| match told {
        Told::Step(step) => progress.begin_move(&step.plan),
        Told::Event(Event::Sample(ShaftSample {
            answer, position, ..
        })) => progress.moved(*answer, gearing.angle(*position), recording.packets()),
        Told::Event(event) => tracing::debug!(?event),
    });
    progress.end_move();
    drop(session);
    let recorded = recording.finish()?;
    warn(&recorded, progress);
    Ok(motion)
}

/// What was lost is said, never passed over.
fn warn(recorded: &Recorded, progress: &Progress) {
    let losses = [
        (
            recorded.lidar.dropped,
            "lidar packets dropped by the kernel: this machine was too slow",
        ),
        (
            recorded.log.dropped,
            "records dropped: the disk was too slow",
        ),
        (recorded.log.refused, "records that the log cannot hold"),
        (
            recorded.lidar.without_kernel_time,
            "lidar packets without a kernel time: their times are less certain",
        ),
    ];
    for (count, what) in losses {
        if count > 0 {
            progress.say(&format!("warning: {count} {what}"));
        }
    }
}

/// Makes the cloud of the log, whatever the motion came to, and says how it ended.
fn finish(
    setup: &Setup,
    target: Target,
    truth: Option<&Truth>,
    motion: Result<(), SessionError>,
) -> Result<Said, Failure> {
    let stdout = target.is_stdout();
    let request = Request {
        recording: &setup.log,
        tilt: TiltSource::Log,
        truth,
    };
    let made = replay::make(&request, target);
    let failure = motion
        .err()
        .map(|error| motion_failure(&error, setup, made.is_ok()));
    match (made, failure) {
        (Ok(scan), failure) => Ok(Said::scan(&scan, failure, stdout)),
        // What went wrong first is what the user must hear.
        (Err(_), Some(failure)) => Err(failure),
        (Err(failure), None) => Err(failure),
    }
}

fn motion_failure(error: &SessionError, setup: &Setup, cloud: bool) -> Failure {
    let saved = if cloud {
        format!(
            "what was captured is saved: the cloud {} and the log {}",
            setup.cloud.display(),
            setup.log.display()
        )
    } else {
        format!(
            "no sweep had begun, so there is no cloud; the log is {}",
            setup.log.display()
        )
    };
    let (kind, help) = match error {
        SessionError::Interrupted => (Kind::Interrupted, None),
        SessionError::Drive(error) => (Kind::DeviceFault, Some(error.help())),
        SessionError::Port(_) => (
            Kind::DeviceFault,
            Some("switch the motor's supply off if the axis still moves, then check cable and supply".into()),
        ),
    };
    let help = help.map_or(saved.clone(), |help| format!("{help}\n{saved}"));
    Failure::new(kind, error.to_string()).help(help)
}

fn port_failure(error: &PortError) -> Failure {
    let help = match error {
        PortError::Permission { .. } => {
            "add yourself to the group that owns the port (dialout on Debian), or install the udev rule"
        }
        PortError::Busy { .. } => "close the other program that uses the drive",
        _ => {
            "see whether the drive is plugged in and switched on, and what its port is called; --device sim needs no hardware"
        }
    };
    Failure::new(Kind::NoDevice, error.to_string()).help(help)
}

/// Becomes true at Ctrl-C or SIGTERM. There is no shorter way out: the axis is stopped first, and every wait has its limit.
fn interrupt_flag() -> Result<Arc<AtomicBool>, Failure> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    let flag = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, Arc::clone(&flag)).map_err(|error| {
            Failure::new(Kind::NoDevice, format!("cannot watch for Ctrl-C: {error}"))
        })?;
    }
    Ok(flag)
}
