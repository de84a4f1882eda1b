//! Reports of reconstructions, serialised as the JSON of `info`, `replay` and `capture`.

use scanner::clock_steps::{ClockStep, SetClock};
use scanner::{MethodChoice, ScanConfig};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Packet counts by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct PacketCounts {
    /// Decoded lidar data packets.
    pub data: u64,
    /// Position packets.
    pub position: u64,
    /// Damaged records or packets.
    pub malformed: u64,
    /// Other traffic.
    pub other: u64,
}

/// The drive part of a log.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct TiltReport {
    /// Shaft samples.
    pub samples: u64,
    /// `usb`, `rs232` or `can`.
    #[schema(schema_with = crate::document::transports)]
    pub transport: String,
}

/// State of a lidar's satellite receiver.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct Gps {
    /// State of the pulse per second: `absent`, `synchronising`, `locked` or `error`.
    #[schema(schema_with = crate::document::pps_states)]
    pub pps: String,
    /// Whether the lidar's time is UTC: pulse and fix are valid.
    pub locked: bool,
    /// Description of the state, with its reason.
    pub state: String,
    /// Last position of its antenna in WGS 84.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<GpsReport>,
}

/// Position of an antenna in WGS 84.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct GpsReport {
    /// Degrees, positive in the north.
    pub latitude_deg: f64,
    /// Degrees, positive in the east.
    pub longitude_deg: f64,
}

/// One of several lidars in a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct SensorReport {
    /// Address and data port.
    pub name: String,
    /// Model.
    pub model: Option<String>,
    /// `strongest`, `last` or `dual`.
    #[schema(schema_with = crate::document::return_modes)]
    pub return_mode: Option<String>,
    /// Data packets.
    pub data: u64,
    /// Channels with a range.
    pub returns: u64,
    /// Data packets missing by device time.
    pub lost_packets: u64,
    /// Lidar speed, revolutions per minute.
    pub rpm: Option<f64>,
    /// Satellite receiver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gps: Option<Gps>,
}

/// Data packets that are missing at one place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct MissingPackets {
    /// From the first firing, seconds of device time.
    pub at_s: f64,
    /// Their number.
    pub missing: u64,
}

/// Contents of a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct Contents {
    /// Sensor model.
    pub model: Option<String>,
    /// `strongest`, `last` or `dual`.
    #[schema(schema_with = crate::document::return_modes)]
    pub return_mode: Option<String>,
    /// Packet counts.
    pub packets: PacketCounts,
    /// Channels with a range.
    pub returns: u64,
    /// Data packets missing by device time.
    pub lost_packets: u64,
    /// Where they are missing: at most the first 100 places.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub packet_gaps: Vec<MissingPackets>,
    /// From the first to the last firing, seconds of device time.
    pub duration_s: f64,
    /// Lidar speed, revolutions per minute.
    pub rpm: Option<f64>,
    /// Satellite receiver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gps: Option<Gps>,
    /// One report per lidar if there are several. The other fields describe the first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<SensorReport>,
    /// Drive samples of a log.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tilt: Option<TiltReport>,
    /// Where and why the file ends early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truncated: Option<String>,
    /// Whether the devices were simulated.
    pub simulated: bool,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// Report of `info`.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct InfoReport {
    /// Contents of the file.
    #[serde(flatten)]
    pub contents: Contents,
    /// Path of the file.
    pub file: String,
    /// Receive time of the first lidar packet or drive record, Unix seconds of the host clock.
    pub start_s: Option<f64>,
    /// Address and data port of the lidar that `packets` and `returns` describe.
    pub sensor: Option<String>,
    /// Sweeps of a log. Why there are none is a warning.
    pub sweeps: Vec<SweepReport>,
    /// Planned sweeps that are incomplete; also in the warnings.
    #[serde(skip)]
    pub incomplete_sweeps: Vec<String>,
    /// Configuration of the scanner in a log; null for a plain recording.
    pub configuration: Option<ScanConfig>,
}

