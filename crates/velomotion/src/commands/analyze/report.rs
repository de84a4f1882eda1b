//! Report of `analyze`, serialised as its JSON.

use analysis::density::{BinCounts, EmptyBand, HistogramClass, HoleRow, Statistics};
use analysis::k::KCurve;
use analysis::tilted_sensor::VisibleRange;
use serde::Serialize;
use utoipa::ToSchema;

use super::view::ViewReport;

/// Report on all inputs.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct AnalyzeReport {
    /// One entry per pattern, cloud or log, in the order of the arguments.
    pub patterns: Vec<PatternReport>,
}

/// Report on one pattern, cloud or log.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct PatternReport {
    /// Name in the arguments.
    pub name: String,
    /// Whether the devices of a cloud or log were simulated.
    pub simulated: bool,
    /// Points with a direction.
    pub points: u64,
    /// Revolutions of the lidar; null if unknown.
    pub frames: Option<u64>,
    /// Duration of the scan, seconds; null if unknown.
    pub scan_s: Option<f64>,
    /// Points at the origin, omitted.
    pub without_direction: u64,
    /// Rows with NaN coordinates, omitted.
    pub without_numbers: u64,
    /// Field of view of patterns and logs; null if unknown.
    pub view: Option<ViewReport>,
    /// Points per bin, over all bins.
    pub density: Density,
    /// Points per bin, over bins whose centre is in view; null if the view is unknown.
    pub density_in_view: Option<Statistics>,
    /// The largest circle without a point.
    pub hole: HoleReport,
    /// The largest circle whose centre is in view; null if the view is unknown.
    pub hole_in_view: Option<HoleReport>,
    /// Distance to the nearest point, from directions in view, or from all directions if the view
    /// is unknown.
    pub gaps: GapReport,
    /// The bins with the fewest points, of those in view, or of all if the view is unknown: up to
    /// ten, the most isolated first.
    pub emptiest: Vec<EmptiestBin>,
    /// Blind spots.
    pub blind: Blind,
    /// Evenness of the points by the angles between them.
    pub k: KReport,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Geometry of the sensor; only for tilted sensors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device: Option<DeviceReport>,
}

/// Points per bin.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct Density {
    /// Statistics.
    #[serde(flatten)]
    pub bins: Statistics,
    /// Subdivisions of the icosahedron.
    pub level: u32,
    /// Bins by their points.
    pub histogram: Vec<HistogramClass>,
    /// Points in each bin, for figures.
    #[serde(skip)]
    pub counts: BinCounts,
}

/// A bin with few points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct EmptiestBin {
    /// Its points.
    pub points: u64,
    /// Direction of its centre: x right, y along the tilt axis, z up.
    pub centre: [f64; 3],
    /// Angle of its centre from the tilt axis (+y), degrees.
    pub from_axis_deg: f64,
    /// Distance from its centre to the nearest point, degrees.
    pub gap_deg: f64,
}

/// The largest circle without a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct HoleReport {
    /// Radius, degrees; its least possible value where not all points are in memory.
    pub radius_deg: f64,
    /// Upper bound on the radius, degrees.
    pub at_most_deg: f64,
    /// Direction of its centre: x right, y along the tilt axis, z up.
    pub centre: [f64; 3],
    /// Angle of its centre from the tilt axis (+y), degrees.
    pub from_axis_deg: f64,
}

/// Ripley's K function relative to complete spatial randomness (CSR): above 0 points cluster, below
/// 0 they repel. `k_minus_csr` is K - K_csr on a sphere of `radius_m`, square metres. `d` is K -
/// K_csr over the area of the sphere: the excess share of all pairs within an angle. Null for a
/// single point.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct KReport {
    /// Method: exact, turned (exact too), sampled or drawn.
    pub method: &'static str,
    /// Bins.
    pub bins: usize,
    /// Radius of the sphere for square metres: 1.
    pub radius_m: f64,
    /// Error bound of `k_minus_csr`, square metres: 0 for exact counts.
    pub error_bound: Option<f64>,
    /// Upper end of each bin, degrees.
    pub theta_deg: Vec<f64>,
    /// K - K_csr, square metres.
    pub k_minus_csr: Option<Vec<f64>>,
    /// Largest absolute value of `k_minus_csr`.
    pub max_abs: Option<f64>,
    /// Error bound of `d`.
    pub d_error_bound: Option<f64>,
    /// Probability that the bounds do not hold, by chance of the samples: 0 for exact counts.
    pub risk: Option<f64>,
    /// D = (K - K_csr) / (4 pi R2), a share.
    pub d: Option<Vec<f64>>,
    /// The largest D.
    pub d_max: Option<f64>,
    /// The smallest D.
    pub d_min: Option<f64>,
    /// Pairs on an edge between two bins within rounding: counted, or estimated from samples. They
    /// count towards the smaller angle.
    pub on_edges: u64,
    /// The complete estimate, for figures.
    #[serde(skip)]
    pub curve: KCurve,
}

/// Distance to the nearest point, from 20,480 directions of the sphere that are spread evenly: the
/// centres of level 5, whatever the level of the bins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct GapReport {
    /// Directions used: those in `view`, or `all`.
    pub of: &'static str,
    /// Median distance, degrees.
    pub median_deg: f64,
    /// Distance that 95 % of the directions do not exceed, degrees.
    pub of_95_percent_deg: f64,
    /// Distance that 99 % of the directions do not exceed, degrees.
    pub of_99_percent_deg: f64,
}

/// Holes in view that are larger than the 99 % gap, and bands about the tilt axis without points.
/// Without a known view holes cannot be distinguished from directions out of view: all values are
/// null.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct Blind {
    /// Smallest radius of the counted holes, degrees.
    pub least_radius_deg: Option<f64>,
    /// Number of holes; no centre lies in a larger hole.
    pub holes: Option<usize>,
    /// Whether there are more holes than counted.
    pub and_more: Option<bool>,
    /// Rows of holes about the tilt axis, by angle.
    pub rows: Option<Vec<HoleRow>>,
    /// Bands of at least `BAND_DEG` about the tilt axis without a point.
    pub bands: Vec<EmptyBand>,
    /// Whether the bands are empty at any speed of the axis, as for patterns of a sensor on it.
    pub bands_at_any_speed: bool,
}

/// Geometry of the sensor on its mount.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct DeviceReport {
    /// Ranges and fields of view.
    #[serde(flatten)]
    pub view: VisibleRange,
    /// The paper's mean vertical resolution: the field of view of tilt and lasers, divided by
    /// lasers times revolutions.
    pub mean_vertical_resolution_deg: f64,
    /// Tilt per revolution of the lidar.
    pub tilt_per_turn_deg: f64,
}

/// Smallest width of a band, degrees.
pub const BAND_DEG: f64 = 0.1;
