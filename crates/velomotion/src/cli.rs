//! The command line. Other programs drive it: names and meanings are a contract.

use std::net::SocketAddr;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use engine::lidars::LidarSheet;
use engine::reconstruct::source::SensorAddress;
use protocol::vlp16::LidarModel;
use scanner::Tolerance;
use sim::effect_models::EffectTolerance;

use crate::sweep_ranges::SweepRanges;

mod requests;
mod values;

use values::{
    acceleration, address_and_port, azimuth, captured_model, deceleration, degrees, effect_or_all,
    heading, lidar_sheet, metres, millimetres, number, place, seconds, share, threads, two_times,
    whole,
};

/// Version, and the commit of the build.
pub const VERSION: &str = env!("VELOMOTION_VERSION");

/// Commit and its date in [`VERSION`]; empty if unknown.
#[must_use]
pub fn commit() -> &'static str {
    let commit = VERSION.split_once(" (");
    commit.map_or("", |(_, commit)| commit.trim_end_matches(')'))
}

/// Dense point clouds from a multi-beam lidar on a tilting platform.
#[derive(Debug, Parser)]
#[command(version = VERSION, about, max_term_width = 100, disable_help_subcommand = true)]
pub struct Cli {
    /// Command to run.
    #[command(subcommand)]
    pub command: Command,
    /// Options of every command.
    #[command(flatten)]
    pub common: Common,
}

/// Options of every command.
#[derive(Clone, Debug, Args)]
pub struct Common {
    /// Configuration file
    #[arg(long, global = true, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Print exactly one JSON object on stdout
    #[arg(long, global = true)]
    pub json: bool,
    /// Print less
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Print more (-vv: everything)
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub verbose: u8,
}

/// Choice of the device, of the commands that use one.
#[derive(Clone, Debug, Args)]
pub struct DeviceArgument {
    /// Device to use: sim, auto, or a [device.NAME] of the configuration
    #[arg(
        id = "device",
        long = "device",
        global = true,
        value_name = "sim|auto|NAME"
    )]
    pub name: Option<String>,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Sweep the platform and make a point cloud of it
    Capture(Capture),
    /// Make the point cloud of a log or of a plain lidar recording; -o NAME.pcap copies the lidar's
    /// packets of a log instead
    Replay(Replay),
    /// Simulate a scene into a log, with ground truth
    Simulate(Simulate),
    /// Show clouds, logs and recordings in the browser
    View(ViewArguments),
    /// List what a file holds
    Info(Info),
    /// Calibrate mount, tilt axis and lasers by logs of ordinary scans, without targets
    Calibrate(Calibrate),
    /// Measure how accurate the points of logs are: residuals, sweeps, stations, error budget
    Accuracy(AccuracyStudyArguments),
    /// Plan a capture: how fast may it be, and what does that cost in accuracy and density?
    Plan(Plan),
    /// Measure how densely and evenly scan patterns, clouds or logs cover the surroundings
    Analyze(Analyze),
    /// Show what gaps and accuracy cost in time
    Tradeoff(Tradeoff),
    /// Show, home, move or stop the tilt axis
    Tilt(TiltArguments),
    /// Run the scanner as a service for browsers and other programs
    Daemon(DaemonArguments),
    /// Check this machine's scanner setup and suggest fixes
    Doctor(Doctor),
    /// Run the simulated EPOS2 alone, to develop a client against it
    FirmwareSim(FirmwareSim),
    /// Explain a command, or print a page of the book
    Help(Help),
    /// Stop the axis if the program that drives it dies; started by that program only
    #[command(hide = true)]
    GuardAxis,
}

/// `help`.
#[derive(Clone, Debug, Args)]
pub struct Help {
    /// Command, or page of the book; without one all pages are listed
    #[arg(value_name = "COMMAND|TOPIC")]
    pub words: Vec<String>,
}

/// `doctor`.
#[derive(Clone, Debug, Args)]
pub struct Doctor {
    /// Device.
    #[command(flatten)]
    pub device: DeviceArgument,
    /// Lead through the first hour with a real drive: every step says what it does, and measures
    #[arg(long)]
    pub bring_up: bool,
    /// Run every step of the bring-up without asking
    #[arg(long, requires = "bring_up")]
    pub yes: bool,
    /// Report that the bring-up appends to [default: bring-up.md]
    #[arg(long, value_name = "FILE", requires = "bring_up")]
    pub report: Option<PathBuf>,
}

