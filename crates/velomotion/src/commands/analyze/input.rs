//! Inputs of the analysis: a named pattern, a cloud, or a log or recording, as directions of
//! points.
//!
//! Directions start at the origin of the base, on the tilt axis; without tilt at the sensor; for
//! clouds at their origin or `--origin`.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use analysis::tilted_sensor::{TiltedSensor, vertical_resolution_deg};
use cloud::formats::Format;
use cloud::read::positions;
use cloud::{Fields, Points, Sink, SinkError, TiltTrack};
use glam::DVec3;
use protocol::record::Wire;
use scanner::{Accuracy, TiltSource};
use sim::patterns::{Pattern, PatternError, PatternRequest};

use super::directions::Directions;
use super::report::DeviceReport;
use super::view::{DistantOrigin, ViewReport};
use engine::failure::{Failure, Kind};
use engine::reconstruct::replay;
use engine::reconstruct::replay::TimeReference;
use engine::reconstruct::source::Source;

/// Directions and their provenance.
#[derive(Default)]
pub struct Input {
    /// Name of the input.
    pub name: String,
    /// Whether its devices were simulated.
    pub simulated: bool,
    /// Unit directions of the points.
    pub directions: Directions,
    /// Revolutions of the lidar, if known.
    pub frames: Option<u64>,
    /// Duration of the scan, if known, seconds.
    pub scan_s: Option<f64>,
    /// Points at the origin, which have no direction.
    pub without_direction: u64,
    /// Rows with NaN coordinates, mostly shots without a return.
    pub without_numbers: u64,
    /// Field of view, if known: for patterns and logs.
    pub view: Option<ViewReport>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Position of the origin relative to a cloud.
    pub outside: Option<DistantOrigin>,
    /// The pattern, if it is one.
    pub pattern: Option<Pattern>,
}

