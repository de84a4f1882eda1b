//! A log of a simulated scene, and its ground truth.
//!
//! A lidar whose packets are not simulated has no log, but the cloud that it measures, with exact
//! times and angles.
//!
//! The log holds the lidar's datagrams, and the drive's USB frames if the scene has a drive.
//! `sim::simulate` does the simulation.

mod log;
mod sizes;
mod stopwatch;

pub use sizes::{EffectChoice, EffectSize, Sampler, unmet};
pub use stopwatch::nanoseconds;

use std::fs::File;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use cloud::mount::Mount;
use cloud::{Fields, Metadata, TiltTrack};
use io::log::{LogConfig, LogError, LogWriter};
use protocol::record::DriveLink;
use scanner::ScanConfig;
use serde::Serialize;
use sim::effect_models::{EffectTolerance, EffectsConfig, Explanation, InvalidSetting};
use sim::effects::{Effects, FiringEffectSet, Stopwatch};
use sim::scene_file::{EffectDemand, EffectLine, SHIPPED, SceneFile};
use sim::simulate::SimulateError;
use utoipa::ToSchema;

use crate::failure::{Failure, Kind};
use crate::output::{self, Target};
use crate::reconstruct::report::PacketCounts;
use log::{Log, Outputs, ReturnCloud, ReturnPlace, WrittenClouds, cannot_write, scan_config};

/// Report on a simulation.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct SimulationReport {
    /// Scene as named by the user.
    pub scene: String,
    /// Random seed.
    pub seed: u64,
    /// Requested effects.
    pub effects: Vec<EffectLine>,
    /// Packets sent; those with positions are not counted.
    pub packets: PacketCounts,
    /// Shots in the packets.
    pub shots: u64,
    /// Shots with a return.
    pub returned: u64,
    /// Share of shots with a return, 0..=1.
    pub share_returned: f64,
    /// Returns; a dual return counts twice.
    pub returns: u64,
    /// Requests to the drive.
    pub polls: u64,
    /// Duration in the scene, seconds.
    pub duration_s: f64,
    /// Computing time, seconds.
    pub took_s: f64,
    /// Duration over computing time.
    pub times_real_time: f64,
    /// Threads used.
    pub threads: usize,
    /// Path of the log; absent with a lidar whose packets are not simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub log: Option<String>,
    /// Path of the cloud that such a lidar measures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cloud: Option<String>,
    /// Path of the truth cloud, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<String>,
    /// Warnings for users of the log.
    pub warnings: Vec<String>,
    /// Changes and costs of effects, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explanation: Option<Explanation>,
    /// What effects change in the cloud, measured on a sample of the scene's firings, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sizes: Option<Vec<EffectSize>>,
    /// Facts of the scene that call for effects, the largest of an effect first.
    pub demands: Vec<EffectDemand>,
    /// Effects chosen by the tolerance of the scene or of the command.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choice: Option<EffectChoice>,
}

/// Output of a simulation besides the truth.
pub enum SimulationOutput {
    /// A log.
    Log {
        /// Its path.
        path: PathBuf,
        /// Whether to overwrite an older one.
        force: bool,
    },
    /// The measured cloud of a lidar without packets.
    Cloud(Target),
}

impl SimulationOutput {
    /// The output of the scene `name` where the user names none. That of a cloud differs from a
    /// mesh of the scene's name.
    #[must_use]
    pub fn default_path(scene: &SceneFile, name: &str) -> PathBuf {
        let stem = stem(name);
        match scene.simulation.sensor.packets {
            Some(_) => format!("{stem}.pcapng").into(),
            None => format!("{stem}-measured.ply").into(),
        }
    }

    /// Whether it is stdout.
    #[must_use]
    pub fn is_stdout(&self) -> bool {
        match self {
            Self::Log { .. } => false,
            Self::Cloud(target) => target.is_stdout(),
        }
    }
}

