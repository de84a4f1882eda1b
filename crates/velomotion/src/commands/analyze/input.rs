//! What is to be analysed: a pattern by its name, a cloud, or a log or recording, as the directions of its points.
//!
//! Directions are as seen from the base's origin, on the tilt axis; where a recording has no tilt, from the sensor. Left out: what becomes of them.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use analysis::device::{Device, vertical_resolution_deg};
use cloud::formats::Format;
use cloud::read::positions;
use cloud::{Fields, Points};
use glam::DVec3;
use protocol::record::Wire;
use scanner::{Accuracy, TiltSource};
use sim::patterns::{Pattern, PatternError, Wish};

use super::report::DeviceReport;
use crate::cli::TimeOf;
use crate::commands::replay;
use crate::failure::{Failure, Kind};
use crate::recordings::Source;

/// Directions, and what is known of how they came about.
pub struct Input {
    /// What it is called.
    pub name: String,
    /// Where its points are, length 1.
    pub directions: Vec<DVec3>,
    /// Turns of the lidar, where they are known.
    pub frames: Option<u64>,
    /// How long the scan took, where that is known, seconds.
    pub scan_s: Option<f64>,
    /// Points in the origin, which have no direction.
    pub without_direction: u64,
    /// The pattern, if it is one: it knows what it can see.
    pub pattern: Option<Pattern>,
}

/// What an argument names.
pub enum Named<'a> {
    /// A pattern.
    Pattern(Box<Pattern>),
    /// A cloud in a format that is read.
    Cloud(&'a Path, Format),
    /// Anything else: a log or a recording.
    Log(&'a Path),
}

impl<'a> Named<'a> {
    /// Says what it is, before any of it is read: a pattern by its name, else by the extension.
    ///
    /// # Errors
    /// [`Kind::Usage`] for patterns that cannot be, [`Kind::BadInput`] for files that are not there.
    pub fn new(argument: &'a str) -> Result<Self, Failure> {
        if Wish::is_one(argument) {
            let pattern = Wish::parse(argument).and_then(|wish| wish.build());
            return Ok(Self::Pattern(Box::new(
                pattern.map_err(|e| pattern_failure(&e))?,
            )));
        }
        let path = Path::new(argument);
        if argument != "-" && !path.exists() {
            let what = format!("there is no pattern and no file {argument:?}");
            return Err(Failure::new(Kind::BadInput, what).help(HINT));
        }
        Ok(match Format::from_path(path) {
            Ok(format) => Self::Cloud(path, format),
            Err(_) => Self::Log(path),
        })
    }

    /// Its directions.
    ///
    /// # Errors
    /// [`Kind::BadInput`] for files that cannot be read, or hold no point.
    pub fn read(&self, interrupt: &AtomicBool) -> Result<Input, Failure> {
        match self {
            Self::Pattern(pattern) => Ok(of_pattern(pattern)),
            Self::Cloud(path, format) => of_cloud(path, *format),
            Self::Log(path) => of_log(path, interrupt),
        }
    }
}

const HINT: &str = "name a pattern (vlp16, hdl32e, vlp32c, rmbl:SPEED, rsbl:SPEED, velomotion16:SPEED), a cloud (.ply .pcd .las .laz .csv), \
                    or a log or recording (pcapng, pcap)";

/// A pattern that cannot be.
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
        directions: pattern.directions(),
        frames: Some(u64::from(pattern.frames())),
        scan_s: Some(pattern.scan_s()),
        without_direction: 0,
        pattern: Some(pattern.clone()),
    }
}