/// `capture`.
#[derive(Clone, Debug, Args)]
pub struct Capture {
    /// Device.
    #[command(flatten)]
    pub device: DeviceArgument,
    /// Cruise speed of the tilt axis; becomes whole rpm of the motor
    #[arg(long, value_name = "DEG_PER_S", allow_negative_numbers = true, value_parser = number)]
    pub speed: f64,
    /// Angle where the sweep starts [default: the axis's upper limit]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = number)]
    pub from: Option<f64>,
    /// Angle where the sweep ends [default: the axis's lower limit]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = number)]
    pub to: Option<f64>,
    /// Acceleration of the tilt axis [default: the device's]
    #[arg(long, value_name = "DEG_PER_S2", allow_negative_numbers = true, value_parser = number)]
    pub accel: Option<f64>,
    /// Number of sweeps [default: 1, with --both-ways 2]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole::<u32>(1..=10_000))]
    pub sweeps: Option<u32>,
    /// Scan on the return move too; each direction counts as a sweep
    #[arg(long)]
    pub both_ways: bool,
    /// Raw log to write [default: named after the cloud]
    #[arg(long, value_name = "LOG.pcapng")]
    pub log: Option<PathBuf>,
    /// Accuracy.
    #[command(flatten)]
    pub accuracy: AccuracyArguments,
    /// Output.
    #[command(flatten)]
    pub output: Output,
}

/// `replay`.
#[derive(Clone, Debug, Args)]
pub struct Replay {
    /// Logs of captures, or any pcap or pcapng with lidar packets; - is stdin
    #[arg(value_name = "LOG|PCAP", required = true)]
    pub inputs: Vec<PathBuf>,
    /// Source of the tilt angles: the log, none (the sensor's own frame), or a CSV of
    /// time_s,angle_deg
    #[arg(long, value_name = "log|none|ANGLES.csv", default_value = "log")]
    pub tilt: String,
    /// Mount of the lidar: a TOML file with d_m in its table `mount`, such as calibrate writes
    /// (default: the log's; with ANGLES.csv the configuration's)
    #[arg(long, value_name = "FILE")]
    pub mount: Option<PathBuf>,
    /// Emit points at the recorded times, or FACTOR times as fast
    #[arg(long, value_name = "FACTOR", num_args = 0..=1, default_missing_value = "1", allow_negative_numbers = true, value_parser = number)]
    pub realtime: Option<f64>,
    /// Clock of the point times: the recording host's, or UTC from the lidar's satellite receiver
    #[arg(long, value_enum, default_value_t = TimeArgument::Host)]
    pub time: TimeArgument,
    /// Make one cloud per revolution, cut at this azimuth; -o NAME.ply gives NAME-00000.ply and so
    /// on, NAME.mcap one file
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = azimuth)]
    pub frames: Option<f64>,
    /// Turn the cloud into a local frame, x east, y north, z up, at the position of the lidar's
    /// satellite receiver: heading of the scanner's y axis (forward) clockwise from true north,
    /// such as 30deg; the base is taken as level
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = heading)]
    pub georeference: Option<f64>,
    /// Report how far the points of the live view are from the cloud
    #[arg(long, conflicts_with = "frames")]
    pub live: bool,
    /// Keep shots without a return: one row per ring, one column per firing (.pcd, with --frames)
    #[arg(long, requires = "frames")]
    pub organised: bool,
    /// Packet decoding.
    #[command(flatten)]
    pub lidar: LidarArguments,
    /// Accuracy.
    #[command(flatten)]
    pub accuracy: AccuracyArguments,
    /// Output.
    #[command(flatten)]
    pub output: Output,
}