/// The files of a simulation as named by the user.
#[derive(Clone, Copy, Debug)]
pub struct SimulationFiles<'a> {
    /// The scene.
    pub scene: &'a Path,
    /// The log, or the cloud of a lidar without packets.
    pub output: &'a Path,
    /// The option or argument that names the output, for messages.
    pub option: &'static str,
    /// The cloud of the truth.
    pub truth: Option<&'a Path>,
    /// Whether to overwrite older files.
    pub force: bool,
}

impl SimulationFiles<'_> {
    /// Opens the clouds and checks the name of the log.
    ///
    /// # Errors
    /// [`Kind::Usage`] for a file that exists or that two of them would share, and for a format
    /// that does not serve; [`Kind::BadInput`] for a cloud that cannot be created.
    pub fn open(self, scene: &SceneFile) -> Result<(SimulationOutput, Option<Target>), Failure> {
        let Self {
            output,
            option,
            force,
            ..
        } = self;
        output::refuse_overwrite(self.scene, output)?;
        if let Some(truth) = self.truth {
            output::refuse_overwrite(self.scene, truth)?;
            output::two_files(output, truth)?;
        }
        let opened = if scene.simulation.sensor.packets.is_some() {
            output::log_is_file(output, option, &["pcapng", "pcap"])?;
            output::check_folder(output)?;
            output::check_free(output, force)?;
            let path = output.to_owned();
            SimulationOutput::Log { path, force }
        } else if output::log_is_file(output, option, &["pcapng", "pcap"]).is_ok() {
            let what = format!(
                "{}: the packets of this lidar are not simulated, so there is no log of it",
                output.display()
            );
            let help = format!("name the cloud that it measures with {option}, such as cloud.ply");
            return Err(Failure::new(Kind::Usage, what).help(help));
        } else {
            SimulationOutput::Cloud(Target::open(output, Fields::FILE, force)?)
        };
        let truth = self.truth;
        let truth = truth.map(|truth| Target::open(truth, Fields::FILE, force));
        Ok((opened, truth.transpose()?))
    }
}

/// A simulation to run.
pub struct SimulationRequest<'a> {
    /// Name of the scene.
    pub name: String,
    /// The output, a log or the cloud of a lidar without packets.
    pub output: SimulationOutput,
    /// Destination of the truth.
    pub truth: Option<Target>,
    /// Threads that make packets.
    pub threads: NonZeroUsize,
    /// Whether to report what effects did.
    pub explain: bool,
    /// Stops the simulation when set.
    pub interrupt: &'a AtomicBool,
    /// Called with the simulated seconds.
    pub progressed: &'a mut dyn FnMut(f64),
}

/// Finds a scene by path or name: its name and its text.
///
/// # Errors
/// [`Kind::BadInput`] without one.
pub fn find(scene: &Path) -> Result<(String, String), Failure> {
    let name = scene.display().to_string();
    if let Some((_, text)) = SHIPPED.iter().find(|(shipped, _)| *shipped == name) {
        return Ok((name, (*text).to_owned()));
    }
    let text = std::fs::read_to_string(scene).map_err(|error| {
        let shipped: Vec<&str> = SHIPPED.iter().map(|(name, _)| *name).collect();
        Failure::new(
            Kind::BadInput,
            format!("scene {name}: cannot read: {error}"),
        )
        .help(format!(
            "name a scene file (TOML) or a built-in scene: {}",
            shipped.join(", ")
        ))
    })?;
    Ok((name, text))
}

/// Parses a scene; mesh paths are relative to it. A stopwatch measures the cost of effects.
///
/// # Errors
/// [`Kind::BadInput`] with the line.
pub fn read(
    name: &str,
    text: &str,
    seed: Option<u64>,
    clock: Stopwatch,
) -> Result<SceneFile, Failure> {
    let folder = Path::new(name).parent().unwrap_or(Path::new(""));
    let mut meshes = |file: &str| {
        let path = folder.join(file);
        // Reading a FIFO without a writer would never end.
        if path.metadata().is_ok_and(|there| !there.is_file()) {
            return Err(format!("{} is not a file", path.display()));
        }
        std::fs::read(&path).map_err(|error| format!("cannot read {}: {error}", path.display()))
    };
    SceneFile::parse_with(text, seed, clock, &mut meshes).map_err(|error| {
        Failure::new(Kind::BadInput, format!("scene {name}, {error}"))
            .help("correct the scene file there; docs: Scenes")
    })
}