/// What the mount makes of the sensor of a pattern that is tilted.
pub fn device(pattern: &Pattern) -> Option<DeviceReport> {
    let (settings, reach) = (pattern.settings(), pattern.reach());
    let tilting = settings.tilting;
    if tilting.speed_deg_s == 0.0 {
        return None;
    }
    let device = Device {
        reach_m: [reach.min_m, reach.max_m],
        elevations_deg: pattern.elevations_deg(),
        d_m: settings.d_m,
        tilt_deg: [
            tilting.from_deg.min(tilting.to_deg),
            tilting.from_deg.max(tilting.to_deg),
        ],
    };
    let view = device.view();
    let [low, high] = view.forwards_deg;
    let frames = pattern.scan_s() * settings.rpm / 60.0;
    Some(DeviceReport {
        view,
        vertical_resolution_deg: vertical_resolution_deg(high - low, pattern.lasers(), frames),
    })
}

fn of_cloud(path: &Path, format: Format) -> Result<Input, Failure> {
    let wrong = |what: String, help: &str| {
        Failure::new(Kind::BadInput, format!("{}: {what}", path.display())).help(help)
    };
    let bytes = std::fs::read(path).map_err(|error| {
        wrong(
            format!("cannot read: {error}"),
            "see whether the name is right and the file may be read",
        )
    })?;
    let positions = positions(format, bytes).map_err(|error| {
        wrong(
            error.to_string(),
            "see whether the file is whole, and is what its extension says",
        )
    })?;
    let (directions, without_direction) =
        directions(path, positions.into_iter().map(DVec3::from_array))?;
    Ok(Input {
        name: path.display().to_string(),
        directions,
        frames: None,
        scan_s: None,
        without_direction,
        pattern: None,
    })
}

/// Where points are, seen from the origin; and how many are in it.
fn directions(
    path: &Path,
    positions: impl Iterator<Item = DVec3>,
) -> Result<(Vec<DVec3>, u64), Failure> {
    let mut directions = Vec::with_capacity(positions.size_hint().0);
    let mut without = 0;
    for (number, position) in positions.enumerate() {
        if position == DVec3::ZERO {
            without += 1;
            continue;
        }
        // Scaled first: squares of what is very large or very small are neither.
        let direction = (position / position.abs().max_element()).try_normalize();
        let Some(direction) = direction.filter(|_| position.is_finite()) else {
            let [x, y, z] = position.to_array();
            let what = format!("{}: point {number} is at ({x}, {y}, {z})", path.display());
            let help = "take out what is no point; its number counts from 0";
            return Err(Failure::new(Kind::BadInput, what).help(help));
        };
        directions.push(direction);
    }
    if directions.is_empty() && without == 0 {
        let what = format!("{}: the file has no points", path.display());
        let help = "see whether it is the right file, and whole";
        return Err(Failure::new(Kind::BadInput, what).help(help));
    }
    if directions.is_empty() {
        let what = format!("{}: no point that has a direction", path.display());
        let help =
            "points are seen from the origin, which is on the tilt axis: give a cloud of such";
        return Err(Failure::new(Kind::BadInput, what).help(help));
    }
    Ok((directions, without))
}

fn of_log(path: &Path, interrupt: &AtomicBool) -> Result<Input, Failure> {
    let source = Source::open(path, None)?;
    let mut tilted = false;
    source.read_until(|record| {
        tilted = matches!(record.wire, Wire::Drive { .. });
        !tilted
    })?;
    let request = replay::Request {
        recording: &source,
        tilt: if tilted {
            TiltSource::Log
        } else {
            TiltSource::None
        },
        options: lidar::Options::default(),
        time: TimeOf::Host,
        accuracy: Accuracy::Best,
        pace: None,
        truth: None,
        lost_records: 0,
        interrupt,
    };
    let mut points = Points::new(Fields::NONE);
    let scan = replay::scan(&request, &mut points, path)?;
    let places = points.x_m().iter().zip(points.y_m()).zip(points.z_m());
    let places = places.map(|((x, y), z)| DVec3::new(*x, *y, *z));
    let (directions, without_direction) = directions(path, places)?;
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
        directions,
        frames: frames.map(|frames| frames.round() as u64),
        scan_s: Some(scan_s),
        without_direction,
        pattern: None,
    })
}
