//! The command line. Other programs drive it: names and meanings are a contract.

use std::net::SocketAddr;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand, ValueEnum};
use cloud::Fields;
use engine::capture::jog::JogRequest;
use engine::capture::request::CaptureRequest;
use engine::reconstruct::decoder_options::DecoderRequest;
use engine::reconstruct::replay;
use lidar::Duplicates;
use protocol::vlp16::{Model, models};
use scanner::Tolerance;

use crate::commands::analyze::Sweep;
use engine::reconstruct::source::SensorName;

/// Version, and the commit that the program was built from.
pub const VERSION: &str = env!("VELOMOTION_VERSION");

/// Dense point clouds from a multi-beam lidar on a tilting platform.
#[derive(Debug, Parser)]
#[command(version = VERSION, about, max_term_width = 100)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// What every command understands.
    #[command(flatten)]
    pub common: Common,
}

/// What every command understands.
#[derive(Clone, Debug, Args)]
pub struct Common {
    /// Device to use: sim, auto, or a [device.NAME] of the configuration
    #[arg(long, global = true, value_name = "sim|auto|NAME")]
    pub device: Option<String>,
    /// Configuration file
    #[arg(long, global = true, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Print exactly one JSON object on stdout
    #[arg(long, global = true)]
    pub json: bool,
    /// Say less
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say more (-vv: everything)
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub verbose: u8,
}

/// The verbs.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Sweep the platform and make a point cloud of it
    Capture(Capture),
    /// Make the point cloud of a log or of a plain lidar recording
    Replay(Replay),
    /// Simulate a scene into a log, with the truth beside it
    Simulate(Simulate),
    /// Say what a file holds
    Info(Info),
    /// Say how densely and evenly scan patterns, clouds or logs cover what is about the scanner
    Analyze(Analyze),
    /// Measure, on this machine and now, what accuracy costs in time
    Tradeoff(Tradeoff),
    /// Look at the tilt axis, home it, move it, stop it
    Tilt(Tilt),
    /// Keep the scanner, show it in the browser and answer other programs, until told to end
    Daemon(Daemon),
    /// Say what this machine has of a scanner, what is wrong and what to do
    Doctor,
    /// Run the software EPOS2 alone, for developing a client against it
    FirmwareSim(FirmwareSim),
}

/// `capture`.
#[derive(Clone, Debug, Args)]
pub struct Capture {
    /// Cruise speed of the tilt axis; becomes whole rpm of the motor
    #[arg(long, value_name = "DEG_PER_S", allow_negative_numbers = true)]
    pub speed: f64,
    /// Angle where the sweep starts [default: the axis's upper limit]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    pub from: Option<f64>,
    /// Angle where the sweep ends [default: the axis's lower limit]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    pub to: Option<f64>,
    /// Acceleration of the tilt axis [default: the device's]
    #[arg(long, value_name = "DEG_PER_S2", allow_negative_numbers = true)]
    pub accel: Option<f64>,
    /// How many sweeps [default: 1, with --both-ways 2]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub sweeps: Option<u32>,
    /// Scan on the way back too; each way counts as a sweep
    #[arg(long)]
    pub both_ways: bool,
    /// Raw log to keep [default: named after the cloud]
    #[arg(long, value_name = "LOG.pcapng")]
    pub log: Option<PathBuf>,
    /// How accurate it is to be
    #[command(flatten)]
    pub accuracy: Accuracy,
    /// Where the cloud goes
    #[command(flatten)]
    pub output: Output,
}

/// `replay`.
#[derive(Clone, Debug, Args)]
pub struct Replay {
    /// Log of a capture, or any pcap or pcapng with lidar packets; - is stdin
    #[arg(value_name = "LOG|PCAP")]
    pub input: PathBuf,
    /// Where tilt angles come from: the log, nowhere (the sensor's own frame), or a CSV of time_s,angle_deg
    #[arg(long, value_name = "log|none|ANGLES.csv", default_value = "log")]
    pub tilt: String,
    /// Hand the points on at the times at which they were recorded, or FACTOR times as fast
    #[arg(long, value_name = "FACTOR", num_args = 0..=1, default_missing_value = "1")]
    pub realtime: Option<f64>,
    /// Whose clock the points' times are of: the recording host's, or UTC by the lidar's satellite receiver
    #[arg(long, value_enum, default_value_t = TimeReference::Host)]
    pub time: TimeReference,
    /// Make a cloud of each turn of the lidar, cut at this azimuth; -o NAME.ply gives NAME-00000.ply and so on, NAME.mcap one file
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = azimuth)]
    pub frames: Option<f64>,
    /// Keep the shots without a return: a row a ring, a column a firing (.pcd, with --frames)
    #[arg(long, requires = "frames")]
    pub organised: bool,
    /// How the lidar's packets are read
    #[command(flatten)]
    pub lidar: Lidar,
    /// How accurate it is to be
    #[command(flatten)]
    pub accuracy: Accuracy,
    /// Where the cloud goes
    #[command(flatten)]
    pub output: Output,
}