/// `calibrate`.
#[derive(Clone, Debug, Args)]
pub struct Calibrate {
    /// Logs of one scanner; scan both ways, at two speeds
    #[arg(value_name = "LOG", required = true)]
    pub logs: Vec<PathBuf>,
    /// Calibration to write, for `file` of the configuration's `mount` table and replay --mount
    #[arg(short, long, value_name = "MOUNT.toml")]
    pub output: Option<PathBuf>,
    /// Mount to start from [default: the first log's]
    #[arg(long, value_name = "FILE")]
    pub mount: Option<PathBuf>,
    /// Parameters to keep at their start: a name or its first words, such as laser or play
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    pub fix: Vec<String>,
    /// Folder for a page that draws the residuals, and the JSON object
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Surface that sets the zero of the tilt
    #[arg(long, value_enum, allow_hyphen_values = true)]
    pub level: Option<LevelSurface>,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// `accuracy`.
#[derive(Clone, Debug, Args)]
pub struct AccuracyStudyArguments {
    /// Logs of one scanner; of several stations in one place corners are compared
    #[arg(value_name = "LOG", required = true)]
    pub logs: Vec<PathBuf>,
    /// Mount and calibration of the scanner [default: the first log's]
    #[arg(long, value_name = "FILE")]
    pub mount: Option<PathBuf>,
    /// Scene with which the log was simulated, to compare points with the truth
    #[arg(long, value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    /// Seed with which it was simulated [default: the log's]
    #[arg(long, value_name = "N", requires = "scene", allow_negative_numbers = true, value_parser = whole::<u64>(0..=u64::MAX))]
    pub seed: Option<u64>,
    /// Folder for a page with the tables, and the JSON object
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// `--level`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LevelSurface {
    /// The floor.
    Floor,
}

/// `simulate`.
#[derive(Clone, Debug, Args)]
pub struct Simulate {
    /// Scene file (TOML), or the name of a built-in scene: hall, parking, quarry, glass-corridor,
    /// fog, traffic, room, stairwell, wavy-walls, hollow-sphere, planes, rig
    #[arg(value_name = "SCENE.toml|NAME")]
    pub scene: PathBuf,
    /// Log to write, or the measured cloud of a lidar whose packets are not simulated, such as an
    /// HDL-64E [default: named after the scene]
    #[arg(short, long, value_name = "LOG.pcapng")]
    pub output: Option<PathBuf>,
    /// Cloud of the true points: .ply .pcd .las .laz .e57 .mcap .csv .xyz .bin .npz; - is PLY on
    /// stdout
    #[arg(long, value_name = "CLOUD")]
    pub truth: Option<PathBuf>,
    /// Random seed [default: the scene's]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole::<u64>(0..=u64::MAX))]
    pub seed: Option<u64>,
    /// Effects of the scene to omit, by name, or all of them: docs, Effects
    #[arg(long, value_name = "EFFECT,..|all", value_delimiter = ',', value_parser = effect_or_all(), hide_possible_values = true)]
    pub without: Vec<String>,
    /// Threads that make packets; the log does not depend on it [default: one per core]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = threads)]
    pub threads: Option<NonZeroUsize>,
    /// Run with as few effects as keep the cloud this close to one with all that the scene calls
    /// for: so many percent of the points may be displaced farther, missing or added [default: the
    /// scene's]
    #[arg(long, value_name = "LENGTH,SHARE", allow_hyphen_values = true)]
    pub tolerance: Option<EffectTolerance>,
    /// Report what each effect changes in the cloud and costs, and the fact that calls for it
    #[arg(long)]
    pub explain: bool,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// `--without all`.
pub const ALL: &str = "all";

/// Requested accuracy.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct AccuracyArguments {
    /// Tolerated point error at a distance, such as 2mm@20m, by tilt angle and clock, without that
    /// of the ranges: selects the cheapest sufficient method [default: the most accurate]
    #[arg(long, value_name = "LENGTH@DISTANCE", allow_hyphen_values = true)]
    pub tolerance: Option<Tolerance>,
}

/// Packet decoding.
#[derive(Clone, Debug, Default, Args)]
pub struct LidarArguments {
    /// Lidar to use if the recording holds several
    #[arg(long, value_name = "ADDRESS[:PORT]")]
    pub sensor: Option<SensorAddress>,
    /// Model, if neither the factory byte nor the timing of the packets identifies it; vlp16 is
    /// also a Puck or Puck LITE, vlp32c an Ultra Puck
    #[arg(long, value_parser = captured_model())]
    pub model: Option<&'static LidarModel>,
    /// Calibration of the individual lidar: ROS YAML or TOML
    #[arg(long, value_name = "FILE")]
    pub calibration: Option<PathBuf>,
    /// Equal returns of a pulse in dual return mode: one point or two
    #[arg(long, value_enum, default_value_t = EqualReturns::Once)]
    pub equal_returns: EqualReturns,
    /// Start all rays in one point, as many drivers do, instead of at the height of each laser
    #[arg(long)]
    pub one_origin: bool,
}

/// Clock of the point times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum TimeArgument {
    /// The recording host's clock
    #[default]
    Host,
    /// UTC, while the lidar's clock is locked to a satellite receiver
    Utc,
}