/// One sweep.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct SweepReport {
    /// Angle at the start.
    pub from_deg: f64,
    /// Angle at the end.
    pub to_deg: f64,
    /// Measured speed of the cruise.
    pub cruise_deg_s: f64,
    /// Time in motion, ramps included.
    pub duration_s: f64,
    /// Angular range over duration.
    pub mean_deg_s: f64,
    /// Lidar revolutions in that time, if its speed is known.
    pub frames: Option<f64>,
}

/// A clock step during the recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct StepReport {
    /// `host` or `lidar`.
    #[schema(value_type = String)]
    pub clock: SetClock,
    /// Time of the step, Unix seconds of the host clock before the step.
    pub when_s: f64,
    /// Seconds after the lidar's first packet.
    pub after_s: f64,
    /// Size of the step, seconds; negative if the clock was set back.
    pub by_s: f64,
}

impl StepReport {
    /// Creates the report of a step.
    #[must_use]
    pub fn new(step: &ClockStep) -> Self {
        Self {
            clock: step.clock,
            when_s: step.when.as_secs_f64(),
            after_s: step.after.as_secs_f64(),
            by_s: step.by.as_secs_f64(),
        }
    }
}

/// Choice of a trajectory method under a tolerance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct ToleranceReport {
    /// Tolerated error, metres.
    pub asked_m: f64,
    /// Distance at which it applies, metres.
    pub at_m: f64,
    /// Error bound of the chosen method, metres.
    pub bound_m: f64,
    /// Every method tried, cheapest first.
    pub tried: Vec<TriedMethod>,
    /// The choice in words, with the errors that the bounds leave out.
    pub why: String,
}

/// A method and its error bound.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct TriedMethod {
    /// Its name.
    pub method: String,
    /// Error bound at the requested distance, metres.
    pub bound_m: f64,
}

impl ToleranceReport {
    /// Creates the report of a choice.
    #[must_use]
    pub fn new(choice: &MethodChoice) -> Self {
        let tried = choice.bounds.iter().map(|(method, bound)| TriedMethod {
            method: method.name().to_owned(),
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

/// Synchronisation of clocks and angles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct SyncReport {
    /// Method of the clock model.
    pub clock_method: String,
    /// Median delay of a packet above the clock's envelope.
    pub clock_residual_us: f64,
    /// Bound on the clock error, apart from a constant delay.
    pub clock_bound_us: f64,
    /// The same as an angle, at the speed of the fastest sweep.
    pub clock_bound_deg: Option<f64>,
    /// The same as a displacement of a point at 20 m.
    pub clock_bound_mm_at_20m: Option<f64>,
    /// Drift of the lidar's clock against the host clock; positive if it runs slow.
    pub clock_drift_ppm: f64,
    /// Clock steps during the recording.
    pub steps: Vec<StepReport>,
    /// Method of the trajectory.
    #[schema(schema_with = crate::document::angle_methods)]
    pub angle_method: String,
    /// Choice of the method, if a tolerance was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<ToleranceReport>,
    /// RMS residual of the angle samples.
    pub angle_rms_deg: Option<f64>,
    /// Bound on the angle error.
    pub angle_bound_deg: Option<f64>,
    /// Times of at least 0.1 s in the sweeps without an angle sample.
    pub angle_gaps: u64,
    /// Longest time between two angle samples in the sweeps.
    pub longest_angle_gap_s: f64,
}

/// Packets received and lost during a capture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Reception {
    /// Packets received, position packets included.
    // Scans of earlier versions call them `packets`.
    #[serde(alias = "packets")]
    pub received: u64,
    /// Packets dropped by the kernel because this program was too slow.
    pub dropped_by_kernel: u64,
    /// Records of either device dropped because the disk was too slow or the log cannot hold them.
    pub dropped_by_log: u64,
    /// Received packets without a kernel timestamp.
    pub without_kernel_time: u64,
    /// Packets of other senders than the configured lidar; not in `packets`.
    pub from_others: u64,
}

/// Errors of a cloud against the simulator's truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct TruthErrors {
    /// Root mean square of the point errors.
    pub rms_m: f64,
    /// Largest error.
    pub worst_m: f64,
}

/// The points that the live view shows of a scan, against those of the cloud. One firing in eight
/// is compared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct LiveReport {
    /// Points placed live.
    pub points: u64,
    /// Root mean square of their distances from the cloud's; null without common points.
    pub rms_m: Option<f64>,
    /// Largest distance.
    pub worst_m: Option<f64>,
    /// Largest delay, seconds: from the first firing not placed to the newest angle.
    pub lag_s: f64,
}