/// `simulate`.
#[derive(Clone, Debug, Args)]
pub struct Simulate {
    /// Scene file (TOML), or the name of a scene that comes with the program: hall
    #[arg(value_name = "SCENE.toml|NAME")]
    pub scene: PathBuf,
    /// Log to write [default: named after the scene]
    #[arg(short, long, value_name = "LOG.pcapng")]
    pub output: Option<PathBuf>,
    /// Cloud of the true points: .ply .pcd .las .laz .e57 .mcap .csv; - is PLY on stdout
    #[arg(long, value_name = "CLOUD")]
    pub truth: Option<PathBuf>,
    /// What chance depends on [default: the scene's]
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Effects of the scene to leave out, by name, or all of them: docs, Effects
    #[arg(long, value_name = "EFFECT,..|all", value_delimiter = ',', value_parser = effect_or_all(), hide_possible_values = true)]
    pub without: Vec<String>,
    /// Threads that make packets; the log does not depend on it [default: one a core]
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Say what each effect did and cost, which line asked for it, and which were not needed
    #[arg(long)]
    pub explain: bool,
    /// Overwrite files that exist
    #[arg(long)]
    pub force: bool,
}

/// `--without`: all effects.
pub const ALL: &str = "all";

/// The names of effects, and [`ALL`].
fn effect_or_all() -> PossibleValuesParser {
    let names = sim::effects::Wishes::NAMES.iter().copied();
    PossibleValuesParser::new(names.chain([ALL]))
}

/// How accurate a cloud is to be.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct Accuracy {
    /// How far off points may be at a distance, such as 2mm@20m: the cheapest way that is good enough [default: the best there is]
    #[arg(long, value_name = "LENGTH@DISTANCE", allow_hyphen_values = true)]
    pub tolerance: Option<Tolerance>,
}

impl Accuracy {
    /// What it asks of the synchroniser.
    #[must_use]
    pub fn wanted(&self) -> scanner::Accuracy {
        self.tolerance
            .map_or(scanner::Accuracy::Best, scanner::Accuracy::Within)
    }
}

/// How a lidar's packets are read.
#[derive(Clone, Debug, Default, Args)]
pub struct Lidar {
    /// Which lidar, where the recording holds several
    #[arg(long, value_name = "ADDRESS[:PORT]")]
    pub sensor: Option<SensorName>,
    /// The lidar's model, where neither its packets' factory byte nor their spacing tells it right
    #[arg(long, value_enum)]
    pub model: Option<ModelName>,
    /// Calibration of this very lidar: YAML as ROS drivers have it, or TOML
    #[arg(long, value_name = "FILE")]
    pub calibration: Option<PathBuf>,
    /// Dual return: both returns of a pulse where they are equal, or one of them
    #[arg(long, value_enum, default_value_t = Equal::Once)]
    pub equal_returns: Equal,
    /// Let all rays start in one point, as many drivers do, and not each at its laser's height
    #[arg(long)]
    pub one_origin: bool,
}

/// Whose clock times are of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum TimeReference {
    /// The recording host's
    #[default]
    Host,
    /// UTC, where the lidar's clock was locked to a satellite receiver
    Utc,
}

/// The models by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ModelName {
    /// VLP-16, Puck, Puck LITE
    Vlp16,
    /// Puck Hi-Res
    HiRes,
    /// HDL-32E
    Hdl32e,
    /// VLP-32C, Ultra Puck
    Vlp32c,
}

/// What becomes of two equal returns of one pulse.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Equal {
    /// One point
    #[default]
    Once,
    /// Two points
    Twice,
}

impl From<TimeReference> for replay::TimeReference {
    fn from(time: TimeReference) -> Self {
        match time {
            TimeReference::Host => Self::Host,
            TimeReference::Utc => Self::Utc,
        }
    }
}

impl Lidar {
    /// The request to the engine.
    #[must_use]
    pub fn request(&self) -> DecoderRequest {
        DecoderRequest {
            model: self.model.map(ModelName::model),
            calibration: self.calibration.clone(),
            duplicates: match self.equal_returns {
                Equal::Once => Duplicates::Unique,
                Equal::Twice => Duplicates::All,
            },
            one_origin: self.one_origin,
        }
    }
}