/// Treatment of two equal returns of one pulse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum EqualReturns {
    /// One point
    #[default]
    Once,
    /// Two points
    Twice,
}

/// Output of a cloud.
#[derive(Clone, Debug, Args)]
pub struct Output {
    /// Cloud to write: .ply .pcd .las .laz .e57 .mcap .csv .xyz .bin .npz; - is PLY on stdout
    #[arg(short, long, value_name = "CLOUD")]
    pub output: Option<PathBuf>,
    /// Add a column sd: standard error of each point (root mean square), metres
    #[arg(long)]
    pub uncertainty: bool,
    /// Add a column echo: 1 strongest, 2 last, 3 both in one, 4 second return, 0 unknown
    #[arg(long)]
    pub echo: bool,
    /// Add a column laser: the number of each point's laser, in firing order from 0
    #[arg(long)]
    pub laser: bool,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// `view`.
#[derive(Clone, Debug, Args)]
pub struct ViewArguments {
    /// Clouds (.ply .pcd .las .laz .e57 .mcap .csv .xyz .bin .npz .txt .asc), logs or recordings
    /// (pcapng, pcap); a log's cloud is made first and plays along its time
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Print the address only, and open no browser
    #[arg(long)]
    pub no_open: bool,
}

/// `info`.
#[derive(Clone, Debug, Args)]
pub struct Info {
    /// Logs, pcap or pcapng files; - is stdin
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Model, if neither the factory byte nor the timing of the packets identifies it; vlp16 is
    /// also a Puck or Puck LITE, vlp32c an Ultra Puck
    #[arg(long, value_parser = captured_model())]
    pub model: Option<&'static LidarModel>,
}

/// `plan`.
#[derive(Clone, Debug, Args)]
pub struct Plan {
    /// Device.
    #[command(flatten)]
    pub device: DeviceArgument,
    /// Distance at which errors and gaps count, such as 20m
    #[arg(long, value_name = "M", default_value = "20m", allow_hyphen_values = true, value_parser = metres)]
    pub at: f64,
    /// Tolerated error of 95 % of points there, ranges included, such as 5mm
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = millimetres)]
    pub error: Option<f64>,
    /// Tolerated distance from a direction to the nearest point, for 99 % of directions in view,
    /// such as 0.3deg
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = degrees)]
    pub gap: Option<f64>,
    /// Time for the scan with homing, such as 10s
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = seconds)]
    pub time: Option<f64>,
    /// Lidar: vlp16, hi-res, hdl32e, vlp32c, or one that velomotion does not capture: hdl64e,
    /// utm30lx, lms151 [default: the configuration's, vlp16]
    #[arg(long, value_name = "MODEL", value_parser = lidar_sheet(), hide_possible_values = true)]
    pub lidar: Option<&'static LidarSheet>,
    /// Revolutions of the lidar per minute to choose from; they are set on the lidar's own page
    /// [default: the configuration's, 600; another lidar's usual one]
    #[arg(long, value_name = "N[,N]", value_delimiter = ',', allow_negative_numbers = true, value_parser = whole::<u32>(0..=1_000_000))]
    pub rpm: Vec<u32>,
    /// Standard deviation of a range, such as 10mm [default: the configuration's range_sd_m, or the
    /// lidar's by its data sheet]
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = millimetres)]
    pub range_sd: Option<f64>,
    /// Standard deviation of mount and zero of the tilt, such as 0.05deg [default: not included]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = degrees)]
    pub mount_sd: Option<f64>,
    /// Angle where the sweep starts [default: the axis's upper limit]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = number)]
    pub from: Option<f64>,
    /// Angle where the sweep ends [default: the axis's lower limit]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = number)]
    pub to: Option<f64>,
    /// Folder for a report: figure (plan.svg) and plan.json
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Overwrite existing files
    #[arg(long, requires = "report")]
    pub force: bool,
}