/// Report of `replay` and `capture`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct ScanReport {
    /// Contents of the log.
    #[serde(flatten)]
    pub contents: Contents,
    /// Points of the cloud.
    pub points: u64,
    /// Clouds written, if each revolution has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clouds: Option<u64>,
    /// Returns omitted.
    pub left_out: u64,
    /// Why; null if none was.
    pub left_out_because: Option<String>,
    /// Sweeps.
    pub sweeps: Vec<SweepReport>,
    /// Synchronisation of clocks and angles.
    pub sync: SyncReport,
    /// Path of the cloud.
    pub output: String,
    /// Path of the log.
    pub log: String,
    /// Records lost during the capture, by the kernel or the disk.
    pub lost_records: u64,
    /// Seconds from the start of the first sweep to the first lidar packet, and from the last
    /// packet to the end of the last sweep; 0 if unknown or negative.
    #[serde(skip)]
    pub lidar_gaps_s: [f64; 2],
    /// Residuals over time.
    #[serde(skip)]
    pub residuals: Vec<TimedResiduals>,
    /// Planned sweeps that are incomplete; also in the warnings.
    #[serde(skip)]
    pub incomplete_sweeps: Vec<String>,
    /// Packets received during a capture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reception: Option<Reception>,
    /// Errors against the simulator's truth; absent for real scans.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<TruthErrors>,
    /// The live view, if it was compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub live: Option<LiveReport>,
    /// Frame of the cloud, if it is georeferenced.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub georeference: Option<GeoreferenceReport>,
}

/// Frame of a georeferenced cloud: x east, y north, z up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[non_exhaustive]
pub struct GeoreferenceReport {
    /// Position of the frame's origin: the median of the receiver's fixes. Its height is unknown.
    pub origin: GpsReport,
    /// Heading of the scanner's y axis (forward), degrees clockwise from true north, as requested.
    pub heading_deg: f64,
    /// Fixes: sentences with a valid position, counted once each.
    pub fixes: u64,
    /// Median distance of the fixes from the origin, metres, without the errors that they share.
    pub spread_p50_m: f64,
    /// Their greatest distance.
    pub spread_worst_m: f64,
    /// State of the pulse per second: `absent`, `synchronising`, `locked` or `error`.
    #[schema(schema_with = crate::document::pps_states)]
    pub pps: String,
    /// The accuracy in words.
    pub accuracy: String,
}

/// Residuals of clock and angle within a part of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[non_exhaustive]
pub struct TimedResiduals {
    /// Middle of the part, seconds since the first packet.
    pub at_s: f64,
    /// Median delay of the packets beyond the clock's lower envelope, microseconds; null without
    /// packets.
    pub delay_us: Option<f64>,
    /// Their greatest delay, microseconds.
    pub most_delay_us: Option<f64>,
    /// Root mean square deviation of the drive's positions in sweeps from the curve, degrees; null
    /// without such positions.
    pub angle_rms_deg: Option<f64>,
    /// Their greatest deviation, degrees.
    pub most_angle_deg: Option<f64>,
}

impl From<&scanner::ResidualInterval> for TimedResiduals {
    fn from(interval: &scanner::ResidualInterval) -> Self {
        Self {
            at_s: interval.at.as_secs_f64(),
            delay_us: interval.delay.map(|(median, _)| median.as_micros_f64()),
            most_delay_us: interval.delay.map(|(_, most)| most.as_micros_f64()),
            angle_rms_deg: interval.angle_deg.map(|(rms, _)| rms),
            most_angle_deg: interval.angle_deg.map(|(_, most)| most),
        }
    }
}

impl SweepReport {
    /// Creates the report of a sweep at a lidar speed of `rpm`.
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