impl From<TiltVerb> for JogRequest {
    fn from(verb: TiltVerb) -> Self {
        match verb {
            TiltVerb::Status | TiltVerb::Faults { clear: false } => Self::Status,
            TiltVerb::Faults { clear: true } => Self::ClearFaults,
            TiltVerb::Stop => Self::Stop,
            TiltVerb::Home => Self::Home,
            TiltVerb::Goto { to, speed, accel } => Self::Goto {
                to_deg: to,
                speed_deg_s: speed,
                accel_deg_s2: accel,
            },
        }
    }
}

impl From<&Capture> for CaptureRequest {
    fn from(arguments: &Capture) -> Self {
        Self {
            speed_deg_s: arguments.speed,
            from_deg: arguments.from,
            to_deg: arguments.to,
            accel_deg_s2: arguments.accel,
            sweeps: arguments.sweeps,
            both_ways: arguments.both_ways,
            tolerance: arguments
                .accuracy
                .tolerance
                .map(|t| format!("{}m@{}m", t.off.0, t.at.0)),
            name: None,
        }
    }
}

impl ModelName {
    /// The model.
    #[must_use]
    pub const fn model(self) -> &'static Model {
        match self {
            Self::Vlp16 => &models::VLP_16,
            Self::HiRes => &models::PUCK_HI_RES,
            Self::Hdl32e => &models::HDL_32E,
            Self::Vlp32c => &models::VLP_32C,
        }
    }
}

/// Where a cloud goes.
#[derive(Clone, Debug, Args)]
pub struct Output {
    /// Cloud to write: .ply .pcd .las .laz .e57 .mcap .csv; - is PLY on stdout
    #[arg(short, long, value_name = "CLOUD")]
    pub output: Option<PathBuf>,
    /// Add a column sd: how far each point is expected to be off (root mean square), metres
    #[arg(long)]
    pub uncertainty: bool,
    /// Add a column echo: 1 strongest, 2 last, 3 both in one, 4 dual return's other one, 0 not told
    #[arg(long)]
    pub echo: bool,
    /// Overwrite files that exist
    #[arg(long)]
    pub force: bool,
}

impl Output {
    /// The columns of the cloud beside the position.
    #[must_use]
    pub fn fields(&self) -> Fields {
        let asked = [(self.uncertainty, Fields::SD), (self.echo, Fields::ECHO)];
        let asked = asked.into_iter().filter(|(asked, _)| *asked);
        asked.fold(Fields::FILE, |fields, (_, field)| fields | field)
    }
}

/// `info`.
#[derive(Clone, Debug, Args)]
pub struct Info {
    /// Log, pcap or pcapng; - is stdin
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// The lidars' model, where neither their packets' factory byte nor their spacing tells it right
    #[arg(long, value_enum)]
    pub model: Option<ModelName>,
}

/// `analyze`.
#[derive(Clone, Debug, Args)]
pub struct Analyze {
    /// Patterns by name (vlp16, hdl32e, vlp32c, rmbl:SPEED, rsbl:SPEED, velomotion16:SPEED, each with ,KEY=VALUE: rpm, step,
    /// start, seam, from, to, tilt, frames, d), clouds (.ply .pcd .las .laz .e57 .mcap .csv .xyz .txt .asc), logs or recordings
    #[arg(value_name = "PATTERN|CLOUD|LOG", required = true)]
    pub inputs: Vec<String>,
    /// How often the icosahedron whose faces are the bins is cut: 20 x 4^N bins
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(0..=8))]
    pub level: u32,
    /// How far the K function may be off, as a share of all pairs: the cheapest way that is good enough; 0 counts every pair
    #[arg(long, value_name = "X", default_value_t = 1e-4, value_parser = tolerance)]
    pub tolerance: f64,
    /// The K function by spherical harmonics up to this degree (64 is usual) instead: faster, but how far it is off is not known
    #[arg(long, value_name = "DEGREE", conflicts_with = "tolerance", value_parser = clap::value_parser!(u16).range(1..=512))]
    pub harmonics: Option<u16>,
    /// Bins of the K function, from 0 to 180 degrees
    #[arg(long, value_name = "N", default_value_t = 151, value_parser = clap::value_parser!(u16).range(1..=3_600))]
    pub bins: u16,
    /// Where the scanner was, metres in the coordinates of the clouds: directions are seen from there [default: 0,0,0]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, conflicts_with = "sweep", value_parser = place)]
    pub origin: Option<[f64; 3]>,
    /// Try settings of one pattern: ranges of speed, rpm or other numbers, each in steps (8 unless /N says so), and say which are best for their scan time
    #[arg(
        long,
        value_name = "KEY=FROM..TO[/N][,...]",
        allow_hyphen_values = true
    )]
    pub sweep: Option<Sweep>,
    /// Folder for a page to look at (index.html), its figures (SVG), every curve (CSV) and analyze.json
    #[arg(long, value_name = "DIR", conflicts_with = "sweep")]
    pub report: Option<PathBuf>,
    /// Write into a folder that is not empty, over what has the same names
    #[arg(long, requires = "report")]
    pub force: bool,
}