/// Whether the log is a plain pcap, which holds the lidar's datagrams only.
fn is_pcap(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default();
    extension.eq_ignore_ascii_case("pcap")
}

/// A scene's name for files: that of its file without extension.
#[must_use]
pub fn stem(name: &str) -> &str {
    let stem = Path::new(name).file_stem().and_then(|stem| stem.to_str());
    stem.unwrap_or("scene")
}

/// Switches on the effects of a scene: those that the file or a fact calls for, without those that
/// `is_out` names, and of these as few as the tolerance allows; by default the scene's.
///
/// # Errors
/// [`Kind::BadInput`] for an invalid setting, or a scene that gives no cloud.
pub fn choose_effects(
    scene: &mut SceneFile,
    name: &str,
    is_out: impl Fn(&str) -> bool,
    tolerance: Option<EffectTolerance>,
    threads: NonZeroUsize,
    clock: Stopwatch,
    interrupt: Option<&AtomicBool>,
) -> Result<Option<EffectChoice>, Failure> {
    let requested: Vec<&'static str> = (EffectsConfig::NAMES.iter().copied())
        .filter(|effect| scene.is_requested(effect) && !is_out(effect))
        .collect();
    let choice = match tolerance.or(scene.tolerance) {
        Some(chosen) if !requested.is_empty() => {
            let sampler = Sampler::new(scene, threads).interrupted_by(interrupt);
            Some(sampler.choose(chosen, &requested, tolerance.is_none())?)
        }
        _ => None,
    };
    let on = choice.as_ref().map_or(&requested, |choice| &choice.on);
    let selected = scene.select(|name| on.contains(&name), clock);
    scene.effects = selected.map_err(|error| invalid_setting(name, &error))?;
    Ok(choice)
}

/// Simulates a scene into a log or a cloud. A failure with usable files is returned with the
/// report.
///
/// # Errors
/// [`Failure`] without a log.
pub fn make(
    mut scene: SceneFile,
    request: SimulationRequest<'_>,
) -> Result<(SimulationReport, Option<Failure>), Failure> {
    let SimulationRequest {
        name,
        output,
        mut truth,
        threads,
        explain,
        interrupt,
        progressed,
    } = request;
    let gearing = scene.simulation.polls.map(|polls| {
        use sim::effects::EncoderEffect;
        let encoder = &scene.effects.effects.encoder;
        encoder.gearing().unwrap_or(polls.gearing)
    });
    let config = scan_config(&name, &scene, gearing);
    // Before an older log is replaced.
    (scene.simulation.check()).map_err(|error| cannot_simulate(&name, &error))?;
    let mut outputs = Outputs::default();
    let mount = config.mount.mount();
    match output {
        SimulationOutput::Log { path, force } => {
            let writer = create_log(&path, &config, gearing.is_some(), force)?;
            outputs.log = Some((writer, path));
        }
        SimulationOutput::Cloud(mut target) => {
            let what = "measured with exact times and angles in the simulated scene";
            begin_cloud(&mut target, what, &name, mount)?;
            outputs.measured = Some(ReturnCloud::new(target, ReturnPlace::Measured));
        }
    }
    if let Some(truth) = &mut truth {
        begin_cloud(truth, "the truth of the simulated scene", &name, mount)?;
    }
    outputs.truth = truth.map(|target| ReturnCloud::new(target, ReturnPlace::True));
    let log = outputs
        .log
        .as_ref()
        .map(|(_, path)| path.display().to_string());
    let began = Instant::now();
    let mut out = Log::new(&scene.simulation, outputs, gearing, interrupt, progressed);
    // Separate instances, so that a scene without effects pays nothing for them.
    let summary = match scene.effects.is_none() {
        true => {
            let mut none = Effects::<FiringEffectSet>::default();
            scene.simulation.run(&mut none, threads, &mut out)
        }
        false => {
            let effects = &mut scene.effects.effects;
            scene.simulation.run(effects, threads, &mut out)
        }
    };
    let summary = summary.map_err(|error| cannot_simulate(&name, &error))?;
    let WrittenClouds {
        measured,
        truth,
        cut,
    } = out.finish()?;
    let took = began.elapsed();
    let explanation = explain.then(|| {
        let busy_ns = took.as_nanos().saturating_mul(threads.get() as u128);
        let busy_ns = u64::try_from(busy_ns).unwrap_or(u64::MAX);
        Explanation::new(
            &scene.effects.effects.usage(),
            &scene.effects.lines,
            busy_ns,
        )
    });
    let (failure, after) = cut.unzip();
    // Of a run that was cut short only the simulated part counts.
    let duration_s = after.unwrap_or(summary.duration).as_secs_f64();
    let took_s = took.as_secs_f64();
    let report = SimulationReport {
        scene: name,
        seed: scene.seed,
        effects: scene.effects.lines,
        packets: PacketCounts {
            data: summary.packets,
            ..PacketCounts::default()
        },
        shots: summary.shots,
        returned: summary.returned,
        share_returned: ratio(summary.returned as f64, summary.shots as f64),
        returns: summary.returns,
        polls: summary.polls,
        duration_s,
        took_s,
        times_real_time: ratio(duration_s, took_s),
        threads: threads.get(),
        log,
        cloud: measured.map(|path| path.display().to_string()),
        truth: truth.map(|path| path.display().to_string()),
        warnings: Vec::new(),
        explanation,
        sizes: None,
        demands: scene.demands,
        choice: None,
    };
    Ok((report, failure))
}

