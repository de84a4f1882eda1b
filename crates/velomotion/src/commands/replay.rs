//! `velomotion replay`: a cloud from a log, or from a plain lidar recording; or the lidar's packets
//! of a log.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use cloud::formats::Format;
use engine::capture::completeness;
use engine::config::{self, MountSettings};
use engine::default_paths;
use engine::failure::{Failure, Kind};
use engine::output::{self, Target};
use engine::reconstruct::contents::read_contents;
use engine::reconstruct::decoder_options::decoder_options;
use engine::reconstruct::frames::FramePlan;
use engine::reconstruct::lidar_copy;
use engine::reconstruct::replay::{self, Reconstruction};
use engine::reconstruct::source::Source;
use engine::reconstruct::tilt_table::tilt_source;
use engine::words::counted;
use scanner::{TableTime, TiltSource};
use units::Degrees;

use super::CommandOutput;
use crate::cli::{self, Common};
use crate::signals;
use crate::terminal::Progress;

/// Runs the command.
///
/// # Errors
/// [`Failure`] without a cloud.
pub fn run(arguments: &cli::Replay, common: &Common) -> Result<CommandOutput, Failure> {
    let interrupt = signals::interrupt_flag()?;
    if let (Some(output), [_, _, ..]) = (&arguments.output.output, &*arguments.inputs) {
        let (output, inputs) = (output.display(), arguments.inputs.len());
        let what = format!("-o {output} names one cloud, and there are {inputs} recordings");
        return Err(Failure::new(Kind::Usage, what)
            .help("leave it out: each cloud gets the name of its recording"));
    }
    let mut clouds: Vec<PathBuf> = Vec::new();
    for input in &arguments.inputs {
        let cloud = default_paths::cloud_of(input);
        if clouds.contains(&cloud) {
            let what = format!("two recordings would have the cloud {}", cloud.display());
            return Err(Failure::new(Kind::Usage, what).help("replay them one by one, with -o"));
        }
        clouds.push(cloud);
    }
    CommandOutput::of_each(&arguments.inputs, |input| {
        replay(arguments, common, input, &interrupt)
    })
}

fn replay(
    arguments: &cli::Replay,
    common: &Common,
    input: &Path,
    interrupt: &AtomicBool,
) -> Result<CommandOutput, Failure> {
    // Check the input before an output is opened.
    let mut source = Source::open(input, arguments.lidar.sensor)?;
    if let Some(pcap) = arguments.output.output.as_deref().filter(is_pcap) {
        return copy(arguments, common, &source, pcap, interrupt);
    }
    let tilt = tilt_source(&arguments.tilt)?;
    let mount = mount(arguments, common, &tilt, &source)?;
    if let (TiltSource::Table(_), true) = (&tilt, arguments.output.uncertainty) {
        let what = "--uncertainty with --tilt: nothing says how accurate a table's angles are";
        return Err(Failure::new(Kind::Usage, what).help("omit --uncertainty"));
    }
    if let Some((mount, _)) = &mount {
        source.set_mount(mount.clone());
    }
    let request = Reconstruction {
        recording: &source,
        tilt,
        options: decoder_options(&arguments.lidar.request(), &source)?,
        time: arguments.time.into(),
        accuracy: arguments.accuracy.wanted(),
        pace: arguments.realtime,
        truth: None,
        live: arguments.live,
        lost_records: 0,
        georeference: arguments.georeference.map(Degrees),
        interrupt,
    };
    let progress = Progress::new(common);
    if let Some((mount, file)) = &mount {
        let calibrated = match mount.calibration() {
            Some(_) => ", calibrated",
            None => "",
        };
        progress.say(&format!(
            "mount of {}: the lidar is {} m above the tilt axis{calibrated}",
            file.display(),
            mount.pose().mount().position_m()[2]
        ));
    }
    if let TiltSource::Table(table) = &request.tilt {
        progress.say(match table.time() {
            TableTime::Unix => "tilt angles: times are Unix seconds",
            TableTime::SinceFirstPacket => {
                "tilt angles: times count from the recording's first lidar packet"
            }
        });
    }
    output::one_for_stdout(arguments.output.output.as_deref(), common.json)?;
    let cloud = arguments
        .output
        .output
        .clone()
        .unwrap_or_else(|| default_paths::cloud_of(input));
    // From stdin to stdout.
    if input.as_os_str() != "-" {
        output::two_files(input, &cloud)?;
    }
    let plan = arguments.frames.map(|cut| FramePlan {
        cut: Degrees(cut),
        organised: arguments.organised,
        output: cloud.clone(),
        fields: arguments.output.fields(),
        force: arguments.output.force,
    });
    let (scan, stdout) = match &plan {
        Some(plan) => (replay::frames(&request, plan)?, false),
        None => {
            let target = Target::open(&cloud, arguments.output.fields(), arguments.output.force);
            let target = target.map_err(|failure| match Format::from_path(&cloud) {
                Err(_) if cloud != Path::new("-") => failure.help(
                    "use one of those extensions, .pcap for the lidar's packets alone, or - for PLY on stdout",
                ),
                _ => failure,
            })?;
            let stdout = target.is_stdout();
            (replay::make(&request, target)?, stdout)
        }
    };
    if scan.contents.simulated {
        progress.say("SIMULATED: this log was made by simulated devices");
    }
    let failure = completeness::missing(&scan).map(|missing| {
        let help = match &scan.contents.truncated {
            Some(_) => "copy the recording from its source again if you need the rest",
            None => "scan again if what is missing matters",
        };
        let made = match (stdout, arguments.frames) {
            (true, _) => "the partial cloud is on stdout".to_owned(),
            (_, Some(_)) => "the partial clouds are made".to_owned(),
            _ => format!("the partial cloud is {}", cloud.display()),
        };
        Failure::new(Kind::Incomplete, format!("{}: {missing}", input.display()))
            .help(format!("{made}; {help}"))
    });
    Ok(CommandOutput::scan(&scan, failure, stdout))
}

