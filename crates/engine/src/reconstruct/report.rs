//! What commands say at the end: one JSON object for programs, a table for people.

use scanner::MethodChoice;
use scanner::steps::{ClockStep, SetClock};
use serde::{Deserialize, Serialize};

/// Packets by what they were.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Packets {
    /// Lidar data packets that were decoded.
    pub data: u64,
    /// Position packets.
    pub position: u64,
    /// Records or packets that are damaged.
    pub malformed: u64,
    /// Traffic of something else.
    pub other: u64,
}

/// The tilt part of a log.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Tilt {
    /// Shaft samples.
    pub samples: u64,
    /// usb, rs232 or can.
    pub transport: String,
}

/// What is known of a lidar's satellite receiver.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Gps {
    /// State of the pulse per second: absent, synchronising, locked or error.
    pub pps: String,
    /// Whether the lidar's time is UTC: pulse and fix are good.
    pub locked: bool,
    /// The same in words, with the reason.
    pub state: String,
}

/// One of several lidars in a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SensorReport {
    /// Address and data port.
    pub name: String,
    /// Model.
    pub model: Option<String>,
    /// strongest, last or dual.
    pub return_mode: Option<String>,
    /// Data packets.
    pub data: u64,
    /// Channels with a distance.
    pub returns: u64,
    /// Data packets missing by device time.
    pub lost_packets: u64,
    /// Rotation.
    pub rpm: Option<f64>,
    /// What is known of its satellite receiver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gps: Option<Gps>,
}

impl SensorReport {
    /// The report on what a decoder saw.
    #[must_use]
    pub fn new(name: String, stats: &lidar::Stats, gps: Option<Gps>) -> Self {
        Self {
            name,
            model: stats.model.map(|model| model.name.to_owned()),
            return_mode: stats.return_mode.map(super::contents::return_mode_name),
            data: stats.data,
            returns: stats.returns,
            lost_packets: stats.lost_packets,
            rpm: stats.rpm,
            gps,
        }
    }
}

/// What a file holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Contents {
    /// Sensor model.
    pub model: Option<String>,
    /// strongest, last or dual.
    pub return_mode: Option<String>,
    /// Packets by what they were.
    pub packets: Packets,
    /// Channels with a distance.
    pub returns: u64,
    /// Data packets missing by device time.
    pub lost_packets: u64,
    /// From the first to the last firing, seconds of the device's clock.
    pub duration_s: f64,
    /// Rotation of the lidar.
    pub rpm: Option<f64>,
    /// What is known of the lidar's satellite receiver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gps: Option<Gps>,
    /// Each lidar, where there are several; the rest of the report is of the first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<SensorReport>,
    /// What a log holds of the drive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt: Option<Tilt>,
    /// Where and why the file ends too early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truncated: Option<String>,
    /// Whether the devices were software.
    pub simulated: bool,
    /// What is doubtful about it.
    pub warnings: Vec<String>,
}

/// One sweep.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SweepReport {
    /// Angle at its start.
    pub from_deg: f64,
    /// Angle at its end.
    pub to_deg: f64,
    /// Measured speed in the cruise.
    pub cruise_deg_s: f64,
    /// Time in motion, ramps included.
    pub duration_s: f64,
    /// Range over time.
    pub mean_deg_s: f64,
    /// Turns of the lidar in that time; none where its speed is not known.
    pub frames: Option<f64>,
}

/// A clock that was set in mid-recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StepReport {
    /// host or lidar.
    pub clock: &'static str,
    /// When, Unix seconds of the host's clock as it was at the begin.
    pub when_s: f64,
    /// Seconds after the lidar's first packet.
    pub after_s: f64,
    /// How far forward, seconds; negative where it was set back.
    pub by_s: f64,
}

impl StepReport {
    /// The report on a step.
    #[must_use]
    pub fn new(step: &ClockStep) -> Self {
        Self {
            clock: match step.clock {
                SetClock::Host => "host",
                SetClock::Lidar => "lidar",
            },
            when_s: step.when.as_secs_f64(),
            after_s: step.after.as_secs_f64(),
            by_s: step.by.as_secs_f64(),
        }
    }
}

/// Why a method was taken.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToleranceReport {
    /// How far off points may be.
    pub asked_m: f64,
    /// At this distance.
    pub at_m: f64,
    /// How far off they may be by the method taken.
    pub bound_m: f64,
    /// Each method that was tried, the cheapest first.
    pub tried: Vec<TriedMethod>,
    /// The same in words.
    #[serde(skip)]
    pub why: String,
}