/// Creates the log.
fn create_log(
    path: &Path,
    config: &ScanConfig,
    has_drive: bool,
    force: bool,
) -> Result<LogWriter<File>, Failure> {
    let head = LogConfig {
        metadata: toml::to_string(config).map_err(|error| cannot_write(path, &error))?,
        drive: has_drive.then_some(DriveLink::Usb),
    };
    let overwrite = output::overwrite(force);
    let writer = match is_pcap(path) {
        true => LogWriter::create_pcap(path, overwrite),
        false => LogWriter::create(path, &head, overwrite),
    };
    writer.map_err(|error| log_failure(path, &error))
}

/// Begins a cloud of a scene.
fn begin_cloud(cloud: &mut Target, what: &str, name: &str, mount: Mount) -> Result<(), Failure> {
    let track = TiltTrack {
        mount: Some(mount),
        ..TiltTrack::default()
    };
    let sink = cloud.sink();
    let begun = sink
        .begin(&metadata(what, name))
        .and_then(|()| sink.tilt(&track));
    begun.map_err(|error| output::sink_failure(cloud.path(), &error))
}

/// A quotient, 0 of nothing.
fn ratio(part: f64, of: f64) -> f64 {
    if of > 0.0 { part / of } else { 0.0 }
}

fn metadata(what: &str, name: &str) -> Metadata {
    Metadata {
        simulated: true,
        source: format!("{what} {}", stem(name)),
        software: concat!("velomotion ", env!("CARGO_PKG_VERSION")).to_owned(),
        time_reference: "Unix seconds (UTC) of the simulated host's clock".to_owned(),
        ..Metadata::default()
    }
}

/// The failure for an invalid setting of an effect.
#[must_use]
pub fn invalid_setting(name: &str, error: &InvalidSetting) -> Failure {
    Failure::new(Kind::BadInput, format!("scene {name}: {error}"))
        .help("correct the scene file; docs: Effects")
}

fn cannot_simulate(name: &str, error: &SimulateError) -> Failure {
    Failure::new(Kind::BadInput, format!("scene {name}: {error}"))
        .help("reduce the values in the scene file's [motion] or [drive]")
}

fn log_failure(path: &Path, error: &LogError) -> Failure {
    match error {
        LogError::Exists { .. } => Failure::new(Kind::Usage, error.to_string())
            .help("choose another name with -o, or overwrite it with --force"),
        LogError::Create { .. } => Failure::new(Kind::BadInput, error.to_string())
            .help("name a file in an existing, writable folder"),
        _ => cannot_write(path, error),
    }
}