/// Whether an output is the lidar's recording rather than a cloud.
fn is_pcap(output: &&Path) -> bool {
    let extension = output.extension().unwrap_or_default();
    extension.eq_ignore_ascii_case("pcap")
}

/// The given options that only a cloud needs.
fn cloud_options(arguments: &cli::Replay) -> impl Iterator<Item = &'static str> {
    let lidar = &arguments.lidar;
    [
        ("--tilt", arguments.tilt != "log"),
        ("--mount", arguments.mount.is_some()),
        ("--realtime", arguments.realtime.is_some()),
        ("--time", arguments.time != cli::TimeArgument::Host),
        ("--frames", arguments.frames.is_some()),
        ("--georeference", arguments.georeference.is_some()),
        ("--live", arguments.live),
        ("--model", lidar.model.is_some()),
        ("--calibration", lidar.calibration.is_some()),
        (
            "--equal-returns",
            lidar.equal_returns != cli::EqualReturns::Once,
        ),
        ("--one-origin", lidar.one_origin),
        ("--tolerance", arguments.accuracy.tolerance.is_some()),
        ("--uncertainty", arguments.output.uncertainty),
        ("--echo", arguments.output.echo),
    ]
    .into_iter()
    .filter_map(|(option, is_given)| is_given.then_some(option))
}

/// The lidar's datagrams alone.
fn copy(
    arguments: &cli::Replay,
    common: &Common,
    source: &Source,
    pcap: &Path,
    interrupt: &AtomicBool,
) -> Result<CommandOutput, Failure> {
    if let Some(option) = cloud_options(arguments).next() {
        let what = format!("a .pcap takes the lidar's packets as they are: {option} is for clouds");
        return Err(Failure::new(Kind::Usage, what).help("omit it, or name a cloud with -o"));
    }
    output::refuse_overwrite(source.path(), pcap)?;
    let report = lidar_copy::copy(source, pcap, arguments.output.force, interrupt)?;
    let ends_early = (report.truncated.as_ref())
        .map(|truncated| format!("the recording ends early ({truncated})"));
    let options = decoder_options(&arguments.lidar.request(), source)?;
    // Packets that cannot be decoded are copied, too.
    let held = read_contents(source, options).ok();
    let missing = held.and_then(|held| completeness::missing_packets(&held.contents));
    let gaps: Vec<String> = ends_early.into_iter().chain(missing).collect();
    let failure = (!gaps.is_empty()).then(|| {
        let what = format!("{}: {}", source.path().display(), gaps.join(", and "));
        Failure::new(Kind::Incomplete, what).help(format!("the part is in {}", pcap.display()))
    });
    if report.simulated {
        Progress::new(common)
            .say("SIMULATED: this log was made by simulated devices; the pcap does not say so");
    }
    let text = format!(
        "{} in {}",
        counted(report.datagrams, "lidar packet"),
        pcap.display()
    );
    Ok(CommandOutput {
        failure,
        ..CommandOutput::report(&report, text)
    })
}

/// The mount that replaces the recording's, and its file: that of `--mount`; with a table of angles
/// that of `--config`, or of the usual configuration if the recording has none.
fn mount(
    arguments: &cli::Replay,
    common: &Common,
    tilt: &TiltSource,
    source: &Source,
) -> Result<Option<(MountSettings, PathBuf)>, Failure> {
    let load = |file: PathBuf| config::load_mount(&file).map(|mount| Some((mount, file)));
    if let (Some(_), TiltSource::None) = (&arguments.mount, tilt) {
        let what = "--mount is for a tilted lidar: --tilt none gives the sensor's own frame";
        return Err(Failure::new(Kind::Usage, what).help("omit one of them"));
    }
    if let Some(file) = &arguments.mount {
        return load(file.clone());
    }
    if !matches!(tilt, TiltSource::Table(_)) {
        return Ok(None);
    }
    if let Some(file) = &common.config {
        return load(file.clone());
    }
    if source.has_config()? {
        return Ok(None);
    }
    let Some(file) = config::usual_place() else {
        return Err(Failure::new(
            Kind::Usage,
            "a recording without a configuration, and angles of another rig: where is the lidar on its tilt axis?",
        )
        .help("name a file with [mount] d_m, the height of the lidar above the axis, with --mount or --config"));
    };
    load(file)
}