/// An input named by an argument.
pub enum InputArgument<'a> {
    /// A pattern.
    Pattern(Box<Pattern>),
    /// A cloud in a readable format.
    Cloud(&'a Path, Format),
    /// A log or a recording.
    Log(&'a Path),
}

impl<'a> InputArgument<'a> {
    /// Classifies an argument without reading the file: by pattern name, else by extension. `.txt`
    /// and `.asc` are read like `.xyz`.
    ///
    /// # Errors
    /// [`Kind::Usage`] for invalid patterns, [`Kind::BadInput`] for missing files.
    pub fn new(argument: &'a str) -> Result<Self, Failure> {
        if PatternRequest::is_one(argument) {
            let pattern = PatternRequest::parse(argument).and_then(|request| request.build());
            return Ok(Self::Pattern(Box::new(
                pattern.map_err(|e| pattern_failure(&e))?,
            )));
        }
        let path = Path::new(argument);
        if argument != "-" && !path.exists() {
            let what = format!("there is no pattern and no file {argument:?}");
            return Err(Failure::new(Kind::BadInput, what).help(HINT));
        }
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let is_text = TEXT_EXTENSIONS.iter().any(|text| extension == *text);
        Ok(match Format::from_path(path) {
            Ok(format) => Self::Cloud(path, format),
            Err(_) if is_text => Self::Cloud(path, Format::Xyz),
            Err(_) => Self::Log(path),
        })
    }

    /// Whether it is a cloud, which may have another origin.
    pub const fn is_cloud(&self) -> bool {
        matches!(self, Self::Cloud(..))
    }

    /// Reads the directions; those of a cloud start at `origin_m`.
    ///
    /// # Errors
    /// [`Kind::BadInput`] for unreadable files and files without points.
    pub fn read(&self, origin_m: DVec3, interrupt: &AtomicBool) -> Result<Input, Failure> {
        match self {
            Self::Pattern(pattern) => Ok(of_pattern(pattern)),
            Self::Cloud(path, format) => of_cloud(path, *format, origin_m),
            Self::Log(path) => of_log(path, interrupt),
        }
    }
}

/// Extensions of text files with one row per point, apart from `.csv` and `.xyz`.
const TEXT_EXTENSIONS: [&str; 2] = ["txt", "asc"];

const HINT: &str = "name a pattern (a lidar: vlp16, hi-res, hdl32e, vlp32c, hdl64e, utm30lx, lms151, each with :SPEED to tilt and ,spin to spin; rmbl:SPEED, rsbl:SPEED, velomotion16:SPEED), a cloud (.ply .pcd .las .laz .e57 .mcap .csv .xyz .bin .npz .txt .asc), \
                    or a log or recording (pcapng, pcap)";

/// The failure for an invalid pattern.
pub fn pattern_failure(error: &PatternError) -> Failure {
    let help = match error {
        PatternError::Name { .. } => HINT,
        PatternError::TooMany { .. } => "scan faster, or with a larger step",
        PatternError::Option { .. } | PatternError::Number { .. } => {
            "as in velomotion16:50,rpm=600,step=0.2,from=0,to=-45,tilt=stepped,d=0.06"
        }
    };
    Failure::new(Kind::Usage, error.to_string()).help(help)
}

fn of_pattern(pattern: &Pattern) -> Input {
    Input {
        name: pattern.name().to_owned(),
        directions: Directions::of_pattern(pattern),
        frames: Some(u64::from(pattern.frames())),
        scan_s: Some(pattern.scan_s()),
        view: Some(ViewReport::of_pattern(pattern)),
        pattern: Some(pattern.clone()),
        ..Input::default()
    }
}

/// Geometry of the sensor of a tilted pattern.
pub fn device(pattern: &Pattern) -> Option<DeviceReport> {
    let (settings, range) = (pattern.settings(), pattern.range());
    let tilt = settings.tilt;
    if tilt.speed_deg_s == 0.0 {
        return None;
    }
    let device = TiltedSensor {
        reach_m: [range.min_m, range.max_m],
        elevations_deg: pattern.elevations_deg(),
        d_m: settings.d_m,
        tilt_deg: [
            tilt.from_deg.min(tilt.to_deg),
            tilt.from_deg.max(tilt.to_deg),
        ],
        sees: [-90.0, 90.0].map(|azimuth_deg| pattern.sees_azimuth(azimuth_deg)),
    };
    let view = device.view();
    let [low, high] = view.forwards_deg.or(view.backwards_deg)?;
    // Without the ramps, as in the paper.
    let moving_s = match tilt.accel_deg_s2 {
        Some(_) => (tilt.to_deg - tilt.from_deg).abs() / tilt.speed_deg_s,
        None => pattern.scan_s(),
    };
    let frames = moving_s * settings.rpm / 60.0;
    Some(DeviceReport {
        view,
        mean_vertical_resolution_deg: vertical_resolution_deg(high - low, pattern.lasers(), frames),
        tilt_per_turn_deg: tilt.speed_deg_s * 60.0 / settings.rpm,
    })
}

/// Marks in velomotion's own clouds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CloudMarks {
    /// Whether the devices were simulated.
    pub simulated: bool,
    /// Whether it is in the frame of a tilting scanner, with the origin on the tilt axis.
    pub scanner: bool,
}

impl CloudMarks {
    /// The marks in some bytes of a file, and in its companion if it has one.
    pub fn of(path: &Path, format: Format, bytes: &[u8]) -> Self {
        let companion = companion(path, format);
        let has = |mark: &[u8]| {
            let contains = |text: &[u8]| text.windows(mark.len()).any(|window| window == mark);
            contains(bytes) || contains(&companion)
        };
        Self {
            simulated: has(b"SIMULATED"),
            scanner: has(b"z up in metres from the tilt axis"),
        }
    }
}

/// Path of the text beside a cloud whose format has no place for its metadata.
pub fn companion_path(path: &Path, format: Format) -> Option<PathBuf> {
    let mut name = path.as_os_str().to_owned();
    name.push(".txt");
    format.needs_companion().then(|| name.into())
}

/// The text beside a cloud; empty if there is none.
pub fn companion(path: &Path, format: Format) -> Vec<u8> {
    let beside = companion_path(path, format).and_then(|path| std::fs::read(path).ok());
    beside.unwrap_or_default()
}

/// Advice on a cloud that cannot be read.
pub const fn help_on(format: Format) -> &'static str {
    match format {
        Format::Csv | Format::Xyz => {
            "expected one row per point with x, y and z in metres, in the first three columns or those that a header names, with decimal points"
        }
        _ => "see whether the file is whole, and is what its extension says",
    }
}