/// `analyze`.
#[derive(Clone, Debug, Args)]
pub struct Analyze {
    /// Patterns by name: a lidar (vlp16, hi-res, hdl32e, vlp32c, hdl64e, utm30lx, lms151), which
    /// tilts with :SPEED and spins with ,spin; rmbl:SPEED, rsbl:SPEED, velomotion16:SPEED. Each
    /// takes ,KEY=VALUE: rpm, step, start, seam, from, to, accel, tilt, frames, d, and planar
    /// scanners ,roll or ,pitch. Clouds (.ply .pcd .las .laz .e57 .mcap .csv .xyz .bin .npz .txt
    /// .asc), logs or recordings
    #[arg(value_name = "PATTERN|CLOUD|LOG", required = true)]
    pub inputs: Vec<String>,
    /// Subdivisions of the icosahedron whose faces are the bins: 20 x 4^N bins
    #[arg(long, value_name = "N", default_value_t = 4, allow_negative_numbers = true, value_parser = whole::<u32>(0..=8))]
    pub level: u32,
    /// Tolerated error of the K function as a share of all pairs: selects the cheapest sufficient
    /// method; 0 counts every pair
    #[arg(long, value_name = "X", default_value_t = 1e-4, allow_negative_numbers = true, value_parser = share)]
    pub k_error: f64,
    /// Bins of the K function, from 0 to 180 degrees
    #[arg(long, value_name = "N", default_value_t = 151, allow_negative_numbers = true, value_parser = whole::<u16>(1..=3_600))]
    pub bins: u16,
    /// Position of the scanner in cloud coordinates, metres: the origin of all directions [default:
    /// 0,0,0]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, conflicts_with = "sweep", value_parser = place)]
    pub origin: Option<[f64; 3]>,
    /// Try settings of one pattern: ranges of speed, rpm or other parameters in steps (8 unless
    /// /N), and list the best per scan time
    #[arg(
        long,
        value_name = "KEY=FROM..TO[/N][,...]",
        allow_hyphen_values = true
    )]
    pub sweep: Option<SweepRanges>,
    /// Folder for a report: page (index.html), figures (SVG), curves (CSV) and analyze.json
    #[arg(long, value_name = "DIR", conflicts_with = "sweep")]
    pub report: Option<PathBuf>,
    /// Write into a folder that is not empty; files of the same names are overwritten
    #[arg(long, requires = "report")]
    pub force: bool,
}

/// `tradeoff`.
#[derive(Clone, Debug, Args)]
pub struct Tradeoff {
    /// Folder for a report: page (index.html), figure (SVG) and tradeoff.json
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Folder of book pages: writes tradeoff.md, and its figures to tradeoff/
    #[arg(long, value_name = "DIR")]
    pub markdown: Option<PathBuf>,
    /// Quick run: fewer settings
    #[arg(long)]
    pub quick: bool,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// `daemon`.
#[derive(Clone, Debug, Args)]
pub struct DaemonArguments {
    /// Device.
    #[command(flatten)]
    pub device: DeviceArgument,
    /// Address and port to listen on; port 0 selects a free one [default: the configuration's,
    /// 127.0.0.1:8016]
    #[arg(long, value_name = "ADDRESS:PORT", value_parser = address_and_port)]
    pub listen: Option<SocketAddr>,
}

/// `tilt`.
#[derive(Clone, Debug, Args)]
pub struct TiltArguments {
    /// Device.
    #[command(flatten)]
    pub device: DeviceArgument,
    /// Request to the axis.
    #[command(subcommand)]
    pub verb: TiltVerb,
}

/// Request to the axis.
#[derive(Clone, Copy, Debug, Subcommand)]
pub enum TiltVerb {
    /// Show its state; nothing moves
    Status,
    /// Find its zero position at the limit switch
    Home,
    /// Move it to an angle
    Goto {
        /// Target angle
        #[arg(value_name = "DEG", allow_negative_numbers = true, value_parser = number)]
        to: f64,
        /// Motion.
        #[command(flatten)]
        motion: MotionArguments,
    },
    /// Move it by an angle from where it is
    Jog {
        /// Angle; negative ones tilt towards the lower limit
        #[arg(value_name = "DEG", allow_negative_numbers = true, value_parser = number)]
        by: f64,
        /// Motion.
        #[command(flatten)]
        motion: MotionArguments,
    },
    /// Stop it now and set the brake, also during a capture
    Stop,
    /// List its faults, with meaning and remedy
    Faults {
        /// Leave the fault state; the fault history stays
        #[arg(long)]
        clear: bool,
    },
}

/// Speed and acceleration of a move by hand.
#[derive(Clone, Copy, Debug, Args)]
pub struct MotionArguments {
    /// Speed
    #[arg(
        long,
        value_name = "DEG_PER_S",
        default_value_t = 10.0,
        allow_negative_numbers = true,
        value_parser = number
    )]
    pub speed: f64,
    /// Acceleration [default: the device's]
    #[arg(long, value_name = "DEG_PER_S2", allow_negative_numbers = true, value_parser = number)]
    pub accel: Option<f64>,
}