/// `tradeoff`.
#[derive(Clone, Debug, Args)]
pub struct Tradeoff {
    /// Folder for a page to look at (index.html), a figure a study (SVG) and tradeoff.json
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Folder of a book's pages: writes tradeoff.md, and its figures into tradeoff/
    #[arg(long, value_name = "DIR")]
    pub markdown: Option<PathBuf>,
    /// Only these studies
    #[arg(long, value_name = "NAME[,NAME]", value_delimiter = ',')]
    pub only: Vec<String>,
    /// A look: smaller workloads and fewer rounds
    #[arg(long)]
    pub quick: bool,
    /// Overwrite files that exist
    #[arg(long)]
    pub force: bool,
}

/// `daemon`.
#[derive(Clone, Copy, Debug, Args)]
pub struct Daemon {
    /// Address and port to listen on; port 0 takes any that is free [default: the configuration's, 127.0.0.1:8016]
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub listen: Option<SocketAddr>,
}

/// `tilt`.
#[derive(Clone, Debug, Args)]
pub struct Tilt {
    /// What to do with the axis.
    #[command(subcommand)]
    pub verb: TiltVerb,
}

/// What to do with the axis.
#[derive(Clone, Copy, Debug, Subcommand)]
pub enum TiltVerb {
    /// Say how it stands; changes nothing
    Status,
    /// Find its zero at the limit switch
    Home,
    /// Move it to an angle
    Goto {
        /// Where to
        #[arg(value_name = "DEG", allow_negative_numbers = true)]
        to: f64,
        /// How fast
        #[arg(
            long,
            value_name = "DEG_PER_S",
            default_value_t = 10.0,
            allow_negative_numbers = true
        )]
        speed: f64,
        /// Acceleration [default: the device's]
        #[arg(long, value_name = "DEG_PER_S2", allow_negative_numbers = true)]
        accel: Option<f64>,
    },
    /// Stop it now and set the brake, also while a capture runs
    Stop,
    /// Say what faults it had, what they mean and what to do
    Faults {
        /// Take the drive out of its fault; the history stays
        #[arg(long)]
        clear: bool,
    },
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
    /// Make a symbolic link to the port
    #[arg(long, value_name = "PATH", conflicts_with = "can")]
    pub link: Option<PathBuf>,
}

/// A share that something may be off by.
fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.0..1.0).contains(&share) => Ok(share),
        _ => Err("expected a share from 0 (every pair is counted) to below 1".to_owned()),
    }
}

/// A place as a user gives it, metres.
fn place(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text
        .split(',')
        .filter_map(|number| number.trim().parse().ok())
        .filter(|number: &f64| number.is_finite())
        .collect();
    match (numbers.try_into(), text.split(',').count()) {
        (Ok(place), 3) => Ok(place),
        _ => Err("expected three numbers, metres: X,Y,Z".to_owned()),
    }
}

/// An azimuth as a user may give it, degrees.
fn azimuth(text: &str) -> Result<f64, String> {
    let degrees: f64 = text.parse().map_err(|_| "expected degrees".to_owned())?;
    if (-360.0..=360.0).contains(&degrees) {
        Ok(degrees)
    } else {
        Err("expected an azimuth from -360 to 360 degrees".to_owned())
    }
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
    fn the_cards_command_is_understood() {
        let cli = Cli::try_parse_from(["velomotion", "capture", "--speed", "56.25"]).unwrap();
        assert!(matches!(
            cli.command,
            Command::Capture(Capture { speed: 56.25, .. })
        ));
    }

    #[test]
    fn angles_may_be_negative() {
        let line = "velomotion capture --speed 10 --from -5 --to -45.5";
        assert!(Cli::try_parse_from(line.split(' ')).is_ok());
    }
}