fn of_cloud(path: &Path, format: Format, origin_m: DVec3) -> Result<Input, Failure> {
    let wrong = |what: String, help: &str| {
        Failure::new(Kind::BadInput, format!("{}: {what}", path.display())).help(help)
    };
    let bytes = std::fs::read(path).map_err(|error| {
        wrong(
            format!("cannot read: {error}"),
            "check the name and the read permission",
        )
    })?;
    let simulated = CloudMarks::of(path, format, &bytes).simulated;
    let read =
        positions(format, bytes).map_err(|error| wrong(error.to_string(), help_on(format)))?;
    let places = read.positions.into_iter().map(DVec3::from_array);
    let places: Vec<DVec3> = places.map(|place| place - origin_m).collect();
    let outside = DistantOrigin::new(&places, origin_m);
    let (directions, without_direction) = directions(path, places, read.without_numbers)?;
    Ok(Input {
        name: path.display().to_string(),
        simulated,
        directions: Directions::Stored(directions),
        without_direction,
        without_numbers: read.without_numbers,
        outside,
        ..Input::default()
    })
}

/// Directions of finite points from the origin, and the number of points at the origin.
fn directions(
    path: &Path,
    positions: Vec<DVec3>,
    without_numbers: u64,
) -> Result<(Vec<DVec3>, u64), Failure> {
    let all = positions.len();
    // Scaling first avoids overflow and underflow of the squares.
    let direction = |place: DVec3| (place / place.abs().max_element()).try_normalize();
    let directions: Vec<DVec3> = positions.into_iter().filter_map(direction).collect();
    let wrong = |what: &str, help: &str| {
        Err(Failure::new(Kind::BadInput, format!("{}: {what}", path.display())).help(help))
    };
    if !directions.is_empty() {
        let without = (all - directions.len()) as u64;
        return Ok((directions, without));
    }
    match (all, without_numbers) {
        (0, 0) => wrong(
            "the file has no points",
            "see whether it is the right file, and whole",
        ),
        (0, _) => wrong(
            "no point whose coordinates are numbers",
            "see whether it is the right file",
        ),
        _ => wrong(
            "no point that has a direction",
            "points are seen from the origin, which is on the tilt axis: give a cloud with that origin, or --origin X,Y,Z",
        ),
    }
}

/// Collects the points of a log and its tilt samples.
struct LogPoints {
    points: Points,
    track: TiltTrack,
}

impl Sink for LogPoints {
    fn points(&mut self, batch: &Points) -> Result<(), SinkError> {
        Sink::points(&mut self.points, batch)
    }

    fn wants_tilt(&self) -> bool {
        true
    }

    fn tilt(&mut self, track: &TiltTrack) -> Result<(), SinkError> {
        self.track = track.clone();
        Ok(())
    }
}

fn of_log(path: &Path, interrupt: &AtomicBool) -> Result<Input, Failure> {
    let source = Source::open(path, None)?;
    let mut tilted = false;
    source.read_until(|record| {
        tilted = matches!(record.wire, Wire::Drive { .. });
        !tilted
    })?;
    let request = replay::Reconstruction {
        recording: &source,
        tilt: if tilted {
            TiltSource::Log
        } else {
            TiltSource::None
        },
        options: lidar::Options::default(),
        time: TimeReference::Host,
        accuracy: Accuracy::Best,
        pace: None,
        truth: None,
        live: false,
        lost_records: 0,
        georeference: None,
        interrupt,
    };
    let mut kept = LogPoints {
        points: Points::new(Fields::NONE),
        track: TiltTrack::default(),
    };
    let scan = replay::scan(&request, &mut kept, path)?;
    let points = &kept.points;
    let places = points.x_m().iter().zip(points.y_m()).zip(points.z_m());
    let places: Vec<DVec3> = places.map(|((x, y), z)| DVec3::new(*x, *y, *z)).collect();
    let view = ViewReport::of_log(&scan, &kept.track, &places);
    let (directions, without_direction) = directions(path, places, 0)?;
    let (frames, scan_s) = if scan.sweeps.is_empty() {
        let seconds = scan.contents.duration_s;
        (scan.contents.rpm.map(|rpm| seconds * rpm / 60.0), seconds)
    } else {
        let frames: Option<f64> = scan.sweeps.iter().map(|sweep| sweep.frames).sum();
        (
            frames,
            scan.sweeps.iter().map(|sweep| sweep.duration_s).sum(),
        )
    };
    Ok(Input {
        name: path.display().to_string(),
        simulated: scan.contents.simulated,
        directions: Directions::Stored(directions),
        frames: frames.map(|frames| frames.round() as u64),
        scan_s: Some(scan_s),
        without_direction,
        view,
        warnings: scan.contents.warnings,
        ..Input::default()
    })
}