/// A method and how far off it may be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TriedMethod {
    /// Its name.
    pub method: &'static str,
    /// How far off points may be by it at the distance asked for.
    pub bound_m: f64,
}

impl ToleranceReport {
    /// The report on a choice.
    #[must_use]
    pub fn new(choice: &MethodChoice) -> Self {
        let tried = choice.bounds.iter().map(|(method, bound)| TriedMethod {
            method: method.name(),
            bound_m: bound.0,
        });
        Self {
            asked_m: choice.tolerance.off.0,
            at_m: choice.tolerance.at.0,
            bound_m: choice.bounds.last().map_or(f64::NAN, |(_, bound)| bound.0),
            tried: tried.collect(),
            why: choice.to_string(),
        }
    }
}

/// How the clocks and the angle were joined.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sync {
    /// Method of the lidar's clock.
    pub clock_method: &'static str,
    /// Median delay of a packet above the clock's envelope.
    pub clock_residual_us: f64,
    /// How far off the clock may be, beyond a constant delay.
    pub clock_bound_us: f64,
    /// How much slower than the host's clock the lidar's runs.
    pub clock_drift_ppm: f64,
    /// Clocks that were set in mid-recording.
    pub steps: Vec<StepReport>,
    /// Method of the trajectory.
    pub angle_method: &'static str,
    /// Why it was taken, where an accuracy was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<ToleranceReport>,
    /// RMS of angle samples against their neighbours.
    pub angle_rms_deg: Option<f64>,
    /// How far off an angle may be at worst.
    pub angle_bound_deg: Option<f64>,
}

/// What a capture heard of the lidar, and what of it was lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reception {
    /// Packets heard, position packets included.
    pub packets: u64,
    /// Packets that the kernel dropped because this program was too slow.
    pub dropped_by_kernel: u64,
    /// Records, the drive's included, that the disk was too slow for or that the log cannot hold.
    pub dropped_by_log: u64,
    /// Of `packets`: those without a kernel time.
    pub without_kernel_time: u64,
    /// Packets of other senders than the configuration's; not in `packets`.
    pub from_others: u64,
}

/// A cloud against the simulator's truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Root mean square of the points' errors.
    pub rms_m: f64,
    /// Largest error.
    pub worst_m: f64,
}

/// What `replay` and `capture` say.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scan {
    /// What the log holds.
    #[serde(flatten)]
    pub contents: Contents,
    /// Points of the cloud.
    pub points: u64,
    /// Clouds, where each turn of the lidar is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clouds: Option<u64>,
    /// Returns left out: fired outside every sweep or where no angle is known.
    pub left_out: u64,
    /// The sweeps.
    pub sweeps: Vec<SweepReport>,
    /// How the clocks and the angle were joined.
    pub sync: Sync,
    /// The cloud.
    pub output: String,
    /// The log.
    pub log: String,
    /// Records that a capture lost: packets that the kernel dropped, records that the disk was too slow for.
    pub lost_records: u64,
    /// How long before the end of the last sweep the last lidar packet came, seconds; 0 where that is not known or it came later.
    #[serde(skip)]
    pub unheard_s: f64,
    /// What of the sweeps that the log was to have is missing; in the warnings too.
    #[serde(skip)]
    pub short: Vec<String>,
    /// What a capture heard.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reception: Option<Reception>,
    /// Against the simulator's truth; real scans have none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<Truth>,
}

impl SweepReport {
    /// The report on a sweep during which the lidar turned at `rpm`.
    #[must_use]
    pub fn new(sweep: &scanner::sweeps::Sweep, rpm: Option<f64>) -> Self {
        let duration_s = (sweep.end - sweep.start).as_secs_f64();
        Self {
            from_deg: sweep.from.0,
            to_deg: sweep.to.0,
            cruise_deg_s: sweep.cruise.0,
            duration_s,
            mean_deg_s: (sweep.to.0 - sweep.from.0) / duration_s,
            frames: rpm.map(|rpm| duration_s * rpm / 60.0),
        }
    }
}

impl Scan {
    /// Adds what a comparison with the truth found.
    #[must_use]
    pub fn with_truth(mut self, report: analysis::truth::TruthReport) -> Self {
        self.truth = Some(Truth {
            rms_m: report.rms_m,
            worst_m: report.worst_m,
        });
        self
    }
}