/// `firmware-sim`.
#[derive(Clone, Debug, Args)]
#[command(group = clap::ArgGroup::new("interface").required(true))]
pub struct FirmwareSim {
    /// Speak EPOS2 USB frames on a pseudo-terminal
    #[arg(long, group = "interface")]
    pub usb: bool,
    /// Speak EPOS2 RS232 frames on a pseudo-terminal
    #[arg(long, group = "interface")]
    pub rs232: bool,
    /// Speak CANopen behind an SLCAN adapter on a pseudo-terminal
    #[arg(long, group = "interface")]
    pub slcan: bool,
    /// Speak CANopen on a CAN interface of the kernel
    #[arg(long, group = "interface", value_name = "IFACE")]
    pub can: Option<String>,
    /// Create a symbolic link to the port
    #[arg(long, value_name = "PATH", conflicts_with = "can")]
    pub link: Option<PathBuf>,
    /// Let gravity accelerate the axis without power, positive towards larger angles; without it,
    /// --friction and --brake the axis stays in place
    #[arg(
        long,
        value_name = "DEG_PER_S2",
        allow_negative_numbers = true,
        value_parser = acceleration
    )]
    pub gravity: Option<f64>,
    /// Let the axis coast without power until friction has stopped it
    #[arg(
        long,
        value_name = "DEG_PER_S2",
        allow_negative_numbers = true,
        value_parser = deceleration
    )]
    pub friction: Option<f64>,
    /// Fit a holding brake that opens and closes in these times; without --friction the axis coasts
    /// until it holds
    #[arg(long, value_name = "OPEN_MS,CLOSE_MS", value_parser = two_times)]
    pub brake: Option<(u16, u16)>,
    /// Deceleration by the closed brake; less than gravity slips [default: holds any load]
    #[arg(
        long,
        value_name = "DEG_PER_S2",
        requires = "brake",
        allow_negative_numbers = true,
        value_parser = deceleration
    )]
    pub brake_holds: Option<f64>,
    /// Renew the position (6064) once per control cycle of 1 ms, as a real drive may
    #[arg(long)]
    pub latch: bool,
    /// Let the encoder's count deviate by up to this many quadcounts at rest under power
    #[arg(long, value_name = "QC", default_value_t = 0, allow_negative_numbers = true, value_parser = whole::<u8>(0..=255))]
    pub dither: u8,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_readme_command_is_accepted() {
        let cli = Cli::try_parse_from(["velomotion", "capture", "--speed", "56.25"]).unwrap();
        assert!(matches!(
            cli.command,
            Command::Capture(Capture { speed: 56.25, .. })
        ));
    }

    #[test]
    fn loads_of_the_simulated_axis_are_finite_and_decelerations_positive() {
        let accepts = |option: &str, value: &str| {
            let line = ["velomotion", "firmware-sim", "--usb", "--brake", "5,5"];
            Cli::try_parse_from(line.into_iter().chain([option, value])).is_ok()
        };
        assert!(accepts("--gravity", "-250") && accepts("--friction", "0"));
        for option in ["--gravity", "--friction", "--brake-holds"] {
            assert!(accepts(option, "250.5"), "{option}");
            for value in ["NaN", "inf", "1e9", "x"] {
                assert!(!accepts(option, value), "{option} {value}");
            }
        }
        for option in ["--friction", "--brake-holds"] {
            assert!(!accepts(option, "-0.1"), "{option}");
        }
    }

    #[test]
    fn the_help_names_every_built_in_scene() {
        let mut command = Cli::command();
        let simulate = command.find_subcommand_mut("simulate").unwrap();
        let help = simulate.render_long_help().to_string();
        let flat = help.split_whitespace().collect::<Vec<_>>().join(" ");
        for (name, _) in sim::scene_file::SHIPPED {
            assert!(flat.contains(name), "{name}: {flat}");
        }
    }

    #[test]
    fn angles_may_be_negative() {
        let line = "velomotion capture --speed 10 --from -5 --to -45.5";
        assert!(Cli::try_parse_from(line.split(' ')).is_ok());
    }
}
